"""What a cluster costs: ``python benchmarks/cluster.py [SECONDS] [--rounds N] [--chunk MEMBERS]``.

An ensemble of clones past the Earth, reduced, by two threads of this process and by two workers of one thread
each, in turns of about so many seconds; the workers are up before. The seconds of processors decide, of all
processes together: what else runs on the machine changes them little.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from typing import TYPE_CHECKING, Any

if __name__ == "__main__":
    os.environ["POLHODE_NUM_THREADS"] = "2"

import numpy as np
from polhode import RigidBody, distributions, ensemble, loads, orbits, reductions

if TYPE_CHECKING:
    from collections.abc import Callable

HOUR, DAY = 3600.0, 86400.0
SPAN = 6 * DAY
MOST = 0.05
BLOCK = 4096


def clones(n: int, chunk: int, client: Any = None) -> Any:
    """Apophis in 2029, its moments and its spin uncertain, all attitudes as likely."""
    orbit = orbits.from_elements(
        398600.4418, eccentricity=4.253901873, periapsis=38011.486, since_periapsis=-SPAN / 2
    )
    moments = distributions.normal((0.64, 0.97, 1.0), sigma=(0.012, 0.008, 0.008))
    return ensemble(
        distributions.apply(RigidBody.from_principal, 1.0, moments),
        [0.0, SPAN],
        distributions.normal(np.array((0.09, 0.03, 0.19)) / HOUR, sigma=0.01 / HOUR),
        distributions.uniform_rotation(),
        loads.gravity_gradient(orbit),
        n=n,
        seed=2029,
        chunk=chunk,
        rtol=1e-12,
        reduce={
            "spin": reductions.covariance(lambda motion: motion.omega[:, -1]),
            "modes": reductions.mode_changes(),
            "speed": reductions.histogram(
                np.linspace(0.0, 0.5 / HOUR, 50), lambda motion: np.linalg.norm(motion.omega[:, -1], axis=1)
            ),
        },
        client=client,
        progress=False,
    )


def same(ours: Any, theirs: Any) -> None:
    """To the last bit."""
    for name in ours:
        for one, other in zip(arrays(ours[name]), arrays(theirs[name]), strict=True):
            assert one.tobytes() == other.tobytes(), name


def arrays(result: Any) -> list[Any]:
    """The numbers of a result."""
    return [np.asarray(value) for value in result]


def processors() -> float:
    """Seconds that this process and those that it started have computed."""
    import psutil

    here = psutil.Process()
    return sum(sum(one.cpu_times()[:2]) for one in (here, *here.children(recursive=True)))


def timed(run: Callable[[], Any]) -> tuple[float, float, Any]:
    """Seconds by the clock, those of processors, and the result."""
    start, computed = time.perf_counter(), processors()
    found = run()
    return time.perf_counter() - start, processors() - computed, found


def main() -> None:
    """Take turns."""
    from dask.distributed import Client, LocalCluster

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("seconds", nargs="?", type=float, default=60.0, help="of a turn, on two free cores")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--chunk", type=int, default=BLOCK)
    options = parser.parse_args()
    with (
        LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            dashboard_address=":0",
            host="127.0.0.1",
            env={"POLHODE_NUM_THREADS": "1"},
        ) as cluster,
        Client(cluster) as client,
    ):
        few = 16 * BLOCK
        _, computed, here = timed(clones(few, BLOCK).compute)
        same(here, clones(few, BLOCK, client).compute())
        n = max(round(2 * options.seconds / computed * few / BLOCK), 1) * BLOCK
        print(f"{n} clones, chunks of {options.chunk}; the bits of {few} are the same", flush=True)
        ratios = []
        for _ in range(options.rounds):
            wall, alone, here = timed(clones(n, options.chunk).compute)
            wall_there, there, found = timed(clones(n, options.chunk, client).compute)
            same(here, found)
            ratios.append(there / alone - 1.0)
            print(
                f"two threads {wall:.1f} s, of processors {alone:.1f} s; two workers {wall_there:.1f} s, of "
                f"processors with client and scheduler {there:.1f} s: {100 * ratios[-1]:+.1f} %",
                flush=True,
            )
    middle = statistics.median(ratios)
    verdict = "met" if middle <= MOST else "NOT MET"
    print(f"overhead {100 * middle:+.1f} %, bar {100 * MOST:g} %: {verdict}")


if __name__ == "__main__":
    main()
