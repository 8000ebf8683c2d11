"""``polhode report``: the mass properties of the body in a file."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from cyclopts import Parameter

from polhode import RigidBody
from polhode.cli.layout import Field, Report, printable
from polhode.errors import PolhodeError
from polhode.io import MOLECULE_SUFFIX, MeshSolid, molecule_isotopes, read_xyz, solid_from_file
from polhode.molecules import Isotope, ray_kappa, rotational_constants
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["BodyOptions", "LoadedBody", "body_fields", "file_report", "load_body"]

LengthUnit = Literal["m", "mm", "cm", "um", "nm", "km", "in", "ft", "angstrom"]
UNKNOWN = "unit unknown"
_LARGE_FILE = 1 << 26


@dataclass(frozen=True, kw_only=True)
class BodyOptions:
    """How to read the file.

    Attributes
    ----------
    density
        Density: kg/m^3 if the length unit is given.
    mass
        Mass instead of density: kg if the length unit is given.
    length_unit
        Unit of the file's coordinates; results are then in SI units.
    weld
        Make corners at most this far apart one, in the unit of the file; without it only equal ones are.
    orient
        Turn triangles that face inward; without it they are an error.
    index_base
        What the faces of an OBJ or plate file count vertices from: 1 (OBJ) or 0.
    """

    density: Annotated[float | None, Parameter(name="--density")] = None
    mass: Annotated[float | None, Parameter(name="--mass")] = None
    length_unit: Annotated[LengthUnit | None, Parameter(name="--length-unit")] = None
    weld: Annotated[float, Parameter(name="--weld")] = 0.0
    orient: Annotated[bool, Parameter(name="--orient", negative="")] = False
    index_base: Annotated[Literal[0, 1], Parameter(name="--index-base")] = 1


@dataclass(frozen=True)
class LoadedBody:
    """A body with what its file and the options say about it.

    Attributes
    ----------
    body : RigidBody
        In kg and m, in u and angstrom (molecules), or in the file's own units.
    source : MeshSolid or list of Isotope
        What was read: a mesh or the nuclides of a molecule.
    comment : str
        A molecule's comment.
    mass_unit, length : str
        Names of the units of `body`.
    density : float
        Of a mesh; not a number for a molecule.
    volume : float
        Of a mesh; not a number for a molecule.
    assumed : bool
        Whether neither density nor mass was given, and density 1 was taken.
    notes : tuple of str
        What was done to the mesh on request.
    """

    body: RigidBody
    source: MeshSolid | list[Isotope]
    mass_unit: str
    length: str
    comment: str = ""
    density: float = float("nan")
    volume: float = float("nan")
    assumed: bool = False
    notes: tuple[str, ...] = ()

    @property
    def moment_unit(self) -> str:
        """Unit of a moment of inertia."""
        return f"{self.mass_unit} {self.length}^2"

    @property
    def extent(self) -> float:
        """A length of the body's own: its distance from the origin and its largest radius of gyration."""
        return float(np.linalg.norm(self.body.center_of_mass) + self.body.radii_of_gyration.max())


def load_body(file: Path, options: BodyOptions) -> LoadedBody:
    """Read the body in a file."""
    if file.suffix.lower() == MOLECULE_SUFFIX:
        return _load_molecule(file, options)
    if options.density is not None and options.mass is not None:
        raise PolhodeError(
            "--density and --mass: give one of the two, since the other follows from the volume"
        )
    scale = 1.0 if options.length_unit is None else metres_per(options.length_unit)
    assumed = options.density is None and options.mass is None
    density = 1.0 if assumed else options.density
    solid = solid_from_file(
        file,
        density=density,
        mass=options.mass,
        scale=scale,
        weld=options.weld,
        orient=options.orient,
        index_base=options.index_base,
        progress=_progress(file),
    )
    notes: tuple[str, ...] = ()
    if options.weld != 0.0:
        notes = (f"{solid.welded} corners were joined to others within {options.weld:g} (--weld)",)
    return LoadedBody(
        body=solid.body,
        source=solid,
        mass_unit="kg" if options.length_unit is not None else "mass",
        length="m" if options.length_unit is not None else "unit",
        density=float(solid.body.mass) / solid.volume if density is None else density,
        volume=solid.volume,
        assumed=assumed,
        notes=notes,
    )


def _progress(file: Path) -> Callable[[float], object] | None:
    """Tell a terminal how much of a large file is done."""
    if not sys.stderr.isatty() or not file.is_file() or file.stat().st_size < _LARGE_FILE:
        return None

    def tell(fraction: float) -> None:
        line = f"\rreading {printable(file.name)}: {fraction:4.0%}" if fraction < 1.0 else "\r\x1b[K"
        print(line, end="", file=sys.stderr, flush=True)

    return tell


def _load_molecule(file: Path, options: BodyOptions) -> LoadedBody:
    if options.density is not None or options.mass is not None:
        given = "--density" if options.density is not None else "--mass"
        raise PolhodeError(f"{given}: {file} is a molecule, whose atoms have their own masses; leave it out")
    for given, is_given in (
        ("--weld", options.weld != 0.0),
        ("--orient", options.orient),
        ("--index-base", options.index_base != 1),
    ):
        if is_given:
            raise PolhodeError(f"{given}: {file} is a molecule, not a mesh; leave it out")
    molecule = read_xyz(file)
    atoms = molecule_isotopes(file, molecule)
    in_angstrom = metres_per(options.length_unit or "angstrom") / METRES["angstrom"]
    body = RigidBody.from_particles([atom.mass for atom in atoms], molecule.positions * in_angstrom)
    return LoadedBody(body=body, source=atoms, mass_unit="u", length="angstrom", comment=molecule.comment)


def file_report(file: Path, options: BodyOptions) -> Report:
    """Report on the body in a file."""
    loaded = load_body(file, options)
    report = Report()
    if isinstance(loaded.source, MeshSolid):
        _mesh_sections(report, file, loaded, loaded.source, options)
    else:
        _molecule_sections(report, file, loaded, loaded.source)
    return report


def _mesh_sections(
    report: Report, file: Path, loaded: LoadedBody, mesh: MeshSolid, options: BodyOptions
) -> None:
    unit, body = options.length_unit, loaded.body
    report.section(
        "",
        Field("file", "file", str(file)),
        Field("format", "format", mesh.format),
        Field(
            "length_unit",
            "length unit",
            unit or UNKNOWN,
            hint="" if unit else "(state it with --length-unit)",
        ),
    )
    vertices = [] if mesh.vertices is None else [Field("vertices", "vertices", mesh.vertices)]
    shape = [
        *vertices,
        Field("faces", "faces", mesh.faces),
        *_with_file_unit("volume", "volume", loaded.volume, 3, loaded=loaded, unit=unit),
        *_with_file_unit("area", "surface area", mesh.area, 2, loaded=loaded, unit=unit),
    ]
    report.section("shape", *shape)
    report.section(
        "mass",
        Field("density", "density", loaded.density, f"{loaded.mass_unit}/{loaded.length}^3"),
        Field("mass", "mass", body.mass, loaded.mass_unit),
        *_with_file_unit(
            "center_of_mass", "centre of mass", body.center_of_mass, 1, loaded=loaded, unit=unit
        ),
    )
    report.section("inertia, file axes", *_tensor_fields(loaded))
    report.section("principal axes", *body_fields(loaded, unit))
    report.section("trust", *_trust_fields(loaded))
    report.notes += loaded.notes
    if loaded.assumed:
        report.notes.append(
            "neither density nor mass was given: density 1 was used (state --density or --mass)"
        )
    if unit is None:
        report.notes.append("unit unknown: all results are in the file's own unit of length")


def _molecule_sections(report: Report, file: Path, loaded: LoadedBody, atoms: list[Isotope]) -> None:
    body = loaded.body
    counts = Counter(atoms)
    report.section(
        "",
        Field("file", "file", str(file)),
        Field("comment", "comment", loaded.comment),
        Field("isotopes", "isotopes", ", ".join(f"{n} {atom.name}" for atom, n in counts.items())),
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
    report.section("inertia, file axes", *_tensor_fields(loaded))
    report.section("principal axes", *body_fields(loaded, None))
    moments = body.principal_moments
    top = body.principal.top
    if top == "linear":
        # What the last digit of the coordinates leaves of the first moment is no property of the molecule.
        moments = np.array([0.0, *moments[1:]])
    frequencies = rotational_constants(moments, "MHz")
    fields = [
        Field("rotational_constants_MHz", "A  B  C", frequencies, "MHz", decimals=3),
        Field("rotational_constants_cm^-1", "", rotational_constants(moments, "cm^-1"), "cm^-1", decimals=6),
    ]
    if top == "asymmetric":
        fields.append(Field("ray_kappa", "Ray's kappa", ray_kappa(frequencies)))
    report.section("rotational constants", *fields)
    report.section("trust", *_trust_fields(loaded))


def _tensor_fields(loaded: LoadedBody) -> list[Field]:
    body, unit = loaded.body, loaded.moment_unit
    about_origin = body.inertia_about("origin")
    return [
        Field("inertia_about_center_of_mass", "about C", body.inertia, unit, scale=body.inertia.max()),
        Field("inertia_about_origin", "about O", about_origin, unit, scale=about_origin.max()),
    ]


def _trust_fields(loaded: LoadedBody) -> list[Field]:
    """Where the numbers come from and what rounding can have done to them."""
    provenance, bound = loaded.body.provenance, loaded.body.error_bound
    return [
        Field("provenance", "made of", str(provenance)),
        Field("error_bound.mass", "bound on mass", bound.mass, loaded.mass_unit),
        Field("error_bound.center_of_mass", "  on centre", bound.center_of_mass, loaded.length),
        Field("error_bound.inertia", "  on inertia", bound.inertia, loaded.moment_unit),
    ]


def body_fields(loaded: LoadedBody, unit: str | None) -> list[Field]:
    """Principal moments, axes and class of a body; lengths also in the file's `unit`."""
    body = loaded.body
    principal = body.principal
    per_mass = principal.moments / body.mass
    return [
        Field("principal_moments", "I1 I2 I3", principal.moments, loaded.moment_unit),
        *_with_file_unit("moments_per_mass", "I1 I2 I3 / mass", per_mass, 2, loaded=loaded, unit=unit),
        *_with_file_unit(
            "radii_of_gyration", "radii of gyration", np.sqrt(per_mass), 1, loaded=loaded, unit=unit
        ),
        Field("axes", "e1 e2 e3", principal.axes, hint="columns", scale=1.0),
        Field("gaps", "gaps 2-1, 3-2", principal.gaps, hint="of I3"),
        Field("top", "top", str(principal.top)),
    ]


def _with_file_unit(
    key: str,
    label: str,
    value: float | NDArray[np.float64],
    power: int,
    *,
    loaded: LoadedBody,
    unit: str | None,
) -> list[Field]:
    """Give a length to some power, and where the file has another unit also in that."""
    suffix = f"^{power}" if power > 1 else ""
    scale = loaded.extent if key == "center_of_mass" else 0.0
    fields = [Field(key, label, value, loaded.length + suffix, scale=scale)]
    if unit not in (None, "m"):
        metres = metres_per(unit) ** power
        fields.append(Field(f"in_file_unit.{key}", "", value / metres, unit + suffix, scale=scale / metres))
    return fields
