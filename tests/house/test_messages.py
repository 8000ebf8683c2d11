"""No code of the package reads a message: errors and notes are data, and become words at the door."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import TypeGuard

import pytest
from places import ROOT

PACKAGE = ROOT / "python" / "polhode"
DOORS = {
    "io/collada.py": "the words of another library are cut short",
    "io/gltf.py": "the words of another library are put on one line",
    "io/hull.py": "the words of another library are cut after their first line",
}
"""Files in which the words of an error are taken, and why."""
READS = {
    "count", "endswith", "find", "index", "lstrip", "partition", "removeprefix", "removesuffix", "replace",
    "rfind", "rpartition", "rsplit", "rstrip", "split", "splitlines", "startswith", "strip",
}  # fmt: skip
SEARCHES = {"match", "search", "fullmatch", "sub", "subn", "split", "findall", "finditer"}


NOTES = ("note", "error", "fault", "warning")
"""Names of variables of loops that go through messages."""
OTHERS = {"OSError", "UnicodeDecodeError", "Exception"}
"""Errors of other libraries, whose words are all that they tell."""


def readers(tree: ast.AST) -> Iterator[int]:
    """Find where the words of an error that was caught, or of notes, are searched, matched or replaced."""
    for node in ast.walk(tree):
        name, scope = "", node
        if isinstance(node, ast.ExceptHandler) and node.name and node.type is not None:
            kinds = {each.id for each in ast.walk(node.type) if isinstance(each, ast.Name)}
            name = "" if kinds <= OTHERS else node.name
        elif isinstance(node, ast.For | ast.comprehension) and isinstance(node.target, ast.Name):
            name = node.target.id if node.target.id in NOTES else ""
            scope = node if isinstance(node, ast.For) else tree
        if name:
            names = [name, *others_of(scope, name)]
            yield from (
                inner.lineno
                for inner in ast.walk(scope)
                if isinstance(inner, ast.expr) and any(reads(inner, each) for each in names)
            )


def others_of(scope: ast.AST, name: str) -> Iterator[str]:
    """Find the other names that the words of an error are given, as in ``text = str(error)``."""
    for node in ast.walk(scope):
        if isinstance(node, ast.Assign) and is_words(node.value, name):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))


def reads(node: ast.AST, name: str) -> bool:
    """Whether a node takes something out of the words of the error or note of this name."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        if node.func.attr in READS and is_words(node.func.value, name):
            return True
        return node.func.attr in SEARCHES and any(is_words(part, name) for part in node.args)
    if isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn | ast.Eq | ast.NotEq):
        return any(is_words(part, name) for part in (node.left, *node.comparators))
    return isinstance(node, ast.Subscript) and is_words(node.value, name)


def is_words(node: ast.AST, name: str) -> bool:
    """Whether an expression is this error in words: its name, ``str(error)`` or ``error.args[0]``."""
    if isinstance(node, ast.Name):
        return node.id == name
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "str":
        return any(is_words(part, name) for part in node.args)
    return isinstance(node, ast.Subscript) and is_pieces(node.value) and is_words(node.value.value, name)


def is_pieces(node: ast.AST) -> TypeGuard[ast.Attribute]:
    """Whether an expression is the pieces of a message."""
    return isinstance(node, ast.Attribute) and node.attr == "args"


def test_no_code_reads_a_message() -> None:
    found = {}
    for path in PACKAGE.rglob("*.py"):
        lines = sorted(set(readers(ast.parse(path.read_text("utf-8")))))
        if lines:
            found[path.relative_to(PACKAGE).as_posix()] = lines
    assert {name: lines for name, lines in found.items() if name not in DOORS} == {}
    assert found.keys() == DOORS.keys()


@pytest.mark.parametrize(
    "line",
    [
        "if 'read-only' in str(error): pass",
        "if str(error).startswith('row'): pass",
        "re.match('row', str(error))",
        "error.args = (str(error).replace('a', 'b'),)",
        "if error.args[0] == 'no': pass",
        "text = str(error); found = text.startswith('row')",
    ],
)
def test_what_reads_is_found(line: str) -> None:
    code = f"try:\n    f()\nexcept ValueError as error:\n    {line}\n    raise\n"
    assert list(readers(ast.parse(code))) != []
    assert list(readers(ast.parse("for note in notes:\n    if note.endswith('found'): pass"))) != []
    assert list(readers(ast.parse(code.replace(line, "error.args = ('row 1: ', *error.args)")))) == []
