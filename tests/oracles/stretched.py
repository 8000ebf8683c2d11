"""Molecules whose bonds are stretched, by NumPy alone."""

from __future__ import annotations

from typing import Any

import numpy as np

WATER = np.array([(0.0, 0.0, 0.0), (0.757, 0.0, 0.587), (-0.757, 0.0, 0.587)])


def tree(rng: np.random.Generator, count: int) -> tuple[Any, list[tuple[int, int]]]:
    """Atoms that hang on earlier ones at random, a bond each, in random order and direction."""
    places, pairs = [np.zeros(3)], []
    for atom in range(1, count):
        on = int(rng.integers(atom))
        along = rng.normal(size=3)
        places.append(places[on] + rng.uniform(0.9, 1.6) * along / np.linalg.norm(along))
        pairs.append((on, atom) if rng.integers(2) else (atom, on))
    order = rng.permutation(len(pairs))
    return np.array(places), [pairs[k] for k in order]


def built(places: Any, pairs: list[tuple[int, int]], lengths: Any) -> Any:
    """Positions of other lengths of the bonds, built outward from atom 0, shape (..., n, 3)."""
    out = np.zeros((*lengths.shape[:-1], *places.shape))
    out[..., 0, :] = places[0]
    known, rest = {0}, list(range(len(pairs)))
    while rest:
        for k in list(rest):
            ends = pairs[k] if pairs[k][0] in known else pairs[k][::-1]
            if ends[0] in known:
                along = places[ends[1]] - places[ends[0]]
                along /= np.linalg.norm(along)
                out[..., ends[1], :] = out[..., ends[0], :] + lengths[..., k, None] * along
                known.add(ends[1])
                rest.remove(k)
    return out


def tensor(masses: Any, places: Any) -> Any:
    """Tensors about the centre of mass, shape (..., 3, 3)."""
    m = np.broadcast_to(masses, places.shape[:-1])
    center = (m[..., None] * places).sum(axis=-2) / m.sum(axis=-1)[..., None]
    d = places - center[..., None, :]
    spread = np.einsum("...n,...ni,...nj->...ij", m, d, d)
    return np.trace(spread, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - spread


def lengths_of(places: Any, pairs: list[tuple[int, int]]) -> Any:
    """Lengths of the bonds, in their order."""
    return np.array([np.linalg.norm(places[j] - places[i]) for i, j in pairs])
