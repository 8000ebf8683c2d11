"""What the shapes of a link say about its inertia: the homogeneous body they are, and the box around them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode import RigidBody, solids
from polhode.errors import PolhodeError
from polhode.io import read_mesh
from polhode.robots.sources import Addresses

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode._files.mesh import Mesh
    from polhode.robots.model import Link, Shape

    Floats = NDArray[np.float64]

__all__ = ["Geometry", "GeometryReader"]

_SOLIDS: Final[dict[str, Callable[[tuple[float, ...]], RigidBody]]] = {
    "box": lambda size: solids.box(size, density=1.0),
    "sphere": lambda size: solids.sphere(size[0], density=1.0),
    "cylinder": lambda size: solids.cylinder(size[0], size[1], density=1.0),
    "capsule": lambda size: solids.capsule(size[0], size[1], density=1.0),
    "ellipsoid": lambda size: solids.ellipsoid(size, density=1.0),
}


@dataclass(frozen=True)
class Geometry:
    """The shapes of a link, taken together.

    Attributes
    ----------
    body : RigidBody or None
        Of density 1, in the axes of the link; None where a shape has no volume that could be told.
    role : str
        Which shapes it is made of: ``"collision"`` or, where they do not serve, ``"visual"``.
    low, high : numpy.ndarray, shape (3,), or None
        Opposite corners of the box along the axes of the link around all shapes of both roles; None where one
        of them could not be told.
    notes : tuple of str
        What could not be told, and how a mesh was read.
    """

    body: RigidBody | None
    role: str
    low: Floats | None
    high: Floats | None
    notes: tuple[str, ...]


class GeometryReader:
    """Reads the shapes of links; a mesh that several links use is read once.

    Parameters
    ----------
    folder : pathlib.Path
        Where relative addresses start.
    packages : sequence of pathlib.Path
        Folders that hold the packages of ``package://`` and ``model://`` addresses.
    """

    def __init__(self, folder: Path, packages: Sequence[Path] = ()) -> None:
        self._folder, self._addresses = folder, Addresses(folder, packages)
        self._meshes: dict[tuple[Path, str], Mesh | str] = {}

    def read(self, link: Link) -> Geometry:
        """Take the shapes of a link together."""
        notes: dict[str, None] = {}
        folder = link.folder or self._folder
        boxes = [self._box(shape, folder, notes) for shape in link.shapes]
        body, role = None, ""
        for role in ("collision", "visual"):
            shapes = [shape for shape in link.shapes if shape.role == role]
            bodies = [self._body(shape, folder, notes) for shape in shapes]
            parts = [part for part in bodies if part is not None]
            if parts and len(parts) == len(bodies):
                body = sum(parts[1:], start=parts[0])
                break
        known = [box for box in boxes if box is not None]
        if not known or len(known) < len(boxes):
            return Geometry(body, role, None, None, tuple(notes))
        low = np.min([box[0] for box in known], axis=0)
        high = np.max([box[1] for box in known], axis=0)
        return Geometry(body, role, low, high, tuple(notes))

    def _body(self, shape: Shape, folder: Path, notes: dict[str, None]) -> RigidBody | None:
        solid: RigidBody | None
        if shape.kind == "mesh":
            solid = self._mesh_body(shape, folder, notes)
        elif shape.kind in _SOLIDS:
            try:
                solid = _SOLIDS[shape.kind](shape.size)
            except ValueError as error:
                notes[f"{shape.kind}: {error}"] = None
                solid = None
        else:
            notes[f"a shape of kind {shape.kind!r} has no volume that could be told"] = None
            solid = None
        if solid is None:
            return None
        weight = shape.density if shape.mass is None else shape.mass / float(solid.mass)
        if not weight > 0.0:
            return None
        placed = solid.rotated(_quaternion(shape.place.rotation)).translated(shape.place.position)
        return placed.scaled(mass=weight)

    def _mesh_body(self, shape: Shape, folder: Path, notes: dict[str, None]) -> RigidBody | None:
        mesh = self._mesh(shape, folder, notes)
        if mesh is None:
            return None
        vertices = mesh.vertices * np.array(shape.size)
        try:
            return RigidBody.from_mesh(vertices, mesh.faces, density=1.0, orient=True)
        except ValueError as error:
            first = str(error)
        try:
            hull = RigidBody.from_mesh(vertices, mesh.faces, density=1.0, closure="hull")
        except (ValueError, ModuleNotFoundError):
            notes[f"mesh {shape.mesh}: {first}"] = None
            return None
        notes[f"mesh {shape.mesh} does not bound a solid: its convex hull was taken"] = None
        return hull

    def _mesh(self, shape: Shape, folder: Path, notes: dict[str, None]) -> Mesh | None:
        key = (folder, shape.mesh)
        if key not in self._meshes:
            self._meshes[key] = self._load(shape.mesh, folder)
        found = self._meshes[key]
        if isinstance(found, str):
            notes[found] = None
            return None
        return found

    def _load(self, address: str, folder: Path) -> Mesh | str:
        path = self._addresses.find(address, folder)
        if path is None or not path.is_file():
            return f"mesh {address or '(without a name)'} was not found"
        try:
            return read_mesh(path)
        except (PolhodeError, OSError, ModuleNotFoundError) as error:
            return f"mesh {address}: {error}"

    def _box(self, shape: Shape, folder: Path, notes: dict[str, None]) -> tuple[Floats, Floats] | None:
        """Opposite corners of the box along the axes of the link around a shape."""
        rotation, position = shape.place
        if shape.kind == "mesh":
            mesh = self._mesh(shape, folder, notes)
            if mesh is None or not len(mesh.faces):
                return None
            corners = mesh.vertices[np.unique(mesh.faces)] * np.array(shape.size) @ rotation.T
            return corners.min(axis=0) + position, corners.max(axis=0) + position
        size = np.abs(shape.size)
        if shape.kind == "box":
            reach = np.abs(rotation) @ (size / 2.0)
        elif shape.kind == "sphere":
            reach = np.full(3, size[0])
        elif shape.kind == "cylinder":
            axis = rotation[:, 2]
            reach = np.abs(axis) * size[1] / 2.0 + size[0] * np.sqrt(np.maximum(0.0, 1.0 - axis**2))
        elif shape.kind == "capsule":
            reach = np.abs(rotation[:, 2]) * size[1] / 2.0 + size[0]
        elif shape.kind == "ellipsoid":
            reach = np.linalg.norm(rotation * size, axis=1)
        else:
            return None
        return position - reach, position + reach


def _quaternion(rotation: Floats) -> Floats:
    from polhode._core import quaternion_from_matrix

    return quaternion_from_matrix(rotation)
