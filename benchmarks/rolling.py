"""A body that rolls, beside numerical integration by SciPy of the same equations, at equal error.

The equations are in NumPy, and, where numba is installed, compiled by it too.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
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
TAP, TAPPED_END, REVERSALS = np.array([3.0, 0.0, 0.0]), 6.0, 5
"""Tapped without spin the stone begins to turn; the sense of its turn changes so many times."""
TAPPED_RTOL, THEIR_TAPPED_RTOL = 1e-6, 1e-8
"""Both with an error of some 1e-5 rad/s at the end."""
RATTLE = 31
"""Times over which the rate is averaged, so that the rattle does not count as a change of sense."""


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
    rates = np.empty(9)
    rates[:3] = (np.cross(u, omega) + w * omega) / 2
    rates[3] = -(u @ omega) / 2
    rates[4:7] = np.linalg.solve(about, torque)
    rates[7:] = (frame @ arm_rate)[:2]
    return rates


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
    return their_run(equations, OMEGA, END, 2)[-1, 4:7]


def compiled() -> Any:
    """Compile the equations by numba."""
    numba: Any = import_module("numba")
    right_side = numba.njit(equations)
    right_side(0.0, np.array([0, 0, 0, 1.0, *OMEGA, 0.0, 0.0]))
    return right_side


def their_run(right_side: Any, omega: Any, end: float, n: int, rtol: float = THEIR_RTOL) -> Any:
    """Compute states at `n` times by SciPy."""
    start = np.concatenate([[0, 0, 0, 1.0], omega, [0.0, 0.0]])
    t = np.linspace(0.0, end, n)
    return solve_ivp(right_side, (0, end), start, method="DOP853", t_eval=t, rtol=rtol, atol=rtol).y.T


def our_turns() -> Any:
    """Compute the rate of a tapped stone about the vertical, with everything that the run needs."""
    body = RigidBody(MASS, inertia=INERTIA, center_of_mass=CENTER)
    contact = rolling.plane(rolling.ellipsoid(SEMI_AXES))
    t = np.linspace(0.0, TAPPED_END, 601)
    run = body.simulate(t, TAP, load=loads.uniform_gravity(GRAVITY), contact=contact, rtol=TAPPED_RTOL)
    return vertical(run.quaternion, run.omega)


def their_turns(right_side: Any) -> Any:
    """Compute the same by SciPy."""
    found = their_run(right_side, TAP, TAPPED_END, 601, THEIR_TAPPED_RTOL)
    return vertical(found[:, :4], found[:, 4:7])


def vertical(quaternion: Any, omega: Any) -> Any:
    """Compute the component of the angular velocity along the vertical."""
    x, y, z, w = quaternion.T
    normal = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), w * w + z * z - x * x - y * y], axis=-1)
    return np.einsum("ti,ti->t", normal, omega) / (quaternion**2).sum(axis=-1)


def same_turns(ours: Any, theirs: Any) -> None:
    """Compare the rates, and count how often their sense changes."""
    turns = np.convolve(ours, np.full(RATTLE, 1 / RATTLE), "valid")
    assert np.count_nonzero(np.diff(np.sign(turns))) == REVERSALS
    assert np.max(np.abs(ours - theirs)) < 1e-4


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
    yield Row(
        name="rolling: a rattleback, tapped, that turns back five times in 6 s",
        peer="scipy: DOP853 in NumPy, equal error",
        ours=our_turns,
        theirs=lambda: their_turns(equations),
        compare=same_turns,
        items=1,
        most_seconds=0.010,
    )
    if find_spec("numba") is not None:
        fast = compiled()
        yield Row(
            name="rolling: a tapped rattleback for a second",
            peer="scipy: DOP853, compiled by numba, equal error",
            ours=ours,
            theirs=lambda: their_run(fast, OMEGA, END, 2)[-1, 4:7],
            compare=same_ends,
            items=1,
            at_least=10,
        )
