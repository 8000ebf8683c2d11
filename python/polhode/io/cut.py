"""A solid cut by a plane, closed by its section: hulls below their waterline, castings, sawn-off parts."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import Argument
from polhode.errors import PolhodeError
from polhode.io.mesh import Mesh, weld_within
from polhode.io.mesh_solid import naming_file
from polhode.io.repair import repair_mesh, spanned_volume

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from polhode._core import RigidBody
    from polhode._typing import SupportsSigma
    from polhode.io.formats import FileContent
    from polhode.io.mesh_solid import MeshSolid

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Number = float | _core.Uncertain | SupportsSigma

__all__ = ["CutSolid", "Plane", "cut_body", "cut_mesh", "cut_solid"]

_WAY_OUT = "read its mesh and cut that: polhode.io.cut_mesh(vertices, faces, normal, point)"


class Plane(NamedTuple):
    """A plane that cuts.

    Attributes
    ----------
    normal : array_like, shape (3,)
        Toward the part that is left.
    point : array_like, shape (3,)
    """

    normal: ArrayLike
    point: ArrayLike = (0.0, 0.0, 0.0)


class CutSolid(NamedTuple):
    """What is left of a solid.

    Attributes
    ----------
    solid : MeshSolid
        Its area is that of its surface with the section.
    mesh : Mesh or None
        Closed; None where its section overlaps itself, see :func:`cut_mesh`.
    """

    solid: MeshSolid
    mesh: Mesh | None


class _Parts(NamedTuple):
    """Faces of what is left: those of the surface, and those of the section."""

    corners: Floats
    surface: Integers
    section: Integers

    def mesh(self) -> Mesh:
        left = np.concatenate([self.surface, self.section])
        used, index = np.unique(left, return_inverse=True)
        return Mesh(self.corners[used], index.reshape(-1, 3).astype(np.int64), "cut")


def cut_mesh(
    vertices: ArrayLike, faces: ArrayLike, normal: ArrayLike, point: ArrayLike = (0.0, 0.0, 0.0)
) -> Mesh:
    """Cut a closed mesh by a plane; what lies where ``n · (x − point) ≥ 0`` is left, closed by its section.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
    faces : array_like of int, shape (m, 3)
        Counted from zero, counterclockwise seen from outside.
    normal : array_like, shape (3,)
        Normal n of the plane, of any length, toward the part that is left.
    point : array_like, shape (3,), optional
        A point of the plane.

    Returns
    -------
    Mesh
        Closed. The section is a fan of triangles about one point: of a section that is not convex they
        overlap with opposite signs, which changes no integral, but is not meant to be drawn.

    Raises
    ------
    PolhodeError
        When nothing is left.

    Examples
    --------
    >>> from polhode import RigidBody
    >>> from polhode.io import cut_mesh
    >>> corners = [(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2)]
    >>> faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    >>> top = cut_mesh(corners, faces, normal=(0, 0, 1), point=(0, 0, 1))
    >>> RigidBody.from_mesh(top.vertices, top.faces, density=6.0).mass
    1.0
    """
    return _cut(vertices, faces, normal, point).mesh()


def _cut(vertices: ArrayLike, faces: ArrayLike, normal: ArrayLike, point: ArrayLike) -> _Parts:
    corners = _core.real_numbers(vertices, "vertices")
    triangles = np.asarray(faces)
    n, p = _vector(normal, "normal"), _vector(point, "point")
    if not np.abs(n).max() > 0.0:
        raise PolhodeError("normal must not be the zero vector: it has no direction")
    n = n / np.abs(n).max()
    n /= np.linalg.norm(n)
    if corners.ndim != 2 or corners.shape[1] != 3 or triangles.ndim != 2 or triangles.shape[1] != 3:
        raise ValueError(
            f"vertices, faces: expected shapes (n, 3) and (m, 3), got {corners.shape} and {triangles.shape}"
        )
    if triangles.dtype.kind not in "iu":
        raise TypeError(f"faces: expected whole numbers, got {triangles.dtype}")
    if triangles.size and not (triangles.min() >= 0 and triangles.max() < len(corners)):
        raise PolhodeError(f"faces: expected numbers of vertices from 0 to {len(corners) - 1}; correct them")
    # Corners at one place are one, as in the checks of a closed mesh.
    corners, same = np.unique(corners + 0.0, axis=0, return_inverse=True)
    triangles = same.reshape(-1)[triangles.astype(np.int64)]
    is_face = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    triangles = triangles[is_face]
    heights = (corners - p) @ n
    of_face = heights[triangles]
    whole = triangles[(of_face >= 0.0).all(axis=1) & (of_face > 0.0).any(axis=1)]
    crossed = triangles[(of_face > 0.0).any(axis=1) & (of_face < 0.0).any(axis=1)]
    if not len(whole) and not len(crossed):
        highest = float(heights[triangles].max(initial=-np.inf))
        raise PolhodeError(
            f"normal, point: nothing lies beyond the plane: the highest corner is at {highest:g} from it; "
            "move the point, or turn the normal round"
        )
    cut, corners = _cut_triangles(crossed, corners, heights)
    surface = np.concatenate([whole, cut])
    open_edges = _open_edges(surface)
    section = np.empty((0, 3), dtype=np.int64)
    if len(open_edges):
        # One point for all outlines of the section: it joins them to one surface, holes in it included.
        middle = corners[open_edges[:, 0]].mean(axis=0)
        middle -= n * (n @ (middle - p))
        apex = np.full(len(open_edges), len(corners))
        corners = np.vstack([corners, middle])
        section = np.column_stack([open_edges[:, ::-1], apex])
    return _Parts(corners, surface, section)


def cut_body(body: RigidBody, normal: ArrayLike, point: ArrayLike = (0.0, 0.0, 0.0)) -> RigidBody:
    """Cut a body that holds its mesh: what ``RigidBody.cut`` does, with its parameters."""
    if body.shape:
        raise PolhodeError(f"cut: expected one body, got a stack of shape {body.shape}; index it")
    vertices, faces = _mesh_of(body)
    _, volume = _core.RigidBody._from_mesh(vertices, faces, density=1.0)
    density = float(body.mass) / volume
    left = cut_mesh(vertices, faces, normal, point)
    return _core.RigidBody.from_mesh(left.vertices, left.faces, density=density)


def cut_solid(
    loaded: FileContent,
    solid: MeshSolid,
    plane: Plane,
    *,
    density: Number | None,
    mass: Number | None,
    scale: float,
    weld: float,
    mended: Mapping[str, object],
) -> CutSolid:
    """Cut the solid of a loaded file, of any number of faces.

    Parameters
    ----------
    loaded : FileContent
    solid : MeshSolid
        The whole.
    plane : Plane
        In units of the result.
    density, mass
        As of the whole: a mass is that of the whole.
    scale, weld
        See :func:`polhode.io.mesh_solid.solid_of`.
    mended : mapping
        The options that mend it, of which `repair` alone goes with a cut.
    """
    if loaded.cad is not None:
        raise PolhodeError(
            Argument("cut"),
            f": {os.fspath(loaded.path)} holds solids, not a mesh; leave it out, or export a mesh",
        )
    name = next((name for name, value in mended.items() if value and name != "repair"), None)
    if name is not None:
        raise PolhodeError(
            Argument(name),
            ": a mesh is cut as its file has it, or as ",
            Argument("repair", True),
            " mends it; leave it out",
        )
    if mended.get("repair"):
        mesh, _, _, _ = repair_mesh(loaded.mesh, weld)
        if spanned_volume(mesh) < 0.0:
            mesh = mesh._replace(faces=mesh.faces[:, ::-1])
    else:
        mesh = weld_within(loaded.mesh, weld) if weld != 0.0 else loaded.mesh
    with naming_file(loaded.path):
        _core.RigidBody._from_mesh(mesh.vertices, mesh.faces, density=1.0)  # which faces outward
        parts = _cut(mesh.vertices * scale, mesh.faces, *plane)
    left = parts.mesh()
    body, volume = _core.RigidBody._from_mesh(left.vertices, left.faces, density=1.0)
    if mass is None:
        body = _core.RigidBody.from_mesh(left.vertices, left.faces, density=density)
    else:
        body = body.scaled(mass=1.0 / solid.volume).scaled(mass=mass)
    a, b, c = (parts.corners[parts.section[:, k]] for k in range(3))
    triangles = np.cross(b - a, c - a) / 2.0
    whole = triangles.sum(axis=0)
    is_simple = bool((triangles @ whole >= 0.0).all())
    area = _core.surface_area(parts.corners, parts.surface) + float(np.linalg.norm(whole))
    found = solid._replace(
        body=body, volume=volume, area=area, vertices=len(left.vertices), faces=len(left.faces)
    )
    return CutSolid(found, left if is_simple else None)


def _mesh_of(body: RigidBody) -> tuple[Floats, Integers]:
    """Return the mesh that a body holds, where it stands."""
    held = body._figures()
    parts = [] if held is None else held[0]
    if len(parts) != 1 or parts[0][0] != "mesh" or parts[0][4]:
        own = parts[0][0].rpartition("::")[2] if parts else ""
        kind = "no shape" if not parts else f"{len(parts)} shapes" if len(parts) > 1 else f"the shape {own!r}"
        raise PolhodeError(
            f"cut: a body is cut that holds one closed mesh of at most 20,000 faces, and this one holds "
            f"{kind}; {_WAY_OUT}"
        )
    _, numbers, triangles, place, _ = parts[0]
    turn, shift = np.array(place[:9]).reshape(3, 3), np.array(place[9:])
    vertices = np.asarray(numbers).reshape(-1, 3) @ turn.T + shift
    faces = np.asarray(triangles).reshape(-1, 3).astype(np.int64)
    return vertices, faces[:, ::-1] if np.linalg.det(turn) < 0.0 else faces


def _vector(given: ArrayLike, name: str) -> Floats:
    found = _core.real_numbers(given, name)
    if found.shape != (3,):
        raise ValueError(f"{name}: expected shape (3,), got {found.shape}")
    if not np.isfinite(found).all():
        raise PolhodeError(f"{name} must be finite, got {found.tolist()}")
    return found


def _cut_triangles(crossed: Integers, corners: Floats, heights: Floats) -> tuple[Integers, Floats]:
    """Return the parts of triangles above the plane, and the corners with those on edges, each cut once."""
    if not len(crossed):
        return crossed, corners
    a, b = crossed, np.roll(crossed, -1, axis=1)
    is_cut = heights[a] * np.sign(heights[b]) < 0.0  # no product that may underflow
    ends = np.sort(np.stack([a[is_cut], b[is_cut]], axis=1), axis=1)
    edges, number = np.unique(ends, axis=0, return_inverse=True)
    low, high = heights[edges[:, 0]], heights[edges[:, 1]]
    part = (low / (low - high))[:, np.newaxis]
    # From the nearer end, so that rounding is relative to the shorter way.
    first, last = corners[edges[:, 0]], corners[edges[:, 1]]
    on_plane = np.where(part < 0.5, first + (last - first) * part, last + (first - last) * (1.0 - part))
    numbers = np.full(crossed.shape, -1)
    numbers[is_cut] = len(corners) + number.reshape(-1)
    made = []
    for triangle, sides, cuts in zip(
        crossed.tolist(), heights[crossed].tolist(), numbers.tolist(), strict=True
    ):
        polygon = []
        for corner, side, cut in zip(triangle, sides, cuts, strict=True):
            polygon += [corner] if side >= 0.0 else []
            polygon += [cut] if cut >= 0 else []
        made += [(polygon[0], polygon[k], polygon[k + 1]) for k in range(1, len(polygon) - 1)]
    return np.array(made, dtype=np.int64).reshape(-1, 3), np.vstack([corners, on_plane])


def _open_edges(faces: Integers) -> Integers:
    """Return the directed edges that no face runs along the other way."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    count = int(faces.max(initial=0)) + 1
    low, high = edges.min(axis=1), edges.max(axis=1)
    pairs, number = np.unique(low * count + high, return_inverse=True)
    surplus = np.bincount(number.reshape(-1), weights=np.where(edges[:, 0] == low, 1.0, -1.0)).astype(
        np.int64
    )
    ends = np.column_stack([pairs // count, pairs % count])
    ends[surplus < 0] = ends[surplus < 0, ::-1]
    return np.repeat(ends, np.abs(surplus), axis=0)
