"""Pictures of the heavy top: its effective potential, and the path of its axis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode._hints import check_kind, with_hints
from polhode.draw.plot.axes import (
    arrow,
    axes_2d,
    axes_3d,
    curve_on,
    plain_frame,
    solid_ellipsoid,
    tidy,
    to_upright,
)
from polhode.draw.sampling import axis_times, drawn_times
from polhode.draw.shape import check_one
from polhode.draw.style import AXIS_COLORS, MOMENTUM_COLOR, OMEGA_COLOR

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import ArrayLike, NDArray

    from polhode import HeavyTop

    Floats = NDArray[np.float64]

__all__ = ["effective_potential", "nutation"]

_SAMPLES = 721


@with_hints
def effective_potential(top: HeavyTop, ax: Axes | None = None, *, energy_label: str = "J") -> Axes:
    """Draw the effective potential V(θ) of a heavy top, and the constant ``I_t θ̇²/2 + V(θ)`` of its motion.

    Parameters
    ----------
    top : HeavyTop
        One top.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.
    energy_label : str
        Word for the unit of the body's energies at the axis; it converts no number.

    Returns
    -------
    matplotlib.axes.Axes
    """
    check_kind(top, "top", "HeavyTop")
    check_one(top.shape, "top")
    ax = axes_2d(ax)
    low, high = top.nutation_limits
    inclination = np.linspace(0.0, np.pi, _SAMPLES + 2)[1:-1]
    potential = top.effective_potential(inclination)
    level = float(top.effective_potential(high if high < np.pi else low))
    bottom = float(potential.min())
    # Above the level four times as much of the walls is shown as there is of the valley below it.
    room = 4.0 * (level - bottom)
    if room <= 1e-9 * abs(level):  # a steady precession, at the very bottom
        room = 0.1 * float(np.median(potential) - bottom)
    ax.plot(np.rad2deg(inclination), potential, color=AXIS_COLORS[0])
    ax.plot(
        np.rad2deg([low, high]),
        [level, level],
        color=AXIS_COLORS[1],
        linewidth=2.4,
        marker="|",
        markersize=10,
    )
    ax.annotate(
        f"nutation from {np.rad2deg(low):.2f}° to {np.rad2deg(high):.2f}°",
        (np.rad2deg(0.5 * (low + high)), level), (0.0, 12.0), textcoords="offset points", ha="center",
        color=AXIS_COLORS[1], bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.0},
    )  # fmt: skip
    ax.set_ylim(bottom - 0.2 * room, level + room)
    ax.set_xlabel("inclination (degrees)")
    ax.set_ylabel(f"effective potential ({energy_label})")
    tidy(ax)
    shown = np.rad2deg(inclination[potential <= level + room])
    ax.set_xlim(max(0.0, shown.min() - 2.0), min(180.0, shown.max() + 2.0))
    return ax


def nutation(top: HeavyTop, t: ArrayLike, ax: Axes3D | None = None) -> Axes3D:
    """Draw the path of the axis of a heavy top on the unit sphere, between its limits of inclination.

    Parameters
    ----------
    top : HeavyTop
        One top, whose centre of mass is not the fixed point.
    t : array_like, shape (T,)
        Times of the path; further times are added in between where needed. The axis is drawn in its position
        at the last time.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default. Upward in the picture is against gravity.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(top, "top", "HeavyTop")
    check_one(top.shape, "top")
    arm = float(np.linalg.norm(top.body.center_of_mass))
    weight = float(np.linalg.norm(top.gravity))
    if not arm > 0.0 or not weight > 0.0:
        raise ValueError(
            "top: without weight, or with its centre of mass at the fixed point, it does not nutate"
        )
    ax = axes_3d(ax)
    ax.view_init(elev=40.0, azim=-55.0)
    path = (
        top.at(drawn_times(top, t, axis_times)).point("center_of_mass")
        / arm
        @ to_upright(-top.gravity / weight).T
    )
    solid_ellipsoid(ax, np.ones(3), np.eye(3), np.zeros(3), 0.6)
    around = np.linspace(0.0, 2.0 * np.pi, 181)
    for limit in top.nutation_limits:
        circle = np.stack(
            [np.sin(limit) * np.cos(around), np.sin(limit) * np.sin(around), np.full(181, np.cos(limit))],
            axis=-1,
        )
        curve_on(ax, circle, circle, "0.35", linewidth=0.9, linestyle="--")
    curve_on(ax, path, path, AXIS_COLORS[1])
    arrow(ax, np.array([0.0, 0.0, 1.25]), MOMENTUM_COLOR, "up")
    arrow(ax, 1.12 * path[-1], OMEGA_COLOR, "axis")
    low, high = np.rad2deg(top.nutation_limits)
    ax.text2D(
        0.5, 0.02, f"path of the axis ({top.mode}):\n{low:.2f}° to {high:.2f}° from the vertical",
        transform=ax.transAxes, ha="center", in_layout=False,
    )  # fmt: skip
    plain_frame(ax, (-1.05, -1.05, -1.05), (1.05, 1.05, 1.25))
    return ax
