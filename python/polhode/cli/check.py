"""``polhode check``: a verdict on the inertia of every link of a robot, and a file with better values."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polhode import robots
from polhode._format import Note
from polhode.cli.files import STDIN, check_outputs, label
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.terminal import in_options
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import files_read
from polhode.io.writing import write_bytes
from polhode.robots.geometry import HULL, LOST
from polhode.robots.sources import read_stream
from polhode.robots.verdict import has_own_tensor, is_without_mass, replacement
from polhode.units import quantity

if TYPE_CHECKING:
    from collections.abc import Iterable

    from polhode.cli.options import CheckOptions

__all__ = ["check_report"]

_UNIT = "kg m^2"
_PACKAGE = re.compile(r"(?:package|model):/+([^/]+)")
_WAY_OUT = "--fix FILE with --density or --mass writes the mass that is missing, where a link has shapes"
_COLUMNS = (
    Column("link", "link"),
    Column("mass", "mass", "kg"),
    Column("moments", "declared", _UNIT),
    Column("shape_moments", "from its shape", _UNIT),
    Column("verdict", "verdict"),
    Column("reason", "reason"),
)


def check_report(file: Path, options: CheckOptions) -> tuple[Report, bool]:
    """Judge a robot and fix it as asked for.

    Returns
    -------
    report : Report
    is_good : bool
        Whether no link fails; of the fixed file where one is written.
    """
    _check_options(options)
    filling = _filling(options)
    with files_read() as read:
        robot = _read_robot(file, options)
        verdicts = robots.check(robot, options.packages, allow_outside=options.allow_outside, **filling)
    check_outputs([("--fix", options.fix)], read)
    failing = robots.FAILURES | ({"suspect"} if options.strict else frozenset())
    report = Report()
    report.section(
        "",
        Field("file", "file", label(file)),
        Field("format", "format", robot.format),
        Field("robot", "robot", robot.name or "(without a name)"),
    )
    report.section("links", Table("links", _COLUMNS, [_row(verdict) for verdict in verdicts]))
    bad = [verdict for verdict in verdicts if verdict.verdict in failing]
    words = ["good", "suspect", *(["coarse"] if any(v.verdict == "coarse" for v in verdicts) else [])]
    counts = {word: sum(v.verdict == word for v in verdicts) for word in words}
    report.section(
        "verdict",
        Field("verdict", "verdict", "bad" if bad else "good"),
        Field("count.links", "links", len(verdicts)),
        Field("count.failing", "failing", len(bad)),
        *(Field(f"count.{word}", word, count) for word, count in counts.items()),
    )
    notes = dict.fromkeys(note for verdict in verdicts for note in verdict.notes)
    report.notes += [in_options(note) for note in (*robot.notes, *_group_notes(notes))]
    if filling and not any(is_without_mass(*each) for each in zip(robot.links, verdicts, strict=True)):
        report.notes.append(f"--{next(iter(filling))} has no effect: no failing link is without mass")
    report.notes += _warnings(robot, verdicts, failing)
    if options.fix is None:
        if any(verdict.better is not None for verdict in bad):
            report.notes.append("--fix FILE writes better values into a copy")
        elif any(verdict.inside is not None for verdict in verdicts):
            report.notes.append("--fix FILE moves tensors on the edge inside, in a copy")
        if any(verdict.verdict == "missing" and verdict.better is None for verdict in bad):
            report.notes.append(_WAY_OUT)
        return report, not bad
    return report, _fix(report, robot, verdicts, failing, options)


def _group_notes(notes: Iterable[str]) -> list[str]:
    """Describe in one line each of all meshes that were not found, and of all whose hulls were taken."""
    notes = [*notes]
    told = [note for note in notes if not isinstance(note, Note) or note.kind not in (LOST, HULL)]
    about = [note for note in notes if isinstance(note, Note)]
    lost = {note.subject: note for note in reversed(about) if note.kind == LOST}
    hulls = {note.subject: note for note in reversed(about) if note.kind == HULL}
    if lost:
        names = [*lost][::-1]
        packages = list(dict.fromkeys(m[1] for name in names if (m := _PACKAGE.match(name)) is not None))
        wanted = f"the folder that holds {_some(packages)}" if packages else "the folder of their package"
        what = lost[names[0]] if len(names) == 1 else f"{len(names)} meshes were not found: {_some(names)}"
        told.append(f"{what}; name {wanted} with --packages, or put them where the file says")
    if hulls:
        names = [*hulls][::-1]
        many = (
            f"{len(names)} meshes do not bound solids, so that their convex hulls were taken: {_some(names)}"
        )
        told.append(hulls[names[0]] if len(names) == 1 else many)
    return told


def _some(names: list[str], most: int = 3) -> str:
    left = len(names) - most
    return ", ".join(names[:most]) + (f" and {left} more" if left > 0 else "")


def _warnings(robot: robots.Robot, verdicts: list[robots.Verdict], failing: frozenset[str]) -> list[str]:
    """Warn of tensors that a fix would replace, though they may come from a measurement."""
    names = [
        link.name
        for link, verdict in zip(robot.links, verdicts, strict=True)
        if verdict.verdict in failing and verdict.better is not None and link.rewrite is not None
        if has_own_tensor(link)
    ]
    if not names:
        return []
    return [
        "warning: --fix replaces tensors that a body can have; they may be measured: "
        f"{_some(names, 8)}; compare them before you use the copy"
    ]


def _filling(options: CheckOptions) -> dict[str, float]:
    """Return the density or the mass of links for which the file says none."""
    if options.density is not None and options.mass is not None:
        raise PolhodeError("--density and --mass: give one of them, not both")
    found: dict[str, float] = {}
    for name, text, unit in (("density", options.density, "kg/m^3"), ("mass", options.mass, "kg")):
        if text is None:
            continue
        found[name] = quantity(text, unit, f"--{name}")
        if not found[name] > 0.0:
            raise PolhodeError(f"--{name}: {text} is not above 0; give a positive {name}")
    return found


def _check_options(options: CheckOptions) -> None:
    for folder in options.packages:
        if not folder.is_dir():
            raise PolhodeError(f"--packages: there is no folder {folder}; name one that holds the packages")


def _read_robot(file: Path, options: CheckOptions) -> robots.Robot:
    if file != STDIN:
        return robots.read_robot(file, options.packages, allow_outside=options.allow_outside)
    source = read_stream(sys.stdin.buffer, label(file))
    if not source:
        raise FileFormatError("-: nothing came on standard input; send a file into it")
    return _parse_robot(source, label(file), Path.cwd(), options)


def _parse_robot(
    source: bytes, name: str, folder: Path, options: CheckOptions, roots: tuple[Path, ...] = ()
) -> robots.Robot:
    packages = (*options.packages, *roots)
    return robots.parse_robot(
        source, name=name, folder=folder, packages=packages, allow_outside=options.allow_outside
    )


def _row(verdict: robots.Verdict) -> dict[str, Any]:
    return {
        "link": verdict.name,
        "line": verdict.line,
        "file": verdict.file,
        "mass": verdict.mass,
        "moments": verdict.moments,
        "shape_moments": verdict.shape_moments,
        "factor": verdict.factor,
        "shapes": verdict.shapes,
        "verdict": verdict.verdict,
        "reason": in_options(verdict.reason),
    }


def _fix(
    report: Report,
    robot: robots.Robot,
    verdicts: list[robots.Verdict],
    failing: frozenset[str],
    options: CheckOptions,
) -> bool:
    """Write the fixed file, tell what changed, and whether all its links are good."""
    path = options.fix
    if path is None:
        return False
    source = robots.fix(robot, verdicts, failing)
    write_bytes(path, source)
    rows, left, elsewhere = [], [], []
    for number, (link, verdict) in enumerate(zip(robot.links, verdicts, strict=True)):
        better = replacement(verdict, failing)
        if better is None:
            if verdict.verdict in failing:
                left.append((number, verdict))
            continue
        if link.rewrite is None:
            elsewhere.append(f"{verdict.name} ({verdict.file})")
            continue
        if verdict.verdict not in failing:
            origin = "its own tensor, moved inside the edge"
        else:
            origin = f"its {verdict.shapes} shape" if verdict.shapes else "the nearest tensor of a body"
        rows.append(
            {
                "link": verdict.name,
                "mass": better.mass,
                "center_of_mass_before": link.inertial.center_of_mass if link.inertial else None,
                "center_of_mass": better.center_of_mass,
                "inertia_before": link.inertial.inertia if link.inertial else None,
                "inertia": better.inertia,
                "from": origin,
                "diagonal": better.inertia.diagonal(),
            }
        )
    columns = (
        Column("link", "link"),
        Column("mass", "mass", "kg"),
        Column("center_of_mass_before", "C before", "m"),
        Column("center_of_mass", "C", "m"),
        Column("diagonal", "Ixx Iyy Izz", _UNIT),
        Column("from", "from"),
    )
    report.section("changed", Table("changed", columns, rows))
    changed = "1 link" if len(rows) == 1 else f"{len(rows)} links"
    report.notes.append(f"wrote {path}: {changed} changed, everything else as it stands")
    fixed = _parse_robot(source, str(path), robot.folder, options, robot.roots)
    packages = (*options.packages, *robot.roots)
    again = robots.check(fixed, packages, allow_outside=options.allow_outside)
    # Where what is tied to it has mass now, a frame needs none.
    unweighed = [v.name for i, v in left if v.verdict == "missing" == again[i].verdict]
    unread = [v.name for _, v in left if v.verdict == "unreadable"]
    unshaped = [v.name for _, v in left if v.verdict not in ("missing", "unreadable")]
    if unweighed:
        report.notes.append(f"left as they are: {', '.join(unweighed)}; {_WAY_OUT}")
    if unread:
        report.notes.append(f"left as they are, to be corrected by hand: {', '.join(unread)}")
    if unshaped:
        report.notes.append(
            f"left as they are, since no better values are known that engines accept: {', '.join(unshaped)}"
        )
    if elsewhere:
        report.notes.append(f"left as they are, to be fixed in their own files: {', '.join(elsewhere)}")
    return not any(verdict.verdict in failing for verdict in again)
