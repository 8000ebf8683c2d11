"""Ctrl-C ends every call within a fifth of a second, whatever the size of its arguments."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

#: What Ctrl-C may take, in seconds.
BAR = 0.2

# Processor time is measured: beside three busy processes on two cores the longest was half of the bar.
pytestmark = pytest.mark.skipif(
    not hasattr(signal, "setitimer"), reason="this system has no timers of processor time"
)


def struck(delays: list[float], threads: int, *names: str) -> dict[str, float | None]:
    """Strike all calls in a process of its own, with so many threads."""
    script = Path(__file__).with_name("interrupted.py")
    run = subprocess.run(
        [sys.executable, str(script), json.dumps(delays), *names],
        env=os.environ | {"POLHODE_NUM_THREADS": str(threads)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return dict(json.loads(line) for line in run.stdout.splitlines())


def check(latencies: dict[str, float | None], bar: float) -> None:
    late = {name: taken for name, taken in latencies.items() if taken is not None and taken > bar}
    assert not late, late
    over = [name for name, taken in latencies.items() if taken is None]
    assert len(over) < len(latencies) / 5, f"these were over before they were struck: {over}"


def test_ctrl_c_ends_every_call() -> None:
    check(struck([0.1], threads=1), BAR)


def test_ctrl_c_ends_what_runs_on_two_threads() -> None:
    """The processor time of both counts: twice the bar."""
    names = [
        "RigidBody",
        "free_motion",
        "many times",
        "taylor runs",
        "dop853 runs",
        "from_mesh",
        "from_surface",
    ]
    check(struck([0.2], 2, *names), 2.0 * BAR)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_ctrl_c_ends_every_call_at_any_time() -> None:
    check(struck([0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.3], threads=1), BAR)
