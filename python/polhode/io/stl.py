"""ASCII STL, read strictly: a file cut short is an error, not a smaller body.

Binary STL is read in the compiled core: ``rust/core/src/io/stl.rs``.
"""

from __future__ import annotations

import io
from functools import partial
from typing import TYPE_CHECKING, BinaryIO, Final

import numpy as np

from polhode.errors import FileFormatError
from polhode.io.budget import with_way_out

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["read_ascii_stl"]

# facet normal n n n  outer loop  vertex x y z  vertex x y z  vertex x y z  endloop endfacet
_KEYWORDS: Final = dict(
    zip(
        (0, 1, 5, 6, 7, 11, 15, 19, 20),
        ("facet", "normal", "outer", "loop", "vertex", "vertex", "vertex", "endloop", "endfacet"),
        strict=True,
    )
)
_WORDS_PER_FACET: Final = 21
_COORDINATES: Final = tuple(7 + 4 * corner + axis for corner in range(3) for axis in (1, 2, 3))
_WORDS_PER_BLOCK: Final = 4096 * _WORDS_PER_FACET
_LONGEST_LINE: Final = 1 << 20


def read_ascii_stl(stream: BinaryIO, file: Path) -> tuple[NDArray[np.float64], tuple[tuple[str, int], ...]]:
    """Read the corners of every triangle of every solid in an ASCII STL file.

    Parameters
    ----------
    stream : binary stream
        The file's content; normals in it are not used.
    file : pathlib.Path
        Its name, for what is wrong with it.

    Returns
    -------
    corners : numpy.ndarray, shape (m, 3, 3)
        Triangle, corner, component.
    groups : tuple of (str, int)
        The name of each solid and the number of its triangles.

    Raises
    ------
    FileFormatError
        With the number of the line by which something had gone wrong.
    """
    blocks: list[NDArray[np.float64]] = []
    words: list[str] = []
    groups: list[tuple[str, int]] = []
    name: str | None = None
    number = read = done = 0
    try:
        # Names of solids may be in any encoding.
        with io.TextIOWrapper(stream, encoding="utf-8", errors="surrogateescape") as lines:
            for line in iter(partial(lines.readline, _LONGEST_LINE), ""):
                number += 1
                if len(line) == _LONGEST_LINE:
                    raise ValueError(f"a line is longer than {_LONGEST_LINE - 1} characters")
                first, *rest = line.split(maxsplit=1) or [""]
                if first.lower() in ("solid", "endsolid"):
                    if (first.lower() == "solid") == (name is not None):
                        raise ValueError("'solid' and 'endsolid' do not alternate")
                    count, left = divmod(read + len(words), _WORDS_PER_FACET)
                    if left:
                        blocks.append(_corners(words))  # which says what is wrong with it
                    groups.append((name or "", count - done))
                    done = count
                    name = _name_in(rest) if first.lower() == "solid" else None
                    continue
                words += line.split()
                if len(words) >= _WORDS_PER_BLOCK:
                    blocks.append(_corners(words[:_WORDS_PER_BLOCK]))
                    words = words[_WORDS_PER_BLOCK:]
                    read += _WORDS_PER_BLOCK
        if name is not None or read + len(words) > _WORDS_PER_FACET * done:
            raise ValueError("the last solid has no 'endsolid'; is the file cut short?")
        blocks.append(_corners(words))
    except ValueError as error:
        fault = with_way_out(error, "export it again")
        raise FileFormatError(file, f": not a whole ASCII STL file: up to line {number}: {fault}") from None
    corners = np.concatenate(blocks)
    if not len(corners):
        raise FileFormatError(file, ": holds no triangles; check the file")
    return corners, tuple(groups)


def _name_in(rest: list[str]) -> str:
    """Return the name of a solid, what is no text in it left out."""
    return " ".join("".join(letter for letter in "".join(rest) if letter.isprintable()).split())


def _corners(words: list[str]) -> NDArray[np.float64]:
    if len(words) % _WORDS_PER_FACET:
        raise ValueError("a facet is incomplete")
    for place, keyword in _KEYWORDS.items():
        for word in set(words[place::_WORDS_PER_FACET]):
            if word.lower() != keyword:
                raise ValueError(f"expected {keyword!r}, got {word[:40]!r}")
    columns = [np.array(words[place::_WORDS_PER_FACET], dtype=np.float64) for place in _COORDINATES]
    return np.stack(columns, axis=-1).reshape(-1, 3, 3)
