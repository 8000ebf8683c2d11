"""Every command that the README and the pages show, run as written, in their order, in an empty folder."""

from __future__ import annotations

import itertools
import re
import shlex
from pathlib import Path

import pytest
from command_line import run
from markdown_code import blocks, pages_of
from places import ROOT

PAGES = [ROOT / "README.md", *pages_of(ROOT / "docs")]
PICTURE = re.compile(r"^[^>]* --save \w+\.png$")
"""A command whose only file is a picture, which no other command reads: drawn for the first page with it."""
LANGUAGES = {
    "python",
    "text",
    "console",
    "sh",
    "bash",
    "toml",
    "yaml",
    "{toctree}",
    "{eval-rst}",
    "{literalinclude}",
}


def commands(page: Path) -> list[str]:
    """What stands behind a ``$`` in the console blocks of a page, and each line of those of ``sh``."""
    return [
        line.removeprefix("$ ").partition("  #")[0].strip()
        for language, code in blocks(page)
        if language in {"console", "sh"}
        for line in code.splitlines()
        if line.startswith("$ ") or language == "sh"
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_every_block_is_run_or_says_why_not(page: Path) -> None:
    """Python runs, with what it prints; commands run; ``bash``, ``toml``, ``yaml``: what tests cannot do."""
    for language, code in blocks(page):
        assert language.split(" ")[0] in LANGUAGES, language
        if language == "bash":
            assert code.startswith("#"), f"why is this not run?\n{code}"


@pytest.mark.parametrize("page", [p for p in PAGES if commands(p)], ids=lambda p: p.name)
def test_commands_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    before = {command for other in PAGES[: PAGES.index(page)] for command in commands(other)}
    for command in commands(page):
        if command in before and PICTURE.search(command):
            continue
        name, *arguments = shlex.split(command)
        if name == "make":
            assert set(arguments) <= set(targets)  # `.ci/run` runs them
            continue
        if name == ".":
            assert arguments == [".venv/bin/activate"]
            continue
        assert name == "polhode"
        code, out, err = run(*arguments)
        # The robot holds a placeholder, which is fixed or accepted.
        is_bad = arguments[0] == "check" and not {"--fix", "--baseline"} & set(arguments)
        assert (code, err) == (1 if is_bad else 0, "")
        assert out or "--output" in arguments
        for option, value in itertools.pairwise(arguments):
            if option in {"--output", "--fix", "--save"}:
                assert Path(value).stat().st_size > 0
