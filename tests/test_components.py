"""Meshes of several components: their volumes, what they share, and their union against closed forms."""

from __future__ import annotations

import gzip
import json
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh
from command_line import run
from mesh_files import obj
from oracles.meshes import box
from polhode import RigidBody, robots, solids
from polhode.errors import MeshError
from polhode.files import body_from_file, components
from polhode.files.components import labels, overlaps, parts_of, winding
from polhode.files.union import shared_volume, united
from robot_texts import link, urdf

if TYPE_CHECKING:
    from pathlib import Path

Box = tuple[np.ndarray, np.ndarray]


def joined(*meshes: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Several meshes as one, their vertices one after the other."""
    before = np.cumsum([0] + [len(vertices) for vertices, _ in meshes])
    faces = [faces + start for (_, faces), start in zip(meshes, before[:-1], strict=True)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(faces)


def at(size: Any, place: Any, inward: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """A box with its centre there."""
    vertices, faces = box(size)
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
    return vertices - middle + np.asarray(place), faces[:, ::-1] if inward else faces


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


TWO = joined(at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
SHARED = 0.4 * 0.5 * 0.7
NESTED = joined(at((1, 1, 1), (0, 0, 0)), at((0.1, 0.1, 0.1), (0.2, 0, 0)))


def written(
    path: Path, *meshes: tuple[np.ndarray, np.ndarray], names: tuple[str, ...] = ("body", "insert")
) -> Path:
    """An OBJ file with a group for each mesh."""
    text, before = "", 1
    for name, (vertices, faces) in zip(names, meshes, strict=True):
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (faces + before).tolist()]
        text += f"o {name}\n" + "\n".join(lines) + "\n"
        before += len(vertices)
    path.write_text(text)
    return path


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

    def test_a_winding_number_is_one_within(self) -> None:
        vertices, faces = at((1, 2, 3), (5, 5, 5))
        points = np.array([(5, 5, 5), (5.49, 5.99, 6.49), (5.51, 5, 5), (0, 0, 0)])
        np.testing.assert_allclose(winding(points, vertices[faces]), [1, 1, 0, 0], atol=1e-12)


@pytest.fixture(params=[True, False], ids=["with manifold3d", "without"])
def has_union(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    if request.param:
        pytest.importorskip("manifold3d")
    else:
        monkeypatch.setattr(components, "has_union", lambda: False)
    return bool(request.param)


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
        lines = components.told(known, 10.0, " m^3")
        assert lines[0] == "components 1 and 11 overlap: 1.1 m^3 (11 % of the volume) counts twice"
        assert len(lines) == 9
        assert lines[-1] == "2 more pairs of components overlap"
        unknown = [components.Overlap("1", str(k), float("nan"), False) for k in range(2, 12)]
        (line,) = components.told(unknown, 10.0)
        assert line.startswith("components 1 and 2, 1 and 3, ")
        assert " and 2 pairs more overlap: what they share counts twice; " in line


@pytest.mark.parametrize(("depth", "is_told"), [(0.0019, False), (0.0021, True)])
def test_check_leaves_out_what_is_little(depth: float, is_told: bool, tmp_path: Path) -> None:
    """Two cubes of side 1 that share a slice: told from a thousandth of both on."""
    pytest.importorskip("manifold3d")
    (tmp_path / "two.obj").write_bytes(
        obj(*joined(at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (1 - depth, 0, 0))))
    )
    text = urdf(link("a", 1.0, 0.2, '<mesh filename="two.obj"/>'))
    (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=tmp_path))
    assert bool(verdict.notes) == is_told


@pytest.mark.parametrize(("most", "is_told"), [(48, False), (47, True)])
def test_check_tells_where_it_does_not_search(
    most: int, is_told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three cubes in a row, of which two pairs meet: 4 times 12 triangles."""
    monkeypatch.setattr("polhode.robots.geometry._MOST_PAIRED", most)
    row = [at((1, 1, 1), (x, 0, 0)) for x in (0.0, 0.9995, 1.999)]
    (tmp_path / "row.obj").write_bytes(obj(*joined(*row)))
    text = urdf(link("a", 1.0, (0.2, 0.8, 0.8), '<mesh filename="row.obj"/>'))
    (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=tmp_path))
    assert any("3 components were not searched for overlaps" in note for note in verdict.notes) == is_told


class TestUnion:
    def test_what_is_open_is_not_handed_over(self) -> None:
        """Manifold3d ends the process on some meshes that are open."""
        pytest.importorskip("manifold3d")
        vertices, faces = at((1, 1, 1), (0, 0, 0))
        other = at((1, 1, 1), (0.5, 0, 0))
        for open_faces in (faces[:-1], faces[:9], np.concatenate([faces[:-1], faces[-1:, ::-1]])):
            assert np.isnan(shared_volume((vertices, open_faces), other))
            with pytest.raises(MeshError, match="a component is open"):
                united([(vertices, open_faces), other], "OBJ")
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
            body = body_from_file(path, density=1.0, union=True)
            mass, first, inertia = true_union(boxes)
            assert float(body.mass) == pytest.approx(mass, rel=1e-12)
            np.testing.assert_allclose(body.center_of_mass, first / mass, rtol=1e-12, atol=1e-12)
            about_o = body.inertia_about((0.0, 0.0, 0.0))
            np.testing.assert_allclose(about_o, inertia, rtol=1e-12, atol=1e-12 * np.trace(inertia))

    def test_cavities_stay(self, tmp_path: Path) -> None:
        pytest.importorskip("manifold3d")
        hollow = (at((4, 4, 4), (0, 0, 0)), at((3, 3, 3), (0, 0, 0), inward=True), at((4, 1, 1), (3.9, 0, 0)))
        path = written(tmp_path / "h.obj", *hollow, names=("a", "b", "c"))
        body = body_from_file(path, density=1.0, union=True)
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


class TestReport:
    def report(self, path: Path, *options: str) -> dict[str, Any]:
        code, out, err = run("report", path, "--format", "json", *options)
        assert (code, err) == (0, "")
        told: dict[str, Any] = json.loads(out)
        return told

    def test_components_and_what_they_share(self, tmp_path: Path, has_union: bool) -> None:
        path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
        found = self.report(path, "--length-unit", "m", "--density", "2")
        assert [part["name"] for part in found["components"]] == ["body", "insert"]
        np.testing.assert_allclose([part["volume"] for part in found["components"]], [1.0, 0.35], rtol=1e-12)
        assert [part["density"] for part in found["components"]] == [2.0, 2.0]
        (note,) = [note for note in found["notes"] if "overlap" in note]
        much = "0.14 m^3 (10.4 % of the volume) counts twice" if has_union else 'pip install "polhode[union]"'
        assert note.startswith("components body and insert overlap: ")
        assert much in note
        if has_union:
            alone = self.report(path, "--length-unit", "m", "--density", "2", "--union")
            assert alone["mass"] == pytest.approx(2 * 1.21, rel=1e-12)
            assert any("how far that moves corners is in no bound" in note for note in alone["notes"])

    def test_numbers_for_other_programs_come_with_notes(self, tmp_path: Path, has_union: bool) -> None:
        path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
        code, out, err = run("report", path, "--length-unit", "m", "--density", "2", "--as", "urdf")
        assert code == 0
        assert out.startswith("<inertial>")
        notes = err.splitlines()
        assert all(note.startswith("polhode: note: ") for note in notes)
        assert any("components body and insert overlap" in note for note in notes)
        assert has_union == any("0.14 m^3" in note for note in notes)

    def test_what_is_repaired_is_joined_after(self, tmp_path: Path) -> None:
        pytest.importorskip("manifold3d")
        vertices, faces = joined(at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
        faces = np.concatenate([faces[:2], faces[2:3, ::-1], faces[3:], faces[-1:]])  # one turned, one twice
        path = tmp_path / "two.obj"
        path.write_bytes(obj(vertices, faces))
        found = self.report(path, "--length-unit", "mm", "--density", "2", "--repair", "--union")
        assert found["mass"] == pytest.approx(2 * 1.21e-9, rel=1e-12)
        assert [step["step"] for step in found["repaired"]] == ["drop", "orient", "union"]
        union = found["repaired"][-1]["volume_change_percent"]
        assert union == pytest.approx(-100 * 0.14 / 1.21, rel=1e-9)
        body = RigidBody.from_file(path, length_unit="mm", density=2.0, repair=True, union=True)
        assert body.mass == pytest.approx(2 * 1.21e-9, rel=1e-12)
        assert body.provenance.checked.endswith(", repaired")

    @pytest.mark.parametrize(("most", "is_told"), [(24, True), (23, False)])
    def test_large_meshes_are_not_taken_apart(
        self, most: int, is_told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        from polhode.cli import components as told

        assert told._MOST_FACES == 250_000
        monkeypatch.setattr(told, "_MOST_FACES", most)
        path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (3, 0, 0)))
        assert ("components" in self.report(path)) == is_told

    def test_a_density_for_each(self, tmp_path: Path) -> None:
        boxes = [(np.array([1.0, 1, 1]), np.zeros(3)), (np.array([1, 0.5, 0.7]), np.array([2, 0.1, 0.0]))]
        path = written(tmp_path / "two.obj", *(at(*each) for each in boxes))
        found = self.report(path, "--length-unit", "m", "--density", "body=2700, insert=7.8 g/cm^3")
        want = solids.box(boxes[0][0], density=2700.0) + solids.box(boxes[1][0], density=7800.0).translated(
            boxes[1][1]
        )
        assert found["mass"] == pytest.approx(float(want.mass), rel=1e-14)
        np.testing.assert_allclose(found["center_of_mass"], want.center_of_mass, atol=1e-14)
        assert found["density"] == pytest.approx(float(want.mass) / 1.35, rel=1e-14)
        assert [part["density"] for part in found["components"]] == [2700.0, 7800.0]

    def test_names_of_a_packed_file_and_bare_numbers(self, tmp_path: Path) -> None:
        path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (3, 0, 0)))
        packed = tmp_path / "two.obj.gz"
        packed.write_bytes(gzip.compress(path.read_bytes()))
        found = self.report(packed, "--length-unit", "m", "--density", "body=2700, insert=7.8 g/cm^3")
        assert [part["density"] for part in found["components"]] == [2700.0, 7800.0]
        assert "--density body=2700 has no unit: kg/m^3 was taken" in found["notes"]
        assert not any("insert" in note for note in found["notes"])

    def test_components_that_were_turned_are_listed_and_joined(self, tmp_path: Path, has_union: bool) -> None:
        path = written(tmp_path / "two.obj", at((2, 2, 2), (0, 0, 0)), at((1, 1, 1), (3, 0, 0), inward=True))
        found = self.report(path, "--orient", "--density", "body=1, insert=3")
        assert found["mass"] == pytest.approx(11.0, rel=1e-14)
        assert [part["volume"] for part in found["components"]] == pytest.approx([8.0, 1.0])
        if has_union:
            code, _, err = run("report", path, "--union", "--density", "1")
            assert code == 2
            assert "component 2 of the mesh is inside out" in err
            assert "pass --orient to turn it" in err
            assert self.report(path, "--union", "--orient", "--density", "1")["mass"] == pytest.approx(9.0)

    def test_more_than_are_listed(self, tmp_path: Path, has_union: bool) -> None:
        many = [at((2, 2, 2), (i, 0, 0)) for i in range(201)]
        (tmp_path / "many.obj").write_bytes(obj(*joined(*many)))
        found = self.report(tmp_path / "many.obj", "--density", "1")
        assert found["mass"] == pytest.approx(201 * 8.0)
        assert any("201 components are more than 200" in note for note in found["notes"])
        if has_union:
            whole = self.report(tmp_path / "many.obj", "--density", "1", "--union")
            assert whole["mass"] == pytest.approx(202 * 4.0, rel=1e-12)

    def test_corners_that_were_welded_before_the_union_are_told(self, tmp_path: Path) -> None:
        pytest.importorskip("manifold3d", reason="joining needs polhode[union]")
        vertices, faces = at((2, 2, 2), (1, 0, 0))
        faces = faces.copy()
        vertices = np.vstack([vertices, vertices[faces[0, 0]] + 1e-7])
        faces[0, 0] = 8
        (tmp_path / "two.obj").write_bytes(obj(*joined(at((2, 2, 2), (0, 0, 0)), (vertices, faces))))
        found = self.report(tmp_path / "two.obj", "--density", "1", "--union", "--weld", "1e-6")
        assert found["mass"] == pytest.approx(12.0, rel=1e-6)
        assert any(note.startswith("1 corners were joined") for note in found["notes"])

    def test_components_without_names_have_numbers(self, tmp_path: Path) -> None:
        (tmp_path / "two.obj").write_bytes(obj(*joined(at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (3, 0, 0)))))
        found = self.report(tmp_path / "two.obj", "--density", "1=1,2=3")
        assert found["mass"] == pytest.approx(4.0, rel=1e-14)

    @pytest.mark.parametrize(
        ("density", "says"),
        [
            ("body=1", "nothing is said of component insert; add insert=DENSITY"),
            (
                "body=1,insert=2,lid=3",
                "'lid=3' names no component; give NAME=DENSITY for each, by commas, of body, insert",
            ),
            ("body=1,body=2", "'body=2' stands twice"),
            ("body=1,insert=0", "insert=0 is not above 0"),
            ("body=1,insert=2 g/cm^3", "state --length-unit too"),
        ],
    )
    def test_densities_that_do_not_fit_are_refused(self, density: str, says: str, tmp_path: Path) -> None:
        path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 1, 1), (3, 0, 0)))
        code, _, err = run("report", path, "--density", density)
        assert code == 2
        assert says in err


def test_check_tells_of_them_too(tmp_path: Path, has_union: bool) -> None:
    (tmp_path / "two.obj").write_bytes(obj(*TWO))
    text = urdf(link("a", 1.0, 0.2, '<mesh filename="two.obj"/>'))
    (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=tmp_path))
    much = "0.14 m^3 (10.4 % of the volume) counts twice" if has_union else "what they share counts twice"
    assert verdict.notes[0].startswith("line 1: mesh two.obj: components 1 and 2 overlap: " + much)
