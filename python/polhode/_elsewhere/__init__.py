"""What the core hands over: calls whose arrays are not in memory. None, where they are read as others are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from polhode._core import MassAccumulator, RigidBody

__all__ = ["body_of_particles", "motion_at", "simulated", "summed"]


def body_of_particles(masses: Any, positions: Any) -> RigidBody | None:
    """Serve ``RigidBody.from_particles``."""
    total = summed(masses, positions, 0)
    return None if total is None else total.finish()


def summed(masses: Any, positions: Any, start: int) -> MassAccumulator | None:
    """Serve ``MassAccumulator.add``."""
    from polhode._elsewhere.particles import summed

    return summed(masses, positions, start)


def simulated(body: RigidBody, t: Any, omega: Any, attitude: Any, **options: Any) -> Any:
    """Serve ``RigidBody.simulate``."""
    from polhode._elsewhere.runs import simulated

    return simulated(body, t, omega, attitude, options)


def motion_at(motion: Any, t: Any) -> Any:
    """Serve ``at`` of motions in closed form."""
    from polhode._elsewhere.closed_forms import motion_at

    return motion_at(motion, t)
