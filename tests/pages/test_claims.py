"""Numbers on the pages that users rely on: ``claims.toml`` names the test that fails when they are false.

The table has a part for each page. A key is words of the page, its value the test or the tests. A test is
named as pytest names it; ``rust/…/file.rs::name`` is one of the core.
"""

from __future__ import annotations

import ast
import re
import tomllib
from functools import cache
from pathlib import Path

from places import ROOT

CLAIMS: dict[str, dict[str, str | list[str]]] = tomllib.loads(
    Path(__file__).with_name("claims.toml").read_text("utf-8")
)


def place(words: str) -> re.Pattern[str]:
    """The words, however the lines are broken."""
    return re.compile(r"\s+".join(re.escape(word) for word in words.split()))


@cache
def names_in(file: str) -> set[str]:
    """The tests of a file, ``Class::name`` of those in a class."""
    text = (ROOT / file).read_text("utf-8")
    if file.endswith(".rs"):
        return set(re.findall(r"#\[test\]\s+(?:#\[[^\]]*\]\s+)*fn (\w+)", text))
    names = set()
    for node in ast.parse(text).body:
        inner = node.body if isinstance(node, ast.ClassDef) else [node]
        prefix = f"{node.name}::" if isinstance(node, ast.ClassDef) else ""
        names |= {prefix + part.name for part in inner if isinstance(part, ast.FunctionDef)}
    return {name for name in names if name.rpartition("::")[2].startswith("test_")}


def test_the_words_stand_on_their_pages() -> None:
    gone = [
        f"{page}: {words}"
        for page, claims in CLAIMS.items()
        for words in claims
        if not place(words).search((ROOT / page).read_text("utf-8"))
    ]
    assert gone == []


def test_the_tests_are_there() -> None:
    gone = []
    for claims in CLAIMS.values():
        for value in claims.values():
            for test in [value] if isinstance(value, str) else value:
                file, _, name = test.partition("::")
                if not (ROOT / file).is_file() or name not in names_in(file):
                    gone.append(test)
    assert gone == []
