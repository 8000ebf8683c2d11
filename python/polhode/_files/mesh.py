"""A mesh as a file holds it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["Mesh", "weld"]


class Mesh(NamedTuple):
    """Triangles as a file holds them.

    Attributes
    ----------
    vertices : numpy.ndarray, shape (n, 3)
        In the unit of the file, which most formats do not state.
    faces : numpy.ndarray, shape (m, 3)
        Rows of `vertices`, counted from 0.
    format : str
        ``"binary STL"``, ``"ASCII STL"``, ``"v/f text"`` (OBJ and plate files), ``"PLY"``, ...
    """

    vertices: Floats
    faces: Integers
    format: str


def weld(vertices: Floats, faces: Integers, name: str) -> Mesh:
    """Make corners at bit-equal coordinates one vertex, in the order of their first appearance."""
    _, first, inverse = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    if len(first) == len(vertices):
        return Mesh(vertices, faces, name)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return Mesh(vertices[first[order]], rank[inverse.reshape(-1)][faces], name)
