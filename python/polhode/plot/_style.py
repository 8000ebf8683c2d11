"""Axes to draw in, and how they look."""

from __future__ import annotations

import itertools
from os import PathLike
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

from polhode._extras import require

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D

__all__ = [
    "axes_2d",
    "axes_3d",
    "columns_that_fit",
    "in_lines",
    "matplotlib",
    "room",
    "show_around",
    "text_size",
    "tidy",
]

_Given = TypeVar("_Given")

_FRAME: Final = 56.0
"""Points that labels, numbers and margins take of the height of a picture over time."""
_ENTRY: Final = 4.2
"""What a legend adds to a text for its line and the room to the next entry, in sizes of its font."""


def matplotlib(module: str) -> Any:
    """Import a module of matplotlib, or say what installs it."""
    return require(f"matplotlib.{module}", extra="plot", purpose="drawing")


def axes_2d(ax: Axes | None) -> Axes:
    """Give the axes to draw in, in a new figure where there are none."""
    if ax is not None:
        return _checked(ax)
    return cast("Axes", matplotlib("pyplot").subplots(layout="constrained")[1])


def axes_3d(ax: Axes3D | None) -> Axes3D:
    """Give the axes of three dimensions to draw in, in a new figure where there are none."""
    if ax is not None:
        return _checked(ax)
    figure = matplotlib("pyplot").figure(layout="constrained")
    return cast("Axes3D", figure.add_subplot(projection="3d", computed_zorder=False))


def _checked(ax: _Given) -> _Given:
    if isinstance(ax, str | PathLike):
        raise TypeError(
            f"ax: expected axes of matplotlib, got {str(ax)!r}; draw first and save the figure: "
            f".figure.savefig({str(ax)!r}) of what this returns"
        )
    return ax


def tidy(ax: Axes) -> Axes:
    """Give axes over time the grid and the open frame that all of them have."""
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
    """Show the cube around a point that reaches so far along every axis."""
    for name, value in zip("xyz", middle, strict=True):
        getattr(ax, f"set_{name}lim")(value - half, value + half)
