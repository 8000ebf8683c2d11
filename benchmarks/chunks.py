"""Particles in generated chunks of dask: two workers beside two threads of one process.

``python benchmarks/chunks.py [PARTICLES]`` (by default 1e8) tells seconds, and the memory of all processes
above what they have when nothing runs. Each side generates the same numbers, which takes most of the time.
"""

from __future__ import annotations

import argparse
import os
import threading
import time
from functools import cache
from typing import TYPE_CHECKING, Any

if __name__ == "__main__":
    os.environ.setdefault("POLHODE_NUM_THREADS", "1")

import numpy as np
from harness import Row
from polhode import RigidBody

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

CHUNK = 1 << 22
COUNT = 8 * CHUNK


def generated(count: int, tail: tuple[int, ...], block_id: tuple[int, ...]) -> Any:
    """A chunk: its numbers depend on its place alone."""
    size = min(CHUNK, count - block_id[0] * CHUNK)
    return np.random.Generator(np.random.SFC64([len(tail), block_id[0]])).random((size, *tail))


def particles(count: int) -> tuple[Any, Any]:
    """Masses and positions that nobody holds as a whole."""
    import dask.array as da

    cuts = (CHUNK,) * (count // CHUNK) + (() if count % CHUNK == 0 else (count % CHUNK,))
    masses = da.map_blocks(generated, count, (), chunks=(cuts,), dtype=float)
    positions = da.map_blocks(generated, count, (3,), chunks=(cuts, (3,)), dtype=float)
    return masses, positions


def by_threads(count: int = COUNT) -> RigidBody:
    """One process, two threads of dask."""
    import dask

    with dask.config.set(scheduler="threads", num_workers=2):
        return RigidBody.from_particles(*particles(count))


def by_workers(count: int = COUNT) -> RigidBody:
    """Two processes of one thread each, which go on running."""
    client = workers()
    with client.as_current():
        return RigidBody.from_particles(*particles(count))


@cache
def workers() -> Any:
    """The client of the two."""
    from dask.distributed import Client, LocalCluster

    return Client(LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", host="127.0.0.1"))


def same(ours: RigidBody, theirs: RigidBody) -> None:
    """To the last bit."""
    assert ours == theirs


def rows() -> Iterator[Row]:
    """Yield the comparison of this file."""
    yield Row(
        name=f"{COUNT:.0e} particles in generated chunks, two workers",
        peer="polhode: two threads of dask",
        ours=by_workers,
        theirs=by_threads,
        compare=same,
        items=COUNT,
        at_most=1.2,
    )


def memory() -> int:
    """Bytes of this process and those that it started."""
    import psutil

    here = psutil.Process()
    return sum(one.memory_info().rss for one in (here, *here.children(recursive=True)))


def processors() -> float:
    """Seconds that the same processes have computed, which others on the machine change little."""
    import psutil

    here = psutil.Process()
    return sum(sum(one.cpu_times()[:2]) for one in (here, *here.children(recursive=True)))


def watched(run: Callable[[], RigidBody]) -> tuple[float, float, float, RigidBody]:
    """Seconds, those of processors, and the most bytes above those before."""
    idle, most, done = memory(), 0, threading.Event()

    def watch() -> None:
        nonlocal most
        while not done.wait(0.05):
            most = max(most, memory() - idle)

    watcher = threading.Thread(target=watch)
    watcher.start()
    start, computed = time.perf_counter(), processors()
    body = run()
    seconds, computed = time.perf_counter() - start, processors() - computed
    done.set()
    watcher.join()
    return seconds, computed, most / 1e9, body


def main() -> None:
    """Measure once each, the workers up before."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("particles", nargs="?", type=float, default=1e8)
    count = int(parser.parse_args().particles)
    by_workers(4 * CHUNK), by_threads(4 * CHUNK)
    found = {}
    for name, run in (("two threads", by_threads), ("two workers", by_workers)):
        seconds, computed, gigabytes, found[name] = watched(lambda run=run: run(count))
        told = f"{seconds:.1f} s, {computed:.1f} s of processors, {gigabytes:.2f} GB above idle"
        print(f"{count:.0e} particles, {name}: {told}", flush=True)
    same(*found.values())


if __name__ == "__main__":
    main()
