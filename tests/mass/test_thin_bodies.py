"""Shells, wires and thin solids: every moment against fifty digits, the smallest one too."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import attitudes, matrix
from oracles.exact_polyhedron import polyhedron
from oracles.exact_simplices import shell, wire
from oracles.meshes import box, cube, icosphere, tetrahedron
from polhode import RigidBody
from polhode.errors import MeshError, PolhodeError

TURN = matrix(np.array([0.2, -0.5, 0.4, 0.7]) / np.linalg.norm([0.2, -0.5, 0.4, 0.7]))
SHIFT = np.array([1.0, -0.7, 0.3])


def relative(computed: Any, exact: Any) -> float:
    """Largest relative error, number by number."""
    pairs = zip(np.ravel(computed).tolist(), np.ravel(np.array(exact, dtype=object)), strict=True)
    return max(float(abs(mpmath.mpf(a) - b) / abs(b)) for a, b in pairs)


def against(computed: Any, exact: Any) -> float:
    """Largest error relative to the largest exact number."""
    want = np.ravel(np.array(exact, dtype=object))
    pairs = zip(np.ravel(computed).tolist(), want, strict=True)
    return max(float(abs(mpmath.mpf(a) - b)) for a, b in pairs) / max(float(abs(b)) for b in want)


def solid_moments(vertices: Any, faces: Any) -> list[Any]:
    exact = polyhedron(vertices, faces).inertia
    with mpmath.workdps(50):
        rows = [[mpmath.mpf(x.numerator) / x.denominator for x in row] for row in exact]
        return sorted(mpmath.eigsy(mpmath.matrix(rows), eigvals_only=True))


class TestThinSolids:
    @pytest.mark.parametrize("thickness", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8])
    @pytest.mark.parametrize("shape", ["needle", "plate", "blade"])
    @pytest.mark.parametrize("shift", [0.0, 10.0])
    def test_moments_of_turned_needles_plates_and_blades(
        self, thickness: float, shape: str, shift: float
    ) -> None:
        t = thickness
        size = {"needle": (t, 0.7 * t, 1.0), "plate": (1.0, 0.7, t), "blade": (1.0, t, max(t * t, 1e-9))}[
            shape
        ]
        if shift and min(size) < 1e-8:
            size = (size[0], size[1], 1e-8)  # thinner than the digits of coordinates that far out
        for vertices, faces in (box(size), icosphere(1)):
            scaled = vertices if len(faces) == 12 else vertices * np.array(size)
            turned = scaled @ TURN.T + shift * SHIFT
            body = RigidBody.from_mesh(turned, faces, density=1.0)
            assert relative(body.principal_moments, solid_moments(turned, faces)) <= 1e-14

    def test_ordinary_solids_are_summed_once_and_thin_ones_again(self) -> None:
        assert RigidBody.from_mesh(*cube(), mass=1.0).provenance.moments == "second moment"
        needle = RigidBody.from_mesh(*box((1e-3, 1e-3, 1.0)), mass=1.0)
        assert needle.provenance.moments == "second moment in own axes"

    def test_a_vertex_that_no_face_uses_does_not_matter(self) -> None:
        vertices, faces = icosphere(2)
        body = RigidBody.from_mesh(vertices, faces, density=1.0)
        for distance in (1e3, 1e9, 1e200):
            stray = np.vstack([vertices, [[distance, 0.0, -distance]]])
            other = RigidBody.from_mesh(stray, faces, density=1.0)
            assert bool(other.isclose(body, rtol=4e-15, atol=1e-15)), distance


class TestShells:
    @pytest.mark.parametrize("far", [1e3, 1e4])
    def test_small_and_far_from_the_vertices_no_face_uses(self, far: float) -> None:
        """They change no bit, though seen from their middle the surface is a speck."""
        vertices, faces = icosphere(2)
        vertices = 5.0 * np.asarray(vertices) + 500.0
        more = np.vstack([vertices, [(far, 0.0, 0.0), (0.0, -far, far)]])
        one, two = (RigidBody.from_surface(these, faces, mass=1.0) for these in (vertices, more))
        assert np.array_equal(one.inertia, two.inertia)
        assert np.array_equal(one.center_of_mass, two.center_of_mass)

    @pytest.mark.parametrize("mesh", [cube(2.0), tetrahedron(), icosphere(2), box((1.0, 2.0, 0.0))])
    @pytest.mark.parametrize("shift", [0.0, 1e3, 1e8])
    def test_against_fifty_digits(self, mesh: Any, shift: float) -> None:
        vertices, faces = mesh[0] @ TURN.T + shift * SHIFT, mesh[1]
        exact = shell(vertices, faces)
        body = RigidBody.from_surface(vertices, faces, areal_density=1.0)
        assert relative(body.mass, exact.content) <= 4e-15
        assert against(body.inertia, exact.inertia) <= 4e-15
        assert relative(body.principal_moments, exact.moments) <= 1e-14
        assert max(abs(body.center_of_mass - np.array(exact.center, dtype=float))) <= 2e-16 * (1 + shift)

    @pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9])
    def test_a_strip_keeps_its_smallest_moment(self, width: float) -> None:
        strip = np.array([(0, 0, 0), (1, 0, 0), (1, width, 0), (0, width, 0)]) @ TURN.T
        faces = [(0, 1, 2), (0, 2, 3)]
        body = RigidBody.from_surface(strip, faces, mass=1.0)
        exact = shell(strip, faces)
        want = [m / exact.content for m in exact.moments]
        assert relative(body.principal_moments, want) <= 1e-14

    def test_the_winding_does_not_matter(self) -> None:
        vertices, faces = icosphere(1)
        mixed = faces.copy()
        mixed[::3] = mixed[::3, ::-1]
        one, other = (RigidBody.from_surface(vertices, f, mass=1.0) for f in (faces, mixed))
        assert bool(one.isclose(other, rtol=1e-15, atol=1e-16))

    def test_mass_and_density(self) -> None:
        assert RigidBody.from_surface(*cube(2.0), mass=3.0).mass == 3.0
        assert RigidBody.from_surface(*cube(2.0), areal_density=0.5).mass == pytest.approx(12.0, rel=1e-15)
        for given_amounts in ({}, {"mass": 1.0, "areal_density": 1.0}):
            with pytest.raises(TypeError, match="exactly one of mass= and areal_density="):
                RigidBody.from_surface(*cube(), **given_amounts)
        for bad in (0.0, -1.0, np.nan, np.inf):
            with pytest.raises(ValueError, match="areal_density must be positive"):
                RigidBody.from_surface(*cube(), areal_density=bad)

    def test_what_is_no_surface_is_refused(self) -> None:
        vertices, faces = cube()
        with pytest.raises(MeshError, match=r"faces\[0\] names vertex 9"):
            RigidBody.from_surface(vertices, [(0, 1, 9)], mass=1.0)
        with pytest.raises(MeshError, match=r"vertices\[3\] is not finite: NaN"):
            RigidBody.from_surface(
                np.where(np.arange(24).reshape(8, 3) == 9, np.nan, vertices), faces, mass=1.0
            )
        with pytest.raises(MeshError, match="no area"):
            RigidBody.from_surface([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)], mass=1.0)
        with pytest.raises(MeshError, match="no faces"):
            RigidBody.from_surface(vertices, np.empty((0, 3), dtype=int), mass=1.0)


class TestWires:
    @pytest.mark.parametrize("shift", [0.0, 1e3, 1e8])
    def test_against_fifty_digits(self, shift: float, rng: np.random.Generator) -> None:
        points = rng.normal(size=(100, 3)) + shift * SHIFT
        exact = wire(points)
        body = RigidBody.from_curve(points, linear_density=1.0)
        assert relative(body.mass, exact.content) <= 4e-15
        assert against(body.inertia, exact.inertia) <= 4e-15
        assert relative(body.principal_moments, exact.moments) <= 1e-14

    @pytest.mark.parametrize("width", [1e-3, 1e-6, 1e-9])
    def test_a_zigzag_keeps_its_smallest_moment(self, width: float) -> None:
        t = np.linspace(-1, 1, 21)
        points = np.stack([t, width * (-1.0) ** np.arange(21), 0.3 * width * t], axis=1) @ TURN.T
        exact = wire(points)
        body = RigidBody.from_curve(points, linear_density=1.0)
        assert relative(body.principal_moments, exact.moments) <= 1e-14

    def test_a_ring_of_many_segments_is_a_ring(self) -> None:
        angle = np.linspace(0, 2 * np.pi, 100_001)
        ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        body = RigidBody.from_curve(ring, mass=2.0)
        assert body.principal_moments == pytest.approx([1.0, 1.0, 2.0], rel=1e-8)

    def test_stacks_are_rows(self, rng: np.random.Generator) -> None:
        points = rng.normal(size=(2, 3, 5, 3))
        stack = RigidBody.from_curve(points, mass=1.0)
        assert stack.shape == (2, 3)
        assert stack[1, 2] == RigidBody.from_curve(points[1, 2], mass=1.0)

    @given(attitude=attitudes(), cuts=st.lists(st.floats(0.01, 0.99), min_size=1, max_size=5))
    def test_points_between_do_not_matter(self, attitude: np.ndarray, cuts: list[float]) -> None:
        a, b = matrix(attitude)[0], 2 * matrix(attitude)[1]
        points = [a, *(a + (b - a) * t for t in sorted(cuts)), b]
        one, other = (RigidBody.from_curve(p, linear_density=1.0) for p in ([a, b], points))
        assert bool(one.isclose(other, rtol=1e-14, atol=1e-15))

    def test_what_is_no_wire_is_refused(self) -> None:
        for points in (np.zeros((0, 3)), np.zeros((1, 3)), np.ones((4, 3))):
            with pytest.raises(PolhodeError, match="positive: points must be two or more"):
                RigidBody.from_curve(points, mass=1.0)
        with pytest.raises(PolhodeError, match="points must be finite, got NaN"):
            RigidBody.from_curve([(0, 0, 0), (np.nan, 0, 0)], mass=1.0)
        with pytest.raises(ValueError, match=r"points: expected shape \(\.\.\., n, 3\), got \(3,\)"):
            RigidBody.from_curve((0, 0, 0), mass=1.0)
