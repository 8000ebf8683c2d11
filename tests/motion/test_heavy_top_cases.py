"""The exact heavy symmetric top against forty digits: every class of motion, up to 1e6 rotations."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.motion_cases import MotionCase, angle, load_table, relative_error
from polhode import RigidBody

BAR = 1e-14


@pytest.mark.parametrize("case", load_table("heavy_top"), ids=lambda case: case.name)
def test_every_class(case: MotionCase) -> None:
    body = RigidBody.from_principal(**case.body)
    motion = body.heavy_top(case.omega, case.attitude, case.gravity).at(np.array(case.times))
    # A pendulum stands still for a moment: its rates are small beside those of the case.
    rate = 2 * np.pi / case.times[0]
    for t, omega, quaternion, want in zip(
        case.times, motion.omega, motion.quaternion, case.expected, strict=True
    ):
        assert angle(quaternion, want.quaternion) <= BAR, f"attitude at t = {t:g}"
        assert relative_error(omega, want.omega, at_least=rate) <= BAR, f"rates at t = {t:g}"
