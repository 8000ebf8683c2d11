"""Chunks of an ensemble one after the other on this machine, whose threads share each of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from polhode.ensembles.plan import Plan

__all__ = ["Task", "chunks_here"]

R_co = TypeVar("R_co", covariant=True)


class Task(Protocol[R_co]):
    """What is done with a chunk: a value that goes to other processes."""

    @property
    def plan(self) -> Plan:
        """The ensemble."""

    def __call__(self, index: int, progress: Callable[[float], object] | None = None) -> R_co:
        """Do it."""


def chunks_here(
    task: Task[R_co], pending: Sequence[int], tell: Callable[[float], object] | None
) -> Iterator[tuple[int, R_co]]:
    """Do chunks here, in order.

    Parameters
    ----------
    task : callable
    pending : sequence of int
        The chunks.
    tell : callable or None
        Told the fraction of all members of the ensemble that is done.

    Yields
    ------
    tuple of int and object
        The chunk and its result.
    """
    plan = task.plan
    members = sum(plan.bounds(index)[1] for index in pending)
    done = plan.n - members
    for index in pending:
        count = plan.bounds(index)[1]

        def within(fraction: float, done: int = done, count: int = count) -> None:
            if tell is not None:
                tell((done + fraction * count) / plan.n)

        result: Any = task(index, within if tell else None)
        yield index, result
        done += count
        if tell is not None:
            tell(done / plan.n)
