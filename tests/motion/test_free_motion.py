"""Exact free motion against series in forty digits, closed forms, laws; every regime, random bodies."""

from __future__ import annotations

import pickle
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mpf
from oracles.free_motion import taylor_motion
from oracles.jacobi import JacobiMotion
from oracles.motion_cases import MotionCase, angle, load_table, relative_error
from polhode import RigidBody, errors
from scipy.spatial.transform import Rotation

ATTITUDE = (0.5, -0.1, 0.7, -0.5)
START = np.array(ATTITUDE) / np.linalg.norm(ATTITUDE)

# Moments and rates of every mode, and of the neighbourhood of every other.
CASES = {
    "short-axis": ((1.0, 2.0, 2.5), (0.3, 0.2, 1.1)),
    "short-axis, other senses": ((1.0, 2.0, 2.5), (-0.3, 0.2, -1.1)),
    "long-axis": ((1.0, 2.0, 2.5), (1.1, 0.2, 0.3)),
    "long-axis, other senses": ((1.0, 2.0, 2.5), (1.1, -0.2, -0.3)),
    "separatrix": ((1.5, 3.0, 4.0), (4.0, 1.0, 3.0)),
    "separatrix, other senses": ((1.5, 3.0, 4.0), (-4.0, -1.0, 3.0)),
    "just outside the separatrix": ((1.5, 3.0, 4.0), (4.0, 1.0, 3.000000000000001)),
    "just inside the separatrix": ((1.5, 3.0, 4.0), (4.000000000000002, 1.0, 3.0)),
    "intermediate axis": ((1.0, 2.0, 2.5), (1e-9, 1.0, -1e-7)),
    "spherical": ((2.0, 2.0, 2.0), (0.3, -0.4, 1.0)),
    "oblate": ((1.0, 1.0, 1.6), (0.5, 0.3, -2.0)),
    "prolate": ((0.4, 1.5, 1.5), (-0.5, 0.3, 1.0)),
    "nearly oblate": ((1.0, 1.0 + 1e-13, 1.6), (0.5, 0.3, -2.0)),
    "nearly prolate": ((0.4, 1.5, 1.5 + 1e-13), (-0.5, 0.3, 1.0)),
    "nearly spherical": ((2.0, 2.0 + 1e-12, 2.0 + 3e-12), (0.3, -0.4, 1.0)),
    "lamina": ((1.0, 2.0, 3.0), (0.3, 0.2, 1.1)),
    "needle": ((1e-6, 1.0, 1.0000005), (20.0, 0.5, -0.3)),
    "steady": ((1.0, 2.0, 2.5), (0.0, -1.3, 0.0)),
    "nearly steady": ((1.0, 2.0, 2.5), (1e-12, -1e-13, 1.3)),
}


def apart(quaternion: Any, exact: Any) -> float:
    """The angle between an attitude and the exact one, to first order in what is left of its rounding."""
    with mpmath.workdps(40):
        x, y, z, w = (mpf(float(v)) for v in quaternion)
        X, Y, Z, W = exact
        vector = [
            W * x - X * w - Y * z + Z * y,
            W * y + X * z - Y * w - Z * x,
            W * z - X * y + Y * x - Z * w,
        ]
        return float(2 * mpmath.norm(vector) / mpmath.sqrt(x * x + y * y + z * z + w * w))


def errors_of(trajectory: Any, exact: Any) -> tuple[float, float]:
    """The largest angle, and the largest error of ω relative to its size."""
    angles, rates = [], []
    for omega, quaternion, (w, q) in zip(trajectory.omega, trajectory.quaternion, exact, strict=True):
        angles.append(apart(quaternion, q))
        with mpmath.workdps(40):
            gap = mpmath.norm([mpf(float(a)) - b for a, b in zip(omega, w, strict=True)])
            rates.append(float(gap / mpmath.norm(w)))
    return max(angles), max(rates)


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.long] * (case == "needle")) for case in CASES]
)
def test_every_mode_against_the_series(case: str) -> None:
    moments, omega = CASES[case]
    speed = np.linalg.norm(np.array(moments) * omega) / moments[1]
    times = [0.0, *(np.array([0.1, 0.7, 1.9]) * 2 * np.pi / speed)]
    exact = taylor_motion(np.diag(moments), omega, times, attitude=ATTITUDE)
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega, START)
    angle, rate = errors_of(motion.at(times), exact)
    assert angle < 4e-15
    assert rate < 4e-15


def test_a_full_tensor_against_the_series() -> None:
    inertia = np.array([[4.0, -0.5, 0.25], [-0.5, 5.0, 0.75], [0.25, 0.75, 6.0]])
    times = [0.0, 1.0, 7.0, 20.0]
    motion = RigidBody(1.0, inertia).free_motion((0.4, -1.0, 0.7), START)
    exact = taylor_motion(inertia, (0.4, -1.0, 0.7), times, attitude=ATTITUDE)
    assert max(errors_of(motion.at(times), exact)) < 4e-15
    backward = taylor_motion(inertia, (0.4, -1.0, 0.7), [0.0, -9.0], attitude=ATTITUDE)
    assert max(errors_of(motion.at([0.0, -9.0]), backward)) < 4e-15


def test_nasa_check_case_2() -> None:
    # NASA/TM-2015-218675, case 2, after 30 s: the numbers given are taken as the exact ones.
    moments, omega = (0.001894220, 0.006211019, 0.007194665), np.radians([10.0, 20.0, 30.0])
    motion = RigidBody.from_principal(0.155404754, moments).free_motion(omega)
    exact = taylor_motion(np.diag(moments), omega, [0, 30])
    angle, rate = errors_of(motion.at([0.0, 30.0]), exact)
    assert rate < 2e-15
    assert angle < 2e-15


def test_symmetric_body_after_a_million_million_rotations() -> None:
    # I_t = 1, I_s = 1.5, ω = (0.75, 0, 1): χ̇ = 1/2, L = √(0.75² + 1.5²).
    motion = RigidBody.from_principal(1.0, (1.0, 1.0, 1.5)).free_motion((0.75, 0.0, 1.0))
    t = 1e13
    with mpmath.workdps(50):
        angle = mpf(t) / 2
        exact = [mpf("0.75") * mpmath.cos(angle), mpf("0.75") * mpmath.sin(angle), mpf(1)]
        L = mpmath.sqrt(mpf("0.75") ** 2 + mpf("1.5") ** 2)
        axis = [mpf("0.75") / L, mpf(0), mpf("1.5") / L]
        half = L * t / 2
        turn = [*(mpmath.sin(half) * a for a in axis), mpmath.cos(half)]
        spin = [mpf(0), mpf(0), mpmath.sin(-angle / 2), mpmath.cos(-angle / 2)]
        q = _product(turn, spin)
    states = motion.at([t])
    assert max(errors_of(states, [(exact, q)])) < 1e-15


def _product(p: Any, q: Any) -> Any:
    a, b, c, d = p
    x, y, z, w = q
    return [
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    ]


def test_a_rod_keeps_what_it_spins_along_itself() -> None:
    rod = RigidBody.from_principal(1.0, (0.0, 2.0, 2.0))
    states = rod.free_motion((5.0, 0.3, 0.4)).at(np.linspace(-20, 20, 41))
    np.testing.assert_allclose(states.omega[:, 0], 5.0, rtol=1e-15)
    np.testing.assert_allclose(np.hypot(states.omega[:, 1], states.omega[:, 2]), 0.5, rtol=1e-15)
    assert np.ptp(states.angular_momentum().total, axis=0).max() < 4e-15


def scales() -> st.SearchStrategy[float]:
    return st.floats(-150.0, 150.0).map(lambda exponent: 10.0**exponent)


@st.composite
def starts(draw: st.DrawFn) -> Any:
    """Moments with gaps of any size and rates with components of any size."""
    sizes = [10.0 ** draw(st.floats(-9.0, 0.0)) for _ in range(3)]
    if draw(st.booleans()):
        sizes[1] = sizes[0] * (1 + draw(st.sampled_from([0.0, 1e-16, 3e-16, 1e-14, 1e-9])))
    a, b, c = sizes
    moments = np.sort([b + c, a + c, a + b])
    rates = [draw(st.sampled_from([-1, 1])) * 10.0 ** draw(st.floats(-20.0, 0.0)) for _ in range(3)]
    zeros = draw(st.integers(0, 7))
    omega = np.array([rate * (zeros >> k & 1) for k, rate in enumerate(rates)])
    return moments, omega


@settings(max_examples=400)
@given(starts(), scales(), scales(), st.floats(-15.0, 15.0))
def test_any_body_at_any_scale_keeps_energy_and_momentum(
    start: Any, size: float, pace: float, exponent: float
) -> None:
    moments, omega = start
    speed = np.linalg.norm(omega) * pace
    t = np.array([0.0, 0.3, 1.0]) * (10.0**exponent / speed if speed else 1.0)
    motion = RigidBody.from_principal(1.0, moments * size).free_motion(omega * pace, START).at(t)
    assert np.isfinite(motion.omega).all()
    np.testing.assert_allclose(np.linalg.norm(motion.quaternion, axis=-1), 1, rtol=1e-15)
    rates = motion.omega / (speed or 1.0)
    energy = rates**2 @ moments
    np.testing.assert_allclose(energy, energy[0], rtol=1e-14)
    momentum = Rotation.from_quat(motion.quaternion).apply(rates * moments)
    assert np.abs(momentum - momentum[0]).max() <= 1e-14 * np.linalg.norm(momentum[0])


def test_shapes_are_those_of_the_stack_and_of_the_times() -> None:
    bodies = RigidBody.from_principal(1.0, [[1.0, 2.0, 2.5], [1.0, 1.0, 1.5], [2.0, 2.0, 2.0]])
    omega = np.array([0.3, 0.2, 1.1]) * np.arange(1, 5)[:, None, None]
    motion = bodies.free_motion(omega)
    assert motion.shape == (4, 3)
    times = np.linspace(0, 3, 10).reshape(2, 5)
    states = motion.at(times)
    assert states.omega.shape == (4, 3, 2, 5, 3)
    assert states.quaternion.shape == (4, 3, 2, 5, 4)
    assert motion.at(1.0).omega.shape == (4, 3, 3)
    energies = states.kinetic_energy().total
    assert energies.shape == (4, 3, 2, 5)
    np.testing.assert_allclose(energies, np.broadcast_to(energies[:, :, :1, :1], energies.shape), rtol=1e-14)
    single = bodies[0].free_motion(omega[0, 0]).at(2.0)
    np.testing.assert_allclose(single.kinetic_energy().total, energies[0, 0, 0, 0], rtol=1e-14)
    assert single.angular_momentum().total.shape == (3,)
    assert repr(single) == "Trajectory(1 times from 2 to 2)"
    one = bodies[1].free_motion(omega[2, 0]).at(times[1, 3])
    assert np.array_equal(one.omega, states.omega[2, 1, 1, 3])
    assert np.array_equal(one.quaternion, states.quaternion[2, 1, 1, 3])


def test_many_states_have_the_bits_of_one() -> None:
    motion = RigidBody.from_principal(1.0, [[1.0, 2.0, 2.5], [1.5, 3.0, 4.0]]).free_motion((4.0, 1.0, 3.0))
    times = np.random.default_rng(3).normal(size=20_001) * 1e4
    states = motion.at(times)
    for k in (0, 4096, 17_000, 20_000):
        assert np.array_equal(motion.at(times[k]).omega, states.omega[:, k])
        assert np.array_equal(motion.at(times[k]).quaternion, states.quaternion[:, k])


def test_the_quaternion_is_continuous() -> None:
    for moments, omega in CASES.values():
        motion = RigidBody.from_principal(1.0, moments).free_motion(omega)
        times = np.linspace(-30, 30, 6001) / np.linalg.norm(omega)
        steps = np.diff(motion.at(times).quaternion, axis=0)
        assert np.linalg.norm(steps, axis=1).max() < 0.0051


def test_rates_must_be_finite_and_times_need_not() -> None:
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    with pytest.raises(errors.PolhodeError, match="omega must be finite"):
        body.free_motion((0.0, np.nan, 1.0))
    states = body.free_motion((0.3, 0.2, 1.1)).at([0.0, np.nan, np.inf])
    assert np.isfinite(states.omega[0]).all()
    assert np.isnan(states.omega[1:]).all()
    assert np.isnan(states.quaternion[1:]).all()


def test_pickles_and_tells_what_it_is() -> None:
    motion = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5)).free_motion((0.3, 0.2, 1.1), START)
    again = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(again.at(12.3).quaternion, motion.at(12.3).quaternion)
    assert repr(motion) == "<FreeMotion: short-axis, omega=[0.3, 0.2, 1.1]>"
    stack = motion.body.free_motion(np.ones((3, 1, 3)))
    assert repr(stack) == "<FreeMotion stack of shape (3, 1): 3 motions>"
    assert np.array_equal(motion.omega, (0.3, 0.2, 1.1))


# Every regime against forty digits, up to 1e6 rotations.

TABLE = load_table("free_motion")


@pytest.mark.parametrize("case", TABLE, ids=lambda case: case.name)
def test_every_regime(case: MotionCase) -> None:
    full = "inertia" in case.body
    body = RigidBody(**case.body) if full else RigidBody.from_principal(**case.body)
    motion = body.free_motion(case.omega, case.attitude).at(np.array(case.times))
    bar = 1e-13 if full else 1e-14
    for t, omega, quaternion, want in zip(
        case.times, motion.omega, motion.quaternion, case.expected, strict=True
    ):
        assert angle(quaternion, want.quaternion) <= bar, f"attitude at t = {t:g}"
        assert relative_error(omega, want.omega) <= bar, f"rates at t = {t:g}"


def test_one_time_and_many_agree_to_the_last_bit() -> None:
    case = TABLE[0]
    motion = RigidBody.from_principal(**case.body).free_motion(case.omega, case.attitude)
    together = motion.at(np.array(case.times))
    for i, t in enumerate(case.times):
        alone = motion.at(t)
        assert np.array_equal(alone.omega, together.omega[i])
        assert np.array_equal(alone.quaternion, together.quaternion[i])


# Random bodies, from needles to near-spheres, up to 1e12 rotations, against elliptic functions.

SEED = 20261121
ROTATIONS = np.array([1.0, 10.0, 1e3, 1e6, 1e9, 1e12])


class Start(NamedTuple):
    moments: np.ndarray
    omega: np.ndarray
    attitude: np.ndarray
    times: np.ndarray


def random_starts(count: int) -> list[Start]:
    """Second moments over three decades, rates over two; the first `count` of one endless sequence."""
    rng = np.random.default_rng(SEED)
    drawn: list[Start] = []
    while len(drawn) < count:
        x, y, z = 10.0 ** rng.uniform(-3.0, 0.0, 3)
        moments = np.sort([y + z, z + x, x + y])
        omega = rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 0.0, 3)
        attitude = rng.normal(size=4)
        rotation = 2 * np.pi * moments[1] / np.linalg.norm(moments * omega)
        times = ROTATIONS * rotation * rng.uniform(0.5, 1.0, len(ROTATIONS))
        drawn.append(Start(moments, omega, attitude / np.linalg.norm(attitude), times))
    return drawn


def random_errors(start: Start) -> list[float]:
    """The larger of the angle and the relative error of ω, at each time."""
    exact = JacobiMotion(start.moments, start.omega, start.attitude)
    body = RigidBody.from_principal(1.0, start.moments)
    motion = body.free_motion(start.omega, start.attitude).at(start.times)
    worst = []
    for t, omega, quaternion in zip(start.times, motion.omega, motion.quaternion, strict=True):
        rates, attitude = exact.at(t)
        worst.append(max(angle(quaternion, attitude), relative_error(omega, rates)))
    return worst


def assert_errors(count: int) -> None:
    found = np.array([random_errors(start) for start in random_starts(count)])
    assert (np.median(found, axis=0) <= 2e-15).all()
    assert found[:, ROTATIONS <= 1e6].max() <= 1e-13
    assert found.max() <= 1e-10


@pytest.mark.timeout(600)
def test_forty_random_bodies() -> None:
    assert_errors(40)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_nine_hundred_random_bodies() -> None:
    assert_errors(900)
