"""The gyrostat in closed form beside SciPy's integrator."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Iterator

MOMENTS = np.array([1.0, 2.0, 2.5])
ROTOR = np.array([0.4, -0.2, 0.9])
OMEGA = np.array([0.3, 0.4, 1.1])
ROTATION = 2 * np.pi / np.linalg.norm(OMEGA)
BESIDE = np.array([-1.5 * (1 - 2.0**-40), 1.0, -1.5])
"""A start 1e-12 off a separatrix."""
TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]])
"""Three times a rotation: what it makes of whole numbers is exact."""
TURNED = TURN @ np.diag([18.0, 27.0, 36.0]) @ TURN.T / 9
TURNED_ROTOR = TURN @ np.array([9.0, 9.0, 18.0])
BORDER = TURN @ np.array([-2.5, 1.0, -2.5])
"""A start on a separatrix."""
STATES = 100_000
FAR = 10_000
INTEGRATED = 10


def integrated(t: float) -> Any:
    """ω and quaternion at t by DOP853 at 1e-12."""

    def rhs(_t: float, s: Any) -> list[float]:
        p, q, r, x, y, z, w = s.tolist()
        a, b, c = MOMENTS * (p, q, r) + ROTOR
        return [
            (b * r - c * q) / MOMENTS[0],
            (c * p - a * r) / MOMENTS[1],
            (a * q - b * p) / MOMENTS[2],
            0.5 * (w * p + y * r - z * q),
            0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y * p),
            -0.5 * (x * p + y * q + z * r),
        ]

    return solve_ivp(rhs, (0, t), [*OMEGA, 0, 0, 0, 1], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    gyrostat = RigidBody.from_principal(1.0, MOMENTS).gyrostat(ROTOR)
    motion = gyrostat.free_motion(OMEGA)
    times = np.linspace(0, 100 * ROTATION, STATES)

    def same(_ours: Any, theirs: Any) -> None:
        near = motion.at(INTEGRATED * ROTATION)
        assert np.abs(near.omega - theirs[:3]).max() < 1e-8
        assert 1 - abs(near.quaternion @ theirs[3:]) / np.linalg.norm(theirs[3:]) < 1e-12

    # The peer integrates part of the way; times are for each rotation.
    yield Row(
        name=f"gyrostat, one state after {FAR:.0e} rotations, set-up included",
        peer=f"SciPy DOP853 at 1e-12, {INTEGRATED} rotations",
        ours=lambda: gyrostat.free_motion(OMEGA).at(FAR * ROTATION),
        theirs=lambda: integrated(INTEGRATED * ROTATION),
        compare=same,
        items=FAR,
        peer_items=INTEGRATED,
        at_least=1000,
    )
    # Set-up, and what of a state is computed: beside those of the free motion.
    body = RigidBody.from_principal(1.0, MOMENTS)
    free = body.free_motion(OMEGA)
    beside = RigidBody.from_principal(1.0, (3.0, 4.0, 6.0)).gyrostat((2.5, 0.0, -1.0))
    # On a separatrix one number is needed to four times the precision; here of a tensor with turned axes.
    turned = RigidBody(1.0, TURNED).gyrostat(TURNED_ROTOR)
    near = BORDER * (1 - 2.0**-40)
    assert turned.free_motion(BORDER).mode == "separatrix"
    assert turned.free_motion(near).mode == "paired"
    for where, moved, omega in (
        ("", gyrostat, OMEGA),
        (" on a separatrix, axes turned", turned, BORDER),
        (" next to a separatrix, axes turned", turned, near),
        (" next to a separatrix", beside, BESIDE),
    ):
        yield Row(
            name=f"gyrostat, set-up{where}",
            peer="our free motion",
            ours=partial(moved.free_motion, omega),
            theirs=lambda: body.free_motion(OMEGA),
            compare=lambda _ours, _theirs: None,
            most_seconds=10e-6,
        )
    yield Row(
        name=f"gyrostat, {STATES:.0e} states",
        peer="our free motion",
        ours=lambda: motion.at(times),
        theirs=lambda: free.at(times),
        compare=lambda _ours, _theirs: None,
        items=STATES,
        most_seconds=150e-9,
    )
