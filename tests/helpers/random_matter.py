"""Random matter as an adversary would choose it: flat, thin, huge, tiny, far away, light and heavy."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np

__all__ = ["Cells", "cells", "cloud", "generator", "grid", "shape"]

Rng = np.random.Generator


def generator(source: str, number: int) -> Rng:
    """The generator of one case, by its number alone."""
    return np.random.default_rng([20261122, *source.encode(), number])


def power(rng: Rng, low: float, high: float) -> float:
    """A number whose logarithm is uniform."""
    return float(10.0 ** rng.uniform(low, high))


def shape(rng: Rng, count: int) -> np.ndarray:
    """Points about the origin: a ball of them, or all but a plane, a line or a lattice."""
    points = rng.uniform(-1, 1, (count, 3))
    match rng.integers(8):
        case 0:  # small integers: exactly flat cells among others
            points = rng.integers(-3, 4, (count, 3)).astype(float)
        case 1:  # thin along an axis
            points[:, rng.integers(3)] *= power(rng, -150, 0)
        case 2:  # a needle along an axis
            points[:, rng.permutation(3)[:2]] *= power(rng, -100, 0)
        case 3:  # a plane, thinner than rounding or not, turned
            points[:, 2] *= power(rng, -40, 0)
            points = points @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
        case 4:  # a turned needle
            points[:, 1:] *= power(rng, -30, 0)
            points = points @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
        case 5:  # a plane but for rounding: the last point lies between the others
            if count > 3:
                points[3:] = rng.dirichlet(np.ones(3), count - 3) @ points[:3]
        case 6:  # clusters of very different sizes
            points *= 10.0 ** rng.uniform(-12, 0, (count, 1))
    return points


def placed(rng: Rng, points: np.ndarray, low: float = -90.0, high: float = 90.0) -> np.ndarray:
    """The points at another scale, at times far from the origin."""
    points = points * power(rng, low, high) if rng.integers(2) else points
    if rng.integers(3) == 0:
        size = np.abs(points).max()
        points = points + size * power(rng, 0, 14) * rng.normal(size=3)
    return points


def amounts(rng: Rng, count: int) -> np.ndarray:
    """Densities or masses: some zero, of one size or of many, light or heavy all together."""
    values = rng.uniform(0, 1, count)
    match rng.integers(6):
        case 0:
            values *= rng.integers(0, 2, count)
        case 1:
            values *= 10.0 ** rng.uniform(-20, 20, count)
        case 2:
            values *= power(rng, -200, 200)
    if not values.any():
        values[rng.integers(count)] = 1.0
    return values


class Cells(NamedTuple):
    """Tetrahedra and their densities, as given and at the corners of each cell."""

    nodes: np.ndarray
    cells: np.ndarray
    density: Any
    at: Literal["cells", "nodes"] | None
    corners: np.ndarray


def cells(number: int) -> Cells:
    """One body of up to five cells."""
    rng = generator("cells", number)
    count = int(rng.integers(4, 9))
    nodes = placed(rng, shape(rng, count))
    which = np.array([rng.permutation(count)[:4] for _ in range(rng.integers(1, 6))])
    match rng.integers(3):
        case 0:
            rho = float(amounts(rng, 1)[0])
            return Cells(nodes, which, rho, None, np.full((len(which), 4), rho))
        case 1:
            own = amounts(rng, len(which))
            return Cells(nodes, which, own, "cells", np.repeat(own[:, None], 4, axis=1))
        case _:
            own = amounts(rng, count)
            return Cells(nodes, which, own, "nodes", own[which])


def cloud(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Masses and positions of up to a dozen particles."""
    rng = generator("cloud", number)
    count = int(rng.integers(1, 13))
    return amounts(rng, count), placed(rng, shape(rng, count), -170, 170)


def grid(number: int) -> tuple[np.ndarray, list[float], list[float]]:
    """Densities, spacing and origin of a small grid."""
    rng = generator("grid", number)
    size = tuple(rng.integers(1, 4, 3))
    density = amounts(rng, int(np.prod(size))).reshape(size)
    spacing = rng.uniform(0.5, 2, 3) * power(rng, -90, 90)
    if rng.integers(3) == 0:
        spacing = spacing * 10.0 ** rng.uniform(-60, 0, 3)
    origin = rng.normal(size=3) * spacing.max() * power(rng, -3, 14)
    return density, spacing.tolist(), origin.tolist()
