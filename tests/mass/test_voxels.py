"""Bodies of voxels, against exact sums over their cells: each cell a homogeneous box."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import errors as errors_of
from oracles import rational, ulp_errors, worst_error
from oracles.exact_particles import Particles, moments
from polhode import RigidBody, errors, solids


class Cells:
    """Cells in exact arithmetic: particles at their centres, and each cell's own second moment m h²/12."""

    def __init__(self, density: np.ndarray, spacing: Any, origin: Any = (0.0, 0.0, 0.0)) -> None:
        h, at = rational(list(spacing)), rational(list(origin))
        volume = h[0] * h[1] * h[2]
        filled = np.argwhere(density)
        masses = [Fraction(float(density[tuple(cell)])) * volume for cell in filled]
        positions = [[o + e * int(i) for o, e, i in zip(at, h, cell, strict=True)] for cell in filled]
        points = Particles(masses, positions)
        self.mass, self.center_of_mass = points.mass, points.center_of_mass
        square = [e * e / 12 for e in h]
        self.inertia = [
            [x + (points.mass * (sum(square) - square[i]) if i == j else 0) for j, x in enumerate(row)]
            for i, row in enumerate(points.inertia)
        ]


def assert_exact(body: RigidBody, exact: Cells, bar: float = 4e-15) -> None:
    assert worst_error(body.mass, exact.mass) <= bar
    size = (max(max(row) for row in exact.inertia) / exact.mass) ** 0.5
    reach = max(float(size), float(np.abs(body.center_of_mass).max()))
    assert worst_error(body.center_of_mass, exact.center_of_mass, scale=reach) <= bar
    assert worst_error(body.inertia, exact.inertia) <= bar


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(1, 1, 1), (5, 6, 7), (1, 40, 1), (17, 1, 9), (12, 12, 12)])
def test_a_random_grid_has_its_exact_inertia(
    dtype: type, shape: tuple[int, int, int], rng: np.random.Generator
) -> None:
    density: np.ndarray = rng.uniform(0, 3, shape).astype(dtype)
    spacing, origin = (0.1, 0.25, 0.3), (1.0, -20.0, 0.7)
    body = RigidBody.from_voxels(density, spacing, origin)
    assert_exact(body, Cells(density, spacing, origin))


@given(
    shape=st.tuples(*[st.integers(1, 5)] * 3),
    spacing=st.tuples(*[st.floats(0.01, 100)] * 3),
    seed=st.integers(0, 1000),
)
def test_sparse_grids_have_their_exact_inertia(
    shape: tuple[int, int, int], spacing: tuple[float, float, float], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    density = rng.uniform(0, 3, shape) * rng.integers(0, 2, shape)
    density.flat[rng.integers(density.size)] = 1.0
    assert_exact(RigidBody.from_voxels(density, spacing), Cells(density, spacing))


@given(
    shape=st.tuples(*[st.integers(1, 6)] * 3),
    exponents=st.tuples(*[st.integers(-3, 3)] * 4),
    seed=st.integers(0, 1000),
)
def test_the_error_bound_holds(
    shape: tuple[int, int, int], exponents: tuple[int, int, int, int], seed: int
) -> None:
    rng = np.random.default_rng(seed)
    density = rng.uniform(0, 1, shape) * rng.integers(0, 2, shape)
    density.flat[rng.integers(density.size)] = 1.0
    *spacing, reach = rng.uniform(1, 2, 4) * 10.0 ** np.array(exponents)
    origin = reach * rng.normal(size=3)
    body, exact = RigidBody.from_voxels(density, spacing, origin), Cells(density, spacing, origin)
    bound = body.error_bound
    assert max(errors_of(body.mass, exact.mass)) <= bound.mass
    assert max(errors_of(body.center_of_mass, exact.center_of_mass)) <= bound.center_of_mass
    assert max(errors_of(body.inertia, exact.inertia)) <= bound.inertia


def test_cells_of_a_box_are_the_box() -> None:
    box = RigidBody.from_voxels(np.full((8, 8, 8), 2.0), (0.125, 0.25, 0.375), (0.0625, 0.125, 0.1875))
    assert bool(box.isclose(solids.box((1, 2, 3), density=2.0).translated((0.5, 1.0, 1.5)), rtol=1e-15))


def test_matter_in_a_corner_of_a_large_grid_loses_no_digits() -> None:
    density = np.zeros((150, 160, 170), np.float32)
    density[:2, :3, :2] = np.arange(1, 13, dtype=np.float32).reshape(2, 3, 2)
    assert_exact(RigidBody.from_voxels(density, (0.1, 0.1, 0.1)), Cells(density, (0.1, 0.1, 0.1)))


@pytest.mark.parametrize("distance", [1e3, 1e6, 1e8])
def test_the_place_of_the_grid_does_not_matter(distance: float, rng: np.random.Generator) -> None:
    density, origin = rng.uniform(0, 1, (4, 5, 6)), distance * np.array([1.0, -0.7, 0.3])
    body = RigidBody.from_voxels(density, 1.0, origin)
    exact = Cells(density, (1.0, 1.0, 1.0), origin)
    assert worst_error(body.inertia, exact.inertia) <= 4e-15
    assert max(ulp_errors(body.center_of_mass, exact.center_of_mass)) <= 1.0


def test_an_oblique_rod_of_cells_keeps_its_smallest_moment(rng: np.random.Generator) -> None:
    density = np.zeros((300, 200, 100), np.float32)
    steps = np.arange(100)
    density[3 * steps, 2 * steps, steps] = rng.uniform(1, 2, 100)
    spacing = (0.1, 0.17, 0.23)
    body = RigidBody.from_voxels(density, spacing)
    exact = moments(Cells(density, spacing).inertia)
    assert body.principal_moments == pytest.approx(exact, rel=3e-15, abs=0)


def test_stacks_layouts_and_types_give_the_same_bits(rng: np.random.Generator) -> None:
    density = rng.integers(0, 200, (3, 6, 5, 4)).astype(np.uint8)
    stack = RigidBody.from_voxels(density, 0.5)
    assert stack.shape == (3,)
    for i, grid in enumerate(density):
        assert stack[i] == RigidBody.from_voxels(grid.astype(np.float32), 0.5)
        assert stack[i] == RigidBody.from_voxels(np.asfortranarray(grid, dtype=np.float64), [0.5] * 3)


@pytest.mark.parametrize(
    ("density", "spacing", "origin", "words"),
    [
        (np.ones((2, 2)), 1.0, (0, 0, 0), r"density.*shape \(\.\.\., nx, ny, nz\), got \(2, 2\)"),
        (np.ones((2, 2, 2)), (1.0, 2.0), (0, 0, 0), r"spacing.*\(3,\), got \(2,\)"),
        (np.ones((2, 2, 2)), 0.0, (0, 0, 0), r"spacing.*positive.*0\.0"),
        (np.ones((2, 2, 2)), np.nan, (0, 0, 0), r"(?i)spacing.*nan"),
        (np.ones((2, 2, 2)), 1.0, (0, np.inf, 0), r"(?i)origin.*inf"),
        (np.ones((2, 0, 2)), 1.0, (0, 0, 0), r"density.*empty"),
        (np.zeros((2, 2, 2)), 1.0, (0, 0, 0), r"density.*positive"),
        (-np.eye(3).reshape(1, 3, 3), 1.0, (0, 0, 0), r"density\[0, 0, 0\] is -1\.0"),
        (np.full((2, 2, 2), np.nan), 1.0, (0, 0, 0), r"(?i)density.*nan"),
        (np.ones((2, 2, 2), complex), 1.0, (0, 0, 0), r"density.*real"),
    ],
)
def test_errors_name_the_argument_and_the_number(density: Any, spacing: Any, origin: Any, words: str) -> None:
    with pytest.raises((ValueError, TypeError), match=words):
        RigidBody.from_voxels(density, spacing, origin)


def test_errors_name_the_row_of_the_stack() -> None:
    density = np.ones((4, 2, 2, 2))
    density[2, 1, 0, 1] = -3.0
    with pytest.raises(errors.InvalidInertiaError, match=r"row 2.*density\[1, 0, 1\] is -3\.0"):
        RigidBody.from_voxels(density, 1.0)
