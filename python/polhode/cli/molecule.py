"""``polhode molecule``: what a spectroscopist reads off a molecule."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.loading import LoadedBody
from polhode.cli.source import as_file, shown
from polhode.cli.tables import FileUnits, body_fields, tensor_fields, top_fields, trust_fields
from polhode.errors import PolhodeError
from polhode.files.body import molecule_isotopes
from polhode.files.content import MOLECULE_SUFFIX
from polhode.files.loaded import load
from polhode.molecules import (
    Isotope,
    body_of_atoms,
    inertial_defect,
    isotopes,
    planar_moments,
    ray_kappa,
    rotational_constants,
)
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from pathlib import Path

    from polhode import RigidBody
    from polhode.cli.options import MoleculeOptions
    from polhode.files.xyz import Molecule

__all__ = ["atoms_report", "molecule_report"]

_BY_NUMBER = re.compile(r"(?P<atom>\d+)=(?P<label>\w+)")


def molecule_report(file: Path, options: MoleculeOptions) -> Report:
    """Report on the rotation of the molecule in a file, and of isotopologues of it."""
    with as_file(file) as path:
        if path.suffix.lower() != MOLECULE_SUFFIX:
            raise PolhodeError(f"{shown(file)}: a molecule is an XYZ file; polhode report reads meshes")
        molecule = load(path).molecule
        atoms = molecule_isotopes(path, molecule, options.masses)
    to_angstrom = metres_per(options.length_unit) / METRES["angstrom"]
    molecule = molecule._replace(
        positions=molecule.positions * to_angstrom, rounding=molecule.rounding * to_angstrom
    )
    loaded = _loaded(atoms, molecule, options)
    report = Report()
    _head(report, file, atoms, loaded)
    report.section("rotation", *_rotation_fields(loaded, options.rtol))
    if options.isotopes:
        rows = [_row("as above", loaded.body, options.rtol)]
        for text in options.isotopes:
            changed = _substituted(atoms, text)
            rows.append(_row(_formula(changed), _loaded(changed, molecule, options).body, options.rtol))
        columns = (
            Column("isotopes", "isotopes"),
            Column("rotational_constants_MHz", "A  B  C", "MHz", 3),
            Column("inertial_defect", "inertial defect", "u angstrom^2", 6),
            Column("ray_kappa", "kappa", "", 6),
            Column("top", "top"),
        )
        report.section("isotopologues", Table("isotopologues", columns, rows))
    report.notes += _straightened(loaded.body, options.rtol)
    masses = "masses of isotopes, not averages"
    if options.masses == "average":
        masses = "masses are averages over the isotopes of an element, which no single molecule has"
    report.notes.append(f"{masses}; moments of the geometry as it stands, without zero-point motion")
    return report


def atoms_report(
    file: Path, loaded: LoadedBody, atoms: list[Isotope], about: tuple[float, float, float] | None
) -> Report:
    """Report the mass properties of a molecule, as ``polhode report`` does."""
    report = Report()
    _head(report, file, atoms, loaded)
    report.section("inertia, file axes", *tensor_fields(loaded, FileUnits(), about))
    report.section("principal axes", *body_fields(loaded, FileUnits()))
    report.section("rotational constants", *_constant_fields(loaded.body))
    report.section("trust", *trust_fields(loaded))
    report.notes += _straightened(loaded.body)
    return report


def _loaded(atoms: list[Isotope], molecule: Molecule, options: MoleculeOptions) -> LoadedBody:
    masses = [atom.mass for atom in atoms]
    body = body_of_atoms(masses, molecule.positions, source=options.masses, rounding=molecule.rounding)
    return LoadedBody(body=body, source=atoms, mass_unit="u", length="angstrom", comment=molecule.comment)


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
            Field(f"isotope_masses.{atom.name}", f"mass of {atom.name}", atom.mass, "u", decimals=9)
            for atom in counts
        ),
        Field("mass", "mass", body.mass, "u", decimals=9),
        Field("center_of_mass", "centre of mass", body.center_of_mass, "angstrom", scale=loaded.extent),
    )


def _moments(body: RigidBody, rtol: float | None = None) -> Any:
    """Principal moments; of a linear molecule, from the positions of its atoms along the axis alone.

    By the last digits of its file it may be bent. Then Ia is 0 and Ib = Ic is Paa, the sum of m a^2, which is
    what one straight line has; Ia = 0 beside the other two as they stand would be no body's.
    """
    moments = body.principal_moments
    if body.principal.classify(rtol) != "linear":
        return moments
    along = planar_moments(moments)[0]
    return np.array([0.0, along, along])


def _straightened(body: RigidBody, rtol: float | None = None) -> list[str]:
    """Give a note where a molecule counts as linear although the last digits of its file bend it."""
    least = body.principal_moments[0]
    if least == 0.0 or body.principal.classify(rtol) != "linear":
        return []
    return [
        f"by its last digits not quite straight, Ia = {least:.3g} u angstrom^2; the constants are those of "
        "the atoms' places along the axis, Ia = 0 and Ib = Ic = Paa"
    ]


def _constant_fields(body: RigidBody, rtol: float | None = None) -> list[Field]:
    moments = _moments(body, rtol)
    frequencies = rotational_constants(moments, "MHz")
    fields = [
        Field("rotational_constants_MHz", "A  B  C", frequencies, "MHz", decimals=3),
        Field("rotational_constants_cm^-1", "", rotational_constants(moments, "cm^-1"), "cm^-1", decimals=6),
    ]
    if body.principal.classify(rtol) == "asymmetric":
        fields.append(Field("ray_kappa", "Ray's kappa", ray_kappa(frequencies)))
    return fields


def _rotation_fields(loaded: LoadedBody, rtol: float | None) -> list[Field]:
    body = loaded.body
    moments = _moments(body, rtol)
    unit, scale = "u angstrom^2", float(moments[2])
    return [
        *top_fields(loaded, rtol),
        Field("principal_moments", "Ia Ib Ic", moments, unit),
        Field("axes", "axes a b c", body.principal.axes, hint="columns", scale=1.0),
        *_constant_fields(body, rtol),
        Field(
            "inertial_defect", "inertial defect", inertial_defect(moments), unit, "Ic - Ia - Ib", scale=scale
        ),
        Field("planar_moments", "planar Paa Pbb Pcc", planar_moments(moments), unit, scale=scale),
    ]


def _row(name: str, body: RigidBody, rtol: float | None) -> dict[str, Any]:
    moments = _moments(body, rtol)
    constants = rotational_constants(moments, "MHz")
    top = str(body.principal.classify(rtol))
    return {
        "isotopes": name,
        "mass": float(body.mass),
        "principal_moments": moments,
        "rotational_constants_MHz": constants,
        "rotational_constants_cm^-1": rotational_constants(moments, "cm^-1"),
        "inertial_defect": float(inertial_defect(moments)),
        "planar_moments": planar_moments(moments),
        "ray_kappa": float(ray_kappa(constants)) if top == "asymmetric" else None,
        "top": top,
    }


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
                raise PolhodeError(f"--isotopes: {part.strip()!r}: no atom of the molecule is {symbol}")
        else:
            index = int(by_number["atom"])
            if not 1 <= index <= len(atoms):
                raise PolhodeError(f"--isotopes: {part.strip()!r}: the molecule has atoms 1 to {len(atoms)}")
            held = atoms[index - 1].name.lstrip("0123456789")
            if held != symbol:
                raise PolhodeError(f"--isotopes: {part.strip()!r}: atom {index} of the file is {held}")
            where = [index - 1]
        for i in where:
            changed[i] = isotope
    return changed
