"""Edits of values in a robot's file. Unchanged numbers keep their text; new elements are indented."""

from __future__ import annotations

from typing import TYPE_CHECKING

from polhode.io.xml_source import Edit, Element, set_attribute, set_text

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["attribute", "first_child", "indent_element", "number_text", "text_of"]


def number_text(values: Iterable[float]) -> str:
    """Write numbers with all digits, so that they are read back unchanged."""
    return " ".join(repr(float(x) + 0.0) for x in values)


def attribute(source: bytes, element: Element, name: str, text: str) -> list[Edit]:
    """Set an attribute, unless it has these numbers already, in any format."""
    return [] if _same(element.attributes.get(name), text) else [set_attribute(source, element, name, text)]


def text_of(element: Element, text: str) -> list[Edit]:
    """Set a text, unless it has these numbers already."""
    return [] if _same(element.text, text) else [set_text(element, text)]


def first_child(source: bytes, parent: Element, text: str) -> Edit:
    """Insert elements before the first child, with the same indentation."""
    if parent.inside == parent.end:
        start = source[parent.start : parent.inside - 2].rstrip().decode()
        return Edit(parent.start, parent.end, f"{start}>{text}</{parent.tag}>")
    first = parent.children[0].start if parent.children else parent.outside
    return Edit(first, first, text + _blanks_before(source, parent.inside, first))


def indent_element(source: bytes, parent: Element, opening: str, inner: Iterable[str], closing: str) -> str:
    """Write an element with its children on lines of their own where those of the parent stand so."""
    first = parent.children[0].start if parent.children else parent.inside
    blanks = _blanks_before(source, parent.inside, first)
    if "\n" not in blanks:
        return f"{opening}{''.join(inner)}{closing}"
    step = "\t" if blanks.endswith("\t") else "  "
    return opening + "".join(f"{blanks}{step}{each}" for each in inner) + blanks + closing


def _blanks_before(source: bytes, start: int, end: int) -> str:
    """Return the blanks before an element, behind a comment or the start of its parent."""
    between = source[start:end]
    return between[len(between.rstrip()) :].decode()


def _same(old: str | None, new: str) -> bool:
    try:
        return old is not None and [float(x) for x in old.split()] == [float(x) for x in new.split()]
    except ValueError:
        return False
