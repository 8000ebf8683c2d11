"""Bodies from files: triangle meshes and molecules.

Nothing is repaired and nothing is guessed: a file is what its name says and whole, or it is an error.
The one exception is exact: corners at bit-equal coordinates are one vertex, because STL stores each
triangle's corners anew.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._files import mesh as meshes
from polhode._files.ascii_stl import read_ascii_stl
from polhode._files.content import EXPECTED_CONTENT, MOLECULE_SUFFIX, checked_format
from polhode._files.mesh import Mesh
from polhode._files.scene import read_scene
from polhode._files.xyz import Molecule, read_xyz
from polhode.errors import FileFormatError, MeshError, PolhodeError
from polhode.molecules import ATOMIC_MASS_CONSTANT, Isotope, body_of_atoms, isotopes
from polhode.units import metres_per

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from polhode.molecules import Masses

__all__ = [
    "MOLECULE_SUFFIX",
    "Mesh",
    "MeshSolid",
    "Molecule",
    "body_from_file",
    "molecule_isotopes",
    "read_mesh",
    "read_xyz",
    "solid_from_file",
]

_SMALL_FILE = 1 << 28


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
    """

    body: _core.RigidBody
    format: str
    vertices: int | None
    faces: int
    volume: float
    area: float
    welded: int


def body_from_file(
    path: str | os.PathLike[str],
    *,
    density: float | None = None,
    mass: float | None = None,
    length_unit: str | None = None,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    index_base: int = 1,
    masses: Masses = "most_common",
    progress: Callable[[float], object] | None = None,
) -> _core.RigidBody:
    """Read the body a file describes: what ``RigidBody.from_file`` does.

    Parameters
    ----------
    path : str or os.PathLike
        A mesh (STL, OBJ and ``v``/``f`` plate files, PLY, OFF, GLB; see :func:`read_mesh`) or a molecule
        (XYZ; see :func:`read_xyz`).
    density, mass : float, optional
        Exactly one of them for a mesh, neither for a molecule.
    length_unit : str, optional
        Unit of the coordinates (see :mod:`polhode.units`); they are converted to metres, and a molecule's
        masses to kilograms. Without it coordinates stay as stored, and a molecule is in u and angstrom.
    weld, closure, orient, index_base
        Of a mesh; see :func:`solid_from_file`.
    masses : {"most_common", "average"}
        Of a molecule; see :func:`polhode.molecules.isotopes`.
    progress : callable, optional
        Is told the fraction of a large mesh file done, now and then; an exception it raises ends the reading.

    Returns
    -------
    RigidBody

    Raises
    ------
    FileFormatError
        If the file is not what its name says, damaged or empty.
    MeshError
        If the mesh does not bound a solid.
    OSError
        If the file cannot be read.
    """
    for name, value in (("density", density), ("mass", mass)):
        _check_amount(name, value, path)
    scale = 1.0 if length_unit is None else metres_per(length_unit)
    if not _is_molecule(path):
        if masses != "most_common":
            raise PolhodeError(f"masses: {os.fspath(path)} is a mesh, not a molecule; leave masses out")
        return solid_from_file(
            path,
            density=density,
            mass=mass,
            scale=scale,
            weld=weld,
            closure=closure,
            orient=orient,
            index_base=index_base,
            progress=progress,
        ).body
    for name, is_given, reason in (
        ("density", density is not None, "whose atoms have their own masses"),
        ("mass", mass is not None, "whose atoms have their own masses"),
        ("weld", weld != 0.0, "not a mesh"),
        ("closure", closure is not None, "not a mesh"),
        ("orient", orient, "not a mesh"),
        ("index_base", index_base != 1, "not a mesh"),
    ):
        if is_given:
            raise PolhodeError(f"{name}: {os.fspath(path)} is a molecule, {reason}; leave it out")
    molecule = read_xyz(path)
    unit = 1.0 if length_unit is None else ATOMIC_MASS_CONSTANT
    found = [isotope.mass * unit for isotope in molecule_isotopes(path, molecule, masses)]
    with _naming(path), np.errstate(over="ignore"):
        rounding = molecule.rounding * scale
        return body_of_atoms(found, molecule.positions * scale, source=masses, rounding=rounding)


def read_mesh(path: str | os.PathLike[str], *, index_base: int = 1, weld: float = 0.0) -> Mesh:
    """Read a triangle mesh.

    Parameters
    ----------
    path : str or os.PathLike
        Binary and ASCII STL, and ``v``/``f`` text (``.obj``, ``.tab``, ``.txt``) are read without any
        further library; PLY, OFF and GLB by trimesh (extra ``mesh``), and no other format. Nodes of a scene
        are placed by their transforms and taken together.
    index_base : {1, 0}
        What ``v``/``f`` text counts its vertices from: 1 in OBJ and in most plate files, 0 in some.
    weld : float
        Corners at most this far from each other (in the unit of the file, in every coordinate) are one
        vertex. The default joins equal corners only, as it must for STL; some exporters write the same
        corner with other last digits in each triangle, and leave the mesh open by them.

    Returns
    -------
    Mesh

    Raises
    ------
    FileFormatError
        If the file is empty, cut short, damaged or in another format than its suffix says.
    OSError
        If the file cannot be read.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix == MOLECULE_SUFFIX:
        raise FileFormatError(f"{file}: an XYZ file holds atoms, not a mesh; read it with read_xyz")
    if index_base not in (0, 1):
        raise ValueError(f"index_base: expected 0 or 1, got {index_base!r}")
    if index_base != 1 and "v/f text" not in EXPECTED_CONTENT.get(suffix, ()):
        raise ValueError(f"index_base: {file} is not v/f text (.obj, .tab, .txt); leave index_base out")
    mesh = _read(file, suffix, index_base)
    return meshes.weld_within(mesh, weld) if weld != 0.0 else mesh


def solid_from_file(
    path: str | os.PathLike[str],
    *,
    density: float | None = None,
    mass: float | None = None,
    scale: float = 1.0,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    index_base: int = 1,
    progress: Callable[[float], object] | None = None,
) -> MeshSolid:
    """Make the solid that the mesh in a file bounds, naming the file in what is wrong with it.

    Binary STL and PLY go through memory block by block, whatever their size, but for the vertices of a
    PLY, which its faces name in any order; other formats, and files that are to be welded within a length
    or closed, are read whole. A stream is gone through again for every eight million triangles, to look for
    faces that stand twice; that components wound inward are cavities, inside others, is checked of a
    quarter of a million triangles at most. `provenance` lists what was checked.

    Parameters
    ----------
    path : str or os.PathLike
        See :func:`read_mesh`.
    density, mass : float, optional
        Exactly one of them.
    scale : float
        Unit of the coordinates, in the unit of the result.
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
    file = Path(path)
    streamed = _stream_format(file) if weld == 0.0 and index_base == 1 and closure is None else None
    if streamed is not None:
        try:
            with _naming(file):
                body, faces, volume, area = _core.stream_solid(
                    str(file), scale=scale, density=density, mass=mass, orient=orient, progress=progress
                )
        except MeshError as error:
            is_told = streamed == "PLY" or " is not closed" not in str(error)
            if is_told or file.stat().st_size > _SMALL_FILE:
                raise
            raise MeshError(_with_weld(str(error), read_mesh(file))) from None
        return MeshSolid(body, streamed, None, faces, volume, area, 0)
    mesh = read_mesh(file, index_base=index_base)
    corners = len(mesh.vertices)
    if weld != 0.0:
        mesh = meshes.weld_within(mesh, weld)
    with np.errstate(over="ignore"):  # what is beyond float64 is refused as infinite, with its number
        vertices = mesh.vertices * scale

    def solid(density: float | None, mass: float | None = None) -> _core.RigidBody:
        return _core.RigidBody.from_mesh(
            vertices, mesh.faces, density=density, mass=mass, closure=closure, orient=orient
        )

    try:
        with _naming(file):
            body = solid(density, mass)
            volume = float(body.mass) / density if density is not None else float(solid(1.0).mass)
            area = _core.surface_area(vertices, mesh.faces)
    except MeshError as error:
        raise MeshError(_with_weld(str(error), mesh)) from None
    welded = corners - len(mesh.vertices)
    count = len(mesh.vertices)
    return MeshSolid(body._welded(welded), mesh.format, count, len(mesh.faces), volume, area, welded)


def molecule_isotopes(
    path: str | os.PathLike[str], molecule: Molecule, masses: Masses = "most_common"
) -> list[Isotope]:
    """Find the nuclides of a molecule's atoms, naming the file in what goes wrong.

    Parameters
    ----------
    path : str or os.PathLike
        Where the molecule comes from.
    molecule : Molecule
        What was read.
    masses : {"most_common", "average"}
        See :func:`polhode.molecules.isotopes`.

    Returns
    -------
    list of Isotope
        In the order of the atoms.
    """
    try:
        return isotopes(molecule.labels, masses)
    except PolhodeError as error:
        raise FileFormatError(f"{os.fspath(path)}: {error}") from None


def _read(file: Path, suffix: str, index_base: int) -> Mesh:
    actual = checked_format(file)
    if actual == "ASCII STL":
        corners = read_ascii_stl(file)
        return meshes.weld(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3), actual)
    if suffix == ".stl":
        # Whatever is neither text nor another known format is the compiled reader's to read or refuse.
        return Mesh(*_core.read_stl(str(file)), "binary STL")
    if suffix in (".obj", ".tab", ".txt"):
        mesh = Mesh(*_core.read_plates(str(file), index_base), "v/f text")
        meshes.check_faces(mesh, str(file))
        return mesh
    return read_scene(file, readable=tuple(known for known in EXPECTED_CONTENT if known != MOLECULE_SUFFIX))


def _stream_format(file: Path) -> str | None:
    """Name the format of a file whose triangles can be read one after the other; None of another."""
    suffix = file.suffix.lower()
    if suffix not in (".stl", ".ply"):
        return None
    actual = checked_format(file)
    if suffix == ".stl":
        # Whatever is neither text nor another known format is the compiled reader's to read or refuse.
        return "binary STL" if actual != "ASCII STL" else None
    with file.open("rb") as stream:
        return "PLY" if actual == "PLY" and b"\nformat binary" in stream.read(4096) else None


def _with_weld(message: str, mesh: Mesh) -> str:
    """Offer to weld, before all else, where corners differ by less than 32-bit coordinates resolve."""
    size = float(np.abs(mesh.vertices).max(initial=0.0))
    in_range = not mesh.faces.size or (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices))
    if not (np.isfinite(size) and size > 0.0 and in_range):
        return message
    resolution = float(f"{size * 2.0**-23:.0e}")
    try:
        near = len(mesh.vertices) - len(meshes.weld_within(mesh, resolution).vertices)
    except ValueError:
        return message
    if near == 0:
        return message
    lie, them = ("corner lies", "it") if near == 1 else ("corners lie", "them")
    hint = f"{near} {lie} within {resolution:g} of another, weld={resolution:g} joins {them}"
    fault, others, remedies = message.partition("; close the mesh ")
    return f"{fault}; {hint}; or close the mesh {remedies}" if others else f"{message} ({hint})"


@contextmanager
def _naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Let what is wrong with a body tell the file that it is read from."""
    try:
        yield
    except PolhodeError as error:
        if str(error).startswith(f"{os.fspath(path)}: "):
            raise
        raise type(error)(f"{os.fspath(path)}: {error}") from None


def _check_amount(name: str, value: object, path: str | os.PathLike[str]) -> None:
    if isinstance(value, str):
        raise TypeError(
            f"{name}: expected a number, got {value!r}; units are read on the command line: "
            f'polhode report {os.fspath(path)} --{name} "{value}"'
        )


def _is_molecule(path: str | os.PathLike[str]) -> bool:
    return Path(path).suffix.lower() == MOLECULE_SUFFIX
