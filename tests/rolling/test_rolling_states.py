"""States and forces of bodies that roll or slip, against Newton's and Euler's equations in more digits."""

from __future__ import annotations

from typing import Any

import numpy as np
import polhode
import pytest
from mpmath import mp, mpf
from oracles.rolling import DIGITS, RollingBody, SlidingBody, cases, motion
from polhode import RigidBody, loads, rolling
from polhode._core import rotate

CASES = cases()
SIZE = 0.5
"""Of their surfaces, about."""


def surface_of(case: dict[str, Any]) -> rolling.Surface:
    given = dict(case["surface"])
    made: rolling.Surface = getattr(rolling, given.pop("kind"))(**given)
    return made


def run(case: dict[str, Any], t: Any = None, **changed: Any) -> polhode.Trajectory:
    """Simulate a case as tightly as doubles can, with small changes of the start."""
    case = case | changed
    body = RigidBody(case["mass"], inertia=case["inertia"], center_of_mass=case["center_of_mass"])
    kind, coefficient = case.get("friction", ("", 0.0))
    law: dict[str, Any] = {
        "": {},
        "coulomb": {"law": "sliding", "friction": coefficient},
        "normal": {"law": "sliding", "viscous": ("normal", coefficient)},
        "plain": {"law": "sliding", "viscous": coefficient},
    }[kind]
    contact = rolling.plane(
        surface_of(case),
        **law,
        normal=case["normal"],
        point=case["point"],
        turntable=case["turntable"],
        lift="hold",
    )
    attitude = np.array(case["attitude"])
    return body.simulate(
        [0.0, case["t"]] if t is None else t,
        case["omega"],
        attitude / np.linalg.norm(attitude),
        load=loads.uniform_gravity(case["gravity"]),
        contact=contact,
        velocity=case.get("velocity"),
        rtol=2.3e-15,
    )


def flat(found: polhode.Trajectory, index: int = -1) -> Any:
    """Return (q, ω in space, C) as the oracle has them, and the velocity of C of a body that slips."""
    quaternion = found.quaternion[index]
    omega = rotate(quaternion, found.omega[index])
    state = [quaternion, omega, found.position[index]]
    assert found.contact is not None
    if found.contact.phase[index] == "sliding":
        state.append(found.velocity[index])
    return np.concatenate(state)


def kept_on_the_plane(case: dict[str, Any], moved: dict[str, Any]) -> dict[str, Any]:
    """Return the case with small changes of the start, and a velocity that keeps its contact."""
    if "velocity" not in case:
        return case | moved
    with mp.workdps(DIGITS):
        body = SlidingBody(case | moved)
        velocity = [float(x) for x in body.velocity(body.start())]
    return case | moved | {"velocity": velocity}


def condition(case: dict[str, Any], end: Any, size: Any) -> float:
    """Estimate by how much the motion enlarges changes of its start, relative to sizes."""
    step, found = 1e-7, 0.0
    for name in ("omega", "attitude", *(["velocity"] if "velocity" in case else [])):
        for i in range(len(case[name])):
            moved = list(case[name])
            moved[i] += step
            near = flat(run(kept_on_the_plane(case, {name: moved})))
            found = max(found, float(np.max(np.abs(near - end) / size)) / step)
    return found


@pytest.mark.parametrize("number", range(len(CASES)))
def test_states_at_the_end_of_a_motion(number: int) -> None:
    case = CASES[number]
    exact = np.array([np.longdouble(x) for x in case["end"]])
    found = run(case)
    end = flat(found)
    sign = np.sign(np.sum(exact[:4] * end[:4]))
    exact = np.concatenate([sign * exact[:4], exact[4:]])
    speed = np.linalg.norm(np.array(exact[4:7], dtype=float))
    size = np.array([1.0] * 4 + [max(speed, 1.0)] * 3 + [1.0] * 3 + [max(speed, 1.0)] * (len(exact) - 10))
    error = np.max(np.abs(end - exact) / size)
    # A condition is at least zero: it is computed, by many motions, only where it decides.
    assert error <= 1e-13 or error <= 1e-13 * (1 + condition(case, end, size)), float(error)


@pytest.mark.parametrize("number", range(len(CASES)))
def test_forces_and_accelerations_of_states(number: int) -> None:
    """Each force is that of the equations in 30 digits at the same state."""
    case = CASES[number]
    found = run(case, np.linspace(0, case["t"], 4))
    assert found.contact is not None
    acceleration = rotate(found.quaternion, found.angular_acceleration())
    for index in (0, 3):
        with mp.workdps(DIGITS):
            state = [mpf(float(x)) for x in flat(found, index)]
            if len(state) > 10:
                rates, _, force = SlidingBody(case).solve_slipping(state[:10], state[10:])
                rates, velocity = [mpf(0)] * 4 + rates, state[10:]
            else:
                rates, force, velocity = RollingBody(case).solve(state)
        exact = np.array([float(x) for x in force])
        size = max(float(np.linalg.norm(exact)), case["mass"] * 9.81)
        assert np.max(np.abs(found.contact.force[index] - exact)) <= 1e-12 * size
        turn = np.array([float(x) for x in rates[4:7]])
        assert np.max(np.abs(acceleration[index] - turn)) <= 1e-11 * max(1.0, float(np.linalg.norm(turn)))
        exact_velocity = np.array([float(x) for x in velocity])
        assert np.max(np.abs(found.velocity[index] - exact_velocity)) <= 1e-13 * (
            1 + np.linalg.norm(found.omega[index])
        )


@pytest.mark.parametrize("number", range(len(CASES)))
def test_height_slip_and_energy(number: int) -> None:
    case = CASES[number]
    found = run(case, np.linspace(0, case["t"], 101))
    assert found.contact is not None
    # Rounding of the attitude moves the contact by the radius of curvature, which is large near lying flat.
    surface, normal = surface_of(case), np.array(case["normal"])
    in_body = rotate(found.quaternion, normal / np.linalg.norm(normal), inverse=True)
    radius = np.max(1 / surface.curvatures(in_body)[:, 0])
    # That of positions and velocities is relative to them: far away and on a fast turntable they are large.
    far = np.max(np.linalg.norm(found.position, axis=1)) / SIZE
    fast = np.max(np.linalg.norm(found.velocity, axis=1) / np.linalg.norm(found.omega, axis=1)) / SIZE
    assert np.max(np.abs(found.contact.residual)) <= 1e-14 * max(1.0, radius, far, fast)
    # Less the work of a turntable and of friction.
    assert found.invariants().energy_drift <= 1e-14


@pytest.mark.long
@pytest.mark.parametrize("number", [0, 6, 12, 18, 24])
def test_the_table_is_what_the_equations_give(number: int) -> None:
    case = CASES[number] | {"t": 0.5}
    exact = motion(case)
    end = flat(run(case))
    sign = np.sign(np.sum(exact[:4] * end[:4]))
    assert np.max(np.abs(end - np.concatenate([sign * exact[:4], exact[4:]]))) <= 1e-12
