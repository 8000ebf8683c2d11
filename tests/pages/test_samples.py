"""The files that ship: generated ones made again, typed ones read, the T-handle the same everywhere."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run
from markdown_code import blocks
from places import ROOT
from polhode import RigidBody, assembly, robots, samples, solids
from polhode.errors import PolhodeError
from polhode.uncertainty import ledger
from sample_files import FILES, FOLDER, t_handle

TYPED = {"craft.csv", "robot.sdf", "robot.urdf", "rover.toml", "water.xyz", "wheel.toml"}
MESHES = {"asteroid.obj": "m", "bracket.ply": "in", "t-handle.stl": "mm", "torus.obj": "mm"}


@pytest.mark.parametrize("name", FILES)
def test_what_is_generated_comes_out_again(name: str) -> None:
    assert FILES[name]() == samples.path(name).read_bytes()


def test_every_file_is_listed_and_they_are_small() -> None:
    there = {path.name for path in FOLDER.iterdir() if path.suffix not in {".py", ""}}
    assert there == set(samples.names()) == set(FILES) | TYPED
    assert list(samples.names()) == sorted(samples.names())
    assert sum(samples.path(name).stat().st_size for name in samples.names()) <= 300_000


@pytest.mark.parametrize("name", MESHES)
def test_every_mesh_is_a_solid(name: str) -> None:
    body = RigidBody.from_file(samples.path(name), density=1.0, length_unit=MESHES[name])
    assert "closed" in body.provenance.checked
    assert body.mass > 0.0


def test_sizes_are_as_they_are_told() -> None:
    inches = RigidBody.from_file(samples.path("bracket.ply"), density=1.0, length_unit="in")
    assert inches.mass == pytest.approx((3 * 0.25 + 1.75 * 0.25) * 2 * 0.0254**3, rel=1e-12)
    ring = RigidBody.from_file(samples.path("torus.obj"), density=1.0)
    assert ring.mass == pytest.approx(2 * np.pi**2 * 40 * 10**2, rel=0.04)  # a polygon is in its circle
    rock = np.loadtxt(
        samples.path("asteroid.obj").read_text().split("\nf ")[0].splitlines()[1:], usecols=(1, 2, 3)
    )
    assert np.ptp(rock[:, 0]) == pytest.approx(476, abs=0.5)
    assert RigidBody.from_file(samples.path("asteroid.obj"), density=1.0).principal.top == "asymmetric"


def test_the_t_handle_is_one_everywhere() -> None:
    """The file, the mesh, the sum of two boxes in README and docs, and the robot's link."""
    steel: Any = {"density": 7850.0}
    bar = solids.box((0.100, 0.016, 0.016), **steel).translated((0, 0, 0.008))
    handle = bar + solids.box((0.016, 0.016, 0.050), **steel).translated((0, 0, -0.025))
    assert RigidBody.from_file(samples.path("t-handle.stl"), length_unit="mm", **steel).isclose(handle, 1e-12)
    vertices, faces = t_handle()
    assert RigidBody.from_mesh(vertices * 1e-3, faces, **steel).isclose(handle, 1e-12)
    for page in (ROOT / "README.md", ROOT / "docs" / "index.md"):
        code = next(code for _, code in blocks(page) if "handle = " in code)
        names: dict[str, object] = {}
        exec(compile(code.partition("\nprint")[0], str(page), "exec"), names)
        made = names["handle"]
        assert isinstance(made, RigidBody)
        assert made.isclose(handle, 1e-14)
    link = next(link for link in robots.read_robot(samples.path("robot.urdf")).links if link.name == "handle")
    assert link.inertial is not None
    assert handle.isclose(
        RigidBody(link.inertial.mass, link.inertial.inertia, link.inertial.center_of_mass), 1e-5
    )


@pytest.mark.parametrize("name", ["robot.urdf", "robot.sdf"])
def test_the_robot_holds_one_fault(name: str) -> None:
    code, out, err = run("check", samples.path(name))
    assert (code, err) == (1, "")
    assert len(re.findall(r"^\s*ball\b.*(impossible|placeholder)", out, re.MULTILINE)) == 1
    assert not re.search(r"^\s*(table|handle)\b.*(impossible|placeholder|suspect|unread)", out, re.MULTILINE)


def test_molecules_trees_and_parts_are_read() -> None:
    water, benzene = (RigidBody.from_file(samples.path(f"{name}.xyz")) for name in ("water", "benzene"))
    assert (water.principal.top, benzene.principal.top) == ("asymmetric", "oblate")
    assert assembly.read(samples.path("rover.toml")).body.mass > 30
    assert ledger(samples.path("craft.csv"))["craft"].predicted_mass > 50


class TestCopies:
    def test_all_are_put_there_again_and_again(self, tmp_path: Path) -> None:
        for _ in range(2):
            code, out, err = run("samples", tmp_path / "a" / "b")
            assert (code, err) == (0, "")
            assert all(name in out for name in samples.names())
        assert {path.name for path in (tmp_path / "a" / "b").iterdir()} == set(samples.names())

    def test_nothing_is_written_over(self, tmp_path: Path) -> None:
        (tmp_path / "water.xyz").write_text("mine")
        code, _, err = run("samples", tmp_path)
        assert code == 2
        assert f"{tmp_path / 'water.xyz'} is there already, with other content; name another folder" in err
        assert [path.name for path in tmp_path.iterdir()] == ["water.xyz"]
        with pytest.raises(PolhodeError, match="is a file; name a folder"):
            samples.copy(tmp_path / "water.xyz")

    def test_without_a_folder_they_are_listed(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.chdir(tmp_path)
        code, out, err = run("samples")
        assert (code, err) == (0, "")
        assert "polhode samples FOLDER" in out
        assert not list(tmp_path.iterdir())

    def test_a_name_that_is_none(self) -> None:
        with pytest.raises(PolhodeError, match=r"'t-handel\.stl' is no sample; did you mean t-handle\.stl\?"):
            samples.path("t-handel.stl")
        with pytest.raises(PolhodeError, match=r"'q' is no sample; there are asteroid\.obj, "):
            samples.path("q")
