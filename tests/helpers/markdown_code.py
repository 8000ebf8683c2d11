"""Runs the code of a Markdown page: its blocks in one session, each beside what it says it prints."""

from __future__ import annotations

import contextlib
import doctest
import io
import re
from pathlib import Path
from typing import Any

FENCE = re.compile(r"^```([^\n`]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


MADE = ("_build", "interface", "gallery", "measured", "notebooks")
"""Folders of pages that the site makes itself."""


def pages_of(docs: Path) -> list[Path]:
    """The pages that stand in Git."""
    return sorted(page for page in docs.rglob("*.md") if not set(page.relative_to(docs).parts) & set(MADE))


def blocks(page: Path) -> list[tuple[str, str]]:
    """Language and content of every fenced block; directives such as ``{math}`` are not code."""
    return FENCE.findall(page.read_text("utf-8"))


def run_page(page: Path) -> None:
    """Run the ``python`` blocks of a page; a ``text`` block after one is what it prints."""
    names: dict[str, Any] = {"__name__": page.stem}
    found = blocks(page)
    for (language, code), (next_language, shown) in zip(found, [*found[1:], ("", "")], strict=True):
        if language in {"pycon", "python"} and ">>>" in code:
            run_examples(doctest.DocTestParser().get_doctest(code, names, page.stem, str(page), 0))
        elif language == "python":
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(code, str(page), "exec"), names)
            if next_language == "text":
                assert printed.getvalue().rstrip() == shown.rstrip()


def run_examples(examples: doctest.DocTest) -> None:
    """Run the examples of a docstring."""
    report = io.StringIO()
    options = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
    runner = doctest.DocTestRunner(optionflags=options, verbose=False)
    runner.run(examples, out=report.write)
    assert not runner.failures, report.getvalue()
