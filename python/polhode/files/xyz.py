"""Molecules as XYZ files hold them."""

from __future__ import annotations

import re
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final, NamedTuple

import numpy as np

from polhode.errors import FileFormatError
from polhode.files.content import opened
from polhode.files.reading import text_of

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["Molecule", "molecule_from", "molecule_of", "read_xyz"]

_MOST_DIGITS: Final = 4000
_PROPERTIES: Final = re.compile(r"""(?:^|\s)Properties=(?:"([^"]*)"|(\S*))""", re.IGNORECASE)
_LATTICE: Final = re.compile(r"(?:^|\s)Lattice=", re.IGNORECASE)


class Molecule(NamedTuple):
    """Atoms as a file of a molecule holds them: XYZ, PDB, MOL or SDF.

    Attributes
    ----------
    labels : tuple of str
        Element symbols, isotopes or atomic numbers, as :func:`polhode.molecules.isotopes` reads them.
    positions : numpy.ndarray, shape (n, 3)
        In the unit of the file, which is angstrom for all of these formats by custom.
    comment : str
        What the file says of the molecule: the second line of XYZ, the first line of MOL and SDF, the first
        ``TITLE`` or ``COMPND`` of PDB.
    rounding : float
        Largest amount by which a coordinate was rounded, in the unit of the file: half a unit of the last
        digit that the file prints. 0 if no coordinate has digits after the decimal point: the rounding is
        then not known.
    notes : tuple of str
        What else the file holds, and what is missing in it.
    """

    labels: tuple[str, ...]
    positions: NDArray[np.float64]
    comment: str
    rounding: float = 0.0
    notes: tuple[str, ...] = ()


def read_xyz(path: str | os.PathLike[str]) -> Molecule:
    """Read a molecule from an XYZ file: a count, a comment, then one ``symbol x y z`` per atom.

    :func:`load` reads the other formats of molecules too.

    Parameters
    ----------
    path : str or os.PathLike
        One frame. Columns other than the symbol and x, y, z (charges, velocities) are not read; an extended
        XYZ file says in its second line where these stand.

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
    with opened(file) as content:
        return molecule_of(content.stream, file)


def molecule_of(stream: BinaryIO, file: Path) -> Molecule:
    """Read a molecule from a file that is open; see :func:`read_xyz`."""
    lines = text_of(stream, file, "an XYZ file").splitlines()
    count_text = lines[0].strip()
    if not (count_text.isdecimal() and len(count_text) <= _MOST_DIGITS) or int(count_text) == 0:
        raise FileFormatError(
            f"{file}: line 1 of an XYZ file is the number of atoms, not {count_text[:40]!r}; write it there"
        )
    count = int(count_text)
    comment = lines[1].strip() if len(lines) > 1 else ""
    columns = _columns(comment, file)
    rows = lines[2 : 2 + count]
    if len(rows) < count:
        raise FileFormatError(
            f"{file}: line 1 promises {count_text[:40]} atoms, but the file holds {len(rows)}; "
            "is it cut short?"
        )
    if any(line.strip() for line in lines[2 + count :]):
        raise FileFormatError(
            f"{file}: text after atom {count}, the last by line 1; correct the count or keep one frame a file"
        )
    atoms = [_atom(file, number, row, columns) for number, row in enumerate(rows, start=3)]
    labels, coordinates = zip(*atoms, strict=True)
    notes = []
    if _LATTICE.search(comment):
        notes.append(
            "the lattice of the file is not used: the atoms are taken as they stand, as one molecule"
        )
    return molecule_from(labels, coordinates, comment, tuple(notes))


def molecule_from(
    labels: Sequence[str],
    coordinates: Sequence[Sequence[Decimal]],
    comment: str,
    notes: tuple[str, ...] = (),
) -> Molecule:
    """Make a molecule of what a file prints, digit by digit."""
    positions = np.array(coordinates, dtype=np.float64)
    rounding = _rounding([x for row in coordinates for x in row])
    return Molecule(tuple(labels), positions, comment, rounding, notes)


def _columns(comment: str, file: Path) -> tuple[int, int]:
    """Find the columns of the symbol and of x, which extended XYZ files name in the second line."""
    found = _PROPERTIES.search(comment)
    if found is None:
        return 0, 1
    words = (found[1] or found[2]).split(":")
    starts: dict[str, tuple[str, int, int]] = {}
    at = 0
    for name, kind, size in zip(words[::3], words[1::3], words[2::3], strict=False):
        if not size.isdecimal() or len(size) > 6:
            break
        starts.setdefault(name, (kind, at, int(size)))
        at += int(size)
    kind, label, _ = starts.get("species", starts.get("element", ("", -1, 0)))
    letter, first, size = starts.get("pos", ("", -1, 0))
    if kind != "S" or letter != "R" or size != 3:
        raise FileFormatError(
            f"{file}: line 2 declares no columns species:S:1 and pos:R:3 "
            f"(Properties={':'.join(words)[:60]}); write them"
        )
    return label, first


def _atom(file: Path, number: int, row: str, columns: tuple[int, int]) -> tuple[str, list[Decimal]]:
    """Split a row into the atom's label and its coordinates, digit by digit."""
    label, first = columns
    words = row.split()
    try:
        coordinates = [Decimal(word) for word in words[first : first + 3]]
        position = [float(x) for x in coordinates]
    except (InvalidOperation, ValueError):  # the latter of a signalling NaN
        position = []
    if len(position) != 3 or not np.isfinite(position).all() or len(words) <= label:
        raise FileFormatError(f"{file}: line {number}: expected 'symbol x y z', got {row.strip()[:60]!r}")
    return words[label], coordinates


def _rounding(numbers: Sequence[Decimal]) -> float:
    """Find half a unit of the last printed digit, the largest of all coordinates.

    Programs print a fixed number of decimals or of significant digits, and some then cut zeros off at the
    end. Of these two rules the one is taken by which fewer zeros were cut off.
    """
    # How many decimals each shows, and of those that are not zero the place of the first digit (0: the ones).
    decimals = [max(0, -int(number.as_tuple().exponent)) for number in numbers]
    finest = max(decimals)
    if finest == 0:
        return 0.0
    shown = [(places, x.adjusted()) for places, x in zip(decimals, numbers, strict=True) if x]
    digits = max((places + first + 1 for places, first in shown), default=0)
    missing_decimals = sum(finest - places for places, _ in shown)
    missing_digits = sum(digits - (places + first + 1) for places, first in shown)
    if missing_digits < missing_decimals:
        return 0.5 * 10.0 ** (1 + max(first for _, first in shown) - digits)
    return 0.5 * 10.0**-finest
