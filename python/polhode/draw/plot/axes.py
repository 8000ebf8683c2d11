"""Axes and their style, and surfaces that hide the curves behind them."""

from __future__ import annotations

import itertools
from os import PathLike
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

import numpy as np

from polhode._optional import require

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "arrow",
    "axes_2d",
    "axes_3d",
    "azimuth_beside",
    "columns_that_fit",
    "curve_on",
    "fan",
    "in_lines",
    "matplotlib",
    "plain_frame",
    "room",
    "show_around",
    "solid_ellipsoid",
    "text_size",
    "tidy",
    "to_upright",
    "toward_viewer",
    "translucent",
]

_AxesArgument = TypeVar("_AxesArgument")
_FRAME: Final = 56.0
"""Points that labels, numbers and margins take of the height of a picture over time."""
_ENTRY: Final = 4.2
"""Width of a legend's line and of the gap to the next entry, in sizes of its font."""


def matplotlib(module: str) -> Any:
    """Import a module of matplotlib, or say what installs it."""
    return require(f"matplotlib.{module}", extra="plot", purpose="drawing")


def axes_2d(ax: Axes | None) -> Axes:
    """Return the axes to draw in, in a new figure where there are none."""
    if ax is not None:
        return _check_axes(ax)
    return cast("Axes", matplotlib("pyplot").subplots(layout="constrained")[1])


def axes_3d(ax: Axes3D | None) -> Axes3D:
    """Return the axes of three dimensions to draw in, in a new figure where there are none."""
    if ax is not None:
        return _check_axes(ax)
    figure = matplotlib("pyplot").figure(layout="constrained")
    return cast("Axes3D", figure.add_subplot(projection="3d", computed_zorder=False))


def _check_axes(ax: _AxesArgument) -> _AxesArgument:
    if isinstance(ax, str | PathLike):
        raise TypeError(
            f"ax: expected axes of matplotlib, got {str(ax)!r}; draw first and save the figure: "
            f".figure.savefig({str(ax)!r}) of what this returns"
        )
    return ax


def tidy(ax: Axes) -> Axes:
    """Set the grid and the open frame that all axes over time have."""
    ax.margins(x=0.0)
    ax.grid(color="0.9", linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    return ax


def room(ax: Axes) -> tuple[float, float]:
    """Return width and height of the part of a figure in which axes stand, in points."""
    part = ax.get_subplotspec()
    figure: Any = ax.figure
    box = ax.get_position() if part is None else part.get_position(figure)
    inches = 72.0 / figure.dpi
    return box.width * figure.bbox.width * inches, box.height * figure.bbox.height * inches


def text_size(text: str, size: float, *, parse_math: bool = True) -> tuple[float, float]:
    """Compute width and height of a text of one or more lines, in points, for a font of this size."""
    font = matplotlib("font_manager").FontProperties(size=size)
    measure = matplotlib("textpath").text_to_path.get_text_width_height_descent
    lines = text.split("\n")
    widths = [measure(line, font, parse_math and "$" in line)[0] if line else 0.0 for line in lines]
    return max(widths), 1.2 * size * len(lines)


def columns_that_fit(width: float, labels: Sequence[str], size: float, most: int) -> int:
    """Return how many columns a legend may have, so that it is no wider than this number of points."""
    widths = [text_size(label, size)[0] + _ENTRY * size for label in labels]
    for columns in range(min(most, len(labels)), 1, -1):
        rows, longer = divmod(len(labels), columns)
        starts = [k * rows + min(k, longer) for k in range(columns + 1)]
        if sum(max(widths[a:b]) for a, b in itertools.pairwise(starts)) <= width:
            return columns
    return 1


def in_lines(ax: Axes, label: str) -> str:
    """Break the label of a vertical axis in two where it is longer than the axis."""
    if text_size(label, 10.0)[0] <= room(ax)[1] - _FRAME:
        return label
    ends = [k for k, letter in enumerate(label) if letter == " "]
    middle = min(ends, key=lambda k: abs(2 * k - len(label)), default=0)
    return f"{label[:middle]}\n{label[middle + 1 :]}" if middle else label


def show_around(ax: Axes3D, middle: Any, half: float) -> None:
    """Set the limits of all axes to a cube around a point, with this half side."""
    for name, value in zip("xyz", middle, strict=True):
        getattr(ax, f"set_{name}lim")(value - half, value + half)


_SURFACE: Final = np.array([0.79, 0.84, 0.91])


def toward_viewer(ax: Axes3D) -> Floats:
    """Find the unit vector from the scene toward the viewer."""
    elevation, azimuth = np.deg2rad([ax.elev, ax.azim])
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])


def solid_ellipsoid(ax: Axes3D, semi_axes: Floats, axes: Floats, center: Floats, opacity: float) -> None:
    """Draw an ellipsoid whose axes are the columns of a matrix."""
    polar, around = np.meshgrid(np.linspace(0.0, np.pi, 61), np.linspace(0.0, 2.0 * np.pi, 121))
    unit = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    points = (unit * semi_axes) @ axes.T + center
    normals = (unit / semi_axes) @ axes.T
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    light = toward_viewer(ax) + np.array([0.0, 0.0, 0.7])
    brightness = 0.84 + 0.2 * (normals @ (light / np.linalg.norm(light)))
    colors = np.clip(brightness[..., np.newaxis] * _SURFACE, 0.0, 1.0)
    surface = ax.plot_surface(
        *np.moveaxis(points, -1, 0), facecolors=colors, shade=False, linewidth=0, antialiased=False, zorder=2,
        rcount=121, ccount=121,
    )  # fmt: skip
    translucent(surface, opacity)


def translucent(surface: Any, opacity: float) -> None:
    """Make a surface of many pieces translucent.

    The pieces are drawn opaque, and their picture is made translucent as a whole. Pieces that are translucent
    one by one cover each other along their edges, which is seen as a grid.
    """
    if opacity >= 1.0:
        return

    def limit_opacity(picture: Floats, _dpi: float) -> tuple[Floats, int, int]:
        thin = picture.copy()
        thin[..., 3] = np.minimum(thin[..., 3], opacity)  # matplotlib may filter twice
        return thin, 0, 0

    surface.set_agg_filter(limit_opacity)
    surface.set_rasterized(True)  # formats of lines, such as SVG, know no filters


def curve_on(ax: Axes3D, points: Floats, normals: Floats, color: str, **style: Any) -> None:
    """Draw a curve on a convex surface: strong where it faces the viewer, faint behind.

    Parameters
    ----------
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D
    points, normals : numpy.ndarray, shape (n, 3)
        The curve, and the outward normals of the surface along it.
    color : str
    **style
        Of the line.
    """
    near = normals @ toward_viewer(ax) >= 0.0
    for side, order, faint in ((near, 4, {}), (~near, 3, {"alpha": 0.3, "linewidth": 0.8})):
        # A part begins at the last point of the other one, so that no gap is seen.
        shown = side | np.roll(side, 1) if order == 4 else side
        visible = np.where(shown[:, np.newaxis], points, np.nan)
        ax.plot(*visible.T, **({"color": color, "linewidth": 1.6, "zorder": order} | style | faint))


def fan(ax: Axes3D, directions: Floats, color: str, opacity: float) -> None:
    """Draw the cone from the origin over a curve."""
    art3d: Any = require("mpl_toolkits.mplot3d.art3d", extra="plot", purpose="drawing")
    apex = np.zeros_like(directions[1:])
    triangles = np.stack([apex, directions[:-1], directions[1:]], axis=1)
    ax.add_collection3d(
        art3d.Poly3DCollection(triangles, facecolors=color, edgecolors="none", alpha=opacity, zorder=2)
    )
    ax.plot(*directions.T, color=color, linewidth=1.4, zorder=3)


def arrow(ax: Axes3D, tip: Floats, color: str, name: str, *, order: int = 6, **style: Any) -> None:
    """Draw a vector from the origin, with its name in a style."""
    ax.quiver(*np.zeros(3), *tip, color=color, linewidth=2.0, arrow_length_ratio=0.08, zorder=order)
    named = {"ha": "center", "va": "center", "zorder": order} | style
    ax.text(*(1.1 * tip), name, color=color, fontsize=13, **named)


def plain_frame(ax: Axes3D, low: ArrayLike, high: ArrayLike) -> None:
    """Show a cube about the box between two corners, without coordinate axes."""
    corners = np.array([low, high], dtype=np.float64)
    middle, half = corners.mean(axis=0), 0.5 * float(np.ptp(corners, axis=0).max())
    show_around(ax, middle, half)
    ax.set_box_aspect((1.0, 1.0, 1.0), zoom=1.2)
    ax.set_axis_off()


def to_upright(normal: Floats) -> Floats:
    """Return the rotation that takes a unit vector to the third axis by the shortest way."""
    x, y, z = normal
    if z < -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    w = 1.0 / (1.0 + z)
    return np.array([[1 - x * x * w, -x * y * w, -x], [-x * y * w, 1 - y * y * w, -y], [x, y, z]])


def azimuth_beside(vector: Floats) -> float:
    """Return the azimuth, in degrees, from which a vector leans to the right."""
    return float(np.rad2deg(np.arctan2(vector[1], vector[0]))) - 80.0
