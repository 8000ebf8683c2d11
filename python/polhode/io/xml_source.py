"""XML as a tree that knows where in its source each element stands, so that an edit leaves the rest as it is.

Read with expat alone: a document that declares entities or a document type is refused, so nothing can be
expanded or fetched.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple
from xml.parsers import expat

from polhode.errors import FileFormatError
from polhode.io.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = [
    "Edit",
    "Element",
    "apply_edits",
    "attribute_span",
    "blanks_of",
    "parse_xml",
    "remove_attribute",
    "set_attribute",
    "set_text",
    "text_span",
    "word_span",
]

_START_TAG: Final = re.compile(rb"<[^\"'<>]*(?:\"[^\"]*\"[^\"'<>]*|'[^']*'[^\"'<>]*)*>")
# A declaration after blanks or comments.
_LATE: Final = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:<!--(?:(?!--).)*-->\s*)*(<\?xml\s[^<>]*\?>)", re.DOTALL)
# Comments as other readers take them, up to the first -->, and what to step over. Each also ends with the
# file, so that what is not closed is looked through once.
_COMMENT: Final = re.compile(rb"<!\[CDATA\[.*?(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)|<!--(.*?)(?:-->|\Z)", re.DOTALL)
_DECLARATION: Final = re.compile(rb"(?:\xef\xbb\xbf)?(<\?xml\s[^<>]*\?>)")
_BAD_TOKEN: Final = expat.errors.codes[expat.errors.XML_ERROR_INVALID_TOKEN]
_BAD_DECLARATION: Final = expat.errors.codes[expat.errors.XML_ERROR_XML_DECL]
_WORD: Final = re.compile(rb"[^\s]+")
_DEEPEST: Final = 200


@dataclass(eq=False, slots=True)
class Element:
    """One element.

    Attributes
    ----------
    tag : str
    attributes : dict
    line : int
        Of its start tag, counted from 1.
    start, inside, outside, end : int
        Bytes of the source at which the start tag begins and ends, and the end tag begins and ends; the last
        three are the same for ``<tag/>``.
    text : str
        Its own characters, those of its children left out.
    file : str
        The file that it stands in, where that is included by another one.
    depth : int
        How many elements are open where it stands, itself and those around an included file counted.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    start: int
    inside: int
    outside: int = 0
    end: int = 0
    text: str = ""
    children: list[Element] = field(default_factory=list)
    file: str = ""
    depth: int = 1

    @property
    def where(self) -> str:
        """The line, and the file unless it is the one that was asked for."""
        return f"line {self.line} of {self.file}" if self.file else f"line {self.line}"

    def find(self, tag: str) -> Element | None:
        """Find the first child of that name."""
        return next(self.all(tag), None)

    def all(self, tag: str) -> Iterator[Element]:
        """Return the children of that name."""
        return (child for child in self.children if child.tag == tag)

    def descendants(self, tag: str) -> Iterator[Element]:
        """Return the elements of that name at any depth, in the order of the document."""
        waiting = self.children[::-1]
        while waiting:
            element = waiting.pop()
            if element.tag == tag:
                yield element
            waiting += reversed(element.children)


class Edit(NamedTuple):
    """Bytes of the source to be replaced."""

    start: int
    end: int
    text: str


def _declared_late(source: bytes) -> bytes:
    """Blank out a declaration after blanks or comments, where XML has none but other readers take it."""
    found = _LATE.match(source)
    if found is None or not source[: found.start(1)].removeprefix(b"\xef\xbb\xbf"):
        return source
    start, end = found.span(1)
    return source[:start] + b" " * (end - start) + source[end:]


def _blank_out_faults(source: bytes, code: int) -> tuple[bytes, str]:
    """Blank out what other readers of robots pass over and XML forbids, and say what; "" where there is none.

    Every byte keeps its place, so that those of elements are the places of the source itself.
    """
    if code == _BAD_DECLARATION and (found := _DECLARATION.match(source)) is not None:
        start, end = found.span(1)
        return source[:start] + b" " * (end - start) + source[end:], "its XML declaration is not well-formed"
    if code != _BAD_TOKEN:
        return source, ""
    pieces: list[bytes] = []
    done, line = 0, 0
    for comment in _COMMENT.finditer(source):
        inside = comment[1]
        if inside is not None and (b"--" in inside or inside.endswith(b"-")):
            start, end = comment.span(1)
            line = line or source.count(b"\n", 0, start) + 1
            pieces += (source[done:start], inside.replace(b"-", b" "))
            done = end
    return b"".join([*pieces, source[done:]]), f"the comment of line {line} holds --" if line else ""


def parse_xml(
    source: bytes,
    name: str,
    *,
    file: str = "",
    above: int = 0,
    budget: Budget | None = None,
    remarks: dict[str, None] | None = None,
) -> Element:
    """Parse a document, in a time proportional to its length.

    Parameters
    ----------
    source : bytes
        In UTF-8, so that the elements' places are those of the text.
    name : str
        Of the file, for what is wrong with it.
    file : str
        What the elements say they stand in.
    above : int
        How deep what includes the file stands.
    budget : Budget, optional
        Its elements are counted there; each document has its own by default.
    remarks : dict, optional
        Gets what is passed over though XML forbids it: a comment that holds two hyphens, a declaration that
        is not well-formed. Without it such a document is refused.

    Returns
    -------
    Element
        The root.

    Raises
    ------
    FileFormatError
        If it is no well-formed XML, declares entities or a document type, is nested beyond reason or has
        too many elements.
    """
    if source.startswith((b"\xff\xfe", b"\xfe\xff")) or b"\0" in source[:4]:
        raise FileFormatError(name, ": is in UTF-16; save it as UTF-8")
    source = _declared_late(source)
    spent = budget if budget is not None else Budget(name, len(source))
    made = 0
    parser = expat.ParserCreate()
    parser.buffer_text = True
    root: list[Element] = []
    stack: list[Element] = []
    texts: list[list[str]] = []  # of the open elements, joined when they end: each character is copied once

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal made
        at, line, depth = parser.CurrentByteIndex, parser.CurrentLineNumber, above + len(stack) + 1
        if depth > _DEEPEST:
            raise FileFormatError(
                name, f": line {line}: elements are nested more than {_DEEPEST} deep; check the file"
            )
        made += 1
        spent.spend("elements", 1, name, f": line {line}")
        match = _START_TAG.match(source, at)
        inside = match.end() if match else at
        element = Element(tag, attributes, line, at, inside, file=file, depth=depth)
        (stack[-1].children if stack else root).append(element)
        stack.append(element)
        texts.append([])

    def end(_: str) -> None:
        element = stack.pop()
        element.text = "".join(texts.pop())
        if source[element.inside - 2 : element.inside] == b"/>":
            element.outside = element.end = element.inside
        else:
            element.outside = parser.CurrentByteIndex
            element.end = source.index(b">", element.outside) + 1

    def characters(text: str) -> None:
        if texts:
            texts[-1].append(text)

    def refuse(*_: object) -> None:
        raise FileFormatError(
            name,
            f": line {parser.CurrentLineNumber}: declares a document type or entities, which are not "
            "read; remove the declaration",
        )

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = characters
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(source, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        if remarks is not None and (loose := _blank_out_faults(source, error.code))[1]:
            spent.spend("elements", -made)
            told = f"{file}: {loose[1]}" if file else loose[1]
            remarks[f"{told}: XML forbids it, so that xacro refuses it; simulators pass over it"] = None
            return parse_xml(loose[0], name, file=file, above=above, budget=spent, remarks=remarks)
        if error.code == _BAD_TOKEN and not _is_utf8(source):
            raise FileFormatError(
                name,
                f": line {error.lineno}: holds bytes that are not UTF-8; save it as UTF-8, or name its "
                'encoding in the first line, as in <?xml version="1.0" encoding="ISO-8859-1"?>',
            ) from None
        raise FileFormatError(
            name,
            f": line {error.lineno}: not well-formed XML: {reason}; correct the line, or is the "
            "file cut short?",
        ) from None
    except FileFormatError:
        raise
    except (LookupError, ValueError) as error:  # of an encoding that Python does not know, or of many bytes
        raise FileFormatError(
            name, f": line 1: the encoding that it declares is not read ({error}); save it as UTF-8"
        ) from None
    return root[0]


def apply_edits(source: bytes, edits: Iterable[Edit]) -> bytes:
    """Apply edits that do not overlap, in one pass."""
    pieces: list[bytes] = []
    done = 0
    for edit in sorted(edits):
        if edit.start < done:
            raise ValueError(f"edits: one starts at byte {edit.start}, within another; divide them")
        pieces += (source[done : edit.start], edit.text.encode())
        done = edit.end
    return b"".join([*pieces, source[done:]])


def set_attribute(source: bytes, element: Element, name: str, value: str) -> Edit:
    """Edit an attribute's value, or add the attribute."""
    found = _attribute(source, element, name)
    if found is not None:
        quote = source[found.end() - 1 : found.end()].decode()
        return Edit(found.start(2), found.end(), f"{quote}{value}{quote}")
    at = element.inside - (2 if source[element.inside - 2 : element.inside] == b"/>" else 1)
    while source[at - 1 : at].isspace():
        at -= 1
    return Edit(at, at, f' {name}="{value}"')


def remove_attribute(source: bytes, element: Element, name: str) -> Edit | None:
    """Edit an attribute away, with the blanks before it."""
    found = _attribute(source, element, name)
    return Edit(found.start(), found.end(), "") if found is not None else None


def set_text(element: Element, value: str) -> Edit:
    """Edit the text between the tags."""
    if element.outside == element.inside == element.end:
        return Edit(element.start, element.end, f"<{element.tag}>{value}</{element.tag}>")
    return Edit(element.inside, element.outside, value)


def attribute_span(source: bytes, element: Element, name: str) -> tuple[int, int] | None:
    """Return where the value of an attribute stands, without its quotes; None where there is none."""
    found = _attribute(source, element, name)
    return (found.start(2) + 1, found.end() - 1) if found is not None else None


def text_span(source: bytes, element: Element) -> tuple[int, int] | None:
    """Return where the text of an element without children stands, without blanks; None for none."""
    text = source[element.inside : element.outside]
    if element.children or not text.strip():
        return None
    return element.inside + len(text) - len(text.lstrip()), element.inside + len(text.rstrip())


def word_span(source: bytes, span: tuple[int, int], number: int) -> tuple[int, int]:
    """Return where the word of that number within a span stands; the span itself where it has none."""
    words = list(_WORD.finditer(source, *span))
    return words[number].span() if number < len(words) else span


def blanks_of(between: bytes) -> str:
    """Return the blanks before an element, so that another one can be inserted with the same indentation."""
    return between.decode() if between.isspace() else ""


def _attribute(source: bytes, element: Element, name: str) -> re.Match[bytes] | None:
    # Values are stepped over, so that a name inside one is not taken for an attribute.
    pattern = re.compile(rb"\s+([^\s=\"'<>/]+)\s*=\s*(\"[^\"]*\"|'[^']*')")
    at = element.start + 1 + len(element.tag.encode())
    while (match := pattern.match(source, at, element.inside)) is not None:
        if match[1] == name.encode():
            return match
        at = match.end()
    return None


def _is_utf8(source: bytes) -> bool:
    try:
        source.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True
