"""Rates of Euler angles and ω, both ways, against the derivative of the rotation in 50 digits."""

from __future__ import annotations

from typing import Any, Literal

import mpmath
import numpy as np
import pytest
from euler_sequences import INTRINSIC, SEQUENCES
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf
from oracles.bodies import vectors
from polhode import RigidBody, euler_angles, solids
from polhode.errors import SingularAttitudeError
from scipy.integrate import solve_ivp
from scipy.special import ellipj

FRAMES: tuple[Literal["body", "space"], ...] = ("body", "space")
angle = st.floats(-3.1, 3.1)


def turn(axis: str, angle: mpf, derivative: bool = False) -> Any:
    """Rotation matrix about one axis, or its derivative with respect to the angle."""
    s, c = mpmath.sin(angle), mpmath.cos(angle)
    one = mpf(0) if derivative else mpf(1)
    if derivative:
        s, c = c, -s
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    matrix = mpmath.zeros(3)
    matrix[i, i], matrix[j, j], matrix[k, k] = one, c, c
    matrix[j, k], matrix[k, j] = -s, s
    return matrix


def exact_omega(angles: Any, rates: Any, sequence: str) -> tuple[list[mpf], list[mpf]]:
    """ω in body and in space from Ṙ: [ω]× is Rᵀ Ṙ in the body and Ṙ Rᵀ in space."""
    with mp.workdps(50):
        axes, angles, rates = sequence.lower(), [mpf(x) for x in angles], [mpf(x) for x in rates]
        if sequence.islower():
            axes, angles, rates = axes[::-1], angles[::-1], rates[::-1]
        R, dR = mpmath.eye(3), mpmath.zeros(3)
        for axis, a, rate in zip(axes, angles, rates, strict=True):
            dR = dR * turn(axis, a) + rate * (R * turn(axis, a, derivative=True))
            R = R * turn(axis, a)
        in_body, in_space = R.T * dR, dR * R.T
        body, space = ([W[2, 1], W[0, 2], W[1, 0]] for W in (in_body, in_space))
        return body, space


def divisor(angles: np.ndarray, sequence: str) -> np.ndarray:
    """What the rates of the first and third angle are divided by."""
    middle = angles[..., 1]
    result: np.ndarray = np.abs(np.sin(middle) if sequence[0] == sequence[2] else np.cos(middle))
    return result


@pytest.mark.parametrize("sequence", SEQUENCES)
class TestEverySequence:
    def test_omega_is_that_of_the_turning_matrix(self, sequence: str, rng: np.random.Generator) -> None:
        for _ in range(5):
            angles, rates = rng.uniform(-6, 6, 3), rng.normal(size=3)
            for frame, want in zip(FRAMES, exact_omega(angles, rates, sequence), strict=True):
                got = euler_angles.angular_velocity(angles, rates, sequence, frame)
                worst = max(abs(mpf(x) - y) for x, y in zip(got, want, strict=True))
                assert float(worst) < 1e-15 * np.abs(rates).sum()

    def test_rates_come_back(self, sequence: str, rng: np.random.Generator) -> None:
        angles, rates = rng.uniform(-6, 6, (400, 3)), rng.normal(size=(400, 3))
        size = (np.abs(rates).sum(axis=1) / divisor(angles, sequence))[:, None]
        for frame in ("body", "space"):
            omega = euler_angles.angular_velocity(angles, rates, sequence, frame)
            back = euler_angles.rates(angles, omega, sequence, frame)
            assert (np.abs(back - rates) / size).max() < 2e-15

    def test_near_the_pole_they_solve_the_equation(self, sequence: str) -> None:
        pole = 0.0 if sequence[0] == sequence[2] else np.pi / 2
        omega = np.array([0.3, -1.1, 0.7])
        for offset in (1e-3, 1e-6, 1e-9, 1e-11):
            angles = np.array([0.4, pole + offset, -1.2])
            rates = euler_angles.rates(angles, omega, sequence)
            again = euler_angles.angular_velocity(angles, rates, sequence)
            assert np.abs(again - omega).max() < 1e-15 * np.abs(rates).max()

    def test_the_pole_is_told_or_not_a_number(self, sequence: str) -> None:
        pole = 0.0 if sequence[0] == sequence[2] else np.pi / 2
        angles = np.array([[0.4, 0.7, 0.1], [0.4, pole, -1.2], [0.3, np.nan, 0.0], [0.4, pole + 2e-12, 0.2]])
        omega = euler_angles.angular_velocity(angles[1], (0.5, -0.8, 1.1), sequence)
        with pytest.raises(
            SingularAttitudeError, match=rf'row 1.*"{sequence}".*middle angle.*singular="nan"'
        ):
            euler_angles.rates(angles, omega, sequence)
        rates = euler_angles.rates(angles, omega, sequence, singular="nan")
        assert np.isnan(rates[1, [0, 2]]).all()
        assert abs(rates[1, 1] + 0.8) < 1e-15, "the middle rate is defined"
        assert np.isfinite(rates[[0, 3]]).all()
        assert np.isnan(rates[2]).any()


class TestTextbook:
    @given(phi=angle, theta=st.floats(0.1, 3.0), psi=angle, rates=vectors())
    def test_msl26(self, phi: float, theta: float, psi: float, rates: np.ndarray) -> None:
        dphi, dtheta, dpsi = rates
        omega = euler_angles.angular_velocity((phi, theta, psi), rates)
        want = [
            dphi * np.sin(theta) * np.sin(psi) + dtheta * np.cos(psi),
            dphi * np.sin(theta) * np.cos(psi) - dtheta * np.sin(psi),
            dphi * np.cos(theta) + dpsi,
        ]
        size = np.abs(rates).sum()
        assert np.abs(omega - want).max() <= 1e-15 * size
        square = dphi**2 + dtheta**2 + dpsi**2 + 2 * dphi * dpsi * np.cos(theta)
        assert abs(omega @ omega - square) <= 2e-15 * size**2

    def test_mex174_a_box_that_turns_about_its_own_y_and_about_the_vertical(
        self, rng: np.random.Generator
    ) -> None:
        """R_NB = Rz(β) Ry(α): T = ½ (I₁ β̇² sin²α + I₂ α̇² + I₃ β̇² cos²α)."""
        box = solids.box(rng.uniform(0.5, 3.0, (50, 3)), mass=rng.uniform(0.5, 3.0, 50))
        alpha, beta, da, db = rng.uniform(-3, 3, (4, 50))
        zero = np.zeros(50)
        angles, rates = np.column_stack([beta, alpha, zero]), np.column_stack([db, da, zero])
        energy = box.kinetic_energy(euler_angles.angular_velocity(angles, rates, "ZYX")).total
        I1, I2, I3 = np.moveaxis(np.diagonal(box.inertia, axis1=1, axis2=2), -1, 0)
        want = 0.5 * (I1 * db**2 * np.sin(alpha) ** 2 + I2 * da**2 + I3 * db**2 * np.cos(alpha) ** 2)
        assert (np.abs(energy - want) / ((I1 + I2 + I3) * (da**2 + db**2))).max() < 1e-15

    @pytest.mark.parametrize("sequence", ["ZXZ", "ZYX", "xyz"])
    def test_mln27_both_steps_agree_with_the_quaternions(self, sequence: str) -> None:
        """First ω(t) by Jacobi's functions, then the angles by the kinematic equations."""
        I = np.array([1.0, 2.0, 2.5])
        body = RigidBody.from_principal(1.0, I)
        start = np.array([0.8, 0.0, 1.5])  # about the largest moment, ω₂ = 0: cn = dn = 1
        L2, T2 = ((I * start) ** 2).sum(), (I * start**2).sum()
        p = np.sqrt((L2 - T2 * I[0]) * (I[2] - I[1]) / I.prod())
        m = (T2 * I[2] - L2) * (I[1] - I[0]) / ((L2 - T2 * I[0]) * (I[2] - I[1]))
        second = np.sqrt((T2 * I[2] - L2) / (I[1] * (I[2] - I[1])))

        def omega(t: Any) -> np.ndarray:
            sn, cn, dn, _ = ellipj(p * t, m)
            return np.stack([start[0] * cn, second * sn, start[2] * dn], axis=-1)

        angles = np.array([0.3, 0.9, -0.4])
        t = np.linspace(0.0, 4.0, 41)
        route = body.simulate(t, start, euler_angles.to_quaternion(angles, sequence), rtol=1e-13)
        found = np.unwrap(route.euler_angles(sequence), axis=0)
        assert divisor(found, sequence).min() > 0.05, "the motion must stay away from the singularity"
        assert np.abs(route.omega - omega(t)).max() < 1e-11

        def rates(t: Any, y: np.ndarray) -> np.ndarray:
            return euler_angles.rates(y, omega(t), sequence)

        steps = solve_ivp(rates, (0.0, 4.0), angles, "DOP853", t, rtol=1e-13, atol=1e-13)
        assert np.abs(steps.y.T - found).max() < 1e-10
        assert np.abs(route.euler_rates(sequence) - rates(t, found)).max() < 1e-9


class TestShapes:
    def test_stacks_broadcast(self) -> None:
        angles = np.full((4, 1, 3), 0.5)
        assert euler_angles.angular_velocity(angles, np.ones((5, 3))).shape == (4, 5, 3)
        assert euler_angles.rates(angles, np.ones((5, 3))).shape == (4, 5, 3)
        assert euler_angles.rates(np.zeros((0, 3)), np.ones(3)).shape == (0, 3)

    def test_a_stack_has_the_bits_of_its_rows(self, rng: np.random.Generator) -> None:
        angles, omega = rng.uniform(0.2, 2.8, (5000, 3)), rng.normal(size=(5000, 3))
        whole = euler_angles.rates(angles, omega)
        for i in (0, 1, 1023, 1024, 4999):
            assert np.array_equal(euler_angles.rates(angles[i], omega[i]), whole[i])

    def test_options_are_checked(self) -> None:
        for arguments, word in (
            ({"sequence": "ZZX"}, "sequence"),
            ({"frame": "inertial"}, "frame"),
            ({"singular": "ignore"}, "singular"),
            ({"angles": (1.0, 2.0)}, "angles"),
            ({"omega": 1.0}, "omega"),
        ):
            given_: dict[str, Any] = {"angles": (0.1, 0.2, 0.3), "omega": (1, 2, 3), **arguments}
            with pytest.raises(ValueError, match=word):
                euler_angles.rates(**given_)
        with pytest.raises(ValueError, match="rates: expected shape"):
            euler_angles.angular_velocity((0.1, 0.2, 0.3), (1.0, 2.0))


def test_extrinsic_rates_are_intrinsic_ones_reversed(rng: np.random.Generator) -> None:
    angles, rates = rng.uniform(-3, 3, (50, 3)), rng.normal(size=(50, 3))
    for sequence in INTRINSIC:
        one = euler_angles.angular_velocity(angles, rates, sequence)
        two = euler_angles.angular_velocity(angles[:, ::-1], rates[:, ::-1], sequence[::-1].lower())
        assert np.array_equal(one, two)
