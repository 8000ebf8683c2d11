"""Covariances of all nodes of a ledger, also of parts that share a source, and who contributes to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode.files.budget import Budget
from polhode.uncertainty._rollup import groups, pack, roll_covariances, shift, shift_row, unpack

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from polhode.uncertainty._parts import Parts
    from polhode.uncertainty._rollup import Values
    from polhode.uncertainty._tree import Tree

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

__all__ = ["Contributions", "Covariances"]

_ROUNDING: Final = 1e-15
"""Of the sum of their sizes: what is left of effects that cancel."""


class Contributions(NamedTuple):
    """What each source of error adds to the variance of one number of a node.

    Attributes
    ----------
    rows : numpy.ndarray
        The row of the part; of parts that share a source, that of the first.
    sources : list of str
        The name of the source that several parts share; "" for the errors of one part alone.
    variances : numpy.ndarray
        By the ten numbers whose error it is, shape (number of sources, 10).
    """

    rows: Integers
    sources: list[str]
    variances: Floats


class Covariances:
    """The covariances of the ten numbers of every node, kept as 55 elements where they are full.

    Parameters
    ----------
    tree : Tree
    values : Values
    parts : Parts
    name : str
        Of the table, for errors.
    """

    def __init__(self, tree: Tree, values: Values, parts: Parts, name: str) -> None:
        self._tree, self._values, self._names = tree, values, parts.source
        self._sigma = tree.by_place(parts.sigma)
        rows, self._draws = parts.correlated
        own = tree.place[rows]
        self._draws_at = np.full(len(tree.order), -1)
        self._draws_at[own] = np.arange(len(own))
        self._shared, self._codes = _shared_leaves(tree, parts.source)
        is_dense = ~tree.is_leaf
        is_dense[own] = True
        is_dense[self._shared] = True
        self._slot = np.where(is_dense, np.cumsum(is_dense) - 1, -1)
        packed = np.zeros((55, int(is_dense.sum())))
        own = np.setdiff1d(own, self._shared)
        packed[:, self._slot[own]] = _squared(self._of(own))
        self._packed = roll_covariances(tree, values, self._sigma, is_dense, packed)
        if len(self._shared):
            budget = Budget(name, len(tree.order), "rows")
            for pairs, draws in _rolled_draws(
                tree, values.arm, self._of(self._shared), self._shared, self._codes
            ):
                budget.spend("shared errors", len(pairs))
                order = np.argsort(pairs, kind="stable")
                nodes, starts, _ = groups(pairs[order])
                squares = _squared(draws[:, :, order])
                self._packed[:, self._slot[nodes]] += np.add.reduceat(squares, starts, axis=1)

        self.sigma = self._sigmas()
        """Standard deviations of the ten numbers, shape (10, n), by place."""

    def _sigmas(self) -> Floats:
        # What parts with independent errors state is theirs to the bit.
        is_full = ~self._tree.is_leaf | (self._draws_at >= 0)
        sigma = self._sigma.copy() if self._draws.shape[2] else self._sigma
        dense = np.flatnonzero(is_full)
        diagonal = [k for k, (a, b) in enumerate(zip(*np.triu_indices(10), strict=True)) if a == b]
        sigma[:, dense] = np.sqrt(self._packed[diagonal][:, self._slot[dense]])
        sigma[1:4, dense] /= self._values.mass[dense]
        return sigma

    def matrices(self, places: Integers) -> Floats:
        """Give covariances, shape (number of places, 10, 10)."""
        full = np.zeros((len(places), 10, 10))
        slots = self._slot[places]
        plain, dense = np.flatnonzero(slots < 0), np.flatnonzero(slots >= 0)
        full[plain[:, None], np.arange(10), np.arange(10)] = (self._sigma[:, places[plain]] ** 2).T
        matrices = unpack(self._packed[:, slots[dense]])
        matrices[1:4] /= self._values.mass[places[dense]]
        matrices[:, 1:4] /= self._values.mass[places[dense]]
        full[dense] = np.moveaxis(matrices, -1, 0)
        return full

    def contributions(self, number: int, row: int) -> Contributions:
        """Tell which part adds what to the variance of one of the ten numbers of the node in a row."""
        tree, values = self._tree, self._values
        node = int(tree.place[row])
        leaves = np.flatnonzero(tree.below(row) & tree.is_leaf)
        gradient = shift_row(number, values.center[:, leaves] - values.center[:, node, None])
        if 1 <= number <= 3:
            gradient /= values.mass[node]
        sigma = self._sigma[:, leaves].copy()
        sigma[1:4] *= values.mass[leaves]
        effect = gradient * sigma
        own = np.flatnonzero(self._draws_at[leaves] >= 0)
        draws = self._draws[:, :, self._draws_at[leaves[own]]]
        effect[:, own] = np.einsum("an,ajn->jn", gradient[:, own], draws)
        rows, sources = tree.order[leaves], [""] * len(leaves)
        is_shared = np.isin(leaves, self._shared)
        if is_shared.any():
            together = np.flatnonzero(is_shared)
            codes = self._codes[np.searchsorted(self._shared, leaves[together])]
            order = np.argsort(codes, kind="stable")
            _, starts, _ = groups(codes[order])
            shared = effect[:, together[order]]
            sums = np.add.reduceat(shared, starts, axis=1)
            sums[np.abs(sums) <= _ROUNDING * np.add.reduceat(np.abs(shared), starts, axis=1)] = 0.0
            first = rows[together[order][starts]]
            sources = [""] * int(np.sum(~is_shared)) + [self._names[row] for row in first.tolist()]
            effect = np.concatenate([effect[:, ~is_shared], sums], axis=1)
            rows = np.concatenate([rows[~is_shared], first])
        return Contributions(rows, sources, (effect**2).T)

    def _of(self, places: Integers) -> Floats:
        """Give the draws of leaves, shape (10, 10, number of places): the effect of each draw on z."""
        draws = np.zeros((10, 10, len(places)))
        sigma = self._sigma[:, places].copy()
        sigma[1:4] *= self._values.mass[places]
        draws[np.arange(10), np.arange(10)] = sigma
        own = np.flatnonzero(self._draws_at[places] >= 0)
        draws[:, :, own] = self._draws[:, :, self._draws_at[places[own]]]
        return draws


def _shared_leaves(tree: Tree, names: list[str]) -> tuple[Integers, Integers]:
    """Give the leaves, by ascending place, that share their source with another one, and the number of it."""
    found: dict[str, list[int]] = {}
    for place, row in enumerate(tree.order.tolist() if names else ()):
        if names[row] and tree.is_leaf[place]:
            found.setdefault(names[row], []).append(place)
    shared = [places for places in found.values() if len(places) > 1]
    pairs = sorted((place, code) for code, places in enumerate(shared) for place in places)
    both = np.array(pairs, np.intp).reshape(-1, 2)
    return both[:, 0], both[:, 1]


def _rolled_draws(
    tree: Tree, arm: Floats, draws: Floats, leaves: Integers, codes: Integers
) -> Iterator[tuple[Integers, Floats]]:
    """Roll up the effect of shared draws, which add before they are squared.

    Yields
    ------
    places, draws : numpy.ndarray
        Of each level: a node as often as there are shared sources in it, with the effect of each.
    """
    most = int(codes.max()) + 1
    nodes, sources, effect = np.empty(0, np.intp), np.empty(0, np.intp), np.empty((10, 10, 0))
    for places in reversed(tree.levels):
        here = (leaves >= places.start) & (leaves < places.stop)
        nodes = np.concatenate([nodes, leaves[here]])
        sources = np.concatenate([sources, codes[here]])
        effect = np.concatenate([effect, draws[:, :, here]], axis=2)
        if not len(nodes):
            continue
        yield nodes, effect
        if places.start == 0:
            return
        key = tree.above[nodes] * most + sources
        order = np.argsort(key, kind="stable")
        keys, starts, _ = groups(key[order])
        effect = np.add.reduceat(shift(effect, arm[:, nodes])[:, :, order], starts, axis=2)
        nodes, sources = keys // most, keys % most


def _squared(draws: Floats) -> Floats:
    """Give the covariances of independent draws, packed: (10, 10, n) to (55, n)."""
    return pack(np.einsum("ajn,bjn->abn", draws, draws))
