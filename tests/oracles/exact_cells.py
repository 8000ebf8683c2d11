"""Tetrahedra with linear density in integer arithmetic: fast enough for a hundred thousand bodies.

The five-point rule of `exact_shapes`, with all floats as integers over one power of two: weights and nodes of
the rule are rational, and nothing is rounded until the caller does so.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from oracles.exact_shapes import Matter

__all__ = ["cells_matter"]

# Weights over 20, shares of the corners over 12.
RULE = [(-16, (3, 3, 3, 3)), *((9, tuple(6 if i == j else 2 for i in range(4))) for j in range(4))]


def _integers(values: Any) -> tuple[list[int], int]:
    """Floats as integers times two to one power, minus the returned shift."""
    ratios = [x.as_integer_ratio() for x in np.asarray(values, dtype=float).ravel().tolist()]
    unit = max((d for _, d in ratios), default=1)
    return [n * (unit // d) for n, d in ratios], unit


def cells_matter(nodes: Any, cells: Any, densities: Any) -> Matter | None:
    """Cells with the densities at their four corners, shape (m, 4); none where they have no mass."""
    flat, unit = _integers(nodes)
    points = [flat[k : k + 3] for k in range(0, len(flat), 3)]
    rhos, weight = _integers(densities)
    mass, first, second = 0, [0, 0, 0], [[0] * 3 for _ in range(3)]
    for m, (i, j, k, n) in enumerate(np.asarray(cells).tolist()):
        corners = [points[i], points[j], points[k], points[n]]
        a = corners[0]
        u, v, w = ([p[x] - a[x] for x in range(3)] for p in corners[1:])
        det = (
            u[0] * (v[1] * w[2] - v[2] * w[1])
            + u[1] * (v[2] * w[0] - v[0] * w[2])
            + u[2] * (v[0] * w[1] - v[1] * w[0])
        )
        rho = rhos[4 * m : 4 * m + 4]
        for share, at in RULE:
            d = share * abs(det) * sum(s * x for s, x in zip(at, rho, strict=True))
            r = [sum(s * p[x] for s, p in zip(at, corners, strict=True)) for x in range(3)]
            mass += d
            for x in range(3):
                first[x] += d * r[x]
                for y in range(x + 1):
                    second[x][y] += d * r[x] * r[y]
    if mass == 0:
        return None
    # Twelfths of lengths and densities, twentieths of weights, sixths of determinants.
    M = Fraction(mass, 20 * 6 * 12 * unit**3 * weight)
    C = [Fraction(x, 12 * unit * mass) for x in first]
    scale = 20 * 6 * 12 * 144 * unit**5 * weight * mass
    S = [
        [Fraction(second[max(x, y)][min(x, y)] * mass - first[x] * first[y], scale) for y in range(3)]
        for x in range(3)
    ]
    return Matter(M, C, S)
