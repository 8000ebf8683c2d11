"""``polhode molecule``: what a spectroscopist reads off a molecule."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._format import with_sigma
from polhode.cli.atoms import atoms_of
from polhode.cli.files import as_file, label
from polhode.cli.layout import NOT_LINEAR, ROUNDING, Cell, Column, Field, Report, Table, number
from polhode.cli.loading import LoadedBody, bond_sigma, loaded_molecule
from polhode.cli.tables import (
    FileUnits,
    Sigmas,
    angle_field,
    body_fields,
    moments_slopes,
    note_linear,
    sigmas_of,
    tensor_fields,
    top_fields,
    trust_fields,
)
from polhode.errors import PolhodeError
from polhode.io.content import EXPECTED_CONTENT, MOLECULE_SUFFIXES, is_molecule, unread
from polhode.io.formats import load, molecule_isotopes
from polhode.io.unpacked import inner_suffix
from polhode.molecules import (
    Isotope,
    inertial_defect,
    isotopes,
    planar_moments,
    ray_kappa,
    rotational_constants,
    rotational_constants_sigma,
)
from polhode.uncertainty.propagation import propagate
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode import RigidBody
    from polhode.cli.options import MoleculeOptions

    Floats = NDArray[np.float64]

__all__ = [
    "atoms_report",
    "constant_fields",
    "isotopologue_row",
    "molecule_report",
    "note_straightening",
    "rotation_fields",
]

_BY_NUMBER = re.compile(r"(?P<atom>\d+)=(?P<label>\w+)")


def molecule_report(file: Path, options: MoleculeOptions) -> Report:
    """Report on the rotation of the molecule in a file, and of isotopologues of it."""
    with as_file(file) as path:
        if not is_molecule(path):
            suffix = inner_suffix(path)
            if suffix not in EXPECTED_CONTENT:
                raise unread(file, suffix, MOLECULE_SUFFIXES)
            raise PolhodeError(
                f"{label(file)}: a molecule is an XYZ, PDB, MOL or SDF file; polhode report reads meshes"
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
            changed = _substitute_isotopes(atoms, text)
            rows.append(isotopologue_row(_formula(changed), at.body(changed, options.masses), options.rtol))
        columns = (
            Column("isotopes", "isotopes"),
            Column("rotational_constants_MHz", "A  B  C", "MHz", 3),
            Column("inertial_defect", "inertial defect", "u angstrom^2", 6),
            Column("ray_kappa", "kappa", "", 6),
            Column("top", "top"),
        )
        report.section("isotopologues", Table("isotopologues", columns, rows))
    report.notes += note_straightening(loaded.body, options.rtol)
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
    report.notes += [*note_straightening(loaded.body), *loaded.notes]
    note_linear(report)
    return report


def _head(report: Report, file: Path, atoms: list[Isotope], loaded: LoadedBody) -> None:
    counts, body = Counter(atoms), loaded.body
    report.section(
        "",
        Field("file", "file", label(file)),
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
                **(Sigmas(sigma=atom.sigma, linear=True) if loaded.has_mass_sigmas else {}),
            )
            for atom in counts
        ),
        Field("mass", "mass", body.mass, "u", decimals=9, **sigmas_of(body, "mass")),
        Field(
            "center_of_mass",
            "centre of mass",
            body.center_of_mass,
            "angstrom",
            scale=loaded.extent,
            **sigmas_of(body, "center_of_mass"),
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


def _substitute_isotopes(atoms: list[Isotope], text: str) -> list[Isotope]:
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


_UNIT: Final = "u angstrom^2"
_LARGE: Final = 0.043
"""Relative sigma of a moment above which its reciprocal has another one by a percent."""
_PLANAR: Final = 0.5 * np.array([[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0]])
_DEFECT: Final = np.array([-1.0, -1.0, 1.0])


class _Moments(NamedTuple):
    """Principal moments; what one sigma of each variable does to them; where the first order is enough."""

    values: Floats
    slopes: Floats | None
    linear: NDArray[np.bool_]

    @property
    def sigma(self) -> Floats | None:
        return None if self.slopes is None else np.sqrt((self.slopes**2).sum(axis=0))

    def sigmas(self) -> Sigmas:
        return {} if self.slopes is None else {"sigma": self.sigma, "linear": self.linear}

    def told_of_constants(self, unit: Any) -> Sigmas:
        sigma = self.sigma
        if sigma is None:
            return {}
        linear = self.linear & (sigma <= _LARGE * self.values)
        return {
            "sigma": rotational_constants_sigma(self.values, sigma, unit),
            "linear": linear | (self.values == 0.0),
        }


class _DerivedSigmas(NamedTuple):
    """What is told of numbers that follow from the moments, of which those sigmas may cancel."""

    defect: Sigmas
    planar: Sigmas
    kappa: Sigmas


def _derive_sigmas(body: RigidBody, moments: _Moments, top: str) -> _DerivedSigmas:
    """Compute the sigmas of inertial defect, planar moments and Ray's kappa.

    Where first-order terms cancel, as those of kappa do for a molecule that is as symmetric as water, the
    moments' own flags tell nothing: draws along the body's covariance do. Numbers are raised by their scale,
    so that what is zero counts as zero.
    """
    if moments.slopes is None:
        return _DerivedSigmas({}, {}, {})
    a, b, c = constants = rotational_constants(moments.values)
    by_constants = np.zeros(3)
    if top == "asymmetric":
        by_constants = np.array([-2.0 * (b - c), 2.0 * (a - c), 2.0 * (b - a)]) / (a - c) ** 2
        by_constants *= -constants / moments.values
    weights = np.vstack([_DEFECT, _PLANAR, by_constants])
    sigma = np.sqrt(((moments.slopes @ weights.T) ** 2).sum(axis=0))

    def raise_by_scale(one: RigidBody) -> Floats:
        values = one.principal_moments
        if top == "linear":
            along = planar_moments(values)[0]
            values = np.array([0.0, along, along])
        kappa = ray_kappa(rotational_constants(values)) if top == "asymmetric" else 0.0
        scale = float(moments.values[2])
        return np.array([inertial_defect(values) + scale, *(planar_moments(values) + scale), kappa + 2.0])

    linear = propagate(raise_by_scale, body).linear
    return _DerivedSigmas(
        Sigmas(sigma=sigma[0], linear=linear[0]),
        Sigmas(sigma=sigma[1:4], linear=linear[1:4]),
        Sigmas(sigma=sigma[4], linear=linear[4]),
    )


def _moments(body: RigidBody, rtol: float | None = None) -> _Moments:
    """Compute the principal moments; those of a linear molecule from positions along its axis alone.

    By the last digits of its file it may be bent. Then Ia is 0 and Ib = Ic is Paa, the sum of m a^2, which is
    what one straight line has; Ia = 0 beside the other two as they stand would be no body's.
    """
    moments, slopes = body.principal_moments, moments_slopes(body)
    linear = np.full(3, True) if body.sigma is None else np.asarray(body.sigma.linear.principal_moments)
    if body.principal.classify(rtol) != "linear":
        return _Moments(moments, slopes, linear)
    along = planar_moments(moments)[0]
    if slopes is not None:
        slopes = slopes @ np.array([np.zeros(3), _PLANAR[0], _PLANAR[0]]).T
    linear = np.array([True, linear[1:].all(), linear[1:].all()])
    return _Moments(np.array([0.0, along, along]), slopes, linear)


def note_straightening(body: RigidBody, rtol: float | None = None) -> list[str]:
    """Return a note where a molecule counts as linear although the last digits of its file bend it."""
    least = body.principal_moments[0]
    if least == 0.0 or body.principal.classify(rtol) != "linear":
        return []
    return [
        f"by its last digits not quite straight, Ia = {least:.3g} u angstrom^2; the constants are those of "
        "the atoms' places along the axis, Ia = 0 and Ib = Ic = Paa"
    ]


def constant_fields(body: RigidBody, rtol: float | None = None) -> list[Field]:
    """Compute the rotational constants, and of an asymmetric top Ray's kappa."""
    moments = _moments(body, rtol)
    frequencies = rotational_constants(moments.values, "MHz")
    waves = rotational_constants(moments.values, "cm^-1")
    of_frequencies, of_waves = (moments.told_of_constants(unit) for unit in ("MHz", "cm^-1"))
    fields = [
        Field("rotational_constants_MHz", "A  B  C", frequencies, "MHz", decimals=3, **of_frequencies),
        Field("rotational_constants_cm^-1", "", waves, "cm^-1", decimals=6, **of_waves),
    ]
    top = str(body.principal.classify(rtol))
    if top == "asymmetric":
        kappa = float(ray_kappa(frequencies))
        of_kappa = _derive_sigmas(body, moments, top).kappa
        fields.append(Field("ray_kappa", "Ray's kappa", kappa, scale=1.0 if of_kappa else 0.0, **of_kappa))
    return fields


def rotation_fields(loaded: LoadedBody, rtol: float | None) -> list[Field]:
    """Compute the class of the top, moments, axes and constants of a molecule."""
    body = loaded.body
    moments = _moments(body, rtol)
    values, scale = moments.values, float(moments.values[2])
    derived = _derive_sigmas(body, moments, str(body.principal.classify(rtol)))
    return [
        *top_fields(loaded, rtol),
        Field("principal_moments", "Ia Ib Ic", values, _UNIT, **moments.sigmas()),
        Field("axes", "axes a b c", body.principal.axes, hint="columns", scale=1.0),
        *angle_field(body),
        *constant_fields(body, rtol),
        Field(
            "inertial_defect",
            "inertial defect",
            inertial_defect(values),
            _UNIT,
            "Ic - Ia - Ib",
            scale=scale,
            **derived.defect,
        ),
        Field(
            "planar_moments",
            "planar Paa Pbb Pcc",
            planar_moments(values),
            _UNIT,
            scale=scale,
            **derived.planar,
        ),
    ]


def isotopologue_row(name: str, body: RigidBody, rtol: float | None) -> dict[str, Any]:
    """Return of one isotopologue, as the fields above."""
    moments = _moments(body, rtol)
    values = moments.values
    constants = rotational_constants(values, "MHz")
    top = str(body.principal.classify(rtol))
    row = {
        "isotopes": name,
        "mass": float(body.mass),
        "principal_moments": values,
        "rotational_constants_MHz": constants,
        "rotational_constants_cm^-1": rotational_constants(values, "cm^-1"),
        "inertial_defect": float(inertial_defect(values)),
        "planar_moments": planar_moments(values),
        "ray_kappa": float(ray_kappa(constants)) if top == "asymmetric" else None,
        "top": top,
    }
    if body.sigma is None:
        return row
    derived = _derive_sigmas(body, moments, top)
    tellings = {
        "mass": Sigmas(sigma=body.sigma.mass, linear=body.sigma.linear.mass),
        "principal_moments": moments.sigmas(),
        "rotational_constants_MHz": moments.told_of_constants("MHz"),
        "rotational_constants_cm^-1": moments.told_of_constants("cm^-1"),
        "inertial_defect": derived.defect,
        "planar_moments": derived.planar,
    }
    if top == "asymmetric":
        tellings["ray_kappa"] = derived.kappa
    for key, decimals in (("rotational_constants_MHz", 3), ("inertial_defect", 6), ("ray_kappa", 6)):
        if row[key] is not None:
            scale = float(values[2]) if key == "inertial_defect" else 0.0
            row[key] = Cell(_text(row[key], tellings[key], decimals, scale), row[key])
    return {
        **row,
        "sigma": {key: told["sigma"] for key, told in tellings.items()},
        "linear": {key: told["linear"] for key, told in tellings.items()},
    }


def _text(value: Any, told: Sigmas, decimals: int, scale: float) -> str:
    sigmas, flags = np.ravel(np.asarray(told["sigma"])), np.ravel(np.asarray(told["linear"]))
    words = []
    for x, sigma, is_linear in zip(np.ravel(value).tolist(), sigmas.tolist(), flags.tolist(), strict=True):
        text = with_sigma(x, sigma) if sigma > ROUNDING * max(abs(x), scale) else number(x, decimals)
        words.append(text if is_linear else f"{text}{NOT_LINEAR}")
    return "  ".join(words)
