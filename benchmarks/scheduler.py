"""What chunks cost the scheduler of dask: ``python benchmarks/scheduler.py [CHUNKS ...] [--bytes N]``.

Chunks that do nothing go the way that all do, to two workers of this machine; the scheduler runs in the
process that asks. Each gives as many bytes as ``--bytes`` says, as the states of reductions would be.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import psutil
from polhode import RigidBody, ensemble
from polhode.ensembles.cluster import chunks_of_client
from polhode.ensembles.merge_tree import BLOCK


@dataclass(frozen=True)
class Empty:
    """What is done with a chunk: nothing."""

    plan: Any
    size: int

    def __call__(self, index: int, progress: Any = None) -> bytes:  # noqa: ARG002
        return bytes(self.size)


def flood(client: Any, chunks: int, size: int) -> None:
    """Return what so many chunks cost."""
    plan = ensemble(
        RigidBody.from_principal(1.0, (1, 2, 2.5)), [0.0], (0, 0, 1), n=chunks * BLOCK, seed=1
    ).plan
    here = psutil.Process()
    memory, processor, start = here.memory_info().rss, sum(here.cpu_times()[:2]), time.perf_counter()
    most = 0
    for done, _ in enumerate(chunks_of_client(client, Empty(plan, size), range(chunks), None)):
        if done % 100 == 0:
            most = max(most, here.memory_info().rss - memory)
    seconds, processor = time.perf_counter() - start, sum(here.cpu_times()[:2]) - processor
    print(
        f"{chunks} chunks of {size} bytes: {1e3 * seconds / chunks:.2f} ms each, of which client and "
        f"scheduler compute {1e3 * processor / chunks:.2f} ms; {most / 1e6:.1f} MB more, "
        f"{most / chunks / 1e3:.2f} kB each; {here.memory_info().rss / 1e6:.0f} MB in all",
        flush=True,
    )


def main() -> None:
    """Flood it with more and more."""
    from dask.distributed import Client, LocalCluster

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("chunks", nargs="*", type=int, default=[2000, 8000, 32000])
    parser.add_argument("--bytes", type=int, default=2000, dest="size", help="of the result of a chunk")
    options = parser.parse_args()
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0", host="127.0.0.1") as cluster,
        Client(cluster) as client,
    ):
        for chunks in options.chunks:
            flood(client, chunks, options.size)


if __name__ == "__main__":
    main()
