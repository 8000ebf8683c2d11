"""T = ½ m v² + m v·(ω×c_P) + ½ ω·I_P·ω, against the sum over particles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from oracles import rational
from oracles.bodies import Body, bodies, vectors
from oracles.exact_particles import Particles
from polhode import KineticEnergy, RigidBody, solids

ABOUT: list[Any] = ["center_of_mass", "origin", (0.5, -1.0, 0.25)]


def particles(rng: np.random.Generator, count: int = 6) -> tuple[RigidBody, Particles]:
    masses, positions = rng.uniform(0.5, 2, count), rng.normal(size=(count, 3))
    return RigidBody.from_particles(masses, positions), Particles(masses, positions)


def point_of(about: Any, exact: Particles) -> Any:
    """The point that `about` means, in exact coordinates."""
    words = {"center_of_mass": exact.center_of_mass, "origin": [0, 0, 0]}
    return words[about] if isinstance(about, str) else about


@pytest.mark.parametrize("about", ABOUT)
def test_the_total_is_the_sum_over_the_particles(about: Any, rng: np.random.Generator) -> None:
    for _ in range(20):
        body, exact = particles(rng)
        omega, velocity = rng.normal(size=3), rng.normal(size=3)
        want = float(exact.kinetic_energy(omega, velocity, point_of(about, exact)))
        parts = body.kinetic_energy(omega, velocity, about=about)
        size = sum(abs(float(x)) for x in parts)
        assert abs(float(parts.total) - want) <= 8e-15 * size


def test_the_parts_about_the_center_of_mass_are_koenigs(rng: np.random.Generator) -> None:
    body = solids.box((1.0, 2.0, 3.0), mass=12.0).translated(rng.normal(size=3))
    parts = body.kinetic_energy((1.0, 2.0, 3.0), velocity=(0.5, 0.0, 0.0))
    assert isinstance(parts, KineticEnergy)
    assert parts.translational == 1.5
    assert parts.mixed == 0.0
    assert parts.rotational == pytest.approx((13 + 40 + 45) / 2, rel=1e-15)
    assert parts.total == pytest.approx(1.5 + 49.0, rel=1e-15)


def test_a_fixed_point_needs_only_the_tensor_about_it() -> None:
    """A rod swinging about its end: T = ½ (m l²/3) ω²."""
    rod = solids.box((0.0, 0.0, 3.0), mass=2.0).translated((0.0, 0.0, -1.5))
    parts = rod.kinetic_energy((2.0, 0.0, 0.0), about="origin")
    assert parts.translational == 0.0
    assert parts.mixed == 0.0
    assert parts.rotational == pytest.approx(0.5 * 6.0 * 4.0, rel=1e-15)


def test_mex173_a_rolling_cylinder_from_three_points(rng: np.random.Generator) -> None:
    """P on the axis, at the top of the rim, on the line of contact, in units of m v²."""
    mass, radius, v = rng.uniform(0.3, 5.0, (3, 50))
    zero = np.zeros(50)
    cylinder = solids.cylinder(radius, 1.0, mass=mass)
    omega, of_axis = np.column_stack([zero, zero, -v / radius]), np.column_stack([v, zero, zero])
    for height, speed, expected in (
        (0.0, 1, (0.5, 0, 0.25)),
        (1.0, 2, (2, -2, 0.75)),
        (-1.0, 0, (0, 0, 0.75)),
    ):
        point = np.column_stack([zero, height * radius, zero])
        velocity = cylinder.point_velocity(point, omega, of_axis)
        assert np.abs(velocity - speed * of_axis).max() < 1e-15 * v.max()
        parts = cylinder.kinetic_energy(omega, velocity, about=point)
        for part, want in zip(parts, expected, strict=True):
            assert np.abs(part / (mass * v**2) - want).max() < 1e-14


@given(body=bodies(decades=3), omega=vectors(), velocity=vectors(), offset=vectors())
def test_the_total_does_not_depend_on_the_point(
    body: Body, omega: np.ndarray, velocity: np.ndarray, offset: np.ndarray
) -> None:
    """With v_P = v_C + ω×(P − C) the parts change with P and their sum does not."""
    made = RigidBody.from_principal(*body)
    velocity = velocity * body.gyration
    home = made.kinetic_energy(omega, velocity)
    point = body.center_of_mass + offset * body.gyration
    v_p = velocity + np.cross(omega, point - body.center_of_mass)
    there = made.kinetic_energy(omega, v_p, about=point)
    size = sum(abs(float(x)) for x in there) + float(home.total)
    assert abs(float(there.total) - float(home.total)) <= 2e-14 * size


@given(body=bodies(), omega=vectors(), velocity=vectors())
def test_energy_is_never_negative(body: Body, omega: np.ndarray, velocity: np.ndarray) -> None:
    parts = RigidBody.from_principal(*body).kinetic_energy(omega, velocity)
    assert parts.translational >= 0
    assert parts.rotational >= 0


def test_rotational_energy_is_exact(rng: np.random.Generator) -> None:
    body, _ = particles(rng)
    omega = rng.normal(size=3)
    w, tensor = rational(omega), rational(body.inertia)
    want = sum(w[i] * tensor[i][j] * w[j] for i in range(3) for j in range(3)) / 2
    assert float(abs(rational(body.kinetic_energy(omega).rotational) - want) / want) < 2e-15


def test_stacks_broadcast() -> None:
    stack = solids.cube([1.0, 2.0], mass=1.0)
    parts = stack.kinetic_energy(np.ones((5, 1, 3)), velocity=np.zeros(3), about="origin")
    assert all(part.shape == (5, 2) for part in parts)
    assert parts.total.shape == (5, 2)
    assert np.shape(stack[0].kinetic_energy((1.0, 0, 0)).total) == ()


def test_each_argument_is_named() -> None:
    body = solids.cube(1.0, mass=1.0)
    for arguments, word in (
        ({"omega": (1.0, 2.0)}, "omega"),
        ({"omega": (1.0, 2.0, 3.0), "velocity": 1.0}, "velocity"),
        ({"omega": (1.0, 2.0, 3.0), "about": (1.0,)}, "about"),
    ):
        with pytest.raises(ValueError, match=word):
            body.kinetic_energy(**arguments)
