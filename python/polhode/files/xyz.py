"""Molecules as XYZ files hold them."""

from __future__ import annotations

import math
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
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

__all__ = ["Molecule", "lines_of", "molecule_from", "molecule_of", "number_of", "numbers_of", "read_xyz"]

_MOST_DIGITS: Final = 4000
_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_LINE_END: Final = re.compile(r"\r\n|\r|\n")
_ENTRY: Final = re.compile(
    r"""([A-Za-z_][\w-]*)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|'([^']*)'|\{([^}]*)\}|\[([^\]]*)\]|([^\s"'{\[]\S*))"""
    r"""|"(?:[^"\\]|\\.)*"|\S+"""
)
_LOGICAL: Final = {"t": True, "true": True, "1": True, "f": False, "false": False, "0": False}
_MASSES: Final = ("mass", "masses")


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
    cell : numpy.ndarray or None
        The cell in which the atoms stand, shape (k, 3): one vector for each direction in which the structure
        repeats, in the unit of the file; of ``CRYST1`` in PDB and of ``Lattice`` with ``pbc`` in extended
        XYZ. The atoms are not moved: :func:`polhode.molecules.cell_crossings` finds the bonds that join atoms
        through a side of it.
    """

    labels: tuple[str, ...]
    positions: NDArray[np.float64]
    comment: str
    rounding: float = 0.0
    notes: tuple[str, ...] = ()
    cell: NDArray[np.float64] | None = None

    def scaled(self, factor: float) -> Molecule:
        """Return the molecule with all lengths in another unit."""
        return self._replace(
            positions=self.positions * factor,
            rounding=self.rounding * factor,
            cell=None if self.cell is None else self.cell * factor,
        )


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


def lines_of(stream: BinaryIO, file: Path, kind: str) -> list[str]:
    """Read the lines of a text; a byte order mark is no part of the first.

    Lines end where editors end them. `str.splitlines` also ends them within a line of some titles, at a form
    feed or at U+2028, and every line after that would be another one.
    """
    lines = _LINE_END.split(text_of(stream, file, kind).removeprefix("\ufeff"))
    return lines[:-1] if lines[-1] == "" else lines


def number_of(text: str) -> Decimal | None:
    """Read a number digit by digit; None if it is none, or beyond the range of floating-point numbers."""
    if _NUMBER.fullmatch(text) is None:  # Decimal would read 1_0 too
        return None
    try:
        number = Decimal(text)
    except InvalidOperation:  # an exponent beyond all bounds
        return None
    # Of an ordinary size, without asking for the float, which takes as long as the rest.
    return number if number.adjusted() < 300 or math.isfinite(float(number)) else None


def numbers_of(texts: Iterable[str]) -> list[Decimal] | None:
    """Read numbers; None if one of the texts is none."""
    numbers = [number_of(text) for text in texts]
    found = [number for number in numbers if number is not None]
    return found if len(found) == len(numbers) else None


def molecule_of(stream: BinaryIO, file: Path) -> Molecule:
    """Read a molecule from a file that is open; see :func:`read_xyz`."""
    lines = lines_of(stream, file, "an XYZ file")
    count_text = lines[0].strip() if lines else ""
    if not re.fullmatch(f"[0-9]{{1,{_MOST_DIGITS}}}", count_text) or int(count_text) == 0:
        raise FileFormatError(
            f"{file}: line 1 of an XYZ file is the number of atoms, not {count_text[:40]!r}; write it there"
        )
    count = int(count_text)
    comment = lines[1].strip() if len(lines) > 1 else ""
    entries = _entries(comment)
    columns = _columns(entries, file)
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
    cell = _cell(entries, file)
    if cell is not None:
        notes.append(
            "the lattice of the file is not used: the atoms are taken as they stand, as one molecule"
        )
    if columns.mass:
        notes.append(
            f"the column {columns.mass!r} of the file is not used: masses are those of the labels; "
            "an isotope is written as 18O"
        )
    return molecule_from(labels, coordinates, comment, tuple(notes), cell)


def molecule_from(
    labels: Sequence[str],
    coordinates: Sequence[Sequence[Decimal]],
    comment: str,
    notes: tuple[str, ...] = (),
    cell: NDArray[np.float64] | None = None,
) -> Molecule:
    """Make a molecule of what a file prints, digit by digit."""
    positions = np.array(coordinates, dtype=np.float64)
    rounding = _rounding([x for row in coordinates for x in row])
    return Molecule(tuple(labels), positions, comment, rounding, notes, cell)


class _Columns(NamedTuple):
    """Where the words of an atom stand in its row, how many there are, and the name of a column of masses."""

    label: int = 0
    position: int = 1
    words: int = 4
    mass: str = ""


def _entries(comment: str) -> dict[str, str]:
    """Read ``key=value`` of the second line of extended XYZ, the first of equal keys; in small letters."""
    entries: dict[str, str] = {}
    for match in _ENTRY.finditer(comment):
        if match[1] is not None:
            entries.setdefault(
                match[1].lower(), next(value for value in match.groups()[1:] if value is not None)
            )
    return entries


def _columns(entries: dict[str, str], file: Path) -> _Columns:
    """Find the columns of the symbol and of x, which extended XYZ files name in the second line."""
    if "properties" not in entries:
        return _Columns()
    words = entries["properties"].split(":")
    starts: dict[str, tuple[str, int, int]] = {}
    at = 0
    for name, kind, size in zip(words[::3], words[1::3], words[2::3], strict=False):
        if not re.fullmatch("[0-9]{1,6}", size):
            break
        starts.setdefault(name, (kind, at, int(size)))
        at += int(size)
    kind, label, width = starts.get("species", starts.get("element", ("", -1, 0)))
    letter, first, size_of_position = starts.get("pos", ("", -1, 0))
    if (kind, width) != ("S", 1) or (letter, size_of_position) != ("R", 3):
        raise FileFormatError(
            f"{file}: line 2 declares no columns species:S:1 and pos:R:3 "
            f"(Properties={':'.join(words)[:60]}); write them"
        )
    return _Columns(label, first, at, next((name for name in _MASSES if name in starts), ""))


def _cell(entries: dict[str, str], file: Path) -> NDArray[np.float64] | None:
    """Read the vectors along which the structure repeats; none without a lattice.

    A lattice of plain XYZ, whose second line is free text, may be any word.
    """
    text = entries.get("lattice", "")
    numbers = numbers_of(word for word in re.split(r"[\s,\[\]{}]+", text) if word) or []
    words = re.split(r"[\s,\[\]{}]+", entries.get("pbc", "T T T").strip("[]{} "))
    flags = [_LOGICAL.get(word.lower()) for word in words]
    if len(numbers) == 9 and len(flags) == 3 and None not in flags:
        cell = np.array(numbers, dtype=np.float64).reshape(3, 3)[[bool(flag) for flag in flags]]
        return cell if len(cell) else None
    if "properties" not in entries or "lattice" not in entries:
        return None
    raise FileFormatError(
        f"{file}: line 2: expected Lattice of nine numbers and pbc of three letters T or F, got "
        f"Lattice={text[:60]!r} and pbc={entries.get('pbc', '')[:20]!r}; correct them"
    )


def _atom(file: Path, number: int, row: str, columns: _Columns) -> tuple[str, list[Decimal]]:
    """Split a row into the atom's label and its coordinates, digit by digit."""
    words = row.split()
    coordinates = numbers_of(words[columns.position : columns.position + 3])
    if coordinates is None or len(coordinates) != 3:
        raise FileFormatError(f"{file}: line {number}: expected 'symbol x y z', got {row.strip()[:60]!r}")
    if len(words) < columns.words:
        raise FileFormatError(
            f"{file}: line {number}: expected {columns.words} words, as Properties of line 2 declares, got "
            f"{len(words)}; correct one of the two"
        )
    return words[columns.label], coordinates


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
