"""Meshes of several components: their volumes, what they share, and their union against closed forms."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh
from boxes import NESTED, SHARED, TWO, at, joined, written
from command_line import run
from polhode import RigidBody, solids
from polhode.errors import MeshError
from polhode.io import components
from polhode.io.components import labels, overlaps, parts_of, winding
from polhode.io.union import shared_volume, unite

if TYPE_CHECKING:
    from pathlib import Path

Box = tuple[np.ndarray, np.ndarray]


def shared(boxes: list[Box]) -> Box | None:
    low = np.max([place - size / 2 for size, place in boxes], axis=0)
    high = np.min([place + size / 2 for size, place in boxes], axis=0)
    return (high - low, (low + high) / 2.0) if (low < high).all() else None


def solid(one: Box) -> RigidBody:
    return solids.box(one[0], density=1.0).translated(one[1])


def true_union(boxes: list[Box]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, first and second moments about the origin, by inclusion and exclusion: boxes share boxes."""
    mass, first, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    for count in range(1, len(boxes) + 1):
        for some in combinations(boxes, count):
            common = shared(list(some))
            if common is not None:
                body, sign = solid(common), (-1) ** (count + 1)
                mass += sign * float(body.mass)
                first += sign * float(body.mass) * body.center_of_mass
                inertia += sign * body.inertia_about((0.0, 0.0, 0.0))
    return mass, first, inertia


class TestParts:
    def test_labels_are_those_of_the_components(self, rng: np.random.Generator) -> None:
        """Against a search that walks from face to face."""
        for count, faces_count in ((5, 1), (30, 8), (300, 80), (300, 120), (2000, 5000)):
            faces = rng.integers(0, count, (faces_count, 3))
            found = labels(faces, count)
            want = 0
            of_vertex: list[set[int]] = [set() for _ in range(count)]
            for row, face in enumerate(faces.tolist()):
                for vertex in face:
                    of_vertex[vertex].add(row)
            seen = np.full(faces_count, -1)
            for row in range(faces_count):
                if seen[row] >= 0:
                    continue
                waiting = [row]
                while waiting:
                    face = waiting.pop()
                    if seen[face] < 0:
                        seen[face] = want
                        waiting += [other for vertex in faces[face].tolist() for other in of_vertex[vertex]]
                want += 1
            np.testing.assert_array_equal(found, seen)

    def test_cavities_belong_to_the_component_around_them(self) -> None:
        """A box in the cavity of a box: two parts, one hollow."""
        mesh = joined(
            at((4, 4, 4), (1, 0, 0)),
            at((3, 3, 3), (1, 0, 0), inward=True),
            at((1, 1, 1), (1, 0, 0)),
            at((1, 1, 1), (9, 0, 0)),
        )
        for turned in (mesh, (mesh[0], mesh[1][:, ::-1])):
            parts = parts_of(*turned)
            assert [(part.name, part.cavities) for part in parts] == [("1", 1), ("2", 0), ("3", 0)]
            np.testing.assert_allclose([part.volume for part in parts], [64 - 27, 1, 1], rtol=1e-14)
            assert overlaps(parts) == []

    def test_corners_that_are_equal_are_one(self) -> None:
        """Each face with vertices of its own: still two cubes."""
        vertices, faces = joined(at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (3, 0, 0)))
        parts = parts_of(vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
        np.testing.assert_allclose([part.volume for part in parts], [1.0, 1.0], rtol=1e-14)

    def test_one_component_is_one_part(self) -> None:
        (part,) = parts_of(*at((1, 2, 3), (5, 5, 5)))
        assert part.volume == pytest.approx(6.0, rel=1e-14)

    def test_rays_tell_what_solid_angles_tell(self, rng: np.random.Generator) -> None:
        """Around a cube with an offset cavity; points askew, and on the planes of its faces and edges."""
        vertices, faces = joined(at((2, 2, 2), (0, 0, 0)), at((1, 1, 1), (0.25, 0.5, 0), inward=True))
        points = np.concatenate([rng.uniform(-1.5, 1.5, (300, 3)), rng.integers(-6, 7, (300, 3)) / 4.0])
        for turned in (np.eye(3), components._ASKEW):
            triangles = vertices[faces] @ turned
            boxes = components._boxes(triangles)
            for point in points @ turned:
                expected = abs(winding(point[None], triangles)[0])
                if abs(expected - 0.5) < 0.4:  # on a face, an edge or a corner it is neither
                    continue
                assert components._is_inside(point, triangles, *boxes) == (expected > 0.5)

    def test_a_winding_number_is_one_within(self) -> None:
        vertices, faces = at((1, 2, 3), (5, 5, 5))
        points = np.array([(5, 5, 5), (5.49, 5.99, 6.49), (5.51, 5, 5), (0, 0, 0)])
        np.testing.assert_allclose(winding(points, vertices[faces]), [1, 1, 0, 0], atol=1e-12)


class TestOverlaps:
    def test_what_is_shared_is_told(self, has_union: bool) -> None:
        (found,) = overlaps(parts_of(*TWO))
        assert (found.one, found.other, found.is_inside) == ("1", "2", False)
        assert np.isnan(found.volume) != has_union
        if has_union:
            assert found.volume == pytest.approx(SHARED, rel=1e-12)

    @pytest.mark.usefixtures("has_union")
    def test_what_lies_within_is_told(self) -> None:
        (found,) = overlaps(parts_of(*NESTED))
        assert (found.one, found.other, found.is_inside) == ("1", "2", True)
        assert found.volume == pytest.approx(1e-3, rel=1e-12)

    @pytest.mark.usefixtures("has_union")
    @pytest.mark.parametrize("x", [1.0, 1.5])
    def test_what_touches_or_stands_apart_shares_nothing(self, x: float) -> None:
        assert overlaps(parts_of(*joined(at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (x, 0.3, 0.2))))) == []

    def test_balls_share_a_lens(self) -> None:
        """π h² (3 r − h)/3 twice, h = r − d/2; less by what facets lack, which is shown to shrink by 4."""
        pytest.importorskip("manifold3d")
        height = 0.6
        want = 2.0 * np.pi * height**2 * (3.0 - height) / 3.0
        lacks = []
        for fineness in (3, 4):
            ball = trimesh.creation.icosphere(fineness)
            pair = joined(*((ball.vertices + np.array([x, 0.0, 0.0]), ball.faces) for x in (0.0, 0.8)))
            (found,) = overlaps(parts_of(*pair))
            lacks.append(want - found.volume)
        assert 0.0 < lacks[1] < lacks[0] < 0.02 * want
        assert lacks[0] / lacks[1] == pytest.approx(4.0, rel=0.05)

    def test_many_are_told_in_few_lines(self) -> None:
        known = [components.Overlap("1", str(k), 0.1 * k, False) for k in range(2, 12)]
        lines = components.describe_overlaps(known, 10.0, " m^3")
        assert lines[0] == "components 1 and 11 overlap: 1.1 m^3 (11 % of the volume) counts twice"
        assert len(lines) == 9
        assert lines[-1] == "2 more pairs of components overlap"
        unknown = [components.Overlap("1", str(k), float("nan"), False) for k in range(2, 12)]
        (line,) = components.describe_overlaps(unknown, 10.0)
        assert line.startswith("components 1 and 2, 1 and 3, ")
        assert " and 2 pairs more overlap: what they share counts twice; " in line


class TestUnion:
    def test_what_is_open_is_not_handed_over(self) -> None:
        """Manifold3d ends the process on some meshes that are open."""
        pytest.importorskip("manifold3d")
        vertices, faces = at((1, 1, 1), (0, 0, 0))
        other = at((1, 1, 1), (0.5, 0, 0))
        for open_faces in (faces[:-1], faces[:9], np.concatenate([faces[:-1], faces[-1:, ::-1]])):
            assert np.isnan(shared_volume((vertices, open_faces), other))
            with pytest.raises(MeshError, match="a component is open"):
                unite([(vertices, open_faces), other], "OBJ")
        assert shared_volume((vertices, faces), other) == pytest.approx(0.5, rel=1e-12)

    @pytest.mark.parametrize("count", [2, 3, 4])
    def test_of_boxes_is_that_of_closed_forms(
        self, count: int, rng: np.random.Generator, tmp_path: Path
    ) -> None:
        pytest.importorskip("manifold3d")
        for _ in range(6):
            boxes = [(rng.uniform(0.5, 1.5, 3), rng.uniform(-0.4, 0.4, 3) + 5.0) for _ in range(count)]
            path = written(
                tmp_path / "boxes.obj", *(at(*each) for each in boxes), names=tuple(map(str, range(count)))
            )
            body = RigidBody.from_file(path, density=1.0, union=True)
            mass, first, inertia = true_union(boxes)
            assert float(body.mass) == pytest.approx(mass, rel=1e-12)
            np.testing.assert_allclose(body.center_of_mass, first / mass, rtol=1e-12, atol=1e-12)
            about_o = body.inertia_about((0.0, 0.0, 0.0))
            np.testing.assert_allclose(about_o, inertia, rtol=1e-12, atol=1e-12 * np.trace(inertia))

    def test_cavities_stay(self, tmp_path: Path) -> None:
        pytest.importorskip("manifold3d")
        hollow = (at((4, 4, 4), (0, 0, 0)), at((3, 3, 3), (0, 0, 0), inward=True), at((4, 1, 1), (3.9, 0, 0)))
        path = written(tmp_path / "h.obj", *hollow, names=("a", "b", "c"))
        body = RigidBody.from_file(path, density=1.0, union=True)
        # The bar reaches 0.1 into a wall of 0.5.
        assert float(body.mass) == pytest.approx(64 - 27 + 4 - 0.1, rel=1e-12)

    def test_without_the_library_the_line_that_installs_it_is_told(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setitem(__import__("sys").modules, "manifold3d", None)
        path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (0.5, 0, 0)))
        code, out, err = run("report", path, "--union")
        assert (code, out) == (2, "")
        assert 'the union of solids needs manifold3d: pip install "polhode[union]"' in err
