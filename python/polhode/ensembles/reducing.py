"""Chunks of members reduced, block by block, to nodes of the tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from polhode.ensembles.running import FAILED, picked, run_members
from polhode.ensembles.tree import BLOCK, Place, Tree

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode.ensembles.plan import Plan
    from polhode.reductions import Reduction

__all__ = ["Nodes", "State", "nodes_of_chunk", "tree_of"]


class State(NamedTuple):
    """Of some members: a state of each reduction, None without a member, and how many failed."""

    parts: tuple[Any, ...]
    left_out: int


Nodes: TypeAlias = dict[Place, State]


def tree_of(plan: Plan, reductions: tuple[Reduction, ...]) -> Tree[State]:
    """Give the tree of all blocks, without any of them."""

    def merge(one: State, other: State) -> State:
        for a, b in zip(one.parts, other.parts, strict=True):
            if a is not None and b is not None and a.shape != b.shape:
                raise ValueError(f"of: gave shape {a.shape} for some members and {b.shape} for others")
        parts = tuple(
            b if a is None else a if b is None else reduction.merged(a, b, plan.n)
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
    shown = picked(run.trajectories[0], np.flatnonzero(kept))
    parts = tuple(reduction.begun(reduction.values(shown), plan.n) for reduction in reductions)
    return State(parts, left_out)
