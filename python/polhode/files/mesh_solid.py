"""The solid that the mesh in a file bounds."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode.errors import MeshError, PolhodeError
from polhode.files.loaded import Loaded, load
from polhode.files.mesh import weld_within
from polhode.units import metres_per

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from polhode._typing import SupportsSigma
    from polhode.files.cad_file import CadFile
    from polhode.files.cad_solid import SolidPart
    from polhode.files.mesh import Mesh

    Number = float | _core.Uncertain | SupportsSigma

__all__ = ["MeshSolid", "naming_file", "solid_from_file", "solid_of"]

_SMALL_FILE: Final = 1 << 28
"""Bytes of a file that is read whole for a hint in an error."""


class MeshSolid(NamedTuple):
    """A solid from a mesh file, and what the file holds.

    Attributes
    ----------
    body : RigidBody
        The solid.
    format : str
        As in :class:`Mesh`.
    vertices : int or None
        How many vertices; None in a format that stores the corners of each triangle anew.
    faces : int
        How many triangles.
    volume, area : float
        In units of the result; the area is that of the file's triangles, without what closed them.
    welded : int
        Corners that were joined to others within the length asked for.
    parts : tuple of SolidPart
        Of a CAD file: its solids, each at its place.
    """

    body: _core.RigidBody
    format: str
    vertices: int | None
    faces: int
    volume: float
    area: float
    welded: int
    parts: tuple[SolidPart, ...] = ()


def solid_from_file(
    path: str | os.PathLike[str],
    *,
    density: Number | None = None,
    mass: Number | None = None,
    scale: float | None = None,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    index_base: int = 1,
    progress: Callable[[float], object] | None = None,
) -> MeshSolid:
    """Make the solid that the mesh in a file bounds; an error names the file.

    Binary STL and PLY go through memory block by block, whatever their size, but for the vertices of a
    PLY, which its faces name in any order; other formats, and files that are to be welded within a length
    or closed, are read whole. A stream is gone through again for every eight million triangles, to look for
    faces that stand twice; that components wound inward are cavities, inside others, is checked of a
    quarter of a million triangles at most. `provenance` lists what was checked.

    Parameters
    ----------
    path : str or os.PathLike
        See :func:`read_mesh`.
    density, mass : float or Uncertain, optional
        Exactly one of them.
    scale : float, optional
        Unit of the coordinates, in the unit of the result. By default the metres in the unit that the file or
        its format states, and 1 for those that state none.
    weld, index_base
        See :func:`read_mesh`.
    closure : {"caps", "hull"}, optional
        How to close an open mesh, see :meth:`polhode.RigidBody.from_mesh`; without it, it is an error.
    orient : bool
        Turn triangles that face inward; without it they are an error.
    progress : callable, optional
        Is told the fraction of the file done, now and then.

    Returns
    -------
    MeshSolid

    Raises
    ------
    FileFormatError
        If the file is not what its name says, damaged or empty.
    MeshError
        If the mesh does not bound a solid.
    OSError
        If the file cannot be read.
    """
    loaded = load(path, index_base=index_base)
    own = 1.0 if loaded.unit is None else metres_per(loaded.unit)
    if scale is not None and scale != own and loaded.states_unit:
        raise PolhodeError(
            f"scale: {os.fspath(path)} says itself that its unit is {loaded.unit!r}; leave it out"
        )
    return solid_of(
        loaded,
        density=density,
        mass=mass,
        scale=own if scale is None else scale,
        weld=weld,
        closure=closure,
        orient=orient,
        progress=progress,
    )


def solid_of(
    loaded: Loaded,
    *,
    density: Number | None = None,
    mass: Number | None = None,
    scale: float = 1.0,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    progress: Callable[[float], object] | None = None,
) -> MeshSolid:
    """Make the solid that the mesh of a loaded file bounds; see :func:`solid_from_file`."""
    file = loaded.path
    if loaded.cad is not None:
        return _cad_solid(
            loaded,
            loaded.cad,
            density,
            mass,
            asked={"weld": weld != 0.0, "closure": closure, "orient": orient},
        )
    if loaded.is_stream and weld == 0.0 and closure is None:
        try:
            with naming_file(file):
                body, faces, volume, area = _core.stream_solid(
                    str(file), scale=scale, density=density, mass=mass, orient=orient, progress=progress
                )
        except MeshError as error:
            if error.law == "closed" and loaded.format == "binary STL" and file.stat().st_size <= _SMALL_FILE:
                _offer_weld(error, loaded.mesh)
            raise
        return MeshSolid(body, loaded.format, None, faces, volume, area, 0)
    mesh = loaded.mesh
    corners = len(mesh.vertices)
    if weld != 0.0:
        mesh = weld_within(mesh, weld)
    with np.errstate(over="ignore"):  # what is beyond float64 is refused as infinite, with its number
        vertices = mesh.vertices * scale

    def solid(density: Number | None, mass: Number | None = None) -> _core.RigidBody:
        return _core.RigidBody.from_mesh(
            vertices, mesh.faces, density=density, mass=mass, closure=closure, orient=orient
        )

    try:
        with naming_file(file):
            body = solid(density, mass)
            volume = float(body.mass) / _value(density) if density is not None else float(solid(1.0).mass)
            area = _core.surface_area(vertices, mesh.faces)
    except MeshError as error:
        _offer_weld(error, mesh)
        raise
    welded = corners - len(mesh.vertices)
    count = len(mesh.vertices)
    return MeshSolid(body._welded(welded), mesh.format, count, len(mesh.faces), volume, area, welded)


def _cad_solid(
    loaded: Loaded, cad: CadFile, density: Number | None, mass: Number | None, asked: dict[str, object]
) -> MeshSolid:
    """Give the body of the solids in a CAD file, which need no mending that a mesh may need."""
    from polhode.files.cad_solid import solids_of

    name = next((name for name, value in asked.items() if value), None)
    if name is not None:
        raise PolhodeError(f"{name}: {loaded.path} holds solids, not a mesh; leave it out")
    with naming_file(loaded.path):
        body, parts = solids_of(cad, density, mass)
    area = sum(part.moments.area for part in cad.parts) * 1e-6
    faces, volume = sum(part.faces for part in cad.parts), sum(part.volume for part in parts)
    return MeshSolid(body, loaded.format, None, faces, volume, area, 0, parts)


def _value(number: Number) -> float:
    """Give the value of a number that may have a sigma."""
    if isinstance(number, _core.Uncertain):
        return float(number.value)
    return float(number) if isinstance(number, float | int) else float(number.nominal_value)


@contextmanager
def naming_file(path: str | os.PathLike[str]) -> Iterator[None]:
    """Put the name of the file before the text of an error."""
    try:
        yield
    except PolhodeError as error:
        error.args = (f"{os.fspath(path)}: {error}",)
        raise


def _offer_weld(error: MeshError, mesh: Mesh) -> None:
    """Offer to weld, as the first way out, where corners are closer than 32-bit coordinates resolve."""
    size = float(np.abs(mesh.vertices).max(initial=0.0))
    in_range = not mesh.faces.size or (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices))
    if not (np.isfinite(size) and size > 0.0 and in_range):
        return
    resolution = float(f"{size * 2.0**-23:.0e}")
    try:
        near = len(mesh.vertices) - len(weld_within(mesh, resolution).vertices)
    except ValueError:
        return
    if near == 0:
        return
    lie, them = ("corner lies", "it") if near == 1 else ("corners lie", "them")
    error.offer(f"{near} {lie} within {resolution:g} of another, weld={resolution:g} joins {them}")
