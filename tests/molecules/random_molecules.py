"""Random files of molecules that use every option of their formats, each with what it holds.

Nothing in a file is a real molecule: elements, isotopes and places are drawn, so that whatever a reader
mistakes shows in the mass or in a coordinate.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

__all__ = ["Atom", "Case", "extended_xyz", "mol", "pdb", "v3000", "xyz"]

#: Of one letter and of two, among these all that a name of another element could be taken for.
NUMBERS = {
    "H": 1,
    "He": 2,
    "Li": 3,
    "B": 5,
    "C": 6,
    "N": 7,
    "O": 8,
    "F": 9,
    "Ne": 10,
    "Na": 11,
    "Mg": 12,
    "P": 15,
    "S": 16,
    "Cl": 17,
    "K": 19,
    "Ca": 20,
}
NUMBERS |= {
    "Sc": 21,
    "V": 23,
    "Fe": 26,
    "Co": 27,
    "Ni": 28,
    "Cu": 29,
    "Zn": 30,
    "Se": 34,
    "Br": 35,
    "Y": 39,
    "Cd": 48,
    "Sn": 50,
    "I": 53,
    "Ce": 58,
}
NUMBERS |= {"Ho": 67, "Hf": 72, "W": 74, "Os": 76, "Pt": 78, "Hg": 80, "U": 92, "Np": 93}
ELEMENTS = list(NUMBERS)
#: Isotopes of the most abundance, and others that occur, by mass number.
COMMON = {"H": 1, "B": 11, "C": 12, "N": 14, "O": 16, "F": 19, "P": 31, "S": 32, "Cl": 35, "K": 39}
OTHERS = {"H": 2, "B": 10, "C": 13, "N": 15, "O": 18, "F": 18, "P": 32, "S": 34, "Cl": 37, "K": 41}


@dataclass(frozen=True)
class Atom:
    """Atomic number, mass number (0 for the element as it is found) and place."""

    number: int
    mass_number: int
    place: tuple[float, ...]


@dataclass
class Case:
    """A file and what it holds.

    Attributes
    ----------
    suffix, text : str
    options : list of str
        What the file uses.
    atoms : list of Atom
        What it holds; if `refused` is "always" it holds no molecule.
    refused : str
        "never", "always", or "may": where programs read it differently and the file says no more.
    by_peers : bool
        Whether peers read the same; where not, `options` say why.
    cell : list or None
        Of the lattice or the crystal: three lengths and angles, or vectors.
    """

    suffix: str
    text: str = ""
    options: list[str] = field(default_factory=list)
    atoms: list[Atom] = field(default_factory=list)
    refused: str = "never"
    by_peers: bool = True
    cell: list[float] | None = None


def places(
    rng: np.random.Generator, count: int, decimals: int = 3, size: float = 9.0
) -> list[tuple[float, ...]]:
    """Places that are all different, as printed."""
    while True:
        found = [tuple(row) for row in np.round(rng.uniform(-size, size, (count, 3)), decimals).tolist()]
        if len(set(found)) == count and all(any(row) for row in found):
            return found


def line_ends(rng: np.random.Generator, case: Case, with_mark: bool = True) -> None:
    """Write the file as another system does."""
    if rng.random() < 0.15:
        case.text = case.text.replace("\n", "\r\n")
        case.options.append("CRLF")
    if with_mark and rng.random() < 0.1:
        case.text = "\ufeff" + case.text
        case.options.append("byte order mark")
        case.by_peers = False  # they take the mark for a part of the first line


# PDB -------------------------------------------------------------------------------------------------------


def pdb_name(element: str, rng: np.random.Generator, number: int, case: Case, has_columns: bool) -> str:
    """A name in columns 13 to 16: a single letter stands in the second column, two from the first on."""
    if len(element) == 1:
        return f" {element}{rng.choice(['', str(number % 10), f'{number % 100:02d}'])}".ljust(4)
    tail = str(rng.choice(["", str(number % 10)]))
    if rng.random() < 0.1:
        tail = f"{number % 100:02d}"
        if not has_columns and element[0] in ELEMENTS:
            case.refused = "may"  # a name of four letters may be that of an element with one letter
    return f"{element.upper()}{tail}".ljust(4)


def pdb(rng: np.random.Generator) -> Case:
    case = Case(".pdb")
    has_columns = rng.random() < 0.6
    case.options.append("element columns" if has_columns else "no element columns")
    lines: list[str] = []
    if rng.random() < 0.5:
        lines += ["HEADER    RANDOM", "TITLE     ATOM  1 A TITLE", "REMARK   3 HETATM"]
    if rng.random() < 0.6:
        lengths, angles = np.round(rng.uniform(8.0, 90.0, 3), 3), np.round(rng.uniform(65.0, 115.0, 3), 2)
        if rng.random() < 0.4:
            angles[:] = 90.0
        case.cell = [*lengths.tolist(), *angles.tolist()]
        words = "".join(f"{x:9.3f}" for x in lengths) + "".join(f"{x:7.2f}" for x in angles)
        lines.append(f"CRYST1{words} P 1           1")
        case.options.append("CRYST1")
    elif rng.random() < 0.5:
        lines.append("CRYST1    1.000    1.000    1.000  90.00  90.00  90.00 P 1           1")
        case.options.append("CRYST1 of no crystal")
    has_models = rng.random() < 0.25
    if has_models:
        lines.append("MODEL        1")
        case.options.append("MODEL")
    rows = pdb_residues(rng, case, has_columns)
    lines += rows
    if rng.random() < 0.3:
        lines += ["CONECT    1    2", "TER"]
        case.options.append("CONECT")
    if has_models:
        lines += ["ENDMDL", "MODEL        2", *pdb_residues(rng, Case(""), has_columns)[:2], "ENDMDL"]
    lines.append("END")
    if rng.random() < 0.15:
        lines += [*pdb_residues(rng, Case(""), has_columns)[:2], "END"]
        case.options.append("a second frame after END")
        case.by_peers = False  # RDKit reads on
    if rng.random() < 0.15:
        lines = [line.rstrip() for line in lines]
        case.options.append("no spaces at the ends of lines")
    case.text = "\n".join(lines) + "\n"
    line_ends(rng, case)
    return case


@dataclass
class Residue:
    """What stands in each line of a residue's atoms."""

    record: str
    name: str
    chain: str
    number: int
    code: str
    segment: str
    has_columns: bool

    def line(
        self,
        rng: np.random.Generator,
        serial: int,
        name: str,
        element: str,
        place: tuple[float, ...],
        alternate: str = " ",
        occupancy: float = 1.0,
        residue: str = "",
    ) -> str:
        shown = f"{serial:5d}" if rng.random() < 0.9 else f"A{serial:04d}"  # hybrid-36 from 100,000 on
        columns, charge = "  ", "  "
        if self.has_columns:
            columns = f"{element.upper():>2s}"
            charge = str(rng.choice(["  ", "  ", "2+", "1-"]))
            if len(element) == 1 and rng.random() < 0.1:
                columns = f"{element} "
        numbers = "".join(f"{x:8.3f}" for x in place)
        return (
            f"{self.record:6s}{shown} {name}{alternate}{residue or self.name} {self.chain}{self.number:4d}"
            f"{self.code}   {numbers}{occupancy:6.2f}{10.0:6.2f}      {self.segment}{columns}{charge}"
        )


def pdb_residues(rng: np.random.Generator, case: Case, has_columns: bool) -> list[str]:
    lines: list[str] = []
    number = int(rng.integers(-3, 200))
    for _ in range(int(rng.integers(1, 5))):
        number += 1
        residue = Residue(
            record=str(rng.choice(["ATOM", "HETATM"])),
            name=str(rng.choice(["ALA", "LIG", " DG", "UNL", "HOH", "  U"])),
            chain=str(rng.choice(list("AB1 "))),
            number=number,
            code=str(rng.choice([" ", " ", " ", "A", "P"])),
            segment=str(rng.choice(["    ", "    ", "SEGA"])),
            has_columns=has_columns,
        )
        if residue.code != " ":
            case.options.append("insertion code")
        lines += pdb_atoms(rng, case, residue, len(lines) + 1)
        if rng.random() < 0.2:
            lines.append(f"TER   {len(lines):5d}")
    return lines


def pdb_element(rng: np.random.Generator, has_columns: bool) -> str:
    found = str(rng.choice(ELEMENTS))
    # Without columns 77 and 78 a name that begins with H in column 13 is read either way in a biopolymer.
    return "C" if not has_columns and found[0] == "H" and len(found) == 2 else found


def pdb_atoms(rng: np.random.Generator, case: Case, residue: Residue, serial: int) -> list[str]:
    lines: list[str] = []
    count = int(rng.integers(1, 6))
    kind = rng.choice(["plain", "plain", "places", "residues"])
    at = iter(places(rng, 4 * count))
    for index in range(count):
        element = pdb_element(rng, residue.has_columns)
        if rng.random() < 0.12:
            element = "H"
            name = f"H{index}{int(rng.integers(10))}{rng.choice(['A', 'B', chr(39)])}"  # all four columns
        elif rng.random() < 0.08:
            element, name = "D", f" D{index} "
        else:
            name = pdb_name(element, rng, index, case, residue.has_columns)
        if kind != "plain":  # equal names of a residue are alternatives there
            name = f"{name[:2]}{index}{name[3:]}"[: 4 if name[0] == "H" else 3].ljust(4)
        if kind == "places":
            case.options.append("alternate places")
            weights = [round(float(w), 2) for w in rng.dirichlet([1.0] * int(rng.integers(2, 4)))]
            if rng.random() < 0.3:
                weights[:2] = [0.5, 0.5]
            letters = [str(letter) for letter in rng.permutation(list("BCDA12"))]
            if rng.random() < 0.2:
                letters[0] = " "  # as old files have it
            found = [(w, next(at), letter) for w, letter in zip(weights, letters, strict=False)]
            place = next(p for w, p, _ in found if w == max(weights))
            for w, p, letter in found:
                lines.append(residue.line(rng, serial + len(lines), name, element, p, letter, w))
        elif kind == "residues" and index == 0:
            case.options.append("alternate residues")
            weights = [0.35, 0.65] if rng.random() < 0.5 else [0.5, 0.5]
            other = pdb_element(rng, residue.has_columns)
            pair = [
                (element, name, next(at), residue.name),
                (other, pdb_name(other, rng, 7, case, residue.has_columns), next(at), "SER"),
            ]
            for (e, n, p, r), w, letter in zip(pair, weights, "AB", strict=True):
                lines.append(residue.line(rng, serial + len(lines), n, e, p, letter, w, r))
            element, _, place, _ = pair[1] if weights[1] > weights[0] else pair[0]
        else:
            place = next(at)
            lines.append(residue.line(rng, serial + len(lines), name, element, place))
            if rng.random() < 0.1:
                lines.append("ANISOU" + lines[-1][6:27])
        case.atoms.append(Atom(1, 2, place) if element == "D" else Atom(NUMBERS[element], 0, place))
    return lines


# MOL -------------------------------------------------------------------------------------------------------

QUERIES = ["A", "Q", "*", "L", "R", "R#", "X", "M", "LP", "AH", "QH", "Pol", "R1"]


def header(rng: np.random.Generator, case: Case, name: str) -> list[str]:
    words = str(rng.choice(["3D", "3D", "  "]))
    if rng.random() < 0.08:
        words = "2D"
        case.options.append("2D with z")
    return [name, f"  random  0102030405{words}", str(rng.choice(["", "M  END", "a comment"]))]


def mol(rng: np.random.Generator) -> Case:
    """MOL and SDF of version V2000."""
    case = Case(str(rng.choice([".mol", ".sdf"])))
    count = int(rng.integers(1, 9))
    at = places(rng, count, decimals=4)
    symbols = [str(symbol) for symbol in rng.choice([e for e in ELEMENTS if e in COMMON], count)]
    if rng.random() < 0.3:
        symbols = [str(symbol) for symbol in rng.choice(ELEMENTS, count)]
    masses = [0] * count
    differences = [0] * count
    properties: list[str] = []
    kind = str(rng.choice(["none", "differences", "M  ISO", "both", "D and T"]))
    case.options.append(kind)
    light = [index for index, symbol in enumerate(symbols) if symbol in COMMON]
    if kind in ("differences", "both"):
        for index in light:
            if rng.random() < 0.5:
                masses[index] = OTHERS[symbols[index]]
                differences[index] = masses[index] - COMMON[symbols[index]]
    if kind in ("M  ISO", "both") and light:
        named = [index for index in light if rng.random() < 0.6] or light[:1]
        for index in named:
            masses[index] = OTHERS[symbols[index]]
        for first in range(0, len(named), 3):
            some = named[first : first + 3]
            properties.append(
                f"M  ISO{len(some):3d}" + "".join(f" {index + 1:3d} {masses[index]:3d}" for index in some)
            )
        if any(differences[index] and index not in named for index in range(count)):
            case.refused = "may"  # the standard drops the differences of the others, RDKit keeps them
    written = list(symbols)
    if kind == "D and T":
        for index in range(count):
            if rng.random() < 0.4:
                mass = int(rng.choice([2, 3]))
                symbols[index], written[index], masses[index] = "H", "DT"[mass - 2], mass
    if rng.random() < 0.2:
        written = [symbol.upper() for symbol in written]
        case.options.append("capitals")
    if rng.random() < 0.3:
        properties = ["M  CHG  1   1   1", *properties, "M  RAD  1   1   2"]
        case.options.append("CHG, RAD")
    if rng.random() < 0.1:
        properties += ["A    1", "M  ISO  1   1  99"]
        case.options.append("alias")
    if rng.random() < 0.1:
        properties += ["S  SKP  1", "M  ISO  1   1  99"]
        case.options.append("SKP")
    lists = 0
    if rng.random() < 0.15:
        case.refused = "always"
        how = int(rng.integers(6))
        if how < 3:
            written[int(rng.integers(count))] = str(rng.choice(QUERIES))
        elif how == 3:
            properties.append("M  ALS   1  2 F C   N   ")
        elif how == 4:
            properties.append("M  RGP  1   1   1")
        else:
            lists = 1
        case.options.append("query atoms")
    name = str(rng.choice(["", "name", "M  ISO  1   1  13", "V3000"]))
    lines = header(rng, case, name)
    if rng.random() < 0.08 and "2D with z" not in case.options:
        lines[1] = "  random  01020304052D"
        at = [(x, y, 0.0) for x, y, _ in at]
        case.refused = "always"
        case.options.append("2D")
    bonds = [f"{index:3d}{index + 1:3d}  1  0" for index in range(1, count)] if rng.random() < 0.7 else []
    lines.append(f"{count:3d}{len(bonds):3d}{lists:3d}  0  0  0  0  0  0  0999 V2000")
    for symbol, difference, place in zip(written, differences, at, strict=True):
        numbers = "".join(f"{x:10.4f}" for x in place)
        rest = "" if rng.random() < 0.1 else "  0  0  0  0  0  0  0  0  0  0"
        lines.append(f"{numbers} {symbol:3s}{difference:2d}{rest or '  0'}")
    lines += bonds
    lines += ["  1 F    2   6   7"] * lists
    lines += [*properties, "M  END"]
    if case.suffix == ".sdf":
        lines += [">  <NAME>", "M  ISO  1   1  13", "", "$$$$"]
        if rng.random() < 0.15:
            lines += lines
            case.options.append("two records")
            case.refused = "always"
    if rng.random() < 0.05:
        lines[4] = "\t" + lines[4].lstrip()
        case.options.append("tabs")
        case.refused = "always"
    case.text = "\n".join(lines) + "\n"
    case.atoms = [
        Atom(NUMBERS[symbol], mass, place) for symbol, mass, place in zip(symbols, masses, at, strict=True)
    ]
    line_ends(rng, case)
    return case


def v3000(rng: np.random.Generator) -> Case:
    case = Case(str(rng.choice([".mol", ".sdf"])))
    count = int(rng.integers(1, 7))
    at = places(rng, count, decimals=5)
    lines = [*header(rng, case, ""), "  0  0  0     0  0            999 V3000", "M  V30 BEGIN CTAB"]
    lines += [f"M  V30 COUNTS {count} {max(count - 1, 0)} 0 0 0", "M  V30 BEGIN ATOM"]
    for index, place in enumerate(at, start=1):
        symbol = str(rng.choice(ELEMENTS))
        mass = 0
        written = symbol
        words: list[str] = []
        if symbol in COMMON and rng.random() < 0.5:
            mass = OTHERS[symbol]
            words.append(rng.choice([f"MASS={mass}", f"mass={mass}"]))
            case.options.append("MASS=")
        elif rng.random() < 0.15:
            symbol, mass = "H", int(rng.choice([2, 3]))
            written = "DT"[mass - 2]
            words += [f"MASS={mass}"] if rng.random() < 0.5 else []
            case.options.append("D and T")
        words += [
            str(word) for word in ("CHG=1", "RAD=2", "CFG=1", "VAL=3", "ATTCHPT=1") if rng.random() < 0.15
        ]
        rng.shuffle(words)
        if rng.random() < 0.04:
            written = str(rng.choice(["[C,N]", "NOT[C,N]", "A", "Q", "*", "R#", "Pol"]))
            words += ["RGROUPS=(1 1)"] if written == "R#" else []
            case.refused = "always"
            case.options.append("query atoms")
        line = " ".join([str(index), written, *(f"{x:.5f}" for x in place), "0", *words])
        if rng.random() < 0.15:
            cut = line.index(" ", 4) + 1
            lines += [f"M  V30 {line[:cut]}-", f"M  V30 {line[cut:]}"]
            case.options.append("continued line")
        else:
            lines.append(f"M  V30 {line}")
        case.atoms.append(Atom(NUMBERS[symbol], mass, place))
    lines += ["M  V30 END ATOM", "M  V30 BEGIN BOND"]
    lines += [f"M  V30 {index} 1 {index} {index + 1}" for index in range(1, count)]
    lines += ["M  V30 END BOND", "M  V30 END CTAB", "M  END"]
    if case.suffix == ".sdf":
        lines.append("$$$$")
    case.text = "\n".join(lines) + "\n"
    line_ends(rng, case)
    return case


# XYZ -------------------------------------------------------------------------------------------------------


def xyz_label(rng: np.random.Generator, case: Case, plain: bool) -> tuple[str, int, int]:
    symbol = str(rng.choice(ELEMENTS))
    if plain or rng.random() < 0.5:
        return (symbol.upper() if rng.random() < 0.2 else symbol), NUMBERS[symbol], 0
    case.by_peers = False  # RDKit reads symbols alone
    how = int(rng.integers(3))
    case.options.append(("atomic number", "isotope", "D and T")[how])
    if how == 0 and symbol != "Np":
        return str(NUMBERS[symbol]), NUMBERS[symbol], 0
    if how == 1 and symbol in OTHERS:
        return f"{OTHERS[symbol]}{symbol}", NUMBERS[symbol], OTHERS[symbol]
    return ("D", 1, 2) if rng.random() < 0.5 else ("T", 1, 3)


def xyz(rng: np.random.Generator) -> Case:
    case = Case(".xyz")
    count = int(rng.integers(1, 9))
    form: Callable[[float], str] = rng.choice([repr, *["{:.5f}".format] * 4, "{:12.6e}".format])  # type: ignore[arg-type]
    gap = str(rng.choice([" ", "   ", "\t"]))
    plain = rng.random() < 0.75
    rows = []
    more = rng.random() < 0.15  # RDKit reads neither more columns nor blank lines at the end
    for place in places(rng, count, decimals=5):
        label, number, mass = xyz_label(rng, case, plain)
        rows.append(gap.join([label, *(form(x) for x in place), *(["0.5", "a"] if more else [])]))
        case.atoms.append(Atom(number, mass, place))
    comment = str(
        rng.choice(["", "name", "energy = -3 'lattice", "Lattice=fcc", "a\x0cb", "a\u2028b", "1 2 3"])
    )
    case.options.append(f"comment {comment!r}")
    case.by_peers = case.by_peers and "\u2028" not in comment
    case.text = "\n".join([f"{' ' if rng.random() < 0.2 else ''}{count}", comment, *rows]) + "\n"
    case.text += str(rng.choice(["", "", "", "\n", " \n\n"]))
    line_ends(rng, case)
    return case


def extended_xyz(rng: np.random.Generator) -> Case:
    """Columns in any order, with a lattice and its periods."""
    case = Case(str(rng.choice([".xyz", ".extxyz"])), by_peers=False)
    count = int(rng.integers(1, 9))
    others = [("forces", "R", 3), ("tags", "I", 1), ("charge", "R", 1), ("fixed", "L", 1), ("kind", "S", 1)]
    chosen = [others[i] for i in rng.permutation(len(others))[: int(rng.integers(4))]]
    label = str(rng.choice(["species", "species", "element"]))
    columns = [(label, "S", 1), ("pos", "R", 3), *chosen]
    columns = [columns[i] for i in rng.permutation(len(columns))]
    rows = []
    for place in places(rng, count, decimals=5):
        name, number, mass = xyz_label(rng, case, plain=rng.random() < 0.8)
        words: list[str] = []
        for column, kind, size in columns:
            if column == label:
                words.append(name)
            elif column == "pos":
                words += [repr(x) for x in place]
            else:
                words += [{"R": "9.5", "I": "7", "L": "T", "S": "Fe"}[kind]] * size
        rows.append(" ".join(words))
        case.atoms.append(Atom(number, mass, place))
    entries = ["Properties=" + ":".join(f"{n}:{k}:{s}" for n, k, s in columns)]
    if rng.random() < 0.3:
        entries[0] = 'properties="' + entries[0].partition("=")[2] + '"'
    if rng.random() < 0.7:
        cell = np.round(np.diag(rng.uniform(6.0, 20.0, 3)) + rng.uniform(-2.0, 2.0, (3, 3)), 4)
        entries.append('Lattice="' + " ".join(repr(x) for x in cell.ravel().tolist()) + '"')
        flags = [True, True, True]
        if rng.random() < 0.6:
            flags = (rng.random(3) < 0.6).tolist()
            words = ["T" if flag else "F" for flag in flags]
            if rng.random() < 0.3:
                words = ["true" if flag else "false" for flag in flags]
            entries.append('pbc="' + " ".join(words) + '"')
        case.cell = cell[flags].ravel().tolist() or None
        case.options.append(f"Lattice {flags}")
    elif rng.random() < 0.3:
        entries.append('pbc="F F F"')
    entries += [
        str(e)
        for e in ("energy=-1.5", 'note="Properties=pos:R:3 Lattice=no"', "config_type=a")
        if rng.random() < 0.3
    ]
    entries = [entries[i] for i in rng.permutation(len(entries))]
    case.text = "\n".join([str(count), " ".join(entries), *rows]) + "\n"
    line_ends(rng, case)
    return case


def cases(maker: Callable[[np.random.Generator], Case], seed: int, count: int) -> Iterator[Case]:
    """So many files of one kind, the same for a seed."""
    for number in range(count):
        yield maker(np.random.default_rng([seed, number]))
