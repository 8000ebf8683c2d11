"""Every command that the README and the pages show, run as written, in their order, in an empty folder."""

from __future__ import annotations

import itertools
import re
import shlex
from pathlib import Path

import pytest
from command_line import run
from markdown_code import blocks

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", *sorted(p for p in (ROOT / "docs").rglob("*.md") if "_build" not in p.parts)]


def commands(page: Path) -> list[str]:
    """What stands behind a ``$`` in the console blocks of a page."""
    return [
        line.removeprefix("$ ").partition("  #")[0].strip()
        for language, code in blocks(page)
        if language == "console"
        for line in code.splitlines()
        if line.startswith("$ ")
    ]


@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=lambda p: p.name)
def test_commands_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    for command in commands(page):
        name, *arguments = shlex.split(command)
        if name == "make":
            assert set(arguments) <= set(targets)  # `.ci/run` runs them
            continue
        if name == ".":
            assert arguments == [".venv/bin/activate"]
            continue
        assert name == "polhode"
        code, out, err = run(*arguments)
        is_bad = arguments[0] == "check" and "--fix" not in arguments  # the robot holds a placeholder
        assert (code, err) == (1 if is_bad else 0, "")
        assert out or "--output" in arguments
        for option, value in itertools.pairwise(arguments):
            if option in {"--output", "--fix", "--save"}:
                assert Path(value).stat().st_size > 0
