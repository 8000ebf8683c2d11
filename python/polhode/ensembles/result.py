"""An ensemble that is ready to run."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar

import numpy as np

from polhode import _core
from polhode._format import Argument, short
from polhode._optional import require
from polhode._progress import progress_bar
from polhode.ensembles.checkpoints import Checkpoint
from polhode.ensembles.cluster import chunks_here, chunks_of_client
from polhode.ensembles.merge_tree import BLOCK, nodes_of_chunk, tree_of
from polhode.ensembles.plan import bytes_of_member, coordinates, draws, layout
from polhode.ensembles.running import arrays_of_chunk
from polhode.ensembles.stores import NpzStore, ZarrStore, open_store
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray
    from xarray import Dataset

    from polhode._progress import Progress
    from polhode.ensembles.cluster import Task
    from polhode.ensembles.plan import Plan
    from polhode.ensembles.stores import Store
    from polhode.motion.trajectory import Trajectory
    from polhode.reductions import Reduction

__all__ = ["Ensemble", "Memory"]

R = TypeVar("R")
_STATE: Final = 120
"""Bytes of a state while it is integrated and handed over, beside the copies that are kept; measured."""
_MEMBER: Final = 500
_MOST_CHUNKS: Final = 2**24
"""Largest number of chunks whose numbers are kept in memory."""
_MADE: Final = 2000
"""Bytes of a body or a load that a member has for itself."""


class Memory(NamedTuple):
    """Approximate memory of an ensemble, in bytes.

    Attributes
    ----------
    worker : int
        While one chunk is run: on this machine, or on each thread of a worker.
    results : int
        Bytes of the results of all members, where ``compute`` keeps their states; 0 where they are reduced.
    """

    worker: int
    results: int

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False)
class _Work:
    """The work on a chunk."""

    plan: Plan
    function: Callable[..., Any]

    def __call__(self, index: int, progress: Callable[[float], object] | None = None) -> Any:
        return self.function(index=index, progress=progress)


@dataclass(frozen=True, eq=False, repr=False)
class Ensemble:
    """Many motions, the *members*, each with its own random numbers. Made by :func:`polhode.ensemble`.

    Nothing is simulated before :meth:`compute`, :meth:`to_zarr` or :meth:`to_npz` is called. All numbers are
    the same for any number of threads and workers, and for any order in which chunks are run.

    Attributes
    ----------
    plan : Plan
        Description of body, load, start and random numbers, which is sent to other processes.
    reduce : Reduction, mapping of str to Reduction or None
        Statistics that are kept in place of the states.
    client : distributed.Client or None
        Client of the dask cluster that runs the chunks; None for the threads of this machine.
    progress : bool, callable or None
        Whether a bar shows the progress, or a function of the fraction done.
    """

    plan: Plan
    reduce: Reduction | Mapping[str, Reduction] | None = None
    client: Any = None
    progress: Progress = None

    def __len__(self) -> int:
        """Count the members."""
        return self.plan.n

    def __repr__(self) -> str:
        plan = self.plan
        drawn = ", ".join(plan.draws()) or "nothing"
        kept = "reduced, " if self.reduce is not None else ""
        return (
            f"Ensemble({plan.n} members, {len(plan.t)} times, seed={plan.seed}, draws {drawn}, {kept}"
            f"{plan.chunks} chunk{'s'[: plan.chunks - 1]} of {min(plan.chunk, plan.n)}, "
            f"{_size(self.memory.worker)} a chunk)"
        )

    @property
    def memory(self) -> Memory:
        """Memory in bytes: of a chunk while it runs, and of the results of all members."""
        plan = self.plan
        kept = bytes_of_member(plan)
        rows = min(plan.chunk, plan.n)
        worker = min(rows, BLOCK) if self.reduce is not None else rows
        own = sum(any(draws(plan.recipe[place])) for place in ("body", "load"))
        each = 2 * kept + len(plan.t) * _STATE + _MEMBER + own * _MADE
        return Memory(worker * each, 0 if self.reduce is not None else plan.n * kept)

    def member(self, k: int) -> Trajectory:
        """Run one member.

        Parameters
        ----------
        k : int
            Number of the member, from 0 on.

        Returns
        -------
        Trajectory
            The motion of the member, with the same bits as in the ensemble.

        Raises
        ------
        PolhodeError
            If the numbers of the member make no body, or its integration fails.

        Examples
        --------
        >>> from polhode import RigidBody, distributions, ensemble
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> many = ensemble(body, [0, 10], distributions.normal((0, 0, 1), sigma=0.1), n=1000, seed=1)
        >>> many.member(999)
        Trajectory(2 times from 0 to 10)
        """
        plan = self.plan
        if isinstance(k, bool) or not isinstance(k, int | np.integer):
            raise TypeError(f"k: expected the number of a member, an integer, got {k!r}")
        k = int(k)
        if not 0 <= k < plan.n:
            raise IndexError(f"k: there are members 0 to {plan.n - 1}, got {k}")
        made = plan.inputs(k, 1).make_arguments(np.arange(1))
        for name, value in made.items():
            if isinstance(value, _core.RigidBody | _core.Load):
                made[name] = value[0] if value.shape else value
            elif isinstance(value, np.ndarray | list):
                made[name] = value[0]
        if made["states"]:
            made["states"] = {
                name: value[0] if value.ndim == 2 else value for name, value in made["states"].items()
            }
        body: _core.RigidBody = made.pop("body")
        return body.simulate(plan.t, **made, **plan.options)

    def compute(self, *, checkpoint: str | os.PathLike[str] | None = None) -> Any:
        """Run all members.

        Parameters
        ----------
        checkpoint : str or os.PathLike, optional
            A file for intermediate results of the reductions, which is written about every five seconds. If
            it exists, the run continues from it: only missing chunks are run, and the result has the same
            bits.

        Returns
        -------
        xarray.Dataset or object
            Without `reduce` the states: ``omega`` (member, time, axis), ``quaternion`` (member, time,
            quaternion_component), ``status`` (member), the states of the load, and the drawn numbers under
            the name of their argument. With `reduce` the result of the reduction, or a dict of results.

        Raises
        ------
        MemoryError
            If the states do not fit into the memory of this machine.
        FileFormatError
            For the file of another ensemble, of other reductions or of another version of polhode.
        """
        plan = self.plan
        if self.reduce is not None:
            self._check_chunk(may_be_done=checkpoint is not None)
            return self._reduce(None if checkpoint is None else Path(checkpoint))
        if checkpoint is not None:
            raise ValueError(
                "checkpoint: keeps reductions, and without reduce= states are kept; write these with "
                "to_zarr or to_npz, and go on with resume"
            )
        xarray = require("xarray", extra="cluster", purpose="Ensemble.compute")
        arrays = self.to_numpy()
        found: Dataset = xarray.Dataset(
            {name: (one.dims, arrays[name], one.attributes) for name, one in layout(plan).items()},
            coordinates(plan),
            {"seed": plan.seed, "n": plan.n, "chunk": plan.chunk, "version": _core.__version__},
        )
        return found

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Run all members, and return their states as arrays; needs NumPy alone.

        Returns
        -------
        dict of str and numpy.ndarray
            The arrays of :meth:`compute` by name: ``omega``, shape (n, T, 3); ``quaternion``, shape
            (n, T, 4); ``status``, shape (n,); the states of the load, and the drawn numbers.

        Raises
        ------
        MemoryError
            If the states do not fit into the memory of this machine.

        Examples
        --------
        >>> from polhode import RigidBody, distributions, ensemble
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> many = ensemble(body, [0, 10], distributions.normal((0, 0, 1), sigma=0.1), n=1000, seed=1)
        >>> many.to_numpy()["quaternion"].shape
        (1000, 2, 4)
        """
        plan = self.plan
        if self.reduce is not None:
            raise ValueError(
                "to_numpy: returns states, and with reduce= none are kept; call compute, or leave it out"
            )
        _check_room(self.memory.results, plan.n)
        self._check_chunk(may_be_done=False)
        arrays = {name: np.empty((plan.n, *one.tail), one.dtype) for name, one in layout(plan).items()}
        for index, chunk in self._run_chunks(partial(arrays_of_chunk, plan), range(plan.chunks)):
            first, count = plan.bounds(index)
            for name, array in arrays.items():
                array[first : first + count] = chunk[name]
        return arrays

    def to_zarr(self, path: str | os.PathLike[str]) -> None:
        """Run all members and write their states, a chunk at a time, to a zarr group; needs zarr.

        Parameters
        ----------
        path : str or os.PathLike
            Name of a new directory. ``xarray.open_zarr(path)`` reads it.

        Raises
        ------
        FileExistsError
            If it exists already; :meth:`resume` continues it.
        """
        self._check_states("to_zarr")
        self._fill(ZarrStore(Path(path), self.plan, is_new=True))

    def to_npz(self, path: str | os.PathLike[str]) -> None:
        """Run all members and write their states, a chunk at a time, to files that NumPy reads.

        Parameters
        ----------
        path : str or os.PathLike
            Name of a new directory: ``chunk-00000000.npz`` and so on, with the arrays of :meth:`compute`,
            beside ``ensemble.json``, which tells what ensemble it is.

        Raises
        ------
        FileExistsError
            If it exists already; :meth:`resume` continues it.
        """
        self._check_states("to_npz")
        self._fill(NpzStore(Path(path), self.plan, is_new=True))

    def resume(self, path: str | os.PathLike[str]) -> None:
        """Run the missing chunks of a :meth:`to_zarr` or :meth:`to_npz` that was interrupted.

        Files that the interrupted process had half written are removed. No other process may write there at
        the same time.

        Parameters
        ----------
        path : str or os.PathLike

        Raises
        ------
        FileFormatError
            If the files belong to another ensemble: another seed, size, chunk or version of polhode, or other
            inputs.
        """
        self._check_states("resume")
        self._fill(open_store(Path(path), self.plan))

    def _check_states(self, what: str) -> None:
        if self.reduce is not None:
            raise ValueError(
                f"{what}: writes states, and with reduce= none are kept; call compute, or leave it out"
            )
        self._check_chunk(may_be_done=True)

    def _check_chunk(self, *, may_be_done: bool) -> None:
        """Refuse chunks that this machine has no memory for, before any of them is run."""
        plan = self.plan
        if may_be_done and plan.chunks > _MOST_CHUNKS:
            raise PolhodeError(
                Argument("chunk"),
                f": {plan.n} members in chunks of {plan.chunk} are {plan.chunks} chunks, more than "
                f"{_MOST_CHUNKS}; give ",
                Argument("chunk", -(-plan.n // (_MOST_CHUNKS * BLOCK)) * BLOCK),
                " or more",
            )
        needed, room = self.memory.worker, _room()
        if self.client is None and room is not None and needed > room:
            raise MemoryError(
                f"chunk: {plan.chunk} members together take {_size(needed)} and this "
                f"machine has {_size(room)}; give a smaller chunk=, or ask for fewer times"
            )

    def _fill(self, store: Store) -> None:
        for index, arrays in self._run_chunks(partial(arrays_of_chunk, self.plan), store.pending()):
            store.write(index, arrays)

    def _reduce(self, path: Path | None) -> Any:
        named: dict[str, Any] = self.reduce if isinstance(self.reduce, dict) else {"": self.reduce}
        reductions = tuple(named.values())
        tree = tree_of(self.plan, reductions)
        work = partial(nodes_of_chunk, self.plan, reductions)
        kept = None if path is None else Checkpoint(path, self.plan, named, tree)
        try:
            for index, nodes in self._run_chunks(
                work, range(self.plan.chunks) if kept is None else kept.pending()
            ):
                for place, state in nodes.items():
                    tree.add(place, state)
                if kept is not None:
                    kept.add(index)
        finally:
            if kept is not None:
                kept.close()
        parts, left_out = tree.root
        found = {
            name: reduction.finish(part, left_out)
            for (name, reduction), part in zip(named.items(), parts, strict=True)
        }
        return found if isinstance(self.reduce, dict) else found[""]

    def _run_chunks(self, function: Callable[..., R], pending: Sequence[int]) -> Iterator[tuple[int, R]]:
        task: Task[R] = _Work(self.plan, function)
        with progress_bar(f"{self.plan.n} members", self.progress) as tell:
            if self.client is None:
                yield from chunks_here(task, pending, tell)
            else:
                yield from chunks_of_client(self.client, task, pending, tell)


def _check_room(needed: int, n: int) -> None:
    """Refuse an ensemble that needs more memory than the machine has, before it is computed."""
    room = _room()
    if room is not None and needed > room:
        raise MemoryError(
            f"compute: the states of {n} members take {_size(needed)} and this machine has {_size(room)}; "
            "write them with to_zarr or to_npz, ask for fewer times, or give reduce="
        )


def _room() -> int | None:
    """Return the memory of this machine; None if the system does not report it."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None


def _size(count: int) -> str:
    return f"{count / 1e9:.3g} GB" if count >= 10**9 else f"{count / 1e6:.3g} MB"
