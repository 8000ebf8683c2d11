"""Steady rotations of gyrostats from the roots of a polynomial, to 120 digits.

``python -m oracles.gyrostat_equilibria`` in the folder ``tests`` writes the table that the core's test reads:
a line ``case I₁ I₂ I₃ h₁ h₂ h₃ |L|``, then one line for each equilibrium, ascending in ω·L, and for each |L|
at which their number changes. Components in principal axes; inputs are exact.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import mpmath
from mpmath import mp, mpf

from oracles.polynomials import roots

__all__ = ["cases", "equilibria", "folds"]

TABLE = Path(__file__).parents[2] / "rust/core/src/motion/gyrostat/equilibria/polynomial.txt"
DIGITS = 120


def cases() -> Iterator[tuple[Sequence[float], Sequence[float], float]]:
    """Moments, h and |L|."""
    draw = random.Random(20261123)

    def drawn() -> tuple[list[float], list[float]]:
        a, b, c = (draw.uniform(0.05, 1.0) for _ in range(3))
        return sorted((b + c, a + c, a + b)), [draw.gauss(0, 1) for _ in range(3)]

    for k in range(60):
        moments, h = drawn()
        yield moments, h, 10 ** draw.uniform(-1, 3.5) if k % 2 else 10 ** draw.uniform(0, 1.5)
    for k in range(24):
        # In principal planes and along axes.
        moments, h = drawn()
        h = [0.0 if (k >> i) % 2 else x for i, x in enumerate(h)]
        yield moments, h, 10 ** draw.uniform(0, 2)
    for _ in range(16):
        # Components of very different size.
        moments, h = drawn()
        h = [x * 10 ** draw.uniform(-40, 0) for x in h]
        yield moments, h, 10 ** draw.uniform(0, 1)
    for k in range(16):
        # Moments close together, and thin bodies.
        _, h = drawn()
        gap = 10.0 ** -(k // 2 + 1)
        moments = [1.0, 1.0 + gap, 1.0 + 2.5 * gap] if k % 2 else [gap, 1.0, 1.0 + 0.75 * gap]
        yield moments, [x * gap for x in h], 10 ** draw.uniform(-1, 2)
    for k in range(40):
        # Close to where two of them meet.
        moments, h = drawn()
        near = folds(moments, h)[k % 2]
        gap = 10.0 ** -(1 + k % 13)
        yield moments, h, float(near * (1 + (gap if k % 4 < 2 else -gap)))


def equilibria(
    moments: Sequence[float], h: Sequence[float], momentum: float
) -> list[tuple[Any, list[Any], Any, Any]]:
    """μ, L/|L|, ½ ω·I ω and D L² of each."""
    with mp.workdps(DIGITS):
        I = [mpf(x) for x in moments]
        e = [mpf(x) / momentum for x in h]
        found = []
        live = [i for i in range(3) if e[i]]
        if live:
            polynomial = _product([_square(I[i]) for i in live])
            for i in live:
                rest = _product([_square(I[j]) for j in live if j != i])
                polynomial = _plus(polynomial, [-(e[i] ** 2) * c for c in rest])
            for mu in _real_roots(polynomial):
                n = [e[i] / (1 - mu * I[i]) for i in range(3)]
                found.append((mu, n))
        for i in range(3):
            if e[i]:
                continue
            n = [mpf(0) if j == i or not e[j] else e[j] / (1 - I[j] / I[i]) for j in range(3)]
            left = 1 - sum(x * x for x in n)
            if left > 0:
                for sign in (1, -1):
                    m = list(n)
                    m[i] = sign * mpmath.sqrt(left)
                    found.append((1 / I[i], m))
        found.sort(key=lambda pair: pair[0])
        L = mpf(momentum)
        return [
            (
                mu,
                n,
                (mu * L) ** 2 * sum(a * x * x for a, x in zip(I, n, strict=True)) / 2,
                _determinant(I, mu, n) * L * L,
            )
            for mu, n in found
        ]


def folds(moments: Sequence[float], h: Sequence[float]) -> list[Any]:
    """The |L| at which f has a minimum between two poles."""
    with mp.workdps(DIGITS):
        I = [mpf(x) for x in moments]
        live = [i for i in range(3) if h[i]]
        if len(live) < 2:
            return []
        polynomial = [mpf(0)]
        for i in live:
            rest = _product([_cube(I[j]) for j in live if j != i])
            polynomial = _plus(polynomial, [mpf(h[i]) ** 2 * I[i] * c for c in rest])
        poles = [1 / I[i] for i in live]
        between = [mu for mu in _real_roots(polynomial) if min(poles) < mu < max(poles)]
        return sorted(mpmath.sqrt(sum((mpf(h[i]) / (1 - mu * I[i])) ** 2 for i in live)) for mu in between)


def _real_roots(polynomial: Sequence[Any]) -> list[Any]:
    """Of a polynomial, its lowest coefficient first."""
    size = max(map(abs, polynomial))
    falling = [c / size for c in reversed(polynomial)]
    while abs(falling[0]) < mpf(10) ** (10 - DIGITS):
        del falling[0]
    found = roots(falling, maxsteps=2000, extraprec=2000)
    return [mpmath.re(root) for root in found if abs(mpmath.im(root)) < mpf(10) ** -40 * abs(root)]


def _determinant(I: Sequence[Any], mu: Any, n: Sequence[Any]) -> Any:
    """Of I⁻¹ − μ across n: the product of both eigenvalues, from a basis of the plane."""
    least = min(range(3), key=lambda i: abs(n[i]))
    a = mpmath.matrix([mpf(i == least) for i in range(3)])
    m = mpmath.matrix(n)
    a -= m * (m.T * a)[0]
    a /= mpmath.norm(a)
    b = mpmath.matrix([m[1] * a[2] - m[2] * a[1], m[2] * a[0] - m[0] * a[2], m[0] * a[1] - m[1] * a[0]])
    H = mpmath.diag([1 / x - mu for x in I])
    form = [[(x.T * H * y)[0] for y in (a, b)] for x in (a, b)]
    return form[0][0] * form[1][1] - form[0][1] * form[1][0]


def _square(x: Any) -> list[Any]:
    return [mpf(1), -2 * x, x * x]


def _cube(x: Any) -> list[Any]:
    return [mpf(1), -3 * x, 3 * x * x, -(x**3)]


def _product(factors: Sequence[Sequence[Any]]) -> list[Any]:
    made = [mpf(1)]
    for factor in factors:
        longer = [mpf(0)] * (len(made) + len(factor) - 1)
        for i, a in enumerate(made):
            for j, b in enumerate(factor):
                longer[i + j] += a * b
        made = longer
    return made


def _plus(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    length = max(len(a), len(b))
    return [(a[i] if i < len(a) else 0) + (b[i] if i < len(b) else 0) for i in range(length)]


def main() -> None:
    """Write the table."""
    lines = []
    for moments, h, momentum in cases():
        lines.append(" ".join(["case", *map(repr, map(float, (*moments, *h, momentum)))]))
        for mu, n, energy, squared in equilibria(moments, h, momentum):
            lines.append(" ".join(["at", *(mpmath.nstr(x, 20) for x in (mu, *n, energy, squared))]))
        lines += [f"fold {mpmath.nstr(x, 20)}" for x in folds(moments, h)]
    TABLE.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
