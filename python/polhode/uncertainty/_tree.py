"""The tree of a ledger: from the names of parents to levels, each with its children side by side."""

from __future__ import annotations

from itertools import pairwise, repeat
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from polhode.errors import PolhodeError
from polhode.files.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

__all__ = ["Tree", "make_tree"]

_SHOWN = 8
"""Ids of a circle that an error names."""


class Tree(NamedTuple):
    """Who is whose part.

    Rows are those of the table. Places count through the levels from the root down: within a level the
    children of one parent stand side by side, in the order of their parents.

    Attributes
    ----------
    ids : tuple of str
        By row.
    row_of : dict
        The row of each id.
    parent : numpy.ndarray
        The row of the parent, by row; -1 for the root.
    order : numpy.ndarray
        The row, by place.
    place : numpy.ndarray
        The place, by row.
    levels : tuple of slice
        The places of each level.
    above : numpy.ndarray
        The place of the parent, by place: it never descends. -1 for the root.
    is_leaf : numpy.ndarray of bool
        By place: whether nothing is below it.
    is_sorted : bool
        Whether places are rows: the table goes level by level.
    """

    ids: tuple[str, ...]
    row_of: dict[str, int]
    parent: Integers
    order: Integers
    place: Integers
    levels: tuple[slice, ...]
    above: Integers
    is_leaf: NDArray[np.bool_]
    is_sorted: bool

    def by_place(self, rows: Floats) -> Floats:
        """Put what stands by row, last axis, in the order of places; not copied where that is the same."""
        return rows if self.is_sorted else rows[..., self.order]

    def by_row(self, places: Floats) -> Floats:
        """Put what stands by place, last axis, in the order of rows; not copied where that is the same."""
        return places if self.is_sorted else places[..., self.place]

    def depth(self) -> Integers:
        """Give the level of each row: 0 for the root."""
        depth = np.empty_like(self.order)
        for level, places in enumerate(self.levels):
            depth[self.order[places]] = level
        return depth

    def below(self, row: int) -> NDArray[np.bool_]:
        """Tell of each place whether it is the node of this row or below it."""
        inside: NDArray[np.bool_] = self.order == row
        for places in self.levels[1:]:
            inside[places] |= inside[self.above[places]]
        return inside

    def children(self, row: int) -> tuple[int, ...]:
        """Give the rows of the children, in the order of the table."""
        place = self.place[row]
        start, end = np.searchsorted(self.above, (place, place + 1))
        return tuple(self.order[start:end].tolist())


def make_tree(ids: Sequence[str], parents: Sequence[str], where: Callable[[int], str]) -> Tree:
    """Build the tree.

    Parameters
    ----------
    ids, parents : sequence of str
        The parent of the root is "".
    where : callable
        Names a row in errors.

    Raises
    ------
    PolhodeError
        If an id is missing or there twice, a parent has no row, there is no root or more than one, or a part
        is its own ancestor.
    """
    index = dict(zip(ids, range(len(ids)), strict=True))
    if "" in index:
        raise PolhodeError(f"{where(ids.index(''))}: id is empty; give each part its own")
    if len(index) < len(ids):
        _refuse_twice(ids, where)
    parent = np.fromiter(map(index.get, parents, repeat(-1)), np.intp, len(ids))
    roots = np.flatnonzero(parent < 0)
    orphan = next((row for row in roots.tolist() if parents[row]), None)
    if orphan is not None:
        raise PolhodeError(
            f"{where(orphan)}: an orphan: its parent {parents[orphan]!r} has no row; add one for it "
            "or correct the name"
        )
    if len(roots) > 1:
        one, two = (ids[row] for row in roots[:2].tolist())
        raise PolhodeError(
            f"{where(int(roots[1]))}: a second root: {one!r} and {two!r} have no parent"
            f"{f' ({len(roots)} roots in all)' if len(roots) > 2 else ''}; add a row for the whole and "
            "name it as their parent"
        )
    order, bounds = _by_levels(parent)
    if len(order) < len(ids):
        _refuse_circle(ids, parent, order, where)
    Budget("", 0).spend("levels", len(bounds) - 1, where(int(order[-1])))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    above = np.where(parent[order] < 0, -1, place[parent[order]])
    is_leaf = np.ones(len(order), np.bool_)
    is_leaf[above[1:]] = False
    levels = tuple(slice(start, end) for start, end in pairwise(bounds))
    return Tree(
        tuple(ids), index, parent, order, place, levels, above, is_leaf, bool(np.all(place[:-1] < place[1:]))
    )


def _by_levels(parent: Integers) -> tuple[Integers, list[int]]:
    """Give the rows that are reached from the root, level by level, and where each level begins."""
    by_parent = np.argsort(parent, kind="stable")
    count = np.bincount(parent + 1, minlength=len(parent) + 1)
    first = np.cumsum(count) - count
    count, first = count[1:], first[1:]
    order, bounds = [by_parent[: int(np.sum(parent < 0))]], [0]
    while len(order[-1]):
        bounds.append(bounds[-1] + len(order[-1]))
        counts = count[order[-1]]
        # The children of each node are a range of `by_parent`: all those ranges one after another.
        steps = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        order.append(by_parent[np.repeat(first[order[-1]], counts) + steps])
    return np.concatenate(order), bounds


def _refuse_twice(ids: Sequence[str], where: Callable[[int], str]) -> None:
    seen: dict[str, int] = {}
    for row, name in enumerate(ids):
        if name in seen:
            raise PolhodeError(
                f"{where(row)}: id {name!r} is there twice, first at {where(seen[name])}; give each part "
                "its own"
            )
        seen[name] = row


def _refuse_circle(
    ids: Sequence[str], parent: Integers, reached: Integers, where: Callable[[int], str]
) -> None:
    outside = np.ones(len(ids), np.bool_)
    outside[reached] = False
    row = int(np.flatnonzero(outside)[0])
    met: dict[int, int] = {}
    walk: list[int] = []
    while row not in met:
        met[row] = len(walk)
        walk.append(row)
        row = int(parent[row])
    circle = walk[met[row] :]
    names = [repr(ids[row]) for row in circle[:_SHOWN]] + (["..."] if len(circle) > _SHOWN else [])
    raise PolhodeError(
        f"{where(circle[0])}: a cycle: {' in '.join([*names, names[0]])}; a part cannot be its own ancestor: "
        "correct one of the parents"
    )
