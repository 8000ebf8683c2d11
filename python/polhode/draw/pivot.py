"""Picture of a body with a fixed point: the pivot, and the path of its axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory

    Floats = NDArray[np.float64]

__all__ = ["Pivot", "path_of", "pivot_of", "top_of"]

_GRAVITY: Final = "<Load: uniform_gravity>"
_ROUNDING: Final = 64.0 * float(np.finfo(np.float64).eps)
"""Radians that an attitude in degrees, or of rounded numbers, is off."""


@dataclass(frozen=True)
class Pivot:
    """A fixed point, and the curves of the motion about it.

    Attributes
    ----------
    axis : numpy.ndarray, shape (3,)
        Unit vector from the pivot toward the centre of mass, in the body frame.
    down : numpy.ndarray, shape (3,)
        Unit vector of gravity in space; -z where there is none.
    limits : tuple of float
        Of a heavy top the least and the greatest angle between the axis and the upward vertical.
    path : str
        Of a heavy top what its axis draws, see `path_of`.
    """

    axis: Floats
    down: Floats
    limits: tuple[float, ...]
    path: str


def top_of(trajectory: Trajectory) -> HeavyTop | None:
    """Return the heavy top in closed form that starts at the first state of a trajectory; else None."""
    if not trajectory.pivoted or repr(trajectory.load) != _GRAVITY or trajectory._varying() is not None:
        return None
    gravity = trajectory.force()[0] / trajectory.body.mass
    try:
        return trajectory.body.heavy_top(trajectory.omega[0], trajectory.quaternion[0], gravity)
    except (PolhodeError, ValueError):  # not symmetric about the line from the pivot to the centre of mass
        return None


def path_of(motion: HeavyTop) -> str:
    """Return the kind of path of a top's axis: ``HeavyTop.mode``, but ``steady`` if it nods by rounding.

    180 degrees are not a float in radians: a top that hangs straight down with them is off by 1e-16, and what
    it draws has cusps of that size.
    """
    least, greatest = motion.nutation_limits
    is_vertical = greatest <= _ROUNDING or np.pi - least <= _ROUNDING
    return "steady" if is_vertical else str(motion.mode)


def pivot_of(trajectory: Trajectory, motion: FreeMotion | HeavyTop | GyrostatMotion | None) -> Pivot | None:
    """Return the fixed point of a body and its curves; None for a body without one.

    Parameters
    ----------
    trajectory : Trajectory
        Of one body.
    motion : HeavyTop or other
        The closed form of the same motion, where there is one.
    """
    if not trajectory.pivoted:
        return None
    center = trajectory.body.center_of_mass
    arm = float(np.linalg.norm(center))
    axis = center / arm if arm > 0.0 else trajectory.body.principal_about("origin").axes[:, 2]
    limits: tuple[float, ...] = ()
    path, gravity = "", np.zeros(3)
    if isinstance(motion, _core.HeavyTop):
        gravity, path = motion.gravity, path_of(motion)
        limits = tuple(float(angle) for angle in motion.nutation_limits)
    size = float(np.linalg.norm(gravity))
    down = gravity / size if size > 0.0 else np.array([0.0, 0.0, -1.0])
    return Pivot(axis, down, limits, path)
