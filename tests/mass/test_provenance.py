"""Where numbers come from, and bounds on what rounding did to them that hold against exact arithmetic."""

from __future__ import annotations

import pickle
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import errors
from oracles.bodies import matrix
from oracles.exact_particles import Particles
from oracles.exact_polyhedron import polyhedron
from oracles.exact_shapes import polygon, tetrahedra
from oracles.exact_simplices import shell, wire
from oracles.meshes import box, cube, icosphere, merge, tetrahedron
from polhode import MassAccumulator, RigidBody, laminae, regions, rods, solids
from polhode.errors import MeshError

TURN = matrix(np.array([0.2, -0.5, 0.4, 0.7]) / np.linalg.norm([0.2, -0.5, 0.4, 0.7]))
CHECKED = "indices, finite, closed, winding, orientation, volume, duplicates, cavities"
with mpmath.workdps(60):
    PI = Fraction(mpmath.nstr(mpmath.pi, 55))
LINE = np.array([[-1.0], [0.5], [2.0]]) * np.array([1.0, 2.0, -0.5])


class TestProvenance:
    def test_every_constructor_says_what_it_was_made_of(self) -> None:
        points = [(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3)]
        told = {
            "tensor": RigidBody(1.0, np.eye(3)),
            "principal moments": RigidBody.from_principal(1.0, (1, 2, 2.5)),
            "particles": RigidBody.from_particles(np.ones(4), points),
            "mesh": RigidBody.from_mesh(*cube(), mass=1.0),
            "surface": RigidBody.from_surface(*cube(), mass=1.0),
            "curve": RigidBody.from_curve(points, mass=1.0),
            "solid": solids.sphere(1.0, mass=1.0),
            "lamina": laminae.disk(1.0, mass=1.0),
            "rod": rods.rod(1.0, mass=1.0),
            "tetrahedra": RigidBody.from_tetrahedra(points, [(0, 1, 2, 3)], density=1.0),
            "bodies": solids.sphere(1.0, mass=1.0) + solids.cube(1.0, mass=1.0),
        }
        assert {name: body.provenance.source for name, body in told.items()} == {name: name for name in told}
        elements = {name: body.provenance.elements for name, body in told.items()}
        assert elements == {
            "tensor": 1,
            "principal moments": 1,
            "particles": 4,
            "mesh": 12,
            "surface": 12,
            "curve": 3,
            "solid": 1,
            "lamina": 1,
            "rod": 1,
            "tetrahedra": 1,
            "bodies": 2,
        }

    def test_particles_and_cells_of_every_kind(self) -> None:
        points = np.array([(0, 0, 0), (1, 0, 0), (0, 2, 0), (0, 0, 3), (1, 1, 1), (2, 1, 0)], dtype=float)
        masses = np.ones(6)
        stack = RigidBody.from_particles(masses, np.stack([points, 2 * points]))
        assert stack.provenance.elements.tolist() == [6, 6]
        labelled = RigidBody.from_labelled_particles(masses, points, [0, 0, 0, 0, 1, 1])
        assert labelled.provenance.source.tolist() == ["particles", "particles"]
        assert labelled.provenance.elements.tolist() == [4, 2]
        assert labelled.provenance.moments.tolist() == ["second moment", "second moment in own axes"]
        accumulator = MassAccumulator()
        accumulator.add(masses, points)
        assert accumulator.finish().provenance.elements == 6
        voxels = RigidBody.from_voxels(np.ones((2, 3, 4)), (1.0, 1.0, 1.0)).provenance
        assert (voxels.source, voxels.elements, voxels.checked) == ("voxels", 24, "finite, masses")
        density = RigidBody.from_density(lambda r: np.ones(len(r)), regions.ball(1.0))
        assert density.provenance.source == "density"
        assert (solids.cube(2.0, mass=8.0) - solids.cube(1.0, mass=1.0)).provenance.source == "bodies"

    def test_what_was_checked(self) -> None:
        assert RigidBody.from_mesh(*cube(), mass=1.0).provenance.checked == CHECKED
        loose = RigidBody.from_mesh(*cube(), mass=1.0, check=False)
        assert loose.provenance.checked == "unchecked, indices, finite, orientation, volume"
        assert RigidBody(1.0, np.eye(3)).provenance.checked == "finite, tensor"
        both = loose + solids.cube(1.0, mass=1.0)
        assert "unchecked" in both.provenance.checked

    def test_what_produced_the_moments(self) -> None:
        assert RigidBody(1.0, np.eye(3)).provenance.moments == "tensor"
        assert RigidBody.from_principal(1.0, (1, 2, 2.5)).provenance.moments == "given"
        assert solids.cube(1.0, mass=1.0).provenance.moments == "second moment"
        assert RigidBody.from_particles(np.ones(3), LINE).provenance.moments == "second moment in own axes"

    def test_what_was_rounded_to_zero(self) -> None:
        assert RigidBody(1.0, np.diag([1e-17, 1.0, 1.0])).provenance.rounded_to_zero == 1
        assert RigidBody(1.0, np.diag([0.0, 1.0, 1.0])).provenance.rounded_to_zero == 0
        assert RigidBody.from_principal(1.0, (-1e-17, 1, 1)).provenance.rounded_to_zero == 1

    def test_it_stays_with_the_body(self) -> None:
        body = RigidBody.from_mesh(*cube(), mass=1.0, check=False)
        told = str(body.provenance)
        for same in (
            body.translated((1, 2, 3)),
            body.rotated(TURN),
            body.scaled(2.0),
            pickle.loads(pickle.dumps(body)),
            RigidBody.stack([body, body])[1],
        ):
            assert str(same.provenance) == told
            assert same.error_bound.inertia > 0.0
        assert pickle.loads(pickle.dumps(body)).error_bound == body.error_bound
        assert body == RigidBody.from_mesh(*cube(), mass=1.0)  # where numbers come from is not what they are
        assert hash(body) == hash(RigidBody.from_mesh(*cube(), mass=1.0))

    def test_a_stack_has_arrays(self) -> None:
        stack = RigidBody.stack([RigidBody.from_mesh(*cube(), mass=1.0), solids.cube(1.0, mass=1.0)])
        provenance = stack.provenance
        assert provenance.source.tolist() == ["mesh", "solid"]
        assert provenance.elements.tolist() == [12, 1]
        assert provenance.volume_change.shape == (2,)
        assert stack.error_bound.mass.shape == (2,)

    def test_it_reads_as_a_sentence(self) -> None:
        vertices, faces = tetrahedron()
        capped = RigidBody.from_mesh(vertices, faces[:-1], density=1.0, closure="caps")
        text = str(capped.provenance)
        assert text.startswith("mesh of 6 elements; checked: indices, finite, closed")
        assert "closed by caps, which changed the volume by" in text


MOVES = [(1.0, 0.0), (1.0, 1e3), (1e-9, 1e-2), (1e6, 1e14)]
MESHES = {
    "cube": cube(),
    "tetrahedron": tetrahedron(),
    "ball": icosphere(3),
    "plate": box((1.0, 1.0, 1e-6)),
    "needle": box((1e-6, 1e-6, 1.0)),
    "cavity": merge(cube(3.0), (tetrahedron()[0], tetrahedron()[1][:, ::-1])),
}
REACH = {name: 2 if name in ("plate", "needle") else 4 for name in MESHES}
"""Moves that leave the shape in the digits of the coordinates."""


class TestErrorBound:
    """Each number within its bound of the exact one, and the bound of use."""

    @pytest.mark.parametrize(("name", "size", "shift"), [(n, *m) for n in MESHES for m in MOVES[: REACH[n]]])
    def test_of_meshes(self, name: str, size: float, shift: float) -> None:
        mesh = MESHES[name]
        vertices, faces = size * (mesh[0] @ TURN.T) + shift * np.array([1.0, -0.7, 0.3]), mesh[1]
        exact = polyhedron(vertices, faces)
        for check in (True, False):
            body = RigidBody.from_mesh(vertices, faces, density=1.0, check=check)
            self.holds(body, exact.volume, exact.centroid, exact.inertia)
            bound = body.error_bound
            assert bound.mass <= 1e-10 * body.mass
            assert bound.inertia <= 1e-9 * body.inertia.max()

    @pytest.mark.parametrize(("size", "shift"), MOVES)
    def test_of_particles(self, size: float, shift: float, rng: np.random.Generator) -> None:
        masses = rng.uniform(0.1, 2.0, 200)
        positions = size * rng.normal(size=(200, 3)) + shift
        exact = Particles(masses, positions)
        body = RigidBody.from_particles(masses, positions)
        self.holds(body, exact.mass, exact.center_of_mass, exact.inertia)

    @pytest.mark.parametrize(("size", "shift"), MOVES)
    def test_of_shells_and_wires(self, size: float, shift: float, rng: np.random.Generator) -> None:
        vertices, faces = icosphere(1)
        vertices = size * vertices * [1.0, 0.5, 0.1] + shift
        exact = shell(vertices, faces)
        body = RigidBody.from_surface(vertices, faces, areal_density=1.0)
        self.holds_to_fifty_digits(body, exact)
        points = size * rng.normal(size=(50, 3)) + shift
        self.holds_to_fifty_digits(RigidBody.from_curve(points, linear_density=1.0), wire(points))

    def test_of_sums(self) -> None:
        parts = [(cube()[0] + d, cube()[1]) for d in ([0.0, 0.0, 0.0], [3.1, -0.2, 1e3], [-7.7, 0.1, 0.3])]
        body = sum(
            (RigidBody.from_mesh(*part, density=1.0) for part in parts[1:]),
            RigidBody.from_mesh(*parts[0], density=1.0),
        )
        exact = polyhedron(*merge(*parts))
        self.holds(body, exact.volume, exact.centroid, exact.inertia)

    @pytest.mark.parametrize(("size", "shift"), MOVES)
    @pytest.mark.parametrize("kind", ["uniform", "cells", "nodes"])
    def test_of_tetrahedra(self, kind: str, size: float, shift: float, rng: np.random.Generator) -> None:
        nodes = size * rng.normal(size=(12, 3)) + shift
        cells = rng.permuted(np.tile(np.arange(12), (20, 1)), axis=1)[:, :4]
        rho: Any = {"uniform": 2.5, "cells": rng.uniform(0, 3, 20), "nodes": rng.uniform(0, 3, 12)}[kind]
        corners = np.asarray(rho)[cells] if kind == "nodes" else np.broadcast_to(rho, (4, 20)).T
        exact = tetrahedra(nodes, cells, corners)
        body = RigidBody.from_tetrahedra(nodes, cells, density=rho)
        self.holds(body, exact.mass, exact.center, exact.inertia)

    @pytest.mark.parametrize(("size", "shift"), MOVES[:3])
    def test_of_polygons(self, size: float, shift: float) -> None:
        star = [(np.cos(k * np.pi / 5) * (1 + k % 2), np.sin(k * np.pi / 5) * (1 + k % 2)) for k in range(10)]
        for corners in (star, star[:3], [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]):
            placed = size * np.array(corners) + shift * np.array([1.0, -0.7])
            exact = polygon(placed)
            body = laminae.polygon(placed, density=1.0)
            self.holds(body, exact.mass, exact.center, exact.inertia)

    @given(
        size=st.tuples(*[st.floats(1e-6, 1e6)] * 3), density=st.floats(1e-3, 1e3), mass=st.floats(1e-3, 1e3)
    )
    def test_of_solids(self, size: tuple[float, float, float], density: float, mass: float) -> None:
        a, b, c = (Fraction(x) for x in size)

        def diagonal(m: Fraction, second: list[Fraction]) -> list[list[Fraction]]:
            moments = [m * (sum(second) - x) for x in second]
            return [[moments[i] if i == j else Fraction(0) for j in range(3)] for i in range(3)]

        volumes = {"box": a * b * c, "ellipsoid": 4 * PI * a * b * c / 3, "cylinder": PI * a * a * b}
        seconds = {
            "box": [x * x / 12 for x in (a, b, c)],
            "ellipsoid": [x * x / 5 for x in (a, b, c)],
            "cylinder": [a * a / 4, a * a / 4, b * b / 12],
        }
        for name, volume in volumes.items():
            for amount in ({"mass": mass}, {"density": density}):
                body = {
                    "box": lambda amount: solids.box(size, **amount),
                    "ellipsoid": lambda amount: solids.ellipsoid(size, **amount),
                    "cylinder": lambda amount: solids.cylinder(size[0], size[1], **amount),
                }[name](amount)
                m = Fraction(mass) if "mass" in amount else Fraction(density) * volume
                self.holds(body, m, [Fraction(0)] * 3, diagonal(m, seconds[name]))

    def test_of_bodies_moved_turned_and_put_together(self, rng: np.random.Generator) -> None:
        """Boxes of dyadic sizes, turned by right angles: where their corners are is exact."""
        turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
        for _ in range(20):
            bodies, parts = [], []
            for _ in range(3):
                x, y, z = (float(n) / 4 for n in rng.integers(1, 9, 3))
                shift = rng.integers(-99, 99, 3) / 8.0
                vertices, faces = box((x, y, z))
                bodies.append(
                    RigidBody.from_mesh(vertices, faces, density=1.0).rotated(turn).translated(shift)
                )
                parts.append((vertices @ turn.T + shift, faces))
            exact = polyhedron(*merge(*parts))
            whole = bodies[0] + bodies[1] + bodies[2]
            self.holds(whole, exact.volume, exact.centroid, exact.inertia)
            self.holds(RigidBody.stack(bodies).combined(0), exact.volume, exact.centroid, exact.inertia)
            rest = polyhedron(*merge(*parts[:2]))
            self.holds(whole - bodies[2], rest.volume, rest.centroid, rest.inertia)

    @pytest.mark.parametrize("name", MESHES)
    def test_of_principal_moments(self, name: str) -> None:
        """By Weyl each is off by at most three times the bound of the elements, and its own rounding."""
        vertices, faces = MESHES[name][0] @ TURN.T, MESHES[name][1]
        body = RigidBody.from_mesh(vertices, faces, density=1.0)
        with mpmath.workdps(50):
            exact = polyhedron(vertices, faces).inertia
            rows = [[mpmath.mpf(x.numerator) / x.denominator for x in row] for row in exact]
            wanted = sorted(mpmath.eigsy(mpmath.matrix(rows), eigvals_only=True))
            worst = max(abs(a - b) for a, b in zip(body.principal_moments.tolist(), wanted, strict=True))
        assert worst <= 3 * body.error_bound.inertia + 16 * 2**-52 * np.trace(body.inertia)

    def test_what_is_given_is_exact(self) -> None:
        given = RigidBody(2.0, np.diag([1.0, 2.0, 2.5]), (1, 2, 3)).error_bound
        assert (given.mass, given.center_of_mass, given.inertia) == (0.0, 0.0, 0.0)
        assert RigidBody.from_mesh(*cube(), mass=2.0).error_bound.mass == 0.0

    @staticmethod
    def holds(body: RigidBody, mass: Any, center: Any, inertia: Any) -> None:
        bound = body.error_bound
        assert max(errors(body.mass, mass)) <= Fraction(bound.mass)
        assert max(errors(body.center_of_mass, center)) <= Fraction(bound.center_of_mass)
        assert max(errors(body.inertia, inertia)) <= Fraction(bound.inertia)

    @staticmethod
    def holds_to_fifty_digits(body: RigidBody, exact: Any) -> None:
        bound = body.error_bound
        assert abs(body.mass - exact.content) <= bound.mass
        pairs = zip(body.center_of_mass.tolist(), exact.center, strict=True)
        assert all(abs(a - b) <= bound.center_of_mass for a, b in pairs)
        wanted = [x for row in exact.inertia for x in row]
        assert all(
            abs(a - b) <= bound.inertia for a, b in zip(body.inertia.ravel().tolist(), wanted, strict=True)
        )


class TestClosure:
    def test_caps_over_flat_holes_bring_back_the_solid(self) -> None:
        for vertices, faces in (cube(2.0), tetrahedron()):
            whole = RigidBody.from_mesh(vertices, faces, density=1.0)
            for missing in range(0, len(faces), 2):
                open_mesh = np.delete(faces, missing, axis=0)
                body = RigidBody.from_mesh(vertices, open_mesh, density=1.0, closure="caps")
                assert bool(body.isclose(whole, rtol=1e-14, atol=1e-15))

    def test_the_cap_of_a_pipe_with_an_odd_outline(self) -> None:
        """A prism over an L without its two ends, far away: caps over outlines that are not convex."""
        outline = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
        n = len(outline)
        vertices = np.vstack([np.c_[outline, np.zeros(n)], np.c_[outline, np.full(n, 2.0)]]) + 1e6
        faces = [f for i in range(n) for j in [(i + 1) % n] for f in ((i, j, n + j), (i, n + j, n + i))]
        body = RigidBody.from_mesh(vertices, faces, density=1.0, closure="caps")
        assert body.mass == pytest.approx(8.0, rel=1e-14)
        assert body.center_of_mass - 1e6 == pytest.approx([(2 * 1 + 2 * 0.5) / 4, (2 * 0.5 + 2 * 2) / 4, 1.0])
        provenance = body.provenance
        assert (provenance.closure, provenance.elements) == ("caps", 12 + 2 * n)
        # From the middle of the box the two ends span a third of their prisms: 2 × 4 × 1/3.
        assert provenance.volume_change == pytest.approx(8 / 3, rel=1e-9)

    def test_the_hull_of_an_open_mesh(self) -> None:
        pytest.importorskip("scipy")
        vertices, faces = icosphere(2)
        whole = RigidBody.from_mesh(vertices, faces, density=1.0)
        body = RigidBody.from_mesh(vertices + 1e3, faces[5:], density=1.0, closure="hull")
        exact = polyhedron(vertices + 1e3, faces)
        assert body.mass == pytest.approx(float(exact.volume), rel=1e-14)
        assert body.principal_moments == pytest.approx(whole.principal_moments, rel=1e-9)
        assert body.provenance.closure == "hull"
        flat = np.c_[np.eye(3)[:, :2], np.zeros(3)]
        with pytest.raises(MeshError, match="no convex hull with a volume"):
            RigidBody.from_mesh(flat, [(0, 1, 2)], density=1.0, closure="hull")

    def test_a_closed_mesh_is_not_changed(self) -> None:
        mesh = icosphere(2)
        capped = RigidBody.from_mesh(*mesh, density=1.0, closure="caps")
        assert capped == RigidBody.from_mesh(*mesh, density=1.0)
        assert capped.provenance.volume_change == 0.0

    def test_faults_that_no_closure_mends(self) -> None:
        vertices, faces = cube()
        turned = faces.copy()
        turned[3] = turned[3][::-1]
        with pytest.raises(MeshError, match="not consistently wound"):
            RigidBody.from_mesh(vertices, turned, density=1.0, closure="caps")
        with pytest.raises(MeshError, match="names vertex 8"):
            RigidBody.from_mesh(vertices, [*faces[1:].tolist(), (0, 1, 8)], density=1.0, closure="caps")
        with pytest.raises(ValueError, match=r'closure: expected None, "caps" or "hull", got "lid"'):
            RigidBody.from_mesh(vertices, faces, density=1.0, closure="lid")  # type: ignore[arg-type]


class TestUnchecked:
    def test_it_is_safe_anywhere(self) -> None:
        vertices, faces = icosphere(2)
        moved = vertices + 1e8 * np.array([0.6, 0.5, -0.4])
        body = RigidBody.from_mesh(moved, faces, density=1.0, check=False)
        assert body == RigidBody.from_mesh(moved, faces, density=1.0)
        with pytest.raises(MeshError, match=r"faces\[0\] names vertex 162"):
            RigidBody.from_mesh(vertices, [(0, 1, 162)], density=1.0, check=False)
        with pytest.raises(MeshError, match=r"vertices\[7\] is not finite"):
            RigidBody.from_mesh(
                np.where(np.arange(162)[:, None] == 7, np.inf, vertices), faces, density=1.0, check=False
            )

    def test_duplicate_faces_are_told(self) -> None:
        vertices, faces = cube()
        again = np.roll(faces[4], 1)
        with pytest.raises(MeshError, match=r"faces\[4\] and faces\[12\] are the same triangle"):
            RigidBody.from_mesh(vertices, [*faces.tolist(), again.tolist()], density=1.0)
        with pytest.raises(MeshError, match=r"\(12 such pairs in all\)"):
            RigidBody.from_mesh(*merge(cube(), cube()), density=1.0)
