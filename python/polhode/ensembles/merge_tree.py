"""Chunks of members reduced, block by block, to nodes of a tree whose shape depends on their number alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Generic, NamedTuple, TypeAlias, TypeVar

import numpy as np

from polhode.ensembles.running import FAILED, run_members, select_rows

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode.ensembles.plan import Plan
    from polhode.reductions import Reduction

__all__ = [
    "BLOCK",
    "Nodes",
    "Place",
    "State",
    "Tree",
    "nodes_of_chunk",
    "tree_of",
]

BLOCK: Final = 4096
"""Members of a leaf."""
S = TypeVar("S")
Place: TypeAlias = tuple[int, int]
"""Level and index of a node: its members begin with ``index * 4096 * 2**level``."""


class Tree(Generic[S]):
    """A tree that grows from its leaves or from nodes above them.

    Parameters
    ----------
    leaves : int
        How many blocks there are.
    merge : callable
        Of the states of two neighbours, the left one first.
    """

    def __init__(self, leaves: int, merge: Callable[[S, S], S]) -> None:
        self.leaves, self.merge = leaves, merge
        self.top = (leaves - 1).bit_length()
        self.nodes: dict[Place, S] = {}
        """Those whose neighbour has not come."""

    def add(self, place: Place, state: S) -> None:
        """Add a node, and merge what is complete."""
        level, index = place
        while level < self.top:
            sibling = index ^ 1
            if sibling << level < self.leaves:
                if (level, sibling) not in self.nodes:
                    break
                other = self.nodes.pop((level, sibling))
                state = self.merge(other, state) if index & 1 else self.merge(state, other)
            # Beyond the last block there is nothing: such a node is its own parent.
            level, index = level + 1, index >> 1
        self.nodes[level, index] = state

    def spans(self) -> list[tuple[int, int]]:
        """Return the blocks of each node: the first, and that after the last."""
        return [(index << level, min(index + 1 << level, self.leaves)) for level, index in self.nodes]

    @property
    def root(self) -> S:
        """The state of all blocks, once all are there."""
        return self.nodes[self.top, 0]


class State(NamedTuple):
    """The state of some members: that of each reduction (None without a member), and how many failed."""

    parts: tuple[Any, ...]
    left_out: int


Nodes: TypeAlias = dict[Place, State]


def tree_of(plan: Plan, reductions: tuple[Reduction, ...]) -> Tree[State]:
    """Return an empty tree for all blocks."""

    def merge(one: State, other: State) -> State:
        for a, b in zip(one.parts, other.parts, strict=True):
            if a is not None and b is not None and a.shape != b.shape:
                raise ValueError(f"of: gave shape {a.shape} for some members and {b.shape} for others")
        parts = tuple(
            b if a is None else a if b is None else reduction.merge(a, b, plan.n)
            for reduction, a, b in zip(reductions, one.parts, other.parts, strict=True)
        )
        return State(parts, one.left_out + other.left_out)

    return Tree(-(-plan.n // BLOCK), merge)


def nodes_of_chunk(
    plan: Plan,
    reductions: tuple[Reduction, ...],
    index: int,
    progress: Callable[[float], object] | None = None,
) -> Nodes:
    """Run the blocks of a chunk and merge them as far as they go.

    Each block is run by itself, so that a function of its states sees the same arrays however the ensemble is
    cut.
    """
    first, count = plan.bounds(index)
    tree = tree_of(plan, reductions)
    for start in range(first, first + count, BLOCK):
        size = min(BLOCK, first + count - start)

        def tell(fraction: float, start: int = start, size: int = size) -> None:
            if progress is not None:
                progress((start - first + fraction * size) / count)

        tree.add((0, start // BLOCK), _block(plan, reductions, start, size, tell if progress else None))
    return tree.nodes


def _block(
    plan: Plan,
    reductions: tuple[Reduction, ...],
    first: int,
    count: int,
    progress: Callable[[float], object] | None,
) -> State:
    run = run_members(plan, first, count, progress)
    good = ~np.isin(run.status, FAILED)
    left_out = count - int(np.count_nonzero(good))
    kept = good[run.rows]
    if not kept.any():
        return State((None,) * len(reductions), left_out)
    # Those that failed are not shown to anybody.
    shown = select_rows(run.trajectories[0], np.flatnonzero(kept))
    parts = tuple(reduction.start(reduction.values(shown), plan.n) for reduction in reductions)
    return State(parts, left_out)
