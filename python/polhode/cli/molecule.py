"""``polhode molecule``: what a spectroscopist reads off a molecule."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from polhode.cli.atoms import atoms_of
from polhode.cli.constants import constant_fields, isotopologue_row, rotation_fields, straightened
from polhode.cli.layout import Cell, Column, Field, Report, Table
from polhode.cli.loading import LoadedBody, bond_sigma, loaded_molecule
from polhode.cli.sigmas import Told, note_linear, told
from polhode.cli.source import as_file, shown
from polhode.cli.tables import FileUnits, body_fields, tensor_fields, trust_fields
from polhode.errors import PolhodeError
from polhode.files.body import molecule_isotopes
from polhode.files.content import EXPECTED_CONTENT, MOLECULE_SUFFIXES, is_molecule, unread
from polhode.files.loaded import load
from polhode.files.unpacked import inner_suffix
from polhode.molecules import Isotope, isotopes
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.cli.options import MoleculeOptions

__all__ = ["atoms_report", "molecule_report"]

_BY_NUMBER = re.compile(r"(?P<atom>\d+)=(?P<label>\w+)")


def molecule_report(file: Path, options: MoleculeOptions) -> Report:
    """Report on the rotation of the molecule in a file, and of isotopologues of it."""
    with as_file(file) as path:
        if not is_molecule(path):
            suffix = inner_suffix(path)
            if suffix not in EXPECTED_CONTENT:
                raise unread(file, suffix, MOLECULE_SUFFIXES)
            raise PolhodeError(
                f"{shown(file)}: a molecule is an XYZ, PDB, MOL or SDF file; polhode report reads meshes"
            )
        read = load(path)
        molecule = read.molecule
        atoms = molecule_isotopes(path, molecule, options.masses)
    to_angstrom = metres_per(options.length_unit) / METRES["angstrom"]
    molecule = molecule.scaled(to_angstrom)
    sigma = bond_sigma(options.bond_sigma, options.length_unit)
    at = atoms_of(file, atoms, molecule, bond_sigma=sigma, mass_sigmas=options.mass_sigmas)
    loaded = loaded_molecule(at, atoms, molecule, options.masses, read.notes)
    report = Report()
    _head(report, file, atoms, loaded)
    _cell(report, atoms, loaded)
    report.section("rotation", *rotation_fields(loaded, options.rtol))
    if options.isotopes:
        rows = [isotopologue_row("as above", loaded.body, options.rtol)]
        for text in options.isotopes:
            changed = _substituted(atoms, text)
            rows.append(isotopologue_row(_formula(changed), at.body(changed, options.masses), options.rtol))
        columns = (
            Column("isotopes", "isotopes"),
            Column("rotational_constants_MHz", "A  B  C", "MHz", 3),
            Column("inertial_defect", "inertial defect", "u angstrom^2", 6),
            Column("ray_kappa", "kappa", "", 6),
            Column("top", "top"),
        )
        report.section("isotopologues", Table("isotopologues", columns, rows))
    report.notes += straightened(loaded.body, options.rtol)
    masses = "masses of isotopes, not averages"
    if options.masses == "average":
        masses = "masses are averages over the isotopes of an element, which no single molecule has"
    report.notes.append(f"{masses}; moments of the geometry as it stands, without zero-point motion")
    report.notes += loaded.notes
    note_linear(report)
    return report


def atoms_report(
    file: Path, loaded: LoadedBody, atoms: list[Isotope], about: tuple[float, float, float] | None
) -> Report:
    """Report the mass properties of a molecule, as ``polhode report`` does."""
    report = Report()
    _head(report, file, atoms, loaded)
    report.section("inertia, file axes", *tensor_fields(loaded, FileUnits(), about))
    report.section("principal axes", *body_fields(loaded, FileUnits()))
    report.section("rotational constants", *constant_fields(loaded.body))
    report.section("trust", *trust_fields(loaded))
    _cell(report, atoms, loaded)
    report.notes += [*straightened(loaded.body), *loaded.notes]
    note_linear(report)
    return report


def _head(report: Report, file: Path, atoms: list[Isotope], loaded: LoadedBody) -> None:
    counts, body = Counter(atoms), loaded.body
    report.section(
        "",
        Field("file", "file", shown(file)),
        Field("comment", "comment", loaded.comment),
        Field("isotopes", "isotopes", _formula(atoms)),
    )
    report.section(
        "mass",
        Field("atoms", "atoms", len(atoms)),
        *(
            Field(
                f"isotope_masses.{atom.name}",
                f"mass of {atom.name}",
                atom.mass,
                "u",
                decimals=9,
                **(Told(sigma=atom.sigma, linear=True) if loaded.has_mass_sigmas else {}),
            )
            for atom in counts
        ),
        Field("mass", "mass", body.mass, "u", decimals=9, **told(body, "mass")),
        Field(
            "center_of_mass",
            "centre of mass",
            body.center_of_mass,
            "angstrom",
            scale=loaded.extent,
            **told(body, "center_of_mass"),
        ),
    )


def _cell(report: Report, atoms: list[Isotope], loaded: LoadedBody) -> None:
    """Report what crosses the cell of the file, where it has one."""
    found = loaded.crossings
    if found is None:
        return
    columns = (Column("first", "atom"), Column("second", "bonded to"), Column("shift", "moved by cells"))
    rows = [
        {
            "first": Cell(f"{atoms[i].name}({i + 1})", i + 1),
            "second": Cell(f"{atoms[j].name}({j + 1})", j + 1),
            "shift": Cell(" ".join(f"{by:+d}" if by else "0" for by in shift), list(shift)),
        }
        for i, j, shift in found.bonds
    ]
    report.section(
        "cell",
        Field("cell.bonds_across", "bonds across sides", len(found.bonds)),
        Field("cell.fragments", "pieces", found.fragments, hint="as the atoms stand"),
        Field("cell.fragments_joined", "", found.fragments_joined, hint="joined by bonds across sides"),
    )
    if rows:
        report.section("", Table("cell_bonds", columns, rows, most=8))


def _elements(atoms: list[Isotope]) -> str:
    return ", ".join(dict.fromkeys(atom.name.lstrip("0123456789") for atom in atoms))


def _formula(atoms: list[Isotope]) -> str:
    return ", ".join(f"{n} {atom.name}" for atom, n in Counter(atoms).items())


def _substituted(atoms: list[Isotope], text: str) -> list[Isotope]:
    """Put nuclides in: ``18O`` for every oxygen, ``2=13C`` for the second atom of the file."""
    changed = list(atoms)
    for part in text.split(","):
        by_number = _BY_NUMBER.fullmatch(part.strip())
        try:
            (isotope,) = isotopes([by_number["label"] if by_number else part.strip()])
        except PolhodeError as error:
            raise PolhodeError(f"--isotopes: {error}") from None
        symbol = isotope.name.lstrip("0123456789")
        if by_number is None:
            where = [i for i, atom in enumerate(atoms) if atom.name.lstrip("0123456789") == symbol]
            if not where:
                raise PolhodeError(
                    f"--isotopes: {part.strip()!r}: no atom of the molecule is {symbol}; give an isotope "
                    f"of {_elements(atoms)}"
                )
        else:
            index = int(by_number["atom"])
            if not 1 <= index <= len(atoms):
                raise PolhodeError(
                    f"--isotopes: {part.strip()!r}: the molecule has atoms 1 to {len(atoms)}; give one "
                    "of them"
                )
            held = atoms[index - 1].name.lstrip("0123456789")
            if held != symbol:
                raise PolhodeError(
                    f"--isotopes: {part.strip()!r}: atom {index} of the file is {held}; give an isotope "
                    f"of {held}, or another atom"
                )
            where = [index - 1]
        for i in where:
            changed[i] = isotope
    return changed
