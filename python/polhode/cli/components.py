"""The components of a mesh in a report: their volumes and densities, and where they overlap."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from polhode import RigidBody
from polhode._quantities import has_unit, quantity
from polhode.cli.layout import Column, Table
from polhode.errors import PolhodeError
from polhode.files.components import MOST_PARTS, Part, groups_of, labels, overlaps, parts_of, told
from polhode.files.mesh import weld_within
from polhode.files.repair import repaired
from polhode.files.unpacked import inner_suffix, unpacked

if TYPE_CHECKING:
    from polhode.cli.layout import Report
    from polhode.cli.options import BodyOptions
    from polhode.files.loaded import Loaded
    from polhode.files.mesh_solid import MeshSolid

__all__ = ["Components", "add_components", "components_of", "has_names", "weighed"]

# Larger meshes are not taken apart: their triangles would all be held in memory.
_MOST_FACES: Final = 250_000


@dataclass(frozen=True)
class Components:
    """What a mesh is made of.

    Attributes
    ----------
    parts : list of Part
    densities : list of float
    notes : list of str
        Where they overlap.
    """

    parts: list[Part]
    densities: list[float]
    notes: list[str]


def has_names(density: str | None) -> bool:
    """Tell whether a density is given by component."""
    return density is not None and "=" in density


def components_of(
    loaded: Loaded, solid: MeshSolid, options: BodyOptions, scale: float, weld: float
) -> Components | None:
    """Take the mesh of a file apart; None where it is one component, or too large."""
    if options.union:
        return Components(
            [], [], ["components were joined (--union): how far that moves corners is in no bound"]
        )
    if loaded.cad is not None:
        from polhode.files.cad_overlaps import overlaps_told

        return (
            Components([], [], overlaps_told(loaded.cad, loaded.path)) if len(loaded.cad.parts) > 1 else None
        )
    if solid.faces > _MOST_FACES or options.closure is not None:
        return None
    parts = _parts(loaded, scale, weld, mended=options.repair)
    if len(parts) < 2:
        count = int(labels(loaded.mesh.faces, len(loaded.mesh.vertices)).max(initial=0)) + 1
        if count <= MOST_PARTS or weld != 0.0 or options.repair:
            return None
        note = (
            f"{count} components are more than {MOST_PARTS}: they are not listed, nor is seen what overlaps"
        )
        return Components([], [], [note])
    notes = told(overlaps(parts), sum(part.volume for part in parts), _unit(options))
    if notes:
        notes.append("--union counts what components share once, where they are of one material")
    return Components(parts, [float(solid.body.mass) / solid.volume] * len(parts), notes)


def weighed(loaded: Loaded, solid: MeshSolid, options: BodyOptions, scale: float, weld: float) -> MeshSolid:
    """Give each component its own density."""
    if loaded.cad is not None:
        raise PolhodeError(
            "--density: components of CAD have the densities of their materials; give one number for "
            "those without, or leave it out"
        )
    for name, is_given in (
        ("union", options.union),
        ("closure", options.closure is not None),
        ("repair", options.repair),
    ):
        if is_given:
            raise PolhodeError(f"--{name}: components of several densities are not joined; leave it out")
    parts = _parts(loaded, scale, weld)
    densities = _densities(options.density or "", [part.name for part in parts], options.length_unit)
    bodies = [
        RigidBody.from_mesh(part.vertices, part.faces, density=density)
        for part, density in zip(parts, densities, strict=True)
    ]
    notes = told(overlaps(parts), sum(part.volume for part in parts), _unit(options))
    if notes:
        notes.append("components of several densities overlap: take what they share out of one of them")
    found = Components(parts, densities, notes)
    return solid._replace(body=sum(bodies[1:], start=bodies[0]), components=found)


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
    rows = [
        {"name": part.name, "volume": part.volume, "density": rho, "cavities": part.cavities}
        for part, rho in zip(found.parts, found.densities, strict=True)
    ]
    if rows:
        report.section("components", Table("components", columns, rows))
    report.notes += found.notes


def _parts(loaded: Loaded, scale: float, weld: float, *, mended: bool = False) -> list[Part]:
    if mended:
        mesh, _, _, _ = repaired(loaded.mesh, weld)
        return parts_of(mesh.vertices * scale, mesh.faces)
    mesh = weld_within(loaded.mesh, weld) if weld != 0.0 else loaded.mesh
    vertices = mesh.vertices * scale
    parts = parts_of(vertices, mesh.faces)
    if len(parts) > 1 and inner_suffix(loaded.path) == ".obj":
        with unpacked(loaded.path) as inside:
            groups = groups_of(inside)
        if len(groups) == len(mesh.faces):  # none fell together when corners did
            return parts_of(vertices, mesh.faces, groups)
    return parts


def _unit(options: BodyOptions) -> str:
    return " m^3" if options.length_unit is not None else ""


def _densities(text: str, names: list[str], unit: str | None) -> list[float]:
    given: dict[str, float] = {}
    for item in text.split(","):
        name, is_named, value = (word.strip() for word in item.partition("="))
        if not is_named or name in given or name not in names:
            known = ", ".join(names[:12]) + (" …" if len(names) > 12 else "")
            what = "stands twice" if name in given else "names no component"
            raise PolhodeError(
                f"--density: {item.strip()!r} {what}; give NAME=DENSITY for each, by commas, of {known}"
            )
        if unit is None and has_unit(value):
            raise PolhodeError(
                f"--density: {value!r} has a unit, but the file's coordinates have none; state "
                "--length-unit too"
            )
        given[name] = quantity(value, "kg/m^3", "--density")
        if not given[name] > 0.0:
            raise PolhodeError(f"--density: {item.strip()} is not above 0; give the one of the material")
    absent = [name for name in names if name not in given]
    if absent:
        raise PolhodeError(f"--density: nothing is said of component {absent[0]}; add {absent[0]}=DENSITY")
    return [given[name] for name in names]
