"""Components of meshes and solids of CAD whose densities are given by name, by number or for all others."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any

from polhode import _core
from polhode._format import Argument
from polhode.errors import PolhodeError
from polhode.io.components import OTHERS, assign, describe_overlaps, groups_of, overlaps, parts_of
from polhode.io.mesh import weld_within
from polhode.io.mesh_solid import naming_file, solid_of
from polhode.io.unpacked import inner_suffix, unpack

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from polhode._typing import SupportsSigma
    from polhode.io.components import Part
    from polhode.io.formats import FileContent

    Number = float | _core.Uncertain | SupportsSigma

__all__ = [
    "OVERLAPPING",
    "body_by_names",
    "body_of_parts",
    "named_parts",
    "names_of_part",
]

OVERLAPPING = "components of several densities overlap: take what they share out of one of them"


def named_parts(loaded: FileContent, scale: float, weld: float) -> list[Part]:
    """Take the mesh of a file apart, its components by the names that the file gives them, else by numbers.

    Parameters
    ----------
    loaded : FileContent
    scale : float
        Of the coordinates.
    weld : float
        See :func:`polhode.io.read_mesh`.
    """
    mesh = weld_within(loaded.mesh, weld) if weld != 0.0 else loaded.mesh
    vertices = mesh.vertices * scale
    groups, materials = (
        [name for name, count in runs for _ in range(count)] for runs in (loaded.groups, loaded.materials)
    )
    parts = parts_of(
        vertices, mesh.faces, groups, materials=materials if len(materials) == len(mesh.faces) else None
    )
    if len(parts) > 1 and inner_suffix(loaded.path) == ".obj":
        with unpack(loaded.path) as inside:
            groups, materials = groups_of(inside)
        if len(groups) == len(mesh.faces):  # none fell together when corners did
            return parts_of(vertices, mesh.faces, groups, materials=materials)
    return parts


def names_of_part(part: Part) -> tuple[str, ...]:
    """Return the names of a component, from that which it has alone to those that others may have too."""
    return part.name, part.group, part.material


def body_of_parts(parts: Sequence[Part], densities: Sequence[Number]) -> _core.RigidBody:
    """Add components, each with its density; those that are uncertain are independent of one another."""
    bodies = [
        _core.RigidBody.from_mesh(part.vertices, part.faces, density=density)
        for part, density in zip(parts, densities, strict=True)
    ]
    return sum(bodies[1:], start=bodies[0])


def body_by_names(
    loaded: FileContent,
    densities: Mapping[Any, Number],
    *,
    scale: float = 1.0,
    weld: float = 0.0,
    orient: bool = False,
    progress: Callable[[float], object] | None = None,
    **left_out: object,
) -> _core.RigidBody:
    """Make the body of a mesh with a density for each of its components; warn where these overlap.

    Parameters
    ----------
    loaded : FileContent
    densities : mapping to float or Uncertain
        See :func:`assign`. Solids of CAD of which nothing is said have the densities of their materials.
    scale, weld, orient, progress
        See :func:`polhode.io.mesh_solid.solid_of`.
    **left_out
        Its other options, which may not be given.
    """
    where = os.fspath(loaded.path)
    if (name := next((name for name, value in left_out.items() if value), None)) is not None:
        raise PolhodeError(
            Argument(name), ": components have densities of their own, by their names; leave it out"
        )
    if loaded.cad is not None:
        from polhode.io.cad_files import solids_of

        with naming_file(loaded.path):
            return solids_of(loaded.cad, densities)[0]
    # What is wrong with the mesh as a whole is said first.
    solid_of(loaded, density=1.0, scale=scale, weld=weld, orient=orient, progress=progress)
    parts = named_parts(loaded, scale, weld)
    found = assign(densities, [names_of_part(part) for part in parts], where)
    weights = [density for density in found if density is not None]
    if len(weights) < len(parts):
        absent = parts[found.index(None)].name
        raise PolhodeError(
            Argument("density"),
            f': nothing is said of component {absent!r} of {where}; add it, or "{OTHERS}" for all others',
        )
    lines = describe_overlaps(overlaps(parts), sum(part.volume for part in parts))
    for line in [*lines, *([OVERLAPPING] if lines else [])]:
        warnings.warn(f"{where}: {line}", stacklevel=3)
    with naming_file(loaded.path):
        return body_of_parts(parts, weights)
