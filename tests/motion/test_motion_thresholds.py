"""Where a closed form changes its series or its case, the answer is the exact one on both sides."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from oracles.jacobi import JacobiMotion
from oracles.lagrange import LagrangeTop
from oracles.motion_cases import angle, relative_error, unit_floats
from polhode import RigidBody

BAR = 1e-14
ATTITUDE = unit_floats(0.1, -0.5, 0.3, 0.8)
TIMES = np.array([0.3, 7.0, 1e3, 1e6])


def worst(motion: Any, exact: Any, times: np.ndarray = TIMES) -> float:
    found = motion.at(times)
    errors = []
    for t, omega, quaternion in zip(times, found.omega, found.quaternion, strict=True):
        rates, attitude = exact.at(t)
        errors.append(max(angle(quaternion, attitude), relative_error(omega, rates)))
    return max(errors)


def assert_free(moments: Any, omega: Any, mode: str, times: np.ndarray = TIMES) -> None:
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega, ATTITUDE)
    assert motion.mode == mode
    assert worst(motion, JacobiMotion(moments, omega, ATTITUDE, digits=35), times) <= BAR


def complement_at(ratio: float) -> float:
    """k′ where K′/K is this."""
    with mp.workdps(40):

        def excess(k: mpf) -> mpf:
            return mpmath.elliprf(0, 1 - k * k, 1) - ratio * mpmath.elliprf(0, k * k, 1)

        return float(mpmath.findroot(excess, (mpf("0.01"), mpf("0.99")), solver="anderson"))


SIDES = [0.5, 1 - 1e-3, 1 - 1e-13, 1 + 1e-13, 1 + 1e-3, 2.0]


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("long_axis", [False, True])
def test_free_series_from_sines_to_hyperbolic_functions(side: float, long_axis: bool) -> None:
    """Sines serve while K′ ≥ K/√2."""
    k = complement_at(np.sqrt(0.5)) * side
    moments = np.array([1.0, 2.0, 2.5])
    # ω₂ = 0: k² = I₁(I₂ − I₁) ω₁²/(I₃(I₃ − I₂) ω₃²), or its inverse.
    share = np.sqrt((1 - k * k) * 1.25)
    omega = (1.0, 0.0, 1 / np.sqrt(1.25) * np.sqrt(1 - k * k)) if long_axis else (share, 0.0, 1.0)
    assert_free(moments, omega, "long-axis" if long_axis else "short-axis")


@pytest.mark.parametrize("angle_on_polhode", [-3.0, -1e-9, 1e-9, 3.0])
@pytest.mark.parametrize("k", [0.9, 1e-2, 1e-7])
def test_the_start_from_either_end_of_the_quarter_period(angle_on_polhode: float, k: float) -> None:
    """tan am u tan am (K − u) = 1/k′: the nearer end changes at tan am u = k′^(−1/2)."""
    moments = np.array([1.0, 2.0, 2.5])
    phi = np.arctan(k**-0.5) * np.sign(angle_on_polhode) + angle_on_polhode * 1e-3
    s, c = np.sin(phi), np.cos(phi)
    # a₃ = 1: a₁² = (1 − k²) 5/4, a₂² = a₁² I₁ (I₃ − I₁)/(I₂ (I₃ − I₂)) = 3/2 a₁².
    a1 = np.sqrt((1 - k * k) * 1.25)
    omega = (a1 * c, np.sqrt(1.5) * a1 * s, np.sqrt(c * c + k * k * s * s))
    assert_free(moments, omega, "short-axis")


ULP = 2.0**-52


@pytest.mark.parametrize("ulps", [0, 1, 2, 1000, 2**20, 2**35])
@pytest.mark.parametrize("shape", ["spherical", "oblate", "prolate"])
def test_symmetric_bodies_and_their_neighbours(shape: str, ulps: int) -> None:
    """Equal moments, and moments that differ by a few last bits."""
    gap = ulps * ULP
    moments = {
        "spherical": (1.0, 1.0 + gap, 1.0 + 2 * gap),
        "oblate": (1.0, 1.0 + gap, 1.5),
        "prolate": (1.0, 1.5, 1.5 + gap),
    }[shape]
    omega = (0.4, -0.3, 1.0)
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega, ATTITUDE)
    if ulps == 0:
        assert motion.mode == ("spherical" if shape == "spherical" else "symmetric")
        # The limit of bodies whose moments differ by 1e-40.
        with mp.workdps(60):
            least = mpf(10) ** -40
            exact: Any = [mpf(moment) + k * least for k, moment in enumerate(moments)]
    else:
        exact = moments
        assert motion.mode in ("short-axis", "long-axis")
    assert worst(motion, JacobiMotion(exact, omega, ATTITUDE, digits=110)) <= BAR


@pytest.mark.parametrize("offset", [0.0, 1e-300, 1e-155, 1e-150, 1e-8])
@pytest.mark.parametrize("axis", [0, 2])
def test_steady_spins_and_their_neighbours(axis: int, offset: float) -> None:
    moments, omega = (1.0, 2.0, 2.5), np.zeros(3)
    omega[axis], omega[2 - axis] = 1.25, offset
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega, ATTITUDE)
    assert motion.mode == ("steady" if offset == 0 else "long-axis" if axis == 0 else "short-axis")
    beside = [mpf(x) if x else mpf(10) ** -40 for x in omega.tolist()]
    assert worst(motion, JacobiMotion(moments, beside, ATTITUDE, digits=340 if offset else 120)) <= BAR


@pytest.mark.parametrize("offset", [0.0, 1e-300, 1e-170, 1e-155, 1e-150, 1e-100])
@pytest.mark.parametrize("axis", [0, 2])
def test_spins_about_the_intermediate_axis_and_their_neighbours(axis: int, offset: float) -> None:
    """K = ln 4/k′ is finite however small k′ is."""
    moments, omega = (1.0, 2.0, 2.5), np.array([0.0, 1.25, 0.0])
    omega[axis] = offset
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega, ATTITUDE)
    if offset == 0.0:
        assert motion.mode == "steady"
        assert motion.at(1e6).omega.tolist() == omega.tolist()
        return
    with mp.workdps(40):
        # k′² = I₃ (I₃ − I₁) … to the first order in the offset.
        i1, i2, i3 = map(mpf, moments)
        difference = (i3 * (i3 - i2) if axis == 2 else i1 * (i2 - i1)) * mpf(offset) ** 2
        a, c = (i1, i3) if axis == 2 else (i3, i1)
        m1 = (c - a) * difference / ((c - i2) * i2 * (i2 - a) * mpf(1.25) ** 2)
        rate = mpmath.sqrt((c - i2) * i2 * (i2 - a) * mpf(1.25) ** 2 / (i1 * i2 * i3))
        flip = 2 * mpmath.log(4 / mpmath.sqrt(abs(m1))) / rate
    assert motion.complementary_modulus == pytest.approx(float(mpmath.sqrt(abs(m1))), rel=1e-14)
    assert motion.periods.flip == pytest.approx(float(flip), rel=1e-14)
    later = motion.at(float(flip)).omega
    assert later[1] == pytest.approx(-1.25, rel=1e-12)


@pytest.mark.parametrize("cancelled", [2.0**-n for n in (8, 12, 13, 20)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_where_four_times_the_precision_begins(cancelled: float, side: float) -> None:
    """The two terms of L² − 2T I₂ cancel but for this part."""
    moments = np.array([0.7, 1.1, 1.6])
    third = np.sqrt(0.7 * 0.4 / (1.6 * 0.5) * (1 + side * cancelled))
    times = np.array([1.0, 1e3, 1e6, 1e12])
    assert_free(moments, (1.0, 0.4, third), "short-axis" if side > 0 else "long-axis", times)


def top(omega: Any, theta: float, digits: int = 60) -> tuple[Any, Any]:
    attitude = (np.sin(theta / 2), 0.0, 0.0, np.cos(theta / 2))
    body = RigidBody.from_principal(1.0, (0.75, 0.75, 0.5), center_of_mass=(0.0, 0.0, 0.5))
    motion = body.heavy_top(omega, attitude, gravity=(0.0, 0.0, -4.0))
    return motion, LagrangeTop(1.0, (0.75, 0.75, 0.5), 0.5, omega, attitude, 4.0, digits)


@cache
def even_fall() -> float:
    """ω₁ for which k² = k′² = ½."""
    low, high = 0.1, 1.9
    for _ in range(55):
        middle = (low + high) / 2
        inside = top((middle, 1.2, 4.0), 1.0, digits=25)[1].complement > np.sqrt(0.5)
        low, high = (middle, high) if inside else (low, middle)
    return low


@pytest.mark.parametrize("step", [-0.1, -1e-6, -1e-12, 1e-12, 1e-6, 0.1])
def test_top_series_from_sines_to_hyperbolic_functions(step: float) -> None:
    """Sines serve while K ≤ K′."""
    motion, exact = top((even_fall() + step, 1.2, 4.0), 1.0)
    assert (exact.complement > np.sqrt(0.5)) == (step < 0)
    assert worst(motion, exact) <= BAR


@pytest.mark.parametrize("apart", [2.0**-n for n in (2, 11, 13, 30)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_where_tops_begin_with_four_times_the_precision(apart: float, side: float) -> None:
    """Energy that reaches the upright position but for this part, L_z = L_s."""
    theta = 1.2
    lean = 1 - np.cos(theta)
    second = 0.5 * 3.0 * lean / np.sin(theta)
    first = np.sqrt(4.0 * lean * (1 + side * apart) - second**2)
    motion, exact = top((first, second, 3.0), theta)
    assert worst(motion, exact, np.array([1.0, 1e3, 1e6, 1e12])) <= BAR
