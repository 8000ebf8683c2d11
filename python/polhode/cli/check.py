"""``polhode check``: a verdict on the inertia of every link of a robot, and a file with better values."""

from __future__ import annotations

import re
import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polhode import robots
from polhode._format import Note
from polhode.cli.baseline import Baseline
from polhode.cli.files import STDIN, check_outputs, label
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.sarif import Checked, finding_lines, sarif_text
from polhode.cli.terminal import in_options, write
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import files_read
from polhode.io.writing import write_bytes
from polhode.robots import NO_ROBOT
from polhode.robots.findings import findings
from polhode.robots.geometry import HULL, LOST
from polhode.robots.macros import EXPANDED
from polhode.robots.sources import read_stream
from polhode.robots.verdict import has_own_tensor, is_without_mass, replacement
from polhode.units import quantity

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from rich.console import Console

    from polhode.cli.options import CheckOptions

__all__ = ["check_files"]

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


class Fleet(Report):
    """The reports of several robots, one after the other, and what they say together."""

    def __init__(self, reports: Sequence[Report], summary: str, *, is_good: bool) -> None:
        super().__init__()
        self._reports, self._summary, self._is_good = reports, summary, is_good

    def as_dict(self) -> dict[str, Any]:
        """Return the reports in a list, and the verdict on all of them."""
        return {
            "robots": [report.as_dict() for report in self._reports],
            "verdict": "good" if self._is_good else "bad",
            "summary": self._summary,
        }

    def print(self, console: Console) -> None:
        """Print the tables, and the line that sums them up."""
        for report in self._reports:
            report.print(console)
            write(console)
        write(console, f"  {self._summary}")


def check_files(files: Sequence[Path], options: CheckOptions, form: str) -> tuple[Report | str, bool]:
    """Judge robots.

    Parameters
    ----------
    files : sequence of pathlib.Path
    options : CheckOptions
    form : {"table", "json", "lines", "sarif"}

    Returns
    -------
    report : Report or str
        Text where the form is lines or SARIF.
    is_good : bool
    """
    if options.fix is not None and len(files) != 1:
        raise PolhodeError(f"--fix: it writes a copy of one robot, and {len(files)} were named; name one")
    baseline = _baseline(options)
    found = _check_each(files, options, baseline)
    if options.accept and baseline is not None:
        baseline = _accept(baseline, [each for _, each in found])
        found = _check_each(files, options, baseline)
        count = "1 finding" if len(baseline.accepted) == 1 else f"{len(baseline.accepted)} findings"
        for report, _ in found[-1:]:
            report.notes.append(f"wrote {baseline.path}, which accepts {count}")
    reports, checked = [report for report, _ in found], [each for _, each in found]
    others = len(files) - len(found)
    is_good = all(each.is_good for each in checked)
    if form == "sarif":
        return sarif_text(checked, int(not is_good)), is_good
    whole = _sum_up(checked, others, is_good=is_good)
    if form == "lines":
        lines = [line for each in checked for line in finding_lines(each)]
        return "\n".join(lines if len(checked) == len(files) == 1 else [*lines, whole]), is_good
    return (
        reports[0] if len(reports) == len(files) == 1 else Fleet(reports, whole, is_good=is_good)
    ), is_good


def _check_each(
    files: Sequence[Path], options: CheckOptions, baseline: Baseline | None
) -> list[tuple[Report, Checked]]:
    """Judge and report each file; pass over those that are no robots, where that is asked for."""
    found: list[tuple[Report, Checked]] = []
    for file in files:
        try:
            found.append(_check_one(file, options, baseline))
        except FileFormatError as error:
            if not (options.only_robots and error.kind == NO_ROBOT):
                raise
    return found


def _accept(baseline: Baseline, checked: Sequence[Checked]) -> Baseline:
    """Write what fails into the baseline, in place of what it held of the same files."""
    places = [path for each in checked for path in (each.file, *each.robot.files.values())]
    pairs = [pair for each in checked for pair in zip(each.keys, each.findings, strict=True)]
    renewed = baseline.renew(places, [key for key, finding in pairs if finding.fails])
    renewed.write()
    return renewed


def _sum_up(checked: Sequence[Checked], others: int, *, is_good: bool) -> str:
    bad = [each for each in checked if not each.is_good]
    robots_of = "1 robot" if len(checked) == 1 else f"{len(checked)} robots"
    names = f": {_some([str(each.file) for each in bad])}" if bad else ""
    told = f"{'good' if is_good else 'bad'}: {len(bad)} of {robots_of} failed{names}"
    return f"{told}; files that are no robots: {others}" if others else told


def _baseline(options: CheckOptions) -> Baseline | None:
    if options.baseline is None:
        if options.accept:
            raise PolhodeError("--accept: it writes a baseline; name its file with --baseline FILE")
        return None
    if options.accept and not options.baseline.exists():
        return Baseline(options.baseline, frozenset())
    return Baseline.read(options.baseline)


def _check_one(file: Path, options: CheckOptions, baseline: Baseline | None) -> tuple[Report, Checked]:
    """Judge a robot, and fix it as asked for."""
    _check_options(options)
    filling = _filling(options)
    with files_read() as read:
        robot = _read_robot(file, options)
        verdicts = robots.check(robot, options.packages, allow_outside=options.allow_outside, **filling)
    check_outputs([("--fix", options.fix), ("--baseline", options.baseline)], read)
    if options.fix is not None and any(isinstance(n, Note) and n.kind == EXPANDED for n in robot.notes):
        raise PolhodeError(
            f"--fix: {label(file)} holds macros, which a copy would not have; expand it with "
            f"xacro {file} > out.urdf, and fix that one"
        )
    failing = robots.FAILURES | ({"suspect"} if options.strict else frozenset())
    found = [*findings(robot, verdicts, failing, Path.read_bytes)]
    known = baseline or Baseline(Path("baseline"), frozenset())
    keys = [known.key(each.path or file, each.link.own_name, each.law) for each in found]
    accepted = None if baseline is None else [key in baseline.accepted for key in keys]
    report = Report()
    report.section(
        "",
        Field("file", "file", label(file)),
        Field("format", "format", robot.format),
        Field("robot", "robot", robot.name or "(without a name)"),
    )
    passed = {id(each.link) for each, ok in zip(found, accepted or (), strict=accepted is not None) if ok}
    pairs = [*zip(robot.links, verdicts, strict=True)]
    bad = [verdict for link, verdict in pairs if verdict.verdict in failing and id(link) not in passed]
    rows = [_row(link, verdict) for link, verdict in pairs]
    report.section("links", Table("links", _COLUMNS, rows))
    words = ["good", "suspect", *(["coarse"] if any(v.verdict == "coarse" for v in verdicts) else [])]
    counts = {word: sum(v.verdict == word for v in verdicts) for word in words}
    if baseline is not None:
        counts["accepted"] = sum(verdict.verdict in failing for verdict in verdicts) - len(bad)
    summary = _summary(label(file), len(verdicts), bad, counts.get("accepted", 0))
    report.section(
        "verdict",
        Field("verdict", "verdict", "bad" if bad else "good"),
        Field("count.links", "links", len(verdicts)),
        Field("count.failing", "failing", len(bad)),
        *(Field(f"count.{word}", word, count) for word, count in counts.items()),
        Field("summary", "summary", summary),
    )
    notes = dict.fromkeys(note for verdict in verdicts for note in verdict.notes)
    report.notes += [in_options(note) for note in (*robot.notes, *_group_notes(notes))]
    if filling and not any(is_without_mass(*pair) for pair in pairs):
        report.notes.append(f"--{next(iter(filling))} has no effect: no failing link is without mass")
    report.notes += _warnings(robot, verdicts, failing)
    is_good = not bad
    if options.fix is None:
        if any(verdict.better is not None for verdict in bad):
            report.notes.append("--fix FILE writes better values into a copy")
        elif any(verdict.inside is not None for verdict in verdicts):
            report.notes.append("--fix FILE moves tensors on the edge inside, in a copy")
        if any(verdict.verdict == "missing" and verdict.better is None for verdict in bad):
            report.notes.append(_WAY_OUT)
    else:
        is_good = _fix(report, robot, verdicts, failing, options, passed)
    checked = Checked(file, robot, found, accepted, keys, [*report.notes], summary, is_good)
    return report, checked


def _summary(name: str, links: int, bad: Sequence[robots.Verdict], accepted: int) -> str:
    """Sum up a robot in one line: how many links fail, and by which laws."""
    laws = Counter(verdict.law for verdict in bad)
    listed = ", ".join(f"{count} {law}" for law, count in sorted(laws.items()))
    told = f"{name}: {'bad' if bad else 'good'}: {len(bad)} of {links} links fail"
    told += f" ({listed})" if listed else ""
    return f"{told}; the baseline accepts {accepted} more" if accepted else told


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
        outside = options.allow_outside
        return robots.read_robot(file, options.packages, allow_outside=outside, arguments=_arguments(options))
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


def _arguments(options: CheckOptions) -> dict[str, str]:
    """Return the arguments of xacro by their names."""
    found: dict[str, str] = {}
    for word in options.arguments:
        name, is_there, value = word.partition(":=")
        if not (name and is_there):
            raise PolhodeError(f"--arguments: {word!r} is no argument of xacro; write it as name:=value")
        found[name] = value
    return found


def _row(link: robots.Link, verdict: robots.Verdict) -> dict[str, Any]:
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
        "law": verdict.law,
        "macros": list(link.macros),
    }


def _fix(
    report: Report,
    robot: robots.Robot,
    verdicts: list[robots.Verdict],
    failing: frozenset[str],
    options: CheckOptions,
    accepted: Collection[int],
) -> bool:
    """Write the fixed file, tell what changed, and whether all its links are good or `accepted` by id."""
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
    pairs = zip(robot.links, again, strict=True)
    return not any(verdict.verdict in failing and id(link) not in accepted for link, verdict in pairs)
