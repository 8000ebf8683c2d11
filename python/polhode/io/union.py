"""The union of solids that overlap, by manifold3d (extra ``union``).

It works in double precision, may move corners by its tolerance, a part in 1e12 or so of the size, and joins
what is nearer than that. How far it moved them it does not say, so no error bound counts it.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._optional import require
from polhode.errors import MeshError
from polhode.io.mesh import Mesh, used_vertices

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Surface = tuple[Floats, Integers]

__all__ = ["difference", "has_union", "is_closed", "shared_volume", "unite"]


def has_union() -> bool:
    """Return whether manifold3d is installed."""
    return find_spec("manifold3d") is not None


def shared_volume(one: Surface, other: Surface) -> float:
    """Return the volume that two closed surfaces, wound outward, have in common."""
    _, (first, second) = _center([one, other])
    try:
        return abs(_volume(_surface(_manifold(first) ^ _manifold(second))))
    except MeshError:
        return float("nan")


def unite(parts: Sequence[Surface], name: str) -> Mesh:
    """Join closed surfaces, wound outward, into one that counts what they share once.

    Parameters
    ----------
    parts : sequence of (vertices, faces)
    name : str
        Of the format, for the mesh.

    Raises
    ------
    MeshError
        Where manifold3d does not take one of them for a solid.
    ModuleNotFoundError
        Without manifold3d, with the line that installs it.
    """
    middle, moved = _center(parts)
    library = _library()
    whole = library.Manifold.batch_boolean([_manifold(each) for each in moved], library.OpType.Add)
    vertices, faces = _surface(whole)
    return Mesh(vertices + middle, faces, name)


def difference(one: Surface, others: Sequence[Surface]) -> Surface:
    """Return what is left of a closed surface without what others, all wound outward, enclose.

    Raises
    ------
    MeshError
        Where manifold3d does not take one of them for a solid.
    """
    middle, moved = _center([one, *others])
    whole = _manifold(moved[0])
    for each in moved[1:]:
        whole -= _manifold(each)
    vertices, faces = _surface(whole)
    return vertices + middle, faces


def _library() -> Any:
    return require("manifold3d", extra="union", purpose="the union of solids")


def _center(parts: Sequence[Surface]) -> tuple[Floats, list[Surface]]:
    """Move surfaces near the origin, where their coordinates have most digits, and drop unused vertices."""
    used = [used_vertices(faces, len(vertices)) for vertices, faces in parts]
    corners = np.concatenate([vertices[rows] for (vertices, _), rows in zip(parts, used, strict=True)])
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
    moved: list[Surface] = [
        (vertices[rows] - middle, np.searchsorted(rows, faces).astype(np.int64))
        for (vertices, faces), rows in zip(parts, used, strict=True)
    ]
    return middle, moved


def _manifold(surface: Surface) -> Any:
    library = _library()
    vertices, faces = surface
    if not is_closed(faces):  # which may end the process in there
        raise MeshError(
            "a component is open, so that there is no union; leave the union out, or repair the mesh"
        )
    solid = library.Manifold(
        library.Mesh64(
            vert_properties=np.ascontiguousarray(vertices, dtype=np.float64),
            tri_verts=np.ascontiguousarray(faces, dtype=np.uint64),
        )
    )
    if solid.status() != library.Error.NoError:
        raise MeshError(
            f"manifold3d does not take a component for a solid ({solid.status().name}); "
            "leave the union out, or repair the mesh"
        )
    return solid


def is_closed(faces: Integers) -> bool:
    """Return whether each edge is gone along as often one way as the other."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).astype(np.int64)
    count = int(ends.max(initial=0)) + 1
    there, back = ends[:, 0] * count + ends[:, 1], ends[:, 1] * count + ends[:, 0]
    is_edge = bool((ends[:, 0] != ends[:, 1]).all())
    return is_edge and bool(np.array_equal(np.sort(there), np.sort(back)))


def _surface(solid: Any) -> Surface:
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
    faces = np.asarray(mesh.tri_verts, dtype=np.int64).reshape(-1, 3)
    # Vertices that only differ in what else they carry are one.
    merged = np.arange(len(vertices))
    merged[np.asarray(mesh.merge_from_vert, dtype=np.int64)] = np.asarray(mesh.merge_to_vert, dtype=np.int64)
    return vertices, merged[faces]


def _volume(surface: Surface) -> float:
    vertices, faces = surface
    corners = vertices[faces]
    return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0)
