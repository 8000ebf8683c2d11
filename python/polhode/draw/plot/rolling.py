"""Pictures of a body that rolls: on its plane with both traces of the contact, and the trace from above."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode._hints import check_kind, with_hints
from polhode._optional import require
from polhode.draw.ground import ground_of, surface_shape
from polhode.draw.plot.axes import (
    axes_2d,
    axes_3d,
    columns_that_fit,
    room,
    show_around,
    toward_viewer,
)
from polhode.draw.shape import longest
from polhode.draw.style import AXIS_COLORS, CONTACT_COLOR
from polhode.draw.triangles import unit_normals

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import NDArray

    from polhode import Trajectory
    from polhode.draw.ground import Ground
    from polhode.draw.shape import Shape

    Floats = NDArray[np.float64]

__all__ = ["contact", "draw_ground", "rolling"]


@with_hints
def rolling(
    trajectory: Trajectory, ax: Axes3D | None = None, *, index: int = -1, length_label: str = "m"
) -> Axes3D:
    """Draw a body that rolls on its plane, with the traces of the contact on the plane and on the body.

    Parameters
    ----------
    trajectory : Trajectory
        The motion of one body, simulated with ``contact=``. The times should be close enough for smooth
        curves: the body should turn by some 20 degrees at most from one to the next.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default.
    index : int
        At which of the times the body is drawn; the last by default. Traces are those up to this time. The
        trace on the far side of the body is faint. In flight nothing is traced.
    length_label : str
        Word for the unit of lengths; it converts no number. The picture says how long a cell of the grid on
        the plane is.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import loads, plot, rolling, solids
    >>> coin, tilted = solids.cylinder(0.01, 0.0, mass=0.005), (np.sin(0.5), 0, 0, np.cos(0.5))
    >>> motion = coin.simulate(
    ...     np.linspace(0, 1, 201), omega=(0, 5, 40), attitude=tilted,
    ...     load=loads.uniform_gravity((0, 0, -9.81)), contact=rolling.plane(rolling.disk(0.01)),
    ... )
    >>> ax = plot.rolling(motion)
    """
    ground, known = _ground(trajectory)
    if not -known <= operator.index(index) < known:
        raise IndexError(f"index: {index} is none of the {known} times at which the body rolls")
    k = index % known
    plane = trajectory._contact
    assert plane is not None
    shape = surface_shape(plane.surface, trajectory.body.center_of_mass)
    ax = axes_3d(ax)
    seen = np.concatenate([ground.contact[: k + 1], ground.center[k : k + 1]])
    low, high = seen.min(axis=0), seen.max(axis=0)
    size = longest(shape.vertices)
    middle = 0.5 * (low + high)
    middle = middle - ground.normal * (ground.normal @ (middle - ground.middle))
    half = float(0.5 * np.linalg.norm(high - low) + 1.2 * size)
    decade = 10.0 ** np.floor(np.log10(half / 4.0))
    cell = float(decade * max(part for part in (1.0, 2.0, 5.0) if part * decade <= half / 4.0))
    draw_ground(
        ax,
        ground,
        shape,
        trajectory.quaternion[k],
        k,
        float(trajectory.t[k]),
        (middle, 1.0 / half, 1.0),
        cell=cell / half,
    )
    words = f"a cell of the grid: {cell:g} {length_label}"
    ax.text2D(0.02, 0.98, words, transform=ax.transAxes, va="top", parse_math=False)
    show_around(ax, 0.3 * ground.normal, 0.8)
    ax.set_box_aspect((1.0, 1.0, 1.0), zoom=1.25)
    ax.set_axis_off()
    return ax


def draw_ground(
    ax: Any,
    ground: Ground,
    shape: Shape,
    quaternion: Floats,
    k: int,
    t: float,
    place: tuple[Floats, float, float],
    shift: Floats | float = 0.0,
    cell: float = 0.25,
) -> None:
    """Draw a plane with a grid, and on it the body at a sample and the traces up to it.

    Parameters
    ----------
    ax : Axes3D
        Where to draw.
    ground : Ground
        The plane and the contact at every sample.
    shape : Shape
        The body, from its centre of mass.
    quaternion : numpy.ndarray, shape (4,)
        The attitude.
    k : int
        Which sample it is.
    t : float
        Its time.
    place : tuple
        The point of the plane that is drawn at the origin; the factor of lengths; the half side of the part
        of the plane that is drawn, in the picture.
    shift : numpy.ndarray, shape (3,)
        By which everything is moved in the picture.
    cell : float
        Side of a cell of the grid, in the picture.
    """
    art3d: Any = require("mpl_toolkits.mplot3d.art3d", extra="plot", purpose="drawing")
    ax.computed_zorder = False  # else the plane, whose middle may be nearer, covers the body
    origin, scale, half = place
    view, to_space = toward_viewer(ax), _core.rotate(quaternion, np.eye(3)).T
    along, across = ground.axes(t)
    corners = [shift + half * (a * along + b * across) for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    ax.add_collection3d(
        art3d.Poly3DCollection([np.array(corners)], facecolors="#eef0f4", edgecolors="0.7", zorder=0)
    )
    offset = np.array([along, across]) @ (ground.middle - origin) * scale % cell
    lines = []
    for one, other, first in ((along, across, offset[0]), (across, along, offset[1])):
        at = np.arange(first - half, half, cell)
        at = at[at > -half]
        lines += [shift + np.array([x * one - half * other, x * one + half * other]) for x in at]
    ax.add_collection3d(art3d.Line3DCollection(lines, colors="0.82", linewidths=0.7, zorder=0.5))
    trace = (ground.contact[: k + 1] - origin) * scale
    is_near = (np.abs(trace @ np.array([along, across]).T) <= half * (1.0 + 1e-9)).all(axis=1)
    trace, touches = trace + shift, ground.touches[: k + 1]
    is_near &= touches
    ax.plot(*np.where(is_near[:, np.newaxis], trace, np.nan).T, color=CONTACT_COLOR, linewidth=1.6, zorder=1)
    center = (ground.center[k] - origin) * scale + shift
    triangles = (center + shape.vertices * scale @ to_space.T)[shape.faces]
    facing = unit_normals(triangles) @ view
    shown = facing > 0.0
    depth = np.argsort(triangles[shown].mean(axis=1) @ view)
    colors = (shape.colors / 255.0)[shown] * (0.62 + 0.38 * facing[shown, np.newaxis])
    body = art3d.Poly3DCollection(
        triangles[shown][depth], facecolors=colors[depth], edgecolors=colors[depth], zorder=2
    )
    body.set_sort_zpos(0.0)
    ax.add_collection3d(body)
    on_body = center + ground.in_body[: k + 1] * scale @ to_space.T
    near = ground.outward[: k + 1] @ to_space.T @ view >= 0.0
    for chosen, alpha in ((near & touches, 1.0), (~near & touches, 0.3)):
        wide = chosen | np.append(chosen[1:], False) | np.insert(chosen[:-1], 0, False)
        points = np.where((chosen | (wide & near & touches))[:, np.newaxis], on_body, np.nan)
        ax.plot(*points.T, color=CONTACT_COLOR, linewidth=1.8, alpha=alpha, zorder=3)
    if touches[k]:
        ax.plot(*trace[k : k + 1].T, "o", color=CONTACT_COLOR, markersize=5.0, zorder=4)


@with_hints
def contact(trajectory: Trajectory, ax: Axes | None = None, *, length_label: str = "m") -> Axes:
    """Draw the trace of the contact in the plane on which a body rolls, and the path of its centre of mass.

    Parameters
    ----------
    trajectory : Trajectory
        The motion of one body, simulated with ``contact=``.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default. The plane is seen from above.
    length_label : str
        Word for the unit of lengths; it converts no number.

    Returns
    -------
    matplotlib.axes.Axes

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import loads, plot, rolling, solids
    >>> ball, table = solids.sphere(0.02, mass=0.1), rolling.plane(rolling.sphere(0.02), turntable=3.0)
    >>> motion = ball.simulate(
    ...     np.linspace(0, 8, 201), omega=(0, 5, 0), load=loads.uniform_gravity((0, 0, -9.81)), contact=table
    ... )
    >>> ax = plot.contact(motion)
    """
    ground, known = _ground(trajectory)
    along = ground.axes(0.0)
    ax = axes_2d(ax)
    touched = (ground.contact[:known] - ground.middle) @ along.T
    touched = np.where(ground.touches[:known, np.newaxis], touched, np.nan)
    above = (ground.center[:known] - ground.middle) @ along.T
    ax.plot(*touched.T, color=CONTACT_COLOR, linewidth=1.6, label="contact")
    ax.plot(*above.T, color=AXIS_COLORS[0], linewidth=1.2, linestyle="--", label="centre of mass")
    ax.plot(*touched[0], "o", color=CONTACT_COLOR, markersize=5.0, label="start")
    is_level = bool(np.abs(along[:, 2]).max() == 0.0 and along[0, 0] == 1.0)
    for name, words in zip("xy", ("x", "y") if is_level else ("first", "second"), strict=True):
        getattr(ax, f"set_{name}label")(
            f"{words}{'' if is_level else ' direction of the plane'} ({length_label})"
        )
    ax.set_aspect("equal", adjustable="datalim")
    ax.grid(color="0.9", linewidth=0.6)
    ax.set_axisbelow(True)
    labels = [line.get_label() for line in ax.lines]
    columns = columns_that_fit(room(ax)[0], [str(label) for label in labels], 10.0, 3)
    ax.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=columns,
        frameon=False,
        fontsize=10.0,
        borderaxespad=0.3,
    )
    return ax


def _ground(trajectory: Trajectory) -> tuple[Ground, int]:
    """Return the plane of a motion, and at how many times the body rolls."""
    check_kind(trajectory, "trajectory", "Trajectory")
    trajectory._check_series("plot")
    if trajectory.omega.ndim != 2:
        raise ValueError(
            "trajectory: expected the motion of one body, got a stack of shape "
            f"{trajectory.omega.shape[:-2]}; simulate one of them"
        )
    ground = ground_of(trajectory)
    if ground is None:
        raise ValueError("trajectory: the body rolls on nothing; simulate it with contact=rolling.plane(...)")
    unknown = np.flatnonzero(~np.isfinite(ground.contact[:, 0]))
    return ground, int(unknown[0]) if len(unknown) else len(ground.contact)
