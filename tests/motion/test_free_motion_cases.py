"""The exact free motion against forty digits: every regime, up to 1e6 rotations."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.motion_cases import MotionCase, angle, load_table, relative_error
from polhode import RigidBody

CASES = load_table("free_motion")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_regime(case: MotionCase) -> None:
    full = "inertia" in case.body
    body = RigidBody(**case.body) if full else RigidBody.from_principal(**case.body)
    motion = body.free_motion(case.omega, case.attitude).at(np.array(case.times))
    bar = 1e-13 if full else 1e-14
    for t, omega, quaternion, want in zip(
        case.times, motion.omega, motion.quaternion, case.expected, strict=True
    ):
        assert angle(quaternion, want.quaternion) <= bar, f"attitude at t = {t:g}"
        assert relative_error(omega, want.omega) <= bar, f"rates at t = {t:g}"


def test_one_time_and_many_agree_to_the_last_bit() -> None:
    case = CASES[0]
    motion = RigidBody.from_principal(**case.body).free_motion(case.omega, case.attitude)
    together = motion.at(np.array(case.times))
    for i, t in enumerate(case.times):
        alone = motion.at(t)
        assert np.array_equal(alone.omega, together.omega[i])
        assert np.array_equal(alone.quaternion, together.quaternion[i])
