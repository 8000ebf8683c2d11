"""A mesh as a file holds it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from polhode._format import Argument, short
from polhode.errors import MeshError, PolhodeError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["Mesh", "check_faces", "equal_rows", "used_vertices", "weld", "weld_within"]


class Mesh(NamedTuple):
    """Triangles as a file holds them.

    Attributes
    ----------
    vertices : numpy.ndarray, shape (n, 3)
        In the unit of the file, which most formats do not state.
    faces : numpy.ndarray, shape (m, 3)
        Rows of `vertices`, counted from 0.
    format : str
        ``"binary STL"``, ``"ASCII STL"``, ``"v/f text"`` (OBJ and plate files), ``"PLY"`` or another of the
        meshes among :attr:`FileContent.format`.
    """

    vertices: Floats
    faces: Integers
    format: str

    def __repr__(self) -> str:
        return short(self)


def check_faces(mesh: Mesh, file: str) -> None:
    """Refuse faces that name vertices which the file does not hold."""
    beyond = (mesh.faces < 0) | (mesh.faces >= len(mesh.vertices))
    if beyond.any():
        row = int(np.flatnonzero(beyond.any(axis=1))[0])
        raise MeshError(
            file,
            f": faces[{row}] names vertex {mesh.faces[row][beyond[row]][0]}, but there are "
            f"{len(mesh.vertices)} vertices, numbered from 0; is the file cut short?",
        )


def weld(vertices: Floats, faces: Integers, name: str) -> Mesh:
    """Make corners at bit-equal coordinates one vertex, in the order of their first appearance."""
    return _merge_equal(Mesh(vertices, faces, name), vertices)


def weld_within(mesh: Mesh, length: float) -> Mesh:
    """Make corners nearer than a length to each other, in every coordinate, one vertex.

    Parameters
    ----------
    mesh : Mesh
        What was read.
    length : float
        In the unit of the file; the first of the corners stays where it is.

    Returns
    -------
    Mesh

    Raises
    ------
    ValueError
        If the length is not a small positive number: corners that are farther apart would be joined by a
        chain of others between them.
    """
    if not (np.isfinite(length) and length > 0.0):
        raise PolhodeError(
            Argument("weld"), f": {length} is not a positive length; leave it out to join equal corners"
        )
    if not np.isfinite(mesh.vertices).all():
        return mesh  # to be refused as it is, with the number of the vertex
    cells = np.empty(mesh.vertices.shape, dtype=np.int64)
    for axis in range(3):
        order = np.argsort(mesh.vertices[:, axis], kind="stable")
        steps = np.diff(mesh.vertices[order, axis]) > length
        cells[order, axis] = np.concatenate([[0], np.cumsum(steps)])
    welded = _merge_equal(mesh, cells)
    moved = np.abs(welded.vertices[welded.faces] - mesh.vertices[mesh.faces]).max(initial=0.0)
    if moved > 2.0 * length:
        raise PolhodeError(
            Argument("weld"), f": {length:g} would join corners up to {moved:g} apart; give a smaller length"
        )
    return welded


def _merge_equal(mesh: Mesh, keys: Floats | Integers) -> Mesh:
    """Return the vertices with equal keys made the first of them."""
    first, of = equal_rows(keys)
    if len(first) == len(mesh.vertices):
        return mesh
    return Mesh(mesh.vertices[first], of[mesh.faces], mesh.format)


def equal_rows(rows: Floats | Integers) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Find rows that are equal.

    Parameters
    ----------
    rows : numpy.ndarray, shape (n, 3)

    Returns
    -------
    first : numpy.ndarray of int, shape (k,)
        The first row of each kind, in their order.
    of : numpy.ndarray of int, shape (n,)
        The kind of each row.
    """
    order = np.lexsort(rows.T[::-1])  # equal rows stay in their order
    ordered = rows[order]
    begins = np.ones(len(rows), dtype=bool)
    begins[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    found = order[begins]
    kinds = np.argsort(found)
    rank = np.empty_like(kinds)
    rank[kinds] = np.arange(len(kinds))
    of = np.empty(len(rows), dtype=np.intp)
    of[order] = rank[np.cumsum(begins) - 1]
    return found[kinds], of


def used_vertices(faces: NDArray[np.integer], count: int) -> NDArray[np.intp]:
    """Return the vertices that faces use, ascending; all of them are between 0 and `count`."""
    marks = np.zeros(count, dtype=bool)
    marks[faces] = True
    return np.flatnonzero(marks)
