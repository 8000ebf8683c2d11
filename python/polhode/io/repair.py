"""Meshes mended step by step on request: corners welded, faces dropped, wound alike, loops filled.

Each step says what it did and by how much it changed the volume that the faces span with the middle of their
box; a step that has nothing to do is none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from polhode.errors import MeshError
from polhode.io.mesh import Mesh, weld_within

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["RepairStep", "repair_mesh", "resolution_of", "spanned_volume"]


class RepairStep(NamedTuple):
    """What was done to a mesh.

    Attributes
    ----------
    name : str
        ``"weld"``, ``"drop"``, ``"orient"`` or ``"fill"``.
    what : str
        How much of it, in words.
    change : float
        Of the volume, in per cent of the volume at the end.
    """

    name: str
    what: str
    change: float


def resolution_of(mesh: Mesh) -> float:
    """Return the length that 32-bit coordinates of this size just resolve."""
    size = float(np.abs(mesh.vertices).max(initial=0.0))
    return float(f"{size * 2.0**-23:.0e}") if np.isfinite(size) else 0.0


def repair_mesh(mesh: Mesh, weld: float = 0.0) -> tuple[Mesh, list[tuple[str, str, float]], int, float]:
    """Weld, drop, orient and fill, in this order.

    Parameters
    ----------
    mesh : Mesh
    weld : float
        Corners at most this far apart are one; by default what 32-bit coordinates resolve.

    Returns
    -------
    mesh : Mesh
    steps : list of tuple
        Of each step that did something: its name, its words and the volume after it.
    welded : int
        How many corners were joined.
    filled : float
        By how much filling changed the volume.

    Raises
    ------
    MeshError
        If faces name vertices that are not there, or none are left.
    """
    faces = mesh.faces
    if not np.isfinite(mesh.vertices).all() or not faces.size:
        raise MeshError(
            "the mesh cannot be repaired: it has no faces, or corners that are not finite; export it again"
        )
    if faces.min() < 0 or faces.max() >= len(mesh.vertices):
        raise MeshError(
            "the mesh cannot be repaired: its faces name vertices that are not there; is the file cut short?"
        )
    steps: list[tuple[str, str, float]] = []

    def note(name: str, what: str) -> None:
        steps.append((name, what, spanned_volume(mesh)))

    corners, length = len(mesh.vertices), weld or resolution_of(mesh)
    try:
        mesh = weld_within(mesh, length) if length > 0.0 else mesh
    except ValueError:
        if weld:
            raise  # corners this near are no copies of one another, and nobody asked for this length
    welded = corners - len(mesh.vertices)
    if welded:
        note("weld", f"{_count(welded, 'corner')} within {length:g} of another joined")
    kept = _find_needed(mesh.faces)
    dropped = len(mesh.faces) - int(kept.sum())
    if dropped:
        mesh = mesh._replace(faces=mesh.faces[kept])
        note("drop", f"{_count(dropped, 'face')} that stand twice or are lines dropped")
    turned = _to_turn(mesh.faces)
    if turned.any():
        faces = mesh.faces.copy()
        faces[turned] = faces[turned][:, ::-1]
        mesh = mesh._replace(faces=faces)
        note("orient", f"{_count(int(turned.sum()), 'face')} turned to run as those beside them")
    before = spanned_volume(mesh)
    mesh, loops, edges = _fill_loops(mesh)
    filled = spanned_volume(mesh) - before
    if loops:
        note("fill", f"{_count(loops, 'loop')} of {_count(edges, 'edge')} closed by fans of triangles")
    return mesh, steps, welded, filled


def spanned_volume(mesh: Mesh) -> float:
    """Return the signed volume that the faces span with the middle of their box."""
    used = mesh.vertices[np.unique(mesh.faces)]
    middle = (used.min(axis=0) + used.max(axis=0)) / 2.0
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces] - middle, 1, 0)
    return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6.0)


def _count(number: int, word: str) -> str:
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


def _find_needed(faces: Integers) -> NDArray[np.bool_]:
    """Find which faces to keep: of those with the same corners one if its edges need it, of lines none."""
    ordered = np.sort(faces, axis=1)
    is_line = (ordered[:, 0] == ordered[:, 1]) | (ordered[:, 1] == ordered[:, 2])
    kept: NDArray[np.bool_] = ~is_line
    _, first, inverse, counts = np.unique(
        ordered, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    group = inverse.reshape(-1)
    is_repeated = (counts[group] > 1) & kept
    if not is_repeated.any():
        return kept
    # An edge needs the face where, without all its copies, an odd number of faces has that edge.
    alone = faces[kept & ~is_repeated]
    edges, times = np.unique(np.sort(_edges(alone), axis=1), axis=0, return_counts=True)
    others = {(int(a), int(b)): int(n) for (a, b), n in zip(edges, times, strict=True)}
    kept &= ~is_repeated
    for face in first[counts > 1].tolist():
        a, b, c = ordered[face].tolist()
        needs = sum(others.get(edge, 0) % 2 for edge in ((a, b), (b, c), (a, c)))
        # Beside other repeated faces nothing is known of the edge: the first copy stays.
        unknown = sum(edge not in others for edge in ((a, b), (b, c), (a, c)))
        kept[face] = not is_line[face] and needs + unknown >= 2
    return kept


def _edges(faces: Integers) -> Integers:
    """Return the directed edges, three of each face after the other."""
    return np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)


def _to_turn(faces: Integers) -> NDArray[np.bool_]:
    """Find which faces to turn so that neighbours run along their edge in opposite ways."""
    edges = _edges(faces)
    _, inverse, counts = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    group = inverse.reshape(-1)
    order = np.argsort(group, kind="stable")
    starts = np.cumsum(counts) - counts
    pairs = order[starts[counts == 2][:, None] + np.arange(2)]
    is_same_way = edges[pairs[:, 0], 0] == edges[pairs[:, 1], 0]
    if not is_same_way.any():
        return np.zeros(len(faces), dtype=bool)
    beside: list[list[tuple[int, bool]]] = [[] for _ in range(len(faces))]
    for (one, other), same in zip((pairs // 3).tolist(), is_same_way.tolist(), strict=True):
        beside[one].append((other, same))
        beside[other].append((one, same))
    turned = np.zeros(len(faces), dtype=bool)
    seen = np.zeros(len(faces), dtype=bool)
    for first in range(len(faces)):
        if seen[first]:
            continue
        seen[first] = True
        part, waiting = [first], [first]
        while waiting:
            face = waiting.pop()
            for other, same in beside[face]:
                if not seen[other]:
                    seen[other] = True
                    turned[other] = turned[face] ^ same
                    part.append(other)
                    waiting.append(other)
        if 2 * int(turned[part].sum()) > len(part):
            turned[part] = ~turned[part]
    return turned


def _fill_loops(mesh: Mesh) -> tuple[Mesh, int, int]:
    """Close each loop of open edges by triangles to the mean of their starts, as ``closure="caps"`` does."""
    edges = _edges(mesh.faces)
    undirected, inverse = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    forward = np.where(edges[:, 0] < edges[:, 1], 1, -1)
    net = np.bincount(inverse.reshape(-1), weights=forward, minlength=len(undirected)).astype(np.int64)
    where = np.repeat(np.flatnonzero(net), np.abs(net[net != 0]))
    open_edges = undirected[where]
    backward = net[where] < 0
    open_edges[backward] = open_edges[backward][:, ::-1]
    if not len(open_edges):
        return mesh, 0, 0
    corners, index = np.unique(open_edges, return_inverse=True)
    starts, ends = index.reshape(-1, 2).T
    root = np.arange(len(corners))
    while True:  # each corner takes the lowest number that an edge leads to
        lowest = root.copy()
        np.minimum.at(lowest, starts, root[ends])
        np.minimum.at(lowest, ends, root[starts])
        lowest = lowest[lowest]
        if np.array_equal(lowest, root):
            break
        root = lowest
    names, loop = np.unique(root[starts], return_inverse=True)
    sums = np.zeros((len(names), 3))
    np.add.at(sums, loop, mesh.vertices[open_edges[:, 0]])
    apexes = sums / np.bincount(loop)[:, None]
    fans = np.column_stack([open_edges[:, 1], open_edges[:, 0], len(mesh.vertices) + loop])
    vertices = np.concatenate([mesh.vertices, apexes])
    closed = Mesh(vertices, np.concatenate([mesh.faces, fans]), mesh.format)
    return closed, len(names), len(open_edges)
