"""Molecules as files hold them: XYZ, PDB, and MDL's MOL and SDF (V2000 and V3000)."""

from __future__ import annotations

import math
import re
from contextlib import contextmanager
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final, NamedTuple

import numpy as np

from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import text_of, with_way_out
from polhode.io.content import open_file
from polhode.molecules.nuclides import SYMBOLS, shifted_mass_number

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

__all__ = [
    "Molecule",
    "lines_of",
    "molecule_from",
    "molecule_of",
    "number_of",
    "numbers_of",
    "read_mol",
    "read_pdb",
    "read_xyz",
]

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
    with open_file(file) as content:
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
            file, f": line 1 of an XYZ file is the number of atoms, not {count_text[:40]!r}; write it there"
        )
    count = int(count_text)
    comment = lines[1].strip() if len(lines) > 1 else ""
    entries = _entries(comment)
    columns = _columns(entries, file)
    rows = lines[2 : 2 + count]
    if len(rows) < count:
        raise FileFormatError(
            file,
            f": line 1 promises {count_text[:40]} atoms, but the file holds {len(rows)}; is it cut short?",
        )
    if any(line.strip() for line in lines[2 + count :]):
        raise FileFormatError(
            file, f": text after atom {count}, the last by line 1; correct the count or keep one frame a file"
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
            file,
            f": line 2 declares no columns species:S:1 and pos:R:3 "
            f"(Properties={':'.join(words)[:60]}); write them",
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
        file,
        f": line 2: expected Lattice of nine numbers and pbc of three letters T or F, got "
        f"Lattice={text[:60]!r} and pbc={entries.get('pbc', '')[:20]!r}; correct them",
    )


def _atom(file: Path, number: int, row: str, columns: _Columns) -> tuple[str, list[Decimal]]:
    """Split a row into the atom's label and its coordinates, digit by digit."""
    words = row.split()
    coordinates = numbers_of(words[columns.position : columns.position + 3])
    if coordinates is None or len(coordinates) != 3:
        raise FileFormatError(file, f": line {number}: expected 'symbol x y z', got {row.strip()[:60]!r}")
    if len(words) < columns.words:
        raise FileFormatError(
            file,
            f": line {number}: expected {columns.words} words, as Properties of line 2 declares, got "
            f"{len(words)}; correct one of the two",
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


_HYDROGENS: Final = {"D": 2, "T": 3}
_ELEMENTS: Final = frozenset(symbol.upper() for symbol in (*SYMBOLS, *_HYDROGENS))
_COLUMNS_77: Final = "write the element in columns 77 and 78"
_AMINO_ACIDS: Final = "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL"
_NUCLEOTIDES: Final = "A C G U I DA DC DG DT DU DI"
_BIOPOLYMER: Final = frozenset(f"{_AMINO_ACIDS} {_NUCLEOTIDES}".split())
_LEAST_CELL: Final = 1.0
"""Angstrom between opposite sides: files without a crystal write a cell of 1 by 1 by 1, as PDB prescribes."""
_NO_HYDROGENS: Final = "the file holds no hydrogens: mass and moments are without them; add them first"
_GEOMETRY: Final = (
    "make a geometry in space with all hydrogens first, for example with Open Babel: "
    "obabel drawing.mol -O molecule.mol -h --gen3d"
)
_CRYST1: Final = ((6, 15), (15, 24), (24, 33), (33, 40), (40, 47), (47, 54))
"""Columns of three lengths and three angles."""
_WORD: Final = re.compile(r'(?:"(?:[^"]|"")*"|\([^)]*\)|\[[^\]]*\]|[^\s"(\[])+')
"""Of an atom of V3000: quoted texts and lists may hold spaces."""
_LIST: Final = (
    "an atom stands for a list of elements, a group or any atom, which has no mass; write its atoms there"
)


class _FaultError(ValueError):
    """What is wrong with a line, without the name of the file."""


class _PdbAtom(NamedTuple):
    """What decides between alternate places, and where the atom stands.

    Attributes
    ----------
    site : tuple of str
        Chain, number of the residue with its insertion code, segment.
    residue, name : str
        Of the residue and of the atom.
    alternate : str
        The letter of the place, blank where there is one alone.
    occupancy : float
    label : str
    coordinates : list of Decimal
    """

    site: tuple[str, ...]
    residue: str
    name: str
    alternate: str
    occupancy: float
    label: str
    coordinates: list[Decimal]


def read_pdb(stream: BinaryIO, file: Path) -> Molecule:
    """Read the atoms of a PDB file's first model; see :func:`polhode.io.read_xyz`.

    Of the alternate places of an atom the one with the highest occupancy is taken, the first of equals. Where
    a residue is one of several at its place, it is chosen alike. Files from X-ray diffraction mostly hold no
    hydrogens: the notes say so.
    """
    atoms: list[_PdbAtom] = []
    title: list[str] = []
    cell = None
    models = left = 0
    is_over = False
    for number, line in enumerate(lines_of(stream, file, "a PDB file"), start=1):
        record = line[:6].strip().upper()
        try:
            if record in ("TITLE", "COMPND") and not title:
                title.append(" ".join(line[10:].split()))
            elif record == "CRYST1" and cell is None:
                cell = _crystal_cell(line)
            elif record == "MODEL":
                models += 1
                is_over = is_over or models > 1
            elif record in ("ENDMDL", "END"):
                is_over = is_over or bool(atoms)
            elif record.startswith(("ATOM", "HETATM")):  # a long serial number may begin in column 6
                if is_over:
                    left += 1
                else:
                    atoms.append(_pdb_atom(line))
        except _FaultError as error:
            fault = with_way_out(error, "correct the line")
            raise FileFormatError(file, f": line {number}: {fault}") from None
    if not atoms:
        raise FileFormatError(file, ": holds no ATOM and no HETATM; check the file")
    chosen = _one_place_each(atoms)
    labels = [atom.label for atom in chosen]
    notes = []
    if not _has_hydrogens(labels):
        notes.append(_NO_HYDROGENS)
    if models > 1:
        notes.append(f"the first of {models} models was taken")
    elif left:
        notes.append(f"the first frame was taken, which ends with END or ENDMDL; {left} atoms follow it")
    if len(chosen) < len(atoms):
        notes.append(
            f"{len(atoms) - len(chosen)} atoms at alternate places were left out; of each atom the place "
            "with the highest occupancy was taken"
        )
    return molecule_from(labels, [atom.coordinates for atom in chosen], " ".join(title), tuple(notes), cell)


def _pdb_atom(line: str) -> _PdbAtom:
    if "\t" in line[:80]:
        raise _FaultError("the line holds a tab, but PDB counts columns; write spaces")
    coordinates = _coordinates(line[30:38], line[38:46], line[46:54])
    alternate, occupancy = line[16:17].strip(), 1.0
    if text := line[54:60].strip():
        if (number := number_of(text)) is not None:
            occupancy = float(number)
        elif alternate:  # else it decides nothing
            raise _FaultError(f"expected an occupancy in columns 55 to 60, got {line[54:60]!r}; correct it")
    site = (line[21:22], line[22:27], line[72:76].strip())
    residue = line[17:20].strip()
    return _PdbAtom(site, residue, line[12:16].strip(), alternate, occupancy, _element(line), coordinates)


def _one_place_each(atoms: list[_PdbAtom]) -> list[_PdbAtom]:
    """Choose one residue of each site that has alternatives, and one place of each atom that has some."""
    if not any(atom.alternate for atom in atoms):
        return atoms
    residues: dict[tuple[str, ...], _PdbAtom] = {}
    for atom in atoms:
        best = residues.get(atom.site)
        if atom.alternate and (best is None or best.occupancy < atom.occupancy):
            residues[atom.site] = atom
    rest = [atom for atom in atoms if not atom.alternate or residues[atom.site].residue == atom.residue]
    has_alternatives = {(atom.site, atom.residue, atom.name) for atom in rest if atom.alternate}
    places: dict[tuple[tuple[str, ...], str, str], _PdbAtom] = {}
    for atom in rest:
        key = (atom.site, atom.residue, atom.name)
        if key in has_alternatives and (key not in places or places[key].occupancy < atom.occupancy):
            places[key] = atom
    chosen = {id(atom) for atom in places.values()}
    return [
        atom
        for atom in rest
        if id(atom) in chosen or (atom.site, atom.residue, atom.name) not in has_alternatives
    ]


def _element(line: str) -> str:
    """Read the element of a PDB atom: columns 77-78, else the name of the atom, whose column tells.

    A symbol of two letters begins in column 13, one of a single letter in column 14: ``"CA  "`` is calcium
    and ``" CA "`` an alpha carbon. A name of four letters has no column to choose.
    """
    stated = line[76:78].strip()
    if stated.isalpha():
        if stated.upper() not in _ELEMENTS:
            raise _FaultError(f"columns 77 and 78 hold {stated!r}, which is no element; {_COLUMNS_77}")
        return stated.capitalize()
    field = f"{line[12:16]:4}".upper()
    name, residue = field.strip(), line[17:20].strip().upper()
    if not field[:1].isalpha():
        symbol = name.lstrip("0123456789")[:1]
        if len(name) == 2 and name == residue and name in _ELEMENTS:
            raise _FaultError(
                f"the name {field!r} is {symbol} by its column and {name.capitalize()} by its residue; "
                f"{_COLUMNS_77}"
            )
    elif not field[1].isalpha() or (len(name) == 4 and field[0] in "HD"):
        # The latter are hydrogens whose names take all four columns.
        symbol = field[0]
    elif field[:2] not in _ELEMENTS:
        raise _FaultError(f"the name {field!r} begins with no element of two letters; {_COLUMNS_77}")
    else:
        may_be_one_letter = field[0] in _ELEMENTS and (
            len(name) == 4 or field[2].isalpha() or (field[0] == "H" and residue in _BIOPOLYMER)
        )
        if may_be_one_letter:
            raise _FaultError(
                f"the name {field!r} of residue {residue!r} may be {field[:2].capitalize()} or {field[0]}; "
                f"{_COLUMNS_77}"
            )
        symbol = field[:2]
    if symbol not in _ELEMENTS:
        raise _FaultError(f"the atom {name!r} names no element; {_COLUMNS_77}")
    return symbol.capitalize()


def _crystal_cell(line: str) -> NDArray[np.float64] | None:
    """Read the cell's three vectors: a along x, b in the x-y plane. None where the cell stands for none."""
    numbers = numbers_of(line[start:end].strip() for start, end in _CRYST1)
    if numbers is None:
        raise _FaultError(
            f"expected three lengths and three angles of a cell, got {line[6:54]!r}; correct them"
        )
    a, b, c, *angles = map(float, numbers)
    # Right angles exactly: the cosine of 90 degrees is not zero in floating point.
    cosines = [0.0 if angle == 90.0 else float(np.cos(np.deg2rad(angle))) for angle in angles]
    alpha, beta, gamma = cosines
    sine = float(np.sqrt(max(1.0 - gamma**2, 0.0)))
    if not (min(a, b, c) > 0.0 and sine > 0.0):
        return None
    across = (alpha - beta * gamma) / sine
    height = 1.0 - beta**2 - across**2
    if not height > 0.0:
        return None
    cell = np.array(
        [[a, 0.0, 0.0], [b * gamma, b * sine, 0.0], [c * beta, c * across, c * float(np.sqrt(height))]]
    )
    with np.errstate(all="ignore"):  # of lengths beyond all bounds
        least = 1.0 / np.linalg.norm(np.linalg.inv(cell), axis=0).max()
    return cell if least > _LEAST_CELL else None


def read_mol(stream: BinaryIO, file: Path) -> Molecule:
    """Read the atoms of an MDL file with one molecule; see :func:`polhode.io.read_xyz`."""
    lines = lines_of(stream, file, "a MOL or SDF file")
    end = next((number for number, line in enumerate(lines) if line.startswith("$$$$")), len(lines))
    if any(line.strip() for line in lines[end + 1 :]):
        raise FileFormatError(file, ": holds more than one molecule; keep one a file")
    lines = lines[:end]
    notes: list[str] = []
    try:
        if len(lines) < 4:
            raise _FaultError("it has fewer than four lines; is it cut short?")
        if "V3000" in lines[3]:
            labels, rows = _of_v3000(lines)
        else:
            labels, rows = _of_v2000(lines, notes)
        is_flat = all(row[2] == 0 for row in rows)
        if lines[1][20:22].upper() == "2D":
            if is_flat:
                raise _FaultError(
                    "line 2 says 2D: a drawing, not a geometry, and mostly without its hydrogens; "
                    f"{_GEOMETRY}"
                )
            notes.append("line 2 says 2D, but z differs from zero: taken as a geometry in space")
    except _FaultError as error:
        raise FileFormatError(file, f": {with_way_out(error, 'export it again')}") from None
    if not _has_hydrogens(labels):
        notes.append(_NO_HYDROGENS)
    if len(rows) > 1 and is_flat:
        notes.append("all z are zero: a drawing in the plane has no bond lengths of its own; check the file")
    return molecule_from(labels, rows, lines[0].strip(), tuple(notes))


def _of_v2000(lines: list[str], notes: list[str]) -> tuple[list[str], list[list[Decimal]]]:
    count = _whole_number(lines[3][:3])
    if count is None or count == 0:
        raise _FaultError(f"line 4: expected the number of atoms, got {lines[3][:40]!r}")
    lists = _whole_number(lines[3][6:9]) or 0
    if len(lines) < 4 + count or not any(line.startswith("M  END") for line in lines[4 + count :]):
        raise _FaultError(f"line 4 promises {count} atoms, or 'M  END' is missing; is it cut short?")
    symbols, rows, differences = [], [], []
    for number, line in enumerate(lines[4 : 4 + count], start=5):
        with _line(number):
            if "\t" in line:
                raise _FaultError("the line holds a tab, but V2000 counts columns; write spaces")
            rows.append(_coordinates(line[:10], line[10:20], line[20:30]))
            symbols.append(_symbol(line[31:34].strip()))
            differences.append(_mass_difference(line[34:36]))
    if lists:
        raise _FaultError(f"line 4: {_LIST}")
    stated: dict[int, int] = {}
    has_isotopes = False
    place = 4 + count  # lines of bonds begin with numbers, whatever their count in line 4 is
    while place < len(lines) and not (line := lines[place]).startswith("M  END"):
        place += 1
        with _line(place):
            if line.startswith(("A  ", "G  ")):  # the next line is a text
                if place < len(lines) and (atom := _whole_number(line[3:6])) and atom <= count:
                    shown = lines[place].strip()[:40]
                    notes.append(f"atom {atom} is shown as {shown!r}: it counts as {symbols[atom - 1]}")
                place += 1
            elif line.startswith("S  SKP"):
                place += _whole_number(line[6:9]) or 0
            elif line.startswith(("M  ALS", "M  RGP")):
                raise _FaultError(_LIST)
            elif line.startswith("M  ISO"):
                has_isotopes = True
                stated.update(_isotope_line(line, count))
    masses = [
        _mass_number(number, symbol, difference, stated.get(number), has_isotopes)
        for number, (symbol, difference) in enumerate(zip(symbols, differences, strict=True), start=1)
    ]
    return [_label(symbol, mass) for symbol, mass in zip(symbols, masses, strict=True)], rows


@contextmanager
def _line(number: int) -> Iterator[None]:
    """Let a fault name the line."""
    try:
        yield
    except _FaultError as error:
        raise _FaultError(f"line {number}: {error}") from None


def _isotope_line(line: str, count: int) -> Iterable[tuple[int, int]]:
    """Read the atoms of ``M  ISO`` and their mass numbers; 0 stands for the element as it is in nature."""
    words = line[9:].split()
    numbers = [_whole_number(word) for word in words]
    promised = _whole_number(line[6:9])
    if promised is None or len(words) != 2 * promised or None in numbers:
        raise _FaultError(
            f"expected 'M  ISO', a count and as many pairs, got {line[:40]!r}; correct the line"
        )
    pairs = [(atom or 0, isotope or 0) for atom, isotope in zip(numbers[::2], numbers[1::2], strict=True)]
    if not all(1 <= atom <= count for atom, _ in pairs):
        raise _FaultError(f"{line[:40]!r} names no atom of the file; correct the line")
    return pairs


def _mass_difference(text: str) -> int:
    match = re.fullmatch(r"[+-]?[0-9]", text.strip() or "0")
    difference = int(match[0]) if match else 99
    if not -3 <= difference <= 4:
        raise _FaultError(
            f"expected a mass difference from -3 to 4 behind the symbol, got {text!r}; "
            "write isotopes as 'M  ISO'"
        )
    return difference


def _mass_number(number: int, symbol: str, difference: int, stated: int | None, has_isotopes: bool) -> int:
    """Find the mass number of an atom of V2000, 0 where no isotope is named.

    ``M  ISO`` lines supersede the differences of all atoms by the standard. Programs keep those of the atoms
    that no such line names, so that this case is refused.
    """
    if difference == 0 or stated is not None:
        return stated or 0
    if has_isotopes:
        raise _FaultError(
            f"line {4 + number}: the mass difference {difference} of {symbol} is not repeated in 'M  ISO', "
            "which replaces it by the standard; write the isotope there, or 0 as the difference"
        )
    if symbol in _HYDROGENS:
        raise _FaultError(
            f"line {4 + number}: {symbol} has a mass difference too; write H, or 0 as the difference"
        )
    try:
        return shifted_mass_number(symbol, difference)
    except PolhodeError as error:
        raise _FaultError(f"line {4 + number}: {error}") from None


def _of_v3000(lines: list[str]) -> tuple[list[str], list[list[Decimal]]]:
    inside = False
    labels: list[str] = []
    rows: list[list[Decimal]] = []
    promised = -1
    for number, line in _join_lines(lines):
        words = line.split()
        if words[:1] == ["COUNTS"] and len(words) > 1 and (count := _whole_number(words[1])) is not None:
            promised = count
        elif words[:2] == ["BEGIN", "ATOM"]:
            inside = True
        elif words[:2] == ["END", "ATOM"]:
            inside = False
        elif inside:
            with _line(number):
                words = _WORD.findall(line)
                if len(words) < 6:
                    raise _FaultError(f"expected 'M  V30 index symbol x y z map', got {line[:60]!r}")
                rows.append(_coordinates(*words[2:5]))
                symbol, mass = _symbol(words[1].strip('"')), 0
                for word in words[6:]:
                    key, _, value = word.partition("=")
                    if key.upper() == "MASS":
                        mass = _stated_mass(value)
                    if key.upper() in ("RGROUPS", "CLASS"):
                        raise _FaultError(_LIST)
                labels.append(_label(symbol, mass))
    if inside or not labels or len(labels) != promised:
        raise _FaultError(f"it promises {promised} atoms and holds {len(labels)}; is it cut short?")
    if not any(line.startswith("M  END") for line in lines):
        raise _FaultError("'M  END' is missing; is it cut short?")
    return labels, rows


def _join_lines(lines: list[str]) -> Iterable[tuple[int, str]]:
    """Read the lines of V3000 without ``M  V30``; one that ends with a hyphen goes on in the next."""
    number, text = 0, ""
    for place, line in enumerate(lines, start=1):
        match = re.fullmatch(r"M\s+V30\s(.*)", line)
        if match is None:
            continue
        number = number or place
        text += match[1].rstrip()
        if text.endswith("-"):
            text = text[:-1]
        else:
            yield number, text
            number, text = 0, ""
    if text:
        yield number, text


def _stated_mass(value: str) -> int:
    match = re.fullmatch(r"([0-9]+)(?:\.0*)?", value)
    if match is None or len(match[1]) > 3:
        raise _FaultError(f"expected MASS= and the mass number of an isotope, got {value[:20]!r}")
    return int(match[1])


def _symbol(text: str) -> str:
    if text.upper() not in _ELEMENTS:
        raise _FaultError(
            f"{text[:20]!r} is no element: it may stand for a list, a group or any atom; "
            "write its atoms there"
        )
    return text.capitalize()


def _label(symbol: str, mass: int) -> str:
    """Join symbol and mass number, 0 where none is stated; that of D and T must be their own, if any."""
    if symbol in _HYDROGENS and mass:
        if mass != _HYDROGENS[symbol]:
            raise _FaultError(f"{symbol} has the mass number {mass}; write H with it")
        return symbol
    return f"{mass}{symbol}" if mass else symbol


def _has_hydrogens(labels: Iterable[str]) -> bool:
    return any(label.lstrip("0123456789") in ("H", *_HYDROGENS) for label in labels)


def _whole_number(text: str) -> int | None:
    text = text.strip()
    return int(text) if re.fullmatch("[0-9]{1,9}", text) else None


def _coordinates(*texts: str) -> list[Decimal]:
    numbers = numbers_of(text.strip() for text in texts)
    if numbers is None:
        raise _FaultError(f"expected three coordinates, got {' '.join(texts)[:60]!r}")
    return numbers
