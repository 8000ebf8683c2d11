"""Who imports whom: the files of the package as a graph, its circles, and its arrows that point up.

The order of the rooms stands in ``layers.toml``, from the ground up.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from typing import NamedTuple

__all__ = ["Room", "circles", "faults", "python_graph", "rooms", "upward"]

Graph = Mapping[str, set[str]]


class Room(NamedTuple):
    """Files that belong together.

    Attributes
    ----------
    name : str
    files : tuple of str
        Patterns of names, as ``plot/*``; the first room with a pattern that fits has the file.
    uses : frozenset of str
        Rooms whose files may be imported here, besides its own.
    """

    name: str
    files: tuple[str, ...]
    uses: frozenset[str]


def rooms(table: Path, section: str) -> list[Room]:
    """Read the rooms of a language from the ground up; a room may use those below it alone."""
    given = tomllib.loads(table.read_text("utf-8"))[section]["rooms"]
    found: list[Room] = []
    for entry in given:
        below = {room.name for room in found}
        unknown = set(entry["uses"]) - below
        if unknown or entry["name"] in below:
            raise ValueError(f"{section}: {entry['name']} uses {sorted(unknown)}, which is not below it")
        found.append(Room(entry["name"], tuple(entry["files"]), frozenset(entry["uses"])))
    return found


def python_graph(root: Path) -> dict[str, set[str]]:
    """Give what every file of a package imports at run time, inside functions too, by names as ``plot/_top``.

    Imports under ``if TYPE_CHECKING:`` are for the reader. A name imported from a package that only passes it
    on counts as an import of the file where it stands.
    """
    files = {_name(path, root): path for path in sorted([*root.rglob("*.py"), *root.rglob("*.pyi")])}
    trees = {name: ast.parse(path.read_text("utf-8")) for name, path in files.items() if path.suffix == ".py"}
    passed_on = {name: dict(_passed_on(tree)) for name, tree in trees.items() if name.endswith("__init__")}
    graph: dict[str, set[str]] = {name: set() for name in files}
    for name, tree in trees.items():
        for module, word in _imports(tree):
            target = _target(module, word, root.name, files, passed_on)
            if target is not None and target != name:
                graph[name].add(target)
    return graph


def circles(graph: Graph) -> list[list[str]]:
    """Give the sets of files that reach each other, each sorted."""
    reached = {name: _reached(graph, name) for name in graph}
    found = {tuple(sorted(b for b in reached[a] if a in reached[b])) for a in graph if a in reached[a]}
    return [list(circle) for circle in sorted(found)]


def upward(graph: Graph, order: Iterable[Room]) -> list[str]:
    """Give the arrows that no room allows, and the files without a room."""
    home: dict[str, Room] = {}
    for name in graph:
        room = next((room for room in order if any(fnmatchcase(name, p) for p in room.files)), None)
        if room is not None:
            home[name] = room
    lost = [f"{name} is in no room" for name in graph if name not in home]
    return lost + [
        f"{name} ({home[name].name}) uses {other} ({home[other].name})"
        for name in graph
        for other in sorted(graph[name])
        if name in home and other in home
        if home[other].name not in {home[name].name, *home[name].uses}
    ]


def faults(graph: Graph, order: list[Room]) -> list[str]:
    """Give all that is wrong: circles, arrows upward, and rooms without a file."""
    empty = [
        f"the room {room.name} has no file"
        for room in order
        if not any(fnmatchcase(name, pattern) for name in graph for pattern in room.files)
    ]
    around = [f"a circle: {' - '.join(circle)}" for circle in circles(graph)]
    return around + upward(graph, order) + empty


def _name(path: Path, root: Path) -> str:
    return path.relative_to(root).with_suffix("").as_posix()


def _reached(graph: Graph, start: str) -> set[str]:
    seen: set[str] = set()
    waiting = list(graph[start])
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            waiting += graph[name]
    return seen


def _imports(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """Give the module and the name of every import that is carried out; of a whole module no name."""
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and _is_type_checking(node.test):
            waiting += node.orelse
            continue
        if (
            isinstance(node, ast.If)
            and isinstance(node.test, ast.UnaryOp)
            and _is_type_checking(node.test.operand)
        ):
            waiting += node.body
            continue
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.module or "", alias.name) for alias in node.names)
        elif isinstance(node, ast.Call) and _callee(node) in ("import_module", "__import__"):
            yield from ((str(word.value), "") for word in node.args[:1] if isinstance(word, ast.Constant))
        waiting += ast.iter_child_nodes(node)


def _passed_on(tree: ast.Module) -> Iterator[tuple[str, tuple[str, str]]]:
    """Give the names that a package passes on, and from where: what it imports, for the reader too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            yield from ((alias.asname or alias.name, (node.module or "", alias.name)) for alias in node.names)


def _target(
    module: str,
    word: str,
    package: str,
    files: Mapping[str, Path],
    passed_on: Mapping[str, Mapping[str, tuple[str, str]]],
) -> str | None:
    """Find the file that an import leads to; None outside the package."""
    if module != package and not module.startswith(f"{package}."):
        return None
    place = module.removeprefix(package).lstrip(".").replace(".", "/")
    inside = f"{place}/{word}".lstrip("/")
    for name in (inside, f"{inside}/__init__") if word else ():
        if name in files:
            return name
    door = f"{place}/__init__".lstrip("/")
    if door in files:
        further = passed_on.get(door, {}).get(word)
        return _target(*further, package, files, passed_on) if further not in (None, (module, word)) else door
    return place if place in files else None


def _is_type_checking(test: ast.AST) -> bool:
    return getattr(test, "id", getattr(test, "attr", "")) == "TYPE_CHECKING"


def _callee(call: ast.Call) -> str:
    return str(getattr(call.func, "id", getattr(call.func, "attr", "")))
