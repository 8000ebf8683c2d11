"""Objects of each class, and what calls of them give; processes that a test starts import this."""

from __future__ import annotations

from typing import Any

import numpy as np
from polhode import RigidBody, loads, principal_axes, regions

RNG = np.random.default_rng(20261122)
MOMENTS = np.sort(RNG.uniform(1.0, 1.5, (4000, 3)), axis=1)
RATES = RNG.normal(size=(4000, 3))
BODIES = RigidBody.from_principal(1.0, MOMENTS)
ONE = BODIES[0]
MOTIONS = BODIES.free_motion(RATES)
LOAD = loads.damping(0.1) + loads.constant_torque((0.0, 0.1, 0.0), "space")
CALLED = LOAD + loads.torque_callback(lambda _t, omega, _quaternion: -0.1 * omega)
TOP = RigidBody.from_principal(1.0, (0.2, 0.2, 0.1), center_of_mass=(0.0, 0.0, 0.3))
HEAVY = TOP.heavy_top((0.1, 0.0, 30.0), (np.sin(0.2), 0.0, 0.0, np.cos(0.2)), (0.0, 0.0, -9.81))
REGION = regions.ball(1.0)


def some_of_everything() -> list[Any]:
    """Use the shared objects, some on all cores."""
    times = np.linspace(0.0, 1.0, 5)
    return [
        MOTIONS.at(times).quaternion,
        MOTIONS.polhode(9),
        np.array(MOTIONS.periods.rotation),
        BODIES.simulate([0.0, 0.2], RATES, load=LOAD).omega,
        BODIES[:60].simulate([0.0, 0.2], RATES[:60], load=LOAD, method="dop853").omega,
        ONE.simulate([0.0, 1.0], RATES[0], load=CALLED).omega,
        HEAVY.at(times).omega,
        principal_axes(BODIES.inertia).axes,
        BODIES.combined().inertia,
        (BODIES + BODIES[::-1]).inertia,
        np.array(RigidBody.from_density(lambda r: 1.0 + r[:, 0] ** 2, REGION).mass),
        LOAD.torque(0.0, RATES, (0.0, 0.0, 0.0, 1.0)),
    ]


def digest() -> list[bytes]:
    return [np.asarray(array).tobytes() for array in some_of_everything()]
