"""Every row of ``bad_inputs.toml``: its exit code, and one line that names what is wrong and the way out."""

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


def content(text: str) -> bytes:
    """The bytes of a file of the table; ``00*80`` in hexadecimal is repeated."""
    if not text.startswith("hex:"):
        return text.lstrip("\n").encode()
    words = (word.partition("*") for word in text.removeprefix("hex:").split())
    return b"".join(bytes.fromhex(word) * int(times or 1) for word, _, times in words)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, text in TABLE["files"].items():
        (tmp_path / name).write_bytes(content(text))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("row", TABLE["bad"], ids=lambda row: row["run"])
@pytest.mark.usefixtures("folder")
def test_row(row: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_the_table_is_long_and_uses_its_files() -> None:
    commands = [row["run"] for row in TABLE["bad"]]
    assert len(commands) >= 40
    assert len({(row["run"], row.get("stdin")) for row in TABLE["bad"]}) == len(commands)
    words = {word for command in commands for word in shlex.split(command)}
    assert [name for name in TABLE["files"] if name not in words] == []
    assert all(re.match(r"\w+", command) for command in commands)
