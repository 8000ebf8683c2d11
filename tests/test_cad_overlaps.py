"""Solids of a CAD file that share matter: what the report tells, beside closed forms."""

from __future__ import annotations

import gzip
from math import pi
from pathlib import Path
from typing import Any

import pytest
from cad_files import boolean, moved, occt, primitive, write_assembly, write_step
from command_line import run
from polhode.files import cad_overlaps
from polhode.files.loaded import load

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


@pytest.mark.parametrize("name", SHARED)
def test_what_two_solids_share(name: str, tmp_path: Path) -> None:
    one, other, volume = SHARED[name]
    path = both(one, other, tmp_path / "two.step")
    cad = load(path).cad
    assert cad is not None
    (pair,), fault = cad_overlaps._looked_for_apart(path, cad_overlaps._meeting(cad.parts))
    assert fault == ""
    assert pair.volume == pytest.approx(volume, rel=1e-9)
    (line,) = cad_overlaps.overlaps_told(cad, path)
    assert f"{volume * 1e-9:.4g} m^3" in line
    assert "counts twice" in line
    assert ("lies within" in line) == (name in ("box and sphere in it", "one box twice"))


@pytest.mark.parametrize("name", APART)
def test_solids_that_share_nothing(name: str, tmp_path: Path) -> None:
    path = both(*APART[name], tmp_path / "two.step")
    cad = load(path).cad
    assert cad is not None
    assert len(cad_overlaps._meeting(cad.parts)) == 1  # so that OCCT is asked
    assert cad_overlaps.overlaps_told(cad, path) == []


def test_the_report_tells_it(tmp_path: Path) -> None:
    path = both(*SHARED["box and cylinder"][:2], tmp_path / "two.step")
    packed = tmp_path / "two.step.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    for file in (path, packed):
        code, out, _ = run("report", file, "--density", "2700 kg/m^3")
        assert code == 0
        assert "overlap: 2.513e-08 m^3 (2.34 % of the volume) counts twice" in out
    code, out, _ = run("spin", path, "--density", "2700 kg/m^3", "--omega", "0 0 1")
    assert code == 0
    assert "where two overlap, what they share counts twice; polhode report looks for that" in out


def test_parts_of_an_assembly_that_are_apart(tmp_path: Path) -> None:
    path = write_assembly(tmp_path / "apart.step", {})
    cad = load(path).cad
    assert cad is not None
    assert cad_overlaps.overlaps_told(cad, path) == []


def test_what_is_not_known_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = both(*SHARED["two boxes"][:2], tmp_path / "two.step")
    cad = load(path).cad
    assert cad is not None
    for command, words in (
        (["-c", "import os; os.kill(os.getpid(), 11)"], "OCCT broke down when it looked for overlaps"),
        (["-c", "import time; time.sleep(20)"], "OCCT took more than 0.5 s to look for overlaps"),
    ):
        monkeypatch.setattr(cad_overlaps, "_COMMAND", command)
        monkeypatch.setattr(cad_overlaps, "_SECONDS", 0.5)
        (line,) = cad_overlaps.overlaps_told(cad, path)
        assert line.startswith(words) or "more than 0.5 s" in line  # on a busy machine
        assert "1 pairs of solids that are near enough to overlap were not looked at" in line
    known = "import sys,pickle; sys.stdout.buffer.write(pickle.dumps((0, 1, None)))"
    monkeypatch.setattr(cad_overlaps, "_COMMAND", ["-c", known])
    monkeypatch.setattr(cad_overlaps, "_SECONDS", 60.0)
    (line,) = cad_overlaps.overlaps_told(cad, path)
    assert line.startswith("whether solids overlap is not known of ")
    monkeypatch.setattr(cad_overlaps, "_MOST_PAIRS", 0)
    (line,) = cad_overlaps.overlaps_told(cad, path)
    assert line.startswith("1 pairs of solids are near enough to overlap, too many to look at")
