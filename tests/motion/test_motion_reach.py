"""How far in time, and in units, motions in closed form reach: right, or refused with the law."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from oracles.jacobi import JacobiMotion
from oracles.lagrange import LagrangeTop
from oracles.motion_cases import angle, relative_error, unit_floats
from polhode import RigidBody, loads, orbits
from polhode.errors import PolhodeError

MOMENTS, OMEGA = (1.0, 2.0, 2.5), (0.3, 0.2, 1.1)
ATTITUDE = unit_floats(0.1, -0.5, 0.3, 0.8)
NEAR = (1.0, 0.2, np.sqrt(0.8) * (1 + 1e-9))
G = (0.0, 0.0, -4.0)
TOP = RigidBody.from_principal(1.0, (0.75, 0.75, 0.5), center_of_mass=(0.0, 0.0, 0.5))
LEAN = (np.sin(0.5), 0.0, 0.0, np.cos(0.5))


def free(omega: Any = OMEGA) -> Any:
    return RigidBody.from_principal(1.0, MOMENTS).free_motion(omega, ATTITUDE)


def reach_of(motion: Any) -> float:
    with pytest.raises(PolhodeError, match="beyond the reach of this motion") as caught:
        motion.at([1.0, 1e100, 2.0])
    message = str(caught.value)
    assert "t = 1e100" in message
    assert "2^88 turns" in message
    return float(message.split("<= ")[1].split(":")[0])


@pytest.mark.parametrize("omega", [OMEGA, NEAR, (1.3, 0.2, 0.1), (0.0, 0.0, 2.0)], ids=str)
def test_times_beyond_the_reach_are_refused(omega: Any) -> None:
    motion = free(omega)
    reach = reach_of(motion)
    turns = reach * np.nanmax(motion.periods.rates) / (2 * np.pi)
    assert 2.0**87 < turns < 2.0**90
    assert np.isfinite(motion.at([reach * 0.999, -reach * 0.999]).omega).all()
    for t in (reach * 1.001, -reach * 1.001):
        for ask in (motion.at, motion.herpolhode, motion.poinsot, motion.sensitivity):
            with pytest.raises(PolhodeError, match="beyond the reach"):
                ask(t)
        assert motion.error_bar(t) == (np.inf, np.inf)
    assert np.isnan(motion.at([np.nan, np.inf]).omega).all()
    bars = motion.error_bar(np.concatenate([[0.0], np.logspace(-300, 308, 609)]), rtol=0.0)
    assert not np.isnan(bars).any()
    assert motion.error_bar(reach * 0.999, rtol=0.0).attitude > 1.5
    bars = motion.error_bar(np.logspace(-300, 308, 609))
    assert not np.isnan(bars).any()


def test_the_row_and_the_time_are_named() -> None:
    motions = free([OMEGA, (3e5, 2e5, 11e5)])
    with pytest.raises(PolhodeError, match=r"row 1: t = -1e22 is beyond"):
        motions.at([0.0, -1e22])


@pytest.mark.parametrize("omega", [OMEGA, NEAR])
@pytest.mark.parametrize("t", [1e15, 1e18, 1e20, 1e23, 1e26])
def test_the_error_bar_covers_the_error_at_any_time(omega: Any, t: float) -> None:
    motion = free(omega)
    exact_omega, exact_attitude = JacobiMotion(MOMENTS, omega, ATTITUDE, digits=90).at(t)
    found, bar = motion.at(t), motion.error_bar(t, rtol=0.0)
    assert angle(found.quaternion, exact_attitude) <= 1e-14 + bar.attitude
    assert relative_error(found.omega, exact_omega) <= 1e-14 + bar.omega / np.linalg.norm(omega)


@pytest.mark.parametrize("omega", [OMEGA, NEAR])
@pytest.mark.parametrize("t", [30.0, 1e6, 1e12, 1e20])
def test_derivatives_near_the_separatrix_and_far_away(omega: Any, t: float) -> None:
    motion = free(omega)
    slopes = motion.sensitivity(t)
    with mp.workdps(120):
        step = mpf(10) ** -45
        for k in range(3):

            def moved(sign: int, k: int = k) -> Any:
                start = [mpf(float(x)) for x in omega]
                start[k] += sign * step
                return mpmath.matrix(JacobiMotion(MOMENTS, start, ATTITUDE, digits=90).at(t)[0])

            slope = (moved(1) - moved(-1)) / (2 * step)
            found = slopes.state[3:, 3 + k]
            assert relative_error(found, list(slope), at_least=1.0) <= 1e-10, k


def test_exact_runs_refuse_what_is_out_of_reach() -> None:
    body = RigidBody.from_principal(1.0, MOMENTS)
    with pytest.raises(PolhodeError, match="beyond the reach"):
        body.simulate([0.0, 1e100], OMEGA, method="exact")
    with pytest.raises(PolhodeError, match="beyond the reach"):
        TOP.simulate(
            [0.0, 1e100], (1.0, 0.5, 4.0), LEAN, load=loads.uniform_gravity(G), about="origin", method="exact"
        )


def test_tops() -> None:
    motion = TOP.heavy_top((1.0, 0.5, 4.0), LEAN, gravity=G)
    reach = reach_of(motion)
    assert np.isfinite(motion.at([reach * 0.999]).omega).all()
    exact = LagrangeTop(1.0, (0.75, 0.75, 0.5), 0.5, (1.0, 0.5, 4.0), LEAN, 4.0, digits=110)
    for t in (1e15, 1e18):
        omega, attitude = exact.at(t)
        found = motion.at(t)
        assert angle(found.quaternion, attitude) <= 1e-14 + t * 1e-27
        assert relative_error(found.omega, omega) <= 1e-14 + t * 1e-27


SCALES = [1e-300, 1e-200, 1e-154, 1e-100, 1e100, 1e154, 1e200, 1e300]
TURN = np.array([[0.6, -0.64, 0.48], [0.8, 0.48, -0.36], [0.0, 0.6, 0.8]])
TURN_BACK = TURN.T


@pytest.mark.parametrize("inertia", [1.0, *SCALES])
@pytest.mark.parametrize("rate", [1.0, *SCALES])
@pytest.mark.parametrize("form", ["principal", "tensor"])
def test_units_of_any_size(inertia: float, rate: float, form: str) -> None:
    """Powers of two near these sizes: the same digits in any units."""
    inertia, rate = 2.0 ** np.round(np.log2([inertia, rate]))
    tensor = TURN @ np.diag(MOMENTS) @ TURN_BACK
    tensor = (tensor + tensor.T) / 2

    def made(inertia: float, rate: float) -> Any:
        if form == "tensor":
            body = RigidBody(1.0, tensor * inertia)
        else:
            body = RigidBody.from_principal(1.0, np.array(MOMENTS) * inertia)
        return body.free_motion(np.array(OMEGA) * rate, ATTITUDE)

    usual, motion = made(1.0, 1.0), made(inertia, rate)
    times = np.array([0.3, 7.0, 1e4])
    same, found = usual.at(times), motion.at(times / rate)
    np.testing.assert_allclose(found.quaternion, same.quaternion, atol=1e-14)
    np.testing.assert_allclose(found.omega / rate, same.omega, atol=1e-14)
    np.testing.assert_allclose(motion.periods.rates / rate, usual.periods.rates, rtol=1e-14)
    assert motion.periods.rotation * rate == pytest.approx(usual.periods.rotation, rel=1e-14)
    assert motion.energy_ratio == pytest.approx(usual.energy_ratio, rel=1e-14)
    assert motion.complementary_modulus == pytest.approx(usual.complementary_modulus, rel=1e-14)
    np.testing.assert_allclose(motion.nutation, usual.nutation, atol=1e-14)
    bar, usual_bar = motion.error_bar(7.0 / rate), usual.error_bar(7.0)
    assert bar.attitude == pytest.approx(usual_bar.attitude, rel=1e-10)
    # A length below the normal numbers has fewer digits.
    assert bar.omega / rate == pytest.approx(usual_bar.omega, rel=1e-6)
    plane, usual_plane = motion.poinsot(0.0), usual.poinsot(0.0)
    np.testing.assert_allclose(plane.normal, usual_plane.normal, atol=1e-15)
    np.testing.assert_allclose(plane.semi_axes / rate, usual_plane.semi_axes, rtol=1e-14)
    with np.errstate(over="ignore", under="ignore"):
        size = inertia * rate
        assert not np.isnan(motion.angular_momentum().spin).any()
        if 1e-290 < size < 1e290:
            np.testing.assert_allclose(
                motion.angular_momentum().spin / size, usual.angular_momentum().spin, rtol=1e-14
            )
        assert not np.isnan(motion.kinetic_energy().total)
        square = np.square(rate)
        if 1e-290 < square < 1e290:
            np.testing.assert_allclose(motion.stability() / square, usual.stability(), rtol=1e-13)


@pytest.mark.parametrize("length", [1e-140, 1e-100, 1.0, 1e100, 1e140])
@pytest.mark.parametrize("mass", [1e-200, 1.0, 1e200])
@pytest.mark.parametrize("rate", [1e-100, 1.0, 1e100])
def test_tops_in_units_of_any_size(length: float, mass: float, rate: float) -> None:
    length, mass, rate = (float(x) for x in 2.0 ** np.round(np.log2([length, mass, rate])))
    inertia, weight = mass * length * length, length * rate * rate
    if not all(1e-290 < x < 1e290 for x in (inertia, weight, inertia * rate * rate)):
        return
    usual = TOP.heavy_top((1.0, 0.5, 4.0), LEAN, gravity=G)
    moments = np.array((0.75, 0.75, 0.5)) * inertia
    body = RigidBody.from_principal(mass, moments, center_of_mass=(0.0, 0.0, 0.5 * length))
    motion = body.heavy_top(np.array((1.0, 0.5, 4.0)) * rate, LEAN, gravity=np.array(G) * weight)
    times = np.array([0.3, 7.0, 1e4])
    same, found = usual.at(times), motion.at(times / rate)
    np.testing.assert_allclose(found.quaternion, same.quaternion, atol=1e-14)
    np.testing.assert_allclose(found.omega / rate, same.omega, atol=1e-13)
    assert motion.mode == usual.mode
    np.testing.assert_allclose(motion.nutation_limits, usual.nutation_limits, atol=1e-14)
    assert motion.nutation_period * rate == pytest.approx(usual.nutation_period, rel=1e-14)
    assert motion.mean_precession / rate == pytest.approx(usual.mean_precession, rel=1e-13)
    assert motion.sleeping_limit / rate == pytest.approx(usual.sleeping_limit, rel=1e-14)


@pytest.mark.parametrize("method", ["dop853", "taylor", "radau", "splitting"])
@pytest.mark.parametrize("inertia", [1e-240, 1e-154, 1e154, 1e240])
@pytest.mark.parametrize("form", ["principal", "tensor"])
def test_integrations_in_units_of_any_size(method: Any, inertia: float, form: str) -> None:
    tensor = TURN @ np.diag(MOMENTS) @ TURN_BACK
    tensor = (tensor + tensor.T) / 2

    def end(inertia: float) -> Any:
        if form == "tensor":
            body = RigidBody(1.0, tensor * inertia)
        else:
            body = RigidBody.from_principal(1.0, np.array(MOMENTS) * inertia)
        torque = loads.constant_torque((0.1 * inertia, 0.0, -0.2 * inertia), frame="space")
        load = None if method == "splitting" else torque
        return body.simulate([0.0, 2.0], OMEGA, load=load, method=method).omega[-1]

    np.testing.assert_allclose(end(float(2.0 ** np.round(np.log2(inertia)))), end(1.0), rtol=1e-12)


@pytest.mark.parametrize("method", ["dop853", "taylor", "radau", "splitting"])
def test_integrations_out_of_range_are_refused(method: Any) -> None:
    body = RigidBody.from_principal(1.0, MOMENTS)
    for scale in (1e-150, 1e150):
        with pytest.raises(PolhodeError, match="span of t must be from 1e-100 to 1e100"):
            body.simulate([0.0, 2.0 / scale], np.array(OMEGA) * scale, method=method)
    for inertia, rate in ((1e200, 1e40), (1e-200, 1e-40)):
        heavy = RigidBody.from_principal(1.0, np.array(MOMENTS) * inertia)
        with pytest.raises(PolhodeError, match="largest moment over the square of the span of t"):
            heavy.simulate([0.0, 2.0 / rate], np.array(OMEGA) * rate, method=method)


class TestOrbits:
    """States of Kepler orbits, against sixty digits, until nothing is left of the phase."""

    @staticmethod
    def exact(orbit: Any, t: float) -> tuple[Any, Any, Any]:
        """Position, the largest speed on the orbit, and the revolutions made."""
        r, v = ([mpf(float(x)) for x in part] for part in (orbit.position, orbit.velocity))
        mu = mpf(orbit.mu)
        distance, sigma = mp.sqrt(mp.fdot(r, r)), mp.fdot(r, v) / mp.sqrt(mu)
        a = 1 / (2 / distance - mp.fdot(v, v) / mu)
        cosine, sine = 1 - distance / a, sigma / mp.sqrt(a)
        eccentricity, first = mp.hypot(cosine, sine), mp.atan2(sine, cosine)
        rate = mp.sqrt(mu / a**3)
        mean = first - sine + rate * mpf(t)
        mean -= 2 * mp.pi * mp.nint(mean / (2 * mp.pi))
        low, high = mean - 2, mean + 2
        for _ in range(220):
            middle = (low + high) / 2
            low, high = (middle, high) if middle - eccentricity * mp.sin(middle) < mean else (low, middle)
        turn = low - first
        f = 1 - a / distance * (1 - mp.cos(turn))
        g = (sigma * a * (1 - mp.cos(turn)) + distance * mp.sqrt(a) * mp.sin(turn)) / mp.sqrt(mu)
        speed = mp.sqrt(mu / a * (1 + eccentricity) / (1 - eccentricity))
        place = [f * one + g * other for one, other in zip(r, v, strict=True)]
        return place, speed, rate * mpf(t) / (2 * mp.pi)

    @pytest.mark.parametrize("seed", range(8))
    def test_ellipses(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        orbit = orbits.kepler(4e14, rng.normal(size=3) * 7e6, rng.normal(size=3) * 2e3)
        times = orbit.period * 10.0 ** rng.uniform(0, 26.4, 5) * rng.choice([-1.0, 1.0], 5)
        found = orbit.at(times)
        with mp.workdps(60):
            for t, place in zip(times, found.position, strict=True):
                want, speed, turns = self.exact(orbit, t)
                off = mp.norm([mpf(float(x)) - y for x, y in zip(place, want, strict=True)])
                # What the phase is known to, and one rounding of it.
                late = (mpf(2) ** -90 * abs(turns) + mpf(2) ** -52) * mpf(float(orbit.period))
                assert off < late * speed + 1e-8, (orbit, t)

    @pytest.mark.parametrize("eccentricity", [0.0, 0.3, 0.9, 0.99999999, 1.0, 1.5])
    def test_beyond_the_reach_they_are_refused(self, eccentricity: float) -> None:
        orbit = orbits.from_elements(4e14, eccentricity=eccentricity, periapsis=7e6)
        with pytest.raises(PolhodeError, match="beyond the reach of this orbit") as caught:
            orbit.at([1.0, 1e200])
        reach = float(str(caught.value).split("orbit, ")[1].split(":")[0])
        if eccentricity < 0.95:
            assert reach / orbit.period == pytest.approx(2.0**88, rel=0.01)
        known = orbit.at([0.999 * reach, -0.999 * reach])
        assert np.isfinite(known.position).all()
        assert np.isfinite(orbit.frame([0.999 * reach, -0.999 * reach]).quaternion).all()
        body = RigidBody.from_principal(1.0, MOMENTS)
        gradient = loads.gravity_gradient(orbit)
        field = loads.magnetic((0, 0, 1), orbit.dipole_field((0, 0, 1e15)))
        down = loads.feedback(K=1.0, D=1.0, target=orbit)
        for t in (1.001 * reach, -1.001 * reach):
            for ask in (orbit.at, orbit.frame, orbit.dipole_field((0, 0, 1.0)).at):
                with pytest.raises(PolhodeError, match=r"give the state of the orbit at a later epoch"):
                    ask(t)
            for load in (gradient, field, down) if eccentricity < 1.0 else ():
                with pytest.raises(PolhodeError, match="beyond the reach of this orbit"):
                    body.simulate([0.0, t], OMEGA, load=load, method="dop853")
        assert np.isnan(orbit.at([np.nan, np.inf]).position).all()

    def test_absurd_times(self) -> None:
        circle = orbits.kepler(1.0, (1.0, 0, 0), (0, 1.0, 0))
        for t in (1e40, 1e300, -1e300):
            with pytest.raises(PolhodeError, match="beyond the reach of this orbit"):
                circle.at(t)
        oblate = orbits.kepler(1.0, (1.0, 0, 0), (0, 1.0, 0), j2=1e-3, radius=0.9)
        with pytest.raises(PolhodeError, match="30 000 revolutions"):
            oblate.at(1e40)
        table = orbits.sampled(1.0, [0.0, 1.0, 2.0], [(1.0, 0, 0), (0, 1.0, 0), (-1.0, 0, 0)])
        with pytest.raises(PolhodeError, match="known from t = 0"):
            table.at(1e40)
