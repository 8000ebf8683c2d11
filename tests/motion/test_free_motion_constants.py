"""Modes, periods, angles, cones, polhode, herpolhode and Poinsot's picture of free motions."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from oracles.bodies import Body, attitudes, bodies, vectors
from polhode import Cones, Periods, Poinsot, RigidBody, solids, tops

BRICK = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
SHORT, LONG = (0.3, 0.2, 1.1), (1.3, 0.2, -0.1)


def angle(u: Any, v: Any) -> Any:
    size = np.linalg.norm(np.cross(u, v), axis=-1)
    return np.arctan2(size, np.sum(np.asarray(u) * v, axis=-1))


def exact(moments: Any, omega: Any) -> dict[str, Any]:
    """Energy ratio, modulus, period and mean rates by mpmath, from L² − 2T I_k; not near a limit."""
    with mpmath.workdps(60):
        I, w = [mpf(float(x)) for x in moments], [mpf(float(x)) for x in omega]
        squared = mpmath.fsum((i * x) ** 2 for i, x in zip(I, w, strict=True))
        double = mpmath.fsum(i * x * x for i, x in zip(I, w, strict=True))
        short_axis = squared > double * I[1]
        if not short_axis:
            I, w = I[::-1], w[::-1]
        x, y, z = I
        D = [abs(squared - double * i) for i in I]
        L = mpmath.sqrt(squared)
        rate = mpmath.sqrt(abs(z - y) * D[0] / (x * y * z))
        m = abs(y - x) * D[2] / (abs(z - y) * D[0])
        K = mpmath.ellipk(m)
        # Of the axis that is not circled: φ̇ = (L/I_x)(1 − (L² − 2T I_x)/(L² − L_x²)), L_x² = A cn².
        A = x * D[2] / abs(z - x)
        mean = mpmath.ellippi(-A / (squared - A), m) / (squared - A) / K
        slow = L / x * (1 - (squared - double * x) * mean)
        ahead = mpmath.pi * rate / (2 * K)
        rates = [slow, slow, slow + ahead] if short_axis else [slow - ahead, slow, slow]
        return {
            "energy_ratio": float(double * (z if short_axis else x) / squared),
            "modulus": float(mpmath.sqrt(m)),
            "rotation": float(4 * K / rate),
            "rates": [float(rate) for rate in rates],
            "mode": "short-axis" if short_axis else "long-axis",
        }


@given(body=bodies(thinnest=2), omega=vectors())
def test_constants_against_elliptic_integrals(body: Body, omega: np.ndarray) -> None:
    """Any body: moments and scales over decades, the angular velocity in principal axes."""
    moments = body.moments
    rates = np.abs(omega)
    if rates.min() < 1e-6 * rates.max() or np.diff(moments).min() < 1e-6 * moments[2]:
        return
    motion = RigidBody.from_principal(body.mass, moments).free_motion(omega)
    if motion.complementary_modulus < 1e-6:
        return
    want = exact(moments, omega)
    assert motion.mode == want["mode"]
    assert motion.energy_ratio == pytest.approx(want["energy_ratio"], rel=1e-14)
    assert motion.modulus == pytest.approx(want["modulus"], rel=1e-14)
    periods = motion.periods
    assert periods.rotation == pytest.approx(want["rotation"], rel=1e-14)
    np.testing.assert_allclose(periods.rates, want["rates"], rtol=2e-14)
    assert periods.precession == pytest.approx(2 * np.pi / want["rates"][0], rel=2e-14)
    assert motion.kinetic_energy().total == pytest.approx(0.5 * float(moments @ omega**2), rel=1e-15)
    np.testing.assert_allclose(motion.angular_momentum().spin, moments * omega, rtol=1e-14)


@pytest.mark.parametrize("omega", [SHORT, LONG, (1e-3, 1.0, 1.1e-3), (-0.3, -0.2, -1.1)])
def test_periods_are_those_of_the_motion(omega: tuple[float, float, float]) -> None:
    motion = BRICK.free_motion(omega, (0.5, -0.1, 0.7, 0.5))
    periods = motion.periods
    assert isinstance(periods, Periods)
    t = np.linspace(0.0, periods.rotation, 20001)
    half = 0.5 * periods.rotation
    start, now, later, last = (motion.at(x) for x in (t, t + 3.0, t + 3.0 + half, t + periods.rotation))
    np.testing.assert_allclose(last.omega, start.omega, atol=1e-13)
    # The intermediate axis swings to the other side; it turns over where it is the nearest to L.
    L = motion.angular_momentum().spin / np.linalg.norm(motion.angular_momentum().spin)
    lean = [state.rotation.apply((0.0, 1.0, 0.0)) @ L for state in (now, later)]
    np.testing.assert_allclose(lean[1], -lean[0], atol=1e-13)
    turns_over = np.abs(lean[0]).max() > np.sqrt(0.5)
    np.testing.assert_equal(periods.flip, half if turns_over else np.nan)
    # Each axis, followed around L, has gone the mean rate times the period.
    first = np.cross(L, (1.0, 0.0, 0.0))
    for k in range(3):
        axis = start.rotation.apply(np.eye(3)[k])
        around = np.unwrap(np.arctan2(axis @ np.cross(L, first), axis @ first))
        assert around[-1] - around[0] == pytest.approx(periods.rates[k] * periods.rotation, rel=1e-12)


@pytest.mark.parametrize("omega", [SHORT, LONG, (1e-3, 1.0, 1.1e-3), (-0.3, -0.2, -1.1), (1.0, 1e-8, 0.0)])
def test_angles_stay_in_their_ranges_and_reach_their_ends(omega: tuple[float, float, float]) -> None:
    motion = BRICK.free_motion(omega)
    state = motion.at(np.linspace(0.0, motion.periods.rotation, 20001))
    momentum = state.omega * BRICK.principal_moments
    for axis, (low, high) in zip(np.eye(3), motion.nutation, strict=True):
        found = angle(momentum, axis)
        np.testing.assert_allclose([found.min(), found.max()], [low, high], atol=2e-6)
        assert low - 1e-14 <= found.min()
        assert found.max() <= high + 1e-14
    cones = motion.cones
    assert isinstance(cones, Cones)
    assert cones.axis == (2 if motion.mode == "short-axis" else 0)
    to_axis = angle(state.omega, np.eye(3)[cones.axis])
    for found, (low, high) in (
        (np.minimum(to_axis, np.pi - to_axis), cones.body),
        (angle(state.omega, momentum), cones.space),
    ):
        np.testing.assert_allclose([found.min(), found.max()], [low, high], atol=2e-6)


@given(ratio=st.one_of(st.floats(0.01, 0.95), st.floats(1.05, 2.0)), q=attitudes(), omega=vectors())
def test_a_symmetric_body_has_round_cones(ratio: float, q: np.ndarray, omega: np.ndarray) -> None:
    """As its free precession in elementary functions says."""
    body = RigidBody.from_principal(1.0, [1.0, 1.0, ratio])
    if np.linalg.norm(omega[:2]) < 1e-3 or abs(omega[2]) < 1e-3:
        return
    motion, known = body.free_motion(omega, q), tops.free_precession(body, omega)
    assert motion.mode == "symmetric"
    axis = 2 if ratio > 1 else 0
    assert motion.cones.axis == axis
    np.testing.assert_allclose(motion.cones.body, [known.body_cone] * 2, rtol=1e-13)
    np.testing.assert_allclose(motion.cones.space, [known.space_cone] * 2, rtol=1e-12)
    assert motion.periods.rates[axis] == pytest.approx(known.space_rate, rel=1e-13)
    assert motion.periods.spin == pytest.approx(2 * np.pi / abs(known.body_rate), rel=1e-13)
    assert motion.periods.precession == pytest.approx(2 * np.pi / known.space_rate, rel=1e-13)
    lean = motion.nutation[axis]
    np.testing.assert_allclose(np.minimum(lean, np.pi - lean), [known.nutation] * 2, rtol=1e-13)


@pytest.mark.parametrize("omega", [SHORT, LONG, (-0.3, -0.2, -1.1), (1e-6, 1.0, 1e-6)])
def test_the_polhode_is_where_the_angular_velocity_runs(omega: tuple[float, float, float]) -> None:
    turned = BRICK.rotated((0.5, 0.5, 0.5, 0.5))
    omega_B = np.roll(omega, 1)  # x to y, y to z, z to x
    motion = turned.free_motion(omega_B)
    curve = motion.polhode(721)
    assert curve.shape == (721, 3)
    assert curve[0].tolist() == curve[-1].tolist() == omega_B.tolist()
    energies = turned.kinetic_energy(curve).rotational
    np.testing.assert_allclose(energies, motion.kinetic_energy().total, rtol=1e-14)
    sizes = np.linalg.norm(turned.angular_momentum(curve).total, axis=-1)
    np.testing.assert_allclose(sizes, np.linalg.norm(motion.angular_momentum().spin), rtol=1e-14)
    # In the sense of the motion: the first step is along the acceleration.
    assert (curve[1] - curve[0]) @ turned.angular_acceleration(omega_B) > 0
    # Every state lies between two neighbours of the curve.
    states = motion.at(np.linspace(0, motion.periods.rotation, 50)).omega
    near = np.linalg.norm(states[:, None] - curve, axis=-1).min(axis=1)
    assert near.max() < np.linalg.norm(np.diff(curve, axis=0), axis=1).max()
    with pytest.raises(ValueError, match=r"n: .*at least 2.*1"):
        motion.polhode(1)


def test_the_ellipsoid_rolls_on_the_invariable_plane() -> None:
    motion = BRICK.free_motion(SHORT, (0.5, -0.1, 0.7, 0.5))
    t = np.linspace(0, 40, 4001)
    found = motion.poinsot(t)
    assert isinstance(found, Poinsot)
    state = motion.at(t)
    L = np.linalg.norm(motion.angular_momentum().spin)
    np.testing.assert_allclose(found.normal, motion.angular_momentum().spin / L, atol=1e-15)
    np.testing.assert_allclose(found.contact, state.rotation.apply(state.omega), atol=1e-14)
    np.testing.assert_allclose(found.contact, motion.herpolhode(t), atol=0)
    np.testing.assert_allclose(found.contact @ found.normal, found.distance, rtol=1e-14)
    assert found.distance == pytest.approx(2 * motion.kinetic_energy().total / L, rel=1e-15)
    # In the body the point lies on the ellipsoid, which has L for its normal there.
    inside = state.omega / found.semi_axes
    np.testing.assert_allclose(np.sum(inside**2, axis=-1), 1.0, rtol=1e-14)
    radii = np.linalg.norm(found.contact - found.distance * found.normal, axis=-1)
    np.testing.assert_allclose([radii.min(), radii.max()], found.radii, rtol=1e-5)
    assert found.radii[0] <= radii.min() + 1e-15
    assert radii.max() <= found.radii[1] + 1e-15


def test_modes_come_in_their_order() -> None:
    sphere, coin = solids.sphere(1.0, mass=1.0), RigidBody.from_principal(1.0, (1.0, 1.0, 2.0))
    rod = RigidBody.from_principal(1.0, (0.0, 1.0, 1.0))
    even = RigidBody.from_principal(1.0, (2.0, 4.0, 4.5))  # 2·2·0.75² = 4.5·0.5·1²
    assert sphere.free_motion((0, 0, 1)).mode == "spherical"
    assert coin.free_motion((0, 0, 1)).mode == rod.free_motion((0, 1, 0)).mode == "symmetric"
    assert [BRICK.free_motion(w).mode for w in np.eye(3)] == ["steady"] * 3
    assert BRICK.free_motion((0, 0, 0)).mode == "steady"
    assert even.free_motion((0.75, 5.0, 1.0)).mode == "separatrix"
    assert even.free_motion((0.75, 5.0, 1.0 + 2e-16)).mode == "short-axis"
    assert even.free_motion((0.75 + 2e-16, 5.0, 1.0)).mode == "long-axis"
    stack = BRICK.free_motion([SHORT, LONG])
    assert stack.mode.tolist() == ["short-axis", "long-axis"]
    assert stack.periods.rates.shape == (2, 3)
    assert stack.nutation.shape == (2, 3, 2)
    assert stack.cones.axis.tolist() == [2, 0]
    assert stack.polhode(7).shape == (2, 7, 3)
    assert stack.herpolhode(np.zeros((4, 5))).shape == (2, 4, 5, 3)
    assert stack.stability().shape == (2, 3)


def test_limits() -> None:
    separatrix = RigidBody.from_principal(1.0, (2.0, 4.0, 4.5)).free_motion((0.75, 0.3, 1.0))
    assert (separatrix.modulus, separatrix.complementary_modulus) == (1.0, 0.0)
    assert separatrix.periods.rotation == separatrix.periods.flip == np.inf
    np.testing.assert_allclose(
        separatrix.periods.rates, np.linalg.norm(separatrix.angular_momentum().spin) / 4
    )
    np.testing.assert_allclose(separatrix.nutation[1], [0, np.pi], atol=1e-15)
    assert separatrix.energy_ratio == pytest.approx(4.5 / 4, rel=1e-15)
    curve = separatrix.polhode(91)
    assert np.isfinite(curve).all()
    steady = BRICK.free_motion((0, 0, -2.0))
    assert steady.periods.wobble == pytest.approx(2 * np.pi / np.sqrt(BRICK.stability(2.0)[2]), rel=1e-15)
    assert steady.periods.turn == np.pi
    np.testing.assert_allclose(steady.nutation, [[np.pi / 2] * 2, [np.pi / 2] * 2, [np.pi] * 2])
    assert steady.polhode(3).tolist() == [[0, 0, -2.0]] * 3
    assert steady.poinsot(0.0).radii.tolist() == [0.0, 0.0]
    rest = BRICK.free_motion((0, 0, 0))
    for unknown in (rest.nutation, rest.cones.space, rest.poinsot(0.0).normal, rest.periods.rates):
        assert np.isnan(unknown).all()
    assert np.isnan(rest.energy_ratio)
    assert rest.kinetic_energy().total == 0.0


@given(exponents=st.tuples(st.integers(-140, 140), st.integers(-140, 140)))
def test_any_scale(exponents: tuple[int, int]) -> None:
    """Periods scale with 1/ω, angles and ratios not at all; no digit is lost."""
    size, speed = 10.0 ** exponents[0], 10.0 ** exponents[1]
    moments, omega = np.array([1.0, 2.0, 2.5]), np.array(SHORT)
    plain = RigidBody.from_principal(1.0, moments).free_motion(omega)
    other = RigidBody.from_principal(1.0, moments * size).free_motion(omega * speed)
    assert other.mode == plain.mode
    assert other.periods.rotation * speed == pytest.approx(plain.periods.rotation, rel=1e-14)
    np.testing.assert_allclose(other.nutation, plain.nutation, rtol=1e-13)
    assert other.modulus == pytest.approx(plain.modulus, rel=1e-13)
    slopes = other.sensitivity(3.0 / speed).state
    assert slopes[3:, 3:] == pytest.approx(plain.sensitivity(3.0).state[3:, 3:], rel=1e-11)


def test_stability_is_that_of_spins_with_the_same_momentum() -> None:
    motion = BRICK.free_motion(SHORT)
    L = np.linalg.norm(motion.angular_momentum().spin)
    want = [BRICK.stability(L / moment)[k] for k, moment in enumerate((1.0, 2.0, 2.5))]
    np.testing.assert_allclose(motion.stability(), want, rtol=1e-15)
    rod = RigidBody.from_principal(1.0, (0.0, 1.0, 1.0)).free_motion((0.0, 1.0, 0.0))
    assert np.isnan(rod.stability()[0])
    assert rod.stability()[1:].tolist() == [0.0, 0.0]
