"""Triangles made fit for drawing: large ones cut, too many joined."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["cut", "joined", "unit_normals"]

_COARSEST: Final = 4
"""Cells along the largest extent of a mesh whose corners are joined, at the least."""


def cut(triangles: Floats, longest: float, *, at_most: int | None = None) -> tuple[Floats, Integers]:
    """Halve triangles until no edge is longer than `longest`; tell which triangle each piece is from.

    What draws sorts polygons by the depth of their middles, which puts large ones in the wrong order.

    Parameters
    ----------
    triangles : numpy.ndarray, shape (m, 3, 3)
        Triangle, corner, component.
    longest : float
    at_most : int, optional
        Cut no further where more pieces than this would come of it.

    Returns
    -------
    pieces : numpy.ndarray, shape (k, 3, 3)
    owner : numpy.ndarray, shape (k,)
        Which triangle each is a piece of.
    """
    owner = np.arange(len(triangles))
    while True:
        lengths = np.linalg.norm(triangles[:, [1, 2, 0]] - triangles, axis=2)
        long = lengths.max(axis=1) > longest
        if not long.any() or (at_most is not None and len(triangles) + long.sum() > at_most):
            return triangles, owner
        edge = lengths[long].argmax(axis=1)
        row = np.arange(len(edge))
        a, b, c = (triangles[long][row, (edge + k) % 3] for k in range(3))
        middle = (a + b) / 2
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        triangles = np.concatenate([triangles[~long], *halves])
        owner = np.concatenate([owner[~long], owner[long], owner[long]])


def joined(vertices: Floats, faces: Integers, at_most: int) -> tuple[Floats, Integers, float]:
    """Join corners that lie in one cell of a grid, the finest that leaves few enough triangles.

    Parameters
    ----------
    vertices : numpy.ndarray, shape (n, 3)
    faces : numpy.ndarray, shape (m, 3)
    at_most : int
        Triangles that may be left.

    Returns
    -------
    vertices, faces : numpy.ndarray
        Of the coarser mesh; for drawing, since it need not bound a solid.
    side : float
        Of the cells; no corner has moved by more than their diagonal. 0 if nothing had to be joined.
    """
    if len(faces) <= at_most:
        return vertices, faces, 0.0
    low = vertices[faces].min(axis=(0, 1))
    size = float((vertices[faces].max(axis=(0, 1)) - low).max())
    coarse, fine = _COARSEST, int(np.sqrt(len(faces))) + _COARSEST
    found = _in_cells(vertices, faces, low, size / coarse)
    while fine - coarse > 1:
        middle = (coarse + fine) // 2
        tried = _in_cells(vertices, faces, low, size / middle)
        if len(tried[1]) <= at_most:
            coarse, found = middle, tried
        else:
            fine = middle
    return *found, size / coarse


def _in_cells(vertices: Floats, faces: Integers, low: Floats, side: float) -> tuple[Floats, Integers]:
    """Put the corners in one cell at their middle, and leave out the triangles that shrink to nothing."""
    cells = np.floor((vertices - low) / side).astype(np.int64)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    count = np.bincount(cell)
    middles = np.stack([np.bincount(cell, axis) for axis in vertices.T], axis=-1) / count[:, np.newaxis]
    corners = cell[faces]
    a, b, c = corners.T
    kept = corners[(a != b) & (b != c) & (c != a)]
    # Sheets that fell together leave the same triangle twice.
    _, first = np.unique(np.sort(kept, axis=1), axis=0, return_index=True)
    return middles, kept[np.sort(first)]


def unit_normals(triangles: Floats) -> Floats:
    """Give unit normals of triangles (m, 3, 3), on the side from which they run counterclockwise."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    unit: Floats = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    return unit
