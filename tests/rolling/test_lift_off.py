"""Lift-off of bodies drawn at random: none missed, none invented; and free flight until they touch again."""

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


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_disk_flies_and_lands(friction: float) -> None:
    """C falls freely from the lift-off on, and the disk turns with constant rate: z − e cos φ − a = 0."""
    e = 0.9
    body = RigidBody.from_principal(1.0, (0.045, 0.045, 0.09), center_of_mass=(0, -e, 0))
    upright = (0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0)
    law: Any = {"law": "dry", "friction": friction} if friction else {"law": "sliding", "friction": 0.0}
    contact = rolling.plane(rolling.disk(1.0), lift="fly", **law)
    t = np.linspace(0, 4, 401)
    found: Any = body.simulate(t, (0, 0, 30.0), upright, load=LOAD, contact=contact, rtol=2.3e-15)
    assert found.status == "landing"
    assert found.events.kind[-2:].tolist() == ["lift-off", "landing"]
    off, on = found.events.t[-2:]
    height, climb = found.events.position[-2][2], found.events.velocity[-2][2]
    rate = found.events.omega[-2][2]
    angle = np.arctan2(-climb / (e * rate), (height - 1) / e)

    def gap(time: float) -> float:
        z = height + climb * time - WEIGHT * time**2 / 2
        return float(z - e * np.cos(angle + rate * time) - 1)

    low, high = 0.01, 0.01
    while gap(high) > 0:
        high += 0.001
    while 0.5 * (low + high) not in (low, high):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if gap(middle) > 0 else (low, middle)
    assert on - off == pytest.approx(low, abs=1e-12)
    flies = (t > off) & (t < on)
    assert flies.sum() > 3
    assert set(found.contact.phase[flies]) == {"flying"}
    assert "flying" not in found.contact.phase[t < off]
    assert not found.contact.force[flies].any()
    assert not found.contact.power[flies].any()
    gaps = [gap(time) for time in t[flies] - off]
    assert np.max(np.abs(found.contact.residual[flies, 0] - gaps)) < 1e-12
    assert found.invariants().energy_drift < 1e-14
    assert np.isnan(found.omega[t > on]).all()


def test_bodies_of_every_kind_fly_under_every_law() -> None:
    rng = np.random.default_rng(3)
    landed = 0
    for number in range(12):
        body, surface, omega, attitude = draw(rng)
        law: Any = [{}, {"law": "dry", "friction": 0.3}, {"law": "sliding", "viscous": 0.2}][number % 3]
        contact = rolling.plane(surface, lift="fly", **law)
        try:
            found: Any = body.simulate(
                np.linspace(0, 3, 301), omega, attitude, load=LOAD, contact=contact, rtol=1e-14
            )
        except ContactError as error:
            assert "lies flat" in str(error)  # noqa: PT017
            continue
        there = ~np.isnan(found.omega[:, 0])
        assert found.contact.residual[there, 0].min() > -1e-13
        assert found.invariants().energy_drift < 1e-13
        if found.status == "landing":
            landed += 1
            assert found.events.kind[-1] == "landing"
            last = body.simulate(
                [0, found.events.t[-1]], omega, attitude, load=LOAD, contact=contact, rtol=1e-14
            )
            assert last.contact is not None
            assert abs(last.contact.residual[-1, 0]) < 1e-12 or np.isnan(last.omega[-1, 0])
    assert landed > 2
