"""L = m R×v + m [R×(ω×c_P) + c_P×v] + I_P ω about the inertial origin, against the sum over particles."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from oracles.bodies import Body, bodies, vectors
from oracles.exact_particles import Particles
from polhode import AngularMomentum, RigidBody, solids

ABOUT: list[Any] = ["center_of_mass", "origin", (0.5, -1.0, 0.25)]


@pytest.mark.parametrize("about", ABOUT)
def test_the_total_is_the_sum_over_the_particles(about: Any, rng: np.random.Generator) -> None:
    for _ in range(20):
        masses, positions = rng.uniform(0.5, 2, 6), rng.normal(size=(6, 3))
        body, exact = RigidBody.from_particles(masses, positions), Particles(masses, positions)
        words = {"center_of_mass": exact.center_of_mass, "origin": [0, 0, 0]}
        point = words[about] if isinstance(about, str) else about
        omega, velocity, position = rng.normal(size=(3, 3))
        want = [float(x) for x in exact.angular_momentum(omega, velocity, position, point)]
        parts = body.angular_momentum(omega, velocity, position, about=about)
        size = sum(float(np.linalg.norm(x)) for x in parts)
        assert np.abs(parts.total - want).max() <= 8e-15 * size


def test_about_the_center_of_mass_it_is_orbital_plus_spin(rng: np.random.Generator) -> None:
    body = solids.box((1.0, 2.0, 3.0), mass=12.0).translated(rng.normal(size=3))
    parts = body.angular_momentum((1.0, 2.0, 3.0), velocity=(0.0, 2.0, 0.0), position=(3.0, 0.0, 0.0))
    assert isinstance(parts, AngularMomentum)
    assert parts.orbital.tolist() == [0.0, 0.0, 72.0]
    assert parts.mixed.tolist() == [0.0, 0.0, 0.0]
    assert parts.spin == pytest.approx([13.0, 20.0, 15.0], rel=1e-15)
    assert parts.total == pytest.approx([13.0, 20.0, 87.0], rel=1e-15)


def test_about_a_fixed_point_it_is_spin_alone() -> None:
    rod = solids.box((0.0, 0.0, 3.0), mass=2.0).translated((0.0, 0.0, -1.5))
    parts = rod.angular_momentum((2.0, 0.0, 0.0), about="origin")
    assert not parts.orbital.any()
    assert not parts.mixed.any()
    assert parts.spin == pytest.approx([12.0, 0.0, 0.0], rel=1e-15)


@given(body=bodies(decades=3), omega=vectors(), velocity=vectors(), position=vectors(), offset=vectors())
def test_the_total_does_not_depend_on_the_point(
    body: Body, omega: np.ndarray, velocity: np.ndarray, position: np.ndarray, offset: np.ndarray
) -> None:
    made = RigidBody.from_principal(*body)
    length = body.gyration
    home = made.angular_momentum(omega, velocity * length, position * length)
    point = body.center_of_mass + offset * length
    arm = point - body.center_of_mass
    there = made.angular_momentum(
        omega, velocity * length + np.cross(omega, arm), position * length + arm, about=point
    )
    # Position and velocity of P are themselves rounded, each at its own size.
    orbit = body.mass * length**2 * np.linalg.norm(position) * np.linalg.norm(velocity)
    size = orbit + sum(float(np.linalg.norm(x)) for x in (*there, *home))
    assert np.abs(there.total - home.total).max() <= 2e-14 * size


def test_energy_is_half_omega_times_spin(rng: np.random.Generator) -> None:
    body = solids.ellipsoid((1.0, 2.0, 3.0), density=1.0)
    omega = rng.normal(size=(10, 3))
    spin = body.angular_momentum(omega).spin
    assert body.kinetic_energy(omega).rotational == pytest.approx((omega * spin).sum(axis=1) / 2, rel=1e-14)


def test_stacks_broadcast() -> None:
    stack = solids.cube([1.0, 2.0], mass=1.0)
    parts = stack.angular_momentum(np.ones((5, 1, 3)), velocity=np.zeros(3), position=np.zeros(3))
    assert all(part.shape == (5, 2, 3) for part in parts)
    assert parts.total.shape == (5, 2, 3)


def test_each_argument_is_named() -> None:
    body = solids.cube(1.0, mass=1.0)
    for arguments, word in (
        ({"omega": (1.0, 2.0)}, "omega"),
        ({"omega": (1.0, 2.0, 3.0), "velocity": 1.0}, "velocity"),
        ({"omega": (1.0, 2.0, 3.0), "position": (1.0, 1.0)}, "position"),
        ({"omega": (1.0, 2.0, 3.0), "about": "here"}, "about"),
    ):
        with pytest.raises(ValueError, match=word):
            body.angular_momentum(**arguments)
