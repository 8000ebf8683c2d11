"""``polhode check``: what it prints, writes and returns."""

from __future__ import annotations

import io
import json
import re
import sys
from typing import TYPE_CHECKING

import numpy as np
from command_line import run, write_obj
from oracles.meshes import cube
from robot_texts import ONE_BALL

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_good_robot(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ONE_BALL.format(0.02))
    code, out, err = run("check", tmp_path / "r.urdf", "--format", "json")
    assert (code, err) == (0, "")
    report = json.loads(out)
    assert report["verdict"] == "good"
    frame, ball = report["links"]
    assert (frame["verdict"], frame["moments"]) == ("none", None)
    assert (ball["link"], ball["line"], ball["verdict"], ball["mass"]) == ("ball", 3, "good", 5.0)
    np.testing.assert_allclose(ball["shape_moments"], 0.02, rtol=1e-14)
    assert report["units"]["links"]["moments"] == "kg m^2"


def test_suspect_fails_only_when_strict(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ONE_BALL.format(0.001))
    code, out, _ = run("check", tmp_path / "r.urdf")
    assert code == 0
    assert "0.05 times its collision shape's" in out
    assert run("check", tmp_path / "r.urdf", "--strict")[0] == 1
    assert run("check", tmp_path / "r.urdf", "--strict", "--fix", tmp_path / "better.urdf")[0] == 0
    assert (tmp_path / "better.urdf").read_text() == ONE_BALL.format(0.02)  # the other numbers stay


def test_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    for moment, want in ((0.02, 0), (1, 1)):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(ONE_BALL.format(moment).encode())))
        assert run("check", "-")[0] == want


def test_meshes_elsewhere_are_read_where_that_is_allowed(tmp_path: Path) -> None:
    """A cube of side 1 and 6 kg: m a²/6 = 1, beside the model's folder."""
    write_obj(tmp_path / "cube.obj", *cube(1.0))
    path = tmp_path / "arm" / "r.urdf"
    path.parent.mkdir()
    mesh = '<mesh filename="../cube.obj"/>'
    path.write_text(ONE_BALL.format(1).replace('"5"', '"6"').replace('<sphere radius="0.1"/>', mesh))
    code, out, err = run("check", path)
    assert (code, err) == (1, "")
    assert f"line 5: mesh ../cube.obj lies outside {path.parent}" in out
    assert "name the folder of its package with --packages, or pass --allow-outside" in out
    assert run("check", path, "--allow-outside")[0] == 0
    assert run("check", path, "--packages", tmp_path)[0] == 0
    better = tmp_path / "better.urdf"
    assert run("check", path, "--allow-outside", "--strict", "--fix", better)[0] == 0
    assert better.read_text() == path.read_text()


def test_control_characters_of_a_file_do_not_reach_the_terminal(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(ONE_BALL.format(1).replace('<sphere radius="0.1"/>', '<mesh filename="a\x9b2J\u202e"/>'))
    _, out, _ = run("check", path)
    assert "mesh a\\x9b2J\\u202e was not found" in out


def test_a_robot_of_placeholders(tmp_path: Path) -> None:
    """Links whose tensors nobody filled in, as in the tutorial of ROS; one has a mesh that is not there."""
    cylinder, box = '<cylinder radius="0.035" length="0.1"/>', '<box size="0.4 0.28 0.07"/>'
    shapes = (cylinder, box, '<sphere radius="0.06"/>', '<mesh filename="tip.dae"/>')
    links = [
        f'''<link name="l{k}"><inertial>
<mass value="{k + 1}"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial><collision><geometry>{shape}</geometry></collision></link>'''
        for k, shape in enumerate(shapes)
    ]
    path = tmp_path / "r.urdf"
    path.write_text("\n".join(['<robot name="r">', *links, "</robot>", ""]))
    code, out, _ = run("check", path)
    assert code == 1
    assert len(re.findall(r"(?m)^\s*l\d\b.*placeholder", out)) == 4
    assert "times its collision shape's" in next(line for line in out.splitlines() if "l2" in line)
    code, out, _ = run("check", path, "--fix", tmp_path / "fixed.urdf", "--format", "json")
    assert code == 1  # one link has a mesh that is not there
    report = json.loads(out)
    assert len(report["changed"]) == 3
    assert any("l3" in note and "left as they are" in note for note in report["notes"])
    again = json.loads(run("check", tmp_path / "fixed.urdf", "--format", "json")[1])
    assert again["count"]["good"] == 3
    by_hand = 2 * np.array([0.28**2 + 0.07**2, 0.4**2 + 0.07**2, 0.4**2 + 0.28**2]) / 12
    turned = next(link for link in again["links"] if link["link"] == "l1")
    np.testing.assert_allclose(
        np.sort(turned["moments"]), np.sort(by_hand), rtol=5e-9
    )  # as many digits as are written
