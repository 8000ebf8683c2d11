"""A ledger of 1e5 parts beside R massProps' documented recursion, node by node in NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode.uncertainty import Ledger, ledger

if TYPE_CHECKING:
    from collections.abc import Iterator

COUNT = 100_000
FAN = 6
"""Children of a node, on average."""
NUMBERS = ("mass", "Cx", "Cy", "Cz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def random_table(count: int, seed: int) -> dict[str, Any]:
    """Parts of a random tree, level by level as in the tables of massProps, as columns."""
    rng = np.random.default_rng(seed)
    above = np.array(
        [-1, *np.sort((np.arange(1, count) - 1 - rng.integers(0, FAN, count - 1)).clip(0) // FAN)]
    )
    is_leaf = np.ones(count, bool)
    is_leaf[above[1:]] = False
    arms = rng.normal(size=(count, 3, 4))
    second = arms @ arms.swapaxes(1, 2)
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    numbers = [rng.uniform(1.0, 5.0, count), *rng.normal(scale=10.0, size=(3, count))]
    numbers += [inertia[:, i, j] for i, j in ELEMENTS]
    sigmas = [rng.uniform(0.0, 0.01, count) * np.abs(number).mean() for number in numbers]
    columns = dict(zip((*NUMBERS, *(f"sigma_{name}" for name in NUMBERS)), numbers + sigmas, strict=True))
    table: dict[str, Any] = {name: np.where(is_leaf, column, np.nan) for name, column in columns.items()}
    ids = [f"part {k}" for k in range(count)]
    table["id"] = ids
    table["parent"] = ["", *(ids[k] for k in above[1:].tolist())]
    table["POIconv"] = ["-"] * count
    return table


def by_recursion(table: dict[str, Any]) -> dict[str, Any]:
    """Roll up as R massProps does, from the leaves up: get the parts of a node, combine them, set it."""
    table = {
        name: column.copy() if isinstance(column, np.ndarray) else column for name, column in table.items()
    }
    index = {name: row for row, name in enumerate(table["id"])}
    children: dict[str, list[str]] = {}
    for name, parent in zip(table["id"], table["parent"], strict=True):
        children.setdefault(parent, []).append(name)
    waiting, order = [children[""][0]], []
    while waiting:
        node = waiting.pop()
        if node in children:
            order.append(node)
            waiting.extend(children[node])
    for name, row in index.items():
        if name not in children:
            validate(got(table, row))
    for node in reversed(order):
        put(table, index[node], combined([got(table, index[child]) for child in children[node]]))
    return table


def got(table: dict[str, Any], row: int) -> tuple[Any, ...]:
    """Mass, centre and tensor of a row, and their sigmas."""
    record: list[Any] = []
    for prefix in ("", "sigma_"):
        mass, *center = (table[f"{prefix}{name}"][row] for name in NUMBERS[:4])
        xx, yy, zz, xy, xz, yz = (table[f"{prefix}{name}"][row] for name in NUMBERS[4:])
        record += [mass, np.array(center), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])]
    return tuple(record)


def validate(record: tuple[Any, ...]) -> None:
    """Refuse what no body has, as massProps does with every leaf."""
    mass, center, tensor, *sigmas = record
    assert np.isfinite(mass)
    assert mass > 0.0
    assert np.all(np.isfinite(center))
    assert np.all(np.isfinite(tensor))
    one, two, three = np.linalg.eigvalsh(tensor)
    assert one > 0.0
    assert one + two > three
    for sigma in sigmas:
        assert np.all(np.isfinite(sigma))
        assert np.all(sigma >= 0.0)


def put(table: dict[str, Any], row: int, record: tuple[Any, ...]) -> None:
    """Write a record into its row."""
    for prefix, (mass, center, tensor) in (("", record[:3]), ("sigma_", record[3:])):
        elements = (tensor[i, j] for i, j in ELEMENTS)
        for name, value in zip(NUMBERS, (mass, *center, *elements), strict=True):
            table[prefix + name][row] = value


def combined(parts: list[tuple[Any, ...]]) -> tuple[Any, ...]:
    """Combine records, formula by formula as the vignette of massProps boxes and codes them."""
    total = sum(part[0] for part in parts)
    center = sum(part[0] * part[1] for part in parts) / total
    one = np.eye(3)

    def moved(part: tuple[Any, ...]) -> Any:
        d = center - part[1]
        q = np.outer(d, d)
        return part[2] - part[0] * (q - np.sum(np.diag(q)) * one)

    def center_variance(part: tuple[Any, ...]) -> Any:
        return (part[0] * part[4]) ** 2 + (part[3] * (part[1] - center)) ** 2

    def inertia_variance(part: tuple[Any, ...]) -> Any:
        d = part[1] - center
        p, q = np.outer(d, part[4]), np.outer(d, d)
        diagonal = np.diag(p)
        m1 = p - np.diag(diagonal - 2.0 * diagonal[[1, 0, 0]])
        m2 = p.T - np.diag(diagonal - 2.0 * diagonal[[2, 2, 1]])
        m3 = q - np.sum(np.diag(q)) * one
        return part[5] ** 2 + part[0] ** 2 * (m1**2 + m2**2) + (part[3] * m3) ** 2

    inertia = sum(moved(part) for part in parts)
    sigma_mass = np.sqrt(sum(part[3] ** 2 for part in parts))
    sigma_center = np.sqrt(sum(center_variance(part) for part in parts)) / total
    return (
        total,
        center,
        inertia,
        sigma_mass,
        sigma_center,
        np.sqrt(sum(inertia_variance(part) for part in parts)),
    )


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    table = random_table(COUNT, seed=1)

    def same(ours: Ledger, theirs: dict[str, Any]) -> None:
        """All values, and all sigmas that the recursion has right.

        It hands on ten independent sigmas a node. Those of centres and tensors lean on the same masses, so
        that one level above assemblies of parts it drops what they have in common.
        """
        sigma = ours.sigma
        assert sigma is not None
        mine = (ours.mass, *ours.center_of_mass.T, *(ours.inertia[:, i, j] for i, j in ELEMENTS))
        spread = (sigma.mass, *sigma.center_of_mass.T, *(sigma.inertia[:, i, j] for i, j in ELEMENTS))
        simple = of_parts_alone(ours)
        for k, name in enumerate(NUMBERS):
            scale = np.abs(mine[k]).max() if k else mine[0]
            assert np.max(np.abs(mine[k] - theirs[name]) / scale) < 1e-12, name
            chosen = simple if k else slice(None)
            error = np.abs(spread[k] / theirs[f"sigma_{name}"] - 1.0)
            assert error[chosen].max() < 1e-9, (name, error[chosen].max())

    def with_sigma() -> Ledger:
        """With the same output as the recursion; what `covariance` writes out is computed by then."""
        made = ledger(table)
        assert made.sigma is not None
        return made

    yield Row(
        name="a ledger of 1e5 parts, values and sigmas, covariances kept",
        peer="numpy: massProps' recursion",
        ours=with_sigma,
        theirs=lambda: by_recursion(table),
        compare=same,
        items=COUNT,
        at_least=50,
    )


def of_parts_alone(tree: Ledger) -> Any:
    """Whether a node is a part or an assembly of parts alone."""
    index = {name: row for row, name in enumerate(tree.ids)}
    alone = np.ones(len(tree), bool)
    for row in np.flatnonzero(~tree.is_part).tolist():
        if tree.parents[row]:
            alone[index[tree.parents[row]]] = False
    return alone
