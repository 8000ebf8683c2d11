"""A body with a constant angular momentum inside (a gyrostat) at any time, from one period of its motion.

L = I ω + h in the body obeys dL/dt = L × ω, and the attitude dq/dt = ½ q ω. Taylor series in fixed point
follow both until L returns, after the period T; the rotation M of that period is the same every time:
q(nT + s) = q(0) Mⁿ U(s), where U is the motion from attitude 1 and M = U(T).

What hardly differs from a steady turning, a nearly spherical body with little inside, is followed relative to
axes that turn at the rate dL in space: q = exp(d L t) V, and V turns at ω − dL.

Nothing here knows an elliptic function, a root of a polynomial or a regime.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import comb
from operator import mul
from typing import Any, NamedTuple, TypeAlias

import mpmath
from mpmath import mp, mpf

from oracles.motion_cases import State
from oracles.rotation import Vector, apply, conjugate, cross, exponential, power, turned
from oracles.rotation import times as product

__all__ = ["Motion", "rises"]

Series: TypeAlias = list[list[int]]
"""Coefficients of L and of the quaternion, seven rows, lowest order first."""


HALVINGS = 60
"""Of a step, in the search for places where it comes back through the plane of the start."""


class Step(NamedTuple):
    """A stretch of the motion: polynomials in (t − start)/length, good for 0..1."""

    start: int
    length: int
    series: Series


class Motion:
    """One motion of a gyrostat.

    Parameters
    ----------
    inertia : (3,) or (3, 3)
        Principal moments or tensor.
    inside : (3,)
        The constant momentum inside, in the body.
    omega, attitude : (3,), (4,)
        The start; the attitude is made a unit quaternion.
    digits : int
        Of every number, absolutely where L or its parts are of order one.
    share : number
        d over the mean of the inverse moments.
    longest : number, optional
        Followed up to this time, and no return is looked for.
    returns : bool
        Whether a return is looked for at all.
    """

    def __init__(
        self,
        inertia: Any,
        inside: Any,
        omega: Any,
        attitude: Any,
        *,
        digits: int = 60,
        share: Any = 1,
        longest: Any = None,
        returns: bool = True,
    ) -> None:
        tensor = _tensor(inertia)
        size = mpmath.frexp(max(abs(x) for row in tensor for x in row))[1]
        rates = [max(map(abs, omega)), mpmath.ldexp(max(map(abs, inside)), -size)]
        self.rate = mpmath.frexp(max(mpf(x) for x in rates))[1] if any(rates) else 0
        self.digits = digits
        with mp.workdps(digits + 30):
            unit = mpmath.ldexp(mpf(1), -size)
            I = mpmath.matrix([[x * unit for x in row] for row in tensor])
            J = (I**-1).tolist()
            steepest = max(abs(x) for row in J for x in row)
            self.noise = 4 + mpmath.frexp(steepest)[1]
            self.bits = int(digits * 3.3219) + 2 * self.noise + 12
            self.order = int(1.4 * (digits + 10))
        self.dps = int(self.bits / 3.3219) + 20
        with mp.workdps(self.dps):
            I = mpmath.matrix([[x * unit for x in row] for row in tensor])
            J = (I**-1).tolist()
            h = [mpmath.ldexp(mpf(x), -size - self.rate) for x in inside]
            w = [mpmath.ldexp(mpf(x), -self.rate) for x in omega]
            L = [x + y for x, y in zip(apply(I.tolist(), w), h, strict=True)]
            drift = mpf(share) * sum(J[i][i] for i in range(3)) / 3
            if steepest > 1000:
                drift = mpf(share)
            q = [mpf(x) for x in attitude]
            self.q0 = [x / mpmath.sqrt(mpmath.fdot(q, q)) for x in q]
            self.turning = [drift * x for x in turned(self.q0, L)]
            """Rate of the axes in space that the motion is followed in."""
            self.J = [[self.fixed(x) for x in row] for row in J]
            self.held = [self.fixed(-x) for x in apply(J, h)]
            self.A = [
                [self.fixed(x - (drift if i == j else 0)) for j, x in enumerate(row)]
                for i, row in enumerate(J)
            ]
            self.first = [*(self.fixed(x) for x in L), 0, 0, 0, 1 << self.bits]
        self.steps: list[Step] = []
        self.period = 0
        self.fastest = 0
        self.steady = max(map(abs, self.slope(self.first))) < 1 << self.bits // 12
        self.cycle: Vector = []
        self.limit = None if longest is None else self.fixed(mpmath.ldexp(mpf(longest), self.rate))
        if returns and not self.steady:
            self._follow()

    def fixed(self, x: Any) -> int:
        """The number in fixed point."""
        return int(mpmath.nint(mpmath.ldexp(x, self.bits)))

    def real(self, x: int) -> Any:
        """The number of one in fixed point."""
        return mpmath.ldexp(mpf(x), -self.bits)

    def rate_of(self, momentum: Sequence[int], matrix: list[list[int]] | None = None) -> list[int]:
        """J (L − h) in fixed point."""
        return [
            (sum(map(mul, row, momentum)) >> self.bits) + b
            for row, b in zip(matrix or self.J, self.held, strict=True)
        ]

    def slope(self, state: Sequence[int]) -> list[int]:
        """dL/dt."""
        return _cross(state[:3], self.rate_of(state[:3]), self.bits)

    def series(self, state: Sequence[int], length: int) -> Series:
        """The polynomials in (t − start)/length of what starts at a state."""
        bits = self.bits
        rows: Series = [[x] for x in state]
        x, y, z, a, b, c, s = rows
        rates: Series = [[w] for w in self.rate_of(state[:3], self.A)]
        back: Series = [[], [], []]
        for k in range(self.order):
            # The rates from the highest order down, so that a convolution is one sum of products.
            for i in range(3):
                back[i] = rates[i][::-1]
            u, v, w = back
            new = (
                _sum(y, w) - _sum(z, v),
                _sum(z, u) - _sum(x, w),
                _sum(x, v) - _sum(y, u),
                (_sum(s, u) + _sum(b, w) - _sum(c, v)) >> 1,
                (_sum(s, v) + _sum(c, u) - _sum(a, w)) >> 1,
                (_sum(s, w) + _sum(a, v) - _sum(b, u)) >> 1,
                -(_sum(a, u) + _sum(b, v) + _sum(c, w)) >> 1,
            )
            for row, value in zip(rows, new, strict=True):
                row.append((((value >> bits) * length) >> bits) // (k + 1))
            last = [x[-1], y[-1], z[-1]]
            for rate, line in zip(rates, self.A, strict=True):
                rate.append(sum(map(mul, line, last)) >> bits)
        return rows

    def run(self, end: int | None) -> Iterator[Step]:
        """Step after step, to the end or for ever."""
        state, start = self.first, 0
        rates = [abs(w) for w in self.rate_of(state[:3], self.A)]
        length = (1 << 2 * self.bits) // (2 * max(*rates, 1)) if max(rates) else 1 << self.bits
        while end is None or start < end:
            while True:
                rows = self.series(state, length)
                fraction = self._fraction(rows, self.noise + max(length.bit_length() - self.bits, 0))
                if fraction >= 0.98:
                    break
                length = int(length * fraction * 0.97)
            step = Step(start, length, rows)
            yield step
            state = _at_one(rows)
            start += length
            length = int(length * min(fraction * 0.92, 2.0))

    def _fraction(self, rows: Series, noise: int) -> float:
        """How much of this length, or how many times it, the polynomials are good for."""
        reach = []
        for k in (self.order, self.order - 1):
            size = max(abs(row[k]) for row in rows)
            reach.append(2.0 ** ((noise - size.bit_length()) / k) if size >> noise else 2.0)
        return min(reach)

    def _follow(self) -> None:
        """Steps over one period, or to the longest time."""
        direction = self.slope(self.first)
        scale = max(map(abs, direction)).bit_length()
        direction = [(x << self.bits) >> scale for x in direction]
        close = 1 << (2 * self.bits) // 5
        for step in self.run(self.limit):
            self.steps.append(step)
            self._note(step)
            if self.limit is not None:
                continue
            beyond = [sum(map(mul, direction, c)) >> self.bits for c in zip(*step.series[:3], strict=True)]
            beyond[0] -= sum(map(mul, direction, self.first[:3])) >> self.bits
            for low, high in rises(beyond, self.bits):
                place = self._crossing(beyond, low, high)
                state = _at(step.series, place, self.bits)
                if max(abs(x - y) for x, y in zip(state[:3], self.first[:3], strict=True)) < close:
                    self.period = step.start + (place * step.length >> self.bits)
                    self.cycle = self._unit(state[3:])
                    return

    def _crossing(self, beyond: Sequence[int], low: int, high: int) -> int:
        """The place between these two at which a polynomial becomes positive."""
        while high - low > 1:
            middle = (low + high) // 2
            if _value(beyond, middle, self.bits) < 0:
                low = middle
            else:
                high = middle
        return high

    def _note(self, step: Step) -> None:
        for s in range(0, 1 << self.bits, 1 << (self.bits - 2)):
            w = self.rate_of(_at(step.series, s, self.bits)[:3])
            self.fastest = max(self.fastest, sum(x * x for x in w))

    def _unit(self, q: Sequence[int]) -> Vector:
        values = [self.real(x) for x in q]
        return [x / mpmath.sqrt(mpmath.fdot(values, values)) for x in values]

    def largest(self) -> Any:
        """Largest |ω| that was met."""
        with mp.workdps(self.dps):
            w = self.rate_of(self.first[:3])
            found = max(self.fastest, sum(x * x for x in w))
            return mpmath.ldexp(mpmath.sqrt(mpmath.ldexp(mpf(found), -2 * self.bits)), self.rate)

    def time(self) -> Any:
        """The period T, zero if none was found."""
        with mp.workdps(self.dps):
            return mpmath.ldexp(self.real(self.period), -self.rate)

    def turn(self) -> Any:
        """The angle by which the body has turned about L after a period, in −π..π."""
        with mp.workdps(self.dps):
            L = [self.real(x) for x in self.first[:3]]
            q = product(
                exponential([self.real(self.period) * x for x in self.turning]), product(self.q0, self.cycle)
            )
            *vector, scalar = product(q, conjugate(self.q0))
            axis = turned(self.q0, L)
            half = mpmath.atan2(mpmath.fdot(vector, axis) / mpmath.norm(axis), scalar)
            return 2 * half - 2 * mpmath.pi * mpmath.nint(half / mpmath.pi)

    def acceleration(self, omega: Sequence[Any]) -> Vector:
        """dω/dt at these rates."""
        with mp.workdps(self.dps):
            w = [mpmath.ldexp(x, -self.rate) for x in omega]
            J = [[self.real(x) for x in row] for row in self.J]
            L = mpmath.lu_solve(
                mpmath.matrix(J), mpmath.matrix([x - self.real(b) for x, b in zip(w, self.held, strict=True)])
            )
            return [mpmath.ldexp(x, 2 * self.rate) for x in apply(J, cross(list(L), w))]

    def at(self, t: Any) -> State:
        """The state at a time."""
        with mp.workdps(self.dps):
            time = self.fixed(mpmath.ldexp(mpf(t), self.rate))
            if self.steady:
                relative = [self.real(x) for x in self.rate_of(self.first[:3], self.A)]
                return self._state(t, self.first[:3], exponential([self.real(time) * x for x in relative]))
            n, rest = divmod(time, self.period) if self.period else (0, time)
            place = max(bisect(self.steps, rest, key=lambda step: step.start) - 1, 0)
            momentum, turn = self._within(self.steps[place], rest)
            return self._state(t, momentum, product(power(self.cycle, n), turn) if n else turn)

    def straight(self, t: Any) -> State:
        """The state at a time, without any return."""
        with mp.workdps(self.dps):
            time = self.fixed(mpmath.ldexp(mpf(t), self.rate))
            last = next(step for step in self.run(time) if step.start + step.length >= time)
            return self._state(t, *self._within(last, time))

    def _within(self, step: Step, time: int) -> tuple[list[int], Vector]:
        state = _at(step.series, ((time - step.start) << self.bits) // step.length, self.bits)
        return state[:3], self._unit(state[3:])

    def _state(self, t: Any, momentum: Sequence[int], turn: Vector) -> State:
        rates = [mpmath.ldexp(self.real(x), self.rate) for x in self.rate_of(momentum)]
        moved = exponential([mpmath.ldexp(mpf(t), self.rate) * x for x in self.turning])
        return State(rates, product(moved, product(self.q0, turn)))


def rises(row: Sequence[int], bits: int) -> Iterator[tuple[int, int]]:
    """Intervals within 0..1 with a place each where a polynomial becomes positive: all of them, in order.

    The polynomial has no more such places than its Bernstein coefficients have changes of sign (Descartes).
    """
    n = len(row) - 1
    part = [(c << 2 * n) // comb(n, k) for k, c in enumerate(row)]
    for k in range(1, n + 1):
        for i in range(n, k - 1, -1):
            part[i] += part[i - 1]
    parts = [(part, 0, 1 << bits)]
    while parts:
        part, low, high = parts.pop()
        changes = sum((a < 0) != (b < 0) for a, b in pairwise(part))
        if changes == 1 or (changes and high - low <= 1 << (bits - HALVINGS)):
            if part[0] < 0 <= part[-1]:
                yield low, high
        elif changes:
            left, right = [part[0]], [part[-1]]
            while len(part) > 1:
                part = [(a + b) >> 1 for a, b in pairwise(part)]
                left.append(part[0])
                right.append(part[-1])
            middle = (low + high) // 2
            parts += [(right[::-1], middle, high), (left, low, middle)]


def _tensor(inertia: Any) -> list[Vector]:
    rows = list(inertia)
    if isinstance(rows[0], list | tuple):
        return [[mpf(x) for x in row] for row in rows]
    return [[mpf(x) if i == j else mpf(0) for j in range(3)] for i, x in enumerate(rows)]


def _sum(a: Sequence[int], b: Sequence[int]) -> int:
    return sum(map(mul, a, b))


def _cross(a: Sequence[int], b: Sequence[int], bits: int) -> list[int]:
    return [
        (a[1] * b[2] - a[2] * b[1]) >> bits,
        (a[2] * b[0] - a[0] * b[2]) >> bits,
        (a[0] * b[1] - a[1] * b[0]) >> bits,
    ]


def _at_one(rows: Series) -> list[int]:
    return [sum(row) for row in rows]


def _at(rows: Series, s: int, bits: int) -> list[int]:
    return [_value(row, s, bits) for row in rows]


def _value(row: Sequence[int], s: int, bits: int) -> int:
    value = 0
    for c in reversed(row):
        value = (value * s >> bits) + c
    return value
