"""The phase portrait of a gyrostat: curves of equal energy on the sphere of its momentum in the body."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._hints import check_kind
from polhode._optional import require
from polhode.draw.plot.axes import (
    axes_3d,
    columns_that_fit,
    curve_on,
    matplotlib,
    plain_frame,
    room,
    solid_ellipsoid,
    toward_viewer,
)
from polhode.draw.sampling import once_round
from polhode.draw.shape import check_one
from polhode.draw.style import AXIS_COLORS, AXIS_DASHES, MOMENTUM_COLOR
from polhode.draw.surface import energy_level, separatrix

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import NDArray

    from polhode import Equilibria, Gyrostat, GyrostatMotion

    Floats = NDArray[np.float64]

__all__ = ["portrait", "portraits"]

_LOOKS: Final = {
    "minimum": (AXIS_COLORS[2], "o", "stable: least energy"),
    "maximum": (AXIS_COLORS[0], "^", "stable: most energy"),
    "saddle": (AXIS_COLORS[1], "X", "unstable"),
    "degenerate": ("0.15", "D", "where some meet"),
}
"""Colour, marker and words for each kind of equilibrium."""
_BETWEEN: Final = "0.35"
"""Curves that go round more than one equilibrium."""
_CELLS: Final = 160
"""Along an edge of each of the six sides of a cube on which curves are looked for."""


def portrait(
    gyrostat: Gyrostat | GyrostatMotion,
    momentum: float | None = None,
    ax: Axes3D | None = None,
    *,
    levels: int = 4,
    labels: bool = True,
) -> Axes3D:
    """Draw the paths of the total angular momentum L in the body, with all equilibria.

    The length of L = I ω + h is constant. In the body its tip therefore moves on a sphere, along a curve of
    constant energy. Curves around a minimum of the energy are green and dash-dotted, curves around a maximum
    are blue and dashed. Separatrices are solid vermilion lines, and curves between two of them are grey.
    Discs are minima, triangles maxima, crosses saddles. For a body with two equal moments, a thick line with
    a mark is a circle of equilibria.

    Parameters
    ----------
    gyrostat : Gyrostat or GyrostatMotion
        One gyrostat; or one motion. The path of a motion is drawn as a thick black line with its start.
    momentum : float, optional
        The length of L, for a gyrostat; for a motion it is known.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default.
    levels : int
        Number of curves between an extremum of the energy and the next saddle.
    labels : bool
        Whether to label the axes, h and the marks.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(gyrostat, "gyrostat", "Gyrostat", "GyrostatMotion")
    check_one(gyrostat.shape, "gyrostat")
    if levels < 0:
        raise ValueError(f"levels: {levels} is negative")
    inertia, inside, found, path = _read_gyrostat(gyrostat, momentum)
    new = ax is None
    ax = axes_3d(ax)
    if new:
        ax.view_init(elev=20.0, azim=35.0)
    points, kinds = np.asarray(found.direction), list(found.kind)
    solid_ellipsoid(ax, np.ones(3), np.eye(3), np.zeros(3), 1.0)
    energies = [float(energy_level(inertia, inside, n)) for n in points]
    saddles = [e for e, kind in zip(energies, kinds, strict=True) if kind == "saddle"]
    # Without a saddle every curve goes round both: the half of the way tells to which it is nearer.
    middle = [0.5 * (min(energies) + max(energies))]
    least, most = min(saddles or middle), max(saddles or middle)
    for level in _levels(energies, levels):
        color, dash = _BETWEEN, "-"
        if level > most:
            color, dash = AXIS_COLORS[0], AXIS_DASHES[0]
        elif level < least:
            color, dash = AXIS_COLORS[2], AXIS_DASHES[2]
        for curve in _curves(inertia, inside, level):
            curve_on(ax, curve, curve, color, linestyle=dash, linewidth=1.1)
    for n, kind in zip(points, kinds, strict=True):
        through = separatrix(inertia, inside, n) if kind == "saddle" else None
        if through is not None:
            curve_on(ax, through, through, AXIS_COLORS[1], linewidth=1.6)
    for n, axis, kind in zip(points, np.asarray(found.circle), kinds, strict=True):
        if np.any(axis):
            ring = _circle(n, axis)
            curve_on(ax, ring, ring, _LOOKS[kind][0], linewidth=2.4)
    _marks(ax, points, kinds, labels)
    if path is not None:
        _draw_path(ax, path)
    if labels:
        _names(ax, inside)
    plain_frame(ax, 3 * [-1.15], 3 * [1.15])
    ax.set_box_aspect((1.0, 1.0, 1.0), zoom=1.3)
    return ax


def portraits(
    gyrostat: Gyrostat,
    momentum: float,
    factors: Sequence[float] | None = None,
    *,
    levels: int = 3,
) -> NDArray[np.object_]:
    """Draw a row of portraits for growing momentum inside.

    Parameters
    ----------
    gyrostat : Gyrostat
        One gyrostat with momentum inside.
    momentum : float
        The length of L.
    factors : sequence of float, optional
        Factors by which the momentum inside is multiplied. By default there is one factor in each range of
        ``|h|`` with a constant number of equilibria.
    levels : int
        As in :func:`portrait`.

    Returns
    -------
    numpy.ndarray of mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(gyrostat, "gyrostat", "Gyrostat")
    check_one(gyrostat.shape, "gyrostat")
    size = float(np.linalg.norm(gyrostat.momentum))
    if not size > 0.0:
        raise ValueError("gyrostat: there is no momentum inside whose growth could be shown")
    if factors is None:
        changes = sorted({float(x) / size for x in gyrostat.equilibria(momentum).bifurcations.rotor})
        ends = [0.0, *changes, 1.6 * changes[-1]] if changes else [0.0, 2.0 * momentum / size]
        factors = [0.5 * (a + b) for a, b in itertools.pairwise(ends) if b - a > 0.02 * ends[-1]]
    figure, row = matplotlib("pyplot").subplots(
        1, len(factors), figsize=(3.6 * len(factors), 4.2), squeeze=False, layout="constrained",
        subplot_kw={"projection": "3d", "computed_zorder": False},
    )  # fmt: skip
    shown: set[str] = set()
    for ax, factor in zip(row[0], factors, strict=True):
        ax.view_init(elev=20.0, azim=35.0)
        one = gyrostat.body.gyrostat(factor * np.asarray(gyrostat.momentum))
        portrait(one, momentum, ax, levels=levels, labels=False)
        _names(ax, np.asarray(one.momentum) / momentum)
        kinds = list(one.equilibria(momentum).kind)
        shown.update(kinds)
        words = f"|h| = {factor * size / momentum:.3g} |L|: {len(kinds)} equilibria"
        ax.text2D(0.5, 0.02, words, transform=ax.transAxes, ha="center", fontsize=10)
    width = 72.0 * float(figure.get_figwidth())
    figure.legend(loc="outside lower center", **_legend([k for k in _LOOKS if k in shown], width))
    return np.asarray(row[0])


def _read_gyrostat(
    gyrostat: Gyrostat | GyrostatMotion, momentum: float | None
) -> tuple[Floats, Floats, Equilibria, Floats | None]:
    """Return the tensor, h/|L|, the equilibria and, of a motion, its path of L/|L| in the body."""
    if not isinstance(gyrostat, _core.GyrostatMotion):
        if momentum is None:
            raise ValueError("momentum: say how long L = I ω + h is; only a motion has one of its own")
        if not 0.0 < momentum < np.inf:
            raise ValueError(
                f"momentum: {momentum} is not positive and finite; it is the length of L = I ω + h"
            )
        inside = np.asarray(gyrostat.momentum, dtype=np.float64) / momentum
        return gyrostat.inertia, inside, gyrostat.equilibria(momentum), None
    motion = gyrostat
    if momentum is not None:
        raise ValueError(f"momentum: the motion has its own; leave {momentum:g} out, or pass motion.gyrostat")
    size = float(np.linalg.norm(motion.angular_momentum().spin))
    if not size > 0.0:
        raise ValueError(
            "gyrostat: the angular momentum of this motion is zero; it has no direction in the body"
        )
    inertia = motion.gyrostat.inertia
    path = (motion.at(once_round(motion)).omega @ inertia + motion.rotor) / size
    return inertia, motion.rotor / size, motion.equilibria(), path


def _draw_path(ax: Axes3D, path: Floats) -> None:
    if len(path) > 1:
        curve_on(ax, 1.002 * path, path, MOMENTUM_COLOR, linewidth=2.6, zorder=5)
    order = 8 if path[0] @ toward_viewer(ax) >= 0.0 else 3
    style = {"linestyle": "none", "marker": "o", "markersize": 5.0, "zorder": order}
    ax.plot(*(1.005 * path[0])[:, np.newaxis], color=MOMENTUM_COLOR, **style)


def _levels(stationary: list[float], count: int) -> list[float]:
    """Return energies between the stationary ones, denser near the extrema, where curves grow as the root."""
    distinct = sorted(set(stationary))
    if len(distinct) < 2:
        return []
    span = distinct[-1] - distinct[0]
    levels = []
    for i, (low, high) in enumerate(itertools.pairwise(distinct)):
        if high - low < 1e-9 * span:
            continue
        part = np.sqrt((high - low) / span)
        many = int(np.ceil(count * (0.5 + part))) if part > 0.1 else min(count, 1)
        s = np.arange(1, many + 1) / (many + 1)
        first, last = i == 0, i == len(distinct) - 2
        if first and last:
            s = np.sin(0.5 * np.pi * s) ** 2
        elif first:
            s = s**2
        elif last:
            s = 1.0 - (1.0 - s) ** 2
        levels += list(low + (high - low) * s)
    return levels


def _curves(inertia: Floats, inside: Floats, level: float) -> Iterator[Floats]:
    """Return the curve of one energy on the unit sphere, in pieces that end at the edges of a cube."""
    contourpy: Any = require("contourpy", extra="plot", purpose="drawing")
    edge = np.linspace(-0.25 * np.pi, 0.25 * np.pi, _CELLS + 1)
    for axis in range(3):
        for sign in (1.0, -1.0):

            def onto(a: Floats, b: Floats, axis: int = axis, sign: float = sign) -> Floats:
                n = np.empty((*np.shape(a), 3))
                n[..., axis], n[..., axis - 2], n[..., axis - 1] = sign, np.tan(a), np.tan(b)
                unit: Floats = n / np.linalg.norm(n, axis=-1, keepdims=True)
                return unit

            a, b = np.meshgrid(edge, edge)
            values = energy_level(inertia, inside, onto(a, b))
            for line in contourpy.contour_generator(a, b, values).lines(level):
                yield onto(line[:, 0], line[:, 1])


def _circle(n: Floats, axis: Floats) -> Floats:
    """Return the circle about an axis through a point of the unit sphere."""
    height = float(n @ axis)
    across = n - height * axis
    turn = np.linspace(0.0, 2.0 * np.pi, 181)[:, np.newaxis]
    circle: Floats = height * axis + np.cos(turn) * across + np.sin(turn) * np.cross(axis, across)
    return circle


def _marks(ax: Axes3D, points: Floats, kinds: list[str], labels: bool) -> None:
    """Mark the equilibria, faintly those on the far side, with a legend for the kinds that there are."""
    viewer = toward_viewer(ax)
    for n, kind in zip(points, kinds, strict=True):
        color, marker, _ = _LOOKS[kind]
        near = n @ viewer >= 0.0
        ax.plot(
            *(1.005 * n)[:, np.newaxis], linestyle="none", marker=marker, markersize=8.0 if near else 6.0,
            color=color, markeredgecolor="white", markeredgewidth=0.8, alpha=1.0 if near else 0.35,
            zorder=7 if near else 3,
        )  # fmt: skip
    if labels:
        legend = ax.legend(loc="lower center", **_legend([k for k in _LOOKS if k in kinds], room(ax)[0]))
        legend.set_in_layout(False)


def _legend(kinds: list[str], width: float) -> dict[str, Any]:
    """Return the entries of a legend of marks, in as many columns as this width (in points) allows."""
    columns = columns_that_fit(width, [_LOOKS[kind][2] for kind in kinds], 9.0, len(kinds))
    return {
        "handles": [_mark(kind) for kind in kinds],
        "ncols": columns,
        "frameon": False,
        "fontsize": 9,
        "columnspacing": 1.2,
    }


def _mark(kind: str) -> Any:
    color, marker, words = _LOOKS[kind]
    return matplotlib("lines").Line2D(
        [], [], linestyle="none", marker=marker, color=color, markersize=8, label=words
    )


def _names(ax: Axes3D, inside: Floats) -> None:
    """Name the axes of the body, and the direction of h."""
    viewer = toward_viewer(ax)
    to_the_right = np.array([-np.sin(np.deg2rad(ax.azim)), np.cos(np.deg2rad(ax.azim)), 0.0])
    size = np.linalg.norm(inside)
    unit = inside / size if size > 0.0 else np.zeros(3)
    meets = unit > 0.97  # h stands at the end of this axis: one text has both names
    for k, name in enumerate("xyz"):
        axis = np.zeros(3)
        axis[k] = 1.0
        order = 5 if axis @ viewer >= 0.0 else 1
        ax.plot(*np.stack([axis, 1.2 * axis], axis=-1), color="0.25", linewidth=1.2, zorder=order)
        words, side, beyond = f"$L_{name}$", "center", 1.36
        if meets[k]:  # beyond the line of h, which is thicker and longer than that of an axis
            words, beyond, across = f"$L_{name}$, $h$", 1.44, float(axis @ to_the_right)
            side = "left" if across > 0.3 else "right" if across < -0.3 else "center"
        faint = 1.0 if axis @ viewer >= -0.2 else 0.4
        ax.text(
            *(beyond * axis), words, color="0.15", ha=side, va="center", fontsize=11, zorder=8, alpha=faint
        )
    if size > 0.0:
        order = 6 if unit @ viewer >= 0.0 else 1
        ax.plot(*np.stack([unit, 1.3 * unit], axis=-1), color="0.0", linewidth=2.4, zorder=order)
        ax.plot(*unit[:, np.newaxis], linestyle="none", marker="o", markersize=3.5, color="0.0", zorder=order)
        if not meets.any():
            # Beside its line where that points at the viewer.
            beside = 0.2 * to_the_right * max(0.0, float(unit @ viewer))
            ax.text(
                *(1.42 * unit + beside), "$h$", color="0.0", ha="center", va="center", fontsize=12, zorder=8
            )
