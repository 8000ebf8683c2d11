"""What multiplies the elements of an MJCF model before it is read: ``<include>`` and ``<replicate>``."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from polhode.errors import FileFormatError
from polhode.robots.model import numbers
from polhode.robots.words import quoted

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.files.xml_source import Element
    from polhode.robots.sources import Sources

__all__ = ["copies", "expand_includes"]


def expand_includes(root: Element, folder: Path, sources: Sources) -> None:
    """Put the elements of included files where the ``<include>`` stands, as MuJoCo does before it reads.

    Parameters
    ----------
    root : Element
        Of the model; it is changed.
    folder : pathlib.Path
        Of the model's file, where the names of all its included files start.
    sources : Sources
    """
    included: set[str] = set()
    waiting = [root]
    while waiting:
        element = waiting.pop()
        children: list[Element] = []
        unread = list(reversed(element.children))
        while unread:
            child = unread.pop()
            if child.tag != "include":
                children.append(child)
                continue
            name = child.attributes.get("file", "")
            if not name:
                raise FileFormatError(f"{child.where}: <include> without file; name one")
            path = sources.locate(name, folder, child)
            # MuJoCo knows a file by its name: links to one file are files of their own.
            if (called := os.path.normpath(path)) in included:
                raise FileFormatError(
                    f"{child.where}: {name} is included twice; MuJoCo allows it once: leave one of them out"
                )
            included.add(called)
            unread += reversed(sources.read(path, name, child).children)
        element.children = children
        waiting += children


def copies(replicate: Element) -> int:
    """Give how many copies a ``<replicate>`` asks for."""
    text = replicate.attributes.get("count")
    (count,) = numbers(replicate, text, 1, "count")
    if count != int(count) or count < 1:
        raise FileFormatError(
            f"{replicate.where}: count is {quoted(text)} where a whole number from 1 has to stand"
        )
    return int(count)
