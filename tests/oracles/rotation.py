"""A rigid body as a `System`: angular momentum, attitude, what acts on the body, and its path.

The unknowns are L (body components), the quaternion, position and velocity of the centre of mass (space
components), then whatever each term carries along:

    L̇ = L×ω + N,    q̇ = ½ q (ω − c L),    ẋ = v,    v̇ = F/m,    ω = I⁻¹ L

The tensor is taken as it is; nothing is diagonalised. With c ≠ 0, allowed without torques only, the
quaternion is that of a frame in which the steady part exp(c L t/2) of the motion is taken out; it is
multiplied back, from the left, by `Rotation.states`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, TypeAlias

import mpmath
import numpy as np
from mpmath import mp, mpf

from oracles.taylor import Row, State, System

__all__ = [
    "Rotation",
    "Term",
    "Vector",
    "conjugate",
    "cross",
    "exponential",
    "inverse",
    "power",
    "times",
    "turned",
]

Vector: TypeAlias = list[mpf]

_PAIRS = ((1, 2), (2, 0), (0, 1))


class Term(ABC):
    """Something that acts on the body: a torque, a force, unknowns of its own."""

    @abstractmethod
    def start(self, rotation: Rotation, quaternion: Vector) -> Vector:
        """Values of the unknowns that it carries, at the start; the place to keep constants too."""

    @abstractmethod
    def rates(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        """Coefficient n of the derivatives of those unknowns."""

    @abstractmethod
    def torque(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:
        """Coefficient n of the torque, body components."""

    def force(self, rotation: Rotation, own: list[Row], n: int) -> list[int]:  # noqa: ARG002
        """Coefficient n of the force over the mass, space components: none unless a term says so."""
        return [0, 0, 0]


class Rotation(System):
    """The rotation, and with a position the path, of one body.

    Parameters
    ----------
    inertia : (3,) or (3, 3)
        Principal moments along the axes of the frame, or the tensor. A moment of zero is allowed among
        three moments; the rate about its axis stays what it is.
    terms : sequence of Term
        What acts.
    drift : number
        The c above.
    """

    def __init__(self, inertia: Any, digits: int, *, terms: Sequence[Term] = (), drift: Any = 0) -> None:
        super().__init__(digits)
        self.terms = list(terms)
        with mp.workdps(digits + 30):
            self.inertia, self.J = _tensor_and_inverse(inertia)
            self.drift = mpf(drift)
            self._J = [[self.fixed(x) for x in row] for row in self.J]
            self._c = self.fixed(self.drift)
        self.omega: list[Row] = []
        self.quaternion: list[Row] = []
        self._relative: list[Row] = []
        self._held: list[int] = [0, 0, 0]
        self._constants: dict[Any, int] = {}
        self._moves = False

    def constant(self, x: Any) -> int:
        """A constant in fixed point, remembered."""
        if x not in self._constants:
            self._constants[x] = self.fixed(x)
        return self._constants[x]

    def begin(self, omega: Any, quaternion: Any, path: Any = None) -> State:
        """The first state. `path` is (position, velocity) of the centre of mass."""
        with mp.workdps(self.digits + 30):
            w, q = [mpf(x) for x in omega], [mpf(x) for x in quaternion]
            zero = [i for i in range(3) if not any(self.J[i])]
            self._held = [self.fixed(w[i] if i in zero else 0) for i in range(3)]
            values = [*apply(self.inertia, w), *q]
            self._moves = path is not None
            if path is not None:
                values += [mpf(x) for part in path for x in part]
            self._slices = []
            for term in self.terms:
                own = term.start(self, q)
                self._slices.append(slice(len(values), len(values) + len(own)))
                values += own
            return [self.fixed(x) for x in values]

    def rates(self, rows: list[Row], n: int) -> list[int]:
        if n == 0:
            self.omega, self._relative = [[], [], []], [[], [], []]
        L, q = rows[:3], rows[3:7]
        self.quaternion = q
        newest = [row[n] for row in L]
        for i in range(3):
            w = self._rate(newest, i) + (self._held[i] if n == 0 else 0)
            self.omega[i].append(w)
            self._relative[i].append(w - self.scaled(self._c, newest[i]))
        momentum = self.turning(L, n)
        force = [0, 0, 0]
        extra = []
        for term, where in zip(self.terms, self._slices, strict=True):
            own = rows[where]
            extra += term.rates(self, own, n)
            momentum = [a + b for a, b in zip(momentum, term.torque(self, own, n), strict=True)]
            force = [a + b for a, b in zip(force, term.force(self, own, n), strict=True)]
        path = [*(row[n] for row in rows[10:13]), *force] if self._moves else []
        return [*momentum, *self._turn(q, n), *path, *extra]

    def turning(self, vector: list[Row], n: int) -> list[int]:
        """Coefficient n of u×ω, the body's derivative of a vector that is fixed in space."""
        w = self.omega
        return [self.product(vector[i], w[j], n) - self.product(vector[j], w[i], n) for i, j in _PAIRS]

    def _turn(self, q: list[Row], n: int) -> list[int]:
        """Coefficient n of ½ q (ω − c L)."""
        x, y, z, w = q
        a, b, c = self._relative
        p = self.product
        doubled = [
            p(w, a, n) + p(y, c, n) - p(z, b, n),
            p(w, b, n) + p(z, a, n) - p(x, c, n),
            p(w, c, n) + p(x, b, n) - p(y, a, n),
            -p(x, a, n) - p(y, b, n) - p(z, c, n),
        ]
        return [d >> 1 for d in doubled]

    def _rate(self, momentum: list[int], i: int) -> int:
        return sum(self.scaled(j, x) for j, x in zip(self._J[i], momentum, strict=True) if j)

    def rate_of(self, state: State) -> list[int]:
        """The angular velocity of a state, in fixed point."""
        return [self._rate(state[:3], i) + self._held[i] for i in range(3)]


def _tensor_and_inverse(inertia: Any) -> tuple[list[Vector], list[Vector]]:
    values = inertia.tolist() if isinstance(inertia, np.ndarray) else list(inertia)
    if not isinstance(values[0], list | tuple):
        moments = [mpf(x) for x in values]
        return _diagonal(moments), _diagonal([1 / x if x else x for x in moments])
    tensor = mpmath.matrix([[mpf(x) for x in row] for row in values])
    return tensor.tolist(), (tensor**-1).tolist()


def _diagonal(values: Vector) -> list[Vector]:
    return [[x if i == j else mpf(0) for j in range(3)] for i, x in enumerate(values)]


def apply(matrix: Any, vector: Any) -> Vector:
    """Product of a matrix and a vector."""
    return [mpmath.fdot([mpf(x) for x in row], vector) for row in matrix]


def cross(a: Any, b: Any) -> Vector:
    """Vector product."""
    return [mpf(a[i]) * mpf(b[j]) - mpf(a[j]) * mpf(b[i]) for i, j in _PAIRS]


def times(p: Any, q: Any) -> Vector:
    """Product of quaternions (x, y, z, w)."""
    a, b = p[:3], q[:3]
    vector = [p[3] * y + q[3] * x + z for x, y, z in zip(a, b, cross(a, b), strict=True)]
    return [*vector, p[3] * q[3] - mpmath.fdot(a, b)]


def conjugate(q: Any) -> Vector:
    """The inverse of a unit quaternion."""
    return [-q[0], -q[1], -q[2], q[3]]


def turned(q: Any, vector: Any) -> Vector:
    """Space components of a vector with these body components."""
    return times(times(q, [*vector, mpf(0)]), conjugate(q))[:3]


def inverse(q: Any, vector: Any) -> Vector:
    """Body components of a vector with these space components."""
    return turned(conjugate(q), vector)


def exponential(vector: Any) -> Vector:
    """The rotation by this vector: its length is the angle."""
    angle = mpmath.sqrt(mpmath.fdot(vector, vector))
    if not angle:
        return [mpf(0), mpf(0), mpf(0), mpf(1)]
    s = mpmath.sin(angle / 2) / angle
    return [*(s * x for x in vector), mpmath.cos(angle / 2)]


def power(q: Any, n: int) -> Vector:
    """The n-th power of a unit quaternion."""
    s = mpmath.sqrt(mpmath.fdot(q[:3], q[:3]))
    if not s:
        return [mpf(0), mpf(0), mpf(0), mpf(q[3]) ** n]
    half = n * mpmath.atan2(s, q[3])
    return [*(mpmath.sin(half) * x / s for x in q[:3]), mpmath.cos(half)]
