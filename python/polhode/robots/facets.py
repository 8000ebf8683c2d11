"""How far the flat facets of a mesh may stand from the round surface that they are drawn for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode.files.mesh import equal_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["sagitta"]

# Edges that turn by more are those of the part itself, not of a surface drawn in facets.
_SMOOTH: Final = np.deg2rad(40.0)


def sagitta(vertices: NDArray[np.float64], faces: NDArray[np.integer]) -> float:
    r"""Give the largest height of an arc over the facets that stand for it.

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
