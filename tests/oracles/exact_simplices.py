"""Mass properties of thin shells and wires to fifty digits, by rules that are exact for quadratic integrands.

The mean of a quadratic over a triangle is its mean over the three midpoints of the edges; over a segment it
is Simpson's (f(a) + 4 f(middle) + f(b))/6. No formula for second moments of simplices is used.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import mpmath
import numpy as np

__all__ = ["Thin", "shell", "wire"]

DIGITS = 50


class Thin:
    """Points with weights that stand for a distribution of matter up to second moments."""

    def __init__(self, weighted: list[tuple[Any, list[Any]]], digits: int = DIGITS) -> None:
        self.digits = digits
        with mpmath.workdps(digits):
            self.content = mpmath.fsum(w for w, _ in weighted)
            self.center = [mpmath.fsum(w * r[k] for w, r in weighted) / self.content for k in range(3)]
            arms = [(w, [x - c for x, c in zip(r, self.center, strict=True)]) for w, r in weighted]
            S = [[mpmath.fsum(w * d[i] * d[j] for w, d in arms) for j in range(3)] for i in range(3)]
            trace = S[0][0] + S[1][1] + S[2][2]
            self.inertia = [[(trace if i == j else 0) - S[i][j] for j in range(3)] for i in range(3)]

    @property
    def moments(self) -> list[Any]:
        """Principal moments, ascending."""
        with mpmath.workdps(self.digits):
            return sorted(mpmath.eigsy(mpmath.matrix(self.inertia), eigvals_only=True))


def _points(rows: Any) -> list[list[Any]]:
    return [[mpmath.mpf(x) for x in row] for row in np.asarray(rows, dtype=float).tolist()]


def _norm(v: list[Any]) -> Any:
    return mpmath.sqrt(mpmath.fsum(x * x for x in v))


def _middle(a: list[Any], b: list[Any]) -> list[Any]:
    return [(x + y) / 2 for x, y in zip(a, b, strict=True)]


def shell(vertices: Any, faces: Any, digits: int = DIGITS) -> Thin:
    """Triangles of mass one per area."""
    with mpmath.workdps(digits):
        points = _points(vertices)
        weighted = []
        for i, j, k in np.asarray(faces).tolist():
            a, b, c = points[i], points[j], points[k]
            e, f = ([x - y for x, y in zip(corner, a, strict=True)] for corner in (b, c))
            normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
            weight = _norm(normal) / 6
            weighted += [(weight, _middle(a, b)), (weight, _middle(b, c)), (weight, _middle(c, a))]
        return Thin(weighted, digits)


def wire(points: Any, digits: int = DIGITS) -> Thin:
    """Segments of mass one per length."""
    with mpmath.workdps(digits):
        rows = _points(points)
        weighted = []
        for a, b in pairwise(rows):
            sixth = _norm([y - x for x, y in zip(a, b, strict=True)]) / 6
            weighted += [(sixth, a), (4 * sixth, _middle(a, b)), (sixth, b)]
        return Thin(weighted, digits)
