"""Taylor series of ordinary differential equations in fixed point, to any number of digits.

A number is an integer that counts units of 2^-bits. Python's integers make the Cauchy products of
long series an order of magnitude faster than objects with an exponent each, without any dependency. What is
integrated must therefore be of order one: who calls scales first, by powers of two.

Coefficients carry the step: row[n] is x⁽ⁿ⁾ hⁿ/n!, so that they fall like e⁻²ⁿ however fast the motion.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from operator import mul
from typing import Any, NamedTuple, TypeAlias

import mpmath
from mpmath import mp, mpf

__all__ = ["Row", "State", "Step", "System", "convolve", "steps"]

Row: TypeAlias = list[int]
"""The coefficients of one unknown."""
State: TypeAlias = list[int]


def convolve(a: Row, b: Row, n: int) -> int:
    """Coefficient n of a product of series, in units of 2^(-2 bits)."""
    return sum(map(mul, a[: n + 1], b[n::-1]))


class System(ABC):
    """A first-order system whose right-hand side is built of sums, products and powers of its unknowns.

    Parameters
    ----------
    digits : int
        Correct decimal digits asked for, of unknowns of order one.
    """

    def __init__(self, digits: int) -> None:
        self.digits = digits
        self.bits = math.ceil(digits * math.log2(10)) + 48
        # With N terms and a step of ρ/e² the rest is e^(-2N).
        self.order = math.ceil(digits * math.log(10) / 2) + 6

    @abstractmethod
    def rates(self, rows: list[Row], n: int) -> list[int]:
        """Coefficient n of the time derivatives, from the coefficients 0…n of the unknowns.

        It is called with n = 0, 1, 2… in turn; n = 0 begins a new series.
        """

    def fixed(self, x: Any) -> int:
        """The nearest integer to x 2^bits."""
        with mp.workprec(self.bits + 200):
            return int(mpmath.nint(mpmath.ldexp(mpf(x), self.bits)))

    def real(self, x: int) -> mpf:
        """The number for which the integer stands, at the working precision of mpmath."""
        return mpmath.ldexp(mpf(x), -self.bits)

    def product(self, a: Row, b: Row, n: int) -> int:
        """Coefficient n of a product of two series."""
        return convolve(a, b, n) >> self.bits

    def scaled(self, factor: int, x: int) -> int:
        """Product of two fixed numbers."""
        return factor * x >> self.bits


class Step(NamedTuple):
    """A polynomial that is valid from its start over a fraction `reach` of its unit of time `h`."""

    system: System
    rows: list[Row]
    start: int
    h: int
    reach: int

    @property
    def end(self) -> int:
        """Time at which the next step begins."""
        return self.start + self.system.scaled(self.h, self.reach)

    def at(self, time: int) -> State:
        """The unknowns at a time between start and end."""
        return self.at_fraction(((time - self.start) << self.system.bits) // self.h)

    def at_fraction(self, sigma: int) -> State:
        """The unknowns at start + sigma h."""
        bits = self.system.bits
        values = []
        for row in self.rows:
            total = 0
            for coefficient in reversed(row):
                total = (total * sigma >> bits) + coefficient
            values.append(total)
        return values

    def root(self, function: Callable[[State], int], low: int, high: int) -> int:
        """The fraction, between two, at which a function of the state has its root."""
        bits = self.system.bits
        while high - low > 1 << (bits - 40):  # 12 digits by bisection, the rest by chords
            middle = (low + high) // 2
            if (function(self.at_fraction(middle)) < 0) == (function(self.at_fraction(low)) < 0):
                low = middle
            else:
                high = middle
        sigma, width = low, 1 << (bits - 40)
        slope = function(self.at_fraction(low + width)) - function(self.at_fraction(low))
        # A chord of width 1e-12 gains twelve digits each time.
        for _ in range(bits // 36 + 2):
            sigma -= function(self.at_fraction(sigma)) * width // slope
        return sigma


def steps(system: System, state: State, end: int, start: int = 0) -> Iterator[Step]:
    """Steps of a solution from `start` until one of them contains `end`."""
    one = 1 << system.bits
    h = one >> 4
    time = start
    while time < end:
        rows = [[x] for x in state]
        for n in range(system.order):
            for row, rate in zip(rows, system.rates(rows, n), strict=True):
                row.append((rate * h >> system.bits) // (n + 1))
        factor = _stretch(system, rows)
        step = Step(system, rows, time, h, one if factor >= 1 else max(int(factor * 2**53) * one >> 53, 1))
        yield step
        state, time = step.at_fraction(step.reach), step.end
        h = max(h * int(min(factor, 16.0) * 2**53) >> 53, 1)


def _stretch(system: System, rows: list[Row]) -> float:
    """Safe step over the unit of time, from the radius of convergence that the last two coefficients show."""
    exponents = []
    for n in (system.order, system.order - 1):
        largest = max(abs(row[n]) for row in rows)
        if largest:
            exponents.append((system.bits - math.log2(largest)) / n)
    return math.exp(min(exponents) * math.log(2) - 2) if exponents else 1e9
