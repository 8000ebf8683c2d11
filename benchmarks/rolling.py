"""A body that rolls, beside numerical integration by SciPy of the same equations in NumPy, at equal error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody, loads, rolling
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Iterator

MASS, GRAVITY, SEMI_AXES = 1.0, np.array([0.0, 0.0, -9.81]), np.array([0.2, 0.03, 0.02])
LEAN, MOMENTS, END = 0.4, (2e-4, 1.6e-3, 1.7e-3), 1.0
"""A rattleback, whose principal axes lean by 0.4 rad against those of its surface; tapped, it reverses."""
TURN = np.array([[np.cos(LEAN), -np.sin(LEAN), 0], [np.sin(LEAN), np.cos(LEAN), 0], [0, 0, 1]])
_UPPER = TURN @ np.diag(MOMENTS) @ TURN.T
INERTIA, CENTER = (_UPPER + _UPPER.T) / 2, np.array([0.0, 0.0, -0.002])
OMEGA = np.array([2.0, 0.0, 0.5])
RTOL = 1e-9
THEIR_RTOL = 1e-12
"""With which SciPy has the error that `RTOL` gives here."""


def equations(_t: float, y: Any) -> Any:
    """Rates of (x, y, z, w, ω, place of the contact), components of ω in the body."""
    q, omega = y[:4], y[4:7]
    u, w = q[:3], q[3]
    frame = (w * w - u @ u) * np.eye(3) + 2 * np.outer(u, u)
    frame += 2 * w * np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    normal = frame[2]
    squares = SEMI_AXES**2
    stretched = squares * normal
    size = np.sqrt(normal @ stretched)
    arm = -stretched / size - CENTER
    rate = np.cross(normal, omega)
    arm_rate = -squares * rate / size + stretched * (stretched @ rate) / size**3
    inward = np.cross(omega, arm_rate + np.cross(omega, arm))
    torque = np.cross(arm, MASS * (-inward - frame.T @ GRAVITY)) - np.cross(omega, INERTIA @ omega)
    about = INERTIA + MASS * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    turn = np.linalg.solve(about, torque)
    return np.concatenate(
        [(np.cross(u, omega) + w * omega) / 2, [-u @ omega / 2], turn, (frame @ arm_rate)[:2]]
    )


def same_ends(ours: Any, theirs: Any) -> None:
    """Compare ω at the end."""
    assert np.max(np.abs(ours - theirs)) < 1e-4


def ours() -> Any:
    """Compute ω at the end, with everything that the run needs."""
    body = RigidBody(MASS, inertia=INERTIA, center_of_mass=CENTER)
    contact = rolling.plane(rolling.ellipsoid(SEMI_AXES))
    load = loads.uniform_gravity(GRAVITY)
    return body.simulate([0, END], OMEGA, load=load, contact=contact, rtol=RTOL).omega[-1]


def theirs() -> Any:
    """Compute the same by SciPy."""
    start = np.concatenate([[0, 0, 0, 1.0], OMEGA, [0.0, 0.0]])
    run = solve_ivp(equations, (0, END), start, method="DOP853", rtol=THEIR_RTOL, atol=THEIR_RTOL)
    return run.y[4:7, -1]


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    yield Row(
        name="rolling: a tapped rattleback for a second",
        peer="scipy: DOP853 in NumPy, equal error",
        ours=ours,
        theirs=theirs,
        compare=same_ends,
        items=1,
        at_least=100,
    )
