"""Long runs of the core show how far they are on a terminal, and nothing in a pipe."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pty = pytest.importorskip("pty")

PROGRAM = """
import time
from polhode import RigidBody, loads

def torque(t, omega, quaternion):
    time.sleep(0.01)
    return 0.0 * omega

body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
body.simulate([0, {end}], (0.1, 1.0, 0.3), load=loads.torque_callback(torque))
"""


def on_a_terminal(end: float) -> bytes:
    """What a run writes on a terminal."""
    outer, inner = pty.openpty()
    with subprocess.Popen([sys.executable, "-c", PROGRAM.format(end=end)], stderr=inner) as process:
        os.close(inner)
        written = b""
        while True:
            try:
                part = os.read(outer, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            written += part
    os.close(outer)
    assert process.returncode == 0
    return written


def test_on_a_terminal() -> None:
    written = on_a_terminal(9.0)
    assert b"polhode [" in written
    assert b"left" in written
    assert written.endswith(b"\r")


def test_a_short_run_is_silent() -> None:
    assert on_a_terminal(0.5) == b""


def test_in_a_pipe() -> None:
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(end=9.0)], capture_output=True, check=True, timeout=60
    )
    assert run.stderr == b""
