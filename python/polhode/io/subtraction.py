"""Solids less what slicers call negative volumes.

Where a negative volume lies within a solid it is a cavity, with its own triangles. Where it cuts through the
surface the rest is computed by manifold3d (extra ``union``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode.errors import MeshError
from polhode.io.components import labels, meeting, parts_of, winding
from polhode.io.mesh import Mesh, weld
from polhode.io.union import difference, has_union, is_closed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.io.components import Part

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

__all__ = ["subtract"]

_MOST_PAIRS: Final = 20_000_000
"""Edges times triangles that are compared one with the other."""
_PAIRS_AT_ONCE: Final = 200_000
_NEAR: Final = 1e-9
"""As a part of the size: nearer than this two surfaces touch."""


def subtract(solid: Mesh, negative: Mesh) -> tuple[Mesh, list[str]]:
    """Subtract volumes from solids.

    Parameters
    ----------
    solid, negative : Mesh
        Each of closed components.

    Returns
    -------
    mesh : Mesh
        What is left of the solids.
    notes : list of str

    Raises
    ------
    MeshError
        If a negative volume is open, or cuts through a surface and manifold3d is not there.
    """
    if not is_closed(weld(negative.vertices, negative.faces, "").faces):
        raise MeshError("a negative volume of it is open; export it again with closed ones")
    if not is_closed(weld(solid.vertices, solid.faces, "").faces):
        raise MeshError(
            "an object with a negative volume is open, so that nothing can be subtracted from it; export it "
            "again as a closed one"
        )
    parts = parts_of(solid.vertices, solid.faces, most=max(len(solid.faces), 1))
    tools = parts_of(negative.vertices, negative.faces, most=max(len(negative.faces), 1))
    vertices: list[Floats] = []
    faces: list[Integers] = []
    serving: set[int] = set()
    is_moved = False
    for part in parts:
        near = {n: how for n, tool in enumerate(tools) if (how := _relation(part, tool)) != "apart"}
        serving |= near.keys()
        cutting = [tools[n] for n in near]
        if "around" in near.values():
            continue
        own = part.vertices, part.faces[:, ::-1] if part.was_inward else part.faces
        if set(near.values()) <= {"inside"} and not meeting(cutting):
            surfaces = [own, *((tool.vertices, tool.faces[:, ::-1]) for tool in cutting)]
        else:
            if not has_union():
                raise MeshError(
                    "a negative volume cuts through the surface of its object; what is left is computed by "
                    'manifold3d: pip install "polhode[union]"'
                )
            surfaces = [difference((part.vertices, part.faces), [(t.vertices, t.faces) for t in cutting])]
            is_moved = True
        vertices += [points for points, _ in surfaces]
        faces += [corners for _, corners in surfaces]
    starts = np.cumsum([0, *map(len, vertices)])
    moved = [corners + start for corners, start in zip(faces, starts, strict=False)]
    mesh = (
        Mesh(np.concatenate(vertices), np.concatenate(moved), solid.format)
        if vertices
        else Mesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64), solid.format)
    )
    return mesh, _describe(len(serving), len(tools) - len(serving), is_moved=is_moved)


def _describe(serving: int, idle: int, *, is_moved: bool) -> list[str]:
    notes = []
    if serving:
        by = " by manifold3d; how far that moves corners is in no bound" if is_moved else ""
        notes.append(f"{serving} negative volume{'s were' if serving > 1 else ' was'} subtracted{by}")
    if idle:
        notes.append(
            f"{idle} negative volume{'s meet' if idle > 1 else ' meets'} no matter of the object, and "
            f"{'remove' if idle > 1 else 'removes'} nothing"
        )
    return notes


def _relation(part: Part, tool: Part) -> str:
    """Find how a tool lies to a part: "apart", "inside", "around", "across", or that it is not known."""
    if not meeting([part, tool]):
        return "apart"
    large, small = part.vertices[part.faces], tool.vertices[tool.faces]
    if _may_cross(large, small) or _may_cross(small, large):
        return "across"
    is_within = bool(winding(small[:1, 0], large)[0] > 0.5)
    # Surfaces that do not cross are each on one side of the other: a corner tells which.
    surfaces = labels(part.faces, len(part.vertices))
    first = [int(np.flatnonzero(surfaces == k)[0]) for k in range(int(surfaces.max()) + 1)]
    around = winding(large[first, 0], small) > 0.5
    if around.all():
        return "around"
    if around.any():
        return "across"
    return "inside" if is_within else "apart"


def _may_cross(edges_of: Floats, triangles: Floats) -> bool:
    """Find whether an edge of one surface meets a triangle of the other; yes if they are too many."""
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    near = _NEAR * float(np.linalg.norm(high - low))
    edges = np.concatenate([edges_of[:, [0, 1]], edges_of[:, [1, 2]], edges_of[:, [2, 0]]])
    edges = edges[((edges.max(axis=1) >= low - near) & (edges.min(axis=1) <= high + near)).all(axis=1)]
    if not len(edges):
        return False
    low, high = edges.min(axis=(0, 1)), edges.max(axis=(0, 1))
    triangles = triangles[
        ((triangles.max(axis=1) >= low - near) & (triangles.min(axis=1) <= high + near)).all(axis=1)
    ]
    if len(edges) * len(triangles) > _MOST_PAIRS:
        return True
    if not len(triangles):
        return False
    at_once = max(1, _PAIRS_AT_ONCE // len(triangles))
    return any(
        _meet(edges[start : start + at_once], triangles, near) for start in range(0, len(edges), at_once)
    )


def _meet(edges: Floats, triangles: Floats, near: float) -> bool:
    a, b, c = np.moveaxis(triangles, 1, 0)
    normals = np.cross(b - a, c - a)
    sizes = np.linalg.norm(normals, axis=1)
    normals = normals / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    offsets = np.einsum("tj,tj->t", normals, a)
    heights = np.einsum("epj,tj->ept", edges, normals) - offsets
    beside = (heights > near).all(axis=1) | (heights < -near).all(axis=1)
    lows = (edges.min(axis=1)[:, None] <= triangles.max(axis=1)[None] + near).all(axis=2)
    highs = (edges.max(axis=1)[:, None] >= triangles.min(axis=1)[None] - near).all(axis=2)
    e, t = np.nonzero(~beside & lows & highs)
    if not len(e):
        return False
    first, last = heights[e, 0, t], heights[e, 1, t]
    is_flat = (np.abs(first) <= near) & (np.abs(last) <= near)  # the edge lies in the plane of the triangle
    if is_flat.any():
        return True
    share = np.clip(first / (first - last), 0.0, 1.0)
    points = edges[e, 0] + share[:, None] * (edges[e, 1] - edges[e, 0])
    sides = []
    for start, end in ((a, b), (b, c), (c, a)):
        along = end[t] - start[t]
        away = np.einsum("kj,kj->k", np.cross(along, points - start[t]), normals[t])
        sides.append(away >= -near * np.linalg.norm(along, axis=1))
    return bool(np.all(sides, axis=0).any())
