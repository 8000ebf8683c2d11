"""``polhode identify``: what it reads, tells of the rows, finds, saves, and how it ends."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, identify, solids

T = np.arange(500) / 100.0
BODY = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
OMEGA: Any = BODY.free_motion((1.0, 3.0, 0.5)).at(T).omega
GYRO = OMEGA + np.random.default_rng(3).normal(0.0, 0.01, OMEGA.shape)


def write(path: Path, names: str, *columns: Any) -> Path:
    rows = np.column_stack(columns)
    lines = [",".join("" if np.isnan(x) else repr(float(x)) for x in row) for row in rows]
    path.write_text("\n".join([names, *lines, ""]), "utf-8")
    return path


def told(*arguments: Any, code: int = 0) -> dict[str, Any]:
    found, out, err = run("identify", *arguments, "--format", "json")
    assert (found, err) == (code, "")
    return dict(json.loads(out))


def shares(moments: Any) -> Any:
    return np.asarray(moments) / np.sum(moments)


@pytest.mark.parametrize(
    ("names", "time", "rate"),
    [
        ("t,wx,wy,wz", 1.0, 1.0),
        ("time [ms],gyro_x [deg/s],gyro_y [deg/s],gyro_z [deg/s]", 1e3, 180.0 / np.pi),
        ("Time (s),gx (rad/s),gy (rad/s),gz (rad/s)", 1.0, 1.0),
    ],
)
def test_a_throw(tmp_path: Path, names: str, time: float, rate: float) -> None:
    log = write(tmp_path / "throw.csv", names, T * time, GYRO * rate)
    found = told(log, "--kind", "tumble")
    time_name, *omega_names = names.split(",")
    assert found["columns"] == {"time": time_name, "omega": " ".join(omega_names)}
    want = identify.from_tumble(T, GYRO)
    assert np.allclose(shares(found["principal_moments"]), shares(want.body.principal_moments), rtol=1e-5)
    assert np.allclose(found["principal_moments"], (0.2, 0.35, 0.45), atol=0.005)


def test_options_name_columns_and_units(tmp_path: Path) -> None:
    log = write(tmp_path / "throw.csv", "a,b,c,d", T, np.rad2deg(GYRO))
    chosen = ("--time", "a", "--omega", "b,c,d", "--rate-unit", "deg/s")
    found = told(log, "--kind", "tumble", *chosen, "--bias")
    assert np.allclose(found["principal_moments"], (0.2, 0.35, 0.45), atol=0.01)
    assert np.abs(found["bias"]).max() < 0.02


def test_what_is_amiss_with_rows_is_told(tmp_path: Path) -> None:
    gyro = GYRO.copy()
    gyro[[5, 9], 1] = np.nan
    keep = (np.arange(500) < 200) | (np.arange(500) >= 230)
    log = write(tmp_path / "throw.csv", "t,gx,gy,gz", T[keep], gyro[keep])
    notes = " ".join(told(log, "--kind", "tumble")["notes"])
    assert "2 of 470 rows have a number that is missing" in notes
    assert "jumps of the clock: 1" in notes
    assert "saturated" not in notes
    clipped = np.clip(GYRO, -2.9, 2.9)
    log = write(tmp_path / "throw.csv", "t,gx,gy,gz", T, clipped)
    code, _, err = run("identify", log, "--kind", "tumble")
    assert code in (1, 2)
    assert "satur" in err or code == 1


def test_a_wrist(tmp_path: Path) -> None:
    box = solids.box((0.1, 0.2, 0.3), mass=2.0).translated((0.0, 0.02, 0.1))
    t, rng = np.linspace(0.0, 8.0, 400), np.random.default_rng(1)
    rates = np.array([2.0, 2.7, 3.4])
    omega, turn = np.sin(np.outer(t, rates)), rates * np.cos(np.outer(t, rates))
    up = 9.81 * np.stack([np.sin(t), np.cos(t) * np.sin(2 * t), np.cos(t) * np.cos(2 * t)], axis=1)
    mc, about = box.mass * box.center_of_mass, box.inertia_about("origin")
    force = box.mass * up + np.cross(turn, mc) + np.cross(omega, np.cross(omega, mc))
    torque = np.cross(mc, up) + turn @ about + np.cross(omega, omega @ about)
    force, torque = force + rng.normal(0, 0.1, (400, 3)), torque + rng.normal(0, 0.01, (400, 3))
    log = write(tmp_path / "wrist.csv", "t,wx,wy,wz,fx,fy,fz,tx,ty,tz,ax,ay,az", t, omega, force, torque, up)
    found = told(log, "--kind", "wrench", "--save", tmp_path / "body.json")
    assert found["mass"] == pytest.approx(2.0, abs=0.01)
    assert np.allclose(found["center_of_mass"], (0.0, 0.02, 0.1), atol=0.002)
    saved = RigidBody.from_file(tmp_path / "body.json")
    assert saved.mass == pytest.approx(found["mass"])
    assert saved.covariance is not None
    still = write(
        tmp_path / "still.csv", "t,wx,wy,wz,fx,fy,fz,tx,ty,tz,ax,ay,az", t, 0 * omega, force, torque, up
    )
    found = told(still, "--kind", "wrench", code=1)
    assert found["verdict"] == "no body: undetermined"
    assert {"the moment about x"} <= {one["words"] for one in found["observability"]}


def test_a_linear_acceleration_is_not_guessed(tmp_path: Path) -> None:
    """A phone takes gravity away from it, and an inertial sensor of a robot does not."""
    names = "t,wx,wy,wz,fx,fy,fz,tx,ty,tz,linear_acceleration_x,linear_acceleration_y,linear_acceleration_z"
    log = write(tmp_path / "wrist.csv", names, T, *(np.ones((len(T), 3)) for _ in range(4)))
    code, _, err = run("identify", log, "--kind", "wrench")
    assert code == 2
    assert "no columns are called as those for --specific-force" in err


SWINGS = """device,axis,period,known
torsional,z,2.0 ± 0.001,0.05
torsional,x,2.3 ± 0.001,
torsional,y,3.1 ± 0.001,
torsional,z,3.5 ± 0.001,
torsional,1 1 0,2.73 ± 0.001,
torsional,1 0 1,2.96 ± 0.001,
torsional,0 1 1,3.31 ± 0.001,
"""


def test_swings(tmp_path: Path) -> None:
    """The example of `from_pendulum`, from a table."""
    table = tmp_path / "swings.csv"
    table.write_text(SWINGS, "utf-8")
    found = told(table, "--kind", "pendulum", "--gravity", "9.81", "--mass", "2 kg")
    assert np.allclose(found["principal_moments"], (0.0661, 0.1201, 0.1531), atol=5e-5)
    table.write_text("\n".join(SWINGS.splitlines()[:4]), "utf-8")
    found = told(table, "--kind", "pendulum", "--gravity", "9.81", "--mass", "2 kg", code=1)
    assert found["verdict"] == "no body: undetermined"


def test_a_log_of_no_tumble_ends_with_1(tmp_path: Path) -> None:
    log = write(tmp_path / "throw.csv", "t,gx,gy,gz", T, GYRO + np.outer(np.sin(3 * T), (1, 2, 3)))
    found = told(log, "--kind", "tumble", "--omega-sigma", "0.01", code=1)
    assert found["verdict"] == "no body: no fit"


@pytest.mark.parametrize("name", ["fit.png", "fit.svg", "fit.pdf"])
def test_pictures(tmp_path: Path, name: str) -> None:
    pytest.importorskip("matplotlib")
    log = write(tmp_path / "throw.csv", "t,gx,gy,gz", T, GYRO)
    told(log, "--kind", "tumble", "--bias", "--save", tmp_path / name)
    assert (tmp_path / name).stat().st_size > 5000


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "--kind: state what was measured"),
        (("--kind", "tumble", "--gravity", "9.81"), "--gravity: it is not for --kind tumble"),
        (("--kind", "tumble", "--save", "a.csv"), "--save: 'a.csv' has a suffix"),
        (("--kind", "tumble", "--omega", "gx,gy"), "--omega: expected 3 columns, got 2"),
        (("--kind", "tumble", "--omega", "a,b,c"), "has no column 'a'"),
        (("--kind", "wrench"), "no columns are called as those for --force"),
        (("--kind", "pendulum"), "--gravity: pendulums need it"),
        (("--kind", "pendulum", "--gravity", "9.81"), "is no column of pendulums"),
    ],
)
def test_bad_input(tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    log = write(tmp_path / "throw.csv", "t,gx,gy,gz", T, GYRO)
    code, _, err = run("identify", log, *arguments)
    assert code == 2
    assert words in err


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("swing,x,2.0,", "device is 'swing'; it is one of compound"),
        ("compound,x,2.0,0.05", "a compound pendulum has no known"),
        ("compound,x,2.0,", "a compound pendulum needs about"),
        ("torsional,x,two,", "row 1: period"),
    ],
)
def test_bad_rows_of_a_table(tmp_path: Path, row: str, words: str) -> None:
    (tmp_path / "swings.csv").write_text(f"device,axis,period,known\n{row}\n", "utf-8")
    code, _, err = run("identify", tmp_path / "swings.csv", "--kind", "pendulum", "--gravity", "9.81")
    assert code == 2
    assert words in err


def test_other_bad_files(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("1,2,3,4\n2,3,4,5\n")
    assert "its columns have no names" in run("identify", tmp_path / "a.csv", "--kind", "tumble")[2]
    (tmp_path / "a.csv").write_text("t,gx,gy,gz\n")
    assert "it holds no rows" in run("identify", tmp_path / "a.csv", "--kind", "tumble")[2]
    log = write(tmp_path / "a.csv", "t,gx [furlong],gy [furlong],gz [furlong]", T, GYRO)
    assert "--rate-unit: the name" in run("identify", log, "--kind", "tumble")[2]
    log = write(tmp_path / "a.csv", "t,gx,gy,gz", T[::-1], GYRO)
    code, _, err = run("identify", log, "--kind", "tumble")
    assert code == 2
    assert "ascend" in err
