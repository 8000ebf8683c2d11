"""What the pages promise: each number and each "every" of a sentence stands in ``claims.toml`` with its test.

``claims.toml`` has a table for each page. A key is words of the page, its value the test that fails when they
are false. A test is named as pytest names it; ``rust/…/file.rs::name`` is one of the core.

What has to stand there:

- on all these pages a number, in digits or in a word from "eight" on, "twice", "per cent" and the like;
- on the pages of promises, which are all but the theory, also "every", "all", "any", "never", "exact".

What has not: code, which ``test_docs.py`` and ``test_commands_in_pages.py`` run; headings; formulas, unless
they are a number alone; labels of the course; years; numbers of axes, of equations and of steps. The
exercises are left to ``test_docs.py``, which runs their code, and to ``test_textbook.py``, which has random
numbers in them.
"""

from __future__ import annotations

import ast
import re
import tomllib
from functools import cache
from pathlib import Path

import pytest
from places import ROOT

CLAIMS: dict[str, dict[str, str | list[str]]] = tomllib.loads(
    (Path(__file__).parent / "claims.toml").read_text("utf-8")
)
THEORY = [
    page.relative_to(ROOT).as_posix()
    for page in sorted((ROOT / "docs" / "theory").glob("*.md"))
    if page.stem != "uncertainty"
]
PROMISES = [
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    *(
        f"docs/{name}.md"
        for name in ("index", "guides", "tutorial", "why_others_disagree", "command_line", "conventions")
    ),
]

NO_SENTENCE = re.compile(
    r"""
      ^```.*?^```$            # code, directives
    | ^\ {4}(?=\S)[^\n]*$     # a drawing in letters
    | ^\#[^\n]*$              # headings
    | ^\d+\.\ (?=\S)         # the number of an item in a list of steps
    | ^\([\w/]+\)=$           # anchors
    | (?:\{[\w:]+\})?`[^`]*`  # code within a sentence, names, formulas of one
    | (?<=\])\([^)\s]*\)      # targets of links
    | \b(?:mex|mln|msl)\d+    # labels of the course
    | \b(?:1[89]\d\d|20[0-2]\d)\b  # years
    | \bsteps?\ \d(?:\ and\ \d)? | \bStep\ \d(?=:) | \bSteps\ \d\ and\ \d
    | \bax[ei]s\ \d(?:\ and\ \d)? | \bcolumns?\ \d(?:\ and\ \d)?
    | \bequations\ [\d.]+\ to\ [\d.]+ | §[\d.]+ | \d+\s\(\d{4}\)\ \d+  # of a book, of a journal
    | [α-ω]\ [<=>]\ \d
    """,
    re.MULTILINE | re.DOTALL | re.VERBOSE,
)
FORMULA = re.compile(r"\$\$.*?\$\$|\$[^$]*\$", re.DOTALL)
NUMBER_ALONE = re.compile(r"\$-?[\d.]+(?:\\cdot\s*10)?(?:\^(?:\d|\{-?\d+\}))?(?:°|\\,)?\$")
NUMBER = re.compile(
    r"""
      (?<![\w.])(?<![A-Za-z]-)\d(?:[\d.,]*\d)?(?:e-?\d+)?
    | \b(?:eight|nine|ten|eleven|twelve|twenty|thirty|forty|fifty|sixty|seventy|eighty|ninety)\b
    | \b(?:hundreds?|thousands?|millions?|gigabytes?|twice|thrice|per\ cent|percent)\b
    | \b(?:two|three|four|five|six|seven)\ times\b
    """,
    re.VERBOSE | re.IGNORECASE,
)
PROMISE = re.compile(NUMBER.pattern + r"| \b(?:every|all|any|never|always|exact|exactly)\b", NUMBER.flags)


def blank(found: re.Match[str]) -> str:
    return re.sub(r"\S", " ", found[0])


def place(words: str) -> re.Pattern[str]:
    """The words, however the lines are broken."""
    return re.compile(r"\s+".join(re.escape(word) for word in words.split()))


def open_sentences(page: str) -> list[str]:
    """Sentences with a number that is within the words of no claim."""
    whole = (ROOT / page).read_text("utf-8")
    text = NO_SENTENCE.sub(blank, whole)
    text = FORMULA.sub(lambda found: found[0] if NUMBER_ALONE.fullmatch(found[0]) else blank(found), text)
    for words in CLAIMS.get(page, {}):
        for found in place(words).finditer(whole):
            text = text[: found.start()] + " " * (found.end() - found.start()) + text[found.end() :]
    rule = NUMBER if page in THEORY else PROMISE
    starts = [
        0,
        *(end.end() for end in re.finditer(r"[.:?;]\s+(?=\S)|\n\s*\n|\n(?=[-|])", whole)),
        len(whole),
    ]
    sentences: dict[str, None] = {}
    for found in rule.finditer(text):
        start = max(s for s in starts if s <= found.start())
        end = min(s for s in starts if s > found.start())
        sentences[f"[{found[0]}] " + " ".join(whole[start:end].split())] = None
    return list(sentences)


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


@pytest.mark.parametrize("page", [*PROMISES, *THEORY])
def test_a_sentence_with_a_number_has_its_test(page: str) -> None:
    found = open_sentences(page)
    assert not found, f"{page}: no claim of tests/pages/claims.toml holds\n" + "\n".join(found)


@pytest.mark.parametrize("page", CLAIMS)
def test_the_words_stand_on_the_page(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    assert [words for words in CLAIMS[page] if not place(words).search(text)] == []


@pytest.mark.parametrize("page", CLAIMS)
def test_the_tests_are_there(page: str) -> None:
    gone = []
    for value in CLAIMS[page].values():
        for test in [value] if isinstance(value, str) else value:
            file, _, name = test.partition("::")
            if not (ROOT / file).is_file() or name not in names_in(file):
                gone.append(test)
    assert gone == []
