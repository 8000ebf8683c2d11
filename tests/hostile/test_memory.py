"""Results larger than memory are refused before anything of them is touched."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from absurd import OTHERS, ROWS
from places import IMPORTED
from polhode import RigidBody, _core

#: Callables without an argument whose size the caller chooses: functions, and properties of what exists.
SIZELESS = {
    "Gyrostat.equilibria",
    "callback",
    "compiled",
    "labelled_voxels",
    "machine",
    "read_plates",
    "read_stl",
    "region_ball",
    "region_box",
    "region_cylinder",
    "region_ellipsoid",
    "stream_solid",
    "to_log_cholesky",
    "to_parameters",
    "to_positive_products",
    "to_pseudo_inertia",
    "to_spatial_inertia",
    "torque_callback",
    "Contact",
    "Stepper",
    "VaryingBody",
    "Surface",
    "rolling_critical_rate",
    "rolling_modes",
    "rolling_plane",
    "rolling_steady",
    "rolling_tippe_top",
    "surface_disk",
    "surface_ellipsoid",
    "surface_paraboloid",
    "surface_sphere",
    "surface_torus",
    "RuledSurface",
    "ruled_cone",
    "ruled_cylinder",
    "attitudes",
    "impulses",
    "rates",
    "white_noise",
    "RigidBody.combined",
    "RigidBody.cut",
    "RigidBody.equimomental_particles",
    "RigidBody.from_atoms",
    "RigidBody.from_file",
    "RigidBody.from_mesh_object",
    "RigidBody.plot",
    "RigidBody.save",
    "RigidBody.stack",
    "RigidBody.view",
    "RigidBody.with_error_bound",
    "FreeMotion.angular_momentum",
    "FreeMotion.animate",
    "FreeMotion.kinetic_energy",
    "FreeMotion.plot",
    "FreeMotion.stability",
    "GyrostatMotion.angular_momentum",
    "GyrostatMotion.animate",
    "GyrostatMotion.equilibria",
    "GyrostatMotion.kinetic_energy",
    "GyrostatMotion.plot",
    "HeavyTop.animate",
    "HeavyTop.plot",
    "Load.with_epoch",
    "Load.keeps_momentum",
    "MassAccumulator.finish",
    "MassAccumulator.merge",
    "MassAccumulator.moment_bounds",
}
CLASSES = (
    "RigidBody",
    "FreeMotion",
    "Gyrostat",
    "GyrostatMotion",
    "HeavyTop",
    "Load",
    "MassAccumulator",
    "Region",
    "Slabs",
    "Wheel",
)

LIMITED = """
import resource, runpy, sys
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
sys.path[:0] = sys.argv[2:]
runpy.run_path(sys.argv[1], run_name="__main__")
"""


@cache
def answers() -> dict[str, tuple[str, str]]:
    """Do every call of ``absurd.py`` in a process with an address space of 4 GB."""
    pytest.importorskip("resource")
    run = subprocess.run(
        [sys.executable, "-c", LIMITED, str(Path(__file__).with_name("absurd.py")), *IMPORTED],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, f"{run.returncode}: {run.stderr[-2000:]}\nafter {run.stdout[-200:]}"
    told = [json.loads(line) for line in run.stdout.splitlines()]
    return {name: (kind, words) for name, kind, words in told}


def test_absurd_sizes_are_refused() -> None:
    accepted = (
        "MemoryError",
        "_ArrayMemoryError",
        "ValueError",
        "PolhodeError",
        "MeshError",
        "QuadratureError",
        "InvalidInertiaError",
    )
    wrong = {name: answer for name, answer in answers().items() if answer[0] not in accepted}
    assert not wrong


def test_errors_of_memory_give_what_asks_the_shape_and_the_bytes() -> None:
    told = {name: words for name, (kind, words) in answers().items() if kind == "MemoryError"}
    assert len(told) > 0.9 * len(answers())
    for name, words in told.items():
        if name.endswith("__getitem__") or "__getitem__ " in name:
            # NumPy itself finds the rows that a key picks.
            assert words.startswith("key: Unable to allocate"), (name, words)
            continue
        if name == "RigidBody.from_labelled_voxels":  # NumPy copies the labels
            assert words.startswith("labels: Unable to allocate"), (name, words)
            continue
        told_right = re.fullmatch(
            r".+: a result of shape \([\d, ]+\) takes [\d.e]+ ([kMGTP]B|bytes) with its copies, "
            r"(but [\d.]+ .B are left|more than a process can address|which the system does not give); .*",
            words,
        )
        assert told_right, (name, words)


def test_every_callable_with_a_size_is_asked() -> None:
    public = {name for name in _core.__all__ if callable(getattr(_core, name)) and name not in CLASSES}
    for one in CLASSES:
        kind = getattr(_core, one)
        methods = [name for name in vars(kind) if not name.startswith("_") and callable(getattr(kind, name))]
        public |= {f"{one}.{name}" for name in methods}
    asked = {name.partition(",")[0].partition(" ")[0] for name in (*ROWS, *OTHERS)}
    assert public - asked - SIZELESS == set()
    assert SIZELESS - public == set()


def test_sizes_that_overflow_are_none() -> None:
    """Also where one of the lengths is zero there are no rows, and no error."""
    none = RigidBody.from_principal(np.ones((0, 1)), (1.0, 1.0, 1.0))
    assert (none.translated(np.zeros((1, 5, 3)))).shape == (0, 5)
    assert none[..., None].shape == (0, 1, 1)
