"""Orbits through samples with velocities, and the torque of an oblate attractor along them."""

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
from scipy.interpolate import BPoly, CubicHermiteSpline, KroghInterpolator
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Callable

EARTH, J2, RADIUS = 3.986004418e14, 1.08263e-3, 6378137.0
POLE = np.array([0.3, -0.2, 0.9])
GIVEN: Any = {"eccentricity": 0.3, "periapsis": 7.0e6, "inclination": 0.9, "node": 0.4, "epoch": 0.0}
ECCENTRIC = orbits.from_elements(EARTH, **GIVEN)
OBLATE = orbits.from_elements(EARTH, **GIVEN, j2=J2, radius=RADIUS, pole=POLE)
BODY = RigidBody.from_principal(4.0, (0.03, 0.05, 0.06))
OMEGA = np.array([0.002, -0.001, 0.003])
T = np.linspace(0.0, 5400.0, 7)


def table(step: float, orbit: Any = ECCENTRIC, **options: Any) -> orbits.SampledOrbit:
    """Give positions and velocities on an orbit."""
    t = np.arange(-600.0, 6000.0 + step, step)
    return orbits.sampled(EARTH, t, *orbit.at(t), **options)


def error(path: orbits.SampledOrbit, exact: Any = ECCENTRIC) -> tuple[float, float]:
    """Give the largest errors of position and velocity, in metres and seconds."""
    t = np.linspace(path.times[0], path.times[-1], 20_011)
    off = [np.linalg.norm(a - b, axis=-1).max() for a, b in zip(path.at(t), exact.at(t), strict=True)]
    return float(off[0]), float(off[1])


def accelerations(path: orbits.SampledOrbit) -> np.ndarray:
    """Give those of SciPy's quintics through each three neighbours."""
    assert path.velocity is not None
    last, found = len(path.times) - 1, []
    for k, t in enumerate(path.times):
        three = np.clip(k, 1, last - 1) + np.arange(-1, 2)
        values = np.stack([path.position[three], path.velocity[three]], axis=1).reshape(6, 3)
        found.append(KroghInterpolator(np.repeat(path.times[three] - t, 2), values).derivative(0.0, 2))
    return np.array(found)


class TestQuintics:
    def test_velocities_make_a_table_of_sixty_seconds_thousands_of_times_better(self) -> None:
        path = table(60.0)
        alone = orbits.sampled(EARTH, path.times, path.position)
        (place, speed), (place_alone, speed_alone) = error(path), error(alone)
        assert place < 1e-3
        assert place_alone / place > 1000.0
        assert speed_alone / speed > 500.0

    def test_the_error_falls_with_the_sixth_power(self) -> None:
        off = np.array([error(table(step)) for step in (240.0, 120.0, 60.0)])
        orders = np.log2(off[:-1] / off[1:])
        assert (orders[:, 0] > 5.7).all(), orders
        assert (orders[:, 0] < 6.5).all(), orders
        assert (orders[:, 1] > 4.7).all(), orders

    def test_the_samples_are_met_to_the_bit(self) -> None:
        path = table(60.0)
        there = path.at(path.times)
        np.testing.assert_array_equal(there.position, path.position)
        np.testing.assert_array_equal(there.velocity, path.velocity)

    @pytest.mark.parametrize("irregular", [False, True])
    def test_they_are_those_of_scipy(self, irregular: bool) -> None:
        t = np.arange(0.0, 6000.0, 60.0)
        if irregular:
            t = t + np.random.default_rng(3).uniform(-20.0, 20.0, t.size)
        path = orbits.sampled(EARTH, t, *ECCENTRIC.at(t))
        assert path.velocity is not None
        known = np.stack([path.position, path.velocity, accelerations(path)], axis=1)
        exact = BPoly.from_derivatives(t, list(known))
        fine = np.linspace(t[0], t[-1], 5003)
        for found, of in zip(path.at(fine), (exact, exact.derivative()), strict=True):
            size = np.linalg.norm(of(fine), axis=-1).max()
            assert np.abs(found - of(fine)).max() <= 1e-13 * size

    def test_two_samples_make_a_cubic(self) -> None:
        t = np.array([0.0, 60.0])
        there = ECCENTRIC.at(t)
        exact = CubicHermiteSpline(t, there.position, there.velocity)
        fine = np.linspace(0.0, 60.0, 101)
        np.testing.assert_allclose(
            orbits.sampled(EARTH, t, *there).at(fine).position, exact(fine), rtol=1e-14
        )

    @pytest.mark.parametrize("what", ["oblate", "moon"])
    def test_what_else_acts_does_not_matter(self, what: str) -> None:
        """Accelerations -mu r/r³ in place of the found ones would be off by metres, and by the whole pull."""
        t = np.arange(0.0, 6001.0, 60.0)
        fine = np.linspace(0.0, 6000.0, 5003)
        mu = EARTH

        def exact(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            if what == "oblate":
                return OBLATE.at(t)
            angle, rate = 2.6617e-6 * t, 2.6617e-6
            place = 3.844e8 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
            speed = 3.844e8 * rate * np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=-1)
            there = ECCENTRIC.at(t)
            return there.position - place, there.velocity - speed

        if what == "moon":
            mu = 4.9028e12
        place, speed = exact(t)
        pull = -mu * place / np.linalg.norm(place, axis=-1, keepdims=True) ** 3
        by_law = BPoly.from_derivatives(t, list(np.stack([place, speed, pull], axis=1)))
        off = np.abs(orbits.sampled(mu, t, place, speed).at(fine).position - exact(fine)[0]).max()
        assert off < 2e-3
        assert np.abs(by_law(fine) - exact(fine)[0]).max() > (0.5 if what == "oblate" else 500.0)


class TestAllThatOrbitsServe:
    def test_frame_and_field(self) -> None:
        path = table(30.0)
        t = np.linspace(0.0, 5000.0, 24).reshape(4, 6)
        np.testing.assert_allclose(path.frame(t).omega, ECCENTRIC.frame(t).omega, atol=1e-12)
        turn = Rotation.from_quat(path.frame(t).quaternion.reshape(-1, 4)).inv()
        off = (turn * Rotation.from_quat(ECCENTRIC.frame(t).quaternion.reshape(-1, 4))).magnitude()
        assert off.max() < 1e-10
        strength = (0, 0, -7.8e15)
        exact = ECCENTRIC.dipole_field(strength).at(t)
        np.testing.assert_allclose(path.dipole_field(strength).at(t), exact, rtol=1e-10, atol=1e-18)

    @pytest.mark.parametrize(
        "make",
        [
            loads.gravity_gradient,
            lambda path: loads.magnetic((0.1, 0, 0), path.dipole_field((0, 0, -7.8e15))),
            lambda path: loads.feedback(2e-4, 2e-3, path),
        ],
    )
    def test_loads_and_their_pickles(self, make: Callable[[Any], loads.Load]) -> None:
        path = table(30.0, OBLATE, j2=J2, radius=RADIUS, pole=POLE)
        again = pickle.loads(pickle.dumps((path, make(path))))
        found, of_path, of_load, exact = (
            BODY.simulate(T, OMEGA, load=load, method="dop853", rtol=1e-11).omega
            for load in (make(path), make(again[0]), again[1], make(OBLATE))
        )
        np.testing.assert_array_equal(of_path, found)
        np.testing.assert_array_equal(of_load, found)
        np.testing.assert_allclose(found, exact, atol=1e-8 * np.abs(exact).max())

    def test_relative_motion(self) -> None:
        path = table(30.0)
        run = BODY.simulate(T, OMEGA, load=loads.gravity_gradient(path), rtol=1e-11)
        found, exact = run.relative_to(path), run.relative_to(ECCENTRIC)
        np.testing.assert_allclose(found.omega, exact.omega, atol=1e-12)
        np.testing.assert_allclose(found.angles(), exact.angles(), atol=1e-9)

    def test_stacks_and_repr(self) -> None:
        t = np.arange(0.0, 6001.0, 60.0)
        both = [np.stack(pair) for pair in zip(ECCENTRIC.at(t), OBLATE.at(t), strict=True)]
        stack = orbits.sampled(EARTH, t, *both, j2=[0.0, J2], radius=RADIUS, pole=POLE)
        assert stack.shape == (2,)
        first = orbits.sampled(EARTH, t, *ECCENTRIC.at(t))
        np.testing.assert_array_equal(stack.at(31.0).position[0], first.at(31.0).position)
        runs = BODY.simulate(T, OMEGA, load=loads.gravity_gradient(stack), rtol=1e-10)
        alone = orbits.sampled(EARTH, t, *OBLATE.at(t), j2=J2, radius=RADIUS, pole=POLE)
        run = BODY.simulate(T, OMEGA, load=loads.gravity_gradient(alone), rtol=1e-10)
        np.testing.assert_array_equal(runs.omega[1], run.omega)
        assert "velocity=" in repr(alone)

    def test_derivatives_by_velocities(self) -> None:
        """A straight path at a constant velocity, all of whose samples are moved along."""
        t = np.linspace(0.0, 5.0, 6)
        start, speed = np.array([1.5, 0.3, -0.2]), np.array([-0.2, 0.3, 0.1])

        def run(change: float) -> Any:
            place, pace = start + t[:, None] * (speed + change), np.broadcast_to(speed + change, (6, 3))
            load = loads.gravity_gradient(orbits.sampled(1.0, t, place, pace))
            body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
            return body.simulate([0.0, 4.0], (0.2, -0.1, 0.3), load=load, rtol=1e-13)

        slopes = run(0.0).sensitivity("differences").load[0]
        assert {"mu", "position", "velocity"} <= set(slopes)
        h = 1e-4
        exact = (run(h).omega[-1] - run(-h).omega[-1]) / (2 * h)
        by_place = np.tensordot(slopes["position"][-1], np.broadcast_to(t[:, None], (6, 3)), 2)
        by_speed = np.tensordot(slopes["velocity"][-1], np.ones((6, 3)), 2)
        np.testing.assert_allclose((by_place + by_speed)[3:], exact, rtol=1e-5, atol=1e-7)


class TestTorqueOfTheBulge:
    """Against second derivatives of the potential, and forces on particles, in many digits."""

    ATTITUDE = Rotation.from_rotvec([0.4, -0.3, 0.8])

    @staticmethod
    def potential(r: list[mpf], j2: float) -> mpf:
        pole = [mpf(x) for x in POLE]
        distance = mpmath.norm(r)
        s = mpmath.fdot(r, pole) / distance / mpmath.norm(pole)
        return EARTH / distance * (1 - mpf(j2) * (mpf(RADIUS) / distance) ** 2 * (3 * s**2 - 1) / 2)

    def pull(self, r: list[mpf], j2: float, h: mpf) -> list[mpf]:
        found = []
        for k in range(3):
            ends = [[x + sense * h * (i == k) for i, x in enumerate(r)] for sense in (1, -1)]
            found.append((self.potential(ends[0], j2) - self.potential(ends[1], j2)) / (2 * h))
        return found

    def tensor(self, r: np.ndarray, j2: float) -> np.ndarray:
        """Give the second derivatives of the potential, by differences in sixty digits."""
        with mp.workdps(60):
            place, h = [mpf(float(x)) for x in r], mpf("1e-12")
            rows = []
            for k in range(3):
                ends = [[x + sense * h * (i == k) for i, x in enumerate(place)] for sense in (1, -1)]
                pulls = [self.pull(end, j2, mpf("1e-12")) for end in ends]
                rows.append([float((a - b) / (2 * h)) for a, b in zip(*pulls, strict=True)])
        return np.array(rows)

    def paths(self) -> dict[str, tuple[Any, float]]:
        t = np.arange(-600.0, 6001.0, 60.0)
        bulge: Any = {"j2": J2, "radius": RADIUS, "pole": POLE}
        return {
            "kepler": (ECCENTRIC, 0.0),
            "oblate": (OBLATE, J2),
            "positions": (orbits.sampled(EARTH, t, ECCENTRIC.at(t).position, **bulge), J2),
            "velocities": (orbits.sampled(EARTH, t, *OBLATE.at(t), **bulge), J2),
            "very flat": (orbits.sampled(EARTH, t, *OBLATE.at(t), **bulge | {"j2": 0.3}), 0.3),
            "prolate": (orbits.sampled(EARTH, t, *OBLATE.at(t), **bulge | {"j2": -0.1}), -0.1),
            "round": (orbits.sampled(EARTH, t, *OBLATE.at(t)), 0.0),
        }

    @pytest.mark.parametrize(
        "name", ["kepler", "oblate", "positions", "velocities", "very flat", "prolate", "round"]
    )
    @pytest.mark.parametrize("t", [0.0, 1234.5, 4000.0])
    def test_it_is_that_of_the_second_derivatives(self, name: str, t: float) -> None:
        path, j2 = self.paths()[name]
        turn = self.ATTITUDE.as_matrix()
        g = turn.T @ self.tensor(path.at(t).position, j2) @ turn
        second = 0.5 * np.trace(BODY.inertia) * np.eye(3) - BODY.inertia
        product = g @ second
        exact = np.array([product[k, j] - product[j, k] for j, k in ((1, 2), (2, 0), (0, 1))])
        got = loads.gravity_gradient(path).torque(t, OMEGA, self.ATTITUDE, body=BODY, start=0.0)
        assert np.linalg.norm(got - exact) <= 1e-12 * np.linalg.norm(exact)

    @pytest.mark.parametrize("name", ["oblate", "velocities", "very flat"])
    def test_it_is_that_on_a_dumbbell(self, name: str) -> None:
        path, j2 = self.paths()[name]
        arm = np.array([0.6, -0.48, 0.64])
        body = RigidBody.from_particles([0.5, 0.5], [arm, -arm])
        total = np.zeros(3)
        with mp.workdps(80):
            place, size, h = [mpf(float(x)) for x in path.at(1234.5).position], mpf("1e-16"), mpf("1e-24")
            away = self.ATTITUDE.apply(arm)
            for sense in (1, -1):
                there = [a + sense * size * mpf(float(b)) for a, b in zip(place, away, strict=True)]
                middle = self.pull(place, j2, h)
                force = [float((a - b) / size) for a, b in zip(self.pull(there, j2, h), middle, strict=True)]
                total += 0.5 * np.cross(sense * away, force)
        got = loads.gravity_gradient(path).torque(1234.5, OMEGA, self.ATTITUDE, body=body, start=0.0)
        exact = self.ATTITUDE.inv().apply(total)
        assert np.linalg.norm(got - exact) <= 1e-12 * np.linalg.norm(exact)

    def test_samples_of_the_oblate_orbit_have_its_motion(self) -> None:
        path = self.paths()["velocities"][0]
        runs = [
            BODY.simulate(T, OMEGA, load=loads.gravity_gradient(one), method="dop853", rtol=1e-12).omega
            for one in (path, OBLATE, orbits.sampled(EARTH, path.times, path.position, path.velocity))
        ]
        size = np.abs(runs[1]).max()
        assert np.abs(runs[0] - runs[1]).max() < 1e-9 * size
        assert np.abs(runs[2] - runs[1]).max() > 1e-5 * size  # without the torque of the bulge


STRAIGHT = np.linspace(0.0, 3.0, 4)[:, None] * np.array([1.0, 2.0, -0.5]) + 5.0
PACE = np.broadcast_to([1.0, 2.0, -0.5], (4, 3))


def straight(factor: float, **options: Any) -> orbits.SampledOrbit:
    """Give a straight path, with velocities times a factor."""
    return orbits.sampled(1.0, np.arange(4.0), STRAIGHT, factor * PACE, **options)


@pytest.mark.parametrize("factor", [0.501, 1.0, 1.999])
def test_velocities_that_agree_within_half_are_taken(factor: float) -> None:
    assert straight(factor).velocity is not None


@pytest.mark.parametrize("factor", [0.499, 2.001, -1.0, 0.0, 1e-3, 1e3, 86400.0])
def test_velocities_that_contradict_positions_are_refused(factor: float) -> None:
    with pytest.raises(
        PolhodeError, match=r"velocity: from row 0 to row 1 .* units of position per unit of t"
    ):
        straight(factor)


def test_kilometres_per_second_beside_metres_are_refused_with_their_row() -> None:
    t = np.arange(0.0, 601.0, 60.0)
    place, speed = ECCENTRIC.at(t)
    with pytest.raises(PolhodeError, match=r"velocity: from row \d to row \d+ the position moves by \["):
        orbits.sampled(EARTH, t, place, speed / 1000.0)
    speed[7] = 0.0
    with pytest.raises(PolhodeError, match=r"from row [67] to row [78] of orbit \(1,\)"):
        orbits.sampled(EARTH, t, np.stack([place, place]), np.stack([ECCENTRIC.at(t).velocity, speed]))


def test_few_samples_in_a_revolution() -> None:
    def circle(count: float) -> orbits.SampledOrbit:
        angle = np.arange(6) * 2 * np.pi / count
        zero = 0 * angle
        return orbits.sampled(
            1.0, angle, np.stack([np.cos(angle), np.sin(angle), zero], -1),
            np.stack([-np.sin(angle), np.cos(angle), zero], -1),
        )  # fmt: skip

    assert circle(2.4).velocity is not None
    with pytest.raises(PolhodeError, match="at times that are near enough"):
        circle(2.2)


def test_a_turning_point_and_rest_are_taken() -> None:
    t = np.linspace(-1.0, 1.0, 4)  # symmetric: the middle interval begins where it ends
    up = np.array([[0.0, 0.0, 1.0]])
    path = orbits.sampled(1.0, t, 3.0 * up[0] - t[:, None] ** 2 * up, -2.0 * t[:, None] * up)
    np.testing.assert_allclose(path.at(0.1).position, [0.0, 0.0, 2.99], rtol=1e-14)
    assert orbits.sampled(1.0, t, np.ones((4, 3)), np.zeros((4, 3))).at(0.0).velocity.tolist() == [0.0] * 3


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: orbits.sampled(1.0, [0, 1], np.ones((2, 3)), np.zeros((3, 3))),
            ValueError,
            "velocity: expected one for each position",
        ),
        (lambda: orbits.sampled(1.0, [0, 1], np.ones((2, 3)), np.zeros((2, 2))), ValueError, "velocity"),
        (lambda: straight(np.nan), ValueError, "velocity: must be finite"),
        (lambda: orbits.sampled(1.0, [0], np.ones((1, 3)), np.zeros((1, 3))), PolhodeError, "at least 2"),
        (lambda: straight(1.0).at(3.5), PolhodeError, "3.5"),
        (lambda: straight(1.0, j2=0.1), TypeError, "j2 and radius: give both"),
        (lambda: straight(1.0, radius=0.1), TypeError, "j2 and radius: give both"),
        (lambda: straight(1.0, j2=np.nan, radius=1.0), PolhodeError, "j2 must be finite"),
        (lambda: straight(1.0, j2=0.1, radius=0.0), PolhodeError, "radius must be positive, got 0.0"),
        (lambda: straight(1.0, j2=0.1, radius=1.0, pole=(0, 0, 0)), PolhodeError, "pole"),
        (lambda: straight(1.0, j2=[0.1, 0.2], radius=[1.0, 1.0, 1.0]), ValueError, "do not broadcast"),
    ],
)
def test_what_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=re.escape(message)):
        make()
