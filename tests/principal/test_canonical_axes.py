"""Canonical axes: where a body leaves its axes free, those nearest to the body frame."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.eigen_cases import symmetric
from oracles.meshes import box
from polhode import MassAccumulator, RigidBody, laminae, principal_axes, rods, solids
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

TOPS = {"oblate": [1.0, 1.0, 1.5], "prolate": [1.0, 2.0, 2.0], "linear": [0.0, 2.0, 2.0]}


def turned(moments: list[float], turns: np.ndarray) -> np.ndarray:
    return symmetric(np.einsum("nij,j,nkj->nik", turns, moments, turns))


@pytest.mark.parametrize("scale", [1e-300, 1e-47, 1.0, 1e37, 1e300])
def test_a_sphere_has_the_axes_of_the_body(scale: float) -> None:
    noise = 1e-9 * np.random.default_rng(1).normal(size=(100, 3, 3))
    spheres = scale * (np.eye(3) + noise + np.swapaxes(noise, 1, 2))
    np.testing.assert_array_equal(
        principal_axes(spheres, canonical=True).axes, np.broadcast_to(np.eye(3), spheres.shape)
    )


@pytest.mark.parametrize("moments", TOPS.values(), ids=TOPS)
def test_tops_in_the_body_frame_have_its_axes(moments: list[float]) -> None:
    np.testing.assert_array_equal(principal_axes(np.diag(moments), canonical=True).axes, np.eye(3))


def nearest(n: np.ndarray, k: int) -> float:
    """The largest trace of principal axes whose column k is along ±n, by a search over the pair's angle."""
    best = -np.inf
    for axis in (n, -n):
        first, second = np.linalg.svd(axis[None])[2][1:]
        frame = np.insert(np.column_stack([first, second]), k, axis, axis=1)
        frame[:, (k + 1) % 3] *= np.linalg.det(frame)
        i, j = (k + 1) % 3, (k + 2) % 3

        def off(angle: float, frame: np.ndarray = frame, i: int = i, j: int = j) -> float:
            pair = np.cos(angle) * frame[i, i] + np.sin(angle) * frame[i, j]
            return -float(pair - np.sin(angle) * frame[j, i] + np.cos(angle) * frame[j, j])

        for start in np.linspace(0.0, 2 * np.pi, 4, endpoint=False):
            found = minimize_scalar(off, bounds=(start - 1.0, start + 1.0), method="bounded")
            best = max(best, axis[k] - found.fun)
    return best


def check_nearest(axes: np.ndarray, k: int) -> None:
    """No pair across the symmetry axis, column k, is nearer to the body frame; the sign rule holds."""
    signs = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])
    assert max((signs * np.diag(axes)).sum(axis=1)) == pytest.approx(nearest(axes[:, k], k), abs=1e-9)
    np.testing.assert_allclose(np.cross(axes[:, 0], axes[:, 1]), axes[:, 2], atol=2e-15)
    for v in axes[:, :2].T:
        leading = (np.abs(v) >= (1 - 1e-8) * np.abs(v).max()).argmax()
        assert v[leading] > 0


@pytest.mark.parametrize("moments", TOPS.values(), ids=TOPS)
def test_no_pair_is_nearer_to_the_body_frame(moments: list[float]) -> None:
    turns = Rotation.random(60, np.random.default_rng(2)).as_matrix()
    tensors = turned(moments, turns)
    for found in (principal_axes(tensors, canonical=True), RigidBody(1.0, tensors).principal):
        for axes in found.axes:
            check_nearest(axes, 2 if moments[0] == moments[1] else 0)
        back = np.einsum("nij,nj,nkj->nik", found.axes, found.moments, found.axes)
        np.testing.assert_allclose(back, tensors, atol=4e-15)


@pytest.mark.parametrize("moments", TOPS.values(), ids=TOPS)
def test_a_symmetry_axis_across_its_own_has_one_pair_too(moments: list[float]) -> None:
    """Both directions of n are as near then; noise on either side of the plane does not choose."""
    k = 2 if moments[0] == moments[1] else 0
    rng = np.random.default_rng(5)
    for angle in rng.uniform(0, 2 * np.pi, 20):
        n = np.insert([np.cos(angle), np.sin(angle)], k, 0.0)
        axes = []
        for tilt in rng.uniform(-1e-12, 1e-12, 10):
            axis = n + np.insert([0.0, 0.0], k, tilt)
            tensor = moments[1] * np.eye(3) + (moments[k] - moments[1]) * np.outer(axis, axis)
            axes.append(RigidBody(1.0, symmetric(tensor)).principal.axes)
            check_nearest(axes[-1], k)
        assert np.ptp(axes, axis=0).max() < 1e-11


def ways(kind: str, turn: np.ndarray, rng: np.random.Generator) -> dict[str, RigidBody]:
    """One body made in many ways, its symmetry axis along the last column of `turn`."""
    count, height = 7, {"oblate": 0.5, "prolate": 4.0, "spherical": 2**0.5}[kind]
    angle = 2 * np.pi * np.arange(count) / count + rng.uniform(0, 7)
    ring = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
    up = np.array([0.0, 0.0, height / 2])
    points = np.concatenate([ring + up, ring - up]) @ turn.T
    # Two rings of particles: I_s = m, I_t = m/2 + m h²/4 with m = 14.
    body = RigidBody.from_particles(np.ones(2 * count), points)
    shift = rng.normal(size=3)
    spin = Rotation.from_rotvec(rng.normal() * turn[:, 2]).as_matrix()
    moments = np.array([7 + 3.5 * height**2, 7 + 3.5 * height**2, 14.0])
    if kind == "spherical":
        moments[:] = 14.0
    sums = MassAccumulator()
    sums.add(np.ones(2 * count), points)
    step = Rotation.random(None, rng).as_matrix()
    halves = [RigidBody.from_particles(np.ones(count), (ring + s * up) @ turn.T) for s in (1, -1)]
    return {
        "particles": body,
        "accumulated": sums.finish(),
        "in another order": RigidBody.from_particles(np.ones(2 * count), points[rng.permutation(2 * count)]),
        "by its tensor": RigidBody(body.mass, body.inertia),
        "about the origin": RigidBody(body.mass, inertia_about_origin=body.inertia),
        "by its moments": RigidBody.from_principal(body.mass, moments, spin @ turn),
        "sum": halves[0] + halves[1],
        "turned": RigidBody.from_principal(body.mass, moments).rotated(spin @ turn),
        "turned twice": body.rotated(step).rotated(step.T),
        "moved": body.translated(shift).translated(-shift),
        "larger": body.scaled(3.0, 0.1),
        "less another": (body + solids.sphere(1.0, mass=2.0)) - solids.sphere(1.0, mass=2.0),
        "in a stack": RigidBody.stack([body, body])[1],
    }


@pytest.mark.parametrize("kind", ["spherical", "oblate", "prolate"])
def test_axes_do_not_depend_on_how_a_body_was_made(kind: str) -> None:
    rng = np.random.default_rng(7)
    for turn in Rotation.random(30, rng).as_matrix():
        bodies = ways(kind, turn, rng)
        expected = bodies["particles"].principal.axes
        for way, body in bodies.items():
            np.testing.assert_allclose(body.principal.axes, expected, atol=2e-13, err_msg=way)
            alone = principal_axes(body.inertia, canonical=True).axes
            np.testing.assert_allclose(alone, expected, atol=2e-13, err_msg=way)
        if kind == "spherical":
            np.testing.assert_array_equal(expected, np.eye(3))
        else:
            check_nearest(expected, 2 if kind == "oblate" else 0)


def test_rounding_of_moments_is_far_below_what_counts_as_equal() -> None:
    """Cubes and rings, turned, as tensors, meshes and particles: gaps between equal moments, 4 ε at most."""
    rng = np.random.default_rng(11)
    vertices, faces = box((1.0, 1.0, 1.0))
    gaps = []
    for turn in Rotation.random(300, rng).as_matrix():
        places, shift = (vertices - 0.5) @ turn.T, 3.0 * rng.normal(size=3)
        bodies = [
            RigidBody(1.0, solids.cube(1.0, mass=1.0).rotated(turn).inertia),
            RigidBody.from_mesh(places + shift, faces, mass=1.0),
            RigidBody.from_particles(np.ones(8), places + shift),
        ]
        moments = np.array([body.principal_moments for body in bodies])
        gaps.append((np.diff(moments).max(axis=1) / moments[:, 2]).max())
    assert max(gaps) <= 4.0 * np.finfo(float).eps


SHAPES = {
    "disk": laminae.disk(1.0, mass=1.0),
    "annulus": laminae.annulus(0.5, 1.0, mass=1.0),
    "square": laminae.rectangle((1.0, 1.0), mass=1.0),
    "sphere": solids.sphere(1.0, mass=1.0),
    "hollow sphere": solids.hollow_sphere(0.5, 1.0, mass=1.0),
    "cube": solids.cube(1.0, mass=1.0),
    "coin": solids.cylinder(1.0, 0.1, mass=1.0),
    "capsule on its side": solids.capsule(0.1, 1.0, mass=1.0).rotated(np.roll(np.eye(3), 1, axis=0)),
    "torus": solids.torus(2.0, 0.5, mass=1.0),
    "point": RigidBody(1.0, np.zeros((3, 3))),
    "rod": rods.rod(1.0, mass=1.0).rotated(np.roll(np.eye(3), 1, axis=0)),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_diagonal_ascending_tensor_has_the_axes_of_the_body(shape: str) -> None:
    body = SHAPES[shape]
    diagonal = body.inertia.diagonal()
    assert (body.inertia == np.diag(diagonal)).all()
    assert (np.diff(diagonal) >= 0.0).all()
    for made in (body, RigidBody(body.mass, body.inertia), RigidBody.from_principal(body.mass, diagonal)):
        np.testing.assert_array_equal(made.principal.axes, np.eye(3))


@pytest.mark.parametrize("scale", [1e-47, 1.0, 1e37])
def test_moments_apart_by_more_than_rounding_keep_their_axes(scale: float) -> None:
    """Both sides of 16 ε, for a pair with other axes than the nearest; exact moments have no such limit."""
    epsilon = np.finfo(float).eps
    for part, is_free in [(0.9, True), (1.1, False)]:
        gap = 16 * epsilon * part
        for diagonal in ([1.0 + gap, 1.0, 1.6], [0.5, 1.0 + gap, 1.0]):
            tensor = scale * np.diag(diagonal)
            assert (RigidBody(1.0, tensor).principal.axes == np.eye(3)).all() == is_free
    kept = RigidBody.from_principal(1.0, scale * np.array([1.0 + epsilon, 1.0, 1.6]))
    np.testing.assert_array_equal(kept.principal.axes[:, 0], [0.0, 1.0, 0.0])
    turn = Rotation.random(None, np.random.default_rng(1)).as_matrix()
    rows = np.abs(turn.T @ kept.rotated(turn).principal.axes)
    np.testing.assert_allclose(rows, np.abs(kept.principal.axes), atol=1e-15)


def test_the_last_bits_of_a_top_do_not_turn_its_axes() -> None:
    rng = np.random.default_rng(3)
    turns = np.repeat(Rotation.random(1, rng).as_matrix(), 200, axis=0)
    top = turned([1.0, 1.0, 1.5], turns)
    noise = 2e-16 * rng.normal(size=top.shape)
    tensors = symmetric(top + noise)
    for found in (principal_axes(tensors, canonical=True), RigidBody(1.0, tensors).principal):
        assert np.ptp(found.axes, axis=0).max() < 1e-13
    assert np.ptp(principal_axes(tensors).axes, axis=0).max() > 0.1


def test_three_different_moments_leave_nothing_free() -> None:
    tensors = turned([1.0, 2.0, 2.5], Rotation.random(20, np.random.default_rng(4)).as_matrix())
    np.testing.assert_array_equal(principal_axes(tensors, canonical=True).axes, principal_axes(tensors).axes)


@pytest.mark.parametrize("canonical", [False, True])
def test_rows_and_stacks_agree(canonical: bool) -> None:
    turns = Rotation.random(30, np.random.default_rng(5)).as_matrix()
    tensors = np.concatenate([turned(moments, turns) for moments in [*TOPS.values(), [1.0, 2.0, 2.5]]])
    stack = principal_axes(tensors, canonical=canonical)
    for row, tensor in enumerate(tensors):
        np.testing.assert_array_equal(principal_axes(tensor, canonical=canonical).axes, stack.axes[row])


def test_what_is_not_a_number_stays_so() -> None:
    assert np.isnan(principal_axes(np.full((3, 3), np.nan), canonical=True).axes).all()
