"""The components of a mesh in a report: their volumes and densities, and where they overlap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from polhode import Uncertain
from polhode._format import with_sigma
from polhode.cli.layout import Cell, Column, Table
from polhode.errors import PolhodeError
from polhode.io.components import (
    MOST_FACES,
    MOST_PARTS,
    Part,
    assign,
    describe_overlaps,
    labels,
    overlapping,
    overlaps,
    parts_of,
)
from polhode.io.named_densities import OVERLAPPING, body_of_parts, named_parts, names_of_part
from polhode.io.repair import repair_mesh
from polhode.units import amount, has_unit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from polhode.cli.layout import Report
    from polhode.cli.options import BodyOptions
    from polhode.io.formats import FileContent
    from polhode.io.mesh_solid import MeshSolid

__all__ = ["Components", "add_components", "components_of", "has_names", "overlaps_beside", "weigh"]

_WAY_OUT: Final = "--union counts what components share once, where they are of one material"
# Larger meshes are not taken apart: their triangles would all be held in memory.
_MOST_FACES: Final = 250_000


@dataclass(frozen=True)
class Components:
    """What a mesh is made of.

    Attributes
    ----------
    parts : list of Part
    densities : list of float or Uncertain
    notes : list of str
        Where they overlap.
    """

    parts: list[Part]
    densities: Sequence[float | Uncertain]
    notes: list[str]


def has_names(density: str | None) -> bool:
    """Return whether a density is given by component."""
    return density is not None and "=" in density


def components_of(
    loaded: FileContent, solid: MeshSolid, options: BodyOptions, scale: float, weld: float
) -> Components | None:
    """Take the mesh of a file apart; None where it is one component, or too large."""
    if options.union:
        return Components(
            [], [], ["--union joined components; the error bounds do not include how far this moves corners"]
        )
    if loaded.cad is not None or solid.faces > _MOST_FACES or options.closure is not None:
        return None
    parts = _parts(loaded, scale, weld, mended=options.repair)
    if len(parts) < 2:
        count = int(labels(loaded.mesh.faces, len(loaded.mesh.vertices)).max(initial=0)) + 1
        if count <= MOST_PARTS or weld != 0.0 or options.repair:
            return None
        note = f"{count} components are more than {MOST_PARTS}: neither they nor their overlaps are listed"
        return Components([], [], [note])
    notes = describe_overlaps(overlaps(parts), sum(part.volume for part in parts), _unit(options))
    notes += [_WAY_OUT] if notes else []
    return Components(parts, [float(solid.body.mass) / solid.volume] * len(parts), notes)


def overlaps_beside(loaded: FileContent, solid: MeshSolid, options: BodyOptions, scale: float) -> list[str]:
    """Say which components of a mesh overlap, where they are not listed; nothing of a large mesh."""
    if loaded.cad is not None or solid.components is not None or solid.faces > MOST_FACES:
        return []
    if options.union or options.repair or options.closure is not None or options.weld is not None:
        return []
    lines = overlapping(loaded.mesh.vertices * scale, loaded.mesh.faces, _unit(options))
    # What is joined is not cut.
    return [*lines, _WAY_OUT] if lines and not options.cut else lines


def weigh(
    loaded: FileContent, solid: MeshSolid, options: BodyOptions, scale: float, weld: float
) -> MeshSolid:
    """Assign each component its own density."""
    for name, is_given in (
        ("union", options.union),
        ("closure", options.closure is not None),
        ("repair", options.repair),
        ("thickness", options.thickness is not None),
        ("cut", bool(options.cut)),
    ):
        if is_given:
            raise PolhodeError(
                f"--{name}: components of several densities are neither joined nor cut; leave it out"
            )
    given = densities_of(options.density or "", options.length_unit)
    if loaded.cad is not None:
        from polhode.io.cad_files import solids_of

        body, solids = solids_of(loaded.cad, given)
        return solid._replace(body=body, parts=solids)
    parts = named_parts(loaded, scale, weld)
    said = assign(given, [names_of_part(part) for part in parts])
    densities = [density for density in said if density is not None]
    if len(densities) < len(parts):
        absent = parts[said.index(None)].name
        raise PolhodeError(
            f"--density: no density is given for component {absent}; add {absent}=DENSITY, or "
            '"*=DENSITY" for all others'
        )
    notes = describe_overlaps(overlaps(parts), sum(part.volume for part in parts), _unit(options))
    notes += [OVERLAPPING] if notes else []
    found = Components(parts, densities, notes)
    return solid._replace(body=body_of_parts(parts, densities), components=found)


def add_components(report: Report, found: Components | None, volume: str, density: str) -> None:
    """Show the components of a mesh."""
    if found is None:
        return
    columns = (
        Column("name", "component"),
        Column("volume", "volume", volume),
        Column("density", "density", density),
        Column("cavities", "cavities"),
    )
    rows: list[dict[str, Any]] = [
        {"name": part.name, "volume": part.volume, "density": _cell(rho), "cavities": part.cavities}
        for part, rho in zip(found.parts, found.densities, strict=True)
    ]
    if any(isinstance(rho, Uncertain) for rho in found.densities):
        for row, rho in zip(rows, found.densities, strict=True):
            row["density_sigma"] = float(rho.sigma) if isinstance(rho, Uncertain) else 0.0
    if rows:
        report.section("components", Table("components", columns, rows))
    report.notes += found.notes


def _parts(loaded: FileContent, scale: float, weld: float, *, mended: bool = False) -> list[Part]:
    if mended:
        mesh, _, _, _ = repair_mesh(loaded.mesh, weld)
        return parts_of(mesh.vertices * scale, mesh.faces)
    return named_parts(loaded, scale, weld)


def _value(density: float | Uncertain) -> float:
    return float(density.value) if isinstance(density, Uncertain) else density


def _cell(density: float | Uncertain) -> Cell | float:
    """Show a density with its sigma, where it has one."""
    if not isinstance(density, Uncertain):
        return density
    return Cell(with_sigma(float(density.value), float(density.sigma)), float(density.value))


def _unit(options: BodyOptions) -> str:
    return " m^3" if options.length_unit is not None else ""


def densities_of(text: str, unit: str | None) -> dict[str, float | Uncertain]:
    """Read the density of each component that --density names."""
    given: dict[str, float | Uncertain] = {}
    for item in text.split(","):
        name, is_named, value = (word.strip() for word in item.partition("="))
        if not is_named or name in given:
            what = "is given twice" if name in given else "names no component"
            raise PolhodeError(f"--density: {item.strip()!r} {what}; give NAME=DENSITY for each, by commas")
        if unit is None and has_unit(value):
            raise PolhodeError(
                f"--density: {value!r} has a unit, but the file's coordinates have none; state "
                "--length-unit too"
            )
        given[name] = found = amount(value, "kg/m^3", "--density")
        if not _value(found) > 0.0:
            raise PolhodeError(f"--density: {item.strip()} is not above 0; give a positive density")
    return given
