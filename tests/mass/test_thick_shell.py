"""Shells of finite thickness against outer minus inner solids, exactly, and against closed forms."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import worst_error
from oracles.bodies import attitudes, matrix, vectors
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import box, cube, icosphere, tetrahedron
from polhode import RigidBody, solids
from polhode.errors import MeshError

Box = tuple[tuple[Fraction | int, Fraction | int], ...]
SHEET = np.array([(0.0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)])
TWO = np.array([(0, 1, 2), (0, 2, 3)])


class Boxes:
    """Boxes, counted with their signs: volume, centre and tensor as fractions."""

    def __init__(self, *signed: tuple[int, Box]) -> None:
        moments = [self.moments(box) for _, box in signed]
        signs = [sign for sign, _ in signed]
        total = [sum(s * m[k] for s, m in zip(signs, moments, strict=True)) for k in range(10)]
        self.volume = total[0]
        self.center = c = [x / self.volume for x in total[1:4]]
        second = dict(zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)], total[4:], strict=True))
        S = [[second[min(i, j), max(i, j)] - self.volume * c[i] * c[j] for j in range(3)] for i in range(3)]
        trace = S[0][0] + S[1][1] + S[2][2]
        self.inertia = [[(trace if i == j else 0) - S[i][j] for j in range(3)] for i in range(3)]

    @staticmethod
    def moments(box: Box) -> list[Fraction]:
        ends = [(Fraction(a), Fraction(b)) for a, b in box]
        size = [b - a for a, b in ends]
        middle = [(a + b) / 2 for a, b in ends]
        third = [(a * a + a * b + b * b) / 3 for a, b in ends]
        v = size[0] * size[1] * size[2]
        mixed = [middle[i] * middle[j] for i, j in ((0, 1), (0, 2), (1, 2))]
        return [v, *(v * m for m in middle), *(v * q for q in third), *(v * p for p in mixed)]


def around(low: Any, high: Any, h: Any) -> Box:
    return tuple(
        (Fraction(a) - Fraction(h), Fraction(b) + Fraction(h)) for a, b in zip(low, high, strict=True)
    )


def holds(body: RigidBody, exact: Boxes, bar: float = 4e-15) -> None:
    """Mass and tensor within `bar`, and all within the bound that the body reports."""
    assert worst_error(body.mass, exact.volume) <= bar
    assert worst_error(body.inertia, exact.inertia) <= bar
    assert worst_error(body.mass, exact.volume, scale=1) <= body.error_bound.mass
    assert worst_error(body.center_of_mass, exact.center, scale=1) <= body.error_bound.center_of_mass
    assert worst_error(body.inertia, exact.inertia, scale=1) <= body.error_bound.inertia


class TestExactly:
    @pytest.mark.parametrize("thickness", [1.0, 0.25, 1e-3, 1e-6, 1e-12])
    @pytest.mark.parametrize("shift", [0.0, 1024.0, 2.0**27])
    def test_a_box_with_mitred_corners(self, thickness: float, shift: float) -> None:
        size = (1.0, 2.0, 3.0)
        vertices, faces = box(size)
        body = RigidBody.from_surface(vertices + shift, faces, density=1.0, thickness=thickness)
        h = Fraction(thickness) / 2
        low, high = ([shift + sign * x / 2 for x in size] for sign in (-1, 1))
        holds(body, Boxes((1, around(low, high, h)), (-1, around(low, high, -h))))
        assert body.error_bound.mass < 1e-9 * body.mass

    @pytest.mark.parametrize("thickness", [0.5, 1e-3])
    def test_reentrant_corners(self, thickness: float) -> None:
        """The surface of an L-shaped bar; its offsets are L-shaped bars."""
        outline = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 4), (0, 4)]
        caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
        vertices = np.array([(x, y, z) for z in (0.0, 2.0) for x, y in outline])
        sides = [t for a, b in pairwise([*range(6), 0]) for t in ((a, b, b + 6), (a, b + 6, a + 6))]
        faces = np.array([t[::-1] for t in caps] + [tuple(k + 6 for k in t) for t in caps] + sides)
        assert float(polyhedron(vertices, faces).volume) == 12.0
        body = RigidBody.from_surface(vertices, faces, density=1.0, thickness=thickness)
        h = Fraction(thickness) / 2

        def bars(sign: int, h: Fraction) -> list[tuple[int, Box]]:
            z = (-h, 2 + h)
            return [(sign, ((-h, 3 + h), (-h, 1 + h), z)), (sign, ((-h, 1 + h), (1 + h, 4 + h), z))]

        holds(body, Boxes(*bars(1, h), *bars(-1, -h)))

    @pytest.mark.parametrize("thickness", [0.5, 1e-3, 1e-9])
    def test_an_open_sheet_has_walls_along_its_rim(self, thickness: float) -> None:
        h = Fraction(thickness) / 2
        flat = RigidBody.from_surface(SHEET, TWO, density=1.0, thickness=thickness)
        holds(flat, Boxes((1, ((0, 2), (0, 1), (-h, h)))))
        bent = np.vstack([SHEET, [(0, 0, 3), (0, 1, 3)]])
        faces = np.vstack([TWO, [(0, 3, 5), (0, 5, 4)]])
        body = RigidBody.from_surface(bent, faces, density=1.0, thickness=thickness)
        y = (Fraction(0), Fraction(1))
        holds(body, Boxes((1, ((-h, 2), y, (-h, h))), (1, ((-h, h), y, (h, 3)))))

    @pytest.mark.parametrize("thickness", [0.3, 1e-2, 1e-5])
    def test_faces_that_touch_a_cone_move_as_they_should(self, thickness: float) -> None:
        """All planes of a regular icosahedron or octahedron touch one sphere: offsets are scaled copies."""
        octahedron = (
            np.vstack([np.eye(3), -np.eye(3)]),
            np.array(
                [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
            ),
        )
        for vertices, faces in (icosphere(0), octahedron):
            a, b, c = vertices[faces[0]]
            normal = np.cross(b - a, c - a)
            radius = a @ normal / np.linalg.norm(normal)
            solid = RigidBody.from_mesh(vertices, faces, density=1.0)
            k = thickness / 2 / radius  # (1 + k)³ − (1 − k)³, (1 + k)⁵ − (1 − k)⁵ without the difference
            body = RigidBody.from_surface(vertices, faces, density=1.0, thickness=thickness)
            assert body.mass == pytest.approx(solid.mass * (6 * k + 2 * k**3), rel=1e-13)
            moments = solid.principal_moments * (10 * k + 20 * k**3 + 2 * k**5)
            assert body.principal_moments == pytest.approx(moments, rel=1e-13)


class TestCurved:
    @pytest.mark.parametrize("thickness", [0.5, 0.02])
    def test_a_ball_of_triangles_approaches_the_hollow_sphere(self, thickness: float) -> None:
        exact = solids.hollow_sphere(1 - thickness / 2, 1 + thickness / 2, density=1.0)
        errors = []
        for subdivisions in range(1, 5):
            body = RigidBody.from_surface(*icosphere(subdivisions), density=1.0, thickness=thickness)
            errors.append(1 - body.principal_moments[0] / exact.principal_moments[0])
        assert errors[-1] < 1e-2
        assert [coarse / fine for coarse, fine in pairwise(errors)] == pytest.approx([4, 4, 4], rel=0.1)

    @pytest.mark.parametrize("thickness", [0.1, 1e-3])
    def test_against_the_difference_of_two_meshes(self, thickness: float) -> None:
        vertices, faces = icosphere(2)
        vertices = vertices * [1.0, 0.7, 0.4]
        ways = directions(vertices, faces)
        outer, inner = (polyhedron(vertices + h * ways, faces) for h in (thickness / 2, -thickness / 2))
        body = RigidBody.from_surface(vertices, faces, density=1.0, thickness=thickness)
        assert body.mass == pytest.approx(float(outer.volume - inner.volume), rel=1e-15 / thickness)
        want = np.array(outer.inertia, dtype=float) - np.array(inner.inertia, dtype=float)
        assert np.abs(body.inertia - want).max() <= 1e-15 / thickness * np.abs(want).max()
        assert body.error_bound.mass < 1e-9 * body.mass

    def test_it_becomes_the_thin_shell(self) -> None:
        for mesh in (icosphere(0), tetrahedron(), (SHEET, TWO)):
            thin = RigidBody.from_surface(*mesh, areal_density=3.0)
            body = RigidBody.from_surface(*mesh, density=3e8, thickness=1e-8)
            assert body.mass == pytest.approx(thin.mass, rel=1e-14)
            assert np.abs(body.inertia - thin.inertia).max() < 1e-14 * thin.inertia.max()


def directions(vertices: Any, faces: Any) -> Any:
    """Weighted least squares at every vertex, by NumPy."""
    rows: list[list[Any]] = [[] for _ in vertices]
    for face in faces:
        corners = vertices[face]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        normal /= np.linalg.norm(normal)
        for k in range(3):
            e, f = corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]
            angle = np.arccos(e @ f / np.linalg.norm(e) / np.linalg.norm(f))
            rows[face[k]].append((np.sqrt(angle), normal))
    found = []
    for at in rows:
        root, normals = np.array([w for w, _ in at]), np.array([n for _, n in at])
        found.append(np.linalg.lstsq(root[:, np.newaxis] * normals, root, rcond=None)[0])
    return np.array(found)


class TestLaws:
    @given(attitude=attitudes(), shift=vectors(100.0), size=st.floats(0.01, 100), t=st.floats(1e-3, 0.9))
    def test_turned_moved_and_scaled(
        self, attitude: np.ndarray, shift: np.ndarray, size: float, t: float
    ) -> None:
        vertices, faces = tetrahedron(3.0)
        R = matrix(attitude)
        here = RigidBody.from_surface(vertices, faces, density=1.0, thickness=t)
        there = RigidBody.from_surface(size * vertices @ R.T + shift, faces, density=1.0, thickness=size * t)
        moved = here.rotated(R).scaled(length=size, mass=size**3).translated(shift)
        scale = 1e-13 * (1 + np.abs(shift).max() / size / t)
        assert bool(there.isclose(moved, rtol=scale))

    def test_either_side_may_be_outside(self) -> None:
        vertices, faces = box((1.0, 2.0, 3.0))
        one, other = (
            RigidBody.from_surface(vertices, f, density=2.0, thickness=0.1) for f in (faces, faces[:, ::-1])
        )
        assert bool(one.isclose(other, rtol=1e-15, atol=1e-15))
        assert one.provenance.source == "surface"
        assert "winding" in one.provenance.checked

    def test_a_soup_is_one_surface(self) -> None:
        vertices, faces = box((1.0, 2.0, 3.0))
        soup, numbers = vertices[faces].reshape(-1, 3), np.arange(36).reshape(12, 3)
        one = RigidBody.from_surface(soup, numbers, mass=2.0, thickness=0.1)
        assert one == RigidBody.from_surface(vertices, faces, mass=2.0, thickness=0.1)
        assert one.mass == 2.0

    @pytest.mark.parametrize("thickness", [1e-1, 1e-4, 1e-8])
    def test_a_thin_strip_keeps_its_smallest_moment(self, thickness: float) -> None:
        turn = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
        strip = np.array([(0, 0, 0), (1, 0, 0), (1, 1e-3, 0), (0, 1e-3, 0)])
        body = RigidBody.from_surface(strip @ turn.T, TWO, mass=1.0, thickness=1e-3 * thickness)
        want = (1e-6 + (1e-3 * thickness) ** 2) / 12
        assert body.principal_moments[0] == pytest.approx(want, rel=1e-12)


class TestRefusals:
    def test_a_fold_names_the_face_and_what_is_possible(self) -> None:
        with pytest.raises(
            MeshError, match=r"folds the shell over itself at faces\[\d+\], where at most 1.0"
        ):
            RigidBody.from_surface(*box((1.0, 2.0, 3.0)), density=1.0, thickness=1.01)
        vertices, faces = icosphere(2)
        radius = 1.0
        with pytest.raises(MeshError, match="make the shell thinner"):
            RigidBody.from_surface(vertices, faces, density=1.0, thickness=2.2 * radius)

    def test_the_surface_must_be_one(self) -> None:
        vertices, faces = cube()
        turned = faces.copy()
        turned[3] = turned[3][::-1]
        fin = np.vstack([SHEET, [(1.0, 0.5, 1.0)]]), np.vstack([TWO, [(0, 2, 4)]])
        for mesh, message in (
            ((vertices, turned), r"faces\[3\] and faces\[4\] both run from vertex 4 to vertex 5"),
            (fin, "3 faces meet in the edge from vertex 0 to vertex 2"),
            (([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), r"faces\[0\] has no normal"),
            # The squares of its edge are below all numbers.
            (([(0, 0, 0), (1e-200, 0, 0), (0, 1, 0)], [(0, 1, 2)]), r"faces\[0\] has no normal"),
            (([(0, 0, 0), (1, 0, 0), (1, 0, 0)], [(0, 1, 2)]), "no area"),
            ((vertices, [(0, 1, 9)]), r"faces\[0\] names vertex 9"),
            ((vertices, np.empty((0, 3), dtype=int)), "no faces"),
        ):
            with pytest.raises(MeshError, match=message):
                RigidBody.from_surface(*mesh, density=1.0, thickness=0.1)

    def test_amounts(self) -> None:
        mesh = cube()
        for amounts, message in (
            ({"areal_density": 1.0, "thickness": 0.1}, "areal_density= is of a thin shell"),
            ({"density": 1.0}, "density= needs thickness="),
            ({"thickness": 0.1}, "exactly one of mass= and density="),
            ({"thickness": 0.1, "mass": 1.0, "density": 1.0}, "exactly one of mass= and density="),
        ):
            with pytest.raises(TypeError, match=message):
                RigidBody.from_surface(*mesh, **amounts)
        for bad in (0.0, -1.0, np.nan, np.inf):
            with pytest.raises(ValueError, match="thickness"):
                RigidBody.from_surface(*mesh, density=1.0, thickness=bad)
