"""Checks that PLY and OFF files hold what their headers promise.

trimesh takes what it finds: a text cut at the end of a line still parses, a word that is no number ends a
row, and of lists that differ in length it looks at the first.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["check_off", "check_ply", "check_ply_lists", "check_ply_size"]

_ROWS_AT_ONCE = 1 << 16


class _Element(NamedTuple):
    """A kind of rows of a PLY file."""

    name: bytes
    rows: int
    are_lists: list[bool]
    """Of each property."""


def check_ply_size(stream: BinaryIO) -> None:
    """Refuse a header that promises more rows than the file has bytes, before anything is made of them."""
    rows = sum(element.rows for element in _ply_header(stream)[0])
    if rows > os.fstat(stream.fileno()).st_size:
        raise ValueError(f"the header promises {rows} rows, more than the file has bytes")


def check_ply_lists(scene: Any) -> None:
    """Refuse a binary PLY with lists of different lengths: trimesh takes the length of the first for all."""
    for geometry in scene.geometry.values():
        for element in geometry.metadata.get("_ply_raw", {}).values():
            data = element.get("data")
            for name in (isinstance(data, np.ndarray) and data.dtype.names) or ():
                if (data[name].dtype.names or ())[:2] == ("f0", "f1"):
                    lengths, held = data[name]["f0"], data[name]["f1"].shape[-1]
                    if (lengths != held).any():
                        row = int(np.argmax(lengths != held))
                        raise ValueError(
                            f"row {row} says that its list is {lengths[row]} long, the first {held}; "
                            "triangulate the mesh"
                        )


def check_ply(stream: BinaryIO, triangles: int) -> None:
    """Compare the rows of a PLY with its header, and the number of triangles with its faces."""
    elements, is_text = _ply_header(stream)
    faces = sum(element.rows for element in elements if element.name == b"face")
    if not is_text:
        if triangles < faces:
            raise _cut_short(faces)
        return
    rows = [words for line in stream if (words := line.split())]
    if len(rows) < sum(element.rows for element in elements):
        raise _cut_short(faces)
    expected = at = 0
    for element in elements:
        for row in rows[at : at + element.rows]:
            place = 0
            for is_list in element.are_lists:
                place += 1 + (int(row[place]) if is_list and place < len(row) else 0)
            if place != len(row):
                raise ValueError(f"the row {_shown(row)} is not as the header says")
            if element.name == b"face" and element.are_lists[0]:
                expected += int(row[0]) - 2
        at += element.rows
    _check_end(rows, at)
    _check_numbers(rows)
    if triangles < faces or (expected and triangles != expected):
        raise _cut_short(faces)


def check_off(stream: BinaryIO, triangles: int) -> None:
    """Compare the rows of an OFF file with its counts, and the number of triangles with its faces."""
    rows = [words for line in stream if (words := line.partition(b"#")[0].split())]
    # The counts may stand beside the word OFF.
    counts, rows = (rows[0][1:], rows[1:]) if rows[0][1:] else (rows[1], rows[2:])
    vertices, faces = int(counts[0]), int(counts[1])
    if len(rows) < vertices + faces:
        raise _cut_short(faces)
    for row in rows[vertices : vertices + faces]:
        if len(row) < int(row[0]) + 1:
            raise ValueError(f"the face {_shown(row)} has fewer corners than it says")
    _check_end(rows, vertices + faces)  # trimesh has refused words that are no numbers
    if triangles != sum(int(row[0]) - 2 for row in rows[vertices:]):
        raise _cut_short(faces)


def _ply_header(lines: Iterable[bytes]) -> tuple[list[_Element], bool]:
    """Read the elements in their order, and whether their rows are text."""
    elements: list[_Element] = []
    is_text = False
    for line in lines:
        words = line.split()
        if words[:1] == [b"element"]:
            elements.append(_Element(words[1], int(words[2]), []))
            if elements[-1].rows < 0:
                raise ValueError(f"the header promises {elements[-1].rows} rows")
        elif words[:1] == [b"property"]:
            elements[-1].are_lists.append(words[1] == b"list")
        is_text |= words[:2] == [b"format", b"ascii"]
        if words == [b"end_header"]:
            break
    return elements, is_text


def _check_end(rows: list[list[bytes]], end: int) -> None:
    if len(rows) > end:
        raise ValueError(f"the row {_shown(rows[end])} is one more than the header promises")


def _check_numbers(rows: list[list[bytes]]) -> None:
    for start in range(0, len(rows), _ROWS_AT_ONCE):
        words = [word for row in rows[start : start + _ROWS_AT_ONCE] for word in row]
        np.array(words).astype(np.float64)  # which tells the word that is none


def _shown(row: list[bytes]) -> str:
    return repr(b" ".join(row)[:60].decode(errors="replace"))


def _cut_short(faces: int) -> ValueError:
    return ValueError(f"the header promises {faces} faces, but the file holds fewer; is it cut short?")
