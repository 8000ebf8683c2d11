"""Files of others, which do not ship with the package: everything agrees with what is known of them.

Where they are not, these five are skipped; what they show is tested elsewhere on generated files too.
"""

from __future__ import annotations

import json
import re
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, robots
from polhode.cli import brick
from polhode.errors import FileFormatError, MeshError

if TYPE_CHECKING:
    from pathlib import Path


def agrees(computed: float, printed: str) -> None:
    """To half a unit of the last digit printed."""
    decimals = len(printed.partition(".")[2])
    off = abs(Fraction(float(computed)) - Fraction(printed))
    assert off <= Fraction(1, 2 * 10**decimals), (computed, printed)


def all_agree(computed: np.ndarray, printed: str) -> None:
    for one, known in zip(computed, printed.split(), strict=True):
        agrees(one, known)


def test_asteroids(shared_data: Path) -> None:
    """Radar and spacecraft shapes of NASA's PDS, moments by trimesh."""
    folder = shared_data / "asteroids"
    for name, volume, moments in (
        ("4179_toutatis_low.obj", "7.69882", "0.37174 1.12008 1.18582"),
        ("apophis_v233s7.obj", "0.0198258", "0.010013 0.0129875 0.0137082"),
    ):
        body = RigidBody.from_file(folder / name, density=1.0)
        agrees(body.mass, volume)
        all_agree(body.principal_moments / body.mass, moments)
    eros = folder / "eros007790.tab"
    with pytest.raises(FileFormatError, match=r"index_base=0"):
        RigidBody.from_file(eros, density=1.0)
    assert "--index-base 0" in run("report", eros)[2]
    body = RigidBody.from_file(eros, density=1.0, index_base=0)
    agrees(body.mass, "2525.99")
    all_agree(body.principal_moments / body.mass, "15.1798 73.3852 74.6251")
    np.testing.assert_allclose(body.center_of_mass, [-0.02163, 0.002368, 0.04748], atol=5e-6)
    path = folder / "4179_toutatis_low.obj"
    asked = ("--length-unit", "km", "--periods", "5.41 d, 7.35 d", "--mode", "long-axis", "--format", "json")
    report = json.loads(run("spin", path, *asked)[1])
    np.testing.assert_allclose(report["angle_from_L"]["e1"], [49.18, 50.10], atol=5e-3)


def test_stl_of_cad_programs(shared_data: Path) -> None:
    """Two parts as SolidWorks weighs them, in pounds and inches; what is left is tessellation."""
    folder = shared_data / "cad"
    known = {
        "angle_block.STL": ("0.0413843", "0.00831524 0.0128252 0.00900698"),
        "idler_riser.STL": ("0.1451257", "0.1208618 0.0911556 0.2053902"),
    }
    for part in json.loads((folder / "mass_properties.json").read_text()):
        path = folder / part["filename"]
        with pytest.raises(MeshError, match=r"corners lie within \de-07 of another, weld="):
            RigidBody.from_file(path, density=part["density"])
        body = RigidBody.from_file(path, density=part["density"], weld=1e-7)
        mass, diagonal = known[part["filename"]]
        agrees(body.mass, mass)
        all_agree(np.diag(body.inertia), diagonal)
        options = ("--length-unit", "in", "--density", f"{part['density']} lb/in^3", "--mass-unit", "lb")
        told = run("report", path, *options, "--weld", "1e-6", "--format", "json")[1]
        report = json.loads(told)["in_file_unit"]
        moments = np.array(report["inertia_about_center_of_mass"])
        assert report["mass"] == pytest.approx(part["mass"], rel=2e-3)
        assert report["area"] == pytest.approx(part["area"], rel=2e-3)
        np.testing.assert_allclose(report["center_of_mass"], part["center_mass"], rtol=2e-3, atol=2e-3)
        np.testing.assert_allclose(moments, part["inertia"], rtol=2e-3, atol=2e-3 * moments.max())
    told = json.loads(run("report", folder / "featuretype.STL", "--weld", 1e-7, "--format", "json")[1])
    assert told["volume"] == pytest.approx(11.62773343, abs=5e-9)
    assert told["principal_moments"][2] == pytest.approx(26.2356, abs=5e-5)
    assert any("288 corners were joined" in note for note in told["notes"])


@pytest.mark.usefixtures("occt_here")
def test_step_of_a_cad_program(shared_data: Path) -> None:
    """SolidWorks wrote it in inches; its STL is coarser by what the tessellation takes off the holes."""
    pytest.importorskip("OCP.BRep", reason="CAD files need polhode[cad]")
    from polhode.io import load, solid_from_file

    path = shared_data / "cad" / "featuretype.STEP"
    assert load(path).unit == "in"
    solid = solid_from_file(path, density=1.0)
    assert solid.volume / 0.0254**3 == pytest.approx(11.62773343, rel=1e-3)
    assert solid.body.error_bound.mass < 1e-9 * solid.body.mass


def test_nasa_s_brick(shared_data: Path) -> None:
    """The constants typed into the demo are those of the files."""
    text = (shared_data / "nesc" / "brick_inertia.dml").read_text()
    for value in (*brick.MOMENTS, brick.MASS):
        assert re.search(rf'initialValue="{value!r}0*"', text), value
    header, *rows = (shared_data / "nesc" / "Atmos_02_sim_01.csv").read_text().splitlines()
    last = dict(zip(header.split(","), rows[-1].split(","), strict=True))
    columns = [f"bodyAngularRateWrtEi_deg_s_{name}" for name in ("Roll", "Pitch", "Yaw")]
    assert float(last["time"]) == brick.DURATION
    assert tuple(float(last[column]) for column in columns) == brick.NASA_RATES


def test_the_tutorial_robot(shared_data: Path, tmp_path: Path) -> None:
    """The robot of ROS's tutorial, whose 16 links all carry 1 1 1."""
    path = shared_data / "urdf" / "07-physics.urdf"
    robot = robots.read_robot(path)
    verdicts = robots.check(robot)
    assert len(verdicts) == 16
    assert {verdict.verdict for verdict in verdicts} == {"placeholder"}
    with_shape = {v.name: v for v in verdicts if v.shape_moments is not None}
    assert len(with_shape) == 12
    assert all("has room for" in verdict.reason for verdict in with_shape.values())
    assert with_shape["left_front_wheel"].factor == pytest.approx(1632.65, abs=0.01)
    assert with_shape["gripper_pole"].factor == pytest.approx(400_000, rel=1e-9)
    assert with_shape["base_link"].factor == pytest.approx(5, rel=1e-12)
    code, out, _ = run("check", path)
    assert code == 1
    rows = [line for line in out.splitlines() if "placeholder" in line and "links fail" not in line]
    assert len(rows) == 16
    assert "400000 times its collision shape's" in next(row for row in rows if "gripper_pole" in row)
    code, out, _ = run("check", path, "--fix", tmp_path / "fixed.urdf", "--format", "json")
    assert code == 1  # four links have meshes that are not there
    report = json.loads(out)
    assert len(report["changed"]) == 12
    assert any("left_tip" in note and "left as they are" in note for note in report["notes"])
    again = json.loads(run("check", tmp_path / "fixed.urdf", "--format", "json")[1])
    assert again["count"]["good"] == 12
    before, after = (p.read_text().splitlines() for p in (path, tmp_path / "fixed.urdf"))
    added = [line for line in after if line.strip().startswith("<origin") and line not in before]
    assert len(added) == len(after) - len(before) == 3
    kept = [line for line in after if line not in added]
    assert sum(old != new for old, new in zip(before, kept, strict=True)) == 12
