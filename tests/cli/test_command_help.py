"""The help of the commands: one word a meaning, options in groups, three examples each, 80 columns."""

from __future__ import annotations

import re
import shlex
from dataclasses import fields, is_dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from command_line import one_line, run
from polhode import samples
from polhode.cli import options
from polhode.cli.app import app
from polhode.cli.running import CHAPTERS, COMMANDS, WIDTH, unknown_option

if TYPE_CHECKING:
    from collections.abc import Iterator

#: What an option holds, and the words for it: one word a meaning, as in Python.
VOCABULARY = {
    Path: {
        "save": "where a result goes",
        "output": "where the text of the report goes",
        "fix": "where a corrected copy goes",
        "checkpoint": "where partial results are, to go on from",
        "expect": "a report to compare with",
        "baseline": "findings that are accepted",
        "tree": "a table of edges",
        "packages": "folders to look into",
        "body": "which body it is",
        "finer": "a second record to compare with",
    },
    int: {
        "n": "how many members, clones",
        "times": "how many times",
        "seed": "of random numbers",
        "depth": "how many levels",
        "chunk": "how many members together",
        "index-base": "the first number",
    },
}
#: Words for the same things that are not used.
FOREIGN = {
    "until", "tmax", "duration", "samples", "steps", "points", "members", "clones", "count", "picture",
    "plot", "dir", "center", "centre", "tensor", "origin", "reference", "quaternion", "orientation",
}  # fmt: skip
#: Options that say no more than a word of Python's.
OTHER_FIELDS = {"format": "form", "as": "program", "all": "every"}
ARGUMENTS = [
    (command, one)
    for command in COMMANDS
    for one in app[command].assemble_argument_collection(parse_docstring=True)
    if one.name.startswith("--")
]


def test_an_option_has_the_word_of_its_meaning() -> None:
    for command, one in ARGUMENTS:
        name = one.name.removeprefix("--")
        where = f"{command} {one.name}"
        if name == "center-of-mass":
            assert one.names == ("--center-of-mass", "--com"), where
            continue
        assert one.names == (one.name,), where
        assert not {name, *name.split("-")} & FOREIGN, where
        for kind, known in VOCABULARY.items():
            if re.search(rf"\b{kind.__name__}\b", str(one.hint)):
                assert name in known, where


def test_fields_are_called_as_options_are() -> None:
    names = {one.name.removeprefix("--") for _, one in ARGUMENTS}
    known = {OTHER_FIELDS.get(name, name.replace("-", "_")) for name in names}
    for owner in vars(options).values():
        if is_dataclass(owner):
            assert {one.name for one in fields(owner)} <= known, owner


def test_an_option_is_in_a_group_and_explained() -> None:
    for command, one in ARGUMENTS:
        parameter: Any = one.parameter
        (group,) = parameter.group
        assert group.name not in ("", "Parameters"), f"{command} {one.name}"
        assert parameter.help.endswith("."), f"{command} {one.name}"


@pytest.mark.parametrize(
    ("command", "old", "meant"),
    [
        ("spin", "until", "end TIME"),
        ("ensemble", "until", "end TIME"),
        ("spin", "samples", "times NUMBER"),
        ("ensemble", "samples", "times NUMBER"),
        ("ensemble", "members", "n NUMBER"),
        ("flyby", "clones", "n NUMBER"),
        ("flyby", "end", "span TIME"),
        ("ledger", "picture", "save FILE.png"),
        ("check", "save", "fix FILE"),
        ("demo", "output-dir", "save FOLDER"),
        ("report", "center", "center-of-mass"),
        ("roll", "inclination", "tilt 52deg"),
        ("roll", "incline", "slope 10deg"),
        ("roll", "disk", "surface disk"),
        ("report", "save", "output FILE"),
    ],
)
def test_other_names_lead_to_the_option(command: str, old: str, meant: str) -> None:
    code, out, err = run(command, f"--{old}", "1")
    assert (code, out) == (2, "")
    assert err == f"polhode: --{old}: {command} has no such option; did you mean --{meant}?\n"


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (("inertia", "part.stl"), "did you mean polhode report part.stl?"),
        (
            ("simulate", "--moments", "1 2 3", "--t-end", "9"),
            'did you mean polhode spin --moments "1 2 3" --end 9 --save FILE.csv?',
        ),
        (("simulate",), "did you mean polhode spin FILE --end TIME --save FILE.csv?"),
        (
            ("convert", "part.stl", "--to", "urdf"),
            "did you mean polhode report part.stl --as urdf --length-unit UNIT?",
        ),
        (
            ("compare", "a.stl", "b.stl"),
            "did you mean polhode report a.stl --expect REPORT.json? (polhode report OTHER",
        ),
        (("animate", "part.stl"), "did you mean polhode spin part.stl --end TIME --save FILE.html?"),
        (("part.stl", "--density", "7850"), "did you mean polhode report part.stl --density 7850?"),
        (("coin",), "did you mean polhode roll --surface disk"),
        (("repot", "part.stl"), "did you mean polhode report part.stl?"),
        (("spin", "--about", "0 0 1"), "did you mean polhode report?"),
        (("xyzzy",), "choose one of demo, samples, report, spin"),
    ],
)
def test_other_commands_lead_to_those_that_there_are(words: tuple[str, ...], meant: str) -> None:
    code, out, err = run(*words)
    assert (code, out) == (2, "")
    assert one_line(err)
    assert meant in err


def test_the_overview_lists_every_command() -> None:
    out = run("--help")[1]
    known = {name for name in app if not name.startswith("-")}
    assert set(COMMANDS) == known
    assert re.findall(r"^  ([a-z]+)  ", out, re.MULTILINE) == list(COMMANDS)
    assert [title for title in CHAPTERS if f"\n{title}:\n" in out] == list(CHAPTERS)
    assert max(map(len, out.splitlines())) <= WIDTH


@pytest.mark.parametrize("columns", ["60", "80", "200"])
@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_is_no_wider_than_people_read(
    command: str, columns: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    code, out, err = run(command, "--help")
    assert (code, err) == (0, "")
    assert max(map(len, out.splitlines())) <= min(int(columns), WIDTH)
    if columns != "60":
        shown = " ".join(re.sub(r"\\ *\n", " ", out).split())
        assert all(line in shown for line in examples(command))


def examples(command: str) -> list[str]:
    """The examples in the docstring of a command, each in one line."""
    document = app[command].default_command.__doc__ or ""
    lines = document.partition("Examples\n")[2].partition("\n")[2].replace("\\\n", " ").splitlines()
    return [" ".join(line.split()) for line in lines if line.strip()]


@pytest.mark.parametrize("command", COMMANDS)
def test_three_examples_run(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    samples.copy(tmp_path)
    monkeypatch.chdir(tmp_path)
    written = examples(command)
    assert len(written) == 3
    for line in written:
        name, *arguments = shlex.split(line)
        assert (name, arguments[0]) == ("polhode", command)
        assert unknown_option(arguments) is None
        code, out, err = run(*arguments)
        is_bad = command == "check" and "--fix" not in arguments  # the robot holds a placeholder
        assert (code, err) == (1 if is_bad else 0, "")
        assert out or "--output" in arguments
        for path in saved(arguments):
            assert path.exists()


def saved(arguments: list[str]) -> Iterator[Path]:
    for option, value in pairwise(arguments):
        if option in {"--save", "--fix", "--output"}:
            yield Path(value)
