"""Solids of a CAD file that share matter: what the report tells, beside closed forms."""

from __future__ import annotations

import gzip
import re
import sys
from math import pi
from pathlib import Path
from typing import Any

import pytest
from boxes import at, written
from cad_files import boolean, moved, occt, primitive, write_assembly, write_step
from command_line import run
from polhode import RigidBody, robots
from polhode.io import cad_files, cad_process, solid_from_file
from polhode.io.cad_files import read_with_shapes
from polhode.io.formats import load
from robot_texts import link, urdf

BOX = primitive("Box", 10.0, 10.0, 10.0)
CUBE = moved(primitive("Box", 2.0, 2.0, 2.0), 1.0, 1.0, 1.0)
HOLLOW = boolean("Cut", primitive("Box", 4.0, 4.0, 4.0), CUBE)

SHARED: dict[str, tuple[Any, Any, float]] = {
    "two boxes": (
        primitive("Box", 4.0, 3.0, 2.0),
        moved(primitive("Box", 4.0, 3.0, 2.0), 2.0, 1.0, 1.0),
        4.0,
    ),
    "box and cylinder": (BOX, moved(primitive("Cylinder", 2.0, 6.0), 5.0, 5.0, 8.0), 8.0 * pi),
    "box and sphere in it": (BOX, moved(primitive("Sphere", 2.0), 5.0, 5.0, 5.0), 32.0 * pi / 3.0),
    "two spheres": (
        primitive("Sphere", 3.0),
        moved(primitive("Sphere", 3.0), 3.0, 0.0, 0.0),
        pi * (4.0 * 3.0 + 3.0) * (2.0 * 3.0 - 3.0) ** 2 / 12.0,
    ),
    "two cylinders on one axis": (
        primitive("Cylinder", 2.0, 6.0),
        moved(primitive("Cylinder", 2.0, 6.0), 0.0, 0.0, 4.0),
        8.0 * pi,
    ),
    "one box twice": (primitive("Box", 1.0, 2.0, 3.0), primitive("Box", 1.0, 2.0, 3.0), 6.0),
}
"""By name: two shapes and the volume that they share, in mm^3."""
TOLD_OF = "solids "
TOLD = "overlap: 2.513e-08 m^3 (2.34 % of the volume) counts twice"
"""Of the box and the cylinder."""
APART = {
    "two boxes that touch": (BOX, moved(BOX, 10.0, 0.0, 0.0)),
    "two boxes whose spheres meet": (BOX, moved(BOX, 11.0, 0.0, 0.0)),
    "a cube in a cavity": (HOLLOW, moved(primitive("Box", 1.0, 1.0, 1.0), 1.5, 1.5, 1.5)),
    "a cube that fills a cavity": (HOLLOW, CUBE),
}


def both(one: Any, other: Any, path: Path) -> Path:
    """Write two solids, as they stand, to one file."""
    builder, whole = occt("BRep").BRep_Builder(), occt("TopoDS").TopoDS_Compound()
    builder.MakeCompound(whole)
    for make in (one, other):
        builder.Add(whole, make())
    return write_step(whole, path)


def told(path: Path) -> tuple[str, ...]:
    """What reading a file tells of its solids."""
    cad = load(path).cad
    assert cad is not None
    return cad.overlaps


@pytest.mark.usefixtures("occt_here")
@pytest.mark.parametrize("name", SHARED)
def test_what_two_solids_share(name: str, tmp_path: Path) -> None:
    one, other, volume = SHARED[name]
    path = both(one, other, tmp_path / "two.step")
    (line,) = told(path)
    cad, shapes = read_with_shapes(path)
    ((i, k),) = cad_files.near_pairs(cad.parts)
    assert cad_files.volume_shared(shapes[i], shapes[k], cad.parts[k].moments.volume) == pytest.approx(
        volume, rel=1e-9
    )
    assert f"{volume * 1e-9:.4g} m^3" in line
    assert "counts twice" in line
    assert ("lies within" in line) == (name in ("box and sphere in it", "one box twice"))


@pytest.mark.usefixtures("occt_here")
@pytest.mark.parametrize("name", APART)
def test_solids_that_share_nothing(name: str, tmp_path: Path) -> None:
    path = both(*APART[name], tmp_path / "two.step")
    cad = load(path).cad
    assert cad is not None
    assert len(cad_files.near_pairs(cad.parts)) == 1  # so that OCCT is asked
    assert cad.overlaps == ()


@pytest.mark.usefixtures("occt_here")
def test_whoever_reads_it_tells_it(tmp_path: Path) -> None:
    path = both(*SHARED["box and cylinder"][:2], tmp_path / "two.step")
    packed = tmp_path / "two.step.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    for file in (path, packed):
        code, out, _ = run("report", file, "--density", "2700 kg/m^3")
        assert code == 0
        assert TOLD in out
    code, out, _ = run("spin", path, "--density", "2700 kg/m^3", "--omega", "0 0 1")
    assert code == 0
    assert TOLD in out
    code, out, _ = run("report", path, "--density", "2700 kg/m^3", "--as", "urdf")
    assert code == 0
    orbit = (
        "--periods",
        "264.178 h, 27.38547 h",
        "--mode",
        "long-axis",
        "--eccentricity",
        "4.25",
        "--n",
        "2",
    )
    code, out, _ = run("flyby", path, "--density", "2700 kg/m^3", *orbit)
    assert code == 0
    assert TOLD in out
    (tmp_path / "whole.toml").write_text('[[part]]\nname = "a"\nfile = "two.step"\ndensity = 2700\n')
    for command in (("assemble",), ("report",), ("spin", "--omega", "0 0 1")):
        code, out, _ = run(command[0], tmp_path / "whole.toml", *command[1:])
        assert code == 0
        assert f"part 'a': {TOLD_OF}" in out
        assert TOLD in out
    for read in (RigidBody.from_file, solid_from_file):
        with pytest.warns(UserWarning, match=re.escape(TOLD)):
            read(path, density=2700.0)


@pytest.mark.usefixtures("occt_here")
def test_a_link_tells_it(tmp_path: Path) -> None:
    both(*SHARED["box and cylinder"][:2], tmp_path / "two.step")
    text = urdf(link("a", 1.0, (1.0, 1.0, 1.0), '<mesh filename="two.step"/>'))
    (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=tmp_path))
    assert any(TOLD in note for note in verdict.notes)


def test_components_of_a_mesh_are_told_beside_a_motion(tmp_path: Path, has_union: bool) -> None:
    written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
    much = "0.14 m^3 (10.4 % of the volume) counts twice" if has_union else "what they share counts twice"
    options = ("--length-unit", "m", "--density", "2")
    code, out, _ = run("spin", tmp_path / "two.obj", *options, "--omega", "0 0 1")
    assert code == 0
    assert much in out
    assert "--union counts what components share once" in out
    code, out, _ = run(
        "spin", tmp_path / "two.obj", *options, "--omega", "0 0 1", *(("--union",) * has_union)
    )
    assert (much in out) != has_union
    part = '[[part]]\nname = "a"\nfile = "two.obj"\nlength_unit = "m"\ndensity = 2\n'
    for more, is_told in (("", True), ("union = true\n", False)):
        if more and not has_union:
            continue
        (tmp_path / "whole.toml").write_text(part + more)
        code, out, _ = run("assemble", tmp_path / "whole.toml")
        assert code == 0
        assert (much in out) == is_told
        assert ("union = true counts what components share once" in out) == is_told


@pytest.mark.usefixtures("occt_here")
def test_parts_of_an_assembly_that_are_apart(tmp_path: Path) -> None:
    assert told(write_assembly(tmp_path / "apart.step", {})) == ()


def test_what_is_not_known_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = both(*SHARED["two boxes"][:2], tmp_path / "two.step")
    for body, words in (
        (
            "import os; os.kill(os.getpid(), 11)",
            "OCCT broke down when it looked for overlaps (exit code -11)",
        ),
        ("import time; time.sleep(60)", "OCCT took more than 0.5 s to look for overlaps"),
        ("return None", "whether solids overlap is not known of "),
    ):
        lines = (
            "import sys",
            "from pathlib import Path",
            "from polhode.io import cad_process",
            "def shared(*_):",
            f"    {body}",
            "cad_process.volume_shared = shared",
            "cad_process._main(Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]))",
        )
        monkeypatch.setattr(cad_process, "_COMMAND", ["-c", "\n".join(lines)])
        monkeypatch.setattr(cad_process, "_SHARING", (0.5 if "sleep" in body else 60.0, 0.0))
        monkeypatch.setattr(cad_process, "_BOTH", (120.0, 0.0))
        (line,) = told(path)
        assert line.startswith(words)
        assert ("1 pairs of solids that are near enough to overlap were not looked at" in line) == (
            "OCCT" in words
        )
    monkeypatch.undo()
    monkeypatch.setattr(cad_files, "_MOST_PAIRS", 0)
    (line,) = told(path)
    assert line.startswith("1 pairs of solids are near enough to overlap, too many to look at")
    monkeypatch.undo()
    monkeypatch.setattr(sys, "executable", "")
    (line,) = told(path)
    assert line.startswith("OCCT was not started: 1 pairs of solids")
