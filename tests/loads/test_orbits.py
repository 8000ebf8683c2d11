"""Orbits and what acts along them: against integration, the conserved quantities, and textbook formulas."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.wheels import turned, turning
from polhode import RigidBody, _core, loads, orbits
from polhode.errors import PolhodeError
from scipy.integrate import solve_ivp

BODY = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5))
OMEGA = np.array([0.3, -0.2, 0.5])
ORBIT = orbits.kepler(1.0, (1.0, 0.2, -0.1), (0.1, 0.9, 0.3), epoch=0.4)
HYPERBOLA = orbits.from_elements(2.0, eccentricity=1.7, periapsis=0.8, inclination=0.3, anomaly=-1.0)


class TestOrbit:
    @pytest.mark.parametrize("orbit", [ORBIT, HYPERBOLA], ids=["ellipse", "hyperbola"])
    def test_integration_finds_the_same(self, orbit: orbits.Orbit) -> None:
        start, later = orbit.epoch or 0.0, np.array([0.0, 1.0, 4.0, 9.0])

        def rates(_: float, y: np.ndarray) -> np.ndarray:
            return np.concatenate([y[3:], -orbit.mu * y[:3] / np.linalg.norm(y[:3]) ** 3])

        run = solve_ivp(
            rates, (0, 9), [*orbit.position, *orbit.velocity], "DOP853", later, rtol=1e-13, atol=1e-13
        )
        r, v = orbit.at(start + later)
        assert np.abs(np.hstack([r, v]) - run.y.T).max() < 1e-10

    @given(
        eccentricity=st.floats(0.01, 3.0),
        periapsis=st.floats(0.1, 10.0),
        inclination=st.floats(0.05, 3.0),
        node=st.floats(-3.0, 3.0),
        argument=st.floats(-3.0, 3.0),
        part=st.floats(-0.9, 0.9),
        mu=st.floats(0.1, 10.0),
    )
    def test_elements_come_back(self, part: float, eccentricity: float, **given: Any) -> None:
        most = np.pi if eccentricity < 1.0 else np.arccos(-1.0 / eccentricity)
        orbit = orbits.from_elements(given.pop("mu"), eccentricity=eccentricity, anomaly=part * most, **given)
        found = orbit.elements
        assert found.eccentricity == pytest.approx(eccentricity, abs=1e-12)
        assert found.anomaly == pytest.approx(part * most, abs=1e-10)
        for name, value in given.items():
            assert getattr(found, name) == pytest.approx(value, rel=1e-10, abs=1e-10)

    def test_periods_of_any_size(self) -> None:
        for length, mu in [(1e-10, 1e-40), (7e6, 4e14), (1e20, 1e31), (1e-90, 1e-120), (1e90, 1e130)]:
            speed = np.sqrt(mu / length)
            period = orbits.kepler(mu, (length, 0, 0), (0, speed, 0)).period
            assert period == pytest.approx(2 * np.pi * length / speed, rel=1e-14)

    def test_degenerate_elements(self) -> None:
        circle = orbits.kepler(1.0, (0, 1, 0), (-1, 0, 0)).elements
        assert circle == pytest.approx((1.0, 0.0, 0.0, 0.0, 0.0, np.pi / 2), abs=1e-15)
        backward = orbits.kepler(1.0, (1, 0, 0), (0, -1, 0)).elements
        assert backward.inclination == pytest.approx(np.pi)

    def test_time_since_periapsis(self) -> None:
        comet = orbits.from_elements(1.0, eccentricity=1.0, periapsis=0.5, since_periapsis=3.0)
        assert np.allclose(
            comet.position, orbits.kepler(1.0, (0.5, 0, 0), (0, 2, 0)).at(3.0).position, atol=1e-14
        )
        long = orbits.from_elements(1.0, eccentricity=0.5, semi_major_axis=2.0)
        assert long.period == pytest.approx(2 * np.pi * 2.0**1.5, rel=1e-14)
        assert orbits.from_elements(1.0, eccentricity=1.0, periapsis=0.5).period == np.inf
        assert comet.period > 1e20  # its rounded state is not quite on a parabola
        assert HYPERBOLA.period == np.inf
        same = orbits.from_elements(
            2.0, eccentricity=1.7, semi_major_axis=0.8 / (1 - 1.7), inclination=0.3, anomaly=-1.0
        )
        assert np.allclose(same.position, HYPERBOLA.position, atol=1e-14)

    @pytest.mark.parametrize("orbit", [ORBIT, HYPERBOLA], ids=["ellipse", "hyperbola"])
    def test_the_local_frame(self, orbit: orbits.Orbit) -> None:
        t = np.array([0.5, 2.0, 7.0])
        frame, (r, v) = orbit.frame(t), orbit.at(t)
        for q, w, place, speed, time in zip(*frame, r, v, t, strict=True):
            x, y, z = turned(q).T
            assert np.allclose(z, -place / np.linalg.norm(place), atol=1e-14)
            assert np.allclose(
                y, -np.cross(place, speed) / np.linalg.norm(np.cross(place, speed)), atol=1e-14
            )
            assert x @ speed > 0
            h = 1e-5
            slope = (turned(orbit.frame(time + h).quaternion) - turned(orbit.frame(time - h).quaternion)) / (
                2 * h
            )
            spin = turned(q).T @ slope
            assert np.allclose([spin[2, 1], spin[0, 2], spin[1, 0]], w, atol=1e-8)

    def test_stacks_times_and_pickles(self) -> None:
        stack = orbits.kepler([1.0, 2.0], [(1.0, 0, 0), (2.0, 0, 0)], (0, 1.0, 0.1))
        times = np.linspace(0, 3, 6).reshape(2, 3)
        assert stack.shape == (2,)
        assert stack.at(times).position.shape == (2, 2, 3, 3)
        assert stack.dipole_field((0, 0, 1.0)).at(times).shape == (2, 2, 3, 3)
        one = orbits.kepler(2.0, (2.0, 0, 0), (0, 1.0, 0.1))
        assert np.array_equal(stack.frame(times).quaternion[1], one.frame(times).quaternion)
        assert np.array_equal(stack.period[1], one.period)
        assert np.array_equal(stack.elements.eccentricity[1], one.elements.eccentricity)
        again = pickle.loads(pickle.dumps(ORBIT))
        assert np.array_equal(again.at(times).velocity, ORBIT.at(times).velocity)

    def test_orbits_never_change(self) -> None:
        place = np.array([1.0, 0, 0])
        orbit = orbits.kepler(1.0, place, (0, 1, 0))
        place[:] = 9.0
        assert orbit.position.tolist() == [1.0, 0.0, 0.0]
        with pytest.raises(ValueError, match="read-only"):
            orbit.position[:] = 1.0

    @pytest.mark.parametrize(
        ("mu", "position", "velocity", "epoch", "message"),
        [
            (0.0, (1, 0, 0), (0, 1, 0), None, "mu must be more than zero"),
            (1.0, (1, 0, 0), (1, 0, 0), None, "radial orbit"),
            (1.0, (1, 0), (0, 1, 0), None, r"position: expected shape \(..., 3\)"),
            (1.0, (1, 0, np.nan), (0, 1, 0), None, "position: must be finite"),
            (1.0, (1, 0, 0), (0, 1, 0), np.inf, "epoch: must be finite"),
        ],
    )
    def test_states_that_are_refused(
        self, mu: float, position: Any, velocity: Any, epoch: Any, message: str
    ) -> None:
        with pytest.raises(ValueError, match=message):
            orbits.kepler(mu, position, velocity, epoch)

    @pytest.mark.parametrize(
        ("elements", "message"),
        [
            ({}, "exactly one of periapsis= and semi_major_axis="),
            ({"eccentricity": -0.1, "periapsis": 1}, "must not be negative"),
            ({"mu": -1.0, "periapsis": 1}, "mu: must be positive"),
            ({"eccentricity": 1.0, "semi_major_axis": 1}, "a parabola none"),
            ({"eccentricity": 1.5, "semi_major_axis": 1}, "negative semi_major_axis"),
            ({"eccentricity": 2.0, "periapsis": 1, "anomaly": 2.5}, "beyond the asymptote"),
            ({"periapsis": 1, "anomaly": 0.1, "since_periapsis": 1}, "not beside"),
            ({"periapsis": 1, "node": np.nan}, "node: must be finite"),
            ({"periapsis": [1, 2], "node": [1, 2, 3]}, r"shapes \[.*\(3,\).*\] do not broadcast"),
            (
                {"semi_major_axis": [1, 2], "eccentricity": [0.1] * 3},
                "semi_major_axis and eccentricity: shapes",
            ),
            ({"periapsis": [1, 2], "eccentricity": 2.0, "anomaly": [0.1, 2.5]}, "beyond the asymptote"),
        ],
    )
    def test_elements_that_are_refused(self, elements: Any, message: str) -> None:
        with pytest.raises(ValueError, match=message):
            orbits.from_elements(**{"mu": 1.0, "eccentricity": 0.1, **elements})


class TestGravityGradient:
    def test_an_orbit_is_its_numbers(self) -> None:
        by_orbit = loads.gravity_gradient(ORBIT)
        by_numbers = loads.gravity_gradient(1.0, ORBIT.position, ORBIT.velocity, 0.4)
        runs = [BODY.simulate([0, 1, 5], OMEGA, load=load).omega for load in (by_orbit, by_numbers)]
        assert np.array_equal(runs[0], runs[1])
        again = pickle.loads(pickle.dumps(by_orbit))
        assert np.array_equal(BODY.simulate([0, 1, 5], OMEGA, load=again).omega, runs[0])
        with pytest.raises(TypeError, match="give it alone"):
            loads.gravity_gradient(ORBIT, (1, 0, 0), (0, 1, 0))
        with pytest.raises(TypeError, match="give mu, position and velocity, or an orbit"):
            loads.gravity_gradient(1.0)

    def test_small_librations(self) -> None:
        """Pitch about the local frame: θ̈ = −3 n² (I₁ − I₃)/I₂ θ; roll and yaw coupled, by DeBra and Delp."""
        roll, pitch, yaw = 2.0, 2.2, 0.5
        body = RigidBody(1.0, np.diag([roll, pitch, yaw]))
        orbit = orbits.kepler(1.0, (1.0, 0, 0), (0, 1.0, 0))
        t, tilt = np.linspace(0, 40, 801), 1e-6
        frame = orbit.frame(t)
        start = _core.rotate(frame.quaternion[0], np.eye(3)).T
        assert np.allclose(start, turned(frame.quaternion[0]), atol=1e-15)

        def libration(axis: int) -> np.ndarray:
            half = np.zeros(4)
            half[axis], half[3] = 0.5 * tilt, 1.0
            q = _product(frame.quaternion[0], half / np.linalg.norm(half))
            omega = _core.rotate(half / np.linalg.norm(half), frame.omega[0], inverse=True)
            run = body.simulate(t, omega, q, load=loads.gravity_gradient(orbit), rtol=1e-14)
            pairs = zip(frame.quaternion * (-1, -1, -1, 1), run.quaternion, strict=True)
            errors = np.array([_product(f, q) for f, q in pairs])
            angles: np.ndarray = 2 * errors[:, :3] * np.sign(errors[:, 3:])
            return angles

        swing = libration(1)[:, 1]
        rate = np.sqrt(3 * (roll - yaw) / pitch)
        assert np.abs(swing - tilt * np.cos(rate * t)).max() < 1e-4 * tilt
        # q̈ + G q̇ + K q = 0 for roll and yaw; its frequencies are in the spectrum of what is simulated.
        k1, k3 = (pitch - yaw) / roll, (pitch - roll) / yaw
        squares = np.roots([1.0, -(1 + 3 * k1 + k1 * k3), 4 * k1 * k3])
        assert (squares > 0).all()
        both = libration(0)[:, [0, 2]]
        columns = np.hstack([f(np.outer(t, np.sqrt(squares))) for f in (np.cos, np.sin)])
        left = both - columns @ np.linalg.lstsq(columns, both, rcond=None)[0]
        assert np.abs(left).max() < 1e-4 * tilt


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Multiply quaternions (x, y, z, w)."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    product: np.ndarray = np.append(vector, a[3] * b[3] - a[:3] @ b[:3])
    return product


STRENGTH = np.array([0.05, -0.1, 0.4])
DIPOLE = np.array([0.2, 0.3, -0.1])
SAMPLES = np.linspace(-1.0, 7.0, 200)


def dipole(r: np.ndarray) -> np.ndarray:
    d = np.linalg.norm(r)
    field: np.ndarray = 3 * (STRENGTH @ r) * r / d**5 - STRENGTH / d**3
    return field


class TestMagnetic:
    @pytest.mark.parametrize("position", [(0.0, 0.0, 0.0), [(1.0, 0.0, 0.0), (0.0, 1e-200, 0.0)]])
    def test_the_centre_of_the_dipole(self, position: Any) -> None:
        with pytest.raises(ValueError, match="position: the field of a dipole is infinite at its centre"):
            _core.dipole_field((0.0, 0.0, 1.0), position)

    @pytest.mark.parametrize("gain", [None, 0.7])
    @pytest.mark.parametrize("source", ["uniform", "dipole", "sampled"])
    @pytest.mark.parametrize("method", ["auto", "dop853", "radau"])
    def test_against_scipy(self, source: str, gain: float | None, method: Any) -> None:
        orbit, constant = orbits.kepler(1.0, (1.0, 0.2, -0.1), (0.1, 0.9, 0.3)), np.array([0.3, 0.5, -0.2])
        field: Any = {
            "uniform": constant,
            "dipole": orbit.dipole_field(STRENGTH),
            "sampled": orbit.dipole_field(STRENGTH).at(SAMPLES),
        }[source]

        def rates(_: float, y: np.ndarray) -> np.ndarray:
            q, w, r, v = y[:4], y[4:7], y[7:10], y[10:]
            pull = -r / np.linalg.norm(r) ** 3
            here, h = (constant, 0.0) if source == "uniform" else (dipole(r), 1e-5)
            change = (dipole(r + h * v) - dipole(r - h * v)) / (2 * h) if h else 0.0 * r
            b, seen = turned(q).T @ here, turned(q).T @ change
            moment = DIPOLE - (gain or 0.0) * (seen - np.cross(w, b))
            spin = BODY.inertia @ w
            push = np.linalg.solve(BODY.inertia, np.cross(moment, b) - np.cross(w, spin))
            return np.concatenate([turning(q, w), push, v, pull])

        start = np.concatenate([[0, 0, 0, 1], OMEGA, orbit.position, orbit.velocity])
        exact = solve_ivp(rates, (0, 6), start, "DOP853", rtol=1e-12, atol=1e-13).y[:7, -1]
        times = SAMPLES if source == "sampled" else None
        load = loads.magnetic(DIPOLE, field, gain=gain, times=times)
        run = BODY.simulate([0, 6], OMEGA, load=load, method=method, rtol=1e-11)
        allowed = 2e-6 if source == "sampled" else 1e-8
        assert np.abs(run.omega[-1] - exact[4:]).max() < allowed
        assert np.abs(np.abs(run.quaternion[-1]) - np.abs(exact[:4])).max() < allowed

    def test_a_fixed_moment_in_a_uniform_field_has_a_potential(self) -> None:
        load = loads.magnetic(DIPOLE, (0.3, 0.5, -0.2))
        for about in ("center_of_mass", "origin"):
            run = BODY.simulate([0, 5, 50], OMEGA, load=load, about=about, rtol=1e-14)
            kept = run.invariants()
            assert kept.energy_drift < 1e-13
            assert kept.angular_momentum_drift < 1e-13
        fine = BODY.simulate([0, 5], OMEGA, load=load, method="taylor", rtol=1e-22)
        coarse = BODY.simulate([0, 5], OMEGA, load=load, method="splitting", rtol=1e-10)
        assert np.abs(fine.omega - coarse.omega).max() < 1e-8

    def test_derivatives_by_moment_and_field(self) -> None:
        field, step = np.array([0.3, 0.5, -0.2]), 1e-5
        slopes = BODY.simulate([0, 3], OMEGA, load=loads.magnetic(DIPOLE, field)).sensitivity().load[0]

        def omega(d: np.ndarray, b: np.ndarray) -> np.ndarray:
            end: np.ndarray = BODY.simulate([0, 3], OMEGA, load=loads.magnetic(d, b), rtol=1e-14).omega[-1]
            return end

        for k, unit in enumerate(step * np.eye(3)):
            by_dipole = (omega(DIPOLE + unit, field) - omega(DIPOLE - unit, field)) / (2 * step)
            by_field = (omega(DIPOLE, field + unit) - omega(DIPOLE, field - unit)) / (2 * step)
            assert np.allclose(slopes["dipole"][-1, 3:, k], by_dipole, atol=1e-8)
            assert np.allclose(slopes["field"][-1, 3:, k], by_field, atol=1e-8)
        other = BODY.simulate([0, 3], OMEGA, load=loads.magnetic(DIPOLE, field, gain=0.0))
        with pytest.raises(PolhodeError, match="no series from which derivatives come"):
            other.sensitivity()

    def test_a_stack_of_gains_is_not_by_series(self) -> None:
        gains = np.array([0.0, 0.3])
        run = BODY.simulate(
            [0, 3], OMEGA, load=loads.magnetic(DIPOLE, (0.3, 0.5, -0.2), gain=gains), rtol=1e-12
        )
        for k, gain in enumerate(gains):
            alone = BODY.simulate(
                [0, 3], OMEGA, load=loads.magnetic(DIPOLE, (0.3, 0.5, -0.2), gain=gain), rtol=1e-12
            )
            assert np.array_equal(run.omega[k], alone.omega)
        plain = BODY.simulate([0, 3], OMEGA, load=loads.magnetic(DIPOLE, (0.3, 0.5, -0.2)))
        assert np.abs(run.omega[0] - plain.omega).max() < 1e-9

    def test_b_dot_takes_energy_only(self) -> None:
        load = loads.magnetic((0, 0, 0), (0.3, 0.5, -0.2), gain=0.5)
        run = BODY.simulate(np.linspace(0, 200, 401), OMEGA, load=load)
        energy = run.kinetic_energy().total
        assert (np.diff(energy) < 1e-9).all()
        along = run.angular_momentum().total @ [0.3, 0.5, -0.2]  # which the torque is across
        assert np.abs(along - along[0]).max() < 1e-8

    def test_a_motion_goes_on_along_its_orbit(self) -> None:
        field = orbits.kepler(1.0, ORBIT.position, ORBIT.velocity).dipole_field(STRENGTH)
        load = loads.magnetic(DIPOLE, field, gain=0.1)
        whole = BODY.simulate([1, 3, 5], OMEGA, load=load, rtol=1e-12)
        half = BODY.simulate([1, 3], OMEGA, load=load, rtol=1e-12)
        assert np.abs(half.resume([3, 5], rtol=1e-12).omega[-1] - whole.omega[-1]).max() < 1e-10

    @pytest.mark.parametrize(
        ("given", "message"),
        [
            ({"dipole": (0, 0, np.nan)}, "dipole must be finite"),
            ({"field": (1, 0, np.inf)}, "field must be finite"),
            ({"gain": np.nan}, "gain must be finite"),
            ({"field": np.ones((3, 3)), "times": [0, 1]}, "one for each of the 2 times, got 3"),
            ({"field": np.ones((2, 3)), "times": [1, 0]}, "times must be strictly ascending"),
            ({"field": np.ones((1, 3)), "times": [1]}, "at least 2"),
        ],
    )
    def test_what_is_refused(self, given: Any, message: str) -> None:
        with pytest.raises(ValueError, match=message):
            loads.magnetic(**{"dipole": DIPOLE, "field": (1, 0, 0), **given})

    def test_what_cannot_be_simulated(self) -> None:
        field = ORBIT.dipole_field(STRENGTH)
        with pytest.raises(TypeError, match="not beside a field along an orbit"):
            loads.magnetic(DIPOLE, field, times=[0, 1])
        load = loads.magnetic(DIPOLE, field)
        with pytest.raises(PolhodeError, match="loads whose series is known"):
            BODY.simulate([0, 1], OMEGA, load=load, method="taylor")
        with pytest.raises(ValueError, match="origin is fixed"):
            BODY.simulate([0, 1], OMEGA, load=load, about="origin")
        sampled = loads.magnetic(DIPOLE, np.ones((2, 3)), times=[0, 1])
        with pytest.raises(ValueError, match="samples of the load are known from"):
            BODY.simulate([0, 1.5], OMEGA, load=sampled)
