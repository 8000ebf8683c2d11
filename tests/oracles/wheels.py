"""A body and its wheels as bodies that push each other, by SciPy; the body of the tests with states."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from polhode import RigidBody
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["ATTITUDE", "BODY", "OMEGA", "T", "by_scipy", "of_wheels", "turned", "turning"]

BODY = RigidBody.from_principal(
    3.0, (1.0, 2.0, 2.5), axes=np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
)
OMEGA = np.array([0.7, -0.9, 1.1])
ATTITUDE = np.array([0.1, -0.5, 0.3, 0.8]) / np.linalg.norm([0.1, -0.5, 0.3, 0.8])
T = np.array([0.0, 1.7, 6.0, 15.0])


def turned(q: np.ndarray) -> np.ndarray:
    """Give the matrix of a quaternion."""
    x, y, z, w = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def turning(q: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Give q̇ = ½ q∘ω."""
    x, y, z, s = q
    a, b, c = w
    product = [s * a + y * c - z * b, s * b + z * a - x * c, s * c + x * b - y * a, -x * a - y * b - z * c]
    return 0.5 * np.array(product)


def by_scipy(
    rates: Callable[[float, np.ndarray], np.ndarray], own: list[float], ends: list[float]
) -> np.ndarray:
    """Integrate (q, ω, own) from piece to piece; the states at T."""
    y, found = np.concatenate([ATTITUDE, OMEGA, own]), []
    for low, high in itertools.pairwise(ends):
        last = high == ends[-1]
        t = T[(low <= T) & ((high > T) | last)]
        run = solve_ivp(rates, (low, high), y, "DOP853", t_eval=np.union1d(t, high), rtol=3e-14, atol=1e-14)
        found += [run.y[:, k] for k, at in enumerate(run.t) if at in t]
        y = run.y[:, -1]
    return np.array(found)


def of_wheels(
    axes: np.ndarray,
    inertia: np.ndarray,
    friction: np.ndarray,
    torque: Callable[[float, np.ndarray, np.ndarray], np.ndarray],
) -> Callable[[float, np.ndarray], np.ndarray]:
    """Give the rates of (q, ω, Ω): body and wheels as bodies that push each other, by one matrix for all."""
    count, tensor = len(axes), BODY.inertia
    mass = np.zeros((3 + count, 3 + count))
    mass[:3, :3] = tensor
    for k in range(count):
        mass[:3, 3 + k] = mass[3 + k, :3] = inertia[k] * axes[k]
        mass[3 + k, 3 + k] = inertia[k]

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        q, w, speed = y[:4], y[4:7], y[7:]
        spin = tensor @ w + (inertia * speed) @ axes
        push = torque(t, q, w) - friction * speed
        return np.concatenate(
            [turning(q, w), np.linalg.solve(mass, np.concatenate([-np.cross(w, spin), push]))]
        )

    return rates
