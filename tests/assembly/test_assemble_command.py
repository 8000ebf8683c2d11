"""``polhode assemble``, and the bodies that come whole: saved ones, assemblies, printouts of CAD programs."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, assembly, solids

CART = """
name = "cart"
length_unit = "mm"
[[part]]
name = "bed"
solid = "box"
size = [1000, 600, 20]
density = "2.70 ± 0.05 g/cm^3"
[[part]]
name = "wheel"
solid = "cylinder"
radius = 100
height = 40
mass = "2 lbm"
position = [400, 320, -100]
rotation = { axis = [1, 0, 0], degrees = 90 }
count = 2
turn = { axis = [0, 0, 1], degrees = 180 }
"""


class TestCommand:
    @pytest.fixture
    def cart(self, tmp_path: Path) -> Path:
        path = tmp_path / "cart.toml"
        path.write_text(CART)
        return path

    def test_the_whole_is_reported_as_any_body(self, cart: Path, tmp_path: Path) -> None:
        code, out, err = run("assemble", cart, "--format", "json")
        assert (code, err) == (0, "")
        told = json.loads(out)
        made = assembly.read(cart)
        assert told["mass"] == pytest.approx(32.4 + 4 * 0.45359237, rel=1e-15)
        assert told["sigma"]["mass"] == pytest.approx(0.6, rel=1e-12)
        assert np.array_equal(told["inertia_about_center_of_mass"], made.body.inertia)
        assert [part["id"] for part in told["parts"]] == ["cart", "bed", "wheel", "wheel/1", "wheel/2"]
        code, alone, _ = run("report", cart, "--format", "json")
        assert code == 0
        report = json.loads(alone)
        assert {key: told[key] for key in report if key != "notes"} == {
            k: v for k, v in report.items() if k != "notes"
        } | {"units": told["units"]}
        assert run("assemble", cart, "--as", "drake") == run("report", cart, "--as", "drake")
        made.body.save(tmp_path / "cart.json")
        code, saved, _ = run("report", tmp_path / "cart.json", "--length-unit", "m", "--format", "json")
        assert code == 0
        for key in ("mass", "center_of_mass", "principal_moments", "sigma"):
            assert json.loads(saved)[key] == report[key]

    def test_what_it_saves(self, cart: Path, tmp_path: Path) -> None:
        files = [tmp_path / name for name in ("c.png", "c.json", "c.csv")]
        code, out, err = run("assemble", cart, *(word for file in files for word in ("--save", file)))
        assert (code, err) == (0, "")
        assert "saved" in out
        assert files[0].read_bytes().startswith(b"\x89PNG")
        assert np.array_equal(RigidBody.from_file(files[1]).inertia, assembly.read(cart).body.inertia)
        code, out, _ = run("ledger", files[2], "--overwrite", "--format", "json")
        assert code == 0
        assert json.loads(out)["nodes"][0]["mass"]["value"] == pytest.approx(34.21436948, rel=1e-12)

    @pytest.mark.parametrize(("count", "left"), [(38, 0), (39, 1), (300, 262)])
    def test_long_ones_are_cut(self, count: int, left: int, tmp_path: Path) -> None:
        path = tmp_path / "row.toml"
        path.write_text(
            f"[[part]]\nname = 'a'\nsolid = 'cube'\nside = 1\nmass = 1\ncount = {count}\nstep = [2, 0, 0]\n"
        )
        code, out, _ = run("assemble", path)
        assert code == 0
        assert ("more; --all shows them" in out) == (left > 0)
        assert out.count(f"  and {left} more; --all shows them") == (2 if left else 0)
        assert len(out.splitlines()) < 150
        assert re.search(rf"^  parts +{count}$", out, re.MULTILINE)
        _, whole, _ = run("assemble", path, "--all")
        assert "more; --all" not in whole
        _, told, _ = run("assemble", path, "--format", "json")
        assert len(json.loads(told)["parts"]) == count + 2  # the whole, and the row of copies

    def test_depth_expect_and_units(self, cart: Path, tmp_path: Path) -> None:
        code, out, _ = run("assemble", cart, "--depth", "1", "--mass-unit", "lbm", "--about", "0 0 10 mm")
        assert code == 0
        assert "wheel" in out
        assert "    1 " not in out
        assert "lbm" in out
        expected = tmp_path / "e.json"
        expected.write_text('{"mass": 34.0}')
        assert run("assemble", cart, "--expect", expected)[0] == 1
        assert run("assemble", cart, "--expect", expected, "--rtol", "0.01")[0] == 0

    def test_a_report_is_a_body_too(self, tmp_path: Path) -> None:
        words = ("--mass", "2", "--com", "0 0 0.1", "--inertia", "3 4 5 0.5 0 0", "--products", "positive")
        path = tmp_path / "part.json"
        assert run("report", *words, "--output", path)[0] == 0
        code, out, err = run("report", path, "--format", "json", "--expect", path)
        assert (code, err) == (0, "")
        assert json.loads(out)["format"] == "report"
        assert run("report", path, "--as", "urdf")[:2] == run("report", *words, "--as", "urdf")[:2]
        part = {"name": "a", "file": "part.json", "position": [1, 0, 0]}
        body = assembly.read({"part": [part]}, folder=tmp_path).body
        assert body.center_of_mass.tolist() == [1.0, 0.0, 0.1]
        assert run("report", path, "--length-unit", "mm")[0] == 2
        fields = json.loads(path.read_text())
        for change, says in (
            ({"sigma": {"mass": 0.1}}, "which of its sigmas go together"),
            ({"units": fields["units"] | {"mass": "u"}}, "a report in u and m"),
            ({"inertia_about_center_of_mass": [[1, 0, 0], [0, 1, 0], [0, 0, 9]]}, "I1 + I2"),
            ({"inertia_about_center_of_mass": [1, 2]}, "not the numbers of a body"),
        ):
            path.write_text(json.dumps(fields | change))
            code, _, err = run("report", path)
            assert code == 2
            assert says in err

    def test_a_saved_body_without_a_unit(self, tmp_path: Path) -> None:
        solids.box((10.0, 20.0, 30.0), mass=2.0).save(tmp_path / "b.npz")
        code, out, _ = run("report", tmp_path / "b.npz", "--length-unit", "mm", "--format", "json")
        assert code == 0
        assert json.loads(out)["principal_moments"][0] == pytest.approx(2.0 / 12 * 5e-4, rel=1e-14)
        code, out, _ = run("report", tmp_path / "b.npz")
        assert code == 0
        assert "unit unknown" in out

    def test_a_part_is_not_written_over(self, cart: Path, tmp_path: Path) -> None:
        outer = tmp_path / "outer.toml"
        outer.write_text('[[part]]\nname = "x"\nassembly = "cart.toml"\n')
        for command in ("assemble", "report"):
            code, _, err = run(command, outer, "--output", cart)
            assert code == 2
            assert "is a file that is read" in err
        assert cart.read_text() == CART


class TestPrintouts:
    """A tensor as CAD programs print it: `box` moved and turned, by hand."""

    def body(self) -> RigidBody:
        return solids.box((1, 2, 3), mass=2.0).rotated([0.1, 0.3, 0.3, 0.9]).translated((1, 2, 3))

    @pytest.mark.parametrize("sign", ["positive", "negative"])
    @pytest.mark.parametrize("count", [6, 9])
    @pytest.mark.parametrize("about", ["center_of_mass", "origin"])
    def test_it_is_the_body(self, sign: str, count: int, about: str) -> None:
        body = self.body()
        matrix = np.array(body.inertia_about(about))
        if sign == "positive":
            matrix = 2 * np.diag(np.diag(matrix)) - matrix
        rows, columns = (
            ([0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]) if count == 6 else np.indices((3, 3)).reshape(2, 9)
        )
        numbers = " ".join(f"{float(x):.17g}" for x in matrix[rows, columns])
        com = " ".join(f"{float(x):.17g}" for x in body.center_of_mass)
        words = [
            "--mass",
            "2",
            "--com",
            com,
            "--inertia",
            numbers,
            "--products",
            sign,
            "--inertia-about",
            about,
        ]
        code, out, err = run("report", *words, "--format", "json")
        assert (code, err) == (0, "")
        told = json.loads(out)
        assert np.allclose(told["inertia_about_center_of_mass"], body.inertia, rtol=0, atol=2e-14)
        assert np.allclose(told["principal_moments"], body.principal_moments, rtol=1e-13)
        code, out, err = run("spin", *words, "--omega", "0 0 1", "--format", "json")
        assert (code, err) == (0, "")
        assert np.allclose(json.loads(out)["principal_moments"], body.principal_moments, rtol=1e-13)

    def test_units_of_the_desk(self) -> None:
        code, out, _ = run("report", "--mass", "1 slug", "--inertia", "3 4 5 lbf-in-s^2", "--format", "json")
        assert code == 0
        told = json.loads(out)
        assert told["principal_moments"] == pytest.approx(
            [k * 0.45359237 * 9.80665 * 0.0254 for k in (3, 4, 5)]
        )
        assert told["notes"] == ["no --center-of-mass was given: the centre of mass was taken at the origin"]
