"""Bodies as trees of uncertain numbers: one description that an oracle evaluates and a test builds.

Each number is a `Quantity`: a value and a factor L, so that a draw is value + L z with z standard normal.
Quantities with one name share z, and a quantity used twice is the same draw. A tree is evaluated in plain
arithmetic: on floats, on arrays of draws, on numbers of fifty digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from oracles.textbook_shapes import SHAPES, Field

Floats: TypeAlias = NDArray[np.float64]

__all__ = [
    "PAIRS",
    "Given",
    "Matter",
    "Mesh",
    "Moved",
    "Node",
    "Particles",
    "Principal",
    "Quantity",
    "Scaled",
    "Solid",
    "Sum",
    "Tensor",
    "Turned",
    "displaced",
    "quantities",
    "ten_numbers",
]

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Order of the elements of a tensor: xx yy zz xy xz yz."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """Numbers (flat), the factor of their covariance (size, k), and the shape and name for the package."""

    value: Floats
    factor: Floats | None = None
    shape: tuple[int, ...] = ()
    source: str | None = None

    @property
    def key(self) -> object:
        """What shares a draw: a name, or this very object."""
        return self.source if self.source is not None else id(self)

    @property
    def covariance(self) -> Floats:
        assert self.factor is not None
        return self.factor @ self.factor.T


Values: TypeAlias = Callable[[Quantity], list[Any]]


@dataclass
class Matter:
    """Mass, ∫r dm and ∫r rᵀ dm about the origin: what adds when bodies do."""

    mass: Any
    first: list[Any]
    second: list[Any]


class Node(Protocol):
    """A body made of quantities, and of other bodies."""

    def matter(self, of: Values, f: Field) -> Matter: ...


def _about_origin(mass: Any, center: list[Any], central: list[Any]) -> Matter:
    second = [s + mass * center[i] * center[j] for s, (i, j) in zip(central, PAIRS, strict=True)]
    return Matter(mass, [mass * c for c in center], second)


def _second(inertia: list[Any]) -> list[Any]:
    """½ tr(I) 1 − I."""
    half = (inertia[0] + inertia[1] + inertia[2]) / 2
    return [half - x for x in inertia[:3]] + [-x for x in inertia[3:]]


def ten_numbers(matter: Matter) -> list[Any]:
    """Mass, centre, and tensor about it: xx yy zz xy xz yz, products with their minus."""
    center = [x / matter.mass for x in matter.first]
    s = [x - matter.mass * center[i] * center[j] for x, (i, j) in zip(matter.second, PAIRS, strict=True)]
    return [matter.mass, *center, s[1] + s[2], s[0] + s[2], s[0] + s[1], -s[3], -s[4], -s[5]]


def _product(a: list[list[Any]], b: list[list[Any]]) -> list[list[Any]]:
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def _matrix(x: Any, y: Any, z: Any, w: Any) -> list[list[Any]]:
    n = x * x + y * y + z * z + w * w
    return [
        [1 - 2 * (y * y + z * z) / n, 2 * (x * y - z * w) / n, 2 * (x * z + y * w) / n],
        [2 * (x * y + z * w) / n, 1 - 2 * (x * x + z * z) / n, 2 * (y * z - x * w) / n],
        [2 * (x * z - y * w) / n, 2 * (y * z + x * w) / n, 1 - 2 * (x * x + y * y) / n],
    ]


def _turned(quaternion: Floats, turn: list[Any], f: Field) -> list[list[Any]]:
    """exp([θ]×) R: the small rotation acts after, about the axes in which the body then stands.

    The quaternion of θ is (θ sinc(θ/2)/2, cos θ/2), both by their series: θ is small.
    """
    half = sum(t * t for t in turn) / 4
    sinc: Any = 0 * half + 1
    cosine: Any = 0 * half + 1
    term: Any = 0 * half + 1
    for k in range(1, 12):
        term = -term * half / ((2 * k - 1) * (2 * k))
        cosine = cosine + term
        sinc = sinc + term / (2 * k + 1)
    small = _matrix(turn[0] * sinc / 2, turn[1] * sinc / 2, turn[2] * sinc / 2, cosine)
    x, y, z, w = (f.number(q) for q in quaternion)
    return _product(small, _matrix(x, y, z, w))


def _rotate(matter: Matter, R: list[list[Any]]) -> Matter:
    xx, yy, zz, xy, xz, yz = matter.second
    s = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    s = _product(_product(R, s), [[R[j][i] for j in range(3)] for i in range(3)])
    first = [sum(R[i][k] * matter.first[k] for k in range(3)) for i in range(3)]
    return Matter(matter.mass, first, [s[i][j] for i, j in PAIRS])


@dataclass(frozen=True, eq=False)
class Tensor:
    """A tensor as measured, about the centre of mass or the origin."""

    mass: Quantity
    center: Quantity
    inertia: Quantity
    about_origin: bool = False

    def matter(self, of: Values, f: Field) -> Matter:  # noqa: ARG002
        (mass,), center, second = of(self.mass), of(self.center), _second(of(self.inertia))
        if self.about_origin:
            return Matter(mass, [mass * c for c in center], second)
        return _about_origin(mass, center, second)


@dataclass(frozen=True, eq=False)
class Given:
    """Ten numbers with a covariance of their own."""

    numbers: Quantity

    def matter(self, of: Values, f: Field) -> Matter:  # noqa: ARG002
        mass, *rest = of(self.numbers)
        return _about_origin(mass, rest[:3], _second(rest[3:]))


@dataclass(frozen=True, eq=False)
class Principal:
    """Principal moments, and the attitude of their axes with three small rotations."""

    mass: Quantity
    moments: Quantity
    attitude: Quantity
    turn: Quantity
    center: Quantity

    def matter(self, of: Values, f: Field) -> Matter:
        (mass,), moments, center = of(self.mass), of(self.moments), of(self.center)
        own = Matter(mass, [0, 0, 0], [*_second([*moments, 0, 0, 0])[:3], 0, 0, 0])
        turned = _rotate(own, _turned(self.attitude.value, of(self.turn), f))
        return _about_origin(mass, center, turned.second)


@dataclass(frozen=True, eq=False)
class Particles:
    """Point masses."""

    masses: Quantity
    positions: Quantity

    def matter(self, of: Values, f: Field) -> Matter:  # noqa: ARG002
        masses, flat = of(self.masses), of(self.positions)
        points = [flat[i : i + 3] for i in range(0, len(flat), 3)]
        first = [sum(m * p[i] for m, p in zip(masses, points, strict=True)) for i in range(3)]
        second = [sum(m * p[i] * p[j] for m, p in zip(masses, points, strict=True)) for i, j in PAIRS]
        return Matter(sum(masses), first, second)


@dataclass(frozen=True, eq=False)
class Solid:
    """A shape of the textbook with its lengths, and a mass or a density."""

    name: str
    lengths: dict[str, Quantity | int]
    amount: Quantity
    by_density: bool

    def matter(self, of: Values, f: Field) -> Matter:
        formula = SHAPES[self.name][0]
        numbers: list[Any] = []
        for length in self.lengths.values():
            numbers += [length] if isinstance(length, int) else of(length)
        shape = formula(f, *numbers)
        (amount,) = of(self.amount)
        mass = amount * shape.measure if self.by_density else amount
        return _about_origin(mass, list(shape.center), [mass * x for x in shape.means])


@dataclass(frozen=True, eq=False)
class Mesh:
    """A closed polyhedron: tetrahedra from the origin with their signs."""

    vertices: Quantity
    faces: NDArray[np.int64]
    amount: Quantity
    by_density: bool

    def matter(self, of: Values, f: Field) -> Matter:  # noqa: ARG002
        flat = of(self.vertices)
        points = [flat[i : i + 3] for i in range(0, len(flat), 3)]
        volume: Any = 0
        first: list[Any] = [0, 0, 0]
        second: list[Any] = [0] * 6
        for face in self.faces.tolist():
            a, b, c = (points[k] for k in face)
            cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]
            v = (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6
            total = [a[i] + b[i] + c[i] for i in range(3)]
            volume = volume + v
            first = [x + v * t / 4 for x, t in zip(first, total, strict=True)]
            second = [
                x + v * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + total[i] * total[j]) / 20
                for x, (i, j) in zip(second, PAIRS, strict=True)
            ]
        (amount,) = of(self.amount)
        rho = amount if self.by_density else amount / volume
        return Matter(rho * volume, [rho * x for x in first], [rho * x for x in second])


@dataclass(frozen=True, eq=False)
class Moved:
    body: Node
    displacement: Quantity

    def matter(self, of: Values, f: Field) -> Matter:
        m, d = self.body.matter(of, f), of(self.displacement)
        second = [
            s + d[i] * m.first[j] + d[j] * m.first[i] + m.mass * d[i] * d[j]
            for s, (i, j) in zip(m.second, PAIRS, strict=True)
        ]
        return Matter(m.mass, [x + m.mass * e for x, e in zip(m.first, d, strict=True)], second)


@dataclass(frozen=True, eq=False)
class Turned:
    body: Node
    attitude: Quantity
    turn: Quantity

    def matter(self, of: Values, f: Field) -> Matter:
        return _rotate(self.body.matter(of, f), _turned(self.attitude.value, of(self.turn), f))


@dataclass(frozen=True, eq=False)
class Scaled:
    body: Node
    length: Quantity
    mass: Quantity

    def matter(self, of: Values, f: Field) -> Matter:
        m, (s,), (k,) = self.body.matter(of, f), of(self.length), of(self.mass)
        return Matter(k * m.mass, [k * s * x for x in m.first], [k * s * s * x for x in m.second])


@dataclass(frozen=True, eq=False)
class Sum:
    """Parts, and cavities with the sign −1."""

    parts: tuple[Node, ...]
    signs: tuple[int, ...]

    def matter(self, of: Values, f: Field) -> Matter:
        parts = [part.matter(of, f) for part in self.parts]
        pairs = list(zip(self.signs, parts, strict=True))
        return Matter(
            sum(s * p.mass for s, p in pairs),
            [sum(s * p.first[i] for s, p in pairs) for i in range(3)],
            [sum(s * p.second[i] for s, p in pairs) for i in range(6)],
        )


def quantities(node: object) -> Iterator[Quantity]:
    """All quantities of a tree, in its order."""
    if isinstance(node, Quantity):
        yield node
    elif isinstance(node, tuple):
        for one in node:
            yield from quantities(one)
    elif isinstance(node, dict):
        for one in node.values():
            yield from quantities(one)
    elif is_dataclass(node):
        for one in fields(node):
            yield from quantities(getattr(node, one.name))


def displaced(node: Any, z: Callable[[Quantity], Floats], done: dict[int, Any] | None = None) -> Any:
    """The same tree as it is measured: each value off by its factor times z; one object stays one."""
    done = {} if done is None else done
    if id(node) not in done:
        if isinstance(node, Quantity):
            made: Any = node
            if node.factor is not None:
                made = replace(node, value=node.value + node.factor @ z(node))
        elif isinstance(node, tuple):
            made = tuple(displaced(one, z, done) for one in node)
        elif isinstance(node, dict):
            made = {key: displaced(one, z, done) for key, one in node.items()}
        elif hasattr(node, "__dataclass_fields__"):
            values = {one.name: displaced(getattr(node, one.name), z, done) for one in fields(node)}
            made = replace(node, **values)
        else:
            made = node
        done[id(node)] = made
    return done[id(node)]
