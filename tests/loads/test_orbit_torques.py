"""Bodies that a field turns, on orbits of every eccentricity, against Taylor series in 40 digits."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.load_cases import ATTITUDE
from oracles.orbit_torques import CASES, Passage, setting, table
from polhode import MotionSensitivity, RigidBody, loads, orbits
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

KNOWN = table()
START = np.array(ATTITUDE) / np.linalg.norm(ATTITUDE)


def slopes_of(found: MotionSensitivity) -> np.ndarray:
    """Derivatives at the end in the oracle's order: of a body in its principal axes."""
    by_tensor = []
    for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)):
        change = np.zeros((3, 3))
        change[i, j] = change[j, i] = 1.0
        off = np.array([change[1, 2], change[2, 0], change[0, 1]])
        by_tensor.append(found.moments[-1] @ np.diag(change) + found.products[-1] @ off)
    by_load = [slopes[-1].reshape(6, -1) for term in found.load for slopes in term.values()]
    own = [found.state[-1], np.array(by_tensor).T, found.center_of_mass[-1], found.mass[-1][:, None]]
    return np.concatenate([*own, *by_load], axis=1)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_passage_and_its_derivatives(case: Passage) -> None:
    known, given = KNOWN[case], setting(case)
    body = RigidBody.from_principal(given.body["mass"], given.body["moments"])
    (term,) = given.load
    load = loads.gravity_gradient(term["mu"], term["position"], term["velocity"])
    run = body.simulate([0.0, given.time], given.omega, ATTITUDE, load=load, method="taylor", rtol=2.3e-15)
    # κ: the largest change of the state for a relative change of a number.
    sizes = np.concatenate(
        [np.ones(3), given.omega, given.body["moments"], np.ones(3), np.zeros(4), [term["mu"]]]
        + [np.full(3, np.linalg.norm(term[name])) for name in ("position", "velocity")]
    )
    state = np.concatenate([np.ones(3), np.full(3, np.linalg.norm(known.omega))])
    kappa = np.abs(known.slopes * sizes / state[:, None]).max()
    sign = np.sign(run.quaternion[-1] @ known.quaternion)
    bar = 1e-13 * (1 + kappa)
    assert np.abs(sign * run.quaternion[-1] - known.quaternion).max() <= bar
    assert np.abs(run.omega[-1] - known.omega).max() <= bar * np.linalg.norm(known.omega)
    found = slopes_of(run.sensitivity())
    for part in (slice(0, 6), slice(6, 12), slice(16, 17), slice(17, 20), slice(20, 23)):
        exact = known.slopes[:, part]
        assert np.abs(found[:, part] - exact).max() <= bar * np.abs(exact).max()


@pytest.mark.parametrize("eccentricity", [0.0, 0.3, 0.95, 1.0, 1.7, 4.3, 10.0])
@pytest.mark.parametrize("end", [3.0, -3.0])
def test_clones_on_the_same_orbits_are_each_as_alone(eccentricity: float, end: float) -> None:
    """Slower than the orbits and far faster; beside twice the precision and SciPy's integrator."""
    rng = np.random.default_rng(5)
    body = RigidBody.from_principal(2.0, (1.0, 1.7, 2.2))
    omega = rng.normal(size=(14, 3)) * np.geomspace(0.05, 30.0, 14)[:, None]
    attitude = Rotation.random(14, rng).as_quat()
    orbit = orbits.from_elements(
        2.0, eccentricity=eccentricity, periapsis=0.8, inclination=0.4, node=1.0, since_periapsis=-0.5 * end
    )
    other = orbits.kepler(0.5, (1.5, -0.4, 2.0), (0.2, 0.4, -0.1), epoch=0.3)
    load = loads.gravity_gradient(orbit) + loads.gravity_gradient(other)
    times = [0.0, 0.31 * end, end]
    runs = body.simulate(times, omega, attitude, load=load, rtol=1e-13)
    exact = body.simulate(times, omega, attitude, load=load, rtol=1e-20)
    speed = np.linalg.norm(exact.omega, axis=-1).max(axis=1)
    for k in range(0, 14, 4):
        alone = body.simulate(times, omega[k], attitude[k], load=load, rtol=1e-13)
        np.testing.assert_array_equal(alone.omega, runs.omega[k])
        np.testing.assert_array_equal(alone.quaternion, runs.quaternion[k])
    assert (np.abs(runs.omega - exact.omega).max(axis=(1, 2)) / speed).max() < 1e-10
    assert np.abs(runs.quaternion - exact.quaternion).max() < 1e-10

    inertia = np.array([1.0, 1.7, 2.2])

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        x, s, w = y[:3], y[3], y[4:]
        torque = -np.cross(w, inertia * w)
        for one in (orbit, other):
            r = Rotation.from_quat(y[:4]).inv().apply(one.at(t).position)
            torque += 3 * one.mu / np.linalg.norm(r) ** 5 * np.cross(r, inertia * r)
        return np.concatenate([0.5 * (s * w + np.cross(x, w)), [-0.5 * x @ w], torque / inertia])

    start = np.concatenate([runs.quaternion[3, 0], omega[3]])
    by_scipy = solve_ivp(rates, (0.0, end), start, "DOP853", rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(runs.omega[3, -1], by_scipy.y[4:, -1], atol=1e-8)


@pytest.mark.parametrize("count", [1, 24])
def test_the_frame_of_the_series_changes_no_more_than_their_rounding(count: int) -> None:
    """Seen from the frame of an orbit alone; from space beside a weight, which turns no free body."""
    rng = np.random.default_rng(11)
    body = RigidBody.from_principal(2.0, (1.0, 1.7, 2.2))
    omega = rng.normal(size=(count, 3)) * np.geomspace(0.3, 3.0, count)[:, None]
    field = loads.gravity_gradient(1.0, (1.0, 0.2, 0.1), (-0.3, 1.1, 0.4))
    weight = loads.uniform_gravity((0.0, 0.0, -1.0))
    alone, beside = (
        body.simulate([0.0, 4.0], omega, START, load=load, method="taylor", rtol=2.3e-15)
        for load in (field, field + weight)
    )
    free = body.simulate([0.0, 4.0], omega, START, method="taylor", rtol=2.3e-15)
    sizes = np.linalg.norm(beside.omega[:, -1], axis=-1)
    assert (np.abs(alone.omega[:, -1] - beside.omega[:, -1]).max(axis=-1) < 1e-13 * sizes).all()
    turns = Rotation.from_quat(alone.quaternion[:, -1]).inv() * Rotation.from_quat(beside.quaternion[:, -1])
    assert turns.magnitude().max() < 1e-13
    # The field does turn them.
    assert (np.abs(free.omega[:, -1] - beside.omega[:, -1]).max(axis=-1) > 1e-3 * sizes).all()
