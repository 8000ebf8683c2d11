"""``polhode report``: units, points, other forms of output, comparison, standard input."""

from __future__ import annotations

import gzip
import io
import json
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run, write_obj
from mesh_files import WRITERS
from oracles.meshes import box
from polhode import RigidBody
from polhode.cli.terminal import progress
from polhode.errors import PolhodeError
from polhode.units import quantities, quantity, vector

if TYPE_CHECKING:
    from pathlib import Path

POUND, INCH = 0.45359237, 0.0254


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    """A 1 x 2 x 3 box that stands with one corner at the origin."""
    vertices, faces = box((1.0, 2.0, 3.0))
    return write_obj(tmp_path / "slab.obj", vertices + np.array([0.5, 1.0, 1.5]), faces)


def fields(*arguments: object) -> dict[str, Any]:
    code, out, err = run("report", *arguments, "--format", "json")
    assert (code, err) == (0, "")
    report: dict[str, Any] = json.loads(out)
    return report


class TestQuantities:
    @pytest.mark.parametrize(
        ("text", "unit", "value"),
        [
            ("2700", "kg/m^3", 2700.0),
            ("2.7 g/cm^3", "kg/m^3", 2700.0),
            ("2.7g/cm3", "kg/m^3", 2700.0),
            ("0.0975 lb/in^3", "kg/m^3", 0.0975 * POUND / INCH**3),
            ("-1.5e-3", "m", -0.0015),
            (".5 in", "m", 0.0127),
            ("3 kg m-3", "kg/m^3", 3.0),
            ("1 slug ft^2", "kg m^2", 1.3558179483314004),
            ("5.41 d", "s", 467424.0),
            ("1.5 h", "s", 5400.0),
            ("60 rpm", "rad/s", 2 * np.pi),
            ("1 rev/s", "rad/s", 2 * np.pi),
            ("180 deg/s", "rad/s", np.pi),
            ("9.81 m/s^2", "m/s^2", 9.81),
        ],
    )
    def test_units(self, text: str, unit: str, value: float) -> None:
        assert quantity(text, unit, "--x") == pytest.approx(value, rel=2e-16)

    @pytest.mark.parametrize(
        "texts",
        [("1", "2", "-3", "deg/s"), ("1 2 -3 deg/s",), ("1 deg/s, 2 deg/s, -3 deg/s",), ("1, 2, -3 deg/s",)],
    )
    def test_vectors(self, texts: tuple[str, ...]) -> None:
        np.testing.assert_allclose(vector(texts, "rad/s", "--x"), np.deg2rad([1, 2, -3]), rtol=1e-15)

    def test_two_of_them(self) -> None:
        assert quantities(("5.41 d, 12 h",), 2, "s", "--x") == (467424.0, 43200.0)

    @pytest.mark.parametrize(
        "text", ["", "d", "1 2", "9**9**9", "1 m**9**9**9", "1;2", "1 __import__", "1e5000"]
    )
    def test_what_is_no_quantity(self, text: str) -> None:
        with pytest.raises(PolhodeError, match="--x"):
            quantity(text, "m", "--x")

    def test_without_pint_the_remedy_is_named(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setitem(sys.modules, "pint", None)
        assert quantity("3", "m", "--x") == 3.0
        with pytest.raises(ModuleNotFoundError, match=r'pip install "polhode\[units\]"'):
            quantity("3 mm", "m", "--x")


class TestUnits:
    def test_density_and_mass(self, slab: Path) -> None:
        by_density = fields(slab, "--length-unit", "cm", "--density", "2.7 g/cm^3")
        assert by_density["mass"] == pytest.approx(0.0162, rel=1e-14)
        by_mass = fields(slab, "--length-unit", "cm", "--mass", "16.2 g")
        np.testing.assert_allclose(by_mass["principal_moments"], by_density["principal_moments"], rtol=1e-14)

    def test_engineers_units(self, slab: Path) -> None:
        report = fields(slab, "--length-unit", "in", "--density", "0.1 lb/in^3", "--mass-unit", "lb")
        inch = report["in_file_unit"]
        assert inch["mass"] == pytest.approx(0.6, rel=1e-14)
        moments = 0.6 / 12 * np.array([5.0, 10.0, 13.0])
        np.testing.assert_allclose(inch["principal_moments"], moments, rtol=1e-13)
        np.testing.assert_allclose(np.diag(inch["inertia_about_center_of_mass"]), moments[::-1], rtol=1e-13)
        assert report["units"]["in_file_unit"]["principal_moments"] == "lb in^2"
        assert report["units"]["in_file_unit"]["mass"] == "lb"

    def test_weld_with_a_unit(self, slab: Path) -> None:
        report = fields(slab, "--length-unit", "mm", "--weld", "1e-3 um")
        assert any("within 1e-06" in note for note in report["notes"])


class TestAbout:
    def test_a_point(self, slab: Path) -> None:
        body = RigidBody.from_file(slab, density=2000, length_unit="mm")
        want = body.inertia_about([0.01, 0.0, -0.005])
        for about in (("10", "0", "-5"), ("10 0 -5 mm",), ("1 cm, 0 mm, -5 mm",), ("10, 0, -5 mm",)):
            report = fields(slab, "--length-unit", "mm", "--density", "2000", "--about", *about)
            np.testing.assert_allclose(report["inertia_about_point"], want, rtol=1e-14)
            np.testing.assert_allclose(report["point"], [0.01, 0, -0.005], rtol=1e-15)

    def test_of_a_molecule(self, tmp_path: Path) -> None:
        (tmp_path / "a.xyz").write_text("1\nneon\nNe 0 0 0\n")
        for about in (("0 0 2",), ("0 0 0.2 nm",)):
            report = fields(tmp_path / "a.xyz", "--about", *about)
            np.testing.assert_allclose(
                np.diag(report["inertia_about_point"]), np.array([4, 4, 0]) * report["mass"]
            )


class TestOutput:
    def test_files_hold_what_is_printed(self, slab: Path, tmp_path: Path) -> None:
        for name, form in (("a.txt", "table"), ("a.json", "json")):
            assert run("report", slab, "--output", tmp_path / name) == (0, "", "")
            assert (tmp_path / name).read_text() == run("report", slab, "--format", form)[1]
        assert run("report", slab, "--output", tmp_path / "b.json", "--format", "table")[0] == 0
        assert (tmp_path / "b.json").read_text() == run("report", slab)[1]


class TestExpect:
    def test_own_report_agrees(self, slab: Path, tmp_path: Path) -> None:
        options = ("--length-unit", "mm", "--density", "2000", "--about", "1 2 3")
        run("report", slab, *options, "--output", tmp_path / "r.json")
        code, out, _ = run("report", slab, *options, "--expect", tmp_path / "r.json", "--rtol", "0")
        assert code == 0
        assert "fields agree" in out

    def test_a_changed_part(self, slab: Path, tmp_path: Path) -> None:
        run("report", slab, "--output", tmp_path / "r.json")
        longer = write_obj(tmp_path / "longer.obj", *box((1.0, 2.0, 3.003)))
        arguments = ("report", longer, "--expect", tmp_path / "r.json", "--format", "json", "--rtol")
        code, out, err = run(*arguments, 1e-4)
        assert (code, err) == (1, "")
        differing = {row["field"]: row["difference"] for row in json.loads(out)["differences"]}
        assert differing["volume"] == pytest.approx(1e-3, rel=1e-9)
        assert "center_of_mass" in differing  # it stands elsewhere
        assert "faces" not in differing
        run("report", longer, "--output", tmp_path / "r.json")
        assert run("report", longer, "--expect", tmp_path / "r.json")[0] == 0

    @pytest.mark.parametrize(
        "text", ['{"mass": "heavy"}', '{"mass": [6]}', '{"mass": null}', '{"top": "oblate"}']
    )
    def test_values_of_another_kind_differ(self, text: str, slab: Path, tmp_path: Path) -> None:
        (tmp_path / "r.json").write_text(text)
        assert run("report", slab, "--expect", tmp_path / "r.json")[0] == 1

    def test_some_fields_suffice(self, slab: Path, tmp_path: Path) -> None:
        (tmp_path / "r.json").write_text('{"mass": 6, "in_file_unit": {"volume": 6.0000001}}')
        code, out, _ = run(
            "report", slab, "--length-unit", "mm", "--mass", 6, "--expect", tmp_path / "r.json"
        )
        assert code == 0
        assert "2 fields agree" in out


class TestStandardInput:
    @pytest.mark.parametrize("name", WRITERS)
    def test_meshes(self, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
        _, writer, format_name = WRITERS[name]
        data = writer(*box((1.0, 2.0, 3.0)))
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))
        report = fields("-", "--mass", 12)
        assert (report["file"], report["format"]) == ("standard input", format_name)
        np.testing.assert_allclose(report["principal_moments"], [5, 10, 13], rtol=1e-12)

    def test_molecule(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(b"1\nneon\nNe 0 0 0\n")))
        assert fields("-")["isotopes"] == "1 20Ne"

    def test_packed(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(gzip.compress(b"solid"))))
        code, _, err = run("report", "-")
        assert code == 2
        assert "standard input is packed with gzip; unpack it before" in err


def test_the_help_needs_no_numpy() -> None:

    code = "import sys; from polhode.cli import main; main(['--help']); print('numpy' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.splitlines()[-1] == "False"


def test_long_work_draws_a_bar_only_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    for stream, is_long, has_bar in (
        (Terminal(), True, True),
        (Terminal(), False, False),
        (io.StringIO(), True, False),
    ):
        monkeypatch.setattr(sys, "stderr", stream)
        with progress("reading [part]", is_long=is_long) as tell:
            assert (tell is not None) == has_bar
            if tell is not None:
                tell(0.5)
        assert ("reading [part]" in stream.getvalue()) == has_bar
