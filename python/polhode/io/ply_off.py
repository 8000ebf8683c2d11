"""PLY and OFF files, read by trimesh and checked against what their headers promise."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, BinaryIO, Final, NamedTuple, NoReturn

import numpy as np

from polhode._optional import require
from polhode.errors import FileFormatError
from polhode.io.budget import with_way_out
from polhode.io.content import unread
from polhode.io.mesh import Mesh, weld

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from polhode.io.budget import Budget

__all__ = [
    "check_off",
    "check_ply",
    "check_ply_lists",
    "check_ply_size",
    "read_by_trimesh",
]

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
                raise ValueError(f"the row {_quote_row(row)} is not as the header says")
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
            raise ValueError(f"the face {_quote_row(row)} has fewer corners than it says")
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
        raise ValueError(f"the row {_quote_row(rows[end])} is one more than the header promises")


def _check_numbers(rows: list[list[bytes]]) -> None:
    for start in range(0, len(rows), _ROWS_AT_ONCE):
        words = [word for row in rows[start : start + _ROWS_AT_ONCE] for word in row]
        np.array(words).astype(np.float64)  # which tells the word that is none


def _quote_row(row: list[bytes]) -> str:
    return repr(b" ".join(row)[:60].decode(errors="replace"))


def _cut_short(faces: int) -> ValueError:
    return ValueError(f"the header promises {faces} faces, but the file holds fewer; is it cut short?")


_READ: Final = (".ply", ".off")
_PROMISING: Final = {"ply": check_ply, "off": check_off}
_BLANKS: Final = b" \t\n\r\v\f"
_BLOCK: Final = 1 << 20


class _NoOtherFiles:
    """Where trimesh would look for other files: nothing but the file itself is read."""

    def get(self, name: str) -> NoReturn:
        raise ValueError(f"it names another file, {name!r}; write all into one")

    __getitem__ = get


def read_by_trimesh(stream: BinaryIO, file: Path, readable: tuple[str, ...], budget: Budget) -> Mesh:
    """Read every triangle of a file with trimesh.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    file : pathlib.Path
        Its name.
    readable : tuple of str
        Suffixes to name where this file's is none that is read.
    budget : Budget

    Returns
    -------
    Mesh
    """
    suffix = file.suffix.lower()
    if suffix not in _READ:  # trimesh knows more: archives that unpack without end, drawings, voxels
        raise unread(file, suffix, readable)
    trimesh: Any = require("trimesh", extra="mesh", purpose=f"{file}: reading {suffix} files")
    kind = suffix.removeprefix(".")
    try:
        _count_words(stream, budget)
        # Its own processing would merge, drop and reorder; only the stored triangles are wanted.
        scene = _load_scene(trimesh, stream, kind)
    except (MemoryError, OSError, FileFormatError):
        raise
    except Exception as error:  # a damaged file can raise anything in there, from KeyError to struct.error
        reason = " ".join(str(error).split()) or type(error).__name__
        fault = with_way_out(reason[:200], "export it again")
        raise FileFormatError(file, f": not a readable {kind.upper()} file: {fault}") from error
    vertices, faces = np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    for name, geometry in scene.geometry.items():  # of which these formats hold one
        if not isinstance(geometry, trimesh.Trimesh):
            raise FileFormatError(
                file, f": holds points or lines ({name}) where triangles are needed; export triangles"
            )
        vertices = np.asarray(geometry.vertices, dtype=np.float64)
        if len(geometry.faces):
            faces = np.asarray(geometry.faces, dtype=np.int64)
    if faces.shape[1:] != (3,) or vertices.shape[1:] != (3,):
        raise FileFormatError(file, ": its faces or vertices are not rows of three numbers; export triangles")
    if faces.size and not (faces.min() >= 0 and faces.max() < len(vertices)):
        row = int(np.flatnonzero((faces < 0).any(axis=1) | (faces >= len(vertices)).any(axis=1))[0])
        raise FileFormatError(
            file, f": face {row} names a vertex that the file does not hold; is it cut short?"
        )
    mesh = weld(vertices, faces, kind.upper())
    if not len(mesh.faces):
        raise FileFormatError(file, ": holds no triangles; export it with them")
    try:
        stream.seek(0)
        _PROMISING[kind](stream, len(mesh.faces))
    except (ValueError, IndexError) as error:
        fault = with_way_out(error, "export it again")
        raise FileFormatError(file, f": not a whole {kind.upper()} file: {fault}") from None
    return mesh


def _count_words(stream: BinaryIO, budget: Budget) -> None:
    """Count what may be words of a text, each of which takes far more memory than its letters."""
    stream.seek(0)
    while block := stream.read(_BLOCK):
        budget.spend("words", len(block) - len(block.translate(None, _BLANKS)))
    stream.seek(0)


def _load_scene(trimesh: Any, stream: BinaryIO, kind: str) -> Any:
    """Return trimesh's scene of a file that can be what it says."""
    if kind == "ply":
        check_ply_size(stream)
    stream.seek(0)
    scene = trimesh.load_scene(
        stream, file_type=kind, resolver=_NoOtherFiles(), process=False, skip_materials=True
    )
    if kind == "ply":
        check_ply_lists(scene)
    return scene
