"""Which file of a Rust crate uses which: names are followed to the file that defines them.

A name that a module only hands on (``pub use``) belongs to the file that defines it, so that a ``mod.rs``
that declares and hands on has no arrows of its own. Comments, strings and what stands under ``#[cfg(test)]``
are not read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatchcase as fnmatch
from pathlib import Path
from typing import Any

__all__ = ["Crate", "circles", "first_item", "out_of_order", "strings", "upward"]

_IGNORED = re.compile(
    r"""//[^\n]*                              # comment to the end of the line
    | /\*(?:[^*]|\*(?!/))*\*/                 # comment
    | \bb?r(?P<hashes>\#*)".*?"(?P=hashes)    # raw string
    | \bb?"(?:[^"\\]|\\.)*"                   # string with a prefix
    | "(?:[^"\\]|\\.)*"                       # string
    | b?'(?:[^'\\\n]|\\[^u]|\\u\{\w+\}|\\x\w\w)'   # character, no lifetime
    """,
    re.VERBOSE | re.DOTALL,
)
_UNTESTED = re.compile(r"#\[cfg\((?:test|doctest)\)\]")
_RESTRICTED = re.compile(r"\bpub\s*\([^()]*\)")
_ITEM = re.compile(
    r"\b(?:macro_rules!\s*|(?:fn|struct|enum|trait|type|static|union|mod)\s+|const\s+(?!fn\b|unsafe\b))"
    r"(?:mut\s+)?([A-Za-z_]\w*)"
)
#: The functions that a macro declares: attributes have no words here any more.
_SHAPE = re.compile(r"\bshape_function!\s*\{(?:\s|#\[[^\]]*\])*([a-z_]\w*)\s*\(")
_USE = re.compile(r"(\bpub\s+)?\buse\s+([^;]+);")
_DECLARATION = re.compile(r"(?:\bpub\b\s*(?:\([^()]*\)\s*)?)?\b(?:mod\s+(?:r#)?\w+|use\s[^;]+)\s*;")
_ATTRIBUTE = re.compile(r"#\s*!?\s*\[")
_INLINE_MODULE = re.compile(r"\bmod\s+(\w+)\s*\{")
_PATH = re.compile(r"(?<![\w:.])[A-Za-z_]\w*(?:\s*::\s*[A-Za-z_]\w*)+")


def _blank(text: str, start: int, end: int) -> str:
    """The text with spaces in a place, its lines as many as before."""
    return text[:start] + re.sub(r"[^\n]", " ", text[start:end]) + text[end:]


def _closing(text: str, opening: int) -> int:
    """The place after the bracket that closes the one at ``opening``."""
    pairs = {"{": "}", "[": "]", "(": ")"}
    depth = 0
    for place in range(opening, len(text)):
        if text[place] in pairs:
            depth += 1
        elif text[place] in pairs.values():
            depth -= 1
            if depth == 0:
                return place + 1
    return len(text)


def _without_tests(text: str, bare: str) -> str:
    """The text without what stands under ``#[cfg(test)]``, found in the text without comments and strings."""
    while found := _UNTESTED.search(bare):
        place = found.end()
        while bare[place:].lstrip().startswith("#["):  # further attributes
            place = _closing(bare, bare.index("[", place))
        end = next((i for i in range(place, len(bare)) if bare[i] in ";{"), len(bare))
        end = _closing(bare, end) if bare[end : end + 1] == "{" else end + 1
        text, bare = _blank(text, found.start(), end), _blank(bare, found.start(), end)
    return text


def _bare(text: str) -> str:
    """The text with spaces for comments and strings, every other letter at its place."""
    return _IGNORED.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


def code(text: str) -> str:
    """The text without comments, strings, tests and the scope of ``pub(…)``."""
    bare = _bare(text)
    return _RESTRICTED.sub(lambda found: "pub".ljust(len(found.group())), _without_tests(bare, bare))


def strings(text: str) -> list[str]:
    """What stands in quotation marks outside of comments and tests, lines that are continued as one."""
    text = _without_tests(text, _bare(text))
    found = (match.group() for match in _IGNORED.finditer(text))
    return [re.sub(r"\\\n\s*", "", word) for word in found if re.match(r"b?r?#*\"", word)]


def first_item(text: str) -> tuple[int, str] | None:
    """The first thing in a file that is more than a declaration: its line, from one on, and its text.

    Declarations are ``mod x;`` and ``use x;``, with attributes and scopes. None where there are only such.
    """
    bare = _bare(text)
    place = 0
    while place < len(bare):
        if bare[place].isspace():
            place += 1
        elif found := _ATTRIBUTE.match(bare, place):
            place = _closing(bare, found.end() - 1)
        elif found := _DECLARATION.match(bare, place):
            place = found.end()
        else:
            return text.count("\n", 0, place) + 1, text[place:].partition("\n")[0].strip()
    return None


def imports(tree: str) -> Iterator[tuple[str, list[str]]]:
    """Each name that a ``use`` brings in, with the path it stands for; ``*`` for all names of a module."""
    tree = tree.strip()
    if tree.endswith("}"):
        head, _, rest = tree.partition("{")
        depth, start = 0, 0
        inner = rest[:-1] + ","
        for place, letter in enumerate(inner):
            depth += (letter == "{") - (letter == "}")
            if letter == "," and depth == 0:
                if inner[start:place].strip():
                    yield from imports(head + inner[start:place].strip())
                start = place + 1
        return
    path, _, alias = tree.partition(" as ")
    segments = [segment.strip() for segment in path.split("::") if segment.strip()]
    if segments[-1] == "self" and len(segments) > 1:
        segments.pop()
    yield (alias.strip() or segments[-1]), segments


@dataclass
class Module:
    """A module: the file it stands in, what it defines, and what it brings in from elsewhere."""

    file: str
    parent: Module | None
    children: dict[str, Module] = field(default_factory=dict)
    items: set[str] = field(default_factory=set)
    names: dict[str, list[str]] = field(default_factory=dict)
    whole: list[list[str]] = field(default_factory=list)
    handed_on: set[str] = field(default_factory=set)
    body: str = ""

    def root(self) -> Module:
        return self if self.parent is None else self.parent.root()


class Crate:
    """The files of a crate and the arrows between them."""

    def __init__(self, source: Path) -> None:
        self.source = source
        self.unknown: list[str] = []
        self.files: list[str] = []
        self.root = self._file(source / "lib.rs", source, None)
        self.arrows: dict[str, dict[str, str]] = {file: {} for file in self.files}
        for module in self._modules(self.root):
            self._draw(module)

    def _file(self, path: Path, folder: Path, parent: Module | None) -> Module:
        """The module of a file; ``folder`` holds those it declares."""
        name = path.relative_to(self.source).as_posix()
        self.files.append(name)
        module = Module(name, parent)
        self._fill(module, code(path.read_text("utf-8")), folder)
        return module

    def _fill(self, module: Module, text: str, folder: Path) -> None:
        while found := _INLINE_MODULE.search(text):
            end = _closing(text, found.end() - 1)
            inner = Module(module.file, module)
            module.children[found.group(1)] = inner
            self._fill(inner, text[found.end() : end - 1], folder / found.group(1))
            text = _blank(text, found.start(), end)
        for found in _USE.finditer(text):
            for name, segments in imports(found.group(2)):
                if name == "*":
                    module.whole.append(segments[:-1])
                elif name != "_":
                    module.names[name] = segments
                    if found.group(1):
                        module.handed_on.add(name)
        module.body = _USE.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)
        outside, place = [], 0
        for brace in re.finditer(r"\{", module.body):
            if brace.start() >= place:
                outside.append(module.body[place : brace.start()])
                place = _closing(module.body, brace.start())
        outside.append(module.body[place:])
        module.items = {*_ITEM.findall(" ".join(outside)), *_SHAPE.findall(module.body)}
        for name in re.findall(r"\bmod\s+(\w+)\s*;", module.body):
            for path in (folder / f"{name}.rs", folder / name / "mod.rs"):
                if path.exists():
                    module.children[name] = self._file(path, folder / name, module)

    def _modules(self, module: Module) -> Iterator[Module]:
        yield module
        for child in module.children.values():
            yield from self._modules(child)

    def _draw(self, module: Module) -> None:
        words = set(re.findall(r"\w+", module.body))
        for name, segments in module.names.items():
            if name not in module.handed_on or name in words:
                self._arrow(module, segments)
        for segments in module.whole:
            there = self._find(module, segments)
            if isinstance(there, Module):
                for name in words & (there.items | set(there.names)):
                    self._arrow(module, [*segments, name])
        for found in _PATH.finditer(module.body):
            self._arrow(module, re.split(r"\s*::\s*", found.group()))

    def _arrow(self, module: Module, segments: list[str]) -> None:
        found = self._find(module, segments)
        if found is None:
            if segments[0] in ("crate", "super", "self"):
                self.unknown.append(f"{module.file}: {'::'.join(segments)}")
        elif isinstance(found, str) and found != module.file:
            self.arrows[module.file].setdefault(found, "::".join(segments))

    def _find(
        self, module: Module, segments: list[str], seen: frozenset[tuple[int, str]] = frozenset()
    ) -> Module | str | None:
        """What a path means in a module: the file that defines it, or a module; None for what is foreign."""
        here: Module | None = module
        for place, segment in enumerate(segments):
            if here is None:
                return None
            if segment == "crate":
                here = module.root()
            elif segment == "super":
                here = here.parent
            elif segment == "self":
                continue
            elif segment in here.children:
                here = here.children[segment]
            elif segment in here.items:
                return here.file
            elif (id(here), segment) in seen:
                return None
            else:
                further = seen | {(id(here), segment)}
                rest = segments[place + 1 :]
                if segment in here.names:
                    if here.names[segment] == [segment]:
                        return None  # a crate by its own name
                    return self._find(here, here.names[segment] + rest, further)
                for whole in here.whole:
                    there = self._find(here, whole, further)
                    if isinstance(there, Module):
                        found = self._find(there, [segment, *rest], further)
                        if found is not None:
                            return found
                return None
        return here


def circles(arrows: dict[str, dict[str, str]]) -> list[list[str]]:
    """The groups of files each of which leads to every other of its group."""

    def reached(start: str) -> set[str]:
        found: set[str] = set()
        waiting = [start]
        while waiting:
            for file in arrows[waiting.pop()]:
                if file not in found:
                    found.add(file)
                    waiting.append(file)
        return found

    leads_to = {file: reached(file) for file in arrows}
    groups = {
        tuple(sorted(other for other in leads_to[file] if file in leads_to[other]))
        for file in arrows
        if file in leads_to[file]
    }
    return [list(group) for group in sorted(groups)]


def room_of(file: str, rooms: list[dict[str, Any]]) -> str | None:
    """The room of a file: the first with a pattern that fits its path without the ending."""
    path = file.removesuffix(".rs")
    return next((room["name"] for room in rooms if any(fnmatch(path, fit) for fit in room["files"])), None)


def out_of_order(crate: Crate, rooms: list[dict[str, Any]]) -> list[str]:
    """What breaks the order of the rooms: files without a room, and arrows to rooms that may not be used."""
    faults = [f"{file} is in no room" for file in crate.files if room_of(file, rooms) is None]
    uses = {room["name"]: {room["name"], *room["uses"]} for room in rooms}
    for file, targets in crate.arrows.items():
        here = room_of(file, rooms)
        for target, path in targets.items():
            there = room_of(target, rooms)
            if here is not None and there is not None and there not in uses[here]:
                faults.append(f"{file} ({here}) uses {path} of {target} ({there})")
    return faults


def upward(rooms: list[dict[str, Any]]) -> list[str]:
    """Rooms that name one which does not stand before them."""
    names = [room["name"] for room in rooms]
    return [
        f"{room['name']} uses {other}"
        for place, room in enumerate(rooms)
        for other in room["uses"]
        if other not in names[:place]
    ]
