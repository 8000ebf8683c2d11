"""Huygens and Steiner: I_P = I_C + m (d² 1 − d dᵀ) with d = P − C, against exact arithmetic."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from oracles import dot, rational, worst_error
from oracles.bodies import Body, bodies, vectors
from polhode import RigidBody, parallel_axis, solids
from polhode.errors import InvalidInertiaError, PolhodeError


def steiner(body: RigidBody, point: np.ndarray) -> list[list[Fraction]]:
    """I_P, exactly, from the stored mass, centre and tensor."""
    mass, tensor = rational(body.mass), rational(body.inertia)
    d = [p - c for p, c in zip(rational(point), rational(body.center_of_mass), strict=True)]
    square = dot(d, d)
    return [
        [tensor[i][j] + mass * ((square if i == j else 0) - d[i] * d[j]) for j in range(3)] for i in range(3)
    ]


@given(body=bodies(), unit=vectors())
def test_about_any_point(body: Body, unit: np.ndarray) -> None:
    made = RigidBody.from_principal(*body)
    point = body.center_of_mass + unit * body.gyration
    assert worst_error(made.inertia_about(point), steiner(made, point)) <= 4 * 2**-52


@given(body=bodies())
def test_about_the_origin_and_about_the_center_of_mass(body: Body) -> None:
    made = RigidBody.from_principal(*body)
    assert np.array_equal(made.inertia_about("origin"), made.inertia_about(np.zeros(3)))
    assert np.array_equal(made.inertia_about("center_of_mass"), made.inertia)
    assert np.array_equal(made.inertia_about(made.center_of_mass), made.inertia)


@given(body=bodies(), unit=vectors())
def test_the_center_of_mass_has_the_least_moment_of_all_points(body: Body, unit: np.ndarray) -> None:
    made = RigidBody.from_principal(*body)
    point = body.center_of_mass + unit * body.gyration
    axis = np.array([1.0, 2.0, -2.0])
    assert made.moment_about(axis, point) >= made.moment_about(axis) * (1 - 1e-15)
    assert np.trace(made.inertia_about(point)) >= np.trace(made.inertia) * (1 - 1e-15)


def test_a_rod_about_its_end() -> None:
    rod = solids.box((0.0, 0.0, 3.0), mass=2.0)
    assert rod.moment_about((1.0, 0, 0)) == 1.5
    assert rod.moment_about((1.0, 0, 0), about=(0.0, 0.0, 1.5)) == 6.0
    assert rod.moment_about((0.0, 0, 1.0), about=(0.0, 0.0, 1.5)) == 0.0


def test_a_sphere_about_a_tangent() -> None:
    ball = solids.sphere(1.0, mass=5.0)
    assert ball.moment_about((0, 0, 1.0), about=(1.0, 0, 0)) == pytest.approx(7.0, rel=1e-15)


class TestMomentAbout:
    @given(body=bodies(), axis=vectors())
    def test_the_length_of_the_axis_does_not_matter(self, body: Body, axis: np.ndarray) -> None:
        made = RigidBody.from_principal(*body)
        if np.linalg.norm(axis) < 1e-4:
            axis = np.array([1.0, 2.0, 3.0])
        u, tensor = rational(axis), rational(made.inertia)
        exact = sum(u[i] * tensor[i][j] * u[j] for i in range(3) for j in range(3)) / dot(u, u)
        scale = body.moments[2]
        for factor in (1.0, -1.0, 2.0**40, 1e-200, 1e200):
            error = abs(rational(made.moment_about(axis * factor)) - exact)
            assert float(error) <= 4e-15 * scale

    @pytest.mark.parametrize("axis", [(0.0, 0.0, 0.0), (np.nan, 0.0, 1.0), (np.inf, 0.0, 0.0)])
    def test_an_axis_needs_a_direction(self, axis: tuple[float, float, float]) -> None:
        with pytest.raises(ValueError, match="axis"):
            solids.cube(1.0, mass=1.0).moment_about(axis)


class TestShapes:
    def test_points_broadcast_against_bodies(self) -> None:
        stack = solids.cube([1.0, 2.0], mass=1.0)
        assert stack.inertia_about(np.zeros((5, 1, 3))).shape == (5, 2, 3, 3)
        assert stack.moment_about(np.eye(3)[:, None], about="origin").shape == (3, 2)
        assert stack.principal_about((1.0, 0, 0)).moments.shape == (2, 3)

    @pytest.mark.parametrize("about", ["centre", "COM", "", 3, None, (1.0, 2.0), np.zeros((3, 2))])
    def test_the_point_is_one_of_two_words_or_three_numbers(self, about: object) -> None:
        with pytest.raises((TypeError, ValueError), match=r"point|about"):
            solids.cube(1.0, mass=1.0).inertia_about(about)  # type: ignore[arg-type]

    def test_principal_about(self) -> None:
        body = solids.box((1.0, 2.0, 3.0), mass=12.0)
        about = body.principal_about((1.0, 0.0, 0.0))
        assert about.moments == pytest.approx([13.0, 17.0, 22.0], rel=1e-15)
        assert body.principal_about("center_of_mass").moments.tolist() == [5.0, 10.0, 13.0]


class TestBareTensors:
    @given(body=bodies(), unit=vectors())
    def test_from_the_center_of_mass_and_back(self, body: Body, unit: np.ndarray) -> None:
        d = unit * body.gyration
        made = RigidBody.from_principal(body.mass, body.moments, body.axes)
        about = parallel_axis.from_center_of_mass(made.inertia, body.mass, d)
        assert worst_error(about, steiner(made, d)) <= 4 * 2**-52
        assert np.array_equal(about, made.inertia_about(d))
        back = parallel_axis.to_center_of_mass(about, body.mass, -d)
        assert worst_error(back, rational(made.inertia), scale=float(np.trace(about))) <= 4 * 2**-52

    def test_stacks_broadcast_and_a_nan_stays_in_its_row(self) -> None:
        tensors = np.tile(np.diag([1.0, 2.0, 2.5]), (4, 1, 1, 1))
        tensors[2, 0, 1, 1] = np.nan
        got = parallel_axis.from_center_of_mass(tensors, np.ones(5), (0.0, 0.0, 1.0))
        assert got.shape == (4, 5, 3, 3)
        assert np.isnan(got[2, :, 1, 1]).all()
        assert np.array_equal(got[0, 0], np.diag([2.0, 3.0, 2.5]))
        assert np.isnan(parallel_axis.to_center_of_mass(np.eye(3), np.nan, (1.0, 0.0, 0.0))).any()

    @pytest.mark.parametrize("way", [parallel_axis.from_center_of_mass, parallel_axis.to_center_of_mass])
    def test_what_is_no_tensor_and_no_mass_is_named(self, way: Callable[..., object]) -> None:
        with pytest.raises(InvalidInertiaError, match=r"row 1: inertia must be symmetric"):
            way([np.eye(3), np.tri(3)], 1.0, (0, 0, 1))
        with pytest.raises(PolhodeError, match=r"mass must be zero or more.*cavity.*-2\.0"):
            way(np.eye(3), -2.0, (0, 0, 1))
        with pytest.raises(ValueError, match=r"displacement: expected shape \(\.\.\., 3\), got \(2,\)"):
            way(np.eye(3), 1.0, (0, 1))


def test_far_away_and_back_keeps_the_tensor() -> None:
    """The tensor about C is stored: no journey through a remote origin can spoil it."""
    body = solids.box((1e-3, 2e-3, 3e-3), mass=1.0)
    far = body.translated((1e9, -1e9, 1e9))
    assert np.array_equal(far.translated((-1e9, 1e9, -1e9)).inertia, body.inertia)
