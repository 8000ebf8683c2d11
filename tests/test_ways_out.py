"""Every refusal of a reader, a robot's check, an assembly or a command names the way out.

``test_bad_inputs.py`` runs the refusals of the command line and what they tell to do; here the sources are
read, so that a new ``raise`` without a way out fails.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import NamedTuple

import polhode
import pytest
from ways_out import names_way_out

SOURCES = Path(polhode.__file__).parent
ROOMS = ("files", "robots", "cli", "assembly")
MODULES = ("_printed", "_quantities", "_snippets", "units", "molecules", "_nuclides", "_bonds", "_extras")


class Handed(NamedTuple):
    """Refusals without a way out of their own: who hands them on, and with which words."""

    kind: str
    by: str
    words: str


HANDED_ON = {
    "files/ascii_stl.py": Handed(
        "ValueError", "files/ascii_stl.py", 'with_way_out(error, "export it again")'
    ),
    "files/cad_moments.py": Handed("ValueError", "files/cad_file.py", "{error}; export it again"),
    "files/collada.py": Handed("_FaultError", "files/collada.py", "with_way_out(fault, 'export it again')"),
    "files/gltf.py": Handed("ValueError", "files/gltf.py", 'with_way_out(reason[:200], "export it again")'),
    "files/molecule_files.py": Handed("_FaultError", "files/molecule_files.py", "with_way_out(error, "),
    "files/plates.py": Handed("ValueError", "files/plates.py", "{error}; is it cut short?"),
    "files/promises.py": Handed(
        "ValueError", "files/by_trimesh.py", 'with_way_out(error, "export it again")'
    ),
    "files/three_mf.py": Handed("_FaultError", "files/three_mf.py", "{error}; export it again"),
}
HANDING_ON = (
    "{error}",
    "{*error.args}",
    "{fault}",
    "{way_out}",
    "{reason}",
    "{_WAY_OUT}",
    "{both}",
    "{what}",
    "{words}",
    "{problem}",
    "{hint}",
    "{MODES}",
    "{words_of(error)}",
)
"""Ends of messages that hand on those of others, which are checked where they are made."""
EXCEPTIONS = {
    "module {__name__} has no attribute {name}": "Python's own words, which tools expect",
    "{scope.where}: {key}: {unknown(str(key), known)}": "`unknown` asks for the nearest key or names all",
}


class Refusal(NamedTuple):
    """One `raise`, its words with what is put in between braces."""

    file: str
    line: int
    kind: str
    words: str


def words_of(node: ast.expr) -> str:
    match node:
        case ast.Constant(value=value):
            return str(value)
        case ast.JoinedStr(values=values):
            return "".join(words_of(part) for part in values)
        case ast.FormattedValue(value=value):
            return f"{{{ast.unparse(value)}}}"
        case ast.BinOp(left=left, right=right):
            return words_of(left) + words_of(right)
    return f"{{{ast.unparse(node)}}}"


def refusals(path: Path) -> list[Refusal]:
    name = path.relative_to(SOURCES).as_posix()
    tree = list(ast.walk(ast.parse(path.read_text("utf-8"))))
    named = {  # texts that have a name before they are the words of an error
        node.targets[0].id: words_of(node.value)
        for node in tree
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
        if isinstance(node.value, ast.JoinedStr | ast.Constant)
    }
    found = []
    for node in tree:
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("Error") and node.args:
            words = " ".join(words_of(argument) for argument in node.args)
            words = re.sub(r"\{(\w+)\}", lambda put_in: named.get(put_in[1], put_in[0]), words)
            found.append(Refusal(name, node.lineno, ast.unparse(node.func), words))
    return found


FILES = [path for room in ROOMS for path in sorted((SOURCES / room).rglob("*.py"))]
FILES += [SOURCES / f"{name}.py" for name in MODULES]


def lacks(refusal: Refusal) -> bool:
    handed = HANDED_ON.get(refusal.file)
    return not (
        names_way_out(refusal.words)
        or refusal.words.endswith(HANDING_ON)
        or refusal.words in EXCEPTIONS
        or (handed is not None and handed.kind == refusal.kind)
    )


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(SOURCES).as_posix())
def test_refusals_of_a_file(path: Path) -> None:
    assert [refusal for refusal in refusals(path) if lacks(refusal)] == []


def test_what_is_handed_on_gets_its_way_out_there() -> None:
    for file, handed in HANDED_ON.items():
        assert any(refusal.kind == handed.kind for refusal in refusals(SOURCES / file))
        assert handed.words in (SOURCES / handed.by).read_text("utf-8")


def test_the_walk_sees_a_refusal_without_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"{__name__}.SOURCES", tmp_path)
    path = tmp_path / "new.py"
    path.write_text(
        'raise PolhodeError(f"{name}: " "is odd")\nraise ValueError(f"{name}: is odd; leave it out")\n'
    )
    first, second = refusals(path)
    assert first == Refusal("new.py", 1, "PolhodeError", "{name}: is odd")
    assert lacks(first)
    assert not lacks(second)
