"""What acts on a body, as series: the terms of `oracles.rotation` that stand for the loads of polhode.

A vector that is fixed in space is carried along in body components, u̇ = u×ω, which keeps every equation
polynomial but for |ω| and the powers of a distance.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import mpmath
from mpmath import mpf

from oracles.rotation import Rotation, Term, Vector, cross, inverse

if TYPE_CHECKING:
    from oracles.taylor import Row

__all__ = [
    "BodyForce",
    "BodyTorque",
    "Damping",
    "Feedback",
    "Gradient",
    "Oscillating",
    "SpaceForce",
    "Weight",
]


class _Still(Term):
    """A term without unknowns of its own."""

    def start(self, rotation: Rotation, quaternion: Vector) -> Vector:  # noqa: ARG002
        return []

    def rates(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:  # noqa: ARG002
        return []


class SpaceForce(Term):
    """A force F constant in space at an arm a, and a torque T constant in space: N = a×F_B + T_B, F/m."""

    def __init__(
        self, mass: Any, arm: Any = (0, 0, 0), force: Any = (0, 0, 0), torque: Any = (0, 0, 0)
    ) -> None:
        self.mass, self.arm, self._force, self._torque = mass, arm, force, torque

    def start(self, rotation: Rotation, quaternion: Vector) -> Vector:
        self._fixed_arm = [rotation.fixed(x) for x in self.arm]
        self._acceleration = [rotation.fixed(mpf(x) / mpf(self.mass)) for x in self._force]
        vectors = [[mpf(x) for x in v] for v in (self._force, self._torque)]
        return [x for v in vectors for x in inverse(quaternion, v)]

    def rates(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        return rotation.turning(own[:3], n) + rotation.turning(own[3:], n)

    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        force, torque = [row[n] for row in own[:3]], [row[n] for row in own[3:]]
        return [x + y for x, y in zip(_fixed_cross(rotation, self._fixed_arm, force), torque, strict=True)]

    def force(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:  # noqa: ARG002
        return self._acceleration if n == 0 else [0, 0, 0]


class Weight(SpaceForce):
    """Weight m g at the centre c of a body whose origin is held: N = c×m g_B."""

    def __init__(self, mass: Any, center_of_mass: Any, gravity: Any) -> None:
        super().__init__(mass, center_of_mass, [mpf(mass) * mpf(x) for x in gravity])


class BodyTorque(_Still):
    """A torque constant in the body."""

    def __init__(self, vector: Any) -> None:
        self.vector = vector

    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:  # noqa: ARG002
        return [rotation.fixed(x) for x in self.vector] if n == 0 else [0, 0, 0]


class BodyForce(Term):
    """A force F constant in the body at an arm a, as of a nozzle: N = a×F, R F/m; carries the rows of R."""

    def __init__(self, mass: Any, arm: Any, force: Any) -> None:
        self.mass, self.arm, self.vector = mass, arm, force

    def start(self, rotation: Rotation, quaternion: Vector) -> Vector:
        self._torque = [rotation.fixed(x) for x in cross(self.arm, self.vector)]
        self._acceleration = [rotation.fixed(mpf(x) / mpf(self.mass)) for x in self.vector]
        unit = [[mpf(int(i == j)) for j in range(3)] for i in range(3)]
        return [x for e in unit for x in inverse(quaternion, e)]

    def rates(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        return [x for i in (0, 3, 6) for x in rotation.turning(own[i : i + 3], n)]

    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:  # noqa: ARG002
        return self._torque if n == 0 else [0, 0, 0]

    def force(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        rows = [own[i : i + 3] for i in (0, 3, 6)]
        return [
            sum(rotation.scaled(f, x[n]) for f, x in zip(self._acceleration, row, strict=True))
            for row in rows
        ]


class Oscillating(Term):
    """The torque vector·sin(rate·t + phase) in the body; carries sine and cosine."""

    def __init__(self, vector: Any, rate: Any, phase: Any) -> None:
        self.vector, self.rate, self.phase = vector, rate, phase

    def start(self, rotation: Rotation, quaternion: Vector) -> Vector:  # noqa: ARG002
        self._vector = [rotation.fixed(x) for x in self.vector]
        self._rate = rotation.fixed(self.rate)
        return [mpmath.sin(mpf(self.phase)), mpmath.cos(mpf(self.phase))]

    def rates(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        sine, cosine = own
        return [rotation.scaled(self._rate, cosine[n]), -rotation.scaled(self._rate, sine[n])]

    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        return [rotation.scaled(x, own[0][n]) for x in self._vector]


class Damping(_Still):
    """N = −D ω − E |ω| ω."""

    def __init__(self, matrix: Any, quadratic: Any = None) -> None:
        self.linear, self.quadratic = matrix, quadratic
        self._square: Row = []
        self._length = _Power(1, 2)

    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:  # noqa: ARG002
        w = rotation.omega
        total = [-x for x in _fixed_apply(rotation, self.linear, [row[n] for row in w])]
        if self.quadratic is not None:
            if n == 0:
                self._square = []
            self._square.append(sum(rotation.product(row, row, n) for row in w))
            length = self._length.extend(rotation, self._square, n)
            faster = [rotation.product(length, row, n) for row in w]
            total = [
                x - y for x, y in zip(total, _fixed_apply(rotation, self.quadratic, faster), strict=True)
            ]
        return total


class Feedback(_Still):
    """N = −K sign(w) vec(e) − D ω with e = q_target⁻¹ q; the scalar w keeps its sign."""

    def __init__(self, K: Any, D: Any, target: Any = (0, 0, 0, 1)) -> None:
        self.stiffness, self.damping, self.target = K, D, target

    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:  # noqa: ARG002
        a, b, c, d = self._unit(rotation)
        x, y, z, w = ([row[k] for k in (0, n)] for row in rotation.quaternion)
        s = rotation.scaled

        def error(k: int) -> list[int]:
            return [
                s(d, x[k]) - s(a, w[k]) - s(b, z[k]) + s(c, y[k]),
                s(d, y[k]) - s(b, w[k]) - s(c, x[k]) + s(a, z[k]),
                s(d, z[k]) - s(c, w[k]) - s(a, y[k]) + s(b, x[k]),
                s(d, w[k]) + s(a, x[k]) + s(b, y[k]) + s(c, z[k]),
            ]

        scalar = error(0)[3]
        if abs(scalar) < 1 << rotation.bits - 5:
            raise ArithmeticError(
                "the error comes near half a turn, where the sign of its scalar part changes"
            )
        vector = [e if scalar > 0 else -e for e in error(1)[:3]]
        pull = _fixed_apply(rotation, self.stiffness, vector)
        drag = _fixed_apply(rotation, self.damping, [row[n] for row in rotation.omega])
        return [-x - y for x, y in zip(pull, drag, strict=True)]

    def _unit(self, rotation: Rotation) -> list[int]:
        target = [mpf(x) for x in self.target]
        return [rotation.fixed(x / mpmath.norm(target)) for x in target]


class Gradient(Term):
    """N = 3μ/r⁵ r_B×(I r_B) on a Kepler orbit r̈ = −μ r/r³; carries r and ṙ in body components."""

    def __init__(self, mu: Any, position: Any, velocity: Any) -> None:
        self.mu, self.position, self.velocity = mu, position, velocity
        self._square: Row = []
        self._third, self._fifth = _Power(-3, 2), _Power(-5, 2)
        self._pull: list[Row] = []
        self._lever: list[Row] = []

    def start(self, rotation: Rotation, quaternion: Vector) -> Vector:
        self._mu = rotation.fixed(self.mu)
        return [x for v in (self.position, self.velocity) for x in inverse(quaternion, [mpf(y) for y in v])]

    def rates(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        r, v = own[:3], own[3:]
        if n == 0:
            self._square = []
        self._square.append(sum(rotation.product(row, row, n) for row in r))
        third = self._third.extend(rotation, self._square, n)
        falls = [rotation.scaled(self._mu, rotation.product(third, row, n)) for row in r]
        moves = [a + row[n] for a, row in zip(rotation.turning(r, n), v, strict=True)]
        return moves + [a - b for a, b in zip(rotation.turning(v, n), falls, strict=True)]

    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        r = own[:3]
        if n == 0:
            self._pull, self._lever = [[], [], []], [[], [], []]
        bent = _fixed_apply(rotation, rotation.inertia, [row[n] for row in r])
        for row, x in zip(self._pull, bent, strict=True):
            row.append(x)
        pairs = ((1, 2), (2, 0), (0, 1))
        for row, (i, j) in zip(self._lever, pairs, strict=True):
            row.append(rotation.product(r[i], self._pull[j], n) - rotation.product(r[j], self._pull[i], n))
        fifth = self._fifth.extend(rotation, self._square, n)
        return [3 * rotation.scaled(self._mu, rotation.product(fifth, row, n)) for row in self._lever]


class _Power:
    """The series of u^(p/q): u w' = (p/q) u' w, coefficient by coefficient."""

    def __init__(self, p: int, q: int) -> None:
        self.p, self.q = p, q
        self.row: Row = []

    def extend(self, rotation: Rotation, u: Row, n: int) -> Row:
        """The series up to coefficient n."""
        if n == 0:
            self.row = [rotation.fixed(mpmath.power(rotation.real(u[0]), mpf(self.p) / self.q))]
        else:
            weights = [self.p * k - self.q * (n - k) for k in range(1, n + 1)]
            total = sum(a * x * y for a, x, y in zip(weights, u[1:], reversed(self.row), strict=True))
            self.row.append(total // (self.q * n * u[0]))
        return self.row


def _fixed_apply(rotation: Rotation, matrix: Any, vector: Sequence[int]) -> list[int]:
    """A matrix, or a multiple of the unit matrix, times a vector in fixed point."""
    if not isinstance(matrix, list | tuple):
        return [rotation.scaled(rotation.constant(matrix), x) for x in vector]
    return [
        sum(rotation.scaled(rotation.constant(a), x) for a, x in zip(row, vector, strict=True) if a)
        for row in matrix
    ]


def _fixed_cross(rotation: Rotation, a: Sequence[int], b: Sequence[int]) -> list[int]:
    return [rotation.scaled(a[i], b[j]) - rotation.scaled(a[j], b[i]) for i, j in ((1, 2), (2, 0), (0, 1))]
