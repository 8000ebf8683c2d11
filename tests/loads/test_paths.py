"""Orbits about oblate attractors and along samples, and what acts on a body there."""

from __future__ import annotations

import pickle
import re
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from polhode import RigidBody, loads, orbits
from polhode.errors import PolhodeError
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Callable

MU, J2, RADIUS = 1.0, 0.02, 0.8
POLE = np.array([0.3, -0.2, 0.9])
START = (np.array([1.1, 0.2, -0.1]), np.array([0.1, 0.8, 0.5]))
OBLATE = orbits.kepler(MU, *START, j2=J2, radius=RADIUS, pole=POLE)
BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
OMEGA = np.array([0.2, -0.1, 0.3])
T = np.linspace(0.0, 12.0, 7)


def omega_of(load: loads.Load, rtol: float = 1e-11, **options: Any) -> np.ndarray:
    """Give ω at the times."""
    found: np.ndarray = BODY.simulate(T, OMEGA, load=load, rtol=rtol, **options).omega
    return found


def potential(r: list[mpf]) -> mpf:
    """Give μ/r (1 − J₂ (R/r)² (3 s² − 1)/2)."""
    pole = [mpf(x) for x in POLE]
    distance = mpmath.norm(r)
    s = mpmath.fdot(r, pole) / distance / mpmath.norm(pole)
    return MU / distance * (1 - mpf(J2) * (mpf(RADIUS) / distance) ** 2 * (3 * s**2 - 1) / 2)


def gradient(r: list[mpf], h: mpf) -> list[mpf]:
    """Give the acceleration, by differences in many digits."""
    found = []
    for k in range(3):
        ends = [[x + sense * h if i == k else x for i, x in enumerate(r)] for sense in (1, -1)]
        found.append((potential(ends[0]) - potential(ends[1])) / (2 * h))
    return found


def test_the_orbit_solves_its_equation() -> None:
    def rates(_: float, y: np.ndarray) -> np.ndarray:
        with mp.workdps(40):
            pull = gradient([mpf(x) for x in y[:3]], mpf("1e-12"))
        return np.concatenate([y[3:], [float(x) for x in pull]])

    for end in (7.0, -5.0):
        run = solve_ivp(rates, (0.0, end), np.concatenate(START), "DOP853", rtol=1e-12, atol=1e-13)
        there = OBLATE.at(end)
        np.testing.assert_allclose(there.position, run.y[:3, -1], atol=1e-10)
        np.testing.assert_allclose(there.velocity, run.y[3:, -1], atol=1e-10)


@pytest.mark.parametrize("t", [0.0, 3.0])
def test_the_torque_is_that_on_particles(t: float) -> None:
    # A small body: six masses on its principal axes; forces to first order in their distances.
    attitude = Rotation.from_rotvec([0.4, -0.3, 0.8])
    second = 0.5 * (np.trace(BODY.inertia) - 2 * np.diag(BODY.inertia))
    total = np.zeros(3)
    with mp.workdps(60):
        place, size, h = [mpf(x) for x in OBLATE.at(t).position], mpf("1e-18"), mpf("1e-27")
        middle = gradient(place, h)
        for k in range(3):
            for sense in (1, -1):
                arm = sense * attitude.apply(np.eye(3)[k])
                there = gradient([a + size * mpf(b) for a, b in zip(place, arm, strict=True)], h)
                pull = [float((a - b) / size) for a, b in zip(there, middle, strict=True)]
                total += 0.5 * second[k] * np.cross(arm, pull)
    got = loads.gravity_gradient(OBLATE).torque(t, OMEGA, attitude, body=BODY, start=0.0)
    np.testing.assert_allclose(got, attitude.inv().apply(total), rtol=1e-11)


def test_without_bulge_it_is_the_kepler_orbit() -> None:
    both = orbits.kepler(MU, *START, j2=0.0, radius=RADIUS), orbits.kepler(MU, *START)
    np.testing.assert_allclose(both[0].at(T).position, both[1].at(T).position, rtol=1e-12)
    runs = [omega_of(loads.gravity_gradient(orbit)) for orbit in both]
    np.testing.assert_allclose(runs[0], runs[1], atol=1e-9)


def test_the_node_of_a_satellite_of_the_earth_drifts() -> None:
    # Sun-synchronous: 0.9856 degrees a day at 800 km and 98.6 degrees, to first order in J₂.
    mu, radius = 3.986004418e14, 6378137.0
    orbit = orbits.from_elements(
        mu,
        eccentricity=0.001,
        periapsis=radius + 8e5,
        inclination=np.radians(98.6),
        j2=1.08263e-3,
        radius=radius,
    )
    days = np.arange(11)
    normal = np.cross(*orbit.at(86400.0 * days))
    node = np.unwrap(np.arctan2(normal[:, 0], -normal[:, 1]))
    assert np.degrees(np.polyfit(days, node, 1)[0]) == pytest.approx(0.9856, rel=0.01)


def test_times_of_any_shape_and_stacks() -> None:
    stack = orbits.kepler(MU, *START, j2=[0.0, 0.01, 0.02], radius=RADIUS, pole=POLE)
    assert stack.shape == (3,)
    grid = np.linspace(-3.0, 4.0, 8).reshape(2, 4)
    there = stack.at(grid)
    assert there.position.shape == (3, 2, 4, 3)
    np.testing.assert_array_equal(there.position[2, 1, 2], OBLATE.at(grid[1, 2]).position)
    np.testing.assert_array_equal(there.velocity[2], OBLATE.at(grid).velocity)
    run = omega_of(loads.gravity_gradient(stack))
    np.testing.assert_array_equal(run[2], omega_of(loads.gravity_gradient(OBLATE)))


def table(count: int) -> orbits.SampledOrbit:
    """Give a Kepler orbit at so many times."""
    t = np.linspace(-1.0, 13.0, count)
    return orbits.sampled(MU, t, orbits.kepler(MU, *START, epoch=0.0).at(t).position)


def test_samples_come_to_the_orbit_with_the_fourth_power() -> None:
    exact = orbits.kepler(MU, *START, epoch=0.0)
    off = [np.abs(table(count).at(T).position - exact.at(T).position).max() for count in (402, 803, 1605)]
    assert off[0] < 1e-6
    assert off[0] / off[2] > 100.0
    plain = omega_of(loads.gravity_gradient(exact), rtol=1e-12)
    ends = [np.abs(omega_of(loads.gravity_gradient(table(count))) - plain).max() for count in (401, 801)]
    assert ends[0] < 1e-6
    assert ends[0] / ends[1] > 10.0


def test_a_sampled_orbit_serves_all_that_orbits_serve() -> None:
    orbit, exact = table(3001), orbits.kepler(MU, *START, epoch=0.0)
    np.testing.assert_allclose(orbit.frame(T).omega, exact.frame(T).omega, atol=1e-6)
    field = orbit.dipole_field((0, 0, 1)).at(T)
    np.testing.assert_allclose(field, exact.dipole_field((0, 0, 1)).at(T), atol=1e-8)
    makers: list[Callable[[Any], loads.Load]] = [
        loads.gravity_gradient,
        lambda path: loads.magnetic((0.1, 0, 0), path.dipole_field((0, 0, 1))),
        lambda path: loads.feedback(2.0, 1.0, path),
    ]
    for make in makers:
        got = [omega_of(make(path), method="dop853") for path in (orbit, exact)]
        np.testing.assert_allclose(got[0], got[1], atol=1e-5)
        again = pickle.loads(pickle.dumps(make(orbit)))
        np.testing.assert_array_equal(omega_of(again), got[0])


@pytest.mark.parametrize("name", ["oblate", "sampled"])
def test_the_frame_turns_as_it_says(name: str) -> None:
    # The plane turns: positions of the oblate orbit, as it is and in a table.
    t = np.linspace(-1.0, 13.0, 20001)
    orbit = OBLATE if name == "oblate" else orbits.sampled(MU, t, OBLATE.at(t).position)
    for at in (0.5, 3.0, 9.0):
        h = 1e-4
        before, after = (Rotation.from_quat(orbit.frame(at + step).quaternion) for step in (-h, h))
        seen = (before.inv() * after).as_rotvec() / (2 * h)
        np.testing.assert_allclose(orbit.frame(at).omega, seen, atol=1e-7 if name == "oblate" else 1e-5)
        assert abs(seen[2]) > 1e-3
    ball = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
    frame = orbit.frame(0.0)
    control = loads.feedback(200.0, 200.0, orbit)
    run = ball.simulate(T, frame.omega, frame.quaternion, load=control, rtol=1e-10)
    off = Rotation.from_quat(orbit.frame(T).quaternion).inv() * run.rotation
    assert off.magnitude().max() < 0.02


@pytest.mark.parametrize(("eccentricity", "far"), [(3.0, 1e5), (3.0, 1e8), (1.0, 1e8), (0.99999, 1e6)])
def test_far_out_and_back(eccentricity: float, far: float) -> None:
    arguments: Any = {"eccentricity": eccentricity, "periapsis": 1.0, "since_periapsis": -far}
    plain = orbits.from_elements(MU, **arguments)
    round_ = orbits.from_elements(MU, **arguments, j2=0.0, radius=0.9)
    for t in (0.3 * far, 0.99 * far, far, 2.0 * far):
        exact = plain.at(t)
        # The time from the periapsis is a difference, and with it the direction afterwards.
        loss = 1e-13 * far + 1e-16 * far**2
        np.testing.assert_allclose(round_.at(t).position, exact.position, rtol=1e-9, atol=loss)
    bulged = orbits.from_elements(MU, **arguments, j2=1e-3, radius=0.9)
    assert np.isfinite(bulged.at([far, 3.0 * far]).position).all()


def test_too_many_revolutions_are_refused() -> None:
    period = OBLATE.period
    assert np.isfinite(OBLATE.at([2.9e4 * period]).position).all()
    for make in (
        lambda: OBLATE.at(3.1e4 * period),
        lambda: OBLATE.frame(-3.1e4 * period),
        lambda: BODY.simulate([0.0, 3.1e4 * period], OMEGA, load=loads.gravity_gradient(OBLATE)),
    ):
        with pytest.raises(PolhodeError, match="at most 30 000 revolutions"):
            make()


def test_two_attractors_are_a_sum() -> None:
    far = orbits.kepler(5.0, (9.0, 0, 1.0), (0, 0.8, 0), epoch=0.0)
    pulls = [loads.gravity_gradient(orbit) for orbit in (orbits.kepler(MU, *START, epoch=0.0), far)]
    both = pulls[0] + pulls[1]
    parts = [load.torque(2.0, OMEGA, (0, 0, 0, 1), body=BODY) for load in (both, *pulls)]
    np.testing.assert_allclose(parts[0], parts[1] + parts[2], rtol=1e-14)
    np.testing.assert_allclose(omega_of(both), omega_of(both, method="dop853"), atol=1e-9)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: orbits.kepler(MU, *START, j2=0.1), TypeError, "j2 and radius: give both"),
        (lambda: orbits.kepler(MU, *START, radius=0.1), TypeError, "j2 and radius: give both"),
        (lambda: orbits.kepler(MU, *START, j2=np.nan, radius=1), PolhodeError, "j2 must be finite"),
        (
            lambda: orbits.kepler(MU, *START, j2=0.1, radius=0),
            PolhodeError,
            "radius must be positive, got 0.0",
        ),
        (lambda: orbits.kepler(MU, *START, j2=0.1, radius=1, pole=(0, 0, 0)), PolhodeError, "pole"),
        (lambda: orbits.sampled(0.0, [0, 1], np.ones((2, 3))), ValueError, "mu: must be positive, got 0.0"),
        (lambda: orbits.sampled(1.0, [0, 0], np.ones((2, 3))), PolhodeError, "t"),
        (lambda: orbits.sampled(1.0, [0, 1, 2], np.ones((2, 3))), ValueError, "each of the 3 times, got 2"),
        (lambda: orbits.sampled(1.0, [0], np.ones((1, 3))), PolhodeError, "at least 2"),
        (lambda: table(5).at(14.0), PolhodeError, "14"),
        (lambda: BODY.simulate([0, 14], OMEGA, load=loads.gravity_gradient(table(5))), PolhodeError, "14"),
        (
            lambda: omega_of(loads.gravity_gradient(OBLATE), method="taylor"),
            PolhodeError,
            "no orbit about an oblate attractor",
        ),
        (lambda: omega_of(loads.gravity_gradient(OBLATE), about="origin"), PolhodeError, "orbit"),
    ],
)
def test_what_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=re.escape(message)):
        make()
