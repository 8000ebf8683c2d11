"""Calls with hostile arguments: of every public callable, in processes that may die of them."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
import time
from pathlib import Path

import polhode
import pytest
from hostile_calls.valid import Call, all_calls
from places import IMPORTED

SEED = 20261122
PATIENCE = 30.0
"""Seconds that a call may take before it counts as one that hangs."""
CALLS = all_calls()


def hostile(seed: int, first: int, last: int, folder: Path) -> tuple[list[str], int]:
    """Make the calls in a worker, and in another one after each call that kills or hangs it."""
    environment = {**os.environ, "POLHODE_NUM_THREADS": "2", "RUST_BACKTRACE": "0"}
    environment["PYTHONPATH"] = os.pathsep.join([*IMPORTED, str(Path(polhode.__path__[0]).parent)])
    progress = folder / "progress"
    wrong: list[str] = []
    made = 0
    while first < last and len(wrong) < 100:
        progress.write_bytes(struct.pack("<q", first))
        command = [
            sys.executable,
            "-m",
            "hostile_calls.worker",
            str(seed),
            str(first),
            str(last),
            str(progress),
        ]
        with (folder / "out").open("w+") as out, (folder / "err").open("w+") as err:
            worker = subprocess.Popen(command, env=environment, stdout=out, stderr=err)
            at, since = first, time.monotonic()
            while worker.poll() is None:
                time.sleep(0.02)
                now = struct.unpack("<q", progress.read_bytes())[0]
                if now != at:
                    at, since = now, time.monotonic()
                elif time.monotonic() - since > PATIENCE:
                    worker.kill()
                    worker.wait()
                    wrong.append(f"seed {seed}, call {at} hangs")
            out.seek(0)
            err.seek(0)
            lines, tail = out.read().splitlines(), err.read()[-500:]
        at = struct.unpack("<q", progress.read_bytes())[0]
        ended = lines and lines[-1].startswith('{"counts"')
        wrong += lines[:-1] if ended else lines
        if ended:
            made += sum(json.loads(lines[-1])["counts"].values())
            break
        if f"seed {seed}, call {at} hangs" not in wrong:
            wrong.append(f"seed {seed}, call {at} killed the process ({worker.returncode}): {tail}")
        made += at + 1 - first
        first = at + 1
    return wrong, made


def check(seed: int, count: int, folder: Path) -> None:
    wrong, made = hostile(seed, 0, count, folder)
    assert not wrong, f"{len(wrong)} of {made} calls went wrong:\n" + "\n".join(wrong[:20])
    assert made == count


@pytest.mark.parametrize("call", CALLS, ids=lambda call: call.name)
def test_the_valid_calls_are_valid(call: Call) -> None:
    # Else a spoilt one would be refused for another reason than what was spoilt.
    for receiver in call.receivers or (None,):
        arguments = dict(call.arguments)
        placed = [arguments.pop(name) for name in list(arguments) if name in call.positional]
        first = [] if receiver is None else [receiver]
        call.function(*first, *placed, **arguments)


@pytest.mark.timeout(300)
def test_hostile_calls(tmp_path: Path) -> None:
    check(SEED, 2500, tmp_path)


@pytest.mark.long
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("part", range(10))
def test_more_hostile_calls(part: int, tmp_path: Path) -> None:
    check(SEED + 1 + part, 10_000, tmp_path)
