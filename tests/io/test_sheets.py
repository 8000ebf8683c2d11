"""A mesh with a thickness is the middle of a sheet: in Python, in assemblies and on the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run, write_obj
from oracles.meshes import box
from polhode import RigidBody, assembly, solids
from polhode.errors import MeshError, PolhodeError


@pytest.fixture
def sheet(tmp_path: Path) -> Path:
    corners = np.array([(0, 0, 0), (200, 0, 0), (200, 100, 0), (0, 100, 0)], dtype=float)
    return write_obj(tmp_path / "sheet.obj", corners, np.array([(0, 1, 2), (0, 2, 3)]))


PLATE = solids.box((0.2, 0.1, 0.002), density=2700.0).translated((0.1, 0.05, 0.0))


def test_an_open_mesh_is_a_plate(sheet: Path) -> None:
    body = RigidBody.from_file(sheet, length_unit="mm", density=2700.0, thickness=0.002)
    assert body.isclose(PLATE, rtol=1e-13)
    by_mass = RigidBody.from_file(sheet, length_unit="mm", mass=float(PLATE.mass), thickness=0.002)
    assert by_mass.isclose(PLATE, rtol=1e-13)
    assert body.provenance.source == "surface"


def test_a_closed_mesh_is_a_box_without_its_inside(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "box.obj", *box((3.0, 2.0, 1.0)))
    body = RigidBody.from_file(path, density=2.0, thickness=0.25)
    exact = solids.box((3.25, 2.25, 1.25), density=2.0) - solids.box((2.75, 1.75, 0.75), density=2.0)
    assert body.isclose(exact, rtol=1e-13)
    with pytest.raises(MeshError, match="thickness"):
        RigidBody.from_file(path, density=2.0, thickness=3.0)


def test_the_same_in_an_assembly_and_on_the_command_line(sheet: Path) -> None:
    part = {
        "name": "plate",
        "file": "sheet.obj",
        "length_unit": "mm",
        "density": "2.7 g/cm^3",
        "thickness": "2 mm",
    }
    made = assembly.read({"name": "a", "part": [part]}, folder=sheet.parent)
    assert made.body.isclose(PLATE, rtol=1e-13)
    bare = assembly.read({"name": "a", "part": [part | {"thickness": 2}]}, folder=sheet.parent)
    assert bare.body.isclose(PLATE, rtol=1e-13)
    for thickness in ("2mm", "2", "0.002 m"):
        code, out, err = run(
            "report",
            sheet,
            "--length-unit",
            "mm",
            "--density",
            "2.7 g/cm^3",
            "--thickness",
            thickness,
            "--format",
            "json",
        )
        assert code == 0, err
        told = json.loads(out)
        assert told["mass"] == pytest.approx(float(PLATE.mass), rel=1e-12)
        assert any("middle of a sheet" in note for note in told["notes"])


def test_refused(sheet: Path, tmp_path: Path) -> None:
    asked: dict[str, Any] = {"closure": "caps", "union": True, "repair": True, "orient": True}
    for name, value in asked.items():
        with pytest.raises(PolhodeError, match=f"{name}: thickness.* makes a sheet"):
            RigidBody.from_file(sheet, density=1.0, thickness=0.1, **{name: value})
    with pytest.raises(PolhodeError, match="thickness must be positive and finite"):
        RigidBody.from_file(sheet, density=1.0, thickness=0.0)
    (tmp_path / "water.xyz").write_text("1\nO\nO 0 0 0\n")
    with pytest.raises(PolhodeError, match=r"thickness: .* is a molecule, not a mesh"):
        RigidBody.from_file(tmp_path / "water.xyz", thickness=0.1)
    code, _, err = run("report", sheet, "--thickness", "2mm", "--density", "1")
    assert code == 2
    assert "state --length-unit" in err
