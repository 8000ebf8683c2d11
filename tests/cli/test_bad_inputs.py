"""Every row of ``bad_inputs.toml``: its exit code, one line that names what is wrong, and what helps."""

from __future__ import annotations

import io
import re
import shlex
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
from command_line import one_line, run

TABLE = tomllib.loads(Path(__file__).with_name("bad_inputs.toml").read_text("utf-8"))

LEAVE_OUT = re.compile(r"leave (?:it|--[a-z-]+|one of the two) out|leave out --[a-z-]+")


def commands_in(message: str) -> set[str]:
    """Options and commands that a message names behind what it is about."""
    text = message.removeprefix("polhode: ")
    text = re.sub(r"^--[a-z-]+(?: and --[a-z-]+)?: ", "", text)
    text = re.sub(r"\(see polhode[a-z -]*--help\)", "", text)
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*|polhode [a-z]+(?= reads| judges)|gunzip", text))


def content(text: str) -> bytes:
    """The bytes of a file of the table; ``00*80`` in hexadecimal is repeated."""
    if not text.startswith("hex:"):
        return text.lstrip("\n").encode()
    words = (word.partition("*") for word in text.removeprefix("hex:").split())
    return b"".join(bytes.fromhex(word) * int(times or 1) for word, _, times in words)


def files_of(row: dict[str, Any]) -> set[str]:
    """The files of the table that the commands of a row name, and those that these files name."""
    words = " ".join([row["run"], *row.get("then", ())])
    named = {name for name in TABLE["files"] if name in words}
    inside = " ".join(TABLE["files"][name] for name in named)
    return named | {name for name in TABLE["files"] if f'"{name}"' in inside}


@pytest.fixture
def folder(row: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    here = tmp_path / "here"  # one file lies outside
    here.mkdir()
    for name in files_of(row):
        (here / name).write_bytes(content(TABLE["files"][name]))
    monkeypatch.chdir(here)
    return here


@pytest.mark.parametrize("row", TABLE["bad"], ids=lambda row: row["run"])
@pytest.mark.usefixtures("folder")
def test_row(row: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """What is refused, in which words; the options of a message stand in the commands behind it."""
    if "stdin" in row:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(row["stdin"].encode())))
    code, out, err = run(*shlex.split(row["run"]))
    assert code == row.get("code", 2)
    if code == 2:
        assert out == ""
        assert one_line(err)
    else:
        assert err == ""
    told = err or out
    assert [text for text in row["says"] if text not in told] == []
    if code == 2 and (commands_in(err) or LEAVE_OUT.search(err)):
        assert "then" in row or "not_run" in row
    if "then" in row and "stdin" not in row:  # but for the options that both leave alone
        options = {name for name in commands_in(err) if name.startswith("--")}
        done = " ".join(row["then"])
        assert not options or LEAVE_OUT.search(err) or any(name in done for name in options)


@pytest.mark.parametrize("row", [row for row in TABLE["bad"] if "then" in row], ids=lambda row: row["run"])
@pytest.mark.usefixtures("folder")
def test_what_the_message_tells_to_do_ends_well(row: dict[str, Any]) -> None:
    for command in row["then"]:
        code, out, err = run(*shlex.split(command))
        assert (code, err) == (0, ""), command
        assert out or "--output" in command


def test_the_table_is_long_and_uses_its_files() -> None:
    commands = [row["run"] for row in TABLE["bad"]]
    assert len(commands) >= 40
    assert len({(row["run"], row.get("stdin")) for row in TABLE["bad"]}) == len(commands)
    commands += [command for row in TABLE["bad"] for command in row.get("then", ())]
    words = {word for command in commands for word in shlex.split(command)}
    words |= {name for name in TABLE["files"] if any(f'"{name}"' in text for text in TABLE["files"].values())}
    assert [name for name in TABLE["files"] if name not in words] == []
    assert all(re.match(r"\w+", command) for command in commands)
