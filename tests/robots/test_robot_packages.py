"""Packages by the names that they give themselves, models by bare names, and what else real files rely on."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import write_obj
from oracles.meshes import cube
from polhode import robots
from robot_texts import HEAVY, ROUND, link, mjcf, sdf, slink, urdf, weighed
from three_formats import there

if TYPE_CHECKING:
    from pathlib import Path

# m a²/6 = 1 of a cube of side 1 and 6 kg.
MESH = urdf(link("a", 6.0, 1.0, '<mesh filename="package://hand_description/m/cube.obj" SCALE/>'))


def placed(folder: Path, name: str = "hand_description") -> Path:
    """A package of that name, in a folder that is called otherwise."""
    (folder / "m").mkdir(parents=True)
    write_obj(folder / "m" / "cube.obj", *cube(1.0))
    (folder / "package.xml").write_text(
        f'<?xml version="1.0"?>\n<package format="2">\n  <name> {name} </name></package>'
    )
    return folder


def is_good(path: Path, *packages: Path) -> bool:
    (verdict,) = robots.check(robots.read_robot(path, packages), packages)
    return verdict.verdict == "good"


def robot(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(MESH.replace("SCALE", ""))
    return path


class TestOwnNames:
    def test_of_the_package_around_the_file(self, tmp_path: Path) -> None:
        placed(tmp_path / "hand-main")
        assert is_good(robot(tmp_path / "hand-main" / "urdf" / "r.urdf"))

    @pytest.mark.parametrize("where", ["h", "src/h", "ws/src/group/h"])
    def test_within_a_declared_folder(self, where: str, tmp_path: Path) -> None:
        placed(tmp_path / "all" / where)
        path = robot(tmp_path / "r" / "r.urdf")
        assert not is_good(path)
        assert is_good(path, tmp_path / "all")

    def test_within_a_checkout(self, tmp_path: Path) -> None:
        (tmp_path / ".git").mkdir()
        placed(tmp_path / "parts" / "h")
        assert is_good(robot(tmp_path / "robots" / "r.urdf"))

    @pytest.mark.parametrize("name", ["ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH", "SDF_PATH"])
    def test_by_the_environment(self, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        placed(tmp_path / "all" / "h")
        monkeypatch.setenv(name, f"{tmp_path / 'none'}{os.pathsep}{tmp_path / 'all'}")
        assert is_good(robot(tmp_path / "r" / "r.urdf"))

    def test_by_an_installed_prefix(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        placed(tmp_path / "install" / "share" / "hand_description")
        monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
        assert is_good(robot(tmp_path / "r" / "r.urdf"))

    def test_another_name_is_none(self, tmp_path: Path) -> None:
        placed(tmp_path / "all" / "h", "hand")
        assert not is_good(robot(tmp_path / "r" / "r.urdf"), tmp_path / "all")

    def test_too_deep_or_within_another_package_is_not_looked_for(self, tmp_path: Path) -> None:
        placed(tmp_path / "deep" / "1" / "2" / "3" / "4" / "h")
        placed(tmp_path / "outer" / "p", "outer")
        placed(tmp_path / "outer" / "p" / "h")
        path = robot(tmp_path / "r" / "r.urdf")
        assert not is_good(path, tmp_path / "deep")
        assert not is_good(path, tmp_path / "outer")

    def test_a_link_to_another_file_is_not_opened(self, tmp_path: Path) -> None:
        placed(tmp_path / "all" / "h")
        (tmp_path / "all" / "h" / "package.xml").rename(tmp_path / "secret")
        (tmp_path / "all" / "h" / "package.xml").symlink_to(tmp_path / "secret")
        assert not is_good(robot(tmp_path / "r" / "r.urdf"), tmp_path / "all")


class TestModels:
    def test_a_bare_name_is_a_model_beside(self, tmp_path: Path) -> None:
        """As PX4's x500 variants include their base."""
        for name, text in (
            ("base", sdf(slink("b", weighed(5, 0.02), ROUND))),
            ("variant", sdf("<include><uri>base</uri></include>")),
        ):
            (tmp_path / "models" / name).mkdir(parents=True)
            (tmp_path / "models" / name / "model.sdf").write_text(text)
            (tmp_path / "models" / name / "model.config").write_text(
                '<model><sdf version="1.9">model.sdf</sdf></model>'
            )
        (verdict,) = robots.check(robots.read_robot(tmp_path / "models" / "variant" / "model.sdf"))
        assert (verdict.name, verdict.verdict) == ("m::b", "good")

    def test_an_included_model_may_be_static(self, tmp_path: Path) -> None:
        (tmp_path / "b.sdf").write_text(sdf(slink("b", weighed(5, 1))))
        for extra, word in (("", "placeholder"), ("<static>true</static>", "none")):
            (tmp_path / "a.sdf").write_text(sdf(f"<include><uri>b.sdf</uri>{extra}</include>"))
            (verdict,) = robots.check(robots.read_robot(tmp_path / "a.sdf"))
            assert verdict.verdict == word

    def test_a_frame_of_another_model_is_attached(self, tmp_path: Path) -> None:
        inner = f'<frame name="f"><body name="b">{HEAVY}</body></frame><body name="c"/>'
        (tmp_path / "arm.xml").write_text(mjcf(inner))
        assets = '<asset><model name="arm" file="arm.xml"/></asset>'
        attach = '<body name="a"><joint/><attach model="arm" {}="f" prefix="x_"/></body>'
        (tmp_path / "r.xml").write_text(mjcf(attach.format("frame"), before=assets))
        words = {v.name: v.verdict for v in robots.check(robots.read_robot(tmp_path / "r.xml"))}
        assert words == {"a": "none", "x_b": "good"}
        (tmp_path / "r.xml").write_text(mjcf(attach.format("body"), before=assets))
        with pytest.raises(ValueError, match=r"arm.xml has no body 'f'; correct the name"):
            robots.read_robot(tmp_path / "r.xml")

    def test_what_is_attached_of_the_model_itself_is_told(self) -> None:
        text = mjcf(f'<body name="a">{HEAVY}</body><attach body="a" prefix="x_"/>')
        robot = robots.parse_robot(text.encode(), name="r", folder=".")
        assert [link.name for link in robot.links] == ["a"]
        assert robot.notes == ("what <attach> repeats of the model itself is judged once",)

    def test_one_scale_is_that_of_all_axes(self, tmp_path: Path) -> None:
        write_obj(tmp_path / "cube.obj", *cube(1000.0))
        mesh = "<mesh><uri>cube.obj</uri><scale>0.001</scale></mesh>"
        texts = [
            urdf(link("a", 6.0, 1.0, '<mesh filename="cube.obj" scale="0.001"/>')),
            sdf(slink("a", weighed(6, 1), mesh)),
            mjcf(
                '<body name="a"><inertial mass="6" pos="0 0 0" diaginertia="1 1 1"/>'
                '<geom type="mesh" mesh="cube"/></body>',
                before='<asset><mesh name="cube" file="cube.obj" scale="0.001"/></asset>',
            ),
        ]
        for text in texts:
            (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=tmp_path))
            assert verdict.verdict == "good"
            np.testing.assert_allclose(there(verdict.shape_moments), 1.0, rtol=1e-12)
        bad = robots.parse_robot(texts[0].replace("0.001", "1 2").encode(), name="r", folder=tmp_path)
        assert "scale is '1 2' where 3 finite numbers" in robots.check(bad)[0].reason


def test_a_reader_that_leaves_is_no_error(tmp_path: Path) -> None:
    """As a process: `polhode … | head -1` ends with 0 on both sides, however much there was to say."""
    write_obj(tmp_path / "cube.obj", *cube(1.0))
    (tmp_path / "r.urdf").write_text(urdf(*(link(f"link{i}", 5.0, 0.1 + 1e-3 * i) for i in range(2000))))
    for arguments in (["report", tmp_path / "cube.obj", "--density", "1"], ["check", tmp_path / "r.urdf"]):
        command = [sys.executable, "-m", "polhode", *map(str, arguments)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            assert process.stdout is not None
            assert process.stderr is not None
            process.stdout.read(20)
            process.stdout.close()
            assert process.stderr.read() == b""
            assert process.wait(60) == 0
