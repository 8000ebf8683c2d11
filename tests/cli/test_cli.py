"""The command line: what ``polhode report`` prints, and how every command ends."""

from __future__ import annotations

import json
import os
import re
import struct
import subprocess
import sys
from fractions import Fraction
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
import polhode
import pytest
from command_line import one_line, run, write_obj
from mesh_files import obj
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import box, cube
from polhode import RigidBody, samples
from polhode.cli import main
from polhode.cli.options import LengthUnit
from polhode.io import read_mesh
from polhode.units import METRES

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    """A 1 x 2 x 3 box that stands with one corner at the origin."""
    vertices, faces = box((1.0, 2.0, 3.0))
    return write_obj(tmp_path / "slab.obj", vertices + np.array([0.5, 1.0, 1.5]), faces)


# report ----------------------------------------------------------------------------------------------


def test_report_of_a_mesh_in_si_units(slab: Path) -> None:
    code, out, err = run("report", slab, "--length-unit", "mm", "--density", 2000, "--format", "json")
    assert (code, err) == (0, "")
    report = json.loads(out)
    mass = 2000 * 6e-9
    moments = np.array([1 + 4, 1 + 9, 4 + 9]) * 1e-6 * mass / 12
    assert report["file"] == str(slab)
    assert report["format"] == "v/f text"
    assert report["length_unit"] == "mm"
    assert (report["vertices"], report["faces"]) == (8, 12)
    assert report["volume"] == pytest.approx(6e-9, rel=1e-14)
    assert report["area"] == pytest.approx(22e-6, rel=1e-14)
    assert report["density"] == 2000
    assert report["mass"] == pytest.approx(mass, rel=1e-14)
    assert report["center_of_mass"] == pytest.approx([0.5e-3, 1e-3, 1.5e-3], rel=1e-14)
    np.testing.assert_allclose(report["principal_moments"], moments, rtol=1e-14)
    np.testing.assert_allclose(np.diag(report["inertia_about_center_of_mass"]), moments[::-1], rtol=1e-14)
    c = np.array([0.5e-3, 1e-3, 1.5e-3])
    about_origin = np.diag(moments[::-1]) + mass * (c @ c * np.eye(3) - np.outer(c, c))
    np.testing.assert_allclose(report["inertia_about_origin"], about_origin, rtol=1e-13)
    np.testing.assert_allclose(report["moments_per_mass"], moments / mass, rtol=1e-14)
    np.testing.assert_allclose(report["radii_of_gyration"], np.sqrt(moments / mass), rtol=1e-14)
    np.testing.assert_allclose(report["gaps"], [5 / 13, 3 / 13], rtol=1e-13)
    np.testing.assert_allclose(np.abs(report["axes"]), np.eye(3)[::-1], atol=1e-15)
    assert report["top"] == "asymmetric"
    assert report["in_file_unit"]["volume"] == pytest.approx(6.0, rel=1e-14)
    np.testing.assert_allclose(report["in_file_unit"]["moments_per_mass"], moments / mass * 1e6, rtol=1e-14)
    assert report["units"]["inertia_about_origin"] == "kg m^2"
    assert report["units"]["in_file_unit"]["volume"] == "mm^3"
    assert report["notes"] == ["--density 2000 has no unit: kg/m^3 was taken"]


def test_report_is_what_from_file_gives(slab: Path) -> None:
    for given, keywords in (
        (("--density", "7.5"), {"density": 7.5}),
        (("--mass", "7.5"), {"mass": 7.5}),
        (("--mass", "7.5", "--length-unit", "ft"), {"mass": 7.5, "length_unit": "ft"}),
    ):
        report = json.loads(run("report", slab, "--format", "json", *given)[1])
        body = RigidBody.from_file(slab, **keywords)
        assert report["mass"] == body.mass
        assert report["inertia_about_center_of_mass"] == body.inertia.tolist()
        assert report["axes"] == body.principal.axes.tolist()
        assert report["density"] * report["volume"] == pytest.approx(body.mass, rel=1e-15)


def test_unit_and_density_that_were_not_given_are_said(slab: Path) -> None:
    code, out, _ = run("report", slab)
    assert code == 0
    assert re.search(r"length unit +unit unknown", out)
    assert "density 1 was used" in out
    report = json.loads(run("report", slab, "--format", "json")[1])
    assert report["length_unit"] == "unit unknown"
    assert report["density"] == 1
    assert report["mass"] == pytest.approx(6.0, rel=1e-15)
    assert "kg" not in json.dumps(report["units"])
    assert "in_file_unit" not in report


def test_table_and_json_hold_the_same_fields(slab: Path, eight_molecules: Path) -> None:
    for arguments in (
        (slab, "--length-unit", "mm"),
        (eight_molecules / "co2.xyz",),
    ):
        words = set(run("report", *arguments)[1].split())
        report = json.loads(run("report", *arguments, "--format", "json")[1])
        for value in _numbers({key: value for key, value in report.items() if key != "units"}):
            shown = float(value) if abs(float(value)) > 1e-16 else 0.0  # less is rounding here
            texts = {format(shown, style) for style in (".7g", ".3f", ".6f", ".9f")}
            assert texts & words or (value == "Infinity" and "infinite" in words), (value, texts)


def _numbers(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return [x for item in value.values() for x in _numbers(item)]
    if isinstance(value, list):
        return [x for item in value for x in _numbers(item)]
    return [value] if isinstance(value, int | float) or value == "Infinity" else []


def test_an_asteroid() -> None:
    """Against rational sums over the triangles that the file holds."""
    path = samples.path("asteroid.obj")
    mesh = read_mesh(path)
    exact = polyhedron(mesh.vertices, mesh.faces)
    moments = np.linalg.eigvalsh(np.array([[float(x / exact.volume) for x in row] for row in exact.inertia]))
    for options in ((), ("--length-unit", "m", "--density", "1900")):
        report = json.loads(run("report", path, *options, "--format", "json")[1])
        assert report["volume"] == pytest.approx(float(exact.volume), rel=1e-14)
        np.testing.assert_allclose(report["moments_per_mass"], moments, rtol=1e-13)


def test_indices_from_zero_are_refused_with_the_remedy_and_right_with_it(tmp_path: Path) -> None:
    mesh = read_mesh(samples.path("asteroid.obj"))
    path = tmp_path / "rock.tab"
    path.write_bytes(obj(mesh.vertices, mesh.faces, 0))
    code, out, err = run("report", path)
    assert (code, out) == (2, "")
    assert one_line(err)
    assert "--index-base 0" in err
    report = json.loads(run("report", path, "--index-base", 0, "--format", "json")[1])
    want = json.loads(run("report", samples.path("asteroid.obj"), "--format", "json")[1])
    for key in ("volume", "moments_per_mass", "center_of_mass"):
        assert report[key] == want[key]


@pytest.mark.parametrize(
    ("name", "constants", "kappa"),
    [
        ("h2o", ("27.374531", "14.586502", "9.515940"), -0.43214),
        ("nh3", ("9.966451", "9.966451", "6.340830"), None),
        ("h2co", ("9.406977", "1.295030", "1.138321"), -0.96210),
        ("ch4", ("5.240925", "5.240925", "5.240925"), None),
        ("sf6", ("0.091036", "0.091036", "0.091036"), None),
        ("c6h6_re", ("0.191204", "0.191204", "0.095602"), None),
        ("c6h6_r0", ("0.189692", "0.189692", "0.094846"), None),
        ("co2", ("infinite", "0.391623", "0.391623"), None),
    ],
)
def test_molecules(name: str, constants: tuple[str, ...], kappa: float | None, eight_molecules: Path) -> None:
    path = eight_molecules / f"{name}.xyz"
    code, out, err = run("report", path)
    assert (code, err) == (0, "")
    (line,) = (line for line in out.splitlines() if line.endswith("cm^-1"))
    printed = line.split()[:3]
    for shown, known in zip(printed, constants, strict=True):
        if known == "infinite":
            assert shown == "infinite"
        else:
            assert abs(Fraction(shown) - Fraction(known)) <= Fraction(1, 10**6)
    report = json.loads(run("report", path, "--format", "json")[1])
    assert ("ray_kappa" in report) == (kappa is not None)
    if kappa is not None:
        assert report["ray_kappa"] == pytest.approx(kappa, abs=6e-6)
    assert (report["rotational_constants_MHz"][0] == "Infinity") == (name == "co2")


def test_molecule_with_another_length_unit(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_text("2\nhydrogen\nH 0 0 0\nH 0 0 0.74\n")
    (tmp_path / "b.xyz").write_text("2\nhydrogen\nH 0 0 0\nH 0 0 0.074\n")
    angstrom = json.loads(run("report", tmp_path / "a.xyz", "--format", "json")[1])
    nanometre = json.loads(run("report", tmp_path / "b.xyz", "--length-unit", "nm", "--format", "json")[1])
    np.testing.assert_allclose(nanometre["principal_moments"], angstrom["principal_moments"], rtol=1e-14)
    assert angstrom["isotope_masses"] == {"1H": pytest.approx(1.00782503, abs=1e-8)}


def test_length_units_are_those_of_the_library() -> None:
    assert get_args(LengthUnit) == tuple(METRES)


def test_control_characters_in_a_file_do_not_reach_the_terminal(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_text("1\nneon \x1b[31m\x07\nNe 0 0 0\n")
    code, out, _ = run("report", tmp_path / "a.xyz")
    assert code == 0
    assert "\x1b[31m" not in out
    assert "\\x1b[31m" in out


# errors ----------------------------------------------------------------------------------------------

BAD_STL = bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(50)


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("absent.stl", None, r"absent\.stl"),
        ("empty.stl", b"", "empty"),
        ("empty.xyz", b"", "empty"),
        ("cut.stl", bytes(80) + struct.pack("<I", 2) + bytes(70), r"cut\.stl"),
        ("text.stl", b"dear reader\n", "text"),
        ("huge.stl", BAD_STL, "4000000000"),
        ("open.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not closed"),
        ("zero.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "--index-base 0"),
        ("part.blend", b"BLENDER", "not read"),
        ("odd.xyz", b"1\na\nXx 0 0 0\n", "'Xx' is not an element"),
    ],
)
@pytest.mark.parametrize("command", [("report",), ("spin", "--omega", "0", "0", "1", "--end", "1")])
def test_bad_file_is_one_line_and_exit_2(
    command: tuple[str, ...], name: str, data: bytes | None, message: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    if data is not None:
        path.write_bytes(data)
    code, out, err = run(*command, path)
    assert (code, out) == (2, "")
    assert one_line(err)
    assert str(path) in err
    assert re.search(message, err)


def test_a_directory(tmp_path: Path) -> None:
    code, out, err = run("report", tmp_path)
    assert (code, out) == (2, "")
    assert one_line(err)
    assert "is a directory" in err


def test_inverted_mesh_is_refused_or_turned(tmp_path: Path) -> None:
    vertices, faces = cube(2.0)
    path = write_obj(tmp_path / "inverted.obj", vertices, faces[:, ::-1])
    code, _, err = run("report", path)
    assert code == 2
    assert "inverted" in err
    for option in (("--mass", "4"), ("--density", "0.5")):
        report = json.loads(run("report", path, "--orient", *option, "--format", "json")[1])
        assert report["volume"] == pytest.approx(8.0, rel=1e-15)
        assert report["mass"] == pytest.approx(4.0, rel=1e-15)


def test_rounding_prints_as_zero_and_stays_in_json(tmp_path: Path) -> None:
    vertices, faces = box((0.1, 0.2, 0.3))
    path = write_obj(tmp_path / "box.obj", vertices * (1 + 1e-16) + np.array([1e-18, 0.0, 0.0]), faces)
    out = run("report", path)[1]
    (line,) = (line for line in out.splitlines() if "centre of mass" in line)
    assert line.split()[3:6] == ["0", "0", "0"]


@pytest.mark.parametrize(
    "option", [("--mass", 1), ("--density", 1), ("--weld", 1), ("--orient",), ("--index-base", 0)]
)
def test_option_that_a_molecule_does_not_take(option: tuple[Any, ...], tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_text("1\nneon\nNe 0 0 0\n")
    code, _, err = run("report", tmp_path / "a.xyz", *option)
    assert code == 2
    assert one_line(err)
    assert option[0] in err


def test_welding_is_said(tmp_path: Path) -> None:
    """Corners that triangles hold in numbers of their own, as in CAD programs, off in the last digits."""
    mesh = read_mesh(samples.path("torus.obj"))
    corners = mesh.vertices[mesh.faces].reshape(-1, 3)
    corners[::7] += 1e-8 * np.sign(corners[::7])
    path = write_obj(tmp_path / "ring.obj", corners, np.arange(len(corners)).reshape(-1, 3))
    code, _, err = run("report", path)
    assert code == 2
    assert "--weld" in err
    report = json.loads(run("report", path, "--weld", 1e-7, "--format", "json")[1])
    whole = json.loads(run("report", samples.path("torus.obj"), "--format", "json")[1])
    assert report["volume"] == pytest.approx(whole["volume"], rel=1e-9)
    assert report["principal_moments"] == pytest.approx(whole["principal_moments"], rel=1e-9)
    said = f"{len(corners) - len(mesh.vertices)} corners were joined"
    assert any(said in note for note in report["notes"])
    out = run("spin", path, "--weld", 1e-7, "--omega", 0, 0, 1, "--end", 1)[1]
    assert said in out


def test_help_and_version() -> None:
    for arguments in (("--help",), (), ("report", "--help"), ("spin", "--help"), ("demo", "--help")):
        code, out, err = run(*arguments)
        assert (code, err) == (0, "")
        assert "Usage: polhode" in out
    assert re.fullmatch(r"polhode \d+\.\d+\.\d+\S*\n", run("--version")[1])


def test_without_the_extra_one_line_says_how_to_install_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for library in ("cyclopts", "rich"):
        with monkeypatch.context() as patch:
            for name in [name for name in sys.modules if name.partition(".")[0] == library]:
                patch.delitem(sys.modules, name)
            for name in [name for name in sys.modules if name.startswith("polhode.cli.")]:
                patch.delitem(sys.modules, name)
            patch.setitem(sys.modules, library, None)
            assert main(["report", "x.stl"]) == 2
            out, err = capsys.readouterr()
            assert out == ""
            assert err == 'polhode: the command line needs its extra: pip install "polhode[cli]"\n'
            assert main(["--version"]) == 0
            assert capsys.readouterr() == (f"polhode {polhode.__version__}\n", "")


def test_interruption_isone_line(slab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("polhode.cli.report.file_report", interrupt)
    assert run("report", slab) == (130, "", "polhode: interrupted\n")


def test_names_beyond_the_encoding_of_the_terminal(slab: Path, tmp_path: Path) -> None:
    path = slab.rename(tmp_path / "Körper.obj")
    command = [sys.executable, "-m", "polhode", "report", str(path)]
    result = subprocess.run(
        command, capture_output=True, check=True, timeout=60, env=os.environ | {"PYTHONIOENCODING": "ascii"}
    )
    assert b"K\\xf6rper.obj" in result.stdout


def test_a_reader_that_leaves_is_no_error(slab: Path) -> None:
    program = f"{sys.executable} -m polhode report {slab} --format json | head -c 1"
    result = subprocess.run(program, shell=True, capture_output=True, check=True, timeout=60)
    assert result.stdout == b"{"
    assert result.stderr == b""
