"""Steady precession and the sleeping limit of the heavy symmetric top."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf
from oracles.bodies import attitudes, matrix
from polhode import RigidBody, euler_angles, loads, solids, tops
from polhode._core import rotate
from polhode.errors import PolhodeError

G = (0.0, 0.0, -9.81)


def make(I_s: float, I_t: float, length: float, axes: np.ndarray) -> RigidBody:
    """A top of unit mass with its centre of mass on its axis, `length` from the pivot."""
    return RigidBody.from_principal(1.0, (I_t, I_t, I_s), axes, center_of_mass=length * axes[:, 2])


tops_and_angles = given(
    ratio=st.one_of(st.floats(0.05, 0.95), st.floats(1.05, 2.0)),
    across=st.floats(0.1, 10),
    length=st.floats(0.1, 3),
    q=attitudes(),
    theta=st.floats(0.05, 3.1),
    factor=st.floats(1.001, 50),
)


@tops_and_angles
def test_the_rates_are_the_roots(
    ratio: float, across: float, length: float, q: np.ndarray, theta: float, factor: float
) -> None:
    """I_t φ̇² cos θ − I_s ω_s φ̇ + m g l = 0, in 50 digits."""
    body = make(ratio * across, across, length, matrix(q))
    spin = factor * float(tops.least_spin(body, G, theta)) or 2.0
    slow, fast = tops.steady_precession(body, spin, theta, G)
    with mp.workdps(50):
        I_s, I_t = mpf(ratio * across), mpf(across) + mpf(length) ** 2
        a, b, c = I_t * mpmath.cos(mpf(theta)), I_s * mpf(spin), mpf(9.81) * mpf(length)
        root = mpmath.sqrt(b * b - 4 * a * c)
        want = sorted([(b - root) / (2 * a), (b + root) / (2 * a)], key=abs)
        # Near the least spin the root of the difference is ill-conditioned: b²/root of the rounding.
        allowed = mpf(1e-14) * max(1, (b / root) ** 2)
        assert abs(slow / want[0] - 1) < allowed
        assert abs(fast / want[1] - 1) < allowed


@tops_and_angles
def test_the_least_spin(
    ratio: float, across: float, length: float, q: np.ndarray, theta: float, factor: float
) -> None:
    body = make(ratio * across, across, length, matrix(q))
    sleeping = tops.least_spin(body, G)
    I_s, I_t = ratio * across, across + length**2
    assert (I_s * sleeping) ** 2 == pytest.approx(4 * I_t * 9.81 * length, rel=1e-13)
    least = tops.least_spin(body, G, theta)
    assert least == pytest.approx(sleeping * np.sqrt(max(np.cos(theta), 0.0)), rel=1e-13)
    if least > 0:
        with pytest.raises(PolhodeError, match=r"no steady precession.*slower than the least"):
            tops.steady_precession(body, least / factor, theta, G)


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("theta", [0.6, 2.2])
def test_a_top_started_so_precesses_so(which: int, theta: float) -> None:
    body = make(3e-4, 2e-4, 0.04, np.eye(3))
    spin = 250.0
    rate = float(tops.steady_precession(body, spin, theta, G)[which])
    rates = np.array([rate, 0.0, spin - rate * np.cos(theta)])
    angles = np.array([0.2, theta, 0.0])
    load = loads.torque_callback(
        lambda _t, _omega, q: np.cross(body.center_of_mass, rotate(q, np.array(G), inverse=True))
    )
    t = np.linspace(0, 0.5, 26)
    motion = body.simulate(
        t,
        euler_angles.angular_velocity(angles, rates),
        euler_angles.to_quaternion(angles),
        load=load,
        about="origin",
        rtol=1e-13,
    )
    found = motion.euler_angles()
    assert np.abs(found[:, 1] - theta).max() < 1e-9
    assert np.abs(motion.euler_rates() - rates).max() < 1e-6 * abs(rate) + 1e-7


@pytest.mark.parametrize(("factor", "sleeps"), [(1.05, True), (0.95, False)])
def test_an_upright_top_sleeps_above_the_limit_only(factor: float, sleeps: bool) -> None:
    body = make(3e-4, 2e-4, 0.04, np.eye(3))
    omega = (1e-6, 0.0, factor * tops.least_spin(body, G))
    load = loads.torque_callback(
        lambda _t, _omega, q: np.cross(body.center_of_mass, rotate(q, np.array(G), inverse=True))
    )
    motion = body.simulate(np.linspace(0, 3, 301), omega, load=load, about="origin", rtol=1e-11)
    lean = np.linalg.norm(motion.point("center_of_mass")[:, :2], axis=1).max() / 0.04
    assert (lean < 1e-5) == sleeps


class TestLimits:
    def test_a_conical_pendulum(self) -> None:
        bob = solids.sphere(0.0, mass=2.0).translated((0.0, 0.0, 0.5))
        theta = 2.0
        rates = tops.steady_precession(bob, 0.0, theta, G)
        want = np.sqrt(9.81 / (0.5 * -np.cos(theta)))
        assert np.abs(rates) == pytest.approx([want, want], rel=1e-14)
        assert rates[0] * rates[1] < 0
        assert tops.least_spin(bob, G) == np.inf
        assert tops.least_spin(bob, G, theta) == 0.0

    def test_without_weight_it_is_the_free_top(self) -> None:
        body = make(3.0, 2.0, 0.5, np.eye(3))
        slow, fast = tops.steady_precession(body, 4.0, 0.7, (0.0, 0.0, 0.0))
        assert slow == 0.0
        assert fast == pytest.approx(3.0 * 4.0 / ((2.0 + 0.25) * np.cos(0.7)), rel=1e-15)
        held = RigidBody.from_principal(1.0, (2.0, 2.0, 3.0))
        assert tops.least_spin(held, G) == 0.0
        assert tops.steady_precession(held, 0.0, 0.7, G).tolist() == [0.0, 0.0]

    def test_the_fast_top_of_the_textbooks(self) -> None:
        body = make(3.0, 2.0, 0.5, np.eye(3))
        slow, fast = tops.steady_precession(body, 1e6, 0.7, G)
        assert slow == pytest.approx(9.81 * 0.5 / 3e6, rel=1e-10)
        assert fast == pytest.approx(3e6 / (2.25 * np.cos(0.7)), rel=1e-10)

    def test_a_ball_on_a_stick(self) -> None:
        """Every axis of a ball is one of symmetry; the line to the pivot is the one that counts."""
        ball = solids.sphere(0.1, mass=1.0).translated((0.3, 0.0, 0.4))
        want = 2 * np.sqrt((0.004 + 0.25) * 9.81 * 0.5) / 0.004
        assert tops.least_spin(ball, G) == pytest.approx(want, rel=1e-14)


class TestErrors:
    def test_asymmetric_bodies_and_pivots_off_the_axis(self) -> None:
        with pytest.raises(PolhodeError, match=r"no symmetric top.*simulate"):
            tops.least_spin(solids.box((1.0, 2.0, 3.0), mass=1.0), G)
        cone = solids.cone(1.0, 3.0, mass=1.0)
        with pytest.raises(PolhodeError, match=r"pivot.*symmetry axis.*0\.01.*translated"):
            tops.least_spin(cone.translated((0.01, 0.0, 1.0)), G)
        assert tops.least_spin(cone.translated((1e-9, 0.0, 1.0)), G) > 0
        with pytest.raises(PolhodeError, match="row 1"):
            tops.steady_precession(cone.translated([(0, 0, 1.0), (0, 1.0, 1.0)]), 1e3, 0.3, G)
        with pytest.raises(PolhodeError, match="positive for a top"):
            tops.least_spin(solids.sphere(0.0, mass=1.0), G)

    def test_stacks_broadcast_and_a_nan_stays_in_its_row(self) -> None:
        stack = solids.cone([1.0, 2.0], 3.0, mass=1.0).translated((0.0, 0.0, 2.25))
        assert tops.least_spin(stack, G).shape == (2,)
        assert tops.least_spin(stack, G, np.zeros((5, 1))).shape == (5, 2)
        got = tops.steady_precession(stack, np.array([[1e3], [np.nan], [1e4]]), 0.5, G)
        assert got.shape == (3, 2, 2)
        assert np.isnan(got[1]).all()
        assert np.isfinite(got[[0, 2]]).all()
        with pytest.raises(ValueError, match="gravity: expected shape"):
            tops.least_spin(stack, 9.81)
        with pytest.raises(TypeError, match="RigidBody"):
            tops.least_spin(1.0, G)  # type: ignore[arg-type]
