"""Bodies with a constant momentum inside against forty digits: every regime, up to 1e12 rotations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from oracles.gyrostat_cases import cases, proven
from oracles.motion_cases import MotionCase, State, angle, apart, load_table, relative_error
from polhode import RigidBody, loads

if TYPE_CHECKING:
    from numpy.typing import NDArray

CASES = load_table("gyrostat")
SHORT = 15.0
"""Rotations that a general integrator is followed for."""


def _body(case: MotionCase) -> RigidBody:
    return RigidBody(**case.body) if "inertia" in case.body else RigidBody.from_principal(**case.body)


def _error(
    case: MotionCase, omega: NDArray[np.float64], quaternion: NDArray[np.float64], want: State
) -> float:
    return max(angle(quaternion, want.quaternion), relative_error(omega, want.omega, at_least=case.fastest))


def test_every_regime_has_its_cases() -> None:
    assert [case.name for case in CASES] == [case.name for case in cases()]
    assert len(CASES) >= 60
    assert all(len(case.kappa) == len(case.expected) == len(case.times) for case in CASES)


@pytest.mark.parametrize(
    "name", ["symmetric: oblate, h along its axis", "spherical: h along none", "generic: two lobes, one"]
)
def test_the_generator_makes_the_table(name: str) -> None:
    made = next(proven(case) for case in cases() if case.name == name)
    kept = next(case for case in CASES if case.name == name)
    assert (made.kappa, made.fastest, made.periods) == (kept.kappa, kept.fastest, kept.periods)
    assert max(apart(a, b) for a, b in zip(made.expected, kept.expected, strict=True)) < 1e-38


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_table_against_integration(case: MotionCase) -> None:
    x, y, z = case.rotor
    inside = loads.damping([[0, z, -y], [-z, 0, x], [y, -x, 0]])
    turn = max(case.times[0] * 4, 1e-300)
    short = [i for i, t in enumerate(case.times) if t <= SHORT * turn]
    times = np.array([0.0, *(case.times[i] for i in short)])
    run = _body(case).simulate(times, case.omega, case.attitude, load=inside, method="taylor", rtol=1e-26)
    for k, i in enumerate(short, start=1):
        bar = 1e-15 + 1e-16 * case.kappa[i]
        assert _error(case, run.omega[k], run.quaternion[k], case.expected[i]) <= bar, (
            f"t = {case.times[i]:g}"
        )


STATES = [pytest.param(case, i, id=f"{case.name}: {i}") for case in CASES for i in range(len(case.times))]


@pytest.mark.parametrize(("case", "i"), STATES)
def test_the_closed_form(case: MotionCase, i: int) -> None:
    motion = _body(case).gyrostat(case.rotor).free_motion(case.omega, case.attitude)
    state, want = motion.at(case.times[i]), case.expected[i]
    bar = 1e-14 + 1e-16 * case.kappa[i]
    assert _error(case, state.omega, state.quaternion, want) <= bar, f"t = {case.times[i]:g}"
