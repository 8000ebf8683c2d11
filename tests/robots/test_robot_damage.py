"""Damaged robots end in a verdict or an error of one line, soon, and never in anything else."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING

import pytest
from command_line import one_line, run
from polhode import robots
from polhode.errors import FileFormatError
from robot_damage import SAMPLES, damaged, write

if TYPE_CHECKING:
    from pathlib import Path

WORDS = {
    "good",
    "suspect",
    "coarse",
    "missing",
    "placeholder",
    "impossible",
    "unreadable",
    "none",
    "inferred",
}
SECONDS = 5.0


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A package with things in it that are no files."""
    home = tmp_path / "package"
    for name in ("", "parts", "part", "urdf", "meshes"):
        inner = home / name
        inner.mkdir()
        os.mkfifo(inner / "pipe")
        (inner / "loop").symlink_to("loop")
        (inner / "folder").mkdir()
        (inner / "away").symlink_to("/etc/hostname")
    (home / "package.xml").write_text("<package/>")
    return home


def judged(path: Path) -> str:
    """What becomes of a robot: a word for a verdict or an error."""
    told = ""
    try:
        robot = robots.read_robot(path)
    except FileFormatError as error:
        told = str(error)
    if told:
        assert told.startswith(f"{path}: ")
        assert len(told) < 1500
        return "refused"
    verdicts = robots.check(robot, density=1000.0)
    assert {verdict.verdict for verdict in verdicts} <= WORDS
    assert all(len(verdict.reason) < 1500 for verdict in verdicts)
    better = robots.fix(robot, verdicts, WORDS)
    again = robots.parse_robot(better, name="better", folder=robot.folder)
    own, written = ([link.name for link in each.links if not link.file] for each in (robot, again))
    assert own == written
    return "judged"


def go_through(numbers: range, folder: Path) -> dict[str, int]:
    """Damage and judge, in Python and on the command line; the count of each outcome."""
    counts: dict[str, int] = {}
    for number in numbers:
        sample, name, data = damaged(number)
        path = write(sample, folder, **{name: data})
        start = time.process_time()
        try:
            outcome = judged(path)
            if number % 4 == 0:
                code, out, err = run("check", path, "--fix", folder / "better.xml")
                assert (code == 2) == (outcome == "refused"), err
                assert one_line(err) and not out if code == 2 else not err
        except BaseException as error:
            error.add_note(f"case {number}: {name} of {sample}, {data[:200]!r}")
            raise
        assert time.process_time() - start < SECONDS, f"case {number}"
        counts[outcome] = counts.get(outcome, 0) + 1
    return counts


@pytest.mark.parametrize("sample", SAMPLES)
def test_whole_samples_are_judged(sample: str, folder: Path) -> None:
    path = write(sample, folder)
    verdicts = {v.name: v.verdict for v in robots.check(robots.read_robot(path))}
    assert "unreadable" not in verdicts.values()
    assert len(verdicts) >= 4
    assert judged(path) == "judged"


def test_damaged_robots(folder: Path) -> None:
    counts = go_through(range(200), folder)
    assert min(counts.values()) > 20


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_many_damaged_robots(folder: Path) -> None:
    counts = go_through(range(1_000, 6_000), folder)
    print(counts)
    assert sum(counts.values()) == 5000


@pytest.mark.parametrize("sample", SAMPLES)
def test_cut_at_every_place(sample: str, folder: Path) -> None:
    """Each file of a sample, cut at every 40th byte."""
    for name, text in SAMPLES[sample].items():
        for length in range(0, len(text), 40):
            judged(write(sample, folder, **{name: text.encode()[:length]}))
