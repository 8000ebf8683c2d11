"""Mass properties, energy and angular momentum of point masses, exactly, from their float64 values.

Straight from the definitions, particle by particle: no theorem that the library uses is used here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import chain
from operator import mul
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
    """I_ij = Σ m (r² δ_ij − r_i r_j) with r from `point`.

    In integers over common denominators: fractions would look for a common divisor in each sum.
    """
    (masses, unit), (numbers, length) = _over_one(masses), _over_one([*point, *chain(*positions)])
    p, q, s = numbers[:3]
    products = [0] * 6  # Σ m r_i r_j: xx, yy, zz, xy, xz, yz
    for m, x, y, z in zip(masses, numbers[3::3], numbers[4::3], numbers[5::3], strict=True):
        x, y, z = x - p, y - q, z - s
        for k, product in enumerate((x * x, y * y, z * z, x * y, x * z, y * z)):
            products[k] += m * product
    xx, yy, zz, xy, xz, yz = (Fraction(one, unit * length**2) for one in products)
    return [[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]]


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    """Scalar product of long vectors."""
    (one, unit), (other, length) = _over_one(a), _over_one(b)
    return Fraction(sum(map(mul, one, other)), unit * length)


def _over_one(values: Sequence[Fraction]) -> tuple[list[int], int]:
    """Numerators over the least common denominator, and that."""
    whole = math.lcm(*{value.denominator for value in values})
    return [value.numerator * (whole // value.denominator) for value in values], whole


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
        self.mass: Fraction = _dot(self.masses, [Fraction(1)] * len(self.masses))
        self.center_of_mass: Vector = [
            _dot(self.masses, column) / self.mass for column in zip(*self.positions, strict=True)
        ]
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
