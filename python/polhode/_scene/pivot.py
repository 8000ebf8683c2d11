"""What is drawn of a body with a fixed point: the pivot, and the way of its axis."""

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

__all__ = ["Pivot", "pivot_of", "top_of"]

_GRAVITY: Final = "<Load: uniform_gravity>"


@dataclass(frozen=True)
class Pivot:
    """A fixed point, and what is seen of the motion about it.

    Attributes
    ----------
    axis : numpy.ndarray, shape (3,)
        Unit vector from the pivot toward the centre of mass, in the body frame.
    down : numpy.ndarray, shape (3,)
        Unit vector of gravity in space; -z where there is none.
    weight : float
        ``m g l``: the weight times the distance of the centre of mass. Zero where no gravity acts.
    limits : tuple of float
        Of a heavy top the least and the greatest angle between the axis and the upward vertical.
    path : str
        Of a heavy top what its axis draws, ``HeavyTop.path``.
    """

    axis: Floats
    down: Floats
    weight: float
    limits: tuple[float, ...]
    path: str


def top_of(trajectory: Trajectory) -> HeavyTop | None:
    """Give the top in closed form from the first state of a trajectory on; None where it is no heavy top."""
    if not trajectory.pivoted or repr(trajectory.load) != _GRAVITY:
        return None
    gravity = trajectory.force()[0] / trajectory.body.mass
    try:
        return trajectory.body.heavy_top(trajectory.omega[0], trajectory.quaternion[0], gravity)
    except (PolhodeError, ValueError):  # not symmetric about the line from the pivot to the centre of mass
        return None


def pivot_of(trajectory: Trajectory, motion: FreeMotion | HeavyTop | GyrostatMotion | None) -> Pivot | None:
    """Find what is drawn of the fixed point of a body; None for a body without one.

    Parameters
    ----------
    trajectory : Trajectory
        Of one body.
    motion : HeavyTop or other
        The closed form of the same motion, where there is one.
    """
    if not trajectory.pivoted:
        return None
    center, mass = trajectory.body.center_of_mass, float(trajectory.body.mass)
    arm = float(np.linalg.norm(center))
    axis = center / arm if arm > 0.0 else trajectory.body.principal_about("origin").axes[:, 2]
    limits: tuple[float, ...] = ()
    path, gravity = "", np.zeros(3)
    if isinstance(motion, _core.HeavyTop):
        gravity, path = motion.gravity, str(motion.path)
        limits = tuple(float(angle) for angle in motion.nutation_limits)
    size = float(np.linalg.norm(gravity))
    down = gravity / size if size > 0.0 else np.array([0.0, 0.0, -1.0])
    return Pivot(axis, down, mass * size * arm, limits, path)
