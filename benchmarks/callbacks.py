"""Loads that are functions: Python ones beside a bare loop of their calls, compiled beside Python ones."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody, loads

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

# The weight of a top about its point, as its owner would write it, and the same in C.
SOURCE = """
void weight(double t, const double *s, double *out, void *user_data) {
    out[3] = 20.0 * 2 * (s[1] * s[2] + s[0] * s[3]);
    out[4] = -20.0 * 2 * (s[0] * s[2] - s[1] * s[3]);
}
"""
TOP = RigidBody.from_principal(1.0, (2.0, 2.0, 1.0))
START, END, OPTIONS = (0.5, 0.2, 30.0), 20.0, {"about": "origin", "rtol": 1e-11}


def weight(_t: float, _omega: Any, quaternion: Any) -> Any:
    """Torque of the weight, m g l = 20."""
    x, y, z, w = quaternion
    return 40.0 * (y * z + x * w), -40.0 * (x * z - y * w), 0.0


def pull(_t: float, _omega: Any, _quaternion: Any, position: Any, velocity: Any) -> Any:
    """A damped spring, and no torque."""
    return -position - 0.1 * velocity, (0.0, 0.0, 0.0)


def bare(function: Callable[..., Any], count: int, *sizes: int) -> None:
    """Build the same arrays, call, convert what comes back, as often."""
    values = [tuple(float(i) for i in range(size)) for size in sizes]
    for _ in range(count):
        returned = function(0.0, *(np.array(value) for value in values))
        if len(returned) == 2:
            np.asarray(returned[0], dtype=float), np.asarray(returned[1], dtype=float)
        else:
            np.asarray(returned, dtype=float)


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    torque, force = loads.torque_callback(weight), loads.callback(pull)

    def top(load: loads.Load) -> Any:
        return TOP.simulate([0.0, END], START, load=load, method="dop853", **OPTIONS)

    def spring() -> Any:
        return TOP.simulate([0.0, 4 * END], START, load=force, position=(1.0, 0.0, 0.0), rtol=1e-11)

    calls = int(top(torque).evaluations)
    yield Row(
        name="torque of a Python function, DOP853",
        peer="bare loop of the calls",
        ours=lambda: top(torque),
        theirs=lambda: bare(weight, calls, 3, 4),
        compare=lambda *_: None,
        items=calls,
        at_most=1.5,
    )
    pulls = int(spring().evaluations)
    yield Row(
        name="force and torque of a Python function, DOP853",
        peer="bare loop of the calls",
        ours=spring,
        theirs=lambda: bare(pull, pulls, 3, 4, 3, 3),
        compare=lambda *_: None,
        items=pulls,
        at_most=1.5,
    )
    compiler = shutil.which("cc")
    if compiler is None:
        return
    folder = Path(tempfile.mkdtemp())
    source, library = folder / "weight.c", folder / "weight.so"
    source.write_text(SOURCE)
    subprocess.run([compiler, "-O2", "-shared", "-fPIC", "-o", str(library), str(source)], check=True)
    function = ctypes.CDLL(str(library)).weight
    compiled = loads.compiled(ctypes.cast(function, ctypes.c_void_p).value)

    def same_motion(ours: Any, theirs: Any) -> None:
        assert np.abs(ours.omega - theirs.omega).max() < 1e-9 * np.abs(theirs.omega).max()

    yield Row(
        name="torque of a compiled function, DOP853",
        peer="the Python function",
        ours=lambda: top(compiled),
        theirs=lambda: top(torque),
        compare=same_motion,
        items=calls,
        at_least=30,
    )
