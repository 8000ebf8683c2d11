"""Dry friction: rolling and slipping in turn, against closed forms, energy and the law itself."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, Trajectory, loads, rolling, solids
from polhode.errors import ContactError

WEIGHT = 9.81
G = loads.uniform_gravity((0, 0, -WEIGHT))
UPRIGHT = (0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0)
"""The axis z of the body along y of space, its y upward."""


def dry(body: Any, surface: Any, t: Any, omega: Any, velocity: Any, friction: float, **given: Any) -> Any:
    plane = {name: given.pop(name) for name in ("normal", "point", "turntable") if name in given}
    contact = rolling.plane(surface, law="dry", friction=friction, **plane)
    options: Any = {"load": G, "contact": contact, "rtol": 2.3e-15} | given
    return body.simulate(t, omega, velocity=velocity, **options)


# Closed forms


@pytest.mark.parametrize(("moment", "radius"), [(0.4, 0.11), (2 / 3, 0.5), (0.4, 1.0)])
def test_a_ball_with_backspin(moment: float, radius: float) -> None:
    """Its slip s falls with (1 + m a²/I) μ g; then it rolls."""
    mu, mass = 0.2, 2.0
    ball = RigidBody.from_principal(mass, (moment * mass * radius**2,) * 3)
    omega, velocity = np.array([1.0, -20.0, 3.0]), np.array([3.0, 0.5, 0])
    slip = velocity + np.cross(omega, [0, 0, -radius])
    speed = np.linalg.norm(slip)
    end = speed / ((1 + 1 / moment) * mu * WEIGHT)
    t = np.linspace(0, 2 * end, 41)
    found = dry(ball, rolling.sphere(radius), t, omega, velocity, mu)
    assert found.status == "complete"
    assert found.events.kind.tolist() == ["roll"]
    assert found.events.t[0] == pytest.approx(end, abs=1e-13)
    last = velocity - mu * WEIGHT * end * slip / speed
    assert np.max(np.abs(found.velocity[t > end] - last)) < 1e-13
    assert np.max(np.abs(found.contact.slip[t > end])) < 1e-13
    apart = np.abs(t - end) > 1e-9
    phases = ["sliding" if one < end else "rolling" for one in t[apart]]
    assert found.contact.phase[apart].tolist() == phases
    kinetic = 0.5 * mass * (velocity @ velocity + moment * radius**2 * omega @ omega)
    rolled = 0.5 * mass * (last @ last * (1 + moment) + moment * radius**2 * omega[2] ** 2)
    assert found.contact.work[-1] == pytest.approx(rolled - kinetic, abs=1e-12 * kinetic)
    assert found.invariants().energy_drift < 1e-14


def test_a_hoop_that_comes_back() -> None:
    """t = s/(2 μ g), and it rolls with (v − a ω)/2."""
    mu, a = 0.3, 0.4
    hoop = RigidBody.from_principal(0.5, (0.25 * a * a, 0.25 * a * a, 0.5 * a * a))
    # About its axis, y of space: ω > 0 would roll along x.
    found = dry(hoop, rolling.disk(a), [0, 3], (0, 0, -30.0), (5.0, 0, 0), mu, attitude=UPRIGHT)
    assert found.events.kind.tolist() == ["roll"]
    assert found.events.t[0] == pytest.approx((5 + 30 * a) / (2 * mu * WEIGHT), abs=1e-13)
    assert found.velocity[-1] == pytest.approx([(5 - 30 * a) / 2, 0, 0], abs=1e-13)


def test_a_ball_on_an_incline_rolls_or_slips_from_rest() -> None:
    """It needs 2/7 tan α."""
    ball, sphere, angle = solids.sphere(0.3, mass=1.0), rolling.sphere(0.3), 0.8
    normal = (np.sin(angle), 0, np.cos(angle))
    needed = 2 / 7 * np.tan(angle)
    down = np.array([np.cos(angle), 0, -np.sin(angle)])
    found = dry(ball, sphere, [0, 1], (0, 0, 0), None, needed * 1.001, normal=normal)
    assert set(found.contact.phase) == {"rolling"}
    assert found.velocity[-1] == pytest.approx(5 / 7 * WEIGHT * np.sin(angle) * down, abs=1e-13)
    mu = needed * 0.5
    found = dry(ball, sphere, [0, 1], (0, 0, 0), None, mu, normal=normal)
    assert set(found.contact.phase) == {"sliding"}
    pull = WEIGHT * (np.sin(angle) - mu * np.cos(angle))
    assert found.velocity[-1] == pytest.approx(pull * down, abs=1e-13)
    with pytest.raises(ContactError, match=r"on the edge of the friction cone at t = 0\.0"):
        dry(ball, sphere, [0, 1], (0, 0, 0), None, needed, normal=normal)
    # Thrown up the slope with spin it slips, its slip ceases, and friction is not enough to roll.
    found = dry(ball, sphere, [0, 3], (0, 0, 0), -2 * down, mu, normal=normal)
    assert found.events.kind.tolist() == ["roll", "slip"]
    assert found.events.t[0] == found.events.t[1]
    fall = WEIGHT * (np.sin(angle) + 3.5 * mu * np.cos(angle))
    assert found.events.t[0] == pytest.approx(2 / fall, abs=1e-13)


# An eccentric disk in a plane


def eccentric_disk(mu: float) -> tuple[float, float]:
    """Return the angle and the time at which a disk that rolls from the top begins to slip, by energy."""
    a, e, moment, start = 1.0, 0.9, 0.09, 0.5

    def about(angle: float) -> float:
        return float(moment + a * a + e * e + 2 * a * e * np.cos(angle))

    energy = 0.5 * about(0.0) * start**2 + WEIGHT * e

    def rate(angle: float) -> float:
        return float(np.sqrt(2 * (energy - WEIGHT * e * np.cos(angle)) / about(angle)))

    def left(angle: float) -> float:
        w, sin, cos = rate(angle), np.sin(angle), np.cos(angle)
        turn = (WEIGHT * e * sin + a * e * sin * w * w) / about(angle)
        normal = WEIGHT - e * cos * w * w - e * sin * turn
        across = (a + e * cos) * turn - e * sin * w * w
        return float(mu * normal - abs(across))

    angles = np.linspace(0, 1.8, 1801)
    first = next(i for i, angle in enumerate(angles) if left(angle) < 0)
    low, high = float(angles[first - 1]), float(angles[first])
    while 0.5 * (low + high) not in (low, high):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if left(middle) > 0 else (low, middle)
    places, weights = np.polynomial.legendre.leggauss(200)
    return low, float(np.sum(weights * [0.5 * low / rate(0.5 * low * (x + 1)) for x in places]))


@pytest.mark.parametrize("mu", [0.15, 0.3, 0.6])
def test_an_eccentric_disk_slips_where_energy_says(mu: float) -> None:
    body = RigidBody.from_principal(1.0, (0.045, 0.045, 0.09), center_of_mass=(0, 0.9, 0))
    angle, time = eccentric_disk(mu)
    t = np.sort(np.array([0, time - 1e-9, time + 1e-9, 1.6]))
    found = dry(body, rolling.disk(1.0), t, (0, 0, 0.5), None, mu, attitude=UPRIGHT)
    assert found.events.kind[0] == "slip"
    assert found.events.t[0] == pytest.approx(time, abs=1e-13)
    assert found.events.position[0][2] == pytest.approx(1 + 0.9 * np.cos(angle), abs=1e-12)
    # The force does not jump, and the slip begins against it.
    before, after = found.contact.force[1], found.contact.force[2]
    assert np.max(np.abs(after - before)) < 1e-6
    later = dry(body, rolling.disk(1.0), [0, time + 0.01], (0, 0, 0.5), None, mu, attitude=UPRIGHT)
    assert later.contact.slip[-1][0] * before[0] < 0
    assert found.invariants().energy_drift < 1e-14 or found.status == "lift-off"


# The law itself, at many times


def draw(rng: np.random.Generator) -> tuple[RigidBody, Any, dict[str, Any], float]:
    """Draw a body of 1 kg, its start with or without slip, and a friction."""
    kind = rng.integers(3)
    surface: Any = (
        rolling.sphere(0.5)
        if kind == 0
        else rolling.ellipsoid(rng.uniform(0.4, 0.6, 3))
        if kind == 1
        else rolling.torus(0.4, 0.1)
    )
    center = rng.uniform(-0.1, 0.1, 3)
    body = RigidBody.from_principal(1.0, rng.uniform(0.08, 0.14, 3), center_of_mass=center)
    omega = rng.normal(0, 2.5, 3)
    attitude = rng.normal(size=4)
    if kind == 2:
        attitude = np.array([1.0, 0, 0, 1.0]) + rng.normal(0, 0.1, 4)
        omega[2] *= 2
    attitude /= np.linalg.norm(attitude)
    velocity = None
    if rng.random() < 0.5:
        at_rest = body.simulate(
            [0, 1e-9], omega, attitude, load=G, contact=rolling.plane(surface, lift="hold")
        )
        velocity = at_rest.velocity[0] + [*rng.normal(0, 1.0, 2), 0]
    return body, surface, {"omega": omega, "attitude": attitude, "velocity": velocity}, rng.uniform(0.05, 0.4)


def check_law(found: Trajectory, mu: float) -> tuple[int, int]:
    """Check friction at each output, and the events; count changes of the phase, and events."""
    there = ~np.isnan(found.omega[:, 0])
    assert found.contact is not None
    phase, needed = found.contact.phase[there], found.contact.friction_needed[there]
    slip = np.linalg.norm(found.contact.slip[there], axis=1)
    rolls = phase == "rolling"
    speed = 1 + np.linalg.norm(found.velocity[there], axis=1)
    assert np.all(needed[rolls] <= mu * (1 + 1e-12))
    assert np.all(slip[rolls] <= 1e-13 * speed[rolls])
    assert np.all(found.contact.normal_force[there] > -1e-11)
    slides = ~rolls & (slip > 1e-6)
    force = found.contact.force[there][slides]
    against = -force[:, :2] / np.linalg.norm(force[:, :2], axis=1)[:, None]
    along = found.contact.slip[there][slides][:, :2] / slip[slides][:, None]
    assert np.all(np.abs(against - along) < 1e-8)
    # Each change of the phase between two outputs has its event, and each event its reason.
    kinds = [kind for kind in found.events.kind if kind in ("slip", "roll")]
    now = "rolling" if phase[0] == "rolling" else "sliding"
    for kind in kinds:
        assert (kind == "roll") == (now == "sliding")
        now = "rolling" if kind == "roll" else "sliding"
    if there.all():
        assert phase[-1] == now
    assert found.invariants().energy_drift < 1e-11
    return int(np.sum(rolls[1:] != rolls[:-1])), len(kinds)


@pytest.mark.parametrize("count", [100, pytest.param(10_000, marks=pytest.mark.long)])
def test_no_change_is_missed_and_none_invented(count: int) -> None:
    rng = np.random.default_rng(47)
    changes = switches = 0
    for number in range(count):
        body, surface, start, mu = draw(rng)
        contact = rolling.plane(surface, law="dry", friction=mu)
        t = np.linspace(0, 1.5, 301)
        try:
            found: Trajectory = body.simulate(t, **start, load=G, contact=contact, rtol=1e-13)
        except ContactError as error:
            assert "lies flat" in str(error) or "no unique force" in str(error)  # noqa: PT017
            continue
        if found.status == "lift-off" and found.events.t[0] == 0.0:
            continue
        try:
            counts = check_law(found, mu)
        except AssertionError as error:
            error.add_note(f"number {number}")
            raise
        changes, switches = changes + counts[0], switches + counts[1]
    assert switches >= changes > count / 4


def test_a_slip_that_comes_back_to_zero_in_its_first_step() -> None:
    """Friction is not enough by 1e-6 of it for 10 ms."""
    center = (0.013779997827720186, -0.037391301762764936, -0.09626620941197171)
    moments = (0.09994014672445567, 0.13170182366921418, 0.11159178270778919)
    body = RigidBody.from_principal(1.0, moments, center_of_mass=center)
    omega = (-4.357952062912301, -4.01989513285972, -2.9108395017001234)
    attitude = (0.6367464327413791, 0.14053026247768702, -0.6180391960623745, 0.4391272911692632)
    mu, t = 0.1703245510777031, np.linspace(0, 1.5, 301)
    found = dry(body, rolling.sphere(0.5), t, omega, None, mu, attitude=attitude, rtol=1e-13)
    assert found.events.kind[:2].tolist() == ["slip", "roll"]
    assert found.events.t[:2] == pytest.approx([0.32972195, 0.34023532], abs=1e-8)
    check_law(found, mu)
    # The slip is so small that its time ends where it does for a motion that is cut into pieces.
    for rtol in (1e-10, 2.3e-15):
        other = dry(body, rolling.sphere(0.5), [0, 0.4], omega, None, mu, attitude=attitude, rtol=rtol)
        assert other.events.t[:2] == pytest.approx(found.events.t[:2], abs=1e-8)


@pytest.mark.parametrize("rtol", [1e-10, 1e-13, 2.3e-15])
def test_a_slip_whose_series_overflow_before_it_ceases(rtol: float) -> None:
    """A torus that is pressed hard: the slip loses its last 1e-13 in 1e-14 s."""
    center = (0.053855510250013006, 0.003821824195078233, -0.0615525204370802)
    moments = (0.12732310277563086, 0.1143076358042252, 0.10981698825526362)
    body = RigidBody.from_principal(1.0, moments, center_of_mass=center)
    omega = (-0.6214050915308232, -1.017192832613387, -0.30521964612967195)
    attitude = (0.7066639600854763, 0.08789109846451296, -0.10957023083358955, 0.6934663415351084)
    mu, t = 0.3741866348800028, np.linspace(0, 0.635, 128)
    found = dry(body, rolling.torus(0.4, 0.1), t, omega, None, mu, attitude=attitude, rtol=rtol)
    assert found.events.kind.tolist() == ["slip", "roll"]
    assert found.events.t == pytest.approx([0.49138432, 0.63466902], abs=1e-8)
    check_law(found, mu)


def test_dry_friction_does_not_depend_on_the_tolerance() -> None:
    rng = np.random.default_rng(7)
    for _ in range(10):
        body, surface, start, mu = draw(rng)
        contact = rolling.plane(surface, law="dry", friction=mu)
        tight, loose = (
            body.simulate([0, 0.3], **start, load=G, contact=contact, rtol=rtol) for rtol in (1e-14, 1e-10)
        )
        assert tight.events.kind.tolist() == loose.events.kind.tolist()
        assert np.allclose(tight.events.t, loose.events.t, rtol=0, atol=1e-7)
        if tight.status == "complete":
            assert np.allclose(tight.omega[-1], loose.omega[-1], rtol=0, atol=1e-7)


def test_dry_friction_goes_on_and_not_back() -> None:
    ball = solids.sphere(0.11, mass=7.0)
    given: tuple[Any, ...] = (rolling.sphere(0.11), [0, 1, 2], (0, 0, 0), (8.0, 0, 0), 0.4)
    found = dry(ball, *given)
    first = dry(ball, given[0], [0, 1], *given[2:])
    again = first.resume([1, 2], rtol=2.3e-15)
    assert again.contact.phase.tolist() == ["rolling", "rolling"]
    assert np.allclose(again.position[-1], found.position[-1], rtol=0, atol=1e-13)
    with pytest.raises(ContactError, match="times that rise"):
        dry(ball, given[0], [1, 0], *given[2:])


@pytest.mark.parametrize("rtol", [1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 2.3e-15])
def test_friction_that_is_only_just_enough_to_brake(rtol: float) -> None:
    """Of 2.5 m/s² two hundredths are left to brake, less than the errors of a step when the slip is small."""
    body = RigidBody(1.0, np.diag([0.1094, 0.1167, 0.095]), (-0.0699, 0.0417, 0.0561))
    attitude = np.array([0.7102, -0.1002, 0.0817, 0.692])
    contact = rolling.plane(rolling.torus(0.4, 0.1), law="dry", friction=0.2628)
    found = body.simulate(
        [0, 1.5], (-0.4562, 4.2494, 0.8843), attitude / np.linalg.norm(attitude), load=G, contact=contact,
        rtol=rtol, max_steps=2500,
    )  # fmt: skip
    assert found.status == "complete"
    assert found.events.kind.tolist() == ["slip", "roll", "slip"]
    exact = [1.26533433291030, 1.31306749, 1.39866647]
    assert np.abs(found.events.t - exact).max() < 1e-7 + 1e3 * rtol


@cache
def drawn(number: int) -> Any:
    """Return one of the bodies that `test_no_change_is_missed_and_none_invented` draws."""
    rng = np.random.default_rng(47)
    for _ in range(number):
        draw(rng)
    return draw(rng)


@pytest.mark.parametrize("rtol", [1e-10, 1e-13, 3e-14, 1e-14, 2.3e-15])
def test_a_slip_that_falls_too_fast_for_the_clock(rtol: float) -> None:
    """It falls by 120 m/s²: the last of it would be gone within the rounding of the time."""
    body, surface, start, mu = drawn(6924)
    contact = rolling.plane(surface, law="dry", friction=mu)
    found = body.simulate([0, 1.5], **start, load=G, contact=contact, rtol=rtol)
    assert found.status == "complete"
    assert found.events.kind.tolist() == ["roll", "slip", "roll", "slip", "roll"]
    exact = [0.05740471, 0.95579188, 1.07259607, 1.07596028, 1.43159563]
    assert np.abs(found.events.t - exact).max() < 1e-7
