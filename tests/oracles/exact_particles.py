"""Mass properties, energy and angular momentum of point masses, exactly, from their float64 values.

Straight from the definitions, particle by particle: no theorem that the library uses is used here.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath

from oracles import Exact, dot, rational

__all__ = ["Particles", "cross", "inertia_about", "moments", "sum_vectors"]

Vector = list[Fraction]


def cross(a: Exact, b: Exact) -> Vector:
    """Vector product of two exact vectors."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def sum_vectors(vectors: Sequence[Vector]) -> Vector:
    """Sum of exact vectors."""
    return [sum(column, Fraction(0)) for column in zip(*vectors, strict=True)]


def inertia_about(masses: Exact, positions: Exact, point: Exact) -> list[Vector]:
    """I_ij = Σ m (r² δ_ij − r_i r_j) with r from `point`."""
    total = [[Fraction(0)] * 3 for _ in range(3)]
    for m, position in zip(masses, positions, strict=True):
        r = [x - p for x, p in zip(position, point, strict=True)]
        square = dot(r, r)
        for i in range(3):
            for j in range(3):
                total[i][j] += m * ((square if i == j else 0) - r[i] * r[j])
    return total


def moments(inertia: Exact) -> list[float]:
    """Principal moments of an exact tensor, ascending: eigenvalues to 80 digits, then rounded."""
    with mpmath.mp.workdps(80):
        entries = [[mpmath.mpf(x.numerator) / x.denominator for x in row] for row in inertia]
        return sorted(float(value) for value in mpmath.eigsy(mpmath.matrix(entries), eigvals_only=True))


class Particles:
    """Point masses held rigidly together, in exact arithmetic."""

    def __init__(self, masses: Any, positions: Any) -> None:
        self.masses: Vector = rational(masses)
        self.positions: list[Vector] = rational(positions)
        self.mass: Fraction = sum(self.masses, Fraction(0))
        weighted = [[m * x for x in r] for m, r in zip(self.masses, self.positions, strict=True)]
        self.center_of_mass: Vector = [x / self.mass for x in sum_vectors(weighted)]
        self.inertia: list[Vector] = inertia_about(self.masses, self.positions, self.center_of_mass)

    def velocities(self, omega: Exact, velocity: Exact, about: Exact) -> list[Vector]:
        """v_i = v_P + ω×(r_i − P)."""
        arms = [[x - p for x, p in zip(r, about, strict=True)] for r in self.positions]
        return [[v + w for v, w in zip(velocity, cross(omega, arm), strict=True)] for arm in arms]

    def kinetic_energy(self, omega: Any, velocity: Any, about: Any) -> Fraction:
        """Σ ½ m v²."""
        v = self.velocities(rational(omega), rational(velocity), rational(about))
        return sum((m * dot(u, u) / 2 for m, u in zip(self.masses, v, strict=True)), Fraction(0))

    def angular_momentum(self, omega: Any, velocity: Any, position: Any, about: Any) -> Vector:
        """Σ m x×v about the inertial origin, where the point `about` of the body stands at `position`."""
        point, where = rational(about), rational(position)
        v = self.velocities(rational(omega), rational(velocity), point)
        x = [[R + r - p for R, r, p in zip(where, row, point, strict=True)] for row in self.positions]
        return sum_vectors([[m * c for c in cross(a, b)] for m, a, b in zip(self.masses, x, v, strict=True)])
