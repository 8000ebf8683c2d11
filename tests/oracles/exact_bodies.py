"""Bodies put together, taken apart, moved, turned and scaled, exactly, from their float64 numbers.

A body is its mass and its first and second moments about the origin, which simply add: the centre of mass
and the tensor about it come last, so that no parallel-axis theorem is needed on the way.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from oracles import dot, rational

__all__ = ["Body"]

Vector = list[Fraction]
INDICES = range(3)


def _tensor(second: list[Vector]) -> list[Vector]:
    """tr(S) 1 − S, which is its own inverse but for the trace."""
    trace = sum((second[i][i] for i in INDICES), Fraction(0))
    return [[(trace if i == j else 0) - second[i][j] for j in INDICES] for i in INDICES]


@dataclass(frozen=True)
class Body:
    """Mass m, ∫ r dm and ∫ r rᵀ dm about the origin, in exact arithmetic."""

    mass: Fraction
    first: Vector
    second: list[Vector]

    @classmethod
    def from_tensor(cls, mass: Any, inertia: Any, center: Any) -> Body:
        """From mass, tensor about the centre of mass, and that."""
        m, tensor, c = rational(mass), rational(inertia), rational(center)
        half = sum((tensor[i][i] for i in INDICES), Fraction(0)) / 2
        second = [
            [(half if i == j else 0) - tensor[i][j] + m * c[i] * c[j] for j in INDICES] for i in INDICES
        ]
        return cls(m, [m * x for x in c], second)

    @classmethod
    def from_tensor_about_origin(cls, mass: Any, inertia: Any, center: Any) -> Body:
        """From mass, tensor about the origin, and centre of mass."""
        m, tensor = rational(mass), rational(inertia)
        half = sum((tensor[i][i] for i in INDICES), Fraction(0)) / 2
        second = [[(half if i == j else 0) - tensor[i][j] for j in INDICES] for i in INDICES]
        return cls(m, [m * x for x in rational(center)], second)

    @classmethod
    def from_particles(cls, masses: Any, positions: Any) -> Body:
        """Σ m, Σ m r and Σ m r rᵀ."""
        m, r = rational(masses), rational(positions)
        weighted = [[mass * x for x in place] for mass, place in zip(m, r, strict=True)]
        columns, moments = list(zip(*r, strict=True)), list(zip(*weighted, strict=True))
        second = [[dot(moments[i], columns[j]) for j in INDICES] for i in INDICES]
        return cls(sum(m, Fraction(0)), [sum(column, Fraction(0)) for column in moments], second)

    def plus(self, other: Body, sign: int = 1) -> Body:
        """Both as one, or what is left without the other."""
        return Body(
            self.mass + sign * other.mass,
            [a + sign * b for a, b in zip(self.first, other.first, strict=True)],
            [
                [a + sign * b for a, b in zip(*rows, strict=True)]
                for rows in zip(self.second, other.second, strict=True)
            ],
        )

    def translated(self, displacement: Any) -> Body:
        """Every r becomes r + d."""
        d, m, p = rational(displacement), self.mass, self.first
        second = [
            [self.second[i][j] + p[i] * d[j] + d[i] * p[j] + m * d[i] * d[j] for j in INDICES]
            for i in INDICES
        ]
        return Body(m, [a + m * b for a, b in zip(p, d, strict=True)], second)

    def rotated(self, rotation: Any) -> Body:
        """Every r becomes R r, and the tensor R I Rᵀ, with the very numbers of R."""
        R, mass = rational(rotation), self.mass
        inertia, center = self.inertia, [dot(row, self.center) for row in R]
        turned = [[dot(row, column) for column in zip(*inertia, strict=True)] for row in R]
        return Body.from_tensor(mass, [[dot(row, other) for other in R] for row in turned], center)

    def scaled(self, length: float, mass: float) -> Body:
        """Every r becomes s r, every mass k times itself."""
        s, k = Fraction(length), Fraction(mass)
        second = [[k * s * s * x for x in row] for row in self.second]
        return Body(k * self.mass, [k * s * x for x in self.first], second)

    @property
    def center(self) -> Vector:
        """∫ r dm / m."""
        return [x / self.mass for x in self.first]

    @property
    def inertia(self) -> list[Vector]:
        """The tensor about the centre of mass."""
        c = self.center
        central = [[self.second[i][j] - self.first[i] * c[j] for j in INDICES] for i in INDICES]
        return _tensor(central)
