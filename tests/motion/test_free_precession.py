"""The torque-free symmetric top, against its angular momentum and against its simulated motion."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import attitudes, matrix, vectors
from polhode import FreePrecession, RigidBody, euler_angles, solids, tops
from polhode.errors import PolhodeError


def angle(u: np.ndarray, v: np.ndarray) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v))


@given(
    ratio=st.one_of(st.floats(0.0, 0.95), st.floats(1.05, 2.0)),
    across=st.floats(0.1, 10),
    q=attitudes(),
    omega=vectors(),
)
def test_axis_momentum_and_rates(ratio: float, across: float, q: np.ndarray, omega: np.ndarray) -> None:
    axes = matrix(q)
    body = RigidBody.from_principal(1.0, [across, across, ratio * across], axes)
    if np.linalg.norm(omega) < 1e-3:
        omega = np.array([0.3, -0.2, 1.0])
    found = tops.free_precession(body, omega)
    assert isinstance(found, FreePrecession)
    n, momentum = found.axis, body.angular_momentum(omega).total
    size = float(np.linalg.norm(omega))
    assert abs(abs(n @ axes[:, 2]) - 1) < 1e-15 * 4
    spin = omega @ n
    assert spin >= -1e-15 * size
    assert abs(found.body_rate - (ratio - 1) * spin) < 1e-14 * size
    assert abs(found.space_rate - np.linalg.norm(momentum) / across) < 1e-14 * size
    assert abs(found.body_cone - angle(n, omega)) < 1e-14
    assert abs(found.nutation - angle(n, momentum)) < 1e-14 / max(ratio, 0.05)
    assert abs(found.space_cone - angle(momentum, omega)) < 1e-14 / max(ratio, 0.05)
    # The cones touch along ω: inside each other for an oblate top, side by side for a prolate one.
    touching = found.nutation + (found.space_cone if ratio > 1 else -found.space_cone)
    assert abs(touching - found.body_cone) < 1e-15 * 4


@pytest.mark.parametrize("moments", [(2.0, 2.0, 3.0), (2.0, 2.0, 0.5), (2.0, 2.0, 0.0)])
def test_the_motion_is_that_of_the_euler_angles(moments: tuple[float, float, float]) -> None:
    """With L along z: θ = nutation, φ̇ = space_rate, ψ̇ = −body_rate."""
    body = RigidBody.from_principal(1.0, moments)
    omega = np.array([0.3, 0.4, 1.2])
    found = tops.free_precession(body, omega)
    assert found.axis.tolist() == [0.0, 0.0, 1.0]
    # Attitude that puts L along z: sin ψ : cos ψ = L_x : L_y.
    start = np.array([0.0, found.nutation, np.arctan2(0.3, 0.4)])
    t = np.linspace(0, 20, 201)
    motion = body.simulate(t, omega, euler_angles.to_quaternion(start), rtol=1e-13)
    direction = motion.angular_momentum().total
    assert np.abs(direction / np.linalg.norm(direction, axis=1)[:, None] - [0, 0, 1]).max() < 1e-11
    want = start + t[:, None] * np.array([found.space_rate, 0.0, -found.body_rate])
    got = np.unwrap(motion.euler_angles(), axis=0)
    assert np.abs(got - want).max() < 1e-9
    rates = motion.euler_rates()
    assert np.abs(rates - [found.space_rate, 0.0, -found.body_rate]).max() < 1e-10


def test_limits() -> None:
    sphere = tops.free_precession(solids.sphere(1.0, mass=1.0), (0.0, 3.0, 4.0))
    assert (sphere.body_rate, sphere.space_rate, sphere.space_cone) == (0.0, 5.0, 0.0)
    spinning = tops.free_precession(solids.cylinder(1.0, 0.0, mass=1.0), (0.0, 0.0, -3.0))
    assert (spinning.body_cone, spinning.space_cone, spinning.nutation) == (0.0, 0.0, 0.0)
    assert spinning.axis.tolist() == [0.0, 0.0, -1.0]
    rod = tops.free_precession(solids.box((0, 0, 1.0), mass=1.0), (0.0, 2.0, 5.0))
    assert (rod.space_rate, rod.body_rate) == (2.0, -5.0)
    assert rod.nutation == pytest.approx(np.pi / 2, rel=1e-15)


def test_about_a_fixed_point() -> None:
    top = solids.cone(1.0, 3.0, mass=2.0).translated((0.0, 0.0, 1.0))
    held = tops.free_precession(top, (0.1, 0.0, 2.0), about="origin")
    inertia = top.inertia_about("origin")
    assert held.body_rate == pytest.approx(2 * (inertia[2, 2] / inertia[0, 0] - 1), rel=1e-14)


def test_what_is_no_symmetric_top_is_refused_with_its_gap() -> None:
    with pytest.raises(
        PolhodeError, match=r"no symmetric top.*5\.0, 10\.0, 13\.0.*2\.31e-1.*integrate with simulate"
    ):
        tops.free_precession(solids.box((1.0, 2.0, 3.0), mass=12.0), (1, 2, 3))
    nearly = RigidBody.from_principal(1.0, (1.0, 1.0 + 1e-4, 1.5))
    with pytest.raises(PolhodeError, match="symmetric top"):
        tops.free_precession(nearly, (0, 0, 1))
    assert tops.free_precession(nearly, (0, 0, 1), rtol=1e-3).body_rate == pytest.approx(0.5, rel=1e-3)
    with pytest.raises(PolhodeError, match="transverse moment"):
        tops.free_precession(solids.sphere(0.0, mass=1.0), (0, 0, 1))
    with pytest.raises(ValueError, match="rtol"):
        tops.free_precession(nearly, (0, 0, 1), rtol=-1.0)


def test_stacks_broadcast() -> None:
    stack = solids.cylinder([1.0, 2.0], 0.1, mass=1.0)
    found = tops.free_precession(stack, np.ones((5, 1, 3)))
    assert found.axis.shape == (5, 2, 3)
    assert all(part.shape == (5, 2) for part in found[1:])
    with pytest.raises(ValueError, match="omega"):
        tops.free_precession(stack, (1.0, 2.0))
