"""`simulate` against forty digits under every load, with the condition number of each case in its bar."""

from __future__ import annotations

from functools import reduce
from operator import add
from typing import Any

import numpy as np
import pytest
from oracles.motion_cases import MotionCase, angle, load_table, relative_error
from polhode import RigidBody, loads

CASES = load_table("simulate")
MATRICES = ("matrix", "quadratic", "K", "D")
EPSILON = float(np.finfo(float).eps)


def load_of(case: MotionCase) -> Any:
    """The sum of the case's loads."""
    return reduce(add, (_load(dict(term)) for term in case.load))


def _load(term: dict[str, Any]) -> Any:
    kind = term.pop("kind")
    if kind == "sinusoidal_torque":
        vector, rate, phase = np.array(term["vector"]), term["rate"], term["phase"]
        return loads.torque_callback(lambda t, _omega, _q: vector * np.sin(rate * t + phase))
    return getattr(loads, kind)(**{key: _matrix(x) if key in MATRICES else x for key, x in term.items()})


def _matrix(x: Any) -> Any:
    return x * np.eye(3) if np.ndim(x) == 0 else x


def simulated(case: MotionCase, method: str, rtol: float) -> Any:
    made = RigidBody.from_principal if "moments" in case.body else RigidBody
    path = {"position": case.position, "velocity": case.velocity} if case.position else {}
    return made(**case.body).simulate(
        [0.0, *case.times],
        case.omega,
        case.attitude,
        load=load_of(case),
        about=case.about,
        method=method,
        rtol=rtol,
        **path,
    )


# An explicit method on a stiff case stands at the limit of its stability: those are for "radau".
SMOOTH = tuple(case for case in CASES if "stiff" not in case.name)


@pytest.mark.parametrize("case", SMOOTH, ids=lambda case: case.name)
def test_dop853(case: MotionCase) -> None:
    trajectory = simulated(case, "dop853", 1e-13)
    rotation = 2 * np.pi / np.linalg.norm(case.omega)
    for i, (t, kappa, want) in enumerate(zip(case.times, case.kappa, case.expected, strict=True), start=1):
        bar = (1e-11 if t < 10.5 * rotation else 1e-9) + 100 * kappa * EPSILON
        assert angle(trajectory.quaternion[i], want.quaternion) <= bar
        rate = float(np.linalg.norm(case.omega))
        assert relative_error(trajectory.omega[i], want.omega, at_least=rate) <= bar
        if case.position:
            assert relative_error(trajectory.position[i], want.position) <= bar
            assert relative_error(trajectory.velocity[i], want.velocity) <= bar
