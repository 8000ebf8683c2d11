"""The roll-up: mass, centre and tensor of every node, their covariances, and the shares of the parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode.io.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from polhode.uncertainty.ledgers.parts import Parts
    from polhode.uncertainty.ledgers.table import Tree

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]
    Column = dict[int, Floats | float]

__all__ = [
    "NUMBERS",
    "PAIRS",
    "Contributions",
    "Covariances",
    "Shares",
    "Values",
    "groups",
    "own_moment",
    "pack",
    "roll_covariances",
    "roll_values",
    "shift",
    "shift_row",
    "unpack",
]

NUMBERS: Final = ("mass", "Cx", "Cy", "Cz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""The ten numbers of a body, in the order of covariances; tensor elements, so minus the products."""
PAIRS: Final = [(a, b) for a in range(10) for b in range(a, 10)]
"""The 55 elements of a symmetric matrix that are kept."""
_PLACE: Final = np.zeros((10, 10), np.intp)
for _k, (_a, _b) in enumerate(PAIRS):
    _PLACE[_a, _b] = _PLACE[_b, _a] = _k
_ROWS: Final = np.array([a for a, _ in PAIRS])
_COLUMNS: Final = np.array([b for _, b in PAIRS])
_CHUNK: Final = 8192
"""Leaves at once, and eight times as many as dense nodes: their arrays fit into the cache."""


class Values(NamedTuple):
    """By place: mass (n,), centre (3, n), tensor about it (6, n), and d = c − C of the parent (3, n)."""

    mass: Floats
    center: Floats
    inertia: Floats
    arm: Floats


def own_moment(d: Floats) -> Floats:
    """Return A(d) = d² 1 − d dᵀ as (6, n) for d of shape (3, n)."""
    x, y, z = d
    return np.stack([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z])


def roll_values(tree: Tree, mass: Floats, center: Floats, inertia: Floats) -> Values:
    """Fill in the values of every node that has children.

    Parameters
    ----------
    tree : Tree
    mass, center, inertia : numpy.ndarray
        By place, shapes (n,), (3, n) and (6, n); what stands at nodes with children is written over.
    """
    arm = np.zeros_like(center)
    for places in reversed(tree.levels[1:]):
        parents, starts, counts = groups(tree.above[places])
        m = mass[places]
        total = np.add.reduceat(m, starts)
        # From the first child on, so that a tree far from the origin loses no digits.
        first = center[:, places][:, starts]
        d = center[:, places] - np.repeat(first, counts, axis=1)
        mean = np.add.reduceat(m * d, starts, axis=1) / total
        d -= np.repeat(mean, counts, axis=1)
        arm[:, places] = d
        mass[parents] = total
        center[:, parents] = first + mean
        inertia[:, parents] = np.add.reduceat(inertia[:, places] + m * own_moment(d), starts, axis=1)
    return Values(mass, center, inertia, arm)


def roll_covariances(
    tree: Tree, values: Values, sigma: Floats, is_dense: NDArray[np.bool_], covariances: Floats
) -> Floats:
    """Roll up the covariances of z for parts that are independent.

    Parameters
    ----------
    tree : Tree
    values : Values
    sigma : numpy.ndarray
        Shape (10, n), by place: standard deviations of the leaves whose ten errors are independent; else
        unused.
    is_dense : numpy.ndarray of bool
        By place: nodes with children, and leaves whose errors are correlated.
    covariances : numpy.ndarray
        Shape (55, number of dense nodes): covariances of z of dense leaves, zero elsewhere; filled in place.

    Returns
    -------
    numpy.ndarray
        `covariances`.
    """
    slot = np.cumsum(is_dense) - 1
    leaves = np.flatnonzero(~is_dense)
    if len(tree.order) > 1:
        for start in range(0, len(leaves), _CHUNK):
            _add_leaves(tree, values, sigma, leaves[start : start + _CHUNK], slot, covariances)
    for places in reversed(tree.levels[1:]):
        level = np.flatnonzero(is_dense[places]) + places.start
        for start in range(0, len(level), _CHUNK // 8):
            dense = level[start : start + _CHUNK // 8]
            parents, starts, _ = groups(tree.above[dense])
            moved = _shift_matrices(unpack(covariances[:, slot[dense]]), values.arm[:, dense])
            covariances[:, slot[parents]] += np.add.reduceat(pack(moved), starts, axis=1)
    return covariances


def shift(z: Floats, d: Floats) -> Floats:
    """Return S(d) z: first index of `z` the ten numbers, last one the nodes, as of `d`, shape (3, n)."""
    moved = z.copy()
    for j, column in enumerate(_columns(d)):
        for a, factor in column.items():
            if a != j:
                moved[a] += factor * z[j]
    return moved


def shift_row(a: int, d: Floats) -> Floats:
    """Return row `a` of S(d), shape (10, n): what each error of a part does to number `a` of the whole."""
    row = np.zeros((10, d.shape[1]))
    row[a] = 1.0
    for j, column in enumerate(_columns(d)):
        row[j] = column.get(a, row[j])
    return row


def pack(matrices: Floats) -> Floats:
    """Keep the 55 elements: (10, 10, n) to (55, n)."""
    packed: Floats = matrices[_ROWS, _COLUMNS]
    return packed


def unpack(packed: Floats) -> Floats:
    """Write out symmetric matrices: (55, n) to (10, 10, n)."""
    return packed[_PLACE]


def _shift_matrices(matrices: Floats, d: Floats) -> Floats:
    """Return S Q Sᵀ for Q of shape (10, 10, n)."""
    return shift(shift(matrices, d).swapaxes(0, 1), d)


def _columns(d: Floats) -> tuple[Column, Column, Column, Column]:
    """Return the columns of S(d) beyond those of the unit matrix: the effect of δm and of the three δs."""
    x, y, z = d
    xx, yy, zz, xy, xz, yz = own_moment(d)
    return (
        {0: 1.0, 1: x, 2: y, 3: z, 4: xx, 5: yy, 6: zz, 7: xy, 8: xz, 9: yz},
        {1: 1.0, 5: 2.0 * x, 6: 2.0 * x, 7: -y, 8: -z},
        {2: 1.0, 4: 2.0 * y, 6: 2.0 * y, 7: -x, 9: -z},
        {3: 1.0, 4: 2.0 * z, 5: 2.0 * z, 8: -x, 9: -y},
    )


def _add_leaves(
    tree: Tree, values: Values, sigma: Floats, leaves: Integers, slot: Integers, covariances: Floats
) -> None:
    """Add S diag(v) Sᵀ of leaves to their parents, element by element: most of those of S are zero."""
    parents, starts, _ = groups(tree.above[leaves])
    sums = np.empty((len(PAIRS), len(parents)))
    v = sigma[:, leaves] ** 2
    v[1:4] *= values.mass[leaves] ** 2
    columns = _columns(values.arm[:, leaves])
    weighted = [{a: factor * v[j] for a, factor in column.items()} for j, column in enumerate(columns)]
    for k, (a, b) in enumerate(PAIRS):
        terms = [w[a] * c[b] for w, c in zip(weighted, columns, strict=True) if a in w and b in c]
        if a == b and a > 3:
            terms.append(v[a])
        np.add.reduceat(sum(terms[1:], terms[0]), starts, out=sums[k])
    covariances[:, slot[parents]] += sums


def groups(above: Integers) -> tuple[Integers, Integers, Integers]:
    """Return the parents, the first child of each, and the number of its children."""
    starts = np.flatnonzero(np.diff(above, prepend=-2))
    return above[starts], starts, np.diff(starts, append=len(above))


_ROUNDING: Final = 1e-15
"""Effects that cancel leave this fraction of the sum of their sizes."""


class Contributions(NamedTuple):
    """Contributions of each source of error to the variance of one number of a node.

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
        packed[:, self._slot[own]] = _covariance_of_draws(self._of(own))
        self._packed = roll_covariances(tree, values, self._sigma, is_dense, packed)
        if len(self._shared):
            budget = Budget(name, len(tree.order), "rows")
            for pairs, draws in _rolled_draws(
                tree, values.arm, self._of(self._shared), self._shared, self._codes
            ):
                budget.spend("shared errors", len(pairs))
                order = np.argsort(pairs, kind="stable")
                nodes, starts, _ = groups(pairs[order])
                squares = _covariance_of_draws(draws[:, :, order])
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
        """Return covariances, shape (number of places, 10, 10)."""
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
        """Return the contributions of the parts to the variance of one of a node's ten numbers."""
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
        """Return the draws of leaves, shape (10, 10, number of places): the effect of each draw on z."""
        draws = np.zeros((10, 10, len(places)))
        sigma = self._sigma[:, places].copy()
        sigma[1:4] *= self._values.mass[places]
        draws[np.arange(10), np.arange(10)] = sigma
        own = np.flatnonzero(self._draws_at[places] >= 0)
        draws[:, :, own] = self._draws[:, :, self._draws_at[places[own]]]
        return draws


def _shared_leaves(tree: Tree, names: list[str]) -> tuple[Integers, Integers]:
    """Return leaves, by ascending place, that share their source with another one, and the number of it."""
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


def _covariance_of_draws(draws: Floats) -> Floats:
    """Return the covariances of independent draws, packed: (10, 10, n) to (55, n)."""
    return pack(np.einsum("ajn,bjn->abn", draws, draws))


@dataclass(frozen=True, eq=False, repr=False)
class Shares:
    """Contributions to the variance of one number, the largest first.

    Each contribution comes from one part, or from all parts that share a source.

    Attributes
    ----------
    of : str
        The number: mass, a coordinate of the centre, or an element of the tensor.
    at : str
        The id of the node whose number it is.
    names : tuple of str
        Name of each part; for parts that share a source, the name of the source.
    is_source : numpy.ndarray of bool, shape (n,)
        Whether the name is that of a shared source.
    fraction : numpy.ndarray, shape (n,)
        Share of each in the variance; the shares add up to 1.
    by_number : numpy.ndarray, shape (n, 10)
        The same shares, split by the number of the part whose error causes them: mass, Cx, Cy, Cz, Ixx, Iyy,
        Izz, Ixy, Ixz, Iyz, as the row of the part states them. A stated density counts as mass.
    sigma : float
        Standard deviation of the number; its square is the variance that is shared out.
    """

    of: str
    at: str
    names: tuple[str, ...]
    is_source: NDArray[np.bool_]
    fraction: Floats
    by_number: Floats
    sigma: float

    def __len__(self) -> int:
        return len(self.names)

    def largest(self, row: int) -> str:
        """Return the name of the number that contributes most, of the part with this place in `names`."""
        return NUMBERS[int(np.argmax(self.by_number[row]))]

    def __repr__(self) -> str:
        told = ", ".join(
            f"{name} {fraction:.1%} ({self.largest(row)})"
            for row, (name, fraction) in enumerate(zip(self.names[:3], self.fraction, strict=False))
        )
        more = f", and {len(self) - 3} more" if len(self) > 3 else ""
        return f"<Shares of the variance of {self.of} of {self.at!r}: {told}{more}>"
