"""Expand the macros of xacro, and tell of each link which file and which macro calls it comes from."""

from __future__ import annotations

import io
import os
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from polhode._format import Note
from polhode._optional import require
from polhode.errors import FileFormatError
from polhode.io.xml_source import parse_xml
from polhode.robots.sources import read_source

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from polhode.io.xml_source import Element
    from polhode.robots.model import Link, Robot
    from polhode.robots.sources import Addresses

__all__ = ["EXPANDED", "Expansion", "expand", "has_macros"]

EXPANDED: Final = "expanded"
"""Kind of the note that tells of an expansion."""
_PREFIX: Final = "xacro:"
_PLACE: Final = "polhode place"
_CALLS: Final = "polhode calls"


def has_macros(root: Element) -> str:
    """Return the tag of the first element of xacro; "" if there is none."""
    waiting = [root]
    while waiting:
        element = waiting.pop()
        if element.tag.startswith(_PREFIX):
            return element.tag
        waiting += reversed(element.children)
    return ""


class Origin(NamedTuple):
    """Where a link stands in the files of xacro, and the macro calls that made it, from the outermost."""

    file: str
    path: Path
    element: Element
    calls: tuple[str, ...]


class Expansion(NamedTuple):
    """The XML that xacro makes, and the origin of each link of URDF, in its order; None: not known."""

    source: bytes
    origins: tuple[Origin | None, ...]

    def trace(self, robot: Robot, name: str) -> Robot:
        """Put the files of xacro in the place of the expanded one, in which nobody works."""
        origins = self.origins if len(self.origins) == len(robot.links) else (None,) * len(robot.links)
        links = tuple(_from(link, origin) for link, origin in zip(robot.links, origins, strict=True))
        files = {origin.file: origin.path for origin in origins if origin is not None}
        note = Note(
            f"{name} was expanded with xacro: the lines that are told of shapes are those of the result, and "
            f"--fix serves only a file that is expanded already (xacro {name} > out.urdf)",
            kind=EXPANDED,
        )
        return replace(robot, links=links, files={**robot.files, **files}, notes=(note, *robot.notes))


def _from(link: Link, origin: Origin | None) -> Link:
    if origin is None:
        return replace(link, rewrite=None, element=None)
    line = origin.element.line
    return replace(
        link, rewrite=None, element=origin.element, file=origin.file, line=line, macros=origin.calls
    )


class _Keeper:
    """Hands what is known of a node on to its copies."""

    def handle(self, _: int, key: str, data: object, __: Any, copy: Any) -> None:
        if copy is not None:
            copy.setUserData(key, data, self)


def expand(
    path: Path, addresses: Addresses, arguments: Mapping[str, str], names: Callable[[Path], str]
) -> Expansion:
    """Expand a file.

    Parameters
    ----------
    path : pathlib.Path
    addresses : Addresses
        Finds the packages of ``$(find NAME)``, before those that xacro finds itself.
    arguments : mapping of str to str
        Values of ``<xacro:arg>``.
    names : callable
        Names a file as messages do.

    Raises
    ------
    ModuleNotFoundError
        Without xacro.
    FileFormatError
        If xacro refuses the file.
    """
    xacro: Any = require("xacro", extra="xacro", purpose=f"expanding the macros of {path}")
    told = io.StringIO()
    try:
        with redirect_stderr(told), redirect_stdout(told), _tracing(xacro, path, addresses, names):
            document = xacro.process_file(os.path.realpath(path), mappings=dict(arguments))
    except FileFormatError:
        raise
    except Exception as error:  # of whatever an expression in the file does
        said = " ".join(str(error).split()) or type(error).__name__
        raise FileFormatError(f"{path}: xacro refuses it: {said}; correct it, or name its packages") from None
    root = document.documentElement
    links = [node for node in root.childNodes if getattr(node, "tagName", "") == "link"]
    return Expansion(
        document.toprettyxml(indent="  ", encoding="utf-8"), tuple(_origin(link, names) for link in links)
    )


def _origin(link: Any, names: Callable[[Path], str]) -> Origin | None:
    place = link.getUserData(_PLACE)
    if place is None:
        return None
    path, element = place
    return Origin(names(path), path, element, link.getUserData(_CALLS) or ())


@contextmanager
def _tracing(xacro: Any, path: Path, addresses: Addresses, names: Callable[[Path], str]) -> Iterator[None]:
    """Note where each element stands when xacro reads a file, and which links a macro call leaves."""
    read, call = xacro.parse, xacro.handle_macro_call
    packages: Any = __import__("xacro.substitution_args", fromlist=["substitution_args"])
    find = getattr(packages, "_eval_find", None)
    keeper = _Keeper()

    def read_and_mark(given: Any, filename: Any = None) -> Any:
        if given is not None:
            return read(given, filename)
        file = Path(filename)
        # Before the other parser sees it: entities are refused here, which would be expanded there.
        tree = parse_xml(read_source(file), str(file), file=names(file), remarks={})
        document = read(given, filename)
        nodes = [document.documentElement, *document.documentElement.getElementsByTagName("*")]
        for node, element in zip(nodes, _in_order(tree), strict=True):
            node.setUserData(_PLACE, (file, element), keeper)
        return document

    def call_and_mark(node: Any, *rest: Any) -> Any:
        parent, before = node.parentNode, [*node.parentNode.childNodes]
        place, tag = node.getUserData(_PLACE), node.tagName
        done = call(node, *rest)
        known = {id(each) for each in before}
        where = f"line {place[1].line} of {names(place[0])}" if place is not None else "a place not known"
        for made in [each for each in parent.childNodes if id(each) not in known]:
            if not hasattr(made, "getElementsByTagName"):
                continue
            for link in [made, *made.getElementsByTagName("link")]:
                calls = (f"<{tag}> in {where}", *(link.getUserData(_CALLS) or ()))
                link.setUserData(_CALLS, calls, keeper)
        return done

    def find_package(name: str) -> str:
        found = addresses.find(f"package://{name}/", path.parent).path
        return str(found) if found is not None else find(name) if find is not None else ""

    xacro.parse, xacro.handle_macro_call = read_and_mark, call_and_mark
    if find is not None:
        packages._eval_find = find_package
    try:
        yield
    finally:
        xacro.parse, xacro.handle_macro_call = read, call
        if find is not None:
            packages._eval_find = find


def _in_order(root: Element) -> Sequence[Element]:
    """Return the elements of a document in its order."""
    waiting, found = [root], []
    while waiting:
        element = waiting.pop()
        found.append(element)
        waiting += reversed(element.children)
    return found
