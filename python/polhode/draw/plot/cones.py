"""Picture of the body cone that rolls on the space cone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import _core
from polhode._hints import check_kind
from polhode.draw.plot.axes import arrow, axes_3d, azimuth_beside, fan, plain_frame, to_upright
from polhode.draw.sampling import drawn_times
from polhode.draw.shape import check_one
from polhode.draw.style import AXIS_COLORS, MOMENTUM_COLOR, OMEGA_COLOR
from polhode.motion.invariants import lengths

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D
    from numpy.typing import ArrayLike

    from polhode import FreeMotion

__all__ = ["cones"]


def cones(motion: FreeMotion, t: ArrayLike, ax: Axes3D | None = None) -> Axes3D:
    """Draw the body cone and the space cone of a free body: they touch along ω and roll on each other.

    Parameters
    ----------
    motion : FreeMotion
        Motion of one body.
    t : array_like, shape (T,)
        Times over which ω sweeps the space cone; further times are added in between where needed. The body
        cone is drawn in its position at the last time. For a body that is not symmetric the cones are not
        circular, and the space cone need not close.
    ax : mpl_toolkits.mplot3d.axes3d.Axes3D, optional
        Where to draw; a new figure by default. L is drawn upward.

    Returns
    -------
    mpl_toolkits.mplot3d.axes3d.Axes3D
    """
    check_kind(motion, "motion", "FreeMotion")
    check_one(motion.shape, "motion")
    momentum = motion.angular_momentum().spin
    size = float(lengths(momentum))
    if not size > 0.0:
        raise ValueError("motion: the body is at rest, and nothing rolls")
    ax = axes_3d(ax)
    times = drawn_times(motion, t)
    upright = to_upright(momentum / size)
    now = motion.at(times[-1:])
    attitude = upright @ _core.rotate(now.quaternion[0], np.eye(3)).T
    omega = attitude @ (now.omega[0] / np.linalg.norm(now.omega[0]))
    ax.view_init(elev=16.0, azim=azimuth_beside(omega))
    corners = [np.zeros(3), 1.3 * np.array([0.0, 0.0, 1.0])]
    in_space = motion.herpolhode(times)
    in_body = motion.polhode(361)
    for curve, turn, color in ((in_body, attitude, AXIS_COLORS[0]), (in_space, upright, AXIS_COLORS[2])):
        directions = curve / np.linalg.norm(curve, axis=-1, keepdims=True)
        rim = directions @ turn.T
        corners += [rim.min(axis=0), rim.max(axis=0)]
        fan(ax, rim, color, 0.22)
    side = motion.cones.axis
    symmetry = attitude @ motion.body.principal.axes[:, side]
    symmetry *= np.sign(symmetry @ omega) or 1.0
    arrows = [
        (1.25 * np.array([0.0, 0.0, 1.0]), MOMENTUM_COLOR, "L"),
        (1.2 * omega, OMEGA_COLOR, r"$\omega$"),
        (1.25 * symmetry, AXIS_COLORS[0], f"$e_{side + 1}$"),
    ]
    across = np.array([-np.sin(np.deg2rad(ax.azim)), np.cos(np.deg2rad(ax.azim)), 0.0])
    # From left to right, so that names of narrow cones stand beside each other.
    arrows.sort(key=lambda one: float(one[0] @ across))
    for (tip, color, name), ha in zip(arrows, ("right", "center", "left"), strict=True):
        arrow(ax, tip, color, name, ha=ha)
    ax.text2D(
        0.5, 0.02,
        f"body cone {_angles(motion.cones.body)} (blue),\nspace cone {_angles(motion.cones.space)} (green)",
        transform=ax.transAxes, ha="center", in_layout=False,
    )  # fmt: skip
    plain_frame(ax, np.min(corners, axis=0), np.max(corners, axis=0))
    return ax


def _angles(half_openings: np.ndarray) -> str:
    """Say half the opening in degrees, or between which two angles it is."""
    low, high = (f"{angle:.1f}°" for angle in np.rad2deg(half_openings))
    return low if low == high else f"{low} to {high}"
