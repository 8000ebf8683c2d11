"""Spacecraft with actuators against SciPy and against live Basilisk, which has an environment of its own::

    python -m venv basilisk
    basilisk/bin/pip install bsk numpy scipy pytest pytest-timeout hypothesis mpmath
    PYTHONPATH=python basilisk/bin/python -m pytest -m long tests/loads/test_basilisk_live.py

Without the package the tests of Basilisk are skipped. With ``-s`` all tests say what the differences are.
"""

from __future__ import annotations

from collections import Counter
from functools import reduce
from itertools import pairwise
from operator import add
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles import basilisk_live
from oracles.basilisk_scenarios import SCENARIOS, Scenario, Steps, attitude_law
from oracles.spacecraft_by_scipy import by_scipy
from polhode import RigidBody, loads, orbits
from polhode.cli.validate import CASES
from scipy.spatial.transform import Rotation

Rows = NDArray[np.float64]

SMALL = 1e-10


def scheduled(table: Steps | None, make: Any) -> list[loads.Load]:
    """Return a load for each row of a table, switched on at its time and off at the next."""
    return [loads.schedule(make(row), [window]) for row, window in table.windows()] if table else []


def controller(scenario: Scenario) -> loads.Load:
    """Return the sampled law of attitude, as a load that exerts its torque."""
    control = scenario.control
    assert control is not None
    names = ["wheel", *(f"wheel_{k}" for k in range(2, 20))]
    target = Rotation.from_mrp(control.target)

    def update(_t: float, omega: Rows, quaternion: Rows, _r: Rows, _v: Rows, states: dict[str, Rows]) -> Rows:
        error = (target.inv() * Rotation.from_quat(quaternion)).as_mrp()
        momenta = [float(states[name][0]) for name in names[: len(scenario.wheels)]]
        return attitude_law(scenario, omega, error, momenta)

    def wrench(*given: Any) -> tuple[Rows, Rows]:
        return np.zeros(3), given[-1]["control"]

    return loads.with_states(None, np.zeros(3), wrench, "control", update=update, period=control.period)


def wheels(scenario: Scenario) -> list[loads.Load]:
    if scenario.motors is None:
        torque = (
            controller(scenario)
            if scenario.control
            else reduce(add, scheduled(scenario.request, loads.constant_torque))
        )
        return [
            loads.wheels(
                [wheel.axis for wheel in scenario.wheels],
                [wheel.inertia for wheel in scenario.wheels],
                torque=torque,
                rate=[wheel.rate for wheel in scenario.wheels],
                friction=[wheel.friction for wheel in scenario.wheels],
                dry_friction=[wheel.dry_friction for wheel in scenario.wheels],
                max_torque=scenario.wheels[0].max_torque,
            )
        ]
    return [
        loads.wheel(
            wheel.axis,
            wheel.inertia,
            wheel.rate,
            torque=np.array(scenario.motors.rows)[:, k],
            times=scenario.motors.times,
            friction=wheel.friction or None,
            dry_friction=wheel.dry_friction or None,
            max_torque=wheel.max_torque,
            max_rate=wheel.max_rate,
        )
        for k, wheel in enumerate(scenario.wheels)
    ]


def coils(scenario: Scenario) -> list[loads.Load]:
    given = scenario.coils
    assert given is not None
    if given.dipoles is None:
        if given.damping:
            law = loads.feedback(K=0.0, D=given.damping)
            return scheduled(given.fields, lambda b: loads.magnetic(law, b, max_dipole=given.limits))
        return scheduled(
            given.fields,
            lambda b: loads.magnetic((0, 0, 0), b, gain=given.gain, max_dipole=given.limits),
        )
    rows = np.array(given.dipoles.rows)
    if np.array_equal(given.axes, np.eye(3)):
        return scheduled(
            given.fields,
            lambda b: loads.magnetic(
                rows,
                b,
                dipole_times=given.dipoles.times,
                max_dipole=given.limits,
            ),
        )
    moments = np.clip(rows, -np.array(given.limits), given.limits) @ np.array(given.axes)
    return scheduled(
        given.fields,
        lambda b: loads.magnetic(moments, b, dipole_times=given.dipoles.times),
    )


def all_loads(scenario: Scenario) -> loads.Load | None:
    found = [
        *scheduled(scenario.force, lambda row: loads.constant_force(row, "body", (0.0, 0.0, 0.0))),
        *scheduled(scenario.force_in_space, lambda row: loads.constant_force(row, "space", (0.0, 0.0, 0.0))),
        *scheduled(scenario.torque, loads.constant_torque),
    ]
    if scenario.wheels:
        found += wheels(scenario)
    elif scenario.control:
        found.append(controller(scenario))
    if scenario.coils:
        found += coils(scenario)
    if scenario.thrusters:
        jets = scenario.thrusters
        found.append(
            loads.thrusters(
                jets.positions,
                jets.directions,
                jets.forces,
                command=np.array(jets.pulses.rows) / jets.period,
                times=jets.pulses.times,
                period=jets.period,
                min_on=jets.min_on or None,
            )
        )
    if scenario.mu:
        found.append(loads.gravity_gradient(scenario.mu, scenario.position, scenario.velocity))
    return reduce(add, found) if found else None


def run(scenario: Scenario) -> Rows:
    """Return the rows of Basilisk's run, by polhode."""
    body = RigidBody(mass=scenario.mass, inertia=scenario.inertia, center_of_mass=scenario.center)
    start = Rotation.from_mrp(scenario.mrp).as_quat()
    moves: dict[str, Any] = (
        {} if scenario.mu else {"position": scenario.position, "velocity": scenario.velocity}
    )
    t = np.array([0.0, *scenario.t])
    load = all_loads(scenario)
    motion = body.simulate(t, scenario.omega, start, load=load, rtol=1e-13, **moves)
    place, speed = motion.position, motion.velocity
    if scenario.mu:
        place, speed = orbits.kepler(scenario.mu, scenario.position, scenario.velocity, epoch=0.0).at(t)
    names = ["wheel", *(f"wheel_{k}" for k in range(2, 20))][: len(scenario.wheels)]
    rates = [
        motion.states[name][:, 0] / wheel.inertia - motion.omega @ wheel.axis
        for name, wheel in zip(names, scenario.wheels, strict=True)
    ]
    rows = [motion.omega, motion.rotation.as_mrp(), place, speed, *(rate[:, None] for rate in rates)]
    return np.concatenate(rows, axis=1)[1:]


def distances(a: Rows, b: Rows) -> Rows:
    """Return how far apart two runs are in attitude, ω, position, velocity and rates, relative to size."""
    found = [float((Rotation.from_mrp(a[:, 3:6]).inv() * Rotation.from_mrp(b[:, 3:6])).magnitude().max())]
    for part in (slice(0, 3), slice(6, 9), slice(9, 12), slice(12, None)):
        difference = np.abs(a[:, part] - b[:, part])
        found.append(float(difference.max(initial=0.0) / max(np.abs(b[:, part]).max(initial=0.0), 1e-3)))
    return np.array(found)


def of_basilisk(scenario: Scenario) -> tuple[Rows, Rows]:
    """Return Basilisk's best, and its error: from halved steps."""
    steps = [
        basilisk_live.run(scenario, scenario.step / 2**k) for k in range(3 if scenario.first_order else 2)
    ]
    if not scenario.first_order:
        # Of fourth order: the error of the short steps is a fifteenth of the difference.
        return steps[1], distances(*steps) / 10.0
    once = [2.0 * b - a for a, b in pairwise(steps)]
    best = (4.0 * once[1] - once[0]) / 3.0
    return best, distances(once[1], best)


QUICK = {
    "wheels: 1 wheels, torques at times, clipped",
    "friction: 1 wheels, viscous",
    "limits: down, and back",
    "allocation: 6 wheels",
    "coils: B-dot",
    "thrusters: 1, one pulse",
    "gravity gradient: of polhode validate",
    "force and torque: torque constant",
}
"""By SciPy these take no more than a second or two."""


def label(scenario: Scenario) -> str:
    return f"{scenario.kind}: {scenario.name}"


@pytest.mark.parametrize(
    "scenario",
    [
        pytest.param(one, id=label(one), marks=() if label(one) in QUICK else pytest.mark.long)
        for one in SCENARIOS
    ],
)
def test_by_scipy(scenario: Scenario) -> None:
    off = distances(run(scenario), by_scipy(scenario))
    print(f"\n{label(scenario):60} off SciPy by {off.max():.1e}")
    assert np.all(off < 1e-11), off


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize("scenario", SCENARIOS, ids=label)
def test_live(scenario: Scenario) -> None:
    pytest.importorskip("Basilisk")
    best, error = of_basilisk(scenario)
    off = distances(run(scenario), best)
    print(f"\n{label(scenario):60} off {off.max():.1e}, Basilisk's own error {error.max():.1e}")
    assert np.all(off < SMALL + error), (off, error)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize(
    ("kind", "row"), [("wheels", "four wheels"), ("gravity gradient", "gravity gradient")]
)
def test_validate_shows_what_basilisk_computes(kind: str, row: str) -> None:
    pytest.importorskip("Basilisk")
    (scenario,) = (one for one in SCENARIOS if (one.kind, one.name) == (kind, "of polhode validate"))
    (case,) = (case for case in CASES if case.name.startswith(row))
    found = basilisk_live.run(scenario, scenario.step / 2)[0]
    if scenario.mu:
        found = np.rad2deg(found[:3]) * 3600.0
    np.testing.assert_allclose([*found[:3], *found[12:]], case.expected, rtol=0.0, atol=case.allowed / 10.0)


def test_there_are_enough() -> None:
    kinds = Counter(scenario.kind for scenario in SCENARIOS)
    assert len(set(map(label, SCENARIOS))) == len(SCENARIOS) >= 40
    assert set(map(label, SCENARIOS)) >= QUICK
    assert min(kinds.values()) >= 3
