"""The arrays of a recorded motion, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._hints import check_kind
from polhode.errors import PolhodeError
from polhode.motion.rates import (
    angular_acceleration,
    angular_velocity,
    read_quaternions,
    read_times,
    read_vectors,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from polhode import _core
    from polhode._typing import SupportsQuaternion

__all__ = ["read_samples"]


def read_samples(
    body: _core.RigidBody,
    t: ArrayLike,
    attitude: ArrayLike | SupportsQuaternion,
    omega: ArrayLike | None,
    position: ArrayLike | None,
    velocity: ArrayLike | None,
    load: _core.Load | None,
    about: str,
    sequence: str | None,
) -> dict[str, Any]:
    """Return what a trajectory holds, by the names of its attributes."""
    if about not in ("center_of_mass", "origin"):
        raise ValueError(f"about: {about!r} is not 'center_of_mass' or 'origin'")
    check_kind(body, "body", "RigidBody")
    if load is not None:
        check_kind(load, "load", "Load")
    if body.shape:
        raise ValueError(
            f"body: a record is the motion of one body, got a stack of shape {body.shape}; take one: body[0]"
        )
    if load is not None and load.shape:
        raise ValueError(
            f"load: a record is of one body, got a stack of shape {load.shape}; take one: load[0]"
        )
    if load is not None and load.states:
        raise PolhodeError(
            f"load: the states {', '.join(load.states)} of it are in no record; give loads without states, "
            "such as loads.rotor(momentum) for a wheel of constant momentum"
        )
    times = read_times(t)
    known = read_quaternions(attitude, len(times), sequence)
    rates = angular_velocity(times, known)[0] if omega is None else read_vectors(omega, len(times), "omega")
    place, speed = np.zeros((2, len(times), 3))
    if position is not None:
        place = read_vectors(position, len(times), "position")
        speed = angular_acceleration(times, place)[0] if velocity is None else speed
    if velocity is not None:
        if position is None:
            raise ValueError("velocity: needs position= too, where the point is")
        speed = read_vectors(velocity, len(times), "velocity")
    return {
        "body": body,
        "t": times,
        "omega": rates,
        "quaternion": known,
        "position": place,
        "velocity": speed,
        "about": body.center_of_mass if about == "center_of_mass" else np.zeros(3),
        "steps": np.array(0),
        "evaluations": np.array(0),
        "load": load,
        "pivoted": about == "origin" and position is None,
        "carried": load.carried(times, rates, None) if load is not None and load.carries else None,
    }
