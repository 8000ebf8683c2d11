"""Random trees of uncertain numbers over every source: ordinary sizes, sigmas up to 1 % of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from oracles.matter_models import (
    Given,
    Mesh,
    Moved,
    Node,
    Particles,
    Principal,
    Quantity,
    Scaled,
    Solid,
    Sum,
    Tensor,
    Turned,
)
from oracles.textbook_shapes import SHAPES

Floats: TypeAlias = NDArray[np.float64]
Rng: TypeAlias = np.random.Generator

__all__ = ["KINDS", "case"]


def relative(rng: Rng) -> float:
    """A sigma relative to the size: 1e-5 to 1e-2, each decade as likely."""
    return float(10 ** rng.uniform(-5, -2))


def certain(value: Any) -> Quantity:
    array = np.asarray(value, dtype=float)
    return Quantity(array.ravel(), None, array.shape)


def uncertain(rng: Rng, value: Any, size: float, share: float | None = None) -> Quantity:
    """Independent components with sigmas of some share of the size: one for all, or one each."""
    array = np.asarray(value, dtype=float)
    sigma = size * (relative(rng) if share is None else share) * np.ones(array.size)
    if rng.random() < 0.5:
        sigma *= rng.uniform(0.2, 1.0, array.size)
    return Quantity(array.ravel(), np.diag(sigma), array.shape)


def correlated(rng: Rng, value: Any, size: float, rank: int | None = None) -> Quantity:
    """A covariance that is full, or of lower rank."""
    array = np.asarray(value, dtype=float)
    k = rank or array.size
    factor = rng.standard_normal((array.size, k)) / np.sqrt(k)
    return Quantity(array.ravel(), size * relative(rng) * factor, array.shape)


def some(rng: Rng, value: Any, size: float) -> Quantity:
    """Any of the above."""
    kind = rng.choice(4, p=[0.15, 0.55, 0.2, 0.1])
    if kind == 0:
        return certain(value)
    if kind == 1 or np.size(value) == 1:
        return uncertain(rng, value, size)
    return correlated(rng, value, size, None if kind == 2 else 1)


def attitude(rng: Rng) -> Floats:
    q = rng.standard_normal(4)
    unit: Floats = q / np.linalg.norm(q)
    return unit


def matter(rng: Rng) -> tuple[float, float, Floats, Floats]:
    """Mass, length, centre and tensor of a body whose moments differ or not, but which exists."""
    mass, length = float(rng.uniform(0.5, 20)), float(10 ** rng.uniform(-1, 1))
    second = mass * length**2 * rng.uniform(0.1, 1, 3)
    moments = second.sum() - second
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    axes = q * np.sign(np.diag(r))
    tensor = (axes * moments) @ axes.T
    return mass, length, length * rng.uniform(-2, 2, 3), (tensor + tensor.T) / 2


def _six(tensor: Floats) -> Floats:
    return np.array([tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]])


def tensor(rng: Rng) -> Node:
    mass, length, center, inertia = matter(rng)
    about_origin = bool(rng.random() < 0.5)
    if about_origin:
        inertia = inertia + mass * (center @ center * np.eye(3) - np.outer(center, center))
    size = float(np.abs(inertia).max())
    return Tensor(
        some(rng, mass, mass), some(rng, center, length), some(rng, _six(inertia), size), about_origin
    )


def given(rng: Rng) -> Node:
    mass, length, center, inertia = matter(rng)
    sizes = np.array([mass, *[length] * 3, *[np.abs(inertia).max()] * 6])
    factor = sizes[:, None] * rng.standard_normal((10, 10)) / np.sqrt(10) * relative(rng)
    if rng.random() < 0.5:
        factor = np.diag(sizes * relative(rng) * rng.uniform(0.1, 1, 10))
    return Given(Quantity(np.array([mass, *center, *_six(inertia)]), factor, (10,)))


def principal(rng: Rng) -> Node:
    mass, length, center, _ = matter(rng)
    second = mass * length**2 * rng.uniform(0.1, 1, 3)
    moments = np.sort(second.sum() - second)
    return Principal(
        some(rng, mass, mass),
        some(rng, moments, moments[2]),
        certain(attitude(rng)),
        certain(np.zeros(3)) if rng.random() < 0.4 else uncertain(rng, np.zeros(3), 1.0),
        some(rng, center, length),
    )


def particles(rng: Rng) -> Node:
    n, length = int(rng.integers(4, 9)), float(10 ** rng.uniform(-1, 1))
    masses, positions = rng.uniform(0.2, 2, n), length * rng.uniform(-1, 1, (n, 3))
    where = some(rng, positions, length)
    if rng.random() < 0.3:  # one rigid shift of all
        where = Quantity(positions.ravel(), length * relative(rng) * np.tile(np.eye(3), (n, 1)), (n, 3))
    return Particles(uncertain(rng, masses, 1.0), where)


def _polygon(rng: Rng, n: int) -> Floats:
    angle = np.sort((np.arange(n) + rng.uniform(0.1, 0.6, n)) * 2 * np.pi / n)
    radius = rng.uniform(0.5, 1.5, n)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def shape(rng: Rng, name: str) -> Solid:
    """A solid, lamina or rod with an uncertain amount and lengths, some of them certain."""
    size = float(10 ** rng.uniform(-1, 1))
    lengths: dict[str, Quantity | int] = {}
    smallest = 0.0
    for argument in SHAPES[name][1]:
        word, _, form = argument.partition(":")
        if word == "sides":
            lengths[word] = int(rng.integers(3, 8))
        elif word == "vertices":
            corners = size * _polygon(rng, int(form[0])) + size * rng.uniform(-1, 1, 2)
            lengths[word] = uncertain(rng, corners, size)
        elif word == "angle":
            lengths[word] = some(rng, rng.uniform(1, 5), 1.0)
        elif form:
            lengths[word] = some(rng, size * rng.uniform(0.4, 1.2, int(form)), size * 0.4)
        else:  # an outer radius beyond the inner one, a major one beyond the minor
            value = size * rng.uniform(0.4, 0.9) + smallest
            smallest = value if word == "inner_radius" else 0.0
            value *= 2.5 if word == "major_radius" else 1.0
            lengths[word] = some(rng, value, size * 0.4)
    amount = float(rng.uniform(0.5, 10))
    return Solid(name, lengths, uncertain(rng, amount, amount), bool(rng.random() < 0.5))


def any_shape(rng: Rng) -> Solid:
    return shape(rng, str(rng.choice(sorted(SHAPES))))


def _icosahedron() -> tuple[Floats, NDArray[np.int64]]:
    g = (1 + 5**0.5) / 2
    rows = [(s, t * g, 0.0) for s in (-1, 1) for t in (-1, 1)]
    points = np.array([np.roll(r, k) for r in rows for k in range(3)])
    faces = []
    for i in range(12):
        for j in range(i + 1, 12):
            for k in range(j + 1, 12):
                a, b, c = points[[i, j, k]]
                if max(np.linalg.norm(a - b), np.linalg.norm(b - c), np.linalg.norm(c - a)) < 2.1:
                    faces.append((i, j, k) if np.linalg.det(points[[i, j, k]]) > 0 else (i, k, j))
    return points, np.array(faces)


def mesh(rng: Rng) -> Node:
    points, faces = _icosahedron()
    length = float(10 ** rng.uniform(-1, 1))
    points = length * (points * rng.uniform(0.4, 1.0, 3) + rng.uniform(-0.05, 0.05, points.shape))
    points = points + length * rng.uniform(-2, 2, 3)
    amount = float(rng.uniform(0.5, 10))
    by_density = bool(rng.random() < 0.5)
    return Mesh(uncertain(rng, points, length), faces, uncertain(rng, amount, amount), by_density)


def placed(rng: Rng, body: Node | None = None) -> Node:
    """A body turned, scaled and moved, in any order and with sigmas of each."""
    body = any_shape(rng) if body is None else body
    for step in rng.permutation(3):
        if step == 0:
            body = Moved(body, some(rng, rng.uniform(-1, 1, 3), 1.0))
        elif step == 1:
            body = Turned(body, certain(attitude(rng)), some(rng, np.zeros(3), 1.0))
        else:
            body = Scaled(body, some(rng, rng.uniform(0.5, 2), 1.0), some(rng, rng.uniform(0.5, 2), 1.0))
    return body


def composite(rng: Rng) -> Node:
    """Parts of all kinds; some bodies twice, at two places."""
    makers = [placed, placed, tensor, particles, principal, given]
    parts = [makers[int(rng.integers(len(makers)))](rng) for _ in range(int(rng.integers(2, 5)))]
    if rng.random() < 0.5:
        parts.append(Moved(parts[0], some(rng, rng.uniform(-1, 1, 3), 1.0)))
    return Sum(tuple(parts), (1,) * len(parts))


def cavity(rng: Rng) -> Node:
    """A block with a bore of its own material: one density for both."""
    density = uncertain(rng, rng.uniform(1, 5), 1.0)
    sides = rng.uniform(2, 4, 3)
    block = Solid("box", {"size": uncertain(rng, sides, 1.0)}, density, True)
    radius, height = uncertain(rng, rng.uniform(0.3, 0.8), 1.0), uncertain(rng, rng.uniform(0.5, 1.5), 1.0)
    bore = Solid("cylinder", {"radius": radius, "height": height}, density, True)
    turned = Turned(bore, certain(attitude(rng)), uncertain(rng, np.zeros(3), 1.0))
    return Sum((block, Moved(turned, uncertain(rng, rng.uniform(-0.3, 0.3, 3), 1.0))), (1, -1))


def named(rng: Rng) -> Node:
    """Two bodies whose densities, or lengths, come from one drawing."""
    sigma = relative(rng)
    words = [Quantity(np.array([v]), np.array([[v * sigma]]), (), "drawing") for v in rng.uniform(0.5, 2, 2)]
    size = certain(rng.uniform(0.5, 2, 3))
    left = Solid("box", {"size": size}, words[0], True)
    right = Solid("cylinder", {"radius": words[1], "height": certain(1.5)}, certain(2.0), False)
    return Sum((left, Moved(right, some(rng, rng.uniform(-1, 1, 3), 1.0))), (1, 1))


def placed_shape(rng: Rng, name: str) -> Node:
    return placed(rng, shape(rng, name))


KINDS: dict[str, Callable[[Rng], Node]] = {
    "tensor": tensor,
    "given": given,
    "principal": principal,
    "particles": particles,
    "mesh": mesh,
    "placed": placed,
    "composite": composite,
    "cavity": cavity,
    "named": named,
    **{name: partial(placed_shape, name=name) for name in SHAPES},
}
"""What a random case may be: every source, and every shape placed anyhow."""


def case(kind: str, seed: int) -> Node:
    """The case of this kind and seed."""
    return KINDS[kind](np.random.default_rng([seed, *kind.encode()]))
