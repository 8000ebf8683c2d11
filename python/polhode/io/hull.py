"""The convex hull of a mesh, by SciPy's Qhull."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._optional import require
from polhode.errors import MeshError
from polhode.io.mesh import used_vertices
from polhode.io.union import is_closed

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["hull"]


def hull(vertices: ArrayLike, faces: ArrayLike) -> NDArray[np.int64]:
    """Return the triangles of the convex hull of the vertices that faces use, wound alike.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
    faces : array_like of int, shape (m, 3)

    Returns
    -------
    numpy.ndarray, shape (k, 3)
        All outward or all inward.
    """
    spatial: Any = require("scipy.spatial", extra=None, purpose='closure="hull"')
    points = np.asarray(vertices, dtype=np.float64)
    corners = np.asarray(faces, dtype=np.int64)
    if corners.size and (corners.min() < 0 or corners.max() >= len(points)):
        return np.empty((0, 3), dtype=np.int64)  # to be refused as it is, with the number of the face
    used = used_vertices(corners, len(points))
    if not np.isfinite(points[used]).all():
        return np.empty((0, 3), dtype=np.int64)
    middle = points[used].mean(axis=0) if len(used) else 0.0
    try:
        found = spatial.ConvexHull(points[used] - middle, qhull_options="Qt")
    except (spatial.QhullError, ValueError) as error:
        reason = str(error).strip().split("\n")[0]
        raise MeshError(
            f"the mesh has no convex hull with a volume: {reason}; model a sheet as a thin shell instead"
        ) from None
    wound = _outward(found.simplices, found.points, found.equations)
    if not is_closed(wound):  # slivers have no normals to speak of
        wound = _wound_alike(found.simplices, found.neighbors)
    return np.asarray(used[wound], dtype=np.int64)


def _outward(faces: NDArray[Any], points: NDArray[Any], equations: NDArray[Any]) -> NDArray[Any]:
    """Turn the faces as the first one is, by the normals of their planes."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    is_inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), equations[:, :3]) < 0.0
    is_turned = is_inward != is_inward[0]
    return np.where(is_turned[:, None], faces[:, [1, 0, 2]], faces)


def _wound_alike(faces: NDArray[Any], neighbors: NDArray[Any]) -> NDArray[Any]:
    """Turn the faces that run along an edge the same way as the neighbour they were reached from."""
    wound = faces.copy()
    seen = np.zeros(len(faces), dtype=bool)
    seen[0] = True
    waiting = [0]
    while waiting:
        face = waiting.pop()
        a, b, c = wound[face].tolist()
        runs = {(a, b), (b, c), (c, a)}
        for other in neighbors[face].tolist():
            if seen[other]:
                continue
            seen[other] = True
            p, q, r = wound[other].tolist()
            if runs & {(p, q), (q, r), (r, p)}:
                wound[other] = (q, p, r)
            waiting.append(other)
    return wound
