"""Derivatives of free motions, against differences in forty digits, composition, motions started beside."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from oracles.bodies import Body, attitudes, bodies, matrix, vectors
from oracles.free_motion import jacobi_rates
from oracles.free_variations import CASES, jacobian, table
from polhode import RigidBody, Sensitivity, solids
from scipy.spatial.transform import Rotation


def scaled(slopes: np.ndarray, moments: np.ndarray, speed: float) -> np.ndarray:
    """Rates in units of the speed, moments in units of themselves."""
    rows = np.array([1, 1, 1, 1 / speed, 1 / speed, 1 / speed])
    columns = np.array([1, 1, 1, speed, speed, speed, *moments])
    return np.asarray(rows[:, None] * slopes * columns)


def whole(found: Sensitivity) -> np.ndarray:
    return np.concatenate([found.state, found.moments], axis=-1)


@pytest.mark.parametrize("case", CASES)
def test_every_mode_against_differences_in_many_digits(case: str) -> None:
    moments, omega, t = CASES[case]
    found = RigidBody.from_principal(1.0, moments).free_motion(omega).sensitivity(t)
    exact = scaled(table()[case], np.array(moments), float(np.linalg.norm(omega)))
    got = scaled(whole(found), np.array(moments), float(np.linalg.norm(omega)))
    assert np.abs(got - exact).max() < 1e-14 * np.abs(exact).max()


def test_the_table_is_what_its_script_computes() -> None:
    moments, omega, t = CASES["spherical"]
    np.testing.assert_allclose(table()["spherical"], jacobian(moments, omega, t), rtol=1e-15, atol=1e-17)


@pytest.mark.parametrize("omega", [(0.3, 0.2, 1.1), (1.3, 0.2, -0.1), (1e-3, 1.0, 1.1e-3)])
def test_rates_after_a_million_rotations(omega: tuple[float, float, float]) -> None:
    """By Jacobi's functions in sixty digits: secular growth, and the phase on top of it."""
    moments, t = (1.0, 2.0, 2.5), 6.0e6
    with mpmath.workdps(70):
        start = [mpf(x) for x in omega + moments]
        base = jacobi_rates(moments, omega, [0, t], digits=60)[-1]
        columns = []
        for k in range(6):
            changed = list(start)
            changed[k] += mpf("1e-30")
            other = jacobi_rates(changed[3:], changed[:3], [0, t], digits=60)[-1]
            columns.append([float((a - b) / mpf("1e-30")) for a, b in zip(other, base, strict=True)])
    exact = np.array(columns).T
    found = RigidBody.from_principal(1.0, moments).free_motion(omega).sensitivity(t)
    assert np.abs(exact).max() > 1e5
    assert np.abs(whole(found)[3:, 3:] - exact).max() < 3e-14 * np.abs(exact).max()


@given(body=bodies(thinnest=3, decades=3), omega=vectors(), q=attitudes(), turns=st.floats(-1e5, 1e5))
def test_two_spans_make_one(body: Body, omega: np.ndarray, q: np.ndarray, turns: float) -> None:
    """The derivatives from zero to t + s are those from t to t + s after those from zero to t."""
    made = RigidBody.from_principal(*body)
    speed = float(np.linalg.norm(omega))
    if speed < 1e-3:
        return
    motion = made.free_motion(omega, q)
    t, s = 3.0 / speed, turns / speed
    state = motion.at(t)
    later = made.free_motion(state.omega, state.quaternion)
    first = scaled(whole(motion.sensitivity(t)), body.moments, speed)
    second = scaled(whole(later.sensitivity(s)), body.moments, speed)
    both = scaled(whole(motion.sensitivity(t + s)), body.moments, speed)
    size = np.linalg.norm(second) * np.linalg.norm(first)
    together = second[:, :6] @ first
    together[:, 6:] += second[:, 6:]
    assert np.abs(together - both).max() < 1e-10 * size


@pytest.mark.parametrize("t", [2.0, 1e6])
def test_a_motion_started_beside(t: float) -> None:
    """A full tensor in any attitude, and the states of motions that start a little off."""
    inertia = np.array([[4.0, -0.5, 0.25], [-0.5, 5.0, 0.75], [0.25, 0.75, 6.0]])
    body = RigidBody(1.0, inertia)
    start, omega = Rotation.from_euler("ZXZ", [0.3, 1.0, -2.0]), np.array([0.4, -1.0, 0.7])
    motion = body.free_motion(omega, start)
    found, state = motion.sensitivity(t).state, motion.at(t)
    here = Rotation.from_quat(state.quaternion)
    h = 1e-10 if t > 100 else 1e-6
    for k in range(6):
        tilt, faster = np.zeros(3), np.zeros(3)
        (tilt if k < 3 else faster)[k % 3] = h
        ends = []
        for sign in (1, -1):
            beside = body.free_motion(omega + sign * faster, start * Rotation.from_rotvec(sign * tilt)).at(t)
            turned = (here.inv() * Rotation.from_quat(beside.quaternion)).as_rotvec()
            ends.append(np.concatenate([turned, beside.omega - state.omega]))
        slopes = (ends[0] - ends[1]) / (2 * h)
        assert np.abs(slopes - found[:, k]).max() < 1e-5 * np.abs(found).max()


def test_attitudes_and_axes_turn_the_derivatives() -> None:
    """The same body described in other axes: derivatives in those axes, whatever the attitude."""
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    omega, t, turn = np.array([0.3, 0.2, 1.1]), 4.0, Rotation.from_euler("ZXZ", [0.3, 1.0, -2.0])
    plain = body.free_motion(omega).sensitivity(t)
    turned = body.rotated(turn).free_motion(turn.apply(omega), (0.5, 0.5, 0.5, 0.5)).sensitivity(t)
    V = np.kron(np.eye(2), turn.as_matrix())
    np.testing.assert_allclose(turned.state, V @ plain.state @ V.T, atol=2e-14)
    np.testing.assert_allclose(turned.moments, V @ plain.moments, atol=2e-14)


def test_zero_time_and_rest() -> None:
    body = solids.box((1.0, 2.0, 3.0), mass=1.0)
    now = body.free_motion((1.0, 2.0, 3.0)).sensitivity(0.0)
    np.testing.assert_allclose(now.state, np.eye(6), atol=1e-15)
    np.testing.assert_allclose(now.moments, 0.0, atol=1e-15)
    rest = body.free_motion((0.0, 0.0, 0.0)).sensitivity(5.0)
    assert np.array_equal(rest.state, np.block([[np.eye(3), 5 * np.eye(3)], [np.zeros((3, 3)), np.eye(3)]]))


def test_a_rod_has_derivatives_by_its_state_alone() -> None:
    """Slender bodies lead to them; a rod that turns about itself is known in closed form."""
    omega, t = (0.7, 0.3, 0.4), 3.0
    rod = RigidBody.from_principal(1.0, (0.0, 2.0, 2.0)).free_motion(omega).sensitivity(t)
    slender = RigidBody.from_principal(1.0, (1e-11, 2.0, 2.0)).free_motion(omega).sensitivity(t)
    np.testing.assert_allclose(rod.state, slender.state, atol=1e-9)
    assert np.isnan(rod.moments).all()
    alone = RigidBody.from_principal(1.0, (0.0, 2.0, 2.0)).free_motion((0.7, 0.0, 0.0)).sensitivity(t)
    back = matrix(np.array([np.sin(-0.35 * t), 0.0, 0.0, np.cos(0.35 * t)]))
    expected = np.block([[back, t * back], [np.zeros((3, 3)), back]])
    np.testing.assert_allclose(alone.state, expected, atol=1e-15)


def test_shapes_and_what_is_not_finite() -> None:
    motion = RigidBody.from_principal(1.0, [(1.0, 2.0, 2.5), (1.0, 2.0, 2.2)]).free_motion((0.3, 0.2, 1.1))
    found = motion.sensitivity(np.zeros((3, 4)))
    assert found.state.shape == (2, 3, 4, 6, 6)
    assert found.moments.shape == (2, 3, 4, 6, 3)
    far = RigidBody.from_principal(1.0, (2.0, 4.0, 4.5)).free_motion((0.75, 0.3, 1.0))
    assert far.mode == "separatrix"
    assert np.isnan(far.sensitivity([1e5, np.nan]).state).all()


def test_the_error_bar_bounds_what_happens(rng: np.random.Generator) -> None:
    moments, omega, rtol = np.array([1.0, 2.0, 2.5]), np.array([0.3, 0.2, 1.1]), 1e-7
    t = np.array([0.0, 3.0, 50.0, 1000.0])
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega)
    bar, state = motion.error_bar(t, rtol), motion.at(t)
    worst = np.zeros((2, 4))
    for _ in range(200):
        tilt = rng.standard_normal(3)
        tilt *= rtol / np.linalg.norm(tilt)
        off = rng.standard_normal(3)
        off *= rtol * np.linalg.norm(omega) / np.linalg.norm(off)
        other = RigidBody.from_principal(1.0, moments * (1 + rtol * rng.choice([-1, 1], 3)))
        beside = other.free_motion(omega + off, Rotation.from_rotvec(tilt)).at(t)
        angle = (state.rotation.inv() * beside.rotation).magnitude()
        worst = np.maximum(worst, [angle, np.linalg.norm(beside.omega - state.omega, axis=-1)])
    assert (worst[0] <= bar.attitude * 1.001).all()
    assert (worst[1] <= bar.omega * 1.001).all()
    assert (worst[0] > 0.2 * bar.attitude).all()
    assert (worst[1] > 0.2 * bar.omega).all()
    with pytest.raises(ValueError, match=r"rtol.*-1"):
        motion.error_bar(0.0, rtol=-1.0)
    rod = RigidBody.from_principal(1.0, (0.0, 2.0, 2.0)).free_motion((0.7, 0.3, 0.4))
    assert np.isfinite(rod.error_bar(3.0).attitude)
