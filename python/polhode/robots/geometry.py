"""The shapes of a link: the homogeneous body that they make, and the box around them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode import RigidBody, laminae, solids
from polhode._format import Note
from polhode.errors import PolhodeError
from polhode.io.components import overlapping
from polhode.io.formats import load
from polhode.io.mesh import Mesh, equal_rows, used_vertices
from polhode.robots.mjcf import legacy_solid
from polhode.robots.model import quote, shorten
from polhode.robots.room import MARKER
from polhode.units import metres_per

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.io.cad_files import CadFile
    from polhode.robots.model import Link, Shape
    from polhode.robots.sources import Addresses

    Floats = NDArray[np.float64]

__all__ = [
    "HULL",
    "LOST",
    "Geometry",
    "GeometryReader",
    "sagitta",
]

LOST: Final = "mesh not found"
HULL: Final = "convex hull"
"""Kinds of notes on meshes, whose subjects are their names."""

_SOLIDS: Final[dict[str, Callable[[tuple[float, ...]], RigidBody]]] = {
    "box": lambda size: solids.box(size, density=1.0),
    "sphere": lambda size: solids.sphere(size[0], density=1.0),
    "cylinder": lambda size: solids.cylinder(size[0], size[1], density=1.0),
    "capsule": lambda size: solids.capsule(size[0], size[1], density=1.0),
    "ellipsoid": lambda size: solids.ellipsoid(size, density=1.0),
}
_SHELLS: Final[dict[str, Callable[[tuple[float, ...]], RigidBody]]] = {
    "box": lambda size: _box_shell(*size),
    "sphere": lambda size: solids.hollow_sphere(size[0], size[0], mass=4.0 * np.pi * size[0] ** 2),
    "cylinder": lambda size: _can(laminae.disk(size[0], density=1.0), *size),
    "capsule": lambda size: _can(_dome(size[0]), *size),
    "ellipsoid": lambda size: _ellipsoid_shell(np.array(size)),
}
"""Of a mass per area of 1."""
# How well a box or a cylinder is taken to stand for the true part, of its diagonal.
_OF_PRIMITIVES: Final = 0.02
# What MuJoCo counts of a mesh beyond its volume is told from here on.
_COUNTED_TWICE: Final = 0.01


@dataclass(frozen=True)
class Geometry:
    """The shapes of a link, taken together.

    Attributes
    ----------
    body : RigidBody or None
        With the densities and masses that the file gives them, else of density 1, in the axes of the link;
        None where a shape has no volume that could be told.
    volume : float
        Of those shapes.
    role : str
        Which shapes it is made of: ``"collision"`` or, where they do not serve, ``"visual"``.
    low, high : numpy.ndarray, shape (3,), or None
        Opposite corners of the box along the axes of the link around all shapes of both roles that could be
        read; None where there is none, or where all that were read are markers.
    unread : int
        How many shapes could not be read, so that the box is a part of what it should be.
    notes : tuple of str
        What could not be told, and how a mesh was read.
    marker : float or None
        Density in kg/m^3 that the declared mass would have in the shapes, where that is beyond 25,000 for
        each role that has a volume: they are markers, and say nothing of the inertia.
    """

    body: RigidBody | None
    volume: float
    role: str
    low: Floats | None
    high: Floats | None
    unread: int
    notes: tuple[str, ...]
    marker: float | None = None


class _MeshOrSolids(NamedTuple):
    """A mesh, and those of its vertices that triangles use; or solids of CAD in the corners of wide boxes."""

    mesh: Mesh
    corners: Floats
    solids: RigidBody | None = None
    overlaps: tuple[str, ...] = ()


class GeometryReader:
    """Reads the shapes of links; a mesh that several links use is read once.

    Parameters
    ----------
    folder : pathlib.Path
        Where relative addresses start.
    addresses : Addresses
        Finds the files of meshes.
    """

    def __init__(self, folder: Path, addresses: Addresses) -> None:
        self._folder, self._addresses = folder, addresses
        self._meshes: dict[tuple[Path, str], _MeshOrSolids | str] = {}
        self._solids: dict[tuple[Path, str, str, tuple[float, ...], str], tuple[RigidBody | None, str]] = {}

    def read(self, link: Link) -> Geometry:
        """Take the shapes of a link together."""
        notes: dict[str, str] = {}  # where each was found first
        folder = link.folder or self._folder
        for shape in link.shapes:
            if _is_nothing(shape):
                notes.setdefault(f"a {shape.kind} of size 0 is no shape; it is left out", shape.where)
        link = replace(link, shapes=tuple(shape for shape in link.shapes if not _is_nothing(shape)))
        boxes = [self._box(shape, folder, notes) for shape in link.shapes]
        mass = link.inertial.mass if link.inertial is not None else 0.0
        body, volume, role, marker = self._whole(link, folder, notes, mass)
        told = tuple(Note.after(f"{where}: ", note) if where else note for note, where in notes.items())
        known = [box for box in boxes if box is not None]
        if not known or marker is not None:
            return Geometry(body, volume, role, None, None, len(boxes) - len(known), told, marker)
        low = np.min([box[0] for box in known], axis=0)
        high = np.max([box[1] for box in known], axis=0)
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            told = (*told, "its shapes are larger than numbers reach")
            return Geometry(body, volume, role, None, None, len(boxes), told)
        return Geometry(body, volume, role, low, high, len(boxes) - len(known), told)

    def fill_shapes(self, link: Link) -> RigidBody | None:
        """Return the shapes filled with density 1, whatever the file says of their masses."""
        plain = replace(link, shapes=tuple(replace(s, density=1.0, mass=None) for s in link.shapes))
        return self._whole(plain, link.folder or self._folder, {})[0]

    def coarseness(self, link: Link) -> float:
        """Return the largest distance between the shapes and the surface that they approximate, in metres.

        A mesh misses a round surface by the sagitta of its facets; a box, a cylinder and the like only stand
        for the true part, which is taken to be within 2 % of their diagonal.
        """
        largest = 0.0
        for shape in link.shapes:
            if shape.kind == "mesh":
                mesh = self._mesh(shape.mesh, link.folder or self._folder)
                if not isinstance(mesh, str) and mesh.solids is None:
                    factors = np.array(shape.size)
                    largest = max(largest, sagitta(mesh.mesh.vertices * factors, mesh.mesh.faces))
            else:
                box = self._box(shape, self._folder, {})
                if box is not None:
                    largest = max(largest, _OF_PRIMITIVES * float(np.linalg.norm(box[1] - box[0])))
        return largest

    def _whole(
        self, link: Link, folder: Path, notes: dict[str, str], mass: float = 0.0
    ) -> tuple[RigidBody | None, float, str, float | None]:
        """Add the shapes of one role: those of collisions if they have volumes, else the visual ones.

        Shapes in which the mass would be denser than any matter are passed over; the last number is the
        least such density, where no others are left.
        """
        role, marker = "", np.inf
        for role in ("collision", "visual"):
            # What the file itself gives no mass is none of the matter.
            shapes = [s for s in link.shapes if s.role == role and (s.density if s.mass is None else s.mass)]
            try:
                bodies = [self._body(shape, folder, notes) for shape in shapes]
                parts = [part for part in bodies if part is not None]
                if parts and len(parts) == len(bodies):
                    volume = sum(each for _, each in parts)
                    if mass > MARKER * volume:
                        notes.setdefault(_marker(role, mass, volume), shapes[0].where)
                        marker = min(marker, mass / volume)
                        continue
                    return sum((part for part, _ in parts[1:]), start=parts[0][0]), volume, role, None
            except PolhodeError as error:
                notes.setdefault(Note(f"the {role} shapes make no body: ", *error.args), shapes[0].where)
        return None, 0.0, role, marker if np.isfinite(marker) else None

    def _body(self, shape: Shape, folder: Path, notes: dict[str, str]) -> tuple[RigidBody, float] | None:
        """Return the body of a shape in the frame of the link, and its volume."""
        if shape.problem:
            return None
        key = (folder, shape.kind, shape.mesh, shape.size, shape.counting)
        if key not in self._solids:
            is_mesh = shape.kind == "mesh"
            self._solids[key] = self._mesh_solid(shape, folder) if is_mesh else _solid(shape)
        solid, note = self._solids[key]
        volume = None
        if (
            shape.counting == "shell" and solid is not None
        ):  # beside what its mass would have to be if it were full
            volume = self._volume(replace(shape, counting=""), folder)
        if note:
            notes.setdefault(note, shape.where)
        if solid is None:
            return None
        weight = shape.density if shape.mass is None else shape.mass / float(solid.mass)
        if not weight > 0.0:
            return None
        placed = solid.rotated(_quaternion(shape.place.rotation)).translated(shape.place.position)
        return placed.scaled(mass=weight), float(solid.mass) if volume is None else volume

    def _volume(self, shape: Shape, folder: Path) -> float:
        """Return the volume that a surface bounds; infinite of one that bounds none."""
        full, _ = self._mesh_solid(shape, folder) if shape.kind == "mesh" else _solid(shape)
        return np.inf if full is None else float(full.mass)

    def _mesh_solid(self, shape: Shape, folder: Path) -> tuple[RigidBody | None, str]:
        """Return the solid that a mesh bounds, or its convex hull, and notes on it."""
        read, name = self._mesh(shape.mesh, folder), shorten(shape.mesh)
        if isinstance(read, str):
            return None, read
        if read.solids is not None:
            factor = shape.size[0]
            if not (factor > 0.0 and all(each == factor for each in shape.size)):
                return None, f"mesh {name}: solids of CAD are scaled alike along all axes; correct the scale"
            note = f"mesh {name}: {'; '.join(read.overlaps)}" if read.overlaps else ""
            return read.solids.scaled(mass=factor**3, length=factor), note
        mesh = read.mesh
        vertices = mesh.vertices * np.array(shape.size)
        if shape.counting == "shell":
            try:
                return RigidBody.from_surface(vertices, mesh.faces, areal_density=1.0), ""
            except ValueError as error:
                return None, f"mesh {name}: {error}"
        solid, first = None, ""
        if shape.counting != "convex":
            try:
                solid = RigidBody.from_mesh(vertices, mesh.faces, density=1.0, orient=True)
            except ValueError as error:
                first = str(error)
        if shape.counting == "legacy" and len(mesh.faces):
            return _fill_as_mujoco(name, legacy_solid(vertices, mesh.faces), solid)
        if solid is not None:
            return solid, _overlapping(f"mesh {name}", vertices, mesh.faces)
        try:
            hull = RigidBody.from_mesh(vertices, mesh.faces, density=1.0, closure="hull")
        except (ValueError, ModuleNotFoundError):
            return None, f"mesh {name}: {first}"
        told = Note(f"mesh {name} does not bound a solid: its convex hull was taken", kind=HULL, subject=name)
        return hull, told if shape.counting != "convex" else ""

    def _mesh(self, address: str, folder: Path) -> _MeshOrSolids | str:
        key = (folder, address)
        if key not in self._meshes:
            self._meshes[key] = self._load(address, folder)
        return self._meshes[key]

    def _load(self, address: str, folder: Path) -> _MeshOrSolids | str:
        if not address:
            return Note("mesh (without a name) was not found", kind=LOST, subject="(without a name)")
        name = shorten(address)
        path, fault = self._addresses.find(address, folder)
        if path is None:
            if fault:
                return Note(f"mesh {name} ", fault)
            return Note(f"mesh {name} was not found", kind=LOST, subject=name)
        if path.is_dir():
            return f"mesh {name} is a directory; name a file in it"
        try:
            loaded = load(path)
            if loaded.cad is not None:
                return _of_cad(loaded.cad)
            mesh = loaded.mesh
            if loaded.unit not in (None, "m"):  # robots are in metres, as is what states no unit
                mesh = mesh._replace(vertices=mesh.vertices * metres_per(loaded.unit))
        except (ValueError, OSError, ModuleNotFoundError, MemoryError) as error:
            return f"mesh {name}: {error}"
        faces = mesh.faces
        if faces.size and not (faces.min() >= 0 and faces.max() < len(mesh.vertices)):
            return f"mesh {name}: {path}: a face names a vertex that the file does not hold; check the file"
        used = used_vertices(faces, len(mesh.vertices))
        corners = mesh.vertices[used]
        if not np.isfinite(corners).all():
            vertex = int(used[np.flatnonzero(~np.isfinite(corners).all(axis=1))[0]])
            return f"mesh {name}: {path}: vertex {vertex} is not finite; check the file"
        return _MeshOrSolids(mesh, corners)

    def _box(self, shape: Shape, folder: Path, notes: dict[str, str]) -> tuple[Floats, Floats] | None:
        """Return the opposite corners of the box along the axes of the link around a shape."""
        rotation, position = shape.place
        if shape.problem:
            notes.setdefault(Note(shape.problem, "; this visual shape is left out"), "")
            return None
        if shape.kind == "mesh":
            mesh = self._mesh(shape.mesh, folder)
            if isinstance(mesh, str):
                notes.setdefault(mesh, shape.where)
                return None
            if not len(mesh.corners):
                return None
            corners = mesh.corners * np.array(shape.size) @ rotation.T
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


def _of_cad(cad: CadFile) -> _MeshOrSolids:
    """Return solids of a CAD file with density 1, in metres, and the corners of wide boxes around them."""
    from polhode.io.cad_files import solids_of

    signs = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    corners = np.concatenate(
        [
            part.rotation @ part.moments.about + part.position + part.moments.reach * signs
            for part in cad.parts
        ]
    )
    corners *= metres_per("mm")
    empty = np.empty((0, 3), dtype=np.int64)
    return _MeshOrSolids(
        Mesh(corners, empty, cad.format), corners, solids_of(cad, density=1.0)[0], cad.overlaps
    )


def _fill_as_mujoco(name: str, legacy: RigidBody, solid: RigidBody | None) -> tuple[RigidBody, str]:
    """Return the body that MuJoCo computes for a mesh, and a note if it is not the solid of the mesh."""
    by = 'MuJoCo\'s inertia="legacy", its default'
    if solid is None:
        return legacy, f"mesh {name} does not bound a solid: {by}, adds the tetrahedra of its triangles"
    times = float(legacy.mass) / float(solid.mass)
    if times <= 1.0 + _COUNTED_TWICE:
        return legacy, ""
    return (
        legacy,
        f'mesh {name}: {by}, counts {times:.3g} times its volume; inertia="exact" there counts it once',
    )


def _marker(role: str, mass: float, volume: float) -> str:
    return (
        f"{mass:.6g} kg in its {role} shapes would be {mass / volume:.3g} kg/m^3, and no matter has more "
        f"than {MARKER:g}: they are taken for markers and not used; correct the mass if they are the link"
    )


def _is_nothing(shape: Shape) -> bool:
    return shape.kind in _SOLIDS and not shape.problem and not any(shape.size)


def _overlapping(name: str, vertices: Floats, faces: NDArray[np.int64]) -> str:
    """Say which components of a mesh overlap; "" where none do, or where there are too many faces."""
    return f"{name}: {'; '.join(lines)}" if (lines := overlapping(vertices, faces)) else ""


def _solid(shape: Shape) -> tuple[RigidBody | None, str]:
    """Return the solid of a shape that is no mesh, or why there is none."""
    if shape.kind not in _SOLIDS:
        return None, f"a shape of kind {quote(shape.kind)} has no volume that could be told"
    made = _SHELLS if shape.counting == "shell" and shape.kind in _SHELLS else _SOLIDS
    note = _ROUGH if made is _SHELLS and shape.kind == "ellipsoid" else ""
    try:
        return made[shape.kind](shape.size), note
    except ValueError as error:
        return None, f"{shape.kind}: {error}"


_ROUGH: Final = (
    "a hollow ellipsoid is counted as MuJoCo does: its area to 1 %, its wall thinner away from the axes"
)


def _ellipsoid_shell(inner: Floats) -> RigidBody:
    """Return the surface of an ellipsoid as MuJoCo counts it.

    Its area is that of Thomsen's formula, its mass that between two ellipsoids whose semi-axes differ by
    a millionth.
    """
    p = 1.6075
    outer = inner + 1e-6
    powers = [(inner[k] * inner[k - 1]) ** p for k in range(3)]
    area = 4.0 * np.pi * (sum(powers) / 3.0) ** (1.0 / p)
    layer = (outer.prod() * outer**2 - inner.prod() * inner**2) / 5.0 / (outer.prod() - inner.prod())
    return RigidBody(float(area), np.diag(layer.sum() - layer) * area)


def _box_shell(a: float, b: float, c: float) -> RigidBody:
    """Return the six faces of a box."""
    pairs = (((a, b, 0.0), (0, 0, c / 2)), ((0.0, b, c), (a / 2, 0, 0)), ((a, 0.0, c), (0, b / 2, 0)))
    faces = []
    for sides, half in pairs:
        face = solids.box(sides, mass=float(np.prod([side for side in sides if side])))
        faces += [face.translated(half), face.translated(-np.array(half))]
    return sum(faces[1:], start=faces[0])


def _can(cap: RigidBody, radius: float, length: float) -> RigidBody:
    """Return the wall of a cylinder with a cap on both ends, the given one toward +z."""
    wall = solids.tube(radius, radius, length, mass=2.0 * np.pi * radius * length)
    top = cap.translated((0, 0, length / 2))
    return wall + top + top.rotated((1.0, 0.0, 0.0, 0.0))


def _dome(radius: float) -> RigidBody:
    """Return half a sphere without thickness, its rim in the plane z = 0."""
    across, along = 5.0 / 12.0, 2.0 / 3.0  # of m r², about its centre of mass at r/2
    mass = 2.0 * np.pi * radius**2
    return RigidBody(mass, np.diag([across, across, along]) * mass * radius**2, (0, 0, radius / 2))


def _quaternion(rotation: Floats) -> Floats:
    from polhode._core import quaternion_from_matrix

    return quaternion_from_matrix(rotation)


# Edges that turn by more are those of the part itself, not of a surface drawn in facets.
_SMOOTH: Final = np.deg2rad(40.0)


def sagitta(vertices: NDArray[np.float64], faces: NDArray[np.integer]) -> float:
    r"""Return the largest distance of an arc from the facets that approximate it.

    Two facets of width w that meet at an angle θ (between their normals) are chords of one arc,
    :math:`w = 2 r \sin(\theta/2)`, whose height over a chord is
    :math:`r (1 - \cos(\theta/2)) = (w/2) \tan(\theta/4)`. Of unequal facets the wider one is taken. Edges
    that turn by more than 40 degrees are taken for edges of the part.

    Parameters
    ----------
    vertices : numpy.ndarray, shape (n, 3)
    faces : numpy.ndarray, shape (m, 3)

    Returns
    -------
    float
        In the unit of the vertices; 0 where nothing is round.
    """
    # STL repeats its vertices: those in one place are one.
    first, of = equal_rows(vertices)
    places, triangles = vertices[first], of[faces]
    corners = places[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(areas, axis=1)
    solid = sizes > 0.0
    triangles, normals, sizes = triangles[solid], areas[solid] / sizes[solid, None], sizes[solid]
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    owner = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    pairs = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    if not pairs.size:
        return 0.0
    one, other = owner[pairs], owner[pairs + 1]
    cosine = np.clip((normals[one] * normals[other]).sum(axis=1), -1.0, 1.0)
    angle = np.arccos(cosine)
    lengths = np.linalg.norm(places[edges[pairs, 1]] - places[edges[pairs, 0]], axis=1)
    widths = np.maximum(sizes[one], sizes[other]) / np.maximum(lengths, np.finfo(float).tiny)
    # Across the diagonal of a flat quadrilateral there is no angle.
    heights = np.where(angle <= _SMOOTH, widths / 2.0 * np.tan(angle / 4.0), 0.0)
    return float(heights.max(initial=0.0))
