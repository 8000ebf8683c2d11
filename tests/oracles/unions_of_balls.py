"""Moments of unions of balls by slices: disks in closed form, the third direction by quadrature."""

from __future__ import annotations

import itertools
from typing import Any

import mpmath as mp
import numpy as np

__all__ = ["sampled_union", "union_by_slices"]

_INTEGRALS: dict[Any, Any] = {  # of the angle t, its cosine and its sine
    (0, 0): lambda t, *_: t,
    (1, 0): lambda *of: of[2],
    (0, 1): lambda *of: -of[1],
    (2, 0): lambda t, c, s: (t + s * c) / 2,
    (0, 2): lambda t, c, s: (t - s * c) / 2,
    (1, 1): lambda *of: of[2] ** 2 / 2,
    (3, 0): lambda *of: of[2] - of[2] ** 3 / 3,
    (0, 3): lambda *of: -of[1] + of[1] ** 3 / 3,
    (2, 1): lambda *of: -(of[1] ** 3) / 3,
    (1, 2): lambda *of: of[2] ** 3 / 3,
}
"""Antiderivatives of cᵐ sⁿ by the angle."""
_MONOMIALS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def _times(a: Any, b: Any) -> Any:
    product: dict[Any, Any] = {}
    for ((i, j), x), ((k, m), y) in itertools.product(a.items(), b.items()):
        product[i + k, j + m] = product.get((i + k, j + m), 0) + x * y
    return product


def _disks(disks: Any) -> Any:
    """Integrals of 1, y, z, y², y z, z² over the union of disks (y, z, r): ∫ f dA = ∮ f (p·n) ds/(k + 2)."""
    sums = [mp.mpf(0)] * 6
    for i, (y, z, r) in enumerate(disks):
        covered: list[tuple[Any, Any]] | None = []
        for k, (v, w, q) in enumerate(disks):
            if k == i:
                continue
            d = mp.hypot(v - y, w - z)
            if d >= r + q or (d <= r - q and (d, r) != (0, q)):
                continue
            if d <= q - r:
                if (d, r) != (0, q) or k < i:
                    covered = None
                    break
                continue
            middle = mp.atan2(w - z, v - y)
            half = mp.acos((d * d + r * r - q * q) / (2 * d * r))
            start = (middle - half) % (2 * mp.pi)
            assert covered is not None
            covered.append((start, start + 2 * half))
        if covered is None:
            continue
        pieces = [(a, min(b, 2 * mp.pi)) for a, b in covered]
        pieces += [(mp.mpf(0), b - 2 * mp.pi) for a, b in covered if b > 2 * mp.pi]
        at, free = mp.mpf(0), []
        for a, b in sorted(pieces):
            if a > at:
                free.append((at, a))
            at = max(at, b)
        if at < 2 * mp.pi:
            free.append((at, 2 * mp.pi))
        of_y, of_z = {(0, 0): y, (1, 0): r}, {(0, 0): z, (0, 1): r}
        normal = {(0, 0): r * r, (1, 0): y * r, (0, 1): z * r}
        table: dict[Any, Any] = {}
        for a, b in free:
            ends = [(t, mp.cos(t), mp.sin(t)) for t in (a, b)]
            for key, integral in _INTEGRALS.items():
                table[key] = table.get(key, 0) + integral(*ends[1]) - integral(*ends[0])
        for n, (j, k) in enumerate(_MONOMIALS):
            product = normal
            for factor in [of_y] * j + [of_z] * k:
                product = _times(product, factor)
            sums[n] += sum(x * table.get(key, 0) for key, x in product.items()) / (j + k + 2)
    return sums


def _kinks(balls: Any) -> Any:
    """Where slices change their kind: ends of spheres and of their circles, points of three spheres."""
    found = []
    for (x, _, _), r in balls:
        found += [x - r, x + r]
    for (a, r), (b, q) in itertools.combinations(balls, 2):
        way = [v - u for u, v in zip(a, b, strict=True)]
        d = mp.sqrt(sum(w * w for w in way))
        if d == 0 or d >= r + q or d <= abs(r - q):
            continue
        h = (d * d + r * r - q * q) / (2 * d)
        reach = mp.sqrt(max(r * r - h * h, 0)) * mp.sqrt(max(1 - (way[0] / d) ** 2, 0))
        found += [a[0] + h * way[0] / d - reach, a[0] + h * way[0] / d + reach]
    for (a, r), (b, q), (c, p) in itertools.combinations(balls, 3):
        one, two = (mp.matrix([v - u for u, v in zip(a, other, strict=True)]) for other in (b, c))
        sides = [(_dot(w, w) + r * r - s * s) / 2 for w, s in ((one, q), (two, p))]
        cross = mp.matrix(
            [
                one[1] * two[2] - one[2] * two[1],
                one[2] * two[0] - one[0] * two[2],
                one[0] * two[1] - one[1] * two[0],
            ]
        )
        if _dot(cross, cross) < mp.mpf(10) ** -25:
            continue
        system = mp.matrix([list(one), list(two), list(cross)])
        foot = mp.lu_solve(system, mp.matrix([*sides, 0]))
        rest = r * r - _dot(foot, foot)
        if rest > 0:
            step = mp.sqrt(rest / _dot(cross, cross)) * cross[0]
            found += [a[0] + foot[0] - step, a[0] + foot[0] + step]
    return sorted(found)


def _dot(a: Any, b: Any) -> Any:
    return sum(u * v for u, v in zip(a, b, strict=True))


def union_by_slices(centers: Any, radii: Any, nodes: Any = 48, digits: Any = 40) -> Any:
    """Volume, first moments (3) and second moments (xx, yy, zz, xy, xz, yz) of a union of balls."""
    with mp.workdps(digits):
        balls = [
            ([mp.mpf(float(x)) for x in c], mp.mpf(float(r))) for c, r in zip(centers, radii, strict=True)
        ]
        kinks = _kinks(balls)
        rule = _rule(nodes, digits)
        sums = [mp.mpf(0)] * 10
        for a, b in itertools.pairwise(kinks):
            if b - a < mp.mpf(10) ** (4 - digits):
                continue
            for t, weight in rule:  # x = a + (b − a) sin²: roots at the ends become analytic
                sine, cosine = mp.sin(mp.pi * t / 2), mp.cos(mp.pi * t / 2)
                x = a + (b - a) * sine**2
                w = weight * (b - a) * mp.pi * sine * cosine
                disks = [
                    (c[1], c[2], mp.sqrt(r * r - (x - c[0]) ** 2)) for c, r in balls if abs(x - c[0]) < r
                ]
                area, y, z, yy, yz, zz = _disks(disks)
                for n, value in enumerate((area, x * area, y, z, x * x * area, yy, zz, x * y, x * z, yz)):
                    sums[n] += w * value
        return sums


_RULES: dict[Any, Any] = {}


def _rule(n: Any, digits: Any) -> Any:
    """Nodes and weights of Gauss and Legendre on (0, 1)."""
    if (n, digits) not in _RULES:
        rule = []
        for guess in np.polynomial.legendre.leggauss(n)[0]:
            x = mp.mpf(guess)
            for _ in range(4):
                p, last = x, mp.mpf(1)
                for k in range(2, n + 1):
                    p, last = ((2 * k - 1) * x * p - (k - 1) * last) / k, p
                slope = n * (x * p - last) / (x * x - 1)
                x -= p / slope
            rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope**2)))
        _RULES[n, digits] = rule
    return _RULES[n, digits]


def sampled_union(centers: Any, radii: Any, n: Any, rng: Any) -> Any:
    """Volume and first moments by Monte Carlo, with their standard errors.

    What no sample saw, such as a small overlap, may have a probability of 1/n.
    """
    volumes = 4 / 3 * np.pi * radii**3
    total = volumes.sum()
    ball = rng.choice(len(radii), size=n, p=volumes / total)
    way = rng.normal(size=(n, 3))
    way *= (radii[ball] * rng.random(n) ** (1 / 3) / np.linalg.norm(way, axis=1))[:, None]
    points = centers[ball] + way
    inside = ((points[:, None] - centers) ** 2).sum(axis=2) <= radii**2 * (1 + 1e-12)
    weights = total / np.maximum(inside.sum(axis=1), 1)
    samples = weights[:, None] * np.column_stack([np.ones(n), points])
    return samples.mean(axis=0), np.hypot(samples.std(axis=0) / np.sqrt(n), np.abs(samples).max(axis=0) / n)
