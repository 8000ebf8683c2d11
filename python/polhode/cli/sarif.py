"""Findings of ``polhode check`` for other programs: SARIF 2.1.0, and lines as compilers write them."""

from __future__ import annotations

import json
import os
from bisect import bisect_right
from hashlib import sha256
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple
from urllib.parse import quote

from polhode import __version__
from polhode.cli.files import STDIN
from polhode.cli.terminal import in_options, printable
from polhode.robots.findings import EDGE, LAWS, Finding

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from polhode.io.xml_source import Edit
    from polhode.robots.model import Robot

__all__ = ["Checked", "Lines", "finding_lines", "sarif_text"]

_SCHEMA: Final = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_ROOT: Final = "%SRCROOT%"
_FINGERPRINT: Final = "linkAndLaw/v1"
_LEVELS: Final = {"suspect": "warning", "coarse": "note"}


class Checked(NamedTuple):
    """A robot that was checked.

    Attributes
    ----------
    file : pathlib.Path
        As it was named.
    robot : Robot
    findings : sequence of Finding
    accepted : sequence of bool or None
        Of each finding, whether the baseline accepts it; None without a baseline.
    keys : sequence of tuple of str
        What the baseline knows each finding by.
    notes : sequence of str
        What else the report says.
    summary : str
        The outcome in one line.
    is_good : bool
    """

    file: Path
    robot: Robot
    findings: Sequence[Finding]
    accepted: Sequence[bool] | None
    keys: Sequence[tuple[str, str, str]]
    notes: Sequence[str]
    summary: str
    is_good: bool


class Lines:
    """The lines of a source, and where in them its bytes stand.

    Parameters
    ----------
    source : bytes
        In UTF-8; any other is taken as an encoding of one byte a character.
    """

    def __init__(self, source: bytes) -> None:
        self._source = source
        lengths = (len(line) + 1 for line in source.split(b"\n"))
        self._starts = [0, *accumulate(lengths)][:-1]
        try:
            source.decode("utf-8")
            self._encoding = "utf-8"
        except UnicodeDecodeError:
            self._encoding = "latin-1"

    def place(self, offset: int) -> tuple[int, int]:
        """Return the line and the column of a byte, from 1; columns count UTF-16, as editors do."""
        line = bisect_right(self._starts, offset)
        before = self._source[self._starts[line - 1] : offset]
        text = before.decode(self._encoding, "replace")
        if line == 1:
            text = text.removeprefix("\ufeff")
        return line, len(text.encode("utf-16-le")) // 2 + 1

    def region(self, start: int, end: int) -> dict[str, int]:
        """Return the region of some bytes, by lines and columns and by bytes."""
        (line, column), (end_line, end_column) = self.place(start), self.place(end)
        return {
            "startLine": line,
            "startColumn": column,
            "endLine": end_line,
            "endColumn": end_column,
            "byteOffset": start,
            "byteLength": end - start,
        }


def sarif_text(robots: Sequence[Checked], exit_code: int) -> str:
    """Write the findings as SARIF 2.1.0.

    The edits of `fixes` are those of ``--fix``: of lines of the robot's own file, and of no others.

    Parameters
    ----------
    robots : sequence of Checked
    exit_code : int
        Of the command.
    """
    rules = [_rule(law) for law in LAWS]
    results = [result for checked in robots for result in _results(checked)]
    notes = [(checked, note) for checked in robots for note in checked.notes]
    run = {
        "tool": {
            "driver": {
                "name": "polhode",
                "version": __version__,
                "semanticVersion": __version__,
                "rules": rules,
            }
        },
        "columnKind": "utf16CodeUnits",
        "originalUriBaseIds": {_ROOT: {"uri": f"{Path.cwd().as_uri().rstrip('/')}/"}},
        "artifacts": [{"location": _location(checked.file)} for checked in robots],
        "invocations": [
            {
                "executionSuccessful": True,
                "exitCode": exit_code,
                "toolExecutionNotifications": [
                    {
                        "level": "note",
                        "message": {"text": _escaped(note)},
                        "locations": [{"physicalLocation": {"artifactLocation": _location(checked.file)}}],
                    }
                    for checked, note in notes
                ],
            }
        ],
        "results": results,
    }
    return json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2)


def _rule(law: str) -> dict[str, Any]:
    rule = LAWS[law]
    title = law.replace("-", " ").capitalize()
    level = "note" if law == EDGE else "warning" if law in ("shape", "density") else "error"
    return {
        "id": law,
        "name": "".join(word.capitalize() for word in law.split("-")),
        "shortDescription": {"text": f"{title}."},
        "fullDescription": {"text": rule.says},
        "help": {
            "text": f"{rule.says} {rule.way_out}",
            "markdown": f"**{title}.** {rule.says}\n\n{rule.way_out}",
        },
        "defaultConfiguration": {"level": level},
    }


def _results(checked: Checked) -> Iterator[dict[str, Any]]:
    sources: dict[Path | None, Lines] = {None: Lines(checked.robot.source)}
    for number, finding in enumerate(checked.findings):
        link = finding.link
        file = _file_of(checked, finding)
        place: dict[str, Any] = {"artifactLocation": _location(file)}
        if finding.span is not None:
            if finding.path not in sources and finding.path is not None:
                sources[finding.path] = Lines(finding.path.read_bytes())
            place["region"] = sources[finding.path].region(*finding.span)
        logical = {"name": link.own_name or link.name, "fullyQualifiedName": link.name, "kind": "element"}
        key = checked.keys[number]
        result: dict[str, Any] = {
            "ruleId": finding.law,
            "ruleIndex": [*LAWS].index(finding.law),
            "level": _level(finding),
            "message": {"text": _escaped(_words(finding))},
            "locations": [{"physicalLocation": place, "logicalLocations": [logical]}],
            "partialFingerprints": {_FINGERPRINT: sha256("\0".join(key).encode()).hexdigest()},
            "properties": {"verdict": finding.verdict},
        }
        if finding.edits:
            result["fixes"] = [_fix(finding.edits, sources[None], checked.file)]
        if checked.accepted is not None:
            is_accepted = checked.accepted[number]
            result["baselineState"] = "unchanged" if is_accepted else "new"
            if is_accepted:
                told = "the baseline accepts it"
                result["suppressions"] = [{"kind": "external", "status": "accepted", "justification": told}]
        yield result


def _fix(edits: Iterable[Edit], lines: Lines, file: Path) -> dict[str, Any]:
    replacements = []
    for edit in edits:
        replacement: dict[str, Any] = {"deletedRegion": lines.region(edit.start, edit.end)}
        if edit.text:
            replacement["insertedContent"] = {"text": edit.text}
        replacements.append(replacement)
    change = {"artifactLocation": _location(file), "replacements": replacements}
    return {"description": {"text": "Write the numbers that --fix writes."}, "artifactChanges": [change]}


def _level(finding: Finding) -> str:
    if finding.fails:
        return "error"
    return "note" if finding.law == EDGE else _LEVELS.get(finding.verdict, "note")


def _words(finding: Finding) -> str:
    told = f"{finding.link.name}: {in_options(finding.reason)}"
    return f"{told}; it comes from {', '.join(finding.link.macros)}" if finding.link.macros else told


def _escaped(text: str) -> str:
    """Escape what messages of SARIF take for links."""
    return in_options(text).replace("\\", "\\\\").replace("[", "\\[").replace("]", "\\]")


def _file_of(checked: Checked, finding: Finding) -> Path:
    return finding.path if finding.path is not None else checked.file


def _location(file: Path) -> dict[str, Any]:
    """Name a file relative to the working directory; one elsewhere in full."""
    if file == STDIN:
        return {"uri": "stdin"}
    whole = Path(os.path.normpath(file.absolute()))
    for each in (whole, Path(os.path.realpath(whole))):
        if each.is_relative_to(Path.cwd()):
            return {"uri": quote(each.relative_to(Path.cwd()).as_posix()), "uriBaseId": _ROOT}
    return {"uri": whole.as_uri()}


def finding_lines(checked: Checked) -> Iterator[str]:
    """Write a line for each finding, as compilers do: file, line, column, level, words, law."""
    own = Lines(checked.robot.source)
    for number, finding in enumerate(checked.findings):
        if checked.accepted is not None and checked.accepted[number]:
            continue
        file = "stdin" if checked.file == STDIN else os.path.relpath(_file_of(checked, finding))
        where = f"{file}:"
        if finding.span is not None:
            lines = own if finding.path is None else Lines(finding.path.read_bytes())
            where = "{}:{}:{}:".format(file, *lines.place(finding.span[0]))
        yield printable(f"{where} {_level(finding)}: {_words(finding)} [{finding.law}]")
    yield printable(checked.summary)
