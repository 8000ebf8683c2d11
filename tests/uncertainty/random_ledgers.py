"""Random trees of parts, and their sums and covariances by other ways than the package's."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from polhode.uncertainty import Ledger

__all__ = [
    "ELEMENTS", "NUMBERS", "SIGMAS", "assert_close", "by_complex_steps", "combined", "covariances",
    "leaf_draws", "random_tree", "sigmas", "ten", "values",
]  # fmt: skip

NUMBERS = ("mass", "Cx", "Cy", "Cz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
SIGMAS = tuple(f"sigma_{name}" for name in NUMBERS)
Floats = NDArray[np.float64]


def ten(mass: Any, center: Any, inertia: Any) -> Floats:
    """The ten numbers, last axis."""
    columns = [mass, *np.moveaxis(np.asarray(center), -1, 0), *(inertia[..., i, j] for i, j in ELEMENTS)]
    return np.stack([np.asarray(column) for column in columns], axis=-1)


def values(tree: Ledger) -> Floats:
    return ten(tree.mass, tree.center_of_mass, tree.inertia)


def sigmas(tree: Ledger) -> Floats:
    assert tree.sigma is not None
    return ten(*tree.sigma)


def covariances(tree: Ledger) -> Floats:
    assert tree.covariance is not None
    return tree.covariance


def combined(parts: Any) -> Any:
    """The textbook's sum of bodies, of numbers of any kind: parts (k, 10), or with draws before them."""
    mass, center = parts[..., 0], parts[..., 1:4]
    total = parts[..., :1].sum(axis=-2)
    mean = (mass[..., None] * center).sum(axis=-2) / total
    x, y, z = np.moveaxis(center - mean[..., None, :], -1, 0)
    own = np.stack([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z], axis=-1)
    inertia = (parts[..., 4:] + mass[..., None] * own).sum(axis=-2)
    return np.concatenate([total, mean, inertia], axis=-1)


def random_tree(count: int, seed: int, fan: int = 3) -> tuple[dict[str, Any], dict[str, list[int]]]:
    """A table of a random tree, and the rows of the leaves below each id."""
    rng = np.random.default_rng(seed)
    above = [-1] + [
        int(rng.integers(max(0, (k - 1) // fan - 2), (k - 1) // fan + 1)) for k in range(1, count)
    ]
    is_leaf = np.ones(count, bool)
    is_leaf[above[1:]] = False
    arms = rng.normal(size=(count, 3, 4))
    second = arms @ arms.swapaxes(1, 2)
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    numbers = ten(rng.uniform(1.0, 5.0, count), 3.0 * rng.normal(size=(count, 3)), inertia)
    spread = rng.uniform(0.002, 0.02, (count, 10)) * np.abs(numbers).mean(axis=0)
    columns = dict(zip(NUMBERS + SIGMAS, np.concatenate([numbers, spread], axis=1).T, strict=True))
    table: dict[str, Any] = {name: np.where(is_leaf, column, np.nan) for name, column in columns.items()}
    table["id"] = [f"n{k}" for k in range(count)]
    table["parent"] = ["" if k < 0 else f"n{k}" for k in above]
    table["POIconv"] = ["-"] * count
    below: dict[str, list[int]] = {name: [] for name in table["id"]}
    for k in np.flatnonzero(is_leaf).tolist():
        node = k
        while node >= 0:
            below[f"n{node}"].append(k)
            node = above[node]
    return table, below


def leaf_draws(table: dict[str, Any]) -> Floats:
    """The ten numbers of each row as stated, (n, 10)."""
    return np.stack([table[name] for name in NUMBERS], axis=1)


def by_complex_steps(
    table: dict[str, Any],
    rows: list[int],
    model: Callable[[Any, int], Any] = lambda numbers, _: numbers,
    source: list[str] | None = None,
) -> Floats:
    """The covariance of the sum of these rows: derivatives by complex steps, which lose no digits.

    `model` makes the ten numbers of a part from what is stated of it; rows with one word in `source` share
    draws.
    """
    stated = np.stack([table[name] for name in NUMBERS], axis=1)[rows]
    spread = np.stack([table[name] for name in SIGMAS], axis=1)[rows]
    groups: dict[Any, list[int]] = {}
    for k, row in enumerate(rows):
        groups.setdefault((source[row] if source else "") or row, []).append(k)
    columns = []
    step = 1e-30
    for members in groups.values():
        for j in range(10):
            moved = stated.astype(complex)
            moved[members, j] += 1j * step * spread[members, j]
            parts = np.stack([model(moved[k], row) for k, row in enumerate(rows)])
            columns.append(combined(parts).imag / step)
    draws = np.stack(columns, axis=1)
    covariance: Floats = draws @ draws.T
    return covariance


def assert_close(ours: Floats, theirs: Floats, rtol: float) -> None:
    """Relative to the size that each element could have by its two sigmas; those below 1e-12 are rounding."""
    scale = np.sqrt(np.diagonal(theirs, axis1=-2, axis2=-1)).clip(1e-12)
    size = scale[..., :, None] * scale[..., None, :]
    assert np.all(np.abs(ours - theirs) <= rtol * size)
