"""``polhode audit``: columns by their names, verdicts, pictures, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from polhode import RigidBody, loads, samples, solids

T = np.arange(401) / 20.0
MOTION: Any = RigidBody.from_principal(1.0, (2.0, 3.0, 4.0)).free_motion((0.1, 1.5, 0.05)).at(T)
BODY = ("--moments", "2 3 4")


def table(path: Path, names: str, *columns: Any, mark: str = ",") -> Path:
    rows = np.column_stack([np.asarray(one).reshape(len(T), -1) for one in columns])
    lines = [mark.join(repr(float(x)) for x in row) for row in rows]
    path.write_text("\n".join([*([names] if names else []), *lines, ""]), "utf-8")
    return path


def told(*arguments: Any) -> tuple[int, dict[str, Any]]:
    code, out, err = run("audit", *arguments, "--format", "json")
    assert err == ""
    return code, json.loads(out)


@pytest.mark.parametrize(
    ("names", "mark"),
    [
        ("t,qx,qy,qz,qw,wx,wy,wz", ","),
        ("Time [s];quat_x;quat_y;quat_z;quat_w;gyro_x;gyro_y;gyro_z", ";"),
        ("time\torientation.x\torientation.y\torientation.z\torientation.w\tomega_x\tomega_y\tomega_z", "\t"),
        ("t quaternion_x quaternion_y quaternion_z quaternion_w w_x w_y w_z", " "),
        ("", ","),
    ],
)
def test_usual_names(names: str, mark: str, tmp_path: Path) -> None:
    code, found = told(
        table(tmp_path / "run.csv", names, T, MOTION.quaternion, MOTION.omega, mark=mark), *BODY
    )
    assert (code, found.get("findings", [])) == (0, [])
    assert found["angular_momentum_drift"] < 1e-9
    assert set(found["columns"]) == {"t", "attitude", "omega"}


def test_names_that_are_told(tmp_path: Path) -> None:
    run_csv = table(tmp_path / "run.csv", "a,b,c,d,e,f,g,h", T, MOTION.quaternion, MOTION.omega)
    chosen = ("--time", "a", "--attitude", "b,c,d,e", "--omega", "f", "g", "h")
    assert told(run_csv, *BODY, *chosen)[0] == 0
    matrices = MOTION.rotation.as_matrix().reshape(-1, 9)
    named = ",".join(f"r{k}" for k in range(9))
    by_matrix = table(tmp_path / "matrix.csv", f"t,{named}", T, matrices)
    code, found = told(by_matrix, *BODY, "--attitude", named)
    assert code == 0
    assert any("computed from the attitudes" in note for note in found["notes"])
    angles = table(tmp_path / "angles.csv", "t,yaw,pitch,roll", T, MOTION.rotation.as_euler("ZYX"))
    assert told(angles, *BODY, "--attitude", "yaw,pitch,roll", "--sequence", "ZYX")[0] == 0


def test_a_finding_ends_with_1(tmp_path: Path) -> None:
    run_csv = table(
        tmp_path / "run.csv", "t,qx,qy,qz,qw,wx,wy,wz", T, MOTION.quaternion, np.rad2deg(MOTION.omega)
    )
    code, found = told(run_csv, *BODY)
    assert (code, [one["kind"] for one in found["findings"]]) == (1, ["degrees"])
    assert "multiply it by pi/180" in found["findings"][0]["words"]
    code, out, _ = run("audit", run_csv, *BODY)
    assert code == 1
    assert "degrees" in out
    assert "no motion of this body" in out


def test_bodies(tmp_path: Path) -> None:
    """From a file, with its axes; from a tensor; and one that it is not."""
    brick = solids.box((1.0, 2.0, 3.0), mass=2.0).rotated((0.1, 0.7, 0.1, 0.7))
    brick.save(tmp_path / "brick.json")
    exact: Any = brick.free_motion((0.3, 1.0, 0.2)).at(T)
    run_csv = table(tmp_path / "run.csv", "t,qx,qy,qz,qw,wx,wy,wz", T, exact.quaternion, exact.omega)
    assert told(run_csv, "--body", tmp_path / "brick.json")[0] == 0
    tensor = " ".join(repr(float(x)) for x in np.asarray(brick.inertia).ravel())
    assert told(run_csv, "--mass", "2", "--inertia", tensor, "--products", "negative")[0] == 0
    code, found = told(run_csv, *BODY)
    assert code == 1
    assert any("no mistake that is known" in note for note in found["notes"])


def test_declared_loads(tmp_path: Path) -> None:
    """The weight of a top, and a wheel: each explains the record, and without it nothing agrees."""
    top = RigidBody(2.0, np.diag([0.5, 0.5, 0.2]), center_of_mass=(0.0, 0.0, 0.3))
    moments = ("--moments", "0.5 0.5 0.2")
    start = ((0.1, 0.0, 30.0), (0.2, 0.0, 0.0, 0.96**0.5))
    weight = loads.uniform_gravity((0.0, 0.0, -9.81))
    wheel = loads.rotor((0.0, 0.6, 0.0))
    cases: Any = (
        (weight, "origin", ("--gravity", "9.81", "--mass", "2", "--center-of-mass", "0 0 0.3")),
        (wheel, "center_of_mass", ("--wheel", "y, 0.6")),
    )
    for load, about, options in cases:
        run = top.simulate(T / 10.0, *start, load=load, about=about)
        run_csv = table(tmp_path / "run.csv", "t,qx,qy,qz,qw,wx,wy,wz", run.t, run.quaternion, run.omega)
        code, found = told(run_csv, *moments, *options)
        assert (code, found.get("findings", [])) == (0, [])
        assert found["angle_from_exact"] < 1e-6
        assert told(run_csv, *moments)[0] == 1


def test_pictures_gaps_and_two_records(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    code, found = told(samples.path("tumble.csv"), *BODY, "--save", tmp_path / "drifts.png")
    assert code == 0
    assert (tmp_path / "drifts.png").stat().st_size > 5000
    text = samples.path("tumble.csv").read_text().splitlines()
    text[3] = text[3].split(",")[0] + ",,,,,,,"
    (tmp_path / "gaps.csv").write_text("# made by hand\n" + "\n".join(text))
    code, gaps = told(tmp_path / "gaps.csv", *BODY)
    assert (code, gaps["rows"]) == (0, found["rows"])
    every_second = "\n".join(samples.path("tumble.csv").read_text().splitlines()[:1] + text[1::2])
    (tmp_path / "coarse.csv").write_text(every_second)
    code, both = told(tmp_path / "coarse.csv", *BODY, "--finer", samples.path("tumble.csv"))
    assert code == 0
    assert "order" in both


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        ("", (), "it holds no rows"),
        ("t,qx,qy,qz,qw\n", (), "it holds no rows below the names of its columns"),
        ("t,a,b\n1,2,3\n", (), "no columns are called as those for --attitude mostly are"),
        ("t,a,b\n1,2,3\n", ("--attitude", "a,c"), "--attitude: run.csv has no column 'c'; it has t, a, b"),
        ("t,a,b\n1,2,3\n", ("--attitude", "a,b"), "--attitude: expected 4 columns"),
        ("t,a,b,c\n1,2,3,4\n", ("--attitude", "a,b,c"), "give their order with --sequence"),
        ("t,qx,qy,qz,qw\n0,0,0,0,1\n", ("--sequence", "ZYX"), "--sequence: it is for three Euler angles"),
        ("t,qx,qy,qz,qw\n0,0,0,x,1\n", (), "run.csv: line 2: qz 'x' is no number"),
        ("t,qx,qy,qz,qw\n0,0,0\n", (), "run.csv: line 2: qz is missing"),
        ("1,2,3\n", (), "3 columns without names"),
        ("t,qx,qy,qz,qw\n0,0,0,0,1\n0,0,0,0,1\n", (), "row 1 is 0.0 after 0.0, and times must ascend"),
        ("t,qx,qy,qz,qw\n0,0,0,0,2\n", (), "row 0 is no rotation"),
        ("t,qx,qy,qz,qw\n0,0,0,0,1\n", ("--gravity", "9.81"), "--gravity: the weight acts at the centre"),
        ("t,qx,qy,qz,qw\n0,0,0,0,1\n", ("--wheel", "y"), "--wheel: 'y' is not an axis"),
        ("t,qx,qy,qz,qw\n0,0,0,0,1\n", ("--ratio", "2"), "--ratio: it compares the steps of two records"),
        (
            "t,qx,qy,qz,qw\n0,0,0,0,1\n",
            ("--save", "a.txt"),
            "--save: 'a.txt' has a suffix that is not written",
        ),
        (
            "t,qx,qy,qz,qw\n0,0,0,0,1\n",
            ("--body", "b.json"),
            "--moments and --body: both say what the body is",
        ),
        ("t,qx,qy,qz,qw,wx,wy,wz\n0,0,0,0,1,0,0,1\n", (), "needs at least 16 rows without NaN, got 1"),
    ],
)
def test_what_is_refused(
    text: str, options: tuple[str, ...], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("run.csv").write_text(text)
    code, _, err = run("audit", "run.csv", *BODY, *options)
    assert code == 2
    assert one_line(err)
    assert words in err


def test_no_body(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("run.csv").write_text("t,qx,qy,qz,qw\n0,0,0,0,1\n")
    code, _, err = run("audit", "run.csv")
    assert code == 2
    assert "audit: say which body it is: --body FILE, or principal moments" in err
