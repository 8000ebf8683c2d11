"""The exact heavy top beside numerical integration by SciPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody, euler_angles
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Iterator

ACROSS, ALONG, LENGTH, G = 0.3, 0.5, 0.7, 9.81


def equations(_t: float, y: Any) -> list[float]:
    """Rates of (x, y, z, w, ω) of a top of unit mass on the third axis."""
    x, y_, z, w, p, q, r = y
    inertia = ACROSS + LENGTH**2
    up = 2 * (x * z - w * y_), 2 * (y_ * z + w * x)
    gyro, weight = (inertia - ALONG) / inertia * r, G * LENGTH / inertia
    return [
        0.5 * (w * p + y_ * r - z * q),
        0.5 * (w * q + z * p - x * r),
        0.5 * (w * r + x * q - y_ * p),
        -0.5 * (x * p + y_ * q + z * r),
        gyro * q + weight * up[1],
        -gyro * p - weight * up[0],
        0.0,
    ]


def same_states(ours: Any, theirs: Any) -> None:
    """Attitudes up to their sign."""
    assert np.abs(np.abs((ours * theirs).sum(-1)) - 1).max() < 1e-8


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    body = RigidBody.from_principal(1.0, (ACROSS, ACROSS, ALONG), center_of_mass=(0, 0, LENGTH))
    omega, attitude = np.array([1.5, -2.0, 20.0]), euler_angles.to_quaternion((0.1, 0.6, 0.4))
    turn = 2 * np.pi / 20.0
    times = np.linspace(0, 10 * turn, 1001)
    top = body.heavy_top(omega, attitude, (0, 0, -G))
    start = np.concatenate([attitude, omega])

    def integrated() -> Any:
        run = solve_ivp(
            equations, (0, times[-1]), start, method="DOP853", rtol=1e-12, atol=1e-12, t_eval=times
        )
        return run.y[:4].T

    yield Row(
        name="heavy top: 1000 states over 10 turns",
        peer="scipy: DOP853 at 1e-12",
        ours=lambda: body.heavy_top(omega, attitude, (0, 0, -G)).at(times).quaternion,
        theirs=integrated,
        compare=same_states,
        items=times.size,
        at_least=300,
    )
    many = np.linspace(0, 1e3, 10_000)
    yield Row(
        name="heavy top: 1e4 states, beside one by one",
        peer="polhode: a call for each",
        ours=lambda: top.at(many).quaternion,
        theirs=lambda: np.stack([top.at(t).quaternion for t in many]),
        compare=same_states,
        items=many.size,
    )
    omegas = omega + np.linspace(0, 1, 4)[:, None]

    def one_by_one() -> Any:
        return np.stack(
            [
                solve_ivp(
                    equations,
                    (0, 10 * turn),
                    np.concatenate([attitude, omega]),
                    method="DOP853",
                    rtol=1e-12,
                    atol=1e-12,
                ).y[:4, -1]
                for omega in omegas
            ]
        )

    yield Row(
        name="heavy top: 4 tops, one state at 10 turns",
        peer="scipy: DOP853 at 1e-12",
        ours=lambda: body.heavy_top(omegas, attitude, (0, 0, -G)).at(10 * turn).quaternion,
        theirs=one_by_one,
        compare=same_states,
        items=len(omegas),
        at_least=300,
    )
