"""The course's bodies as stacks of random parameter sets, against the closed forms on paper."""

from __future__ import annotations

import numpy as np
import pytest
from polhode import RigidBody, solids
from scipy.spatial.transform import Rotation

COUNT = 200


@pytest.fixture
def sizes(rng: np.random.Generator) -> np.ndarray:
    """A mass and three lengths for each row."""
    drawn: np.ndarray = rng.uniform(0.2, 4.0, (COUNT, 4))
    return drawn


def assert_tensors(got: np.ndarray, want: np.ndarray) -> None:
    """Equal to 1e-13 of the largest element of each row."""
    size = np.abs(want).max(axis=(1, 2), keepdims=True)
    assert (np.abs(got - want) / size).max() < 1e-13


def diagonal(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    tensors: np.ndarray = np.stack([x, y, z], axis=-1)[..., None] * np.eye(3)
    return tensors


def test_mex68_a_cube_about_its_corner(sizes: np.ndarray) -> None:
    M, L = sizes[:, 0], sizes[:, 1]
    cube = solids.cube(L, mass=M)
    corner = L[:, None] / 2 * np.ones(3)
    unit = (M * L**2)[:, None, None]
    assert_tensors(cube.inertia_about(corner), unit * (11 / 12 * np.eye(3) - 1 / 4))
    about = cube.principal_about(corner)
    assert np.abs(about.moments / unit[..., 0] - [1 / 6, 11 / 12, 11 / 12]).max() < 1e-13
    assert np.abs(about.axes[..., 0] - 1 / np.sqrt(3)).max() < 1e-14
    assert cube.moment_about((1, 1, 1), corner) == pytest.approx(M * L**2 / 6, rel=1e-13)


def test_mex71_a_cone_about_its_apex_and_its_center(sizes: np.ndarray) -> None:
    M, R, h, _ = sizes.T
    cone = solids.cone(R, h, mass=M)
    apex = np.column_stack([0 * h, 0 * h, 0.75 * h])
    across, along = 0.6 * M * (h**2 + R**2 / 4), 0.3 * M * R**2
    assert_tensors(cone.inertia_about(apex), diagonal(across, across, along))
    across = 3 / 20 * M * (R**2 + h**2 / 4)
    assert_tensors(cone.inertia, diagonal(across, across, along))


def test_mex252_to_254_cylinder_sphere_ellipsoid(sizes: np.ndarray) -> None:
    M, a, b, c = sizes.T
    across = M * (3 * a**2 + b**2) / 12
    assert_tensors(solids.cylinder(a, b, mass=M).inertia, diagonal(across, across, M * a**2 / 2))
    ball = 0.4 * M * a**2
    assert_tensors(solids.sphere(a, mass=M).inertia, diagonal(ball, ball, ball))
    want = diagonal(M * (b**2 + c**2) / 5, M * (c**2 + a**2) / 5, M * (a**2 + b**2) / 5)
    assert_tensors(solids.ellipsoid(sizes[:, 1:], mass=M).inertia, want)


def test_mex255_a_four_atomic_molecule(sizes: np.ndarray) -> None:
    m1, a, h, m2 = sizes.T

    def molecule(height: np.ndarray, apex: np.ndarray) -> RigidBody:
        angle = np.arange(3) * 2 * np.pi / 3
        ring = (a / np.sqrt(3))[:, None, None] * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
        top = np.stack([0 * height, 0 * height, height], axis=-1)[:, None]
        masses = np.stack([m1, m1, m1, apex], axis=-1)
        return RigidBody.from_particles(masses, np.concatenate([ring, top], axis=1))

    across = m1 * a**2 / 2 + 3 * m1 * m2 / (3 * m1 + m2) * h**2
    assert_tensors(molecule(h, m2).inertia, diagonal(across, across, m1 * a**2))
    regular = molecule(a * np.sqrt(2 / 3), m1)
    assert (regular.principal.top == "spherical").all()
    assert regular.principal_moments == pytest.approx(np.outer(m1 * a**2, np.ones(3)), rel=1e-13)


def test_mex69_parallel_axes_and_mln80_principal_axes(sizes: np.ndarray, rng: np.random.Generator) -> None:
    turn = Rotation.from_quat(rng.normal(size=(COUNT, 4)))
    box = solids.box(sizes[:, 1:], mass=sizes[:, 0]).rotated(turn)
    d, axis = rng.normal(size=(2, COUNT, 3))
    n = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    distance = np.linalg.norm(np.cross(n, d), axis=1)
    want = box.moment_about(axis) + box.mass * distance**2
    assert box.moment_about(axis, box.center_of_mass + d) == pytest.approx(want, rel=1e-13)
    # I Ω = Ω Ī, ΩᵀΩ = 1, det Ω = 1
    moments, axes = box.principal.moments, box.principal.axes
    size = moments[:, 2, None, None]
    assert (np.abs(box.inertia @ axes - axes * moments[:, None, :]) / size).max() < 1e-14
    assert np.abs(axes.swapaxes(1, 2) @ axes - np.eye(3)).max() < 1e-14
    assert np.linalg.det(axes) == pytest.approx(np.ones(COUNT), rel=1e-14)
