"""Motions of many drawn bodies at once: Euler's equations by the classical rule of four stages, in NumPy.

Rates ω and attitudes q (x, y, z, w) side by side, under a constant torque in the body and a linear drag.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]

__all__ = ["attitude_changes", "moved"]


def _product(p: Floats, q: Floats) -> Floats:
    """Quaternions in columns: what q turns, turned by p."""
    v = p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3], axis=0)
    return np.vstack([v, p[3] * q[3] - (p[:3] * q[:3]).sum(axis=0)])


def moved(
    tensors: Floats, omega: Floats, attitude: Floats, time: float, torque: Floats, drag: float, steps: int
) -> tuple[Floats, Floats]:
    """Rates (3, n) and attitudes (4, n) after a time, from theirs; tensors (n, 3, 3)."""
    inverse = np.linalg.inv(tensors)

    def rates(w: Floats, q: Floats) -> tuple[Floats, Floats]:
        momentum = np.einsum("nij,jn->in", tensors, w)
        change = torque[:, None] - drag * w - np.cross(w, momentum, axis=0)
        half = np.vstack([w / 2, np.zeros(w.shape[1])])
        return np.einsum("nij,jn->in", inverse, change), _product(q, half)

    h = time / steps
    w, q = omega, attitude
    for _ in range(steps):
        a, A = rates(w, q)
        b, B = rates(w + h / 2 * a, q + h / 2 * A)
        c, C = rates(w + h / 2 * b, q + h / 2 * B)
        d, D = rates(w + h * c, q + h * C)
        w = w + h / 6 * (a + 2 * b + 2 * c + d)
        q = q + h / 6 * (A + 2 * B + 2 * C + D)
        q = q / np.linalg.norm(q, axis=0)
    return w, q


def attitude_changes(nominal: Floats, attitude: Floats) -> Floats:
    """δ of R → R exp(δ×), components in the body frame: (3, n)."""
    back = np.concatenate([-nominal[:3], nominal[3:]])[:, None] * np.ones(attitude.shape[1])
    r = _product(back, attitude)
    r = r * np.where(r[3] < 0, -1.0, 1.0)
    sine = np.linalg.norm(r[:3], axis=0)
    ratio = np.where(sine > 1e-12, 2 * np.arctan2(sine, r[3]) / np.maximum(sine, 1e-300), 2.0)
    return np.asarray(r[:3] * ratio)
