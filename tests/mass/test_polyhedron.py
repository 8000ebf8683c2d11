"""Solids bounded by triangles, against exact rational integrals over the very vertices given."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import ulp_errors, worst_error
from oracles.bodies import attitudes, matrix, vectors
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import box, cube, icosphere, merge, tetrahedron
from polhode import RigidBody, samples
from polhode.errors import MeshError
from polhode.io import read_mesh

Mesh = tuple[np.ndarray, np.ndarray]

CLOSED: dict[str, Callable[[], Mesh]] = {
    "cube": cube,
    "tetrahedron": tetrahedron,
    "sphere": icosphere,
    "two parts": lambda: merge(cube(), _moved(tetrahedron(), [3.0, 1.0, -2.0])),
    "cavity": lambda: merge(cube(3.0), _reversed(tetrahedron())),
    "plate": lambda: box((1.0, 1.0, 1e-4)),
    "needle": lambda: box((1e-4, 1e-4, 1.0)),
    "foil": lambda: box((1.0, 1.0, 1e-12)),
    "fibre": lambda: box((1e-9, 1e-9, 1.0)),
}


def _moved(mesh: Mesh, shift: object) -> Mesh:
    return mesh[0] + np.asarray(shift, dtype=float), mesh[1]


def _reversed(mesh: Mesh) -> Mesh:
    return mesh[0], mesh[1][:, ::-1].copy()


def assert_exact(mesh: Mesh, bar: float = 4e-15) -> None:
    """Mass and I_C within `bar`, C within one unit in the last place, of the exact values."""
    body, exact = RigidBody.from_mesh(*mesh, density=1.0), polyhedron(*mesh)
    assert worst_error(body.mass, exact.volume) <= bar
    assert worst_error(body.inertia, exact.inertia) <= bar
    assert max(ulp_errors(body.center_of_mass, exact.centroid)) <= 1.0


class TestAccuracy:
    @pytest.mark.parametrize("name", CLOSED)
    def test_at_home(self, name: str) -> None:
        mesh = CLOSED[name]()
        body, exact = RigidBody.from_mesh(*mesh, density=1.0), polyhedron(*mesh)
        assert worst_error(body.mass, exact.volume) <= 4e-15
        assert worst_error(body.inertia, exact.inertia) <= 4e-15
        assert worst_error(body.center_of_mass, exact.centroid, scale=np.ptp(mesh[0])) <= 4e-16

    @pytest.mark.parametrize("distance", [1e2, 1e4, 1e6, 1e8])
    @pytest.mark.parametrize("name", ["cube", "tetrahedron", "sphere"])
    def test_moved_many_sizes_away(self, name: str, distance: float) -> None:
        for direction in ([1.0, -0.7, 0.3], [-0.1, 0.9, 1.0], [1 / 3, 1 / 7, -1.0]):
            assert_exact(_moved(CLOSED[name](), distance * np.array(direction)))

    @pytest.mark.parametrize("name", ["cube", "tetrahedron", "sphere"])
    @pytest.mark.parametrize("size", [1e-9, 0.1, 30.0, 1e9])
    def test_moved_many_sizes_away_at_any_size(self, name: str, size: float) -> None:
        vertices, faces = CLOSED[name]()
        assert_exact(_moved((vertices * size, faces), 1e8 * size * np.array([0.6, 0.5, -0.4])))

    @given(attitude=attitudes(), shift=vectors(1e6), size=st.floats(0.01, 100))
    def test_turned_moved_and_scaled(self, attitude: np.ndarray, shift: np.ndarray, size: float) -> None:
        vertices, faces = box((1.0, 2.0, 3.0))
        turned = size * vertices @ matrix(attitude).T + shift
        body, exact = RigidBody.from_mesh(turned, faces, density=1.0), polyhedron(turned, faces)
        assert worst_error(body.inertia, exact.inertia) <= 4e-15
        size_of_it = max(float(np.abs(turned).max()) * 2**-52 / 4e-16, float(np.ptp(turned)))
        assert worst_error(body.center_of_mass, exact.centroid, scale=size_of_it) <= 4e-16

    @pytest.mark.parametrize("size", [1e-150, 1e-80, 1e-47, 1e37, 1e80, 1e150])
    def test_no_scale_is_special(self, size: float) -> None:
        vertices, faces = tetrahedron()
        body = RigidBody.from_mesh(size * vertices, faces, mass=80.0)
        want = np.array([[6.0, 1, 1], [1, 6, 1], [1, 1, 6]])
        assert np.abs(body.inertia / size / size - want).max() < 1e-14
        assert np.abs(body.center_of_mass / size - 0.25).max() < 1e-15

    @pytest.mark.parametrize("size", [1e-15, 1e-9, 1.0, 1e6, 1e21])
    @pytest.mark.parametrize("mass", [1e-27, 1.0, 1e30])
    def test_a_box_of_any_size_and_mass(self, size: float, mass: float) -> None:
        vertices, faces = box((1.0, 2.0, 3.0))
        scaled = size * vertices
        exact = polyhedron(scaled, faces)
        body = RigidBody.from_mesh(scaled, faces, mass=mass)
        per_mass = [[x / exact.volume * Fraction(mass) for x in row] for row in exact.inertia]
        assert worst_error(body.inertia, per_mass) <= 4e-15
        assert worst_error(RigidBody.from_mesh(scaled, faces, density=1.0).mass, exact.volume) <= 4e-15

    @pytest.mark.parametrize("distance", [1e3, 1e6, 1e8])
    def test_an_asteroid_wherever_it_stands(self, distance: float) -> None:
        mesh = read_mesh(samples.path("asteroid.obj"))
        size = float(np.ptp(mesh.vertices))
        assert_exact((mesh.vertices + distance * size * np.array([0.6, 0.5, -0.4]), mesh.faces))

    def test_the_ball_of_5120_triangles_approaches_the_ball(self) -> None:
        body = RigidBody.from_mesh(*icosphere(4), mass=1.0)
        assert body.principal_moments == pytest.approx(np.full(3, 0.4), rel=5e-3)
        assert body.principal.top == "spherical"

    def test_bits_do_not_depend_on_how_indices_are_stored(self) -> None:
        vertices, faces = _moved(icosphere(3), [3.0, 4.0, 5.0])
        body = RigidBody.from_mesh(vertices, faces, density=2.0)
        for kind in (np.int32, np.uint32, np.int64, np.uint64, np.uint16):
            assert RigidBody.from_mesh(vertices, faces.astype(kind), density=2.0) == body
        assert RigidBody.from_mesh(vertices.tolist(), faces.tolist(), density=2.0) == body
        assert RigidBody.from_mesh(np.asfortranarray(vertices), faces[:, :], density=2.0) == body


class TestMass:
    def test_density_or_mass(self) -> None:
        by_density = RigidBody.from_mesh(*cube(2.0), density=0.5)
        by_mass = RigidBody.from_mesh(*cube(2.0), mass=4.0)
        assert by_density.mass == 4.0
        assert by_mass.mass == 4.0
        assert by_density.inertia == pytest.approx(by_mass.inertia, rel=1e-15)

    def test_exactly_one_of_them(self) -> None:
        with pytest.raises((TypeError, ValueError), match=r"mass.*density|density.*mass"):
            RigidBody.from_mesh(*cube())
        with pytest.raises((TypeError, ValueError), match=r"mass.*density|density.*mass"):
            RigidBody.from_mesh(*cube(), mass=1.0, density=1.0)

    @pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
    @pytest.mark.parametrize("name", ["mass", "density"])
    def test_it_is_a_positive_number(self, name: str, value: Any) -> None:
        with pytest.raises(ValueError, match=name):
            RigidBody.from_mesh(*cube(), **{name: value})


class TestRefusals:
    """A surface that bounds no solid is an error that proves it with an edge or a face."""

    def test_an_open_mesh_names_a_boundary_edge(self) -> None:
        vertices, faces = tetrahedron()
        with pytest.raises(MeshError, match=r"(?i)open|boundary|closed") as caught:
            RigidBody.from_mesh(vertices, faces[:-1], density=1.0)
        boundary = ({"1", "2"}, {"2", "3"}, {"1", "3"})
        assert any(_mentions(str(caught.value), edge) for edge in boundary), caught.value

    def test_an_inconsistent_mesh_names_an_edge_of_the_turned_face(self) -> None:
        vertices, faces = tetrahedron()
        faces[1] = faces[1][::-1]  # the face 0, 1, 3
        with pytest.raises(MeshError, match=r"(?i)consisten|wound|winding|direction|orient") as caught:
            RigidBody.from_mesh(vertices, faces, density=1.0)
        edges = ({"0", "1"}, {"1", "3"}, {"0", "3"})
        assert any(_mentions(str(caught.value), edge) for edge in edges), caught.value

    def test_an_inverted_mesh_is_named_as_such(self) -> None:
        with pytest.raises(MeshError, match=r"(?i)inverted|inward|inside out") as caught:
            RigidBody.from_mesh(*_reversed(cube()), density=1.0)
        assert "orient=True" in str(caught.value)

    def test_an_edge_with_three_faces_is_refused(self) -> None:
        vertices, faces = tetrahedron()
        fin = np.array([[0, 1, 4], [0, 4, 1]])
        with pytest.raises(MeshError):
            RigidBody.from_mesh(
                np.vstack([vertices, [[1.0, 1, 1]]]), np.vstack([faces, fin[:1]]), density=1.0
            )

    def test_an_index_out_of_range_names_face_and_index(self) -> None:
        vertices, faces = cube()
        for bad in (8, -1, 2**40):
            wrong = faces.copy()
            wrong[5, 1] = bad
            with pytest.raises(MeshError, match=rf"(?=.*\b5\b).*(?<!\d){bad}\b"):
                RigidBody.from_mesh(vertices, wrong, density=1.0)

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_a_vertex_that_is_no_number_is_named(self, value: float) -> None:
        vertices, faces = cube()
        vertices[6, 2] = value
        with pytest.raises(ValueError, match=r"(?i)vert.*\b6\b.*(nan|inf)|(nan|inf).*vert.*\b6\b"):
            RigidBody.from_mesh(vertices, faces, density=1.0)

    def test_a_flat_closed_mesh_has_no_volume(self) -> None:
        vertices, faces = box((1.0, 1.0, 0.0))
        with pytest.raises(MeshError, match=r"(?i)volume"):
            RigidBody.from_mesh(vertices, faces, density=1.0)

    def test_a_mesh_with_no_faces_is_refused(self) -> None:
        for vertices in (np.zeros((0, 3)), np.eye(3)):
            with pytest.raises(ValueError, match=r"(?i)face|triangle|empty"):
                RigidBody.from_mesh(vertices, np.zeros((0, 3), dtype=int), density=1.0)

    def test_shapes_and_types_are_checked(self) -> None:
        vertices, faces = cube()
        with pytest.raises(ValueError, match=r"vertices.*shape \(n, 3\), got \(8, 2\)"):
            RigidBody.from_mesh(vertices[:, :2], faces, density=1.0)
        with pytest.raises(ValueError, match=r"faces.*shape \(\w, 3\), got \(12, 2\)"):
            RigidBody.from_mesh(vertices, faces[:, :2], density=1.0)
        with pytest.raises((TypeError, ValueError), match="faces"):
            RigidBody.from_mesh(vertices, faces + 0.5, density=1.0)

    def test_the_soup_of_an_open_mesh_is_open(self) -> None:
        vertices, faces = cube()
        soup = vertices[faces[:-1]].reshape(-1, 3)
        with pytest.raises(MeshError, match=r"(?i)open|boundary|closed"):
            RigidBody.from_mesh(soup, np.arange(33).reshape(11, 3), density=1.0)


class TestOrient:
    def test_an_inverted_mesh_is_turned_outward(self) -> None:
        body = RigidBody.from_mesh(*_reversed(cube()), density=1.0, orient=True)
        assert bool(body.isclose(RigidBody.from_mesh(*cube(), density=1.0), rtol=1e-15, atol=1e-16))

    def test_a_good_mesh_keeps_its_bits(self) -> None:
        mesh = icosphere(2)
        assert RigidBody.from_mesh(*mesh, density=1.0, orient=True) == RigidBody.from_mesh(*mesh, density=1.0)

    def test_orientation_neither_closes_a_mesh_nor_mends_its_winding(self) -> None:
        vertices, faces = tetrahedron()
        turned = faces.copy()
        turned[2] = turned[2][::-1]
        with pytest.raises(MeshError):
            RigidBody.from_mesh(vertices, turned, density=1.0, orient=True)
        with pytest.raises(MeshError):
            RigidBody.from_mesh(vertices, faces[:-1], density=1.0, orient=True)


def _parts(*parts: tuple[float, tuple[float, float, float], bool]) -> Mesh:
    """Cubes: side, centre, whether wound outward."""
    moved = [(_moved(cube(side), center), outward) for side, center, outward in parts]
    return merge(*(mesh if outward else _reversed(mesh) for mesh, outward in moved))


class TestCavities:
    """A surface wound inward is a cavity inside another one, and inside out anywhere else."""

    O, BESIDE = (0.0, 0.0, 0.0), (5.0, 0.1, 0.2)

    def test_beside_the_others_it_is_refused_and_named(self) -> None:
        mesh = _parts((2.0, self.O, True), (1.0, self.BESIDE, False))
        with pytest.raises(
            MeshError, match=r"12 connected faces with faces\[12\].*-(1\.0|0\.9).*orient=True"
        ):
            RigidBody.from_mesh(*mesh, density=1.0)
        soup = mesh[0][mesh[1]].reshape(-1, 3), np.arange(72).reshape(24, 3)
        with pytest.raises(MeshError, match=r"12 connected faces with faces\[12\]"):
            RigidBody.from_mesh(*soup, density=1.0)
        both = _parts((2.0, self.O, True), (1.0, self.BESIDE, True))
        for wrong in (mesh, soup, _reversed(mesh)):
            body = RigidBody.from_mesh(*wrong, density=1.0, orient=True)
            assert bool(body.isclose(RigidBody.from_mesh(*both, density=1.0), rtol=1e-15, atol=1e-15))
            assert body.provenance.checked.endswith("cavities")

    def test_two_that_cancel_are_not_taken_for_nothing(self) -> None:
        mesh = _parts((1.0, self.O, True), (1.0, self.BESIDE, False))
        with pytest.raises(MeshError, match="inside out"):
            RigidBody.from_mesh(*mesh, density=1.0)
        assert RigidBody.from_mesh(*mesh, density=1.0, orient=True).mass == 2.0

    @pytest.mark.parametrize(
        ("parts", "volume"),
        [
            ([(3.0, O, True), (1.0, O, False)], 26.0),
            ([(4.0, O, True), (3.0, O, False), (2.0, O, True), (1.0, O, False)], 64 - 27 + 8 - 1),
            ([(3.0, O, True), (1.0, O, False), (3.0, BESIDE, True), (1.0, BESIDE, False)], 52.0),
        ],
    )
    def test_inside_they_are_taken_out(
        self, parts: list[tuple[float, tuple[float, float, float], bool]], volume: float
    ) -> None:
        assert RigidBody.from_mesh(*_parts(*parts), density=1.0).mass == pytest.approx(volume, rel=1e-14)
        turned = [(side, center, not outward) for side, center, outward in parts]
        with pytest.raises(MeshError, match="inverted"):
            RigidBody.from_mesh(*_parts(*turned), density=1.0)
        body = RigidBody.from_mesh(*_parts(*turned), density=1.0, orient=True)
        assert body.mass == pytest.approx(volume, rel=1e-14)

    @given(attitude=attitudes(), shift=vectors(100.0), data=st.data())
    def test_a_foam(self, attitude: np.ndarray, shift: np.ndarray, data: st.DataObject) -> None:
        """Bubbles on a grid are cavities; one that was moved out is named."""
        outward = [True] + [False] * 27
        centers = [(0.0, 0.0, 0.0)] + [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
        sides = [3.0] + [0.7] * 27

        def foam(out: int | None) -> Mesh:
            places = [(7.0, -0.3, 0.1) if number == out else place for number, place in enumerate(centers)]
            vertices, faces = _parts(*zip(sides, places, outward, strict=True))
            return vertices @ matrix(attitude).T + shift, faces

        vertices, faces = foam(None)
        body = RigidBody.from_mesh(vertices, faces, density=1.0)
        # Far away the coordinates are rounded before the mesh is made of them, those of all bubbles alike.
        rounded = (6 * 9.0 + 27 * 6 * 0.49) * float(np.spacing(np.abs(vertices).max()))
        assert body.mass == pytest.approx(27 - 27 * 0.343, abs=2e-11 + rounded)
        out = data.draw(st.integers(1, 27))
        with pytest.raises(MeshError, match=rf"faces with faces\[{12 * out}\]"):
            RigidBody.from_mesh(*foam(out), density=1.0)

    def test_the_check_may_be_left_out(self) -> None:
        mesh = _parts((2.0, self.O, True), (1.0, self.BESIDE, False))
        assert RigidBody.from_mesh(*mesh, density=1.0, check=False).mass == pytest.approx(7.0, rel=1e-15)


class TestBesideTrimesh:
    """The same numbers as trimesh, where trimesh has digits: no far coordinates, no thin bodies."""

    @pytest.mark.parametrize("name", ["cube", "tetrahedron", "sphere", "two parts", "cavity"])
    @pytest.mark.parametrize("density", [1.0, 7850.0])
    def test_mass_properties(self, name: str, density: float) -> None:
        trimesh = pytest.importorskip("trimesh")
        vertices, faces = CLOSED[name]()
        turn = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
        turn *= np.sign(np.linalg.det(turn))
        vertices = vertices @ turn.T + [0.3, -0.2, 0.7]
        theirs = trimesh.Trimesh(vertices, faces, process=False)
        theirs.density = density
        body = RigidBody.from_mesh(vertices, faces, density=density)
        assert body.mass == pytest.approx(theirs.mass, rel=1e-13)
        assert body.center_of_mass == pytest.approx(theirs.center_mass, abs=1e-13)
        assert np.abs(body.inertia - theirs.moment_inertia).max() < 1e-12 * body.inertia.max()
        moments = np.sort(theirs.principal_inertia_components)
        assert body.principal_moments == pytest.approx(moments, rel=1e-12)

    @pytest.mark.parametrize("damage", ["open", "turned", "none"])
    def test_they_agree_on_what_is_closed(self, damage: str) -> None:
        trimesh = pytest.importorskip("trimesh")
        vertices, faces = icosphere(2)
        if damage == "open":
            faces = faces[:-1]
        if damage == "turned":
            faces[7] = faces[7][::-1]
        theirs = trimesh.Trimesh(vertices, faces, process=False)
        if theirs.is_watertight and theirs.is_winding_consistent:
            assert RigidBody.from_mesh(vertices, faces, density=1.0).mass == pytest.approx(theirs.volume)
        else:
            with pytest.raises(MeshError):
                RigidBody.from_mesh(vertices, faces, density=1.0)


class TestLaws:
    def test_corners_stored_several_times_are_one_vertex(self) -> None:
        """Triangle soup, as STL stores it: bit-equal corners are the same point (and −0 is +0)."""
        vertices, faces = box((1.0, 2.0, 3.0))
        vertices -= vertices[0]
        soup = vertices[faces].reshape(-1, 3)
        soup[::5] *= np.where(soup[::5] == 0, -1.0, 1.0)
        body = RigidBody.from_mesh(soup, np.arange(36).reshape(12, 3), density=1.0)
        assert body == RigidBody.from_mesh(vertices, faces, density=1.0)

    def test_solids_that_touch_along_an_edge_are_closed(self) -> None:
        pair = merge(cube(), _moved(cube(), [1.0, 1.0, 0.0]))
        assert RigidBody.from_mesh(*pair, density=1.0).mass == 2.0

    def test_a_mesh_of_two_parts_is_the_sum_of_the_parts(self) -> None:
        one, two = cube(), _moved(tetrahedron(2.0), [3.0, 1.0, -2.0])
        both = RigidBody.from_mesh(*merge(one, two), density=3.0)
        apart = RigidBody.from_mesh(*one, density=3.0) + RigidBody.from_mesh(*two, density=3.0)
        assert bool(both.isclose(apart, rtol=1e-14, atol=1e-15))


def _mentions(message: str, numbers: set[str]) -> bool:
    return numbers <= set(re.findall(r"\d+", message))
