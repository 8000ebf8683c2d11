"""Particles that are not in memory, summed a piece at a time: here, or where dask computes them."""

from __future__ import annotations

import re
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._core import MassAccumulator
from polhode._elsewhere.kinds import check_sizes, dask_array, in_memory, is_stored
from polhode._extras import require
from polhode._progress import watched
from polhode.ensembles.fingerprint import build

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["summed"]

_PIECE: Final = 1 << 18
"""Particles that are read at a time, 8 MB; a multiple of the blocks by which the core sums."""
_AT_ONCE: Final = 32
"""Sums that are merged by one task."""
_ROW: Final = re.compile(r"(?<=\bmasses\[)\d+|(?<=the element at \()\d+")
"""A row in an error of the core."""


def summed(masses: Any, positions: Any, start: int) -> MassAccumulator | None:
    """Sum the particles of one body.

    Parameters
    ----------
    masses, positions : array_like, shapes (n,) and (n, 3)
    start : int
        The number of the first of them.

    Returns
    -------
    MassAccumulator or None
        None where both are in memory, or are a stack of bodies.
    """
    by_dask = dask_array(masses) is not None or dask_array(positions) is not None
    if not by_dask and not is_stored(masses) and not is_stored(positions):
        return None
    if np.ndim(masses) != 1 or np.ndim(positions) != 2:
        return None
    _check(masses, positions)
    return (_by_dask if by_dask else _in_pieces)(masses, positions, start)


def _check(masses: Any, positions: Any) -> None:
    """Refuse shapes that make no particles, before anything is read."""
    for name, array in (("masses", masses), ("positions", positions)):
        check_sizes(array, name)
    (n,), (m, *axes) = np.shape(masses), np.shape(positions)
    if axes != [3]:
        raise ValueError(f"positions: expected shape (n, 3), got {np.shape(positions)}")
    if n != m:
        raise ValueError(f"masses and positions: expected shapes (n) and (n, 3), got n = {n} and n = {m}")


def _in_pieces(masses: Any, positions: Any, start: int) -> MassAccumulator:
    """Sum what files hold, by pieces that end where the core's blocks end."""
    total, count = MassAccumulator(), np.shape(masses)[0]
    first = 0
    with watched(f"{count} particles") as tell:
        while first < count:
            end = min(first + _PIECE - (start + first) % _PIECE, count)
            total.merge(_part(masses[first:end], positions[first:end], start, first))
            first = end
            if tell is not None:
                tell(end / count)
    return total


def _by_dask(masses: Any, positions: Any, start: int) -> MassAccumulator:
    """Sum chunks where dask computes them, and merge the sums pairwise."""
    dask, da, layers = (
        require(module, extra="cluster", purpose="particles of dask arrays")
        for module in ("dask", "dask.array", "dask.layers")
    )
    known = dask_array(positions)
    if known is None:
        known = dask_array(masses)
    cuts = known.chunks[0]
    arrays = []
    for given, chunks in ((masses, (cuts,)), (positions, (cuts, (3,)))):
        found = dask_array(given)
        # Rows that come from one array of dask are computed once for both.
        arrays.append(da.from_array(given, chunks=chunks) if found is None else found.rechunk(chunks))
    # An array of one sum for each chunk, so that dask makes a chunk and sums it in one task.
    sums = da.blockwise(
        _placed, "ij", arrays[0], "i", arrays[1], "ij", layers.ArraySliceDep((cuts,)), "i",
        first=start, wanted=build(), align_arrays=False, adjust_chunks={"i": 1, "j": 1}, dtype=object,
        meta=np.empty((0, 0), dtype=object),
    )  # fmt: skip
    nodes = sums.to_delayed().ravel().tolist()
    merge = dask.delayed(_merged, pure=False)
    while len(nodes) > 1:
        nodes = [merge(nodes[first : first + _AT_ONCE]) for first in range(0, len(nodes), _AT_ONCE)]
    with _told(f"{sum(cuts)} particles", len(cuts)):
        total: MassAccumulator = nodes[0].compute().item()
    return total


def _placed(masses: Any, positions: Any, place: Any, *, first: int, wanted: tuple[str, str]) -> Any:
    """Sum a chunk, on whatever machine it is."""
    if build() != tuple(wanted):
        raise RuntimeError(
            f"this worker has polhode {build()[0]} (core {build()[1][:8]}) and the client polhode "
            f"{wanted[0]} (core {wanted[1][:8]}); the same package must be installed on all of them"
        )
    return _boxed(_part(masses, positions, first, place[0].start))


def _part(masses: Any, positions: Any, start: int, row: int) -> MassAccumulator:
    """Sum some rows, from `row` on; errors tell which of all they are."""
    part, first = MassAccumulator(), start + row
    try:
        part.add(in_memory(masses), in_memory(positions), start=first)
    except ValueError as error:
        told = _ROW.sub(lambda found: str(row + int(found[0])), str(error))
        raise type(error)(f"particles {first} to {first + len(masses) - 1}: {told}") from None
    return part


def _boxed(part: MassAccumulator) -> Any:
    box = np.empty((1, 1), dtype=object)
    box[0, 0] = part
    return box


def _merged(boxes: list[Any]) -> Any:
    """Merge sums into a new one: those of a task that is done again must be as they were."""
    total = MassAccumulator()
    for box in boxes:
        total.merge(box.item())
    return _boxed(total)


@contextmanager
def _told(what: str, chunks: int) -> Iterator[None]:
    """Show a bar while dask's own schedulers compute here; a cluster has its own."""
    callbacks = require("dask.callbacks", extra="cluster", purpose="particles of dask arrays")
    with ExitStack() as stack:
        tell = stack.enter_context(watched(what))
        if tell is not None:
            done = 0

            def count(*_: Any) -> None:
                nonlocal done
                done += 1
                tell(min(done / chunks, 1.0))

            stack.enter_context(callbacks.Callback(posttask=count))
        yield
