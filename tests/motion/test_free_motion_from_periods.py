"""Free motions from two periods: published asteroids, round trips, what no body can do."""

from __future__ import annotations

import re
from typing import Literal, TypeAlias

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import Body, bodies
from polhode import RigidBody, euler_angles
from polhode.errors import PolhodeError
from scipy.integrate import quad
from scipy.special import ellipk

APOPHIS = (0.61, 0.965, 1.0)
Mode: TypeAlias = Literal["long-axis", "short-axis"]


def test_toutatis() -> None:
    """Its moments and periods (Hudson and Ostro, Science 270 (1995) 84) give the tilt of the long axis."""
    body = RigidBody.from_principal(1.0, (1.0, 3.01307, 3.18992))  # of the radar shape
    motion = body.free_motion_from_periods(5.41, 7.35, mode="long-axis")
    assert motion.mode == "long-axis"
    np.testing.assert_allclose(np.degrees(motion.nutation[0]), [49.18, 50.10], atol=0.005)
    # The nodding is there in the motion itself.
    state = motion.at(np.linspace(0, 5.41, 2001))
    axis = state.rotation.apply(body.principal.axes[:, 0])
    tilt = np.degrees(np.arccos(axis[:, 2]))
    np.testing.assert_allclose([tilt.min(), tilt.max()], [49.18, 50.10], atol=0.005)


def test_apophis() -> None:
    """Three published numbers, ratios of moments and two periods, give the fourth: E/E0 = 1.024 ± 0.013."""
    body = RigidBody.from_principal(1.0, APOPHIS)
    motion = body.free_motion_from_periods(263.0, 27.38, mode="short-axis")
    assert motion.energy_ratio == pytest.approx(1.0286, abs=1e-4)
    assert _ratio_by_quadrature(APOPHIS, motion.omega) == pytest.approx(263.0 / 27.38, rel=1e-10)
    radar = RigidBody.from_principal(1.0, (0.7304, 0.9474, 1.0))
    found = radar.free_motion_from_periods(263.0, 27.38, mode="short-axis")
    assert found.energy_ratio == pytest.approx(1.0378, abs=1e-4)


def _ratio_by_quadrature(moments: tuple[float, float, float], omega: np.ndarray) -> float:
    """P_ψ/P_φ in short-axis mode, with φ̇ integrated in the amplitude by SciPy."""
    I, w = np.array(moments), np.array(omega)
    square, double = np.sum((I * w) ** 2), np.sum(I * w**2)
    D1, D3 = square - double * I[0], double * I[2] - square
    m = (I[1] - I[0]) * D3 / ((I[2] - I[1]) * D1)
    rate = np.sqrt((I[2] - I[1]) * D1 / I.prod())
    a = np.sqrt([D3 / (I[0] * (I[2] - I[0])), D3 / (I[1] * (I[2] - I[1])), D1 / (I[2] * (I[2] - I[0]))])

    def precession(phi: float) -> float:
        s = np.sin(phi)
        d = np.sqrt(1 - m * s * s)
        y, z = a[1] * s, a[2] * d
        energy, momentum = I[1] * y * y + I[2] * z * z, (I[1] * y) ** 2 + (I[2] * z) ** 2
        return float(np.sqrt(square) * energy / momentum / d)

    mean = quad(precession, 0, np.pi / 2, epsabs=0, epsrel=1e-12)[0] / ellipk(m)
    return float(4 * ellipk(m) / rate * mean / (2 * np.pi))


@given(
    body=bodies(thinnest=2),
    omega=st.tuples(*[st.floats(0.05, 1.0)] * 3),
    sense=st.sampled_from([1, -1]),
)
def test_periods_lead_back_to_the_motion(body: Body, omega: tuple[float, ...], sense: int) -> None:
    made = RigidBody.from_principal(*body)
    if np.diff(body.moments).min() < 1e-3 * body.moments[2]:
        return
    motion = made.free_motion(made.principal.axes @ (np.array(omega) * [sense, 1, sense]))
    if motion.complementary_modulus < 1e-3:
        return
    periods = motion.periods
    again = made.free_motion_from_periods(periods.rotation, periods.precession, mode=motion.mode, sense=sense)
    assert again.mode == motion.mode
    assert again.periods.rotation == pytest.approx(periods.rotation, rel=1e-12)
    assert again.periods.precession == pytest.approx(periods.precession, rel=1e-12)
    # Near a steady spin the ratio hardly depends on the energy.
    assert again.energy_ratio == pytest.approx(motion.energy_ratio, rel=1e-9)
    np.testing.assert_allclose(again.nutation, motion.nutation, atol=1e-5)


@pytest.mark.parametrize("mode", ["long-axis", "short-axis"])
@pytest.mark.parametrize("sense", [1, -1])
def test_phase_sense_and_direction(mode: Mode, sense: int) -> None:
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    periods = (9.0, 5.0)
    start = body.free_motion_from_periods(*periods, mode, sense)
    circled, crossed = (0, 2) if mode == "long-axis" else (2, 0)
    assert np.sign(start.omega[circled]) == sense
    assert start.omega[1] == 0.0
    assert start.omega[crossed] > 0
    for phase in (0.2, 0.25, 0.7, -3.4):
        later = body.free_motion_from_periods(*periods, mode, sense, phase)
        np.testing.assert_allclose(later.omega, start.at(phase * 9.0).omega, atol=1e-13)
    L = start.angular_momentum().spin
    np.testing.assert_allclose(L / np.linalg.norm(L), [0, 0, 1], atol=1e-15)
    # The long axis as the third of Euler's angles: φ = 0.
    third = start.at(0.0).rotation.apply((1.0, 0.0, 0.0))
    phi = np.arctan2(third[0], -third[1])
    assert phi == pytest.approx(0.0, abs=1e-15)
    for direction in [(1.0, 2.0, -2.0), (0.0, 0.0, -5e-200), (3e200, 0.0, 0.0)]:
        aimed = body.free_motion_from_periods(*periods, mode, sense, 0.3, direction).angular_momentum().spin
        unit = np.array(direction) / np.abs(direction).max()
        unit /= np.linalg.norm(unit)
        np.testing.assert_allclose(aimed / np.linalg.norm(aimed), unit, atol=1e-15)


def test_euler_angles_of_the_long_axis_have_the_periods() -> None:
    """In a body frame with the long axis third φ goes once around in P_φ on the mean, ψ in P_ψ."""
    order = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # axes 1, 2, 3: z, x, y
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5), order.T)
    motion = body.free_motion_from_periods(8.0, 5.0, mode="long-axis")
    t = np.linspace(0, 40.0, 8001)
    angles = np.unwrap(euler_angles.from_quaternion(motion.at(t).quaternion), axis=0)
    assert angles[0, 0] == pytest.approx(0.0, abs=1e-14)
    turns = (angles[-1] - angles[0]) / (2 * np.pi)
    assert turns[2] == pytest.approx(40.0 / 8.0, rel=1e-12)
    assert turns[0] == pytest.approx(40.0 / 5.0, rel=1e-12)


def test_a_symmetric_body_in_closed_form() -> None:
    """A prolate body has P_ψ/P_φ = I_s/((I_t − I_s) cos θ)."""
    body = RigidBody.from_principal(1.0, (0.5, 2.0, 2.0))
    motion = body.free_motion_from_periods(3.0, 4.0, mode="long-axis")
    assert np.cos(motion.nutation[0]) == pytest.approx([0.5 / 1.5 * 4 / 3] * 2, rel=1e-12)
    with pytest.raises(PolhodeError, match=r"no short-axis mode.*0\.5, 2\.0, 2\.0.*free_motion"):
        body.free_motion_from_periods(3.0, 4.0, mode="short-axis")


def test_what_no_motion_has_is_refused_with_the_reach() -> None:
    body = RigidBody.from_principal(1.0, APOPHIS)
    with pytest.raises(
        PolhodeError, match=r"short-axis motion.*= 5\.0:.*0\.61, 0\.965, 1\.0.*from 6\.566928 "
    ):
        body.free_motion_from_periods(5.0, 1.0, mode="short-axis")
    radar = RigidBody.from_principal(1.0, (0.7304, 0.9474, 1.0))
    with pytest.raises(PolhodeError, match=r"from 6\.985448 "):
        radar.free_motion_from_periods(6.0, 1.0, mode="short-axis")
    # In closed form: 1/√(α₁α₂), and 1/√(α₂α₃) − 1.
    first, second, third = 0.035 / 0.61, 0.39 / 0.965, 0.355
    limits: dict[Mode, float] = {
        "short-axis": (first * second) ** -0.5,
        "long-axis": (second * third) ** -0.5 - 1,
    }
    for mode, least in limits.items():
        body.free_motion_from_periods(least * (1 + 1e-9), 1.0, mode=mode)
        with pytest.raises(PolhodeError, match=f"{mode} motion"):
            body.free_motion_from_periods(least * (1 - 1e-9), 1.0, mode=mode)
        with pytest.raises(PolhodeError, match="separatrix"):
            body.free_motion_from_periods(1e4, 1.0, mode=mode)
    sphere = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
    with pytest.raises(PolhodeError, match="long-axis mode"):
        sphere.free_motion_from_periods(1.0, 1.0, mode="long-axis")


NEEDLE = (3.7336506454180177e-19, 6.846093914796246e-7, 6.84609391479998e-7)


@pytest.mark.parametrize("moments", [APOPHIS, (1.0, 2.0, 2.5), (0.01, 1.0, 1.0001), NEEDLE])
@pytest.mark.parametrize("mode", ["long-axis", "short-axis"])
def test_what_is_near_the_separatrix_has_its_periods_or_is_refused(
    moments: tuple[float, ...], mode: Mode
) -> None:
    """The periods grow without bound towards the separatrix, where the last bits of ω decide on them."""
    body = RigidBody.from_principal(1.0, moments)
    with pytest.raises(PolhodeError, match="the separatrix") as caught:
        body.free_motion_from_periods(1e25, 1.0, mode=mode)
    least, most = map(float, re.findall(r"from (\S+) \(steady spin\) to (\S+) ", str(caught.value))[0])
    for share in (*np.linspace(0.01, 0.9, 9), 0.99, 0.999, 0.99999):
        periods = body.free_motion_from_periods(least + share * (most - least), 1.0, mode=mode).periods
        assert periods.rotation == pytest.approx(least + share * (most - least), rel=1e-9)
        assert periods.precession == pytest.approx(1.0, rel=1e-9)
    with pytest.raises(PolhodeError, match="separatrix"):
        body.free_motion_from_periods(least + 1.0001 * (most - least), 1.0, mode=mode)


def test_arguments() -> None:
    body = RigidBody.from_principal(1.0, (1.0, 3.0, 3.2))
    with pytest.raises(ValueError, match="mode"):
        body.free_motion_from_periods(1.0, 1.0, mode="long")  # type: ignore[arg-type]
    with pytest.raises(PolhodeError, match=r"row 1: rotation_period.*-1\.0"):
        body.free_motion_from_periods([1.0, -1.0], 1.0, "long-axis")
    with pytest.raises(PolhodeError, match="precession_period"):
        body.free_motion_from_periods(1.0, np.nan, "long-axis")
    with pytest.raises(PolhodeError, match=r"sense must be \+1 or -1, got 2\.0"):
        body.free_motion_from_periods(1.0, 1.0, "long-axis", sense=2)
    with pytest.raises(PolhodeError, match="phase"):
        body.free_motion_from_periods(1.0, 1.0, "long-axis", phase=np.inf)
    with pytest.raises(PolhodeError, match="angular_momentum_direction"):
        body.free_motion_from_periods(1.0, 1.0, "long-axis", angular_momentum_direction=(0, 0, 0))
    stack = body.free_motion_from_periods([1.0, 1.1], 1.0, "long-axis", phase=[[0.0], [0.5], [0.7]])
    assert stack.shape == (3, 2)
