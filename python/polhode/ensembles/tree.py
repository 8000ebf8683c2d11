"""States of blocks, merged in a tree that depends on their number alone, whatever order they come in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Generic, TypeAlias, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["BLOCK", "Place", "Tree"]

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
        """Give the blocks of each node: the first, and that after the last."""
        return [(index << level, min(index + 1 << level, self.leaves)) for level, index in self.nodes]

    @property
    def root(self) -> S:
        """The state of all blocks, once all are there."""
        return self.nodes[self.top, 0]
