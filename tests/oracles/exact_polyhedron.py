"""Volume, centroid and inertia of a closed triangle mesh, exactly, from its float64 vertices.

By the divergence theorem a closed surface bounds the signed sum of the tetrahedra from the origin to
its triangles. With D = a·(b×c) and s = a + b + c, one tetrahedron has

    V = D/6,    ∫ r dV = D s/24,    ∫ r_i r_j dV = D (a_i a_j + b_i b_j + c_i c_j + s_i s_j)/120.

Floats are integers times a power of two, so all sums run on Python integers without any rounding,
and far from the origin nothing cancels but what should.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

__all__ = ["Solid", "polyhedron"]


@dataclass(frozen=True)
class Solid:
    """Exact integrals over a solid of density one."""

    volume: Fraction
    centroid: list[Fraction]
    inertia: list[list[Fraction]]
    """Tensor about the centroid, per unit density."""


def _as_integers(vertices: Any) -> tuple[list[list[int]], int]:
    """Vertices as integers over one common denominator, a power of two."""
    exact = [[Fraction(x) for x in row] for row in np.asarray(vertices, dtype=float).tolist()]
    unit = max((x.denominator for row in exact for x in row), default=1)
    return [[int(x * unit) for x in row] for row in exact], unit


def polyhedron(vertices: Any, faces: Any) -> Solid:
    """Exact mass properties of the solid inside a closed, outward oriented triangle mesh."""
    points, unit = _as_integers(vertices)
    volume, first = 0, [0, 0, 0]
    second = [[0, 0, 0] for _ in range(3)]
    for i, j, k in np.asarray(faces).tolist():
        a, b, c = points[i], points[j], points[k]
        det = (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )
        s = [a[n] + b[n] + c[n] for n in range(3)]
        volume += det
        for n in range(3):
            first[n] += det * s[n]
            for m in range(n + 1):
                second[n][m] += det * (a[n] * a[m] + b[n] * b[m] + c[n] * c[m] + s[n] * s[m])

    V = Fraction(volume, 6 * unit**3)
    C = [Fraction(first[n], 24 * unit**4) / V for n in range(3)]
    S = [[Fraction(second[max(n, m)][min(n, m)], 120 * unit**5) - V * C[n] * C[m] for m in range(3)]
         for n in range(3)]  # fmt: skip
    trace = S[0][0] + S[1][1] + S[2][2]
    I = [[(trace if n == m else 0) - S[n][m] for m in range(3)] for n in range(3)]
    return Solid(V, C, I)
