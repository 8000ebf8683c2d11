"""The oracles against closed forms, against each other and against SciPy: who watches the watchmen."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from oracles import exact_polyhedron, meshes, rational, worst_error
from oracles.exact_particles import Particles
from oracles.free_motion import as_floats, jacobi_rates, taylor_motion
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

BRICK = np.array([0.001894220, 0.006211019, 0.007194665])


def test_polyhedron_cube_and_tetrahedron_have_their_closed_forms() -> None:
    cube = exact_polyhedron.polyhedron(*meshes.cube(2.0))
    assert cube.volume == 8
    assert cube.centroid == rational([0, 0, 0])
    assert cube.inertia == [[Fraction(16, 3), 0, 0], [0, Fraction(16, 3), 0], [0, 0, Fraction(16, 3)]]

    corner = exact_polyhedron.polyhedron(*meshes.tetrahedron(1.0))
    diagonal, product = Fraction(1, 80), Fraction(1, 480)
    assert (corner.volume, corner.centroid) == (Fraction(1, 6), [Fraction(1, 4)] * 3)
    assert corner.inertia == [[diagonal if i == j else product for j in range(3)] for i in range(3)]


def test_polyhedron_is_translation_invariant_without_any_error() -> None:
    vertices, faces = meshes.tetrahedron(1.0)
    here = exact_polyhedron.polyhedron(vertices, faces)
    there = exact_polyhedron.polyhedron(vertices + np.array([2.0**40, -(2.0**41), 2.0**30]), faces)
    assert (there.volume, there.inertia) == (here.volume, here.inertia)


def test_icosphere_is_a_closed_oriented_polyhedron_near_the_ball() -> None:
    vertices, faces = meshes.icosphere(4)
    assert (len(vertices), len(faces)) == (2562, 5120)
    edges = {(int(f[i]), int(f[i - 2])) for f in faces for i in range(3)}
    assert len(edges) == 3 * len(faces)
    assert all((b, a) in edges for a, b in edges)
    ball = exact_polyhedron.polyhedron(vertices, faces)
    assert 0.99 * 4 / 3 * np.pi < float(ball.volume) < 4 / 3 * np.pi


def test_particles_of_a_dumbbell() -> None:
    dumbbell = Particles([1.0, 3.0], [[0.0, 0, 0], [4.0, 0, 0]])
    assert dumbbell.mass == 4
    assert dumbbell.center_of_mass == rational([3, 0, 0])
    assert dumbbell.inertia == [[0, 0, 0], [0, 12, 0], [0, 0, 12]]
    assert dumbbell.kinetic_energy([0, 0, 2.0], [0, 0, 0], dumbbell.center_of_mass) == 24


@pytest.mark.parametrize("omega", [(1.0, 2.0, 3.0), (-3.0, -0.2, 0.1), (0.3, 0.2, -1.1), (3.0, 0.2, 0.1)])
def test_taylor_and_jacobi_agree_to_forty_digits(omega: tuple[float, float, float]) -> None:
    times = [0, 4, 10]
    series = taylor_motion(np.diag(BRICK), omega, times)
    closed = jacobi_rates(BRICK, omega, times)
    with mpmath.mp.workdps(50):
        gaps = [
            abs(x - y)
            for (w, _), row in zip(series, closed, strict=True)
            for x, y in zip(w, row, strict=True)
        ]
        assert max(gaps) < mpmath.mpf(10) ** -40


def test_taylor_with_torques_agrees_with_scipy() -> None:
    inertia = np.array([[3.0, 0.2, -0.1], [0.2, 2.0, 0.3], [-0.1, 0.3, 4.0]])
    body_torque, space_torque = np.array([0.1, -0.2, 0.3]), np.array([-0.4, 0.1, 0.2])
    omega, attitude = np.array([0.5, -1.0, 0.25]), np.array([0.5, -0.5, 0.5, 0.5])

    def rhs(_t: float, y: np.ndarray) -> np.ndarray:
        w, turn = y[:3], Rotation.from_quat(y[3:])
        torque = body_torque + turn.inv().apply(space_torque)
        rate = np.linalg.solve(inertia, torque - np.cross(w, inertia @ w))
        spin = turn * Rotation.from_quat([*w, 0.0]) if w.any() else turn
        return np.concatenate([rate, np.linalg.norm(w) * spin.as_quat() / 2])

    want = solve_ivp(rhs, (0, 2), [*omega, *attitude], rtol=1e-11, atol=1e-12).y[:, -1]
    states = taylor_motion(
        inertia, omega, [0, 2], attitude=attitude, body_torque=body_torque, space_torque=space_torque
    )
    rates, quaternions = as_floats(states)
    assert np.abs(rates[-1] - want[:3]).max() < 1e-8
    assert abs(abs(quaternions[-1] @ want[3:]) - 1) < 1e-8


def test_worst_error_counts_in_units_of_the_largest_entry() -> None:
    assert worst_error([1.0, 2.0], [Fraction(1), Fraction(2)]) == 0.0
    assert worst_error([1.0, 2.5], [Fraction(1), Fraction(2)]) == 0.25
