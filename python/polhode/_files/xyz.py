"""Molecules as XYZ files hold them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode._files.content import checked_format
from polhode._files.reading import read_text
from polhode.errors import FileFormatError

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

__all__ = ["Molecule", "read_xyz"]

_MOST_DIGITS: Final = 18


class Molecule(NamedTuple):
    """Atoms as an XYZ file holds them.

    Attributes
    ----------
    labels : tuple of str
        Element symbols, isotopes or atomic numbers, as :func:`polhode.molecules.isotopes` reads them.
    positions : numpy.ndarray, shape (n, 3)
        In the unit of the file: angstrom by the format's custom.
    comment : str
        The second line of the file.
    """

    labels: tuple[str, ...]
    positions: NDArray[np.float64]
    comment: str


def read_xyz(path: str | os.PathLike[str]) -> Molecule:
    """Read a molecule: a count, a comment, then one ``symbol x y z`` per atom.

    Parameters
    ----------
    path : str or os.PathLike
        One frame. Columns after the fourth (charges, velocities) are not read.

    Returns
    -------
    Molecule

    Raises
    ------
    FileFormatError
        With the number of the line that is wrong.
    OSError
        If the file cannot be read.
    """
    file = Path(path)
    checked_format(file)
    lines = read_text(file, "an XYZ file").splitlines()
    count_text = lines[0].strip()
    if not (count_text.isdecimal() and len(count_text) <= _MOST_DIGITS) or int(count_text) == 0:
        raise FileFormatError(
            f"{file}: line 1 of an XYZ file is the number of atoms, not {count_text[:40]!r}"
        )
    count = int(count_text)
    comment = lines[1].strip() if len(lines) > 1 else ""
    columns = comment.partition("Properties=")[2]
    if columns and not columns.startswith(("species:S:1:pos:R:3", '"species:S:1:pos:R:3')):
        raise FileFormatError(f"{file}: line 2 declares other columns than symbol x y z first; reorder them")
    rows = lines[2 : 2 + count]
    if len(rows) < count:
        raise FileFormatError(
            f"{file}: line 1 promises {count} atoms, but the file holds {len(rows)}; is it cut short?"
        )
    if any(line.strip() for line in lines[2 + count :]):
        raise FileFormatError(
            f"{file}: text after atom {count}, the last by line 1; correct the count or keep one frame a file"
        )
    atoms = [_atom(file, number, row) for number, row in enumerate(rows, start=3)]
    labels, positions = zip(*atoms, strict=True)
    return Molecule(labels, np.array(positions), comment)


def _atom(file: Path, number: int, row: str) -> tuple[str, list[float]]:
    words = row.split()
    try:
        position = [float(word) for word in words[1:4]]
    except ValueError:
        position = []
    if len(position) != 3 or not np.isfinite(position).all():
        raise FileFormatError(f"{file}: line {number}: expected 'symbol x y z', got {row.strip()[:60]!r}")
    return words[0], position
