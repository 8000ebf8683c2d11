"""Near the separatrix and on it, up to 1e12 turns, against elliptic functions of eighty digits."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from oracles.jacobi import JacobiMotion
from oracles.lagrange import LagrangeTop
from oracles.motion_cases import angle, relative_error
from oracles.near_separatrix import Start, TopStart, complement, exact_axes, starts, top_starts
from oracles.rotation import conjugate
from oracles.rotation import times as product
from polhode import RigidBody

BAR = 1e-14
IDENTITY = (0.0, 0.0, 0.0, 1.0)


def worst(motion: Any, exact: Any, times: np.ndarray) -> float:
    """The largest angle and relative error of ω at the times."""
    found = motion.at(times)
    errors = []
    for t, omega, quaternion in zip(times, found.omega, found.quaternion, strict=True):
        rates, attitude = exact.at(t)
        errors.append(max(angle(quaternion, attitude), relative_error(omega, rates)))
    return max(errors)


def assert_free(start: Start) -> None:
    motion = RigidBody.from_principal(1.0, start.moments).free_motion(start.omega, start.attitude)
    k = complement(start.moments, start.omega)
    assert motion.mode == ("short-axis" if k > 0 else "long-axis")
    assert motion.complementary_modulus == pytest.approx(abs(k), rel=2e-15)
    exact = JacobiMotion(start.moments, start.omega, start.attitude, digits=60)
    assert worst(motion, exact, start.times) <= BAR, start
    assert motion.periods.flip == pytest.approx(float(2 * exact._K / exact.p), rel=1e-14)


def assert_top(start: TopStart) -> None:
    mass, moments, height, omega, attitude, gravity, times = start
    body = RigidBody.from_principal(mass, moments, center_of_mass=(0.0, 0.0, height))
    top = body.heavy_top(omega, attitude, gravity=(0.0, 0.0, -gravity))
    exact = LagrangeTop(mass, moments, height, omega, attitude, gravity, digits=70)
    assert worst(top, exact, times) <= BAR, start
    assert top.nutation_period == pytest.approx(float(exact.period), rel=2e-15)


@pytest.mark.timeout(120)
@pytest.mark.parametrize("start", starts(12), ids=range(12))
def test_free_bodies(start: Start) -> None:
    assert_free(start)


@pytest.mark.timeout(120)
@pytest.mark.parametrize("start", top_starts(6), ids=range(6))
def test_tops(start: TopStart) -> None:
    assert_top(start)


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_a_thousand_free_bodies() -> None:
    for start in starts(1000, seed=1):
        assert_free(start)


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_five_hundred_tops() -> None:
    for start in top_starts(500, seed=1):
        assert_top(start)


TURN = np.array([[0.6, -0.64, 0.48], [0.8, 0.48, -0.36], [0.0, 0.6, 0.8]])


class Turned:
    """The motion seen in a frame B in which the principal axes are the columns of an exact rotation."""

    def __init__(self, moments: Any, axes: Any, omega: Any, attitude: Any) -> None:
        with mp.workdps(100):
            self.axes = axes
            self.turn = mpmath.matrix(axes)
            inside = list(self.turn.T * mpmath.matrix([mpf(x) for x in omega]))
            self.quaternion = _quaternion_of(self.turn)
            self.inner = JacobiMotion(
                moments, inside, product([mpf(x) for x in attitude], self.quaternion), digits=80
            )

    def at(self, t: float) -> tuple[list[mpf], list[mpf]]:
        with mp.workdps(100):
            omega, attitude = self.inner.at(t)
            return list(self.turn * mpmath.matrix(omega)), product(attitude, conjugate(self.quaternion))


def _quaternion_of(R: Any) -> list[mpf]:
    w = mpmath.sqrt(1 + R[0, 0] + R[1, 1] + R[2, 2]) / 2
    return [
        (R[2, 1] - R[1, 2]) / (4 * w),
        (R[0, 2] - R[2, 0]) / (4 * w),
        (R[1, 0] - R[0, 1]) / (4 * w),
        w,
    ]


@pytest.mark.parametrize("form", ["tensor", "axes"])
@pytest.mark.parametrize("tilt", [0.0, 1e-12, 1e-7, 1e-3])
def test_spin_about_the_rounded_intermediate_axis(form: str, tilt: float) -> None:
    """What ω has across the axis is the rounding of its components: 1e-16, known to all of its digits."""
    moments = (1.0, 2.0, 2.5)
    tensor = TURN @ np.diag(moments) @ TURN.T
    tensor = (tensor + tensor.T) / 2
    body = RigidBody(1.0, tensor) if form == "tensor" else RigidBody.from_principal(1.0, moments, axes=TURN)
    exact_moments, axes = exact_axes(tensor if form == "tensor" else None, body.principal.axes)
    omega = TURN[:, 1] + tilt * TURN[:, 2]
    motion = body.free_motion(omega)
    exact = Turned(exact_moments or moments, axes, omega, IDENTITY)
    times = 2 * np.pi * np.array([1.0, 1e3, 1e6, 1e9, 1e12])
    assert worst(motion, exact, times) <= BAR


@pytest.mark.parametrize("seed", range(8))
def test_exactly_on_it_with_full_numbers(seed: int) -> None:
    """I = s (3, 4, 6), ω = r (2, …, 1): 6·2·1 = 3·1·4, whatever the bits of s and r."""
    rng = np.random.default_rng(seed)
    s, r = (float(rng.integers(2**49, 2**50) | 1) * 2.0**-50 for _ in range(2))
    moments, omega = np.array([3 * s, 4 * s, 6 * s]), np.array([2 * r, rng.normal(), r])
    assert complement(moments, omega) == 0.0
    body = RigidBody.from_principal(1.0, moments)
    motion = body.free_motion(omega)
    assert (motion.mode, motion.complementary_modulus) == ("separatrix", 0.0)
    assert motion.periods.flip == np.inf
    # For ever on its way to the intermediate axis.
    late = motion.at(1e12).omega
    assert abs(abs(late[1]) - np.linalg.norm(motion.angular_momentum().spin) / moments[1]) <= 1e-15
    for away, mode in ((np.inf, "short-axis"), (0.0, "long-axis")):
        beside = omega.copy()
        beside[2] = np.nextafter(omega[2], away)
        near = body.free_motion(beside)
        assert near.mode == mode
        assert near.complementary_modulus == pytest.approx(abs(complement(moments, beside)), rel=2e-15)


def test_a_tensor_exactly_on_it() -> None:
    """An exact tensor with irrational axes, ω in the plane of axes 1 and 3 on the separatrix."""
    # Axes (1, 1, 0)/√2, (0, 0, 1), (1, −1, 0)/√2: I₁ = 3, I₂ = 4, I₃ = 6, ω = 2√2 a₁ + √2 a₃.
    tensor = [[4.5, -1.5, 0.0], [-1.5, 4.5, 0.0], [0.0, 0.0, 4.0]]
    motion = RigidBody(1.0, tensor).free_motion((3.0, 1.0, 0.25))
    assert motion.mode == "separatrix"
    assert motion.at(1e9).omega[:2] == pytest.approx([0.0, 0.0], abs=1e-14)


def test_a_steady_spin_about_an_irrational_axis() -> None:
    """ω = (1, 1, 0) is along the intermediate axis of this tensor: nothing is left across it."""
    tensor = [[4.5, -0.5, 0.0], [-0.5, 4.5, 0.0], [0.0, 0.0, 3.0]]  # 4 along (1, 1, 0), 5 along (1, −1, 0)
    motion = RigidBody(1.0, tensor).free_motion((1.0, 1.0, 0.0))
    assert motion.mode == "steady"
    assert motion.at(1e9).omega.tolist() == [1.0, 1.0, 0.0]
