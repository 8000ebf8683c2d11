"""Polygons and tetrahedra in exact rational arithmetic, from the very floats given to the code under test.

Polygons by Green's theorem in its textbook form, about the origin. Tetrahedra by a five-point rule that is
exact for cubic polynomials and has rational nodes, which says nothing of the closed forms the code uses.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from oracles import rational

__all__ = ["Matter", "polygon", "tensor", "tetrahedra"]


@dataclass(frozen=True)
class Matter:
    """Exact integrals: mass, centroid, and second moments about the centroid."""

    mass: Fraction
    center: list[Fraction]
    second: list[list[Fraction]]

    @property
    def inertia(self) -> list[list[Fraction]]:
        return tensor(self.second)


def tensor(second: list[list[Fraction]]) -> list[list[Fraction]]:
    """`tr(S) 1 − S`."""
    trace = sum((second[i][i] for i in range(3)), Fraction(0))
    return [[(trace if i == j else 0) - second[i][j] for j in range(3)] for i in range(3)]


def _matter(mass: Fraction, first: list[Fraction], second: list[list[Fraction]]) -> Matter:
    center = [f / mass for f in first]
    central = [[second[i][j] - mass * center[i] * center[j] for j in range(3)] for i in range(3)]
    return Matter(mass, center, central)


def polygon(vertices: Any) -> Matter:
    """A simple polygon of unit density in the x-y plane, counter-clockwise or not."""
    points = rational(np.asarray(vertices, dtype=float))
    area, sx, sy, xx, xy, yy = (Fraction(0) for _ in range(6))
    for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1], strict=True):
        d = x0 * y1 - x1 * y0
        area += d / 2
        sx += d * (x0 + x1) / 6
        sy += d * (y0 + y1) / 6
        xx += d * (x0 * x0 + x0 * x1 + x1 * x1) / 12
        yy += d * (y0 * y0 + y0 * y1 + y1 * y1) / 12
        xy += d * (x0 * y1 + 2 * x0 * y0 + 2 * x1 * y1 + x1 * y0) / 24
    sign = 1 if area > 0 else -1
    zero = Fraction(0)
    second = [[sign * xx, sign * xy, zero], [sign * xy, sign * yy, zero], [zero] * 3]
    return _matter(sign * area, [sign * sx, sign * sy, zero], second)


def tetrahedra(nodes: Any, cells: Any, densities: Any) -> Matter:
    """Cells with the densities at their four corners, shape (m, 4), linear in between."""
    points = rational(np.asarray(nodes, dtype=float))
    rule = [(Fraction(-4, 5), [Fraction(1, 4)] * 4)]
    rule += [(Fraction(9, 20), [Fraction(1, 2 if i == j else 6) for i in range(4)]) for j in range(4)]
    mass, first = Fraction(0), [Fraction(0)] * 3
    second = [[Fraction(0)] * 3 for _ in range(3)]
    for cell, rho in zip(np.asarray(cells).tolist(), rational(np.asarray(densities, float)), strict=True):
        a, b, c, d = (points[k] for k in cell)
        u, v, w = ([p[i] - a[i] for i in range(3)] for p in (b, c, d))
        det = (
            u[0] * (v[1] * w[2] - v[2] * w[1])
            + u[1] * (v[2] * w[0] - v[0] * w[2])
            + u[2] * (v[0] * w[1] - v[1] * w[0])
        )
        for weight, share in rule:
            r = [
                sum((s * p[i] for s, p in zip(share, (a, b, c, d), strict=True)), Fraction(0))
                for i in range(3)
            ]
            m = weight * abs(det) / 6 * sum((s * x for s, x in zip(share, rho, strict=True)), Fraction(0))
            mass += m
            for i in range(3):
                first[i] += m * r[i]
                for j in range(3):
                    second[i][j] += m * r[i] * r[j]
    return _matter(mass, first, second)
