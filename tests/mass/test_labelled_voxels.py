"""Voxels under an affine matrix, and bodies of labels, against exact sums over their cells."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, errors, solids

SIX = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


def exact_body(
    density: np.ndarray, affine: np.ndarray
) -> tuple[Fraction, list[Fraction], list[list[Fraction]]]:
    """Mass, centre and second moment about it, of cells that are parallelepipeds, in rationals."""
    a = [[Fraction(float(x)) for x in row] for row in affine[:3]]
    edges = [[a[i][k] for i in range(3)] for k in range(3)]
    (p, q, r) = edges
    volume = abs(
        p[0] * (q[1] * r[2] - q[2] * r[1])
        - p[1] * (q[0] * r[2] - q[2] * r[0])
        + p[2] * (q[0] * r[1] - q[1] * r[0])
    )
    mass, first = Fraction(0), [Fraction(0)] * 3
    second = [[Fraction(0)] * 3 for _ in range(3)]
    own = [[sum(e[i] * e[j] for e in edges) / 12 for j in range(3)] for i in range(3)]
    for cell in np.argwhere(density):
        m = Fraction(float(density[tuple(cell)])) * volume
        x: list[Any] = [sum(a[i][k] * int(cell[k]) for k in range(3)) + a[i][3] for i in range(3)]
        mass += m
        for i in range(3):
            first[i] += m * x[i]
            for j in range(3):
                second[i][j] += m * (x[i] * x[j] + own[i][j])
    center = [f / mass for f in first]
    return mass, center, [[second[i][j] - mass * center[i] * center[j] for j in range(3)] for i in range(3)]


def assert_exact(body: RigidBody, density: np.ndarray, affine: np.ndarray, bar: float = 1e-13) -> None:
    mass, center, second = exact_body(density, affine)
    assert float(abs(Fraction(float(body.mass)) / mass - 1)) <= bar
    size = float(sum(second[i][i] for i in range(3)) / mass) ** 0.5
    reach = size + float(np.abs(affine[:3, 3]).max())
    for i in range(3):
        assert float(abs(Fraction(float(body.center_of_mass[i])) - center[i])) <= bar * reach
    found = 0.5 * np.trace(body.inertia) * np.eye(3) - body.inertia
    for i, j in SIX:
        assert float(abs(Fraction(float(found[i, j])) - second[i][j])) <= bar * float(mass) * size**2


def affine_of(rng: np.random.Generator) -> np.ndarray:
    affine = np.eye(4)
    affine[:3] = rng.normal(size=(3, 4)).round(3)
    affine[:3, 3] *= 10.0
    return affine


def test_any_affine(rng: np.random.Generator) -> None:
    for _ in range(30):
        density, affine = rng.random(tuple(rng.integers(1, 5, 3))), affine_of(rng)
        assert_exact(RigidBody.from_voxels(density, affine=affine), density, affine)
        assert_exact(RigidBody.from_voxels(density, affine=affine[:3]), density, affine)


def test_a_diagonal_affine_has_the_bits_of_spacing(rng: np.random.Generator) -> None:
    density, spacing, origin = rng.random((5, 6, 7)), np.array([0.1, 0.2, 0.3]), np.array([1.0, 2.0, 3.0])
    affine = np.diag([*spacing, 1.0])
    affine[:3, 3] = origin
    assert RigidBody.from_voxels(density, affine=affine) == RigidBody.from_voxels(density, spacing, origin)
    turned = affine.copy()
    turned[0, 0], turned[0, 3] = -0.1, 1.0
    same = RigidBody.from_voxels(density[::-1], spacing, (1.0 - 0.4, 2.0, 3.0))
    assert RigidBody.from_voxels(density, affine=turned).isclose(same, rtol=1e-14)


def test_a_thin_row_under_a_shear_keeps_its_smallest_moment() -> None:
    density = np.zeros((1, 1, 3000))
    density[:] = 1.0
    affine = np.eye(4)
    affine[:3, 2] = (0.5, 0.25, 1.0)
    body = RigidBody.from_voxels(density, affine=affine)
    labels = density.astype(np.uint8)
    _, (same,) = RigidBody.from_labelled_voxels(labels, 1.0, affine=affine)
    # A prism along e₃: across it the second moment of the base, projected along the prism.
    axis = affine[:3, 2] / np.linalg.norm(affine[:3, 2])
    across = [edge - axis * (edge @ axis) for edge in np.eye(3)[:2]]
    smallest = body.mass / 12 * sum(float(edge @ edge) for edge in across)
    for each in (body, same):
        assert each.principal_moments[0] == pytest.approx(smallest, rel=1e-6)
    assert same.principal_moments[0] == pytest.approx(float(body.principal_moments[0]), rel=1e-13)


def test_what_the_affine_must_be() -> None:
    density = np.ones((2, 2, 2))
    flat = np.eye(4)
    flat[:3, 2] = (1, 1, 0)
    with pytest.raises(errors.PolhodeError, match="not in one plane"):
        RigidBody.from_voxels(density, affine=flat)
    with pytest.raises(ValueError, match=r"expected shape \(4, 4\)"):
        RigidBody.from_voxels(density, affine=np.eye(3))
    with pytest.raises(ValueError, match="as its last row"):
        RigidBody.from_voxels(density, affine=2.0 * np.eye(4))
    with pytest.raises(TypeError, match="exactly one of spacing="):
        RigidBody.from_voxels(density)
    with pytest.raises(TypeError, match="exactly one of spacing="):
        RigidBody.from_voxels(density, 1.0, affine=np.eye(4))
    with pytest.raises(TypeError, match="origin= goes with spacing="):
        RigidBody.from_voxels(density, origin=(0, 0, 0), affine=np.eye(4))
    with pytest.raises(errors.PolhodeError, match="affine must be finite"):
        RigidBody.from_voxels(density, affine=np.diag([np.nan, 1, 1, 1]))


KINDS: list[Any] = [
    bool,
    np.uint8,
    np.int8,
    np.uint16,
    np.int16,
    np.uint32,
    np.int32,
    np.int64,
    np.uint64,
    np.float16,
    np.float32,
    float,
    np.longdouble,
    ">i2",
    ">f8",
]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("order", ["C", "F"])
def test_labels_of_every_kind(rng: np.random.Generator, kind: Any, order: Any) -> None:
    affine = affine_of(rng)
    image = rng.integers(0, 2 if kind is bool else 5, (4, 5, 6)).astype(kind, order=order)
    labels, bodies = RigidBody.from_labelled_voxels(image, 2.5, affine=affine)
    assert labels.tolist() == [label for label in np.unique(image).tolist() if label]
    for label, body in zip(labels, bodies, strict=True):
        assert_exact(body, np.where(image == label, 2.5, 0.0), affine)


def test_densities_by_label_and_by_cell(rng: np.random.Generator) -> None:
    image, affine = rng.integers(-1, 4, (6, 5, 4)), affine_of(rng)
    labels, bodies = RigidBody.from_labelled_voxels(image, {3: 2.0, -1: 3.0}, affine=affine)
    assert labels.tolist() == [-1, 3]
    assert_exact(bodies[0], np.where(image == -1, 3.0, 0.0), affine)
    labels, bodies = RigidBody.from_labelled_voxels(image, {0: 1.5, "2": 2.0, "*": 3.0}, affine=affine)
    assert labels.tolist() == [-1, 0, 1, 2, 3]
    assert_exact(bodies[1], np.where(image == 0, 1.5, 0.0), affine)
    assert_exact(bodies[2], np.where(image == 1, 3.0, 0.0), affine)
    density = rng.random(image.shape)
    labels, bodies = RigidBody.from_labelled_voxels(image, density, affine=affine)
    assert labels.tolist() == [-1, 1, 2, 3]
    for label, body in zip(labels, bodies, strict=True):
        assert_exact(body, np.where(image == label, density, 0.0), affine)
    by_spacing = RigidBody.from_labelled_voxels(image, density, spacing=(1, 2, 3), origin=(1, 0, 0))[1][1]
    assert by_spacing.isclose(RigidBody.from_voxels(np.where(image == 1, density, 0.0), (1, 2, 3), (1, 0, 0)))


def test_a_box_of_cells_is_a_box() -> None:
    image = np.zeros((30, 40, 50), dtype=np.uint8)
    image[10:20, 5:35, 40:44] = 9
    _, found = RigidBody.from_labelled_voxels(image, 1000.0, spacing=(0.1, 0.2, 0.3), origin=(1, 2, 3))
    box = solids.box((1.0, 6.0, 1.2), density=1000.0).translated((1 + 1.45, 2 + 3.9, 3 + 12.45))
    assert found[0].isclose(box, rtol=1e-14)
    assert found.provenance.source.tolist() == ["voxels"]
    assert found.provenance.elements.tolist() == [1200]


def test_bits_do_not_depend_on_threads_or_order(rng: np.random.Generator) -> None:
    image = rng.integers(0, 9, (40, 30, 20)).astype(np.int16)
    _, one = RigidBody.from_labelled_voxels(image, 2.0, spacing=0.5)
    _, again = RigidBody.from_labelled_voxels(np.asfortranarray(image), 2.0, spacing=0.5)
    assert one.isclose(again, rtol=1e-14).all()
    assert one == RigidBody.from_labelled_voxels(image.astype(float), 2.0, spacing=0.5)[1]


def test_refused() -> None:
    image = np.arange(8).reshape(2, 2, 2)
    with pytest.raises(errors.PolhodeError, match="no voxel has the value 12; the values are 0, 1"):
        RigidBody.from_labelled_voxels(image, {12: 1.0}, spacing=1.0)
    for kind in (np.float16, np.float32, np.float64, np.longdouble):
        with pytest.raises(errors.PolhodeError, match=r"must be whole numbers .*go to from_voxels, got 0\.5"):
            RigidBody.from_labelled_voxels((image + 0.5).astype(kind), 1.0, spacing=1.0)
    for label in (math.nan, math.inf, 2.0**53):
        with pytest.raises(errors.PolhodeError, match="labels must be whole numbers"):
            RigidBody.from_labelled_voxels(np.where(image == 5, label, 1.0), 1.0, spacing=1.0)
    with pytest.raises(errors.PolhodeError, match=r"labels must be whole .*got 1\.8446744073709552e19"):
        RigidBody.from_labelled_voxels(image.astype(np.uint64) + (2**64 - 8), 1.0, spacing=1.0)
    with pytest.raises(errors.PolhodeError, match=r"label 3: density must be positive, got -1.0"):
        RigidBody.from_labelled_voxels(image, {3: -1.0}, spacing=1.0)
    with pytest.raises(ValueError, match=r"labels: expected shape \(nx, ny, nz\), got \(4,\)"):
        RigidBody.from_labelled_voxels([1, 2, 3, 4], 1.0, spacing=1.0)
    with pytest.raises(ValueError, match="density: expected one number, a mapping of labels"):
        RigidBody.from_labelled_voxels(image, [1.0, 2.0], spacing=1.0)
    with pytest.raises(TypeError, match="exactly one of spacing="):
        RigidBody.from_labelled_voxels(image, 1.0)
    with pytest.raises(errors.PolhodeError, match="labels must not be empty"):
        RigidBody.from_labelled_voxels(np.zeros((0, 2, 2), dtype=int), 1.0, spacing=1.0)
    with pytest.raises(TypeError, match="labels: expected whole numbers, got"):
        RigidBody.from_labelled_voxels(np.full((1, 1, 1), "a"), 1.0, spacing=1.0)
    labels, bodies = RigidBody.from_labelled_voxels(np.zeros((2, 2, 2), dtype=int), 1.0, spacing=1.0)
    assert labels.shape == bodies.shape == (0,)


def test_labels_that_are_not_aligned_in_memory() -> None:
    """As in a record of a binary file."""
    labels = np.zeros(4 * 8 + 1, np.uint8)[1:].view(np.int64).reshape(1, 2, 2)
    labels[:] = [[[1, 2], [0, 1]]]
    assert not labels.flags.aligned
    names, bodies = RigidBody.from_labelled_voxels(labels, density=2.0, spacing=0.5)
    same, expected = RigidBody.from_labelled_voxels(labels.copy(), density=2.0, spacing=0.5)
    assert np.array_equal(names, same)
    assert bodies == expected
