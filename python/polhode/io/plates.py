"""Plate files of Gaskell's stereophotoclinometry: Eros, Itokawa, Phobos (``ver64q.tab``).

A line with the number of vertices, then ``index x y z``; a line with the number of plates, then
``index a b c``, counted from 1. Kilometres by custom; the file does not say.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from polhode.errors import FileFormatError
from polhode.io.budget import text_of
from polhode.io.mesh import Mesh

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["is_numbered_plates", "read_numbered_plates"]


def is_numbered_plates(lines: list[str]) -> bool:
    """Return whether the first lines of a text are those of such a file."""
    rows = [words for line in lines[:8] if (words := line.split())][:3]
    if len(rows) < 3 or len(rows[0]) != 1 or not rows[0][0].isdecimal():
        return False
    return [len(row) for row in rows[1:]] == [4, 4] and [row[0] for row in rows[1:]] == ["1", "2"]


def read_numbered_plates(stream: BinaryIO, file: Path) -> Mesh:
    """Read the vertices and plates.

    Parameters
    ----------
    stream : binary stream
    file : pathlib.Path
        Its name.
    """
    words = text_of(stream, file, "a plate file").split()
    try:
        count = int(words[0])
        end = 1 + 4 * count
        rows = np.array(words[1:end], dtype=np.float64).reshape(-1, 4)
        if len(rows) != count or end >= len(words):
            raise ValueError(f"its first line promises {count} vertices, and it holds fewer")
        plates = int(words[end])
        faces = np.array(words[end + 1 :], dtype=np.int64).reshape(-1, 4)
        if len(faces) != plates:
            raise ValueError(f"it promises {plates} plates, and holds {len(faces)}")
        for name, index in (("vertex", rows[:, 0]), ("plate", faces[:, 0])):
            wrong = np.flatnonzero(index != np.arange(1, len(index) + 1))
            if len(wrong):
                raise ValueError(f"{name} {wrong[0] + 1} has the number {index[wrong[0]]:g}")
        if not plates:
            raise ValueError("it holds no plates")
    except (ValueError, OverflowError, IndexError) as error:
        raise FileFormatError(file, f": not a whole plate file: {error}; is it cut short?") from None
    return Mesh(rows[:, 1:].copy(), faces[:, 1:] - 1, "numbered plates")
