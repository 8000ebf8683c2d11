"""Pictures of a body: its surface and its principal axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._hints import check_kind, with_hints
from polhode._optional import require
from polhode.draw.plot.axes import axes_3d, show_around, toward_viewer, translucent
from polhode.draw.style import AXIS_COLORS, OUTLINE_COLOR
from polhode.draw.triangles import subdivide, unit_normals

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import ArrayLike, NDArray

    from polhode import RigidBody

    Floats = NDArray[np.float64]

__all__ = ["body", "principal_axes"]

_SURFACE: Final = np.array([0.78, 0.83, 0.90])
_LIGHT: Final = np.array([0.30, -0.55, 0.78])
_FEATURE_ANGLE: Final = np.deg2rad(40.0)
_PIECES: Final = 24


@with_hints
def body(
    vertices: ArrayLike,
    faces: ArrayLike,
    ax: Axes3D | None = None,
    *,
    opacity: float = 1.0,
    length_label: str | None = None,
    colors: ArrayLike | None = None,
) -> Axes3D:
    """Draw a mesh as a shaded body with its edges.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Corners.
    faces : array_like, shape (m, 3)
        Triangles, counted from 0.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default.
    opacity : float
        Opacity of the surface, from 0 to 1.
    length_label : str, optional
        Word for the unit of the coordinates at their axes; without it the axes are not drawn. It converts no
        number.
    colors : array_like, shape (m, 3), optional
        Red, green and blue of each triangle, from 0 to 1; a pale blue by default.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    art3d: Any = require("mpl_toolkits.mplot3d.art3d", extra="plot", purpose="drawing")
    ax = axes_3d(ax)
    points = _core.real_numbers(vertices, "vertices")
    _core.real_numbers(faces, "faces")  # neither masked nor with a unit
    corners = np.asarray(faces, dtype=np.int64)
    size = max(float(np.ptp(points, axis=0).max()), float(np.finfo(float).tiny))
    normals = unit_normals(points[corners])
    pieces, owner = subdivide(points[corners], size / _PIECES)
    brightness = 0.66 + 0.42 * (normals @ (_LIGHT / np.linalg.norm(_LIGHT)))
    own = _SURFACE if colors is None else _core.real_numbers(colors, "colors")
    if own.shape not in ((3,), (len(corners), 3)):
        raise ValueError(f"colors: expected shape ({len(corners)}, 3), got {own.shape}")
    shades = np.clip(brightness[:, np.newaxis] * own, 0.0, 1.0)[owner]
    outline = _outline(points, corners, normals, size)
    # One collection for both, since matplotlib sorts by depth within a collection only: a piece of outline is
    # a triangle with two equal corners. Triangles edged in their own colour show no hairlines between them.
    surface = art3d.Poly3DCollection(
        np.concatenate([pieces, outline]),
        facecolors=np.concatenate([shades, np.tile(OUTLINE_COLOR, (len(outline), 1))]),
        edgecolors=np.concatenate([shades, np.tile(OUTLINE_COLOR, (len(outline), 1))]),
        linewidths=0.7,
    )
    translucent(surface, opacity)
    surface.set_zorder(2)

    def depth(z: Floats, axis: int) -> Floats:
        """Compute the depths of pieces; the outline is moved half a piece nearer, to lie on the surface."""
        middle: Floats = z.mean(axis=axis)
        middle[len(pieces) :] -= 0.5 * np.ptp(z, axis=axis).max()
        return middle

    # Matplotlib takes only the names of its own functions here. Should it cease to look at this attribute,
    # outlines would be broken lines, no more.
    surface._zsortfunc = depth
    ax.add_collection3d(surface)
    _frame(ax, points, length_label)
    return ax


def principal_axes(
    rigid_body: RigidBody,
    ax: Axes3D,
    *,
    length: float,
    center: ArrayLike | None = None,
    labels: tuple[str, str, str] = ("$e_1$", "$e_2$", "$e_3$"),
) -> Axes3D:
    """Draw the principal axes of one body through its centre of mass.

    Parameters
    ----------
    rigid_body : RigidBody
        One body.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D
        Where to draw.
    length : float
        Length from the centre to each tip.
    center : array_like, shape (3,), optional
        Where to draw the centre of mass; at its own position by default.
    labels : tuple of str
        Labels at the tips, in the order of ascending moments.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(ax, "ax", "Axes3D")
    check_kind(rigid_body, "rigid_body", "RigidBody")
    origin = _core.real_numbers(rigid_body.center_of_mass if center is None else center, "center")
    toward = toward_viewer(ax)
    for color, direction, label in zip(AXIS_COLORS, rigid_body.principal.axes.T, labels, strict=True):
        for sense in (1.0, -1.0):
            tip = origin + sense * length * direction
            # The half that points away from the viewer passes behind the body, the other one in front.
            order = 4 if sense * (direction @ toward) > 0.0 else 1
            half = np.stack([origin, tip], axis=-1)
            ax.plot(*half, color=color, linewidth=1.8 if sense > 0 else 1.0, zorder=order)
        name = origin + 1.14 * length * direction
        ax.text(*name, label, color=color, ha="center", va="center", fontsize=12, zorder=5)
    ax.scatter(*origin[:, np.newaxis], color="black", s=14, zorder=5, depthshade=False)
    return ax


def _outline(points: Floats, faces: NDArray[np.int64], normals: Floats, size: float) -> Floats:
    """Return the edges at which the surface turns sharply, as flat triangles slightly outside the surface."""
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    paired = np.flatnonzero((edges[:-1] == edges[1:]).all(axis=1))
    first, second = normals[owner[paired]], normals[owner[paired + 1]]
    sharp = np.einsum("ij,ij->i", first, second) < np.cos(_FEATURE_ANGLE)
    start, end = np.moveaxis(points[edges[paired[sharp]]], 1, 0)
    outward = (first + second)[sharp] * (0.003 * size)
    steps = np.linspace(0.0, 1.0, _PIECES + 1)[:, np.newaxis, np.newaxis]
    along = start + outward + steps * (end - start)
    segments: Floats = np.stack([along[:-1], along[1:], along[:-1]], axis=2).reshape(-1, 3, 3)
    return segments


def _frame(ax: Axes3D, points: Floats, length_label: str | None) -> None:
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = (low + high) / 2, (high - low).max() / 2 or 1.0
    show_around(ax, middle, half)
    ax.set_box_aspect((1.0, 1.0, 1.0))
    if length_label is None:
        ax.set_axis_off()
    else:
        for name in "xyz":
            getattr(ax, f"set_{name}label")(f"{name} ({length_label})")
