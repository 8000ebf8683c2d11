"""Two threads beside one, in two processes that take turns; and how a plain sum scales in the same rounds.

Where the plain sum does not gain, the machine has no second core or no memory bandwidth to spare.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from harness import Row

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

COUNT = 10_000_000

WORKER = """
import hashlib, sys
from concurrent.futures import ThreadPoolExecutor
import numpy as np
from meshes import globe
from polhode import MassAccumulator, RigidBody

threads, count = map(int, sys.argv[1:])
pool = ThreadPoolExecutor(threads)
rng = np.random.default_rng(1)
masses, positions = rng.uniform(0.5, 1.0, count), rng.normal(size=(count, 3))
thin = positions * [1.0, 1e-3, 1e-3]
density = rng.uniform(size=(256, 256, 256)).astype(np.float32)
atoms = 20
small = masses.reshape(-1, atoms)[:100_000], positions.reshape(-1, atoms, 3)[:100_000]
ball = globe(708, 707)

def stream():
    particles = MassAccumulator()
    particles.add(masses, positions)
    return particles.finish()

def plain():
    parts = np.array_split(masses, threads) + np.array_split(positions, threads)
    list(pool.map(np.sum, parts))

tasks = {
    "sum": plain,
    "particles": lambda: RigidBody.from_particles(masses, positions),
    "thin": lambda: RigidBody.from_particles(masses, thin),
    "stream": stream,
    "stack": lambda: RigidBody.from_particles(*small),
    "voxels": lambda: RigidBody.from_voxels(density, 1.0),
    "mesh": lambda: RigidBody.from_mesh(*ball, density=1.0),
}
for line in sys.stdin:
    body = tasks[line.strip()]()
    numbers = b"" if body is None else body.inertia.tobytes() + body.principal.axes.tobytes()
    print(hashlib.sha256(numbers).hexdigest(), flush=True)
"""


class Worker:
    """A process with its own number of threads: does a task when told to and answers with a digest."""

    def __init__(self, threads: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", WORKER, str(threads), str(COUNT)],
            env={**os.environ, "POLHODE_NUM_THREADS": str(threads), "PYTHONPATH": str(Path(__file__).parent)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def task(self, name: str) -> Callable[[], str]:
        """Return the call that does the task."""

        def run() -> str:
            assert self.process.stdin
            assert self.process.stdout
            self.process.stdin.write(f"{name}\n")
            self.process.stdin.flush()
            return self.process.stdout.readline()

        return run


def same_bits(ours: str, theirs: str) -> None:
    """The digests agree."""
    assert ours
    assert ours == theirs


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    two, one = Worker(2), Worker(1)
    try:
        for name, task, bar in (
            ("a plain sum over 1e7 particles", "sum", None),
            ("inertia of 1e7 particles", "particles", 1.7),
            ("a thin body of 1e7 particles", "thin", 1.7),
            ("1e7 particles through a stream", "stream", 1.7),
            ("1e5 bodies x 20 particles", "stack", 1.7),
            ("256^3 voxels, float32", "voxels", 1.7),
            ("checked solid, 1e6 triangles", "mesh", 1.7),
        ):
            yield Row(
                name=f"{name}, two threads",
                peer="one thread",
                ours=two.task(task),
                theirs=one.task(task),
                compare=same_bits,
                at_least=bar,
            )
    finally:
        for worker in (two, one):
            worker.process.kill()
            worker.process.wait()
