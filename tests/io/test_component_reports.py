"""Components in reports and checks: their volumes and densities each, and what is told of overlaps."""

from __future__ import annotations

import gzip
import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from boxes import TWO, at, joined, written
from command_line import run
from mesh_files import obj
from polhode import RigidBody, robots, solids
from robot_texts import link, urdf

if TYPE_CHECKING:
    from pathlib import Path


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
            assert any(
                "the error bounds do not include how far this moves corners" in note
                for note in alone["notes"]
            )

    @pytest.mark.parametrize("marks", [" # of {}", " \\\n", "/1/1 \\\r\n "])
    def test_names_of_groups_whatever_stands_in_the_lines_of_faces(self, tmp_path: Path, marks: str) -> None:
        """A comment behind the corners, or a backslash that joins the line with the next."""
        path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 1, 2), (3, 0, 0)))
        lines = path.read_text().splitlines()
        mark = marks if marks.startswith(" #") else ""
        for i, line in enumerate(lines):
            if line.startswith(("f", "v")):
                words = line.split()
                ends = marks if line.startswith("f") or not marks.startswith("/") else " \\\n"
                lines[i] = f"{line}{mark}" if mark else f"{' '.join(words[:2])}{ends}{' '.join(words[2:])}"
        path.write_text("\n".join(lines) + "\n")
        found = self.report(path, "--length-unit", "m", "--density", "body=2, insert=5")
        assert [part["density"] for part in found["components"]] == [2.0, 5.0]
        assert found["mass"] == pytest.approx(2.0 * 1.0 + 5.0 * 2.0, rel=1e-12)

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
            ("body=1", "no density is given for component insert; add insert=DENSITY"),
            (
                "body=1,insert=2,lid=3",
                "there is no component 'lid'; give one density for each of body, insert, by name",
            ),
            ("body=1,body=2", "'body=2' is given twice"),
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
    monkeypatch.setattr("polhode.io.components._MOST_PAIRED", most)
    row = [at((1, 1, 1), (x, 0, 0)) for x in (0.0, 0.9995, 1.999)]
    (tmp_path / "row.obj").write_bytes(obj(*joined(*row)))
    text = urdf(link("a", 1.0, (0.2, 0.8, 0.8), '<mesh filename="row.obj"/>'))
    (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=tmp_path))
    assert any("3 components were not searched for overlaps" in note for note in verdict.notes) == is_told
