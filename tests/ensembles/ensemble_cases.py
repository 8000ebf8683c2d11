"""Ensembles that several files of tests run; as a program, one that is written until somebody kills it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polhode
from polhode import RigidBody, distributions, loads, reductions

TESTS = Path(__file__).parent
BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
SPIN = distributions.normal((0.2, 0.1, 1.0), [[0.04, 0.01, 0.0], [0.01, 0.04, 0.0], [0.0, 0.0, 0.01]])
TIMES = (0.0, 1.5, 4.0)


def twisted(n: int = 300, *, t: Any = TIMES, seed: int = 5, **options: Any) -> polhode.Ensemble:
    """Bodies, starts and loads that are all drawn; a few bodies break the triangle inequality."""
    bodies = distributions.apply(
        RigidBody.from_principal, 1.0, distributions.normal((1.0, 2.0, 2.9), sigma=0.04)
    )
    twist = distributions.apply(loads.constant_torque, distributions.normal((0.0, 0.1, 0.0), sigma=0.1))
    return polhode.ensemble(
        bodies, t, SPIN, distributions.uniform_rotation(), twist, n=n, seed=seed, **options
    )


def pushed(n: int, *, t: Any, seed: int = 5, **options: Any) -> polhode.Ensemble:
    """One body with starts that are drawn: many members cost little."""
    twist = loads.constant_torque((0.0, 0.1, 0.0))
    return polhode.ensemble(BODY, t, SPIN, distributions.uniform_rotation(), twist, n=n, seed=seed, **options)


def last_spin(motion: polhode.Trajectory) -> Any:
    """The angular velocity at the end; a function that every process can import or unpickle."""
    return motion.omega[:, -1]


def all_reductions() -> dict[str, reductions.Reduction]:
    """One of each."""
    return {
        "mean": reductions.mean("omega"),
        "covariance": reductions.covariance(last_spin),
        "histogram": reductions.histogram(np.linspace(-1.0, 2.0, 31), last_spin),
        "quantiles": reductions.quantiles((0.0, 0.05, 0.5, 1.0), last_spin),
        "modes": reductions.mode_changes(),
    }


def all_bytes(result: Any) -> bytes:
    """All bits of a dataset or of results of reductions."""
    if isinstance(result, dict):
        return b"".join(all_bytes(result[name]) for name in sorted(result))
    if isinstance(result, tuple):
        return b"".join(np.asarray(part).tobytes() for part in result)
    return b"".join(np.asarray(result[name]).tobytes() for name in sorted(map(str, result.variables)))


def slow(**options: Any) -> polhode.Ensemble:
    """Twenty chunks that take some hundredths of a second each."""
    return twisted(1200, t=(0.0, 80.0), chunk=60, **options)


def python(code: str, **environment: str) -> str:
    """What a program prints that runs beside the tests, in an environment."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
        cwd=TESTS,
        env=os.environ | environment,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


if __name__ == "__main__":
    kind, path = sys.argv[1:]
    getattr(slow(), f"to_{kind}")(path)
