"""Closed, outward oriented triangle meshes, generated from nothing.

Counter-clockwise faces seen from outside. Each function returns ``(vertices, faces)``.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]

__all__ = ["box", "cube", "icosphere", "merge", "tetrahedron"]


def box(size: tuple[float, float, float]) -> tuple[Floats, Ints]:
    """A box with its centre at the origin: 8 vertices, 12 triangles."""
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    return np.array(corners) * np.array(size), np.array(faces)


def cube(side: float = 1.0) -> tuple[Floats, Ints]:
    """A cube with its centre at the origin."""
    return box((side, side, side))


def tetrahedron(side: float = 1.0) -> tuple[Floats, Ints]:
    """The corner tetrahedron 0, x, y, z with legs of length `side`."""
    vertices = side * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return vertices, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def icosphere(subdivisions: int = 4, radius: float = 1.0) -> tuple[Floats, Ints]:
    """An icosahedron, each triangle cut in four `subdivisions` times and pushed out to the sphere.

    Four subdivisions give 2562 vertices and 5120 triangles.
    """
    golden = (1 + 5**0.5) / 2
    points = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0),
              (0, -1, golden), (0, 1, golden), (0, -1, -golden), (0, 1, -golden),
              (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1)]  # fmt: skip
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]  # fmt: skip
    vertices = [np.array(p) / np.linalg.norm(p) for p in points]

    for _ in range(subdivisions):
        middles: dict[tuple[int, int], int] = {}

        def middle(a: int, b: int, middles: dict[tuple[int, int], int] = middles) -> int:
            edge = (min(a, b), max(a, b))
            if edge not in middles:
                between = vertices[a] + vertices[b]
                middles[edge] = len(vertices)
                vertices.append(between / np.linalg.norm(between))
            return middles[edge]

        finer = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return radius * np.array(vertices), np.array(faces)


def merge(*parts: tuple[Floats, Ints]) -> tuple[Floats, Ints]:
    """One mesh of several components, their vertices numbered on."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in parts[:-1]])
    vertices = np.concatenate([vertices for vertices, _ in parts])
    return vertices, np.concatenate([faces + n for (_, faces), n in zip(parts, starts, strict=True)])
