"""Where the chunks of an ensemble are computed: threads of this machine, or the workers of a dask cluster."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from polhode._optional import require
from polhode.ensembles.fingerprint import build

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from polhode.ensembles.plan import Plan

__all__ = [
    "Task",
    "check_client",
    "chunks_here",
    "chunks_of_client",
]

R = TypeVar("R")


def check_client(client: Any) -> None:
    """Refuse an object that is no client of dask, or an asynchronous client."""
    distributed = require("distributed", extra="cluster", purpose="client=")
    if not isinstance(client, distributed.Client):
        raise TypeError(f"client: expected a dask.distributed.Client, got {type(client).__name__}")
    if client.asynchronous:
        raise ValueError("client: it is asynchronous; make one without asynchronous=True")


def chunks_of_client(
    client: Any, task: Task[R], pending: Sequence[int], tell: Callable[[float], object] | None
) -> Iterator[tuple[int, R]]:
    """Run chunks on the workers of a cluster, and yield them in the order in which they end.

    Parameters
    ----------
    client : distributed.Client
    task : callable
    pending : sequence of int
        The chunks.
    tell : callable or None
        Called with the fraction of all members that is done.

    Yields
    ------
    tuple of int and object
        The chunk and its result.

    Raises
    ------
    RuntimeError
        Where a worker has another polhode, before any chunk is begun.
    """
    distributed = require("distributed", extra="cluster", purpose="client=")
    _check_workers(client)
    plan = task.plan
    # As a task of its own, whose argument the scheduler keeps: a worker that comes later, or in place of one
    # that died, gets it as the others did.
    held = client.submit(_deserialize, _serialize(task), build(), pure=False)
    waiting = iter(pending)
    done = plan.n - sum(plan.bounds(index)[1] for index in pending)
    places: dict[Any, int] = {}

    def submit_next() -> Any:
        """Submit the next chunk, if there is one."""
        for index in waiting:
            future = client.submit(_run_task, held, index, pure=False)
            places[future] = index
            return future
        return None

    threads = sum(client.nthreads().values())
    first = [future for _ in range(2 * threads + 2) if (future := submit_next()) is not None]
    under_way = distributed.as_completed(first)
    try:
        for future in under_way:
            index = places.pop(future)
            result: R = future.result()
            # The worker may forget it, and the next one may begin.
            future.release()
            following = submit_next()
            if following is not None:
                under_way.add(following)
            yield index, result
            done += plan.bounds(index)[1]
            if tell is not None:
                tell(done / plan.n)
    finally:
        # Also after Ctrl-C or an error: what has not begun never does.
        client.cancel([*places, held])


def _check_workers(client: Any) -> None:
    """Refuse workers whose polhode is not the one here."""
    here = build()
    for worker, there in client.run(_build_of_worker).items():
        if tuple(there) != here:
            raise RuntimeError(
                f"client: worker {worker} has {_name_build(there)} and this process {_name_build(here)}; "
                "the same package must be installed on all of them"
            )


def _build_of_worker() -> tuple[str, str]:
    return build()


def _name_build(found: tuple[str, str]) -> str:
    return f"polhode {found[0]} (core {found[1][:8]})"


def _serialize(task: Any) -> bytes:
    """Write the task, with functions of the user's own by value."""
    cloudpickle = require("cloudpickle", extra="cluster", purpose="client=")
    try:
        data: bytes = cloudpickle.dumps(task)
    except (TypeError, pickle.PicklingError) as error:
        raise TypeError(
            f"client: a function or a value of the ensemble cannot be sent to workers: {error}; make locks, "
            "open files and the like within the function that uses them"
        ) from error
    return data


def _deserialize(data: bytes, wanted: tuple[str, str]) -> Any:
    if build() != tuple(wanted):
        raise RuntimeError(
            f"this worker has {_name_build(build())} and the client {_name_build(wanted)}; "
            "the same package must be installed on all of them"
        )
    return pickle.loads(data)


def _run_task(task: Any, index: int) -> Any:
    return task(index)


R_co = TypeVar("R_co", covariant=True)


class Task(Protocol[R_co]):
    """The work on a chunk, as a value that can be sent to other processes."""

    @property
    def plan(self) -> Plan:
        """The ensemble."""

    def __call__(self, index: int, progress: Callable[[float], object] | None = None) -> R_co:
        """Do it."""


def chunks_here(
    task: Task[R_co], pending: Sequence[int], tell: Callable[[float], object] | None
) -> Iterator[tuple[int, R_co]]:
    """Run chunks in this process, in order.

    Parameters
    ----------
    task : callable
    pending : sequence of int
        The chunks.
    tell : callable or None
        Called with the fraction of all members of the ensemble that is done.

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
