"""I ω̇ + ω×I ω = N, forward and inverse, against exact rational arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from oracles import Exact, dot, rational, worst_error
from oracles.bodies import Body, bodies, vectors
from oracles.exact_particles import cross
from polhode import RigidBody, solids

BOX = solids.box((1.0, 2.0, 3.0), mass=12.0)  # moments 13, 10, 5 about x, y, z


def apply(tensor: Exact, vector: Exact) -> list[Fraction]:
    return [dot(row, vector) for row in tensor]


def exact_torque(tensor: Any, omega: Any, rate: Any) -> list[Fraction]:
    """I ω̇ + ω×I ω."""
    I, w, a = rational(tensor), rational(omega), rational(rate)
    return [x + y for x, y in zip(apply(I, a), cross(w, apply(I, w)), strict=True)]


@given(body=bodies(), omega=vectors(), rate=vectors())
def test_torque_is_exact(body: Body, omega: np.ndarray, rate: np.ndarray) -> None:
    made = RigidBody.from_principal(*body)
    scale = body.moments[2] * (np.linalg.norm(rate) + np.linalg.norm(omega) ** 2)
    if scale > 0:
        got = made.torque(omega, rate)
        assert worst_error(got, exact_torque(made.inertia, omega, rate), scale=scale) <= 2e-15


@given(body=bodies(thinnest=3), omega=vectors(), torque=vectors())
def test_angular_acceleration_needs_exactly_the_torque(
    body: Body, omega: np.ndarray, torque: np.ndarray
) -> None:
    made = RigidBody.from_principal(*body)
    torque = torque * body.moments[2]
    rate = made.angular_acceleration(omega, torque)
    scale = body.moments[2] * (np.linalg.norm(rate) + np.linalg.norm(omega) ** 2) + np.linalg.norm(torque)
    if scale > 0:
        residual = [
            x - y for x, y in zip(exact_torque(made.inertia, omega, rate), rational(torque), strict=True)
        ]
        assert max(abs(float(x)) for x in residual) <= 4e-15 * scale


@pytest.mark.parametrize("about", ["center_of_mass", "origin", (0.3, -0.2, 1.0)])
def test_forward_and_inverse_undo_each_other(about: Any, rng: np.random.Generator) -> None:
    body = BOX.translated((0.5, 1.0, -0.25))
    omega, rate = rng.normal(size=(50, 3)), rng.normal(size=(50, 3))
    again = body.angular_acceleration(omega, body.torque(omega, rate, about=about), about=about)
    assert np.abs(again - rate).max() < 2e-14


def test_about_a_fixed_point_the_tensor_about_that_point_rules() -> None:
    body, omega, rate = BOX.translated((0.5, 1.0, -0.25)), np.array([1.0, -2, 0.5]), np.array([0.1, 0.2, 0.3])
    for about in ("origin", (0.3, -0.2, 1.0)):
        tensor = body.inertia_about(about)
        assert worst_error(body.torque(omega, rate, about=about), exact_torque(tensor, omega, rate)) < 2e-15
    assert np.array_equal(body.torque(omega, rate), BOX.torque(omega, rate))


def test_principal_axes_give_the_textbook_form() -> None:
    rate = BOX.angular_acceleration((1.0, 2.0, 3.0))
    assert rate == pytest.approx([(10 - 5) * 6 / 13, (5 - 13) * 3 / 10, (13 - 10) * 2 / 5], rel=1e-15)


@given(body=bodies(thinnest=3))
def test_rotation_about_a_principal_axis_is_steady(body: Body) -> None:
    made = RigidBody.from_principal(*body)
    for axis in made.principal.axes.T:
        # The axis itself is rounded, so the residue is ε times the largest ratio of moments.
        residue = np.linalg.norm(made.angular_acceleration(axis))
        assert residue <= 8e-16 * body.moments[2] / body.moments[0]


def test_a_sphere_has_no_gyroscopic_torque(rng: np.random.Generator) -> None:
    ball = solids.sphere(1.0, mass=5.0)
    assert not ball.angular_acceleration(rng.normal(size=(20, 3))).any()


def test_free_bodies_keep_energy_and_momentum_at_every_instant(rng: np.random.Generator) -> None:
    omega = rng.normal(size=(100, 3))
    rate = BOX.angular_acceleration(omega)
    power = np.einsum("ni,ij,nj->n", omega, BOX.inertia, rate)
    growth = np.einsum("ni,ij,jk,nk->n", omega, BOX.inertia, BOX.inertia, rate)
    assert np.abs(power).max() < 1e-13
    assert np.abs(growth).max() < 1e-12


class TestZeroMoments:
    """An axis with zero moment: ω along it stays constant, a torque along it has no answer."""

    rod = RigidBody.from_principal(1.0, [0.0, 1.0, 1.0])

    def test_rate_along_the_axis_stays(self) -> None:
        rate = self.rod.angular_acceleration((3.0, 2.0, 1.0))
        assert rate.tolist() == [0.0, 3.0, -6.0]

    def test_a_torque_along_the_axis_is_an_error(self) -> None:
        with pytest.raises(ValueError, match=r"(?i)torque.*(zero|axis|moment)"):
            self.rod.angular_acceleration((0.0, 0.0, 0.0), torque=(1.0, 0.0, 0.0))

    def test_a_torque_across_the_axis_is_none(self) -> None:
        assert self.rod.angular_acceleration((0.0, 0, 0), torque=(0.0, 2.0, 3.0)).tolist() == [0.0, 2.0, 3.0]

    def test_a_point_keeps_any_rate(self) -> None:
        point = RigidBody.from_principal(1.0, [0.0, 0.0, 0.0])
        assert not point.angular_acceleration((1.0, 2.0, 3.0)).any()

    def test_a_linear_molecule_in_any_attitude_is_a_rod(self, rng: np.random.Generator) -> None:
        """Its moment along itself is zero, or rounding: neither may leak into ω̇ = (ω·n) ω×n."""
        for _ in range(100):
            n = rng.normal(size=3)
            n /= np.linalg.norm(n)
            atoms = np.array([-1.1, 0.0, 1.1])[:, None] * n + rng.normal(size=3)
            body = RigidBody.from_particles([16.0, 12.0, 16.0], atoms)
            omega = rng.normal(size=3)
            want = (omega @ n) * np.cross(omega, n)
            assert np.abs(body.angular_acceleration(omega) - want).max() < 1e-13 * (omega @ omega)

    def test_a_rod_about_its_end_is_a_rod(self, rng: np.random.Generator) -> None:
        for _ in range(100):
            n = rng.normal(size=3)
            n /= np.linalg.norm(n)
            body = RigidBody.from_particles([1.0, 2.0], np.array([[0.5], [2.0]]) * n)
            omega = rng.normal(size=3)
            want = (omega @ n) * np.cross(omega, n)
            assert np.abs(body.angular_acceleration(omega, about="origin") - want).max() < 1e-13 * (
                omega @ omega
            )

    def test_the_row_is_named(self) -> None:
        with pytest.raises(ValueError, match=r"\b2\b"):
            self.rod.angular_acceleration(np.zeros((4, 3)), torque=[[0.0, 0, 0]] * 2 + [[1.0, 0, 0]] * 2)


class TestShapes:
    def test_bodies_rates_and_torques_broadcast(self) -> None:
        stack = solids.cube([1.0, 2.0], mass=1.0)
        assert stack.angular_acceleration(np.zeros((5, 1, 3))).shape == (5, 2, 3)
        assert stack.torque((1.0, 0, 0), np.zeros((5, 1, 3)), about="origin").shape == (5, 2, 3)
        assert BOX.torque(np.zeros((0, 3))).shape == (0, 3)

    def test_each_argument_is_named(self) -> None:
        mistakes: list[tuple[Callable[[], object], str]] = [
            (lambda: BOX.torque((1.0, 2.0)), r"omega.*shape \(\.\.\., 3\), got \(2,\)"),
            (lambda: BOX.torque((1.0, 2.0, 3.0), (1.0,)), r"angular_acceleration.*shape"),
            (lambda: BOX.angular_acceleration((1.0, 2, 3), np.zeros((2, 2))), r"torque.*shape"),
            (lambda: BOX.torque((1.0, 2, 3), about="center"), r"about"),
        ]
        for make, words in mistakes:
            with pytest.raises(ValueError, match=f"(?i){words}"):
                make()
