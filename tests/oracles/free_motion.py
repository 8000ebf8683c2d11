"""Rotation of a rigid body in arbitrary precision.

Two independent roads to the same numbers:

`taylor_motion`
    Taylor series of Euler's equations and of the quaternion's, I ω̇ + ω×I ω = N and q̇ = ½ q ω, for
    any tensor and a torque constant in the body or in space. Nothing is diagonalised. Numbers are those
    of :mod:`decimal`, which is written in C: three times as fast here as those of mpmath.
`jacobi_rates`
    Euler's solution for a free body by Jacobi's elliptic functions, in principal axes.

Quaternions are (x, y, z, w) and turn body components into space components.
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal, localcontext
from itertools import pairwise
from operator import mul
from typing import Any

import mpmath
import numpy as np
from mpmath import mp, mpf

__all__ = ["as_floats", "jacobi_rates", "taylor_motion"]

DIGITS = 45
Vector = list[mpf]
State = tuple[Vector, Vector]
Row = list[Decimal]
"""The coefficients of one unknown, or a vector."""


def as_floats(states: Sequence[State]) -> tuple[Any, Any]:
    """Rates (T, 3) and quaternions (T, 4) rounded to float64."""
    omega = np.array([[float(x) for x in w] for w, _ in states])
    return omega, np.array([[float(x) for x in q] for _, q in states])


def taylor_motion(
    inertia: Any,
    omega: Any,
    times: Sequence[Any],
    *,
    attitude: Any = (0, 0, 0, 1),
    body_torque: Any = (0, 0, 0),
    space_torque: Any = (0, 0, 0),
    digits: int = DIGITS,
) -> list[State]:
    """States ``(omega, quaternion)`` at `times`, the first of which is the start.

    Floats are taken at their exact binary value. The attitude is made a unit quaternion first.
    """
    with mp.workdps(digits + 10), localcontext() as context:
        context.prec = digits + 10
        start = [_decimal(x) for x in attitude]
        norm = _dot(start, start).sqrt()
        system = _Euler(inertia, body_torque, space_torque, digits)
        state = [_decimal(x) for x in omega], [x / norm for x in start]
        states = [state]
        for before, after in pairwise(times):
            state = system.advance(state, _decimal(after) - _decimal(before))
            states.append(state)
        return [([mpf(str(x)) for x in w], [mpf(str(x)) for x in q]) for w, q in states]


def _decimal(x: Any) -> Decimal:
    """A float or a number of mpmath, rounded to the precision at hand."""
    exact = mpf(x)
    mantissa, exponent = exact.man_exp  # without the sign
    unit: Decimal = Decimal(2) ** int(exponent)
    return (int(mantissa) * unit).copy_sign(-1 if exact < 0 else 1)


def _dot(a: Row, b: Row) -> Decimal:
    return sum(map(mul, a, b), Decimal(0))


class _Euler:
    """Taylor coefficients of (ω, q), and steps inside their circle of convergence."""

    def __init__(self, inertia: Any, body_torque: Any, space_torque: Any, digits: int) -> None:
        tensor = mpmath.matrix([[mpf(x) for x in row] for row in np.asarray(inertia, float).tolist()])
        self.I = _rows(tensor)
        self.inverse = _rows(tensor**-1)
        self.body_torque = [_decimal(x) for x in body_torque]
        self.space_torque = [_decimal(x) for x in space_torque]
        # With N terms and a step of ρ/e² the rest is e^(-2N): N = digits ln(10)/2 reaches the digits.
        self.order = int(digits * 1.16) + 4

    def advance(self, state: tuple[Row, Row], span: Decimal) -> tuple[Row, Row]:
        while span != 0:
            w, q = self.series(state)
            step = self.step(w + q)
            if step is None or step > abs(span):
                step = abs(span)
            h = step.copy_sign(span)
            state = _horner(w, h), _horner(q, h)
            span = span - h if step < abs(span) else Decimal(0)
        return state

    def step(self, series: list[Row]) -> Decimal | None:
        """A step inside the radius of convergence that the last two coefficients show."""
        radii = []
        for n in (self.order, self.order - 1):
            largest = max(abs(row[n]) for row in series)
            scale = max(abs(row[0]) for row in series)
            if largest > 0:
                radii.append((scale / largest).ln() / n)
        return (min(radii) - 2).exp() if radii else None

    def series(self, state: tuple[Row, Row]) -> tuple[list[Row], list[Row]]:
        """Coefficients of each component: three rows for ω, four for q."""
        w = [[x] for x in state[0]]
        q = [[x] for x in state[1]]
        L: list[Row] = [[], [], []]
        for n in range(self.order):
            newest = [w[0][n], w[1][n], w[2][n]]
            for i in range(3):
                L[i].append(_dot(self.I[i], newest))
            torque = self.torque(q, n)
            rate = [torque[i] - gyroscopic for i, gyroscopic in enumerate(_cross(w, L, n))]
            turn = _product(q, [*w, [Decimal(0)] * (n + 1)], n)
            for i in range(3):
                w[i].append(_dot(self.inverse[i], rate) / (n + 1))
            for i in range(4):
                q[i].append(turn[i] / (2 * (n + 1)))
        return w, q

    def torque(self, q: list[Row], n: int) -> Row:
        """Coefficient n of N = N_body + q* N_space q, for a unit quaternion."""
        total = list(self.body_torque) if n == 0 else [Decimal(0)] * 3
        if any(self.space_torque):
            x, y, z, w = q
            a, b, c = self.space_torque
            turned = [
                [a * w[k] + b * z[k] - c * y[k] for k in range(n + 1)],
                [b * w[k] + c * x[k] - a * z[k] for k in range(n + 1)],
                [c * w[k] + a * y[k] - b * x[k] for k in range(n + 1)],
                [-a * x[k] - b * y[k] - c * z[k] for k in range(n + 1)],
            ]
            conjugate = [[-v for v in x], [-v for v in y], [-v for v in z], w]
            total = [t + s for t, s in zip(total, _product(conjugate, turned, n)[:3], strict=True)]
        return total


def _rows(matrix: Any) -> list[Row]:
    return [[_decimal(matrix[i, j]) for j in range(3)] for i in range(3)]


def _convolve(a: Row, b: Row, n: int) -> Decimal:
    return _dot(a[: n + 1], b[n::-1])


def _cross(a: list[Row], b: list[Row], n: int) -> Row:
    pairs = ((1, 2), (2, 0), (0, 1))
    return [_convolve(a[i], b[j], n) - _convolve(a[j], b[i], n) for i, j in pairs]


def _product(p: list[Row], q: list[Row], n: int) -> Row:
    """Coefficient n of the quaternion product p q."""
    signs = (
        ((0, 3, 1), (1, 2, 1), (2, 1, -1), (3, 0, 1)),
        ((0, 2, -1), (1, 3, 1), (2, 0, 1), (3, 1, 1)),
        ((0, 1, 1), (1, 0, -1), (2, 3, 1), (3, 2, 1)),
        ((0, 0, -1), (1, 1, -1), (2, 2, -1), (3, 3, 1)),
    )
    return [sum((s * _convolve(p[i], q[j], n) for i, j, s in row), Decimal(0)) for row in signs]


def _horner(series: list[Row], h: Decimal) -> Row:
    values = []
    for row in series:
        total = Decimal(0)
        for coefficient in reversed(row):
            total = total * h + coefficient
        values.append(total)
    return values


def jacobi_rates(moments: Any, omega: Any, times: Sequence[Any], digits: int = DIGITS) -> list[Vector]:
    """Rates of a free body about its principal axes, by Jacobi's elliptic functions.

    The moments are distinct and ascending, the motion not on the separatrix. With the axis 3 (short
    axis mode, 2T I₂ < L²) or 1 (long axis mode) circled, ω = (α cn u, β sn u, γ dn u) or
    (γ dn u, β sn u, α cn u), u = p (t − t₀); t₀ follows from the start.
    """
    with mp.workdps(digits + 10):
        I1, I2, I3 = (mpf(x) for x in moments)
        w = [mpf(x) for x in omega]
        L2 = (I1 * w[0]) ** 2 + (I2 * w[1]) ** 2 + (I3 * w[2]) ** 2
        T2 = I1 * w[0] ** 2 + I2 * w[1] ** 2 + I3 * w[2] ** 2
        short_axis = T2 * I2 < L2
        if not short_axis:
            # The same formulas serve with axes 1 and 3 exchanged.
            I1, I3 = I3, I1
            w = [w[2], w[1], w[0]]
        alpha = mpmath.sqrt((T2 * I3 - L2) / (I1 * (I3 - I1)))
        beta = mpmath.sqrt((T2 * I3 - L2) / (I2 * (I3 - I2)))
        gamma = mpmath.sqrt((L2 - T2 * I1) / (I3 * (I3 - I1)))
        p = mpmath.sqrt(abs((L2 - T2 * I1) * (I3 - I2) / (I1 * I2 * I3)))
        m = (T2 * I3 - L2) * (I2 - I1) / ((L2 - T2 * I1) * (I3 - I2))
        # I₂ ω̇₂ = (I₃ − I₁) ω₃ ω₁, even in the exchange, fixes the sense in which the angle runs.
        gamma *= mpmath.sign(w[2])
        sense = mpmath.sign(w[2])
        u0 = mpmath.ellipf(mpmath.atan2(w[1] / beta, w[0] / alpha), m)
        rates = []
        for t in times:
            u = u0 + sense * p * (mpf(t) - mpf(times[0]))
            row = [
                alpha * mpmath.ellipfun("cn", u, m=m),
                beta * mpmath.ellipfun("sn", u, m=m),
                gamma * mpmath.ellipfun("dn", u, m=m),
            ]
            rates.append(row if short_axis else row[::-1])
        return rates
