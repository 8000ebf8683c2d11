"""``polhode report``: the mass properties of the body in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from polhode.cli.components import add_components
from polhode.cli.files import STDIN, label
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.loading import in_file_unit
from polhode.cli.options import ReportOptions
from polhode.cli.tables import (
    FileUnits,
    Sigmas,
    body_fields,
    ellipsoid_fields,
    note_linear,
    sigmas_of,
    tensor_fields,
    trust_fields,
)
from polhode.cli.whole import any_body, whole_report
from polhode.errors import PolhodeError
from polhode.io.mesh_solid import MeshSolid
from polhode.units import metres_per, quantity, split_vector

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.cli.loading import LoadedBody
    from polhode.cli.options import BodyOptions

__all__ = ["check_alone", "file_report", "for_program"]

UNKNOWN = "unit unknown"
PLAIN = ReportOptions()


def file_report(file: Path | None, options: BodyOptions, extra: ReportOptions = PLAIN) -> Report:
    """Report on the body in a file."""
    if extra.mass_unit is not None:
        quantity(f"1 {extra.mass_unit}", "kg", "--mass-unit")
    loaded = any_body(file, options, with_components=True)
    if extra.mass_unit is not None and isinstance(loaded.source, MeshSolid) and loaded.length_unit is None:
        raise PolhodeError("--mass-unit: the length of the file has no unit; state --length-unit too")
    about = _point(loaded, options, extra)
    if loaded.kind:
        return whole_report(file, loaded, extra.mass_unit, about)
    assert file is not None
    units = FileUnits(loaded.length_unit, extra.mass_unit)
    if isinstance(loaded.source, MeshSolid):
        return _mesh_report(file, loaded, loaded.source, units, about)
    if extra.mass_unit is not None:
        raise PolhodeError(f"--mass-unit: {label(file)} is a molecule, in u and angstrom; leave it out")
    from polhode.cli.molecule import atoms_report

    return atoms_report(file, loaded, loaded.source, about)


def for_program(
    file: Path | None, options: BodyOptions, extra: ReportOptions, form: str | None
) -> tuple[str, list[str]]:
    """Write the mass properties of the body in a file for the program of --as; what has to be noted too."""
    from polhode.interop.programs import to_text

    check_alone(extra, form)
    loaded = any_body(file, options, with_components=True)
    if loaded.mass_unit != "kg" or loaded.length != "m":
        reason = "is a molecule, in u and angstrom" if loaded.mass_unit == "u" else "does not say its unit"
        way_out = "leave --as out" if loaded.mass_unit == "u" else "state --length-unit"
        raise PolhodeError(
            f"--as: other programs take kg and m, and {label(file or STDIN)} {reason}; {way_out}"
        )
    if loaded.assumed:
        raise PolhodeError("--as: neither density nor mass is given; state --density or --mass")
    found = loaded.source.components if isinstance(loaded.source, MeshSolid) else None
    return to_text(loaded.body, str(extra.program)), [*loaded.notes, *(found.notes if found else ())]


def check_alone(extra: ReportOptions, form: str | None) -> None:
    """Refuse what the numbers for the program of --as have no place for."""
    for option, is_given in (
        ("--format", form is not None),
        ("--expect", extra.expect is not None),
        ("--about", extra.about),
        ("--mass-unit", extra.mass_unit is not None),
    ):
        if is_given:
            raise PolhodeError(f"{option}: --as prints the numbers that {extra.program} takes; leave it out")


def _point(
    loaded: LoadedBody, options: BodyOptions, extra: ReportOptions
) -> tuple[float, float, float] | None:
    """Find where --about is, in the unit of the body."""
    if not extra.about:
        return None
    is_molecule = loaded.length == "angstrom"
    known = "angstrom" if is_molecule else "m" if loaded.length == "m" else None
    unit = loaded.length_unit or options.length_unit or known
    of_body = 1.0 if unit is None else metres_per(unit) / (metres_per("angstrom") if is_molecule else 1.0)
    x, y, z = (
        in_file_unit(part, "--about", unit) * of_body for part in split_vector(extra.about, "m", "--about")
    )
    return x, y, z


def _parts(mesh: MeshSolid) -> Table:
    """List the solids of a CAD file."""
    columns = (
        Column("name", "solid"),
        Column("mass", "mass", "kg"),
        Column("volume", "volume", "m^3"),
        Column("density", "density", "kg/m^3"),
        Column("center_of_mass", "centre of mass", "m"),
        Column("material", "material"),
    )
    rows = [
        {
            "name": part.name,
            "mass": part.body.mass,
            "volume": part.volume,
            "density": part.body.mass / part.volume,
            "center_of_mass": part.body.center_of_mass,
            "material": part.material or None,
        }
        for part in mesh.parts
    ]
    return Table("parts", columns, rows)


def _mesh_report(
    file: Path,
    loaded: LoadedBody,
    mesh: MeshSolid,
    units: FileUnits,
    about: tuple[float, float, float] | None,
) -> Report:
    report, body, unit = Report(), loaded.body, units.length
    hint = "(the file's own)" if loaded.states_unit else "" if unit else "(state it with --length-unit)"
    report.section(
        "",
        Field("file", "file", label(file)),
        Field("format", "format", mesh.format),
        Field("length_unit", "length unit", unit or UNKNOWN, hint=hint),
    )
    volume, area = f"{loaded.length}^3", f"{loaded.length}^2"
    report.section(
        "shape",
        *([] if mesh.vertices is None else [Field("vertices", "vertices", mesh.vertices)]),
        Field("faces", "faces", mesh.faces),
        *units.fields("volume", "volume", loaded.volume, volume, length=3),
        *units.fields("area", "surface area", mesh.area, area, length=2),
    )
    if mesh.steps:
        columns = (
            Column("step", "step"),
            Column("volume_change_percent", "change of volume", "%"),
            Column("what", "what"),
        )
        rows = [{"step": s.name, "volume_change_percent": s.change, "what": s.what} for s in mesh.steps]
        report.section("repaired", Table("repaired", columns, rows))
    if len(mesh.parts) > 1 or any(part.material for part in mesh.parts):
        report.section("parts", _parts(mesh))
    center, extent = body.center_of_mass, loaded.extent
    report.section(
        "mass",
        Field(
            "density",
            "density",
            loaded.density,
            f"{loaded.mass_unit}/{volume}",
            **({} if body.sigma is None else Sigmas(sigma=body.sigma.mass / loaded.volume, linear=True)),
        ),
        *units.fields("mass", "mass", body.mass, loaded.mass_unit, mass=1, **sigmas_of(body, "mass")),
        *units.fields(
            "center_of_mass",
            "centre of mass",
            center,
            loaded.length,
            length=1,
            scale=extent,
            **sigmas_of(body, "center_of_mass"),
        ),
    )
    report.section("inertia, file axes", *tensor_fields(loaded, units, about))
    report.section("principal axes", *body_fields(loaded, units))
    report.section("equivalent ellipsoid, along e1 e2 e3", *ellipsoid_fields(loaded, units))
    report.section("trust", *trust_fields(loaded))
    report.notes += loaded.notes
    add_components(report, mesh.components, volume, f"{loaded.mass_unit}/{volume}")
    note_linear(report)
    if loaded.assumed:
        report.notes.append(
            "neither density nor mass was given: density 1 was used (state --density or --mass)"
        )
    if unit is None:
        report.notes.append("unit unknown: all results are in the file's own unit of length")
    return report
