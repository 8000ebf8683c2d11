"""Coils and thrusters against Basilisk: recorded, and live where its package is installed."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from oracles import basilisk_actuators
from oracles.basilisk_actuators import COILS, CRAFT, TABLE, THRUSTERS
from polhode import RigidBody, loads
from scipy.spatial.transform import Rotation

BODY = RigidBody(mass=CRAFT["mass"], inertia=CRAFT["inertia"])
START = Rotation.from_mrp(CRAFT["mrp"]).as_quat()
CASES: dict[str, Any] = {
    "coils": (
        COILS["t"],
        loads.magnetic(COILS["dipole"], COILS["field"], max_dipole=COILS["max_dipole"]),
    ),
    "thrusters": (
        THRUSTERS["t"],
        loads.thrusters(
            THRUSTERS["positions"],
            THRUSTERS["directions"],
            THRUSTERS["forces"],
            command=THRUSTERS["duties"],
            times=[0.0, *THRUSTERS["t"][:-1]],
            period=THRUSTERS["period"],
        ),
    ),
}


def compare(case: str, recorded: Any) -> None:
    t, load = CASES[case]
    run = BODY.simulate([0.0, *t], CRAFT["omega"], START, load=load, rtol=1e-13)
    omega, mrp, position, velocity = np.split(np.array(recorded), 4, axis=1)
    assert np.abs(run.omega[1:] - omega).max() < 1e-11
    assert (Rotation.from_mrp(mrp).inv() * run.rotation[1:]).magnitude().max() < 2e-11
    assert np.abs(run.position[1:] - position).max() < 1e-11
    assert np.abs(run.velocity[1:] - velocity).max() < 1e-11


@pytest.mark.parametrize("case", CASES)
def test_as_recorded(case: str) -> None:
    compare(case, json.loads(TABLE.read_text())[case])


@pytest.mark.parametrize("case", CASES)
def test_live(case: str) -> None:
    pytest.importorskip("Basilisk")
    compare(case, getattr(basilisk_actuators, case)())
