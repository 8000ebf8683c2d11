"""Particles in place of a body, against exact sums over them."""

from __future__ import annotations

from fractions import Fraction
from typing import Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import worst_error
from oracles.bodies import Body, bodies
from oracles.exact_particles import Particles as ExactParticles
from polhode import Particles, RigidBody, equimomental, solids
from polhode.errors import InvalidInertiaError, PolhodeError


class TestSmallestSet:
    @given(body=bodies())
    def test_it_has_the_bodys_mass_center_and_tensor(self, body: Body) -> None:
        made = RigidBody.from_principal(*body)
        found = made.equimomental_particles()
        assert isinstance(found, Particles)
        exact = ExactParticles(found.masses, found.positions)
        assert len(set(found.masses.tolist())) == 1
        assert abs(float(exact.mass) - body.mass) <= 1e-15 * body.mass
        reach = body.gyration + float(np.linalg.norm(body.center_of_mass))
        assert worst_error(made.center_of_mass, exact.center_of_mass, scale=reach) < 1e-15
        # Coordinates are rounded to their distance from the origin.
        scale = body.mass * body.gyration * reach
        assert worst_error(made.inertia, exact.inertia, scale=scale) < 4e-15

    @pytest.mark.parametrize(
        ("size", "count"),
        [
            ((1.0, 2.0, 3.0), 4),
            ((1.0, 1.0, 1.0), 4),
            ((1e-3, 1e-3, 1.0), 4),
            ((1e-9, 1e-9, 1.0), 4),
            ((1.0, 2.0, 1e-5), 4),
            ((1.0, 2.0, 0.0), 3),
            ((1.0, 1.0, 0.0), 3),
            ((1.0, 1e-4, 0.0), 3),
            ((0.0, 0.0, 2.0), 2),
            ((0.0, 0.0, 0.0), 1),
        ],
    )
    @pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
    def test_as_many_as_the_rank_and_one(
        self, size: tuple[float, ...], count: int, scale: float, rng: np.random.Generator
    ) -> None:
        q = rng.normal(size=4)
        body = solids.box(scale * np.array(size), mass=3.0).rotated(q / np.linalg.norm(q))
        found = body.equimomental_particles()
        assert found.masses.shape == (count,)
        assert found.positions.shape == (count, 3)
        exact = ExactParticles(found.masses, found.positions)
        if count > 1:
            assert worst_error(body.inertia, exact.inertia) < 4e-15

    def test_particles_of_a_rod_and_of_a_plate_are_few_again(self, rng: np.random.Generator) -> None:
        direction = rng.normal(size=3)
        rod = RigidBody.from_particles(rng.uniform(1, 2, 9), np.outer(rng.normal(size=9), direction))
        assert rod.equimomental_particles().masses.shape == (2,)
        plate = rng.normal(size=(9, 2)) @ rng.normal(size=(2, 3))
        assert RigidBody.from_particles(np.ones(9), plate).equimomental_particles().masses.shape == (3,)

    def test_they_move_as_the_body_does(self) -> None:
        body = solids.ellipsoid((1.0, 2.0, 3.0), mass=2.0).translated((0.5, 0.0, 1.0))
        twin = RigidBody.from_particles(*body.equimomental_particles())
        t, omega = np.linspace(0, 10, 11), (0.3, 1.0, -0.2)
        points: tuple[Literal["center_of_mass", "origin"], ...] = ("center_of_mass", "origin")
        for about in points:
            one = body.simulate(t, omega, about=about, rtol=1e-12)
            two = twin.simulate(t, omega, about=about, rtol=1e-12)
            assert np.abs(one.omega - two.omega).max() < 1e-10

    def test_stacks_of_one_kind(self) -> None:
        found = solids.cube(np.ones((2, 5)), mass=1.0).equimomental_particles()
        assert found.masses.shape == (2, 5, 4)
        assert found.positions.shape == (2, 5, 4, 3)
        again = RigidBody.from_particles(*found)
        assert again.isclose(solids.cube(1.0, mass=1.0)).all()
        mixed = solids.box([(1.0, 1.0, 1.0), (1.0, 1.0, 0.0)], mass=1.0)
        with pytest.raises(ValueError, match=r"first needs 4, the one at flat index 1 needs 3"):
            mixed.equimomental_particles()

    def test_moments_that_no_masses_have(self) -> None:
        body = RigidBody.from_principal(1.0, [1.0, 1.0, 2.01], rtol=0.01)
        with pytest.raises(InvalidInertiaError, match="triangle"):
            body.equimomental_particles()


class TestStick:
    @given(
        mass=st.floats(0.1, 10),
        k2=st.floats(0.1, 2),
        a=st.floats(0.2, 4),
        slack=st.floats(1.001, 3),
        x=st.floats(-5, 5),
    )
    def test_mass_center_and_moment_about_every_parallel_axis(
        self, mass: float, k2: float, a: float, slack: float, x: float
    ) -> None:
        """mex143: I₀ + m x²."""
        inertia, b = mass * k2, slack * k2 / a
        found = equimomental.stick(mass, inertia, a, b)
        assert (found.masses >= 0).all()
        m, z = [Fraction(v) for v in found.masses], [Fraction(v) for v in found.positions[:, 2]]
        assert abs(float(sum(m)) - mass) <= 1e-15 * mass
        first = sum(p * q for p, q in zip(m, z, strict=True))
        assert abs(float(first)) <= 1e-15 * float(m[0]) * a
        moment = sum(p * (q - Fraction(x)) ** 2 for p, q in zip(m, z, strict=True))
        largest = float(m[0]) * (a - x) ** 2 + float(m[1]) * (b + x) ** 2 + mass * x * x
        assert abs(float(moment) - (inertia + mass * x * x)) <= 4e-15 * largest

    def test_the_printed_masses(self) -> None:
        m, I0, a, b = 6.0, 4.0, 1.0, 2.0
        found = equimomental.stick(m, I0, a, b)
        assert found.masses == pytest.approx(
            [I0 / (a * (a + b)), I0 / (b * (a + b)), m - I0 / (a * b)], rel=1e-15
        )
        assert found.positions.tolist() == [[0, 0, 1], [0, 0, -2], [0, 0, 0]]

    def test_it_is_the_rod(self) -> None:
        rod = solids.box((0.0, 0.0, 3.0), mass=2.0)
        twin = RigidBody.from_particles(*equimomental.stick(2.0, 1.5, 1.0, 2.0))
        assert twin.isclose(rod, rtol=1e-14, atol=1e-15)

    def test_a_negative_third_mass_is_refused_with_the_least_product(self) -> None:
        with pytest.raises(PolhodeError, match=r"-1\.0.*negative.*a b of at least inertia/mass = 2\.0"):
            equimomental.stick(1.0, 2.0, 1.0, 1.0)
        with pytest.raises(PolhodeError, match="row 1"):
            equimomental.stick(1.0, [1.0, 2.0], 1.0, 1.0)
        assert equimomental.stick(1.0, 2.0, 1.0, 2.0).masses[2] == 0.0

    @pytest.mark.parametrize(
        ("arguments", "word"),
        [
            ((-1.0, 1.0, 1.0, 1.0), "mass"),
            ((1.0, -1.0, 1.0, 1.0), "inertia"),
            ((1.0, 1.0, 0.0, 1.0), "a must be positive"),
            ((1.0, 1.0, 1.0, -2.0), "b must be positive"),
            ((np.nan, 1.0, 1.0, 1.0), "mass"),
            ((1.0, 1.0, np.inf, 1.0), "a must be finite"),
        ],
    )
    def test_impossible_arguments(self, arguments: tuple[float, ...], word: str) -> None:
        with pytest.raises(ValueError, match=word):
            equimomental.stick(*arguments)

    def test_stacks_broadcast(self) -> None:
        found = equimomental.stick(np.ones((4, 1)), 0.5, [1.0, 2.0], 1.0)
        assert found.masses.shape == (4, 2, 3)
        assert found.positions.shape == (4, 2, 3, 3)
