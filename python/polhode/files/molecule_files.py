"""Molecules of other programs: PDB, and MDL's MOL and SDF (V2000 and V3000)."""

from __future__ import annotations

from decimal import Decimal, InvalidOperation
from typing import TYPE_CHECKING, BinaryIO, Final

from polhode.errors import FileFormatError
from polhode.files.reading import text_of, with_way_out
from polhode.files.xyz import Molecule, molecule_from

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["read_mol", "read_pdb"]

_TWO_LETTERS: Final = frozenset(
    """
    LI BE NE NA MG AL SI CL AR CA SC TI CR MN FE NI CU ZN GA GE AS SE BR KR RB SR ZR NB MO RU RH PD AG CD SB
    TE XE CS BA LA CE PR ND SM EU GD TB DY ER TM YB LU TA RE OS IR PT AU HG TL PB BI TH
    """.split()  # noqa: SIM905
)
_HYDROGENS: Final = ("H", "D", "T")


class _FaultError(ValueError):
    """What is wrong with a line, without the name of the file."""


def read_pdb(stream: BinaryIO, file: Path) -> Molecule:
    """Read the atoms of a PDB file's first model; see :func:`polhode.files.read_xyz`.

    Of alternate places the first is taken. Files from X-ray diffraction mostly hold no hydrogens: the notes
    say so.
    """
    labels: list[str] = []
    rows: list[list[Decimal]] = []
    title: list[str] = []
    models = alternates = 0
    for number, line in enumerate(text_of(stream, file, "a PDB file").splitlines(), start=1):
        record = line[:6].strip()
        if record in ("TITLE", "COMPND") and not title:
            title.append(" ".join(line[10:].split()))
        if record == "MODEL":
            models += 1
        if record not in ("ATOM", "HETATM") or models > 1:
            continue
        if line[16:17] not in ("", " ", "A", "1"):
            alternates += 1
            continue
        try:
            rows.append(_coordinates(line[30:38], line[38:46], line[46:54]))
            labels.append(_element(line))
        except _FaultError as error:
            raise FileFormatError(f"{file}: line {number}: {error}") from None
    if not labels:
        raise FileFormatError(f"{file}: holds no ATOM and no HETATM; check the file")
    notes = []
    if not any(label in _HYDROGENS for label in labels):
        notes.append("the file holds no hydrogens: mass and moments are without them; add them first")
    if models > 1:
        notes.append(f"the first of {models} models was taken")
    if alternates:
        notes.append(f"{alternates} atoms at alternate places were left out; the first places were taken")
    return molecule_from(labels, rows, " ".join(title), tuple(notes))


def _element(line: str) -> str:
    """Give the element of a PDB atom: columns 77-78, else the name of the atom, whose column tells."""
    stated = line[76:78].strip()
    if stated.isalpha():
        return stated.capitalize()
    name = line[12:16]
    letters = name[:2].strip().lstrip("0123456789")
    if name[:1].upper() == "H" and len(name.strip()) == 4:  # a hydrogen whose name takes all four columns
        return "H"
    if name[:1].isalpha() and name[:2].upper() in _TWO_LETTERS and not name[2:].strip().isalpha():
        return name[:2].capitalize()
    first = (letters or name.strip().lstrip("0123456789"))[:1]
    if not first.isalpha():
        raise _FaultError(f"the atom {name.strip()!r} names no element; write it in columns 77 and 78")
    return first.upper()


def read_mol(stream: BinaryIO, file: Path) -> Molecule:
    """Read the atoms of an MDL file with one molecule; see :func:`polhode.files.read_xyz`."""
    text = text_of(stream, file, "a MOL or SDF file")
    records = text.split("$$$$")
    if any(record.strip() for record in records[1:]):
        raise FileFormatError(f"{file}: holds more than one molecule; keep one a file")
    lines = records[0].splitlines()
    try:
        if len(lines) < 4:
            raise _FaultError("it has fewer than four lines; is it cut short?")
        labels, rows = _of_v3000(lines) if "V3000" in lines[3] else _of_v2000(lines)
    except _FaultError as error:
        raise FileFormatError(f"{file}: {with_way_out(error, 'export it again')}") from None
    notes = []
    if not any(label.lstrip("0123456789") in _HYDROGENS for label in labels):
        notes.append("the file holds no hydrogens: mass and moments are without them; add them first")
    if len(rows) > 1 and all(row[2] == 0 for row in rows):
        notes.append("all z are zero: a drawing in the plane has no bond lengths of its own; check the file")
    return molecule_from(labels, rows, lines[0].strip(), tuple(notes))


def _of_v2000(lines: list[str]) -> tuple[list[str], list[list[Decimal]]]:
    count_text = lines[3][:3].strip()
    if not count_text.isdecimal() or int(count_text) == 0:
        raise _FaultError(f"line 4: expected the number of atoms, got {lines[3][:40]!r}")
    count = int(count_text)
    if len(lines) < 4 + count or not any(line.startswith("M  END") for line in lines):
        raise _FaultError(f"line 4 promises {count} atoms, or 'M  END' is missing; is it cut short?")
    labels, rows = [], []
    for number, line in enumerate(lines[4 : 4 + count], start=5):
        try:
            rows.append(_coordinates(line[:10], line[10:20], line[20:30]))
        except _FaultError as error:
            raise _FaultError(f"line {number}: {error}") from None
        labels.append(line[31:34].strip())
    for number, line in enumerate(lines, start=1):
        if line.startswith("M  ISO"):
            words = line[9:].split()
            for atom, isotope in zip(words[::2], words[1::2], strict=False):
                if not (atom.isdecimal() and isotope.isdecimal() and 1 <= int(atom) <= count):
                    raise _FaultError(
                        f"line {number}: {line[:40]!r} names no atom of the file; correct the line"
                    )
                labels[int(atom) - 1] = f"{int(isotope)}{labels[int(atom) - 1].lstrip('0123456789')}"
    return labels, rows


def _of_v3000(lines: list[str]) -> tuple[list[str], list[list[Decimal]]]:
    inside = False
    labels: list[str] = []
    rows: list[list[Decimal]] = []
    promised = -1
    for number, line in enumerate(lines, start=1):
        words = line.split()
        if words[:3] == ["M", "V30", "COUNTS"] and len(words) > 3 and words[3].isdecimal():
            promised = int(words[3])
        elif words[:4] == ["M", "V30", "BEGIN", "ATOM"]:
            inside = True
        elif words[:4] == ["M", "V30", "END", "ATOM"]:
            inside = False
        elif inside:
            if len(words) < 7 or line.rstrip().endswith("-"):
                raise _FaultError(f"line {number}: expected 'M V30 index symbol x y z', got {line[:60]!r}")
            mass = next((word[5:] for word in words[7:] if word.startswith("MASS=")), "")
            rows.append(_coordinates(*words[4:7]))
            labels.append(f"{mass}{words[3]}")
    if inside or not labels or len(labels) != promised:
        raise _FaultError(f"it promises {promised} atoms and holds {len(labels)}; is it cut short?")
    return labels, rows


def _coordinates(*texts: str) -> list[Decimal]:
    try:
        numbers = [Decimal(text.strip()) for text in texts]
    except InvalidOperation:
        numbers = []
    if len(numbers) != 3 or not all(number.is_finite() for number in numbers):
        raise _FaultError(f"expected three coordinates, got {' '.join(texts)[:60]!r}")
    return numbers
