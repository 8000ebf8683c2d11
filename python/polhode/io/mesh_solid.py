"""The solid that the mesh in a file bounds."""

from __future__ import annotations

import os
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import Argument
from polhode.errors import FileFormatError, MeshError, PolhodeError
from polhode.io.mesh import weld_within
from polhode.io.repair import RepairStep, repair_mesh, resolution_of, spanned_volume

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from polhode._typing import SupportsSigma
    from polhode.io.cad_files import CadFile, SolidPart
    from polhode.io.formats import FileContent
    from polhode.io.mesh import Mesh

    Number = float | _core.Uncertain | SupportsSigma

__all__ = ["MeshSolid", "naming_file", "solid_of"]

_SMALL_FILE: Final = 1 << 28
"""Bytes of a file that is read whole for a hint in an error."""
_MOST_TRIED: Final = 300_000
_MOST_HELD: Final = 20_000
"""Faces of a mesh that its body holds, for pictures and cuts, as that of ``RigidBody.from_mesh`` does."""
_CLOSURES: Final[tuple[Literal["caps", "hull"], ...]] = ("caps", "hull")
"""Faces of a mesh that is repaired for a hint in an error."""
_CHECKS, _WELDED, _CLOSURE, _CHANGE = 27, 28, 29, 30
"""Places among the numbers of a body."""
_REPAIRED: Final = 1 << 11
_CAPS: Final = 1


class MeshSolid(NamedTuple):
    """A solid from a mesh file, and what the file holds.

    Attributes
    ----------
    body : RigidBody
        The solid.
    format : str
        As in :class:`Mesh`.
    vertices : int or None
        Number of vertices; None for a format that stores the three corners of every triangle (STL).
    faces : int
        How many triangles.
    volume, area : float
        In units of the result. The area is that of the triangles in the file, without triangles that were
        added to close holes.
    welded : int
        Number of corners that were joined to others within the length `weld`.
    components : object
        The components of the mesh, as a report lists them; None for a mesh of one component.
    parts : tuple of SolidPart
        Of a CAD file: its solids, each at its place.
    steps : tuple of RepairStep
        What was done to a mesh that was repaired on request.
    """

    body: _core.RigidBody
    format: str
    vertices: int | None
    faces: int
    volume: float
    area: float
    welded: int
    components: Any = None
    parts: tuple[SolidPart, ...] = ()
    steps: tuple[RepairStep, ...] = ()


def solid_of(
    loaded: FileContent,
    *,
    density: Number | None = None,
    mass: Number | None = None,
    scale: float = 1.0,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    union: bool = False,
    repair: bool = False,
    progress: Callable[[float], object] | None = None,
    thickness: float | None = None,
) -> MeshSolid:
    """Make the solid that the mesh of a loaded file bounds; see :func:`solid_from_file`.

    With `union` components that overlap are joined first, see :mod:`polhode.io.union`. With `thickness`, in
    units
    of the result, the mesh is the middle of a sheet.
    """
    file = loaded.path
    if thickness is not None:
        options = {"closure": closure, "orient": orient, "union": union, "repair": repair}
        return _sheet(loaded, density, mass, scale, weld, thickness, options)
    asked = {"weld": weld != 0.0, "closure": closure, "orient": orient, "repair": repair}
    if loaded.cad is not None:
        return _cad_solid(loaded, loaded.cad, density, mass, {**asked, "union": union})
    if repair:
        for name in ("closure", "orient"):
            if asked[name]:
                raise PolhodeError(
                    Argument(name),
                    ": ",
                    Argument("repair"),
                    " closes and orients by itself; leave one of the two out",
                )
        with naming_file(file):
            first = _repaired_solid(loaded.mesh, density, mass, scale, weld)
            return _unite_components(loaded, first, weld, density, mass, scale) if union else first
    joined = 0
    if union:
        mesh = weld_within(loaded.mesh, weld) if weld != 0.0 else loaded.mesh
        joined = len(loaded.mesh.vertices) - len(mesh.vertices)
        loaded, weld = _join_components(loaded, mesh, orient), 0.0
    if loaded.is_stream and weld == 0.0 and closure is None:
        try:
            with naming_file(file):
                body, faces, volume, area = _core.stream_solid(
                    str(file), scale=scale, density=density, mass=mass, orient=orient, progress=progress
                )
        except MeshError as error:
            if file.stat().st_size <= _SMALL_FILE:
                # Of a file that another reader refuses there is no way out to tell.
                with suppress(FileFormatError):
                    is_welded = error.kind == "open" and loaded.format == "binary STL"
                    is_welded = is_welded and _offer_weld(error, loaded.mesh)
                    _offer_repair(error, loaded.mesh, scale, is_welded=is_welded)
            raise
        if faces <= _MOST_HELD:
            body = _hold_mesh(body, loaded.mesh, scale, orient=orient)
        return MeshSolid(body, loaded.format, None, faces, volume, area, 0)
    mesh = loaded.mesh
    corners = len(mesh.vertices)
    if weld != 0.0:
        mesh = weld_within(mesh, weld)
    with np.errstate(over="ignore"):  # what is beyond float64 is refused as infinite, with its number
        vertices = mesh.vertices * scale

    try:
        with naming_file(file):
            body, volume = _core.RigidBody._from_mesh(
                vertices, mesh.faces, density=density, mass=mass, closure=closure, orient=orient
            )
            area = _core.surface_area(vertices, mesh.faces)
    except MeshError as error:
        is_welded = _offer_weld(error, mesh)
        if closure is None:
            _offer_repair(error, mesh, scale, is_welded=is_welded)
        raise
    welded = joined + corners - len(mesh.vertices)
    count = len(mesh.vertices)
    return MeshSolid(body._welded(welded), mesh.format, count, len(mesh.faces), volume, area, welded)


def _hold_mesh(body: _core.RigidBody, mesh: Mesh, scale: float, *, orient: bool) -> _core.RigidBody:
    """Return the body of a file that was summed as a stream, with its mesh."""
    held, _ = _core.RigidBody._from_mesh(mesh.vertices * scale, mesh.faces, density=1.0, orient=orient)
    numbers = np.array(body.__reduce__()[1][0], dtype=np.float64)
    return _core.RigidBody._from_numbers(numbers, body._doubts(), held._figures())


def _sheet(
    loaded: FileContent,
    density: Number | None,
    mass: Number | None,
    scale: float,
    weld: float,
    thickness: float,
    asked: Mapping[str, object],
) -> MeshSolid:
    """Make the shell of this thickness about the mesh of a file, open or closed."""
    name = next((name for name, value in asked.items() if value), None)
    if name is not None:
        raise PolhodeError(
            Argument(name),
            ": ",
            Argument("thickness"),
            " makes a sheet, of an open mesh too; leave one of the two out",
        )
    if loaded.cad is not None:
        raise PolhodeError(
            Argument("thickness"), f": {loaded.path} holds solids, not a mesh; leave it out, or export a mesh"
        )
    mesh = weld_within(loaded.mesh, weld) if weld != 0.0 else loaded.mesh
    vertices, welded = mesh.vertices * scale, len(loaded.mesh.vertices) - len(mesh.vertices)
    with naming_file(loaded.path):
        volume = float(
            _core.RigidBody.from_surface(vertices, mesh.faces, density=1.0, thickness=thickness).mass
        )
        body = _core.RigidBody.from_surface(
            vertices, mesh.faces, density=density, mass=mass, thickness=thickness
        )
        area = _core.surface_area(vertices, mesh.faces)
    return MeshSolid(body, mesh.format, len(mesh.vertices), len(mesh.faces), volume, area, welded)


def _join_components(loaded: FileContent, mesh: Mesh, orient: bool) -> FileContent:
    """Return the file with the components of its mesh joined to one solid."""
    from polhode.io.components import parts_of
    from polhode.io.union import unite

    parts = parts_of(mesh.vertices, mesh.faces, most=len(mesh.faces))
    with naming_file(loaded.path):
        inward = next((part.name for part in parts if part.was_inward), None)
        if inward is not None and not orient:
            raise MeshError(
                f"component {inward} of the mesh is inside out, and lies in no other as a cavity; reverse "
                "the order of its vertices, or pass ",
                Argument("orient", True),
                " to turn it",
            )
        joined = unite([(part.vertices, part.faces) for part in parts], mesh.format)
    return replace(loaded, is_stream=False, _mesh=joined)


def _cad_solid(
    loaded: FileContent,
    cad: CadFile,
    density: Number | Mapping[Any, Number] | None,
    mass: Number | None,
    asked: Mapping[str, object],
) -> MeshSolid:
    """Return the body of the solids in a CAD file, which need no mending that a mesh may need."""
    from polhode.io.cad_files import solids_of

    name = next((name for name, value in asked.items() if value), None)
    if name is not None:
        raise PolhodeError(Argument(name), f": {loaded.path} holds solids, not a mesh; leave it out")
    with naming_file(loaded.path):
        body, parts = solids_of(cad, density, mass)
    area = sum(part.moments.area for part in cad.parts) * 1e-6
    faces, volume = sum(part.faces for part in cad.parts), sum(part.volume for part in parts)
    return MeshSolid(body, loaded.format, None, faces, volume, area, 0, parts=parts)


@contextmanager
def naming_file(path: str | os.PathLike[str]) -> Iterator[None]:
    """Put the name of the file before the text of an error."""
    try:
        yield
    except PolhodeError as error:
        if isinstance(error, MeshError):
            _name_arguments(error)
        error.args = (os.fspath(path), ": ", *error.args)
        raise


def _repaired_solid(
    mesh: Mesh, density: Number | None, mass: Number | None, scale: float, weld: float
) -> MeshSolid:
    """Make the solid of a mesh that is repaired first; what nests in what is for the core to see."""
    corners, area = len(mesh.vertices), _core.surface_area(mesh.vertices * scale, mesh.faces)
    before, faces = spanned_volume(mesh), len(mesh.faces)
    mended, done, welded, filled = repair_mesh(mesh, weld)
    vertices = mended.vertices * scale
    body, volume = _core.RigidBody._from_mesh(vertices, mended.faces, density=density, mass=mass, orient=True)
    last, steps = before, []
    for name, what, after in done:
        steps.append(RepairStep(name, what, 100.0 * (after - last) * scale**3 / volume))
        last = after
    if abs(volume - last * scale**3) > 1e-9 * volume:
        change = 100.0 * (volume - last * scale**3) / volume
        steps.append(
            RepairStep("orient", "components that faced inward, and are no cavities, turned", change)
        )
    if steps:
        has_filled = any(step.name == "fill" for step in steps)
        closed = abs(filled) * np.sign(filled * last) * scale**3 if has_filled else None
        body = _mark_repair(body, welded, closed)
    return MeshSolid(body, mesh.format, corners - welded, faces, volume, area, welded, steps=tuple(steps))


def _mark_repair(body: _core.RigidBody, welded: int, closed: float | None) -> _core.RigidBody:
    """Return the body of a mesh that was repaired; `closed` is the change of volume by what was filled."""
    numbers = np.array(body.__reduce__()[1][0], dtype=np.float64)
    numbers[_CHECKS] = int(numbers[_CHECKS]) | _REPAIRED
    numbers[_WELDED] = welded
    if closed is not None:
        numbers[_CLOSURE], numbers[_CHANGE] = _CAPS, closed
    return _core.RigidBody._from_numbers(numbers, body._doubts())


def _unite_components(
    loaded: FileContent,
    first: MeshSolid,
    weld: float,
    density: Number | None,
    mass: Number | None,
    scale: float,
) -> MeshSolid:
    """Join the components of a mesh that was repaired first."""
    mended, _, _, _ = repair_mesh(loaded.mesh, weld)
    joined = _join_components(loaded, mended, orient=True)
    solid = solid_of(joined, density=density, mass=mass, scale=scale)
    change = 100.0 * (solid.volume - first.volume) / solid.volume
    step = RepairStep("union", "components joined, so that what they share counts once", change)
    provenance = first.body.provenance
    closed = float(provenance.volume_change) if provenance.closure else None
    return solid._replace(
        body=_mark_repair(solid.body, first.welded, closed), steps=(*first.steps, step), welded=first.welded
    )


def _offer_repair(error: MeshError, mesh: Mesh, scale: float, *, is_welded: bool) -> None:
    """Offer what mends a mesh, where it does: repair, else the convex hull.

    `is_welded` says that welding is offered already.
    """
    if len(mesh.faces) > _MOST_TRIED:
        return
    if error.kind == "open":
        _end_open(error, _serving(mesh, scale))
    try:
        steps = _repaired_solid(mesh, 1.0, None, scale, 0.0).steps
    except (MeshError, ValueError):
        with suppress(MeshError, ValueError, ModuleNotFoundError):
            _core.RigidBody.from_mesh(mesh.vertices * scale, mesh.faces, density=1.0, closure="hull")
            if error.kind != "open":  # of an open mesh the message offers it
                error.offer(Argument("closure", "hull"), " takes the convex hull instead")
        return
    change = sum(step.change for step in steps)
    if steps and not (is_welded and [step.name for step in steps] == ["weld"]):
        names = ", ".join(dict.fromkeys(step.name for step in steps))
        error.offer(Argument("repair", True), f" mends it ({names}; volume changed by {change:.2g} %)")


def _name_arguments(error: MeshError) -> None:
    """Name the arguments in the remedy with which a message of the core ends."""
    if any(isinstance(piece, Argument) for piece in error.args):
        return
    if error.kind == "open":
        _end_open(error, _CLOSURES)
    elif error.kind in ("inverted", "inside out"):
        turned = " to turn them all" if error.kind == "inverted" else " to turn them"
        error.args = (*error.args[:-1], ", or pass ", Argument("orient", True), turned)


def _end_open(error: MeshError, closures: Sequence[str]) -> None:
    close = ("close the mesh (", Argument("closure", tuple(closures)), "), or ") if closures else ()
    error.end_with(*close, "model a thin shell with ", Argument("thickness"))


def _serving(mesh: Mesh, scale: float) -> list[str]:
    """Find the closures that leave a solid."""
    serving: list[str] = []
    for closure in _CLOSURES:
        with suppress(MeshError, ValueError):
            with suppress(ModuleNotFoundError):  # whether it would serve is not known
                _core.RigidBody.from_mesh(mesh.vertices * scale, mesh.faces, density=1.0, closure=closure)
            serving.append(closure)
    return serving


def _offer_weld(error: MeshError, mesh: Mesh) -> bool:
    """Offer to weld, as the first way out, where corners are closer than 32-bit coordinates resolve."""
    in_range = not mesh.faces.size or (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices))
    resolution = resolution_of(mesh)
    if not (resolution > 0.0 and in_range):
        return False
    try:
        near = len(mesh.vertices) - len(weld_within(mesh, resolution).vertices)
    except ValueError:
        return False
    if near == 0:
        return False
    lie, them = ("corner lies", "it") if near == 1 else ("corners lie", "them")
    weld = Argument("weld", float(f"{resolution:g}"))
    error.offer(f"{near} {lie} within {resolution:g} of another, ", weld, f" joins {them}")
    return True
