"""Bodies that a field turns, on orbits of every eccentricity, against Taylor series in 40 digits."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.load_cases import ATTITUDE
from oracles.orbit_torques import CASES, Passage, setting, table
from polhode import MotionSensitivity, RigidBody, loads

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
