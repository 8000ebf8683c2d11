"""Lift-off of bodies drawn at random: none missed, none invented, against a contact that holds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, Trajectory, loads, rolling
from polhode.errors import ContactError

WEIGHT = 9.81
LOAD = loads.uniform_gravity((0, 0, -WEIGHT))
END = 1.5
ALLOWED = 1e-12
"""Of the weight: less is rounding."""


def draw(rng: np.random.Generator) -> tuple[RigidBody, Any, Any, Any]:
    """Draw a body of 1 kg whose centre of mass is off that of its surface, and a fast start."""
    kind = rng.integers(4)
    axes = rng.uniform(0.4, 0.6, 3)
    surface: Any = (
        rolling.sphere(0.5)
        if kind == 0
        else rolling.ellipsoid(axes)
        if kind == 1
        else rolling.disk(0.5)
        if kind == 2
        else rolling.torus(0.4, 0.1)
    )
    moments = rng.uniform(0.08, 0.14, 3)
    center = rng.uniform(-0.2, 0.2, 3)
    body = RigidBody.from_principal(1.0, moments, center_of_mass=center)
    omega = rng.normal(0, 3.0, 3)
    if kind < 2:
        attitude = rng.normal(size=4)
    else:
        # Its axis is nearly level, and it spins about it.
        attitude = np.array([1.0, 0, 0, 1.0]) + rng.normal(0, 0.1, 4)
        omega[2] *= 2
    return body, surface, omega, attitude / np.linalg.norm(attitude)


def lowest(run: Any, end: float) -> float:
    """Return the smallest normal force up to a time, by samples that become denser about the lowest one."""
    low, high, least = 0.0, end, np.inf
    for _ in range(4):
        t = np.linspace(low, high, 200)
        force = run(np.unique([0.0, *t]))
        least = min(least, float(np.min(force)))
        best = int(np.argmin(force[-200:]))
        low, high = t[max(best - 1, 0)], t[min(best + 1, 199)]
    return least


@pytest.mark.parametrize("count", [200, pytest.param(10_000, marks=pytest.mark.long)])
def test_lift_off_is_not_missed_and_not_invented(count: int) -> None:
    rng = np.random.default_rng(47)
    lifted = rolled = 0
    for number in range(count):
        body, surface, omega, attitude = draw(rng)

        def run(t: Any, lift: Any = "hold", start: Any = (body, surface, omega, attitude)) -> Trajectory:
            body, surface, omega, attitude = start
            contact = rolling.plane(surface, lift=lift)
            found: Trajectory = body.simulate(t, omega, attitude, load=LOAD, contact=contact, rtol=1e-13)
            return found

        def force(t: Any, run: Any = run) -> Any:
            return run(t).contact.normal_force

        try:
            found = run([0.0, END], "stop")
            held = run([0.0, END])
        except ContactError as error:
            assert "lies flat" in str(error)  # noqa: PT017
            continue
        first = held.contact.normal_force[0] if held.contact is not None else np.nan
        if found.status == "complete":
            rolled += 1
            assert lowest(force, END) > -ALLOWED * WEIGHT, number
            continue
        lifted += 1
        assert found.status == "lift-off"
        time = float(found.events.t[-1])
        if time == 0.0:
            assert first < 0, number
            continue
        assert lowest(force, time) > -ALLOWED * WEIGHT, number
        # The force passes through zero there, from above.
        step = 1e-6
        before, at, after = force([0.0, time - step, time, time + step])[1:]
        assert before > 0 > after, number
        slope = (before - after) / (2 * step)
        assert abs(at) <= slope * time * 1e-12 + ALLOWED * WEIGHT, number
    assert min(lifted, rolled) > count / 10
