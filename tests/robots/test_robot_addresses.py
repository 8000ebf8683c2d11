"""Which files a robot may name: its own and declared ones in every ordinary layout, and nothing outside."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import run
from mesh_files import obj
from oracles.meshes import cube
from polhode import robots
from polhode.errors import FileFormatError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from polhode.robots import Verdict

# m a²/6 of a cube of side 1.
INERTIAL = """<inertial><mass value="6"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"""
ROBOT = f"""<robot name="r"><link name="first">{INERTIAL}
<collision><geometry><mesh filename="ADDRESS"/></geometry></collision></link>
<link name="second">{INERTIAL.replace("1", "2")}
<collision><geometry><box size="1 1 1"/></geometry></collision></link></robot>"""
INCLUDE = "<include><uri>ADDRESS</uri></include>"
SDF = f'<sdf version="1.9"><model name="m"><link name="own"/>{INCLUDE}</model></sdf>'
OPENED: list[str] | None = None


def _hear(event: str, arguments: tuple[object, ...]) -> None:
    if OPENED is not None and event == "open":
        OPENED.append(str(arguments[0]))


sys.addaudithook(_hear)


@pytest.fixture
def opened() -> Iterator[list[str]]:
    """The files that are opened during a test."""
    global OPENED
    OPENED = []
    yield OPENED
    OPENED = None


def robot(path: Path, address: str, text: str = ROBOT) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text.replace("ADDRESS", address))
    return path


def mesh(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(obj(*cube(1.0)))
    return path


def first(path: Path, *packages: Path, allow_outside: bool = False) -> Verdict:
    """The verdict of the link with the mesh; the other one is always judged."""
    found = robots.read_robot(path, packages, allow_outside=allow_outside)
    one, two = robots.check(found, packages, allow_outside=allow_outside)
    assert two.shape_moments is not None
    np.testing.assert_allclose(two.shape_moments, 1.0, rtol=1e-14)
    return one


def is_read(verdict: Verdict) -> bool:
    if verdict.shape_moments is None:
        return False
    np.testing.assert_allclose(verdict.shape_moments, 1.0, rtol=1e-14)
    assert verdict.notes == ()
    return True


@pytest.mark.parametrize(
    ("mark", "file", "address", "where"),
    [
        ("", "r.urdf", "cube.obj", "cube.obj"),
        ("", "r.urdf", "meshes/deep/cube.obj", "meshes/deep/cube.obj"),
        ("", "urdf/r.urdf", "../meshes/cube.obj", "meshes/cube.obj"),
        ("", "robots/r.urdf", "../meshes/cube.obj", "meshes/cube.obj"),
        ("", "arm/r.urdf", "../arm/cube.obj", "arm/cube.obj"),
        ("package.xml", "robots/urdf/r.urdf", "../../meshes/cube.obj", "meshes/cube.obj"),
        ("package.xml", "a/b/c/r.urdf", "../../../d/cube.obj", "d/cube.obj"),
        ("manifest.xml", "robots/r.urdf", "../meshes/cube.obj", "meshes/cube.obj"),
        ("model.config", "1.4/r.urdf", "../meshes/cube.obj", "meshes/cube.obj"),
        (".git/HEAD", "assets/arm/r.urdf", "../objects/cube.obj", "assets/objects/cube.obj"),
        ("__init__.py", "assets/arm/r.urdf", "../objects/cube.obj", "assets/objects/cube.obj"),
        ("", "r.urdf", "package://meshes/cube.obj", "meshes/cube.obj"),
        ("", "arm/r.urdf", "package://arm/cube.obj", "arm/cube.obj"),
        ("package.xml", "urdf/r.urdf", "package://home/meshes/cube.obj", "meshes/cube.obj"),
        ("package.xml", "urdf/r.urdf", "model://home/meshes/cube.obj", "meshes/cube.obj"),
        ("package.xml", "urdf/r.urdf", "model:///home/meshes/cube.obj", "meshes/cube.obj"),
        ("other/package.xml", "arm/urdf/r.urdf", "package://other/meshes/cube.obj", "other/meshes/cube.obj"),
        ("other/model.config", "arm/r.urdf", "model://other/meshes/cube.obj", "other/meshes/cube.obj"),
        ("", "r.urdf", "HOME/meshes/cube.obj", "meshes/cube.obj"),
        ("", "r.urdf", "file://HOME/meshes/cube.obj", "meshes/cube.obj"),
        ("", "urdf/r.urdf", "..\\meshes\\cube.obj", "meshes/cube.obj"),
        ("", "r.urdf", "meshes\\cube.obj", "meshes/cube.obj"),
        ("", "r.urdf", "meshes\\cube.obj", "meshes\\cube.obj"),
    ],
)
def test_ordinary_layouts_are_read(mark: str, file: str, address: str, where: str, tmp_path: Path) -> None:
    home = tmp_path / "home"
    if mark:
        (home / mark).parent.mkdir(parents=True)
        (home / mark).touch()
    mesh(home / where)
    path = robot(home / file, address.replace("HOME", str(home)))
    assert is_read(first(path))


class TestLinks:
    def test_a_file_that_is_a_link_has_its_own_place_in_truth(self, tmp_path: Path) -> None:
        """As in a cache of downloads, whose files are links to what they hold."""
        robot(tmp_path / "blobs" / "1", "cube.obj")
        mesh(tmp_path / "blobs" / "2")
        (tmp_path / "shot").mkdir()
        (tmp_path / "shot" / "r.urdf").symlink_to("../blobs/1")
        (tmp_path / "shot" / "cube.obj").symlink_to("../blobs/2")
        assert is_read(first(tmp_path / "shot" / "r.urdf"))
        path, better = tmp_path / "shot" / "r.urdf", tmp_path / "better.urdf"
        assert run("check", path, "--strict", "--fix", better)[0] == 0

    def test_an_installed_package_of_links_to_its_source(self, tmp_path: Path) -> None:
        source, installed = tmp_path / "src" / "arm", tmp_path / "install" / "arm"
        mesh(source / "meshes" / "cube.obj")
        (source / "package.xml").touch()
        (installed / "meshes").mkdir(parents=True)
        for name in ("package.xml", "meshes/cube.obj"):
            (installed / name).symlink_to(source / name)
        path = robot(tmp_path / "elsewhere" / "r.urdf", "package://arm/meshes/cube.obj")
        assert is_read(first(path, tmp_path / "install"))

    def test_dots_after_a_linked_folder_are_those_of_the_system(self, tmp_path: Path) -> None:
        mesh(tmp_path / "real" / "meshes" / "cube.obj")
        robot(tmp_path / "real" / "urdf" / "r.urdf", "../meshes/cube.obj")
        (tmp_path / "link").symlink_to(tmp_path / "real" / "urdf")
        assert is_read(first(tmp_path / "link" / "r.urdf"))


@pytest.mark.parametrize("variable", ["ROS_PACKAGE_PATH", "GZ_SIM_RESOURCE_PATH", "AMENT_PREFIX_PATH"])
def test_declared_packages_are_read(variable: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    share = tmp_path / "ws" / "share"
    file = mesh(share / "arm" / "cube.obj")
    monkeypatch.setenv(variable, str(share.parent if variable.startswith("AMENT") else share))
    for address in ("package://arm/cube.obj", str(file), f"file://{file}"):
        assert is_read(first(robot(tmp_path / "home" / "r.urdf", address)))
    monkeypatch.delenv(variable)
    assert not is_read(first(tmp_path / "home" / "r.urdf"))
    assert is_read(first(tmp_path / "home" / "r.urdf", share))


OUTSIDE = [
    "../outside/cube.obj",
    "../cube.obj",
    "meshes/../../outside/cube.obj",
    "ROOT/outside/cube.obj",
    "file://ROOT/outside/cube.obj",
    "file://../outside/cube.obj",
    "..\\outside\\cube.obj",
    "linked.obj",
    "linked/cube.obj",
    "package://arm/../outside/cube.obj",
    "package://arm/linked.obj",
    "package://outside/cube.obj",
    "model://outside/cube.obj",
    "package://other/../outside/cube.obj",
    "package://other/linked.obj",
    "package://marked/linked.obj",
]


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """A folder without a mark, beside others, with links that lead out of it."""
    mesh(tmp_path / "outside" / "cube.obj")
    mesh(tmp_path / "cube.obj")
    folder = tmp_path / "arm"
    (folder / "meshes").mkdir(parents=True)
    (folder / "linked").symlink_to(tmp_path / "outside")
    (folder / "linked.obj").symlink_to("../outside/cube.obj")
    for name in ("other", "marked"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "linked.obj").symlink_to("../outside/cube.obj")
    (tmp_path / "other" / "package.xml").touch()
    # A mark that is a link, but to what is none, does not make the folder it leads to a package.
    (tmp_path / "marked" / "package.xml").symlink_to("../outside/cube.obj")
    return folder


@pytest.mark.parametrize("address", OUTSIDE)
def test_what_lies_outside_is_told_and_not_opened(address: str, arm: Path, opened: list[str]) -> None:
    address = address.replace("ROOT", str(arm.parent))
    path = robot(arm / "r.urdf", address)
    if "file://.." not in address and address != "..\\outside\\cube.obj":
        assert is_read(first(path, allow_outside=True))
    del opened[:]
    verdict = first(path)
    (note,) = verdict.notes
    assert note.startswith(f"line 3: mesh {address} lies outside {arm.parent}")
    assert "--packages" in note
    assert "pass allow_outside=True" in note
    assert not [name for name in opened if "cube.obj" in name or "linked" in name]
    code, out, err = run("check", path)
    assert (code, err) == (1, "")  # of the placeholder in both links
    assert "pass --allow-outside" in out
    assert "lies outside" not in run("check", path, "--allow-outside")[1]
    assert not is_read(first(path))


@pytest.mark.parametrize(
    "address",
    [
        "package://../outside/cube.obj",
        "package://..",
        "model://",
        "package:///",
        "package://./arm",
        "http://a/b",
    ],
)
def test_names_of_no_package_are_not_found(address: str, arm: Path) -> None:
    (note,) = first(robot(arm / "r.urdf", address), allow_outside=True).notes
    assert note == f"line 3: mesh {address} was not found"


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("", "mesh (without a name) was not found"),
        (".", "mesh . is a directory; name a file in it"),
        ("meshes", "mesh meshes is a directory; name a file in it"),
        ("pipe", "mesh pipe is a pipe, a socket or a device; name a file"),
        ("loop", "mesh loop cannot be read (Too many levels of symbolic links)"),
        ("n" * 300, "(300 characters) cannot be read (File name too long)"),
        ("n/" * 3000, "(6000 characters) is a name of 6000 characters, more than files have"),
        ("n/" * 500_000, "(1000000 characters) is a name of 1000000 characters, more than files have"),
        ("damaged.stl", "damaged.stl: "),
        ("far.obj", "far.obj: "),
        ("nan.obj", "nan.obj: vertex 0 is not finite; check the file"),
    ],
)
def test_a_mesh_that_is_none_is_a_note_of_its_link(address: str, says: str, arm: Path) -> None:
    os.mkfifo(arm / "pipe")
    (arm / "loop").symlink_to("loop")
    (arm / "damaged.stl").write_bytes(b"solid\n")
    (arm / "far.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    (arm / "nan.obj").write_text("v 0 0 nan\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    verdict = first(robot(arm / "r.urdf", address))
    assert verdict.verdict == "placeholder"
    (note,) = verdict.notes
    assert note.startswith("line 3: mesh ")
    assert says in note
    assert len(note) < 500


def test_devices_are_not_read_even_where_all_is_allowed(arm: Path) -> None:
    (note,) = first(robot(arm / "r.urdf", "/dev/zero"), allow_outside=True).notes
    assert "is a pipe, a socket or a device" in note


def test_a_code_that_no_file_name_has() -> None:
    shape = robots.Shape("mesh", (1.0, 1.0, 1.0), robots.Place.identity(), "collision", mesh="a\0b")
    link = robots.Link("a", 1, robots.Inertial(1.0, np.zeros(3), np.eye(3)), shapes=(shape,))
    (verdict,) = robots.check(robots.Robot("URDF", "r", (link,), Path(), b""))
    assert "a character of code 0" in verdict.notes[0]


class TestHome:
    """The user's home and what is above it are nobody's package, whatever stands in them."""

    @pytest.mark.parametrize("mark", ["package.xml", ".git", "__init__.py"])
    @pytest.mark.parametrize("folder", ["arm", "urdf", "a/b"])
    def test_marks_in_it(
        self, mark: str, folder: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("HOME", str(tmp_path))
        monkeypatch.setenv("USERPROFILE", str(tmp_path))
        (tmp_path / mark).touch()
        mesh(tmp_path / "secret" / "cube.obj")
        up = "../" * (folder.count("/") + 1)
        verdict = first(robot(tmp_path / folder / "r.urdf", f"{up}secret/cube.obj"))
        assert "lies outside" in verdict.notes[0]


class TestIncludes:
    def test_of_mujoco(self, arm: Path, opened: list[str]) -> None:
        (arm.parent / "outside" / "part.xml").write_text('<x><body name="b"/></x>')
        (arm.parent / "outside" / "model.xml").write_text("<mujoco><worldbody><body/></worldbody></mujoco>")
        world = "<mujoco>{}<worldbody><body name='a'/>{}</worldbody></mujoco>"
        asset = '<asset><model name="m" file="../outside/model.xml"/></asset>'
        for text in (
            world.format("", '\n<include file="../outside/part.xml"/>'),
            world.format(asset, '\n<attach model="m" prefix="p"/>'),
            world.format('\n<asset><model file="../outside/model.xml"/></asset>', ""),
        ):
            path = robot(arm / "r.xml", "", text)
            del opened[:]
            with pytest.raises(FileFormatError) as told:
                robots.read_robot(path)
            assert str(told.value).startswith(f"{path}: line 2: ../outside/")
            assert "pass allow_outside=True" in str(told.value)
            assert not [name for name in opened if "/outside/" in name]
            code, _, err = run("check", path)
            assert code == 2
            assert "--allow-outside" in err
            assert len(robots.read_robot(path, allow_outside=True).links) >= 1
            assert run("check", path, "--allow-outside")[0] == 0

    @pytest.mark.parametrize(
        "address", ["../outside/m.sdf", "model://outside", "model://arm/../outside", "evil"]
    )
    def test_of_sdf(self, address: str, arm: Path, opened: list[str]) -> None:
        (arm.parent / "outside" / "m.sdf").write_text(SDF.replace(INCLUDE, ""))
        (arm.parent / "outside" / "model.sdf").write_text(SDF.replace(INCLUDE, ""))
        (arm / "evil").mkdir()
        (arm / "evil" / "model.config").write_text("<model><sdf>../../outside/m.sdf</sdf></model>")
        path = robot(arm / "r.sdf", address, SDF)
        del opened[:]
        own, lost = robots.check(robots.read_robot(path))
        assert (own.name, own.verdict, lost.verdict) == ("own", "placeholder", "unreadable")
        assert lost.reason.startswith("line 1: ")
        assert "lies outside" in lost.reason
        assert not [name for name in opened if "/outside/" in name]
        read = robots.check(robots.read_robot(path, allow_outside=True), allow_outside=True)
        assert [verdict.verdict for verdict in read] == ["placeholder", "placeholder"]


class TestTheFileItself:
    def test_what_is_no_file(self, tmp_path: Path) -> None:
        for path, says in ((tmp_path, "is a directory"), (Path("/dev/zero"), "is a device or a socket")):
            with pytest.raises(FileFormatError, match=says):
                robots.read_robot(path)

    def test_a_pipe_is_read_to_its_end_and_not_waited_for(self, tmp_path: Path) -> None:
        pipe = tmp_path / "pipe"
        os.mkfifo(pipe)
        with pytest.raises(FileFormatError, match="is a pipe into which nothing writes"):
            robots.read_robot(pipe)
        reading, writing = os.pipe()
        os.write(writing, ROBOT.replace("ADDRESS", "no.obj").encode())
        os.close(writing)
        found = robots.read_robot(f"/dev/fd/{reading}")
        os.close(reading)
        assert [link.name for link in found.links] == ["first", "second"]
