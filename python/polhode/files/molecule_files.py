"""Molecules of other programs: PDB, and MDL's MOL and SDF (V2000 and V3000)."""

from __future__ import annotations

import re
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO, Final, NamedTuple

import numpy as np

from polhode._nuclides import SYMBOLS, shifted_mass_number
from polhode.errors import FileFormatError, PolhodeError
from polhode.files.reading import with_way_out
from polhode.files.xyz import Molecule, lines_of, molecule_from, number_of, numbers_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from decimal import Decimal
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["read_mol", "read_pdb"]

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
    """Read the atoms of a PDB file's first model; see :func:`polhode.files.read_xyz`.

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
            raise FileFormatError(f"{file}: line {number}: {fault}") from None
    if not atoms:
        raise FileFormatError(f"{file}: holds no ATOM and no HETATM; check the file")
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
    """Read the atoms of an MDL file with one molecule; see :func:`polhode.files.read_xyz`."""
    lines = lines_of(stream, file, "a MOL or SDF file")
    end = next((number for number, line in enumerate(lines) if line.startswith("$$$$")), len(lines))
    if any(line.strip() for line in lines[end + 1 :]):
        raise FileFormatError(f"{file}: holds more than one molecule; keep one a file")
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
        raise FileFormatError(f"{file}: {with_way_out(error, 'export it again')}") from None
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
    for number, line in _joined(lines):
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


def _joined(lines: list[str]) -> Iterable[tuple[int, str]]:
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
