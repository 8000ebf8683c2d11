"""Random free bodies and heavy tops near the separatrix: how near is drawn, not left to chance.

`L² − 2T I₂ = I₃(I₃ − I₂) ω₃² − I₁(I₂ − I₁) ω₁²` vanishes on the separatrix; k′² is what is left of it. A
start is made near by the double ω₃ next to the one that cancels, the best of several ω₁, or by an ω near the
intermediate axis.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import mpmath
import numpy as np
from mpmath import mp, mpf

__all__ = ["ROTATIONS", "Start", "TopStart", "complement", "exact_axes", "starts", "top_starts"]

SEED = 20261122
ROTATIONS = np.array([1.0, 1e3, 1e6, 1e9, 1e12])


class Start(NamedTuple):
    """Principal moments, ω along the principal axes, the times to ask for."""

    moments: np.ndarray
    omega: np.ndarray
    attitude: np.ndarray
    times: np.ndarray


def complement(moments: np.ndarray, omega: np.ndarray) -> float:
    """k′ of exact doubles; negative in long-axis mode."""
    with mp.workdps(120):
        i, w = [mpf(x) for x in moments], [mpf(x) for x in omega]
        difference = i[2] * (i[2] - i[1]) * w[2] ** 2 - i[0] * (i[1] - i[0]) * w[0] ** 2
        if difference == 0:
            return 0.0
        a, b, c = (0, 1, 2) if difference > 0 else (2, 1, 0)
        size = i[b] * abs(i[b] - i[a]) * w[b] ** 2 + i[c] * abs(i[c] - i[a]) * w[c] ** 2
        square = abs((i[c] - i[a]) * difference) / (abs(i[c] - i[b]) * size)
        return float(mpmath.sign(difference) * mpmath.sqrt(square))


def _moments(rng: np.random.Generator) -> np.ndarray:
    x, y, z = 10.0 ** rng.uniform(-1.5, 0.0, 3)
    return np.sort([y + z, z + x, x + y])


def _cancelling(rng: np.random.Generator, moments: np.ndarray, relative: float) -> np.ndarray:
    """ω whose two terms of L² − 2T I₂ differ by this part of either, or as little as last bits allow."""
    omega = rng.normal(size=3)
    with mp.workdps(60):
        i1, i2, i3 = (mpf(x) for x in moments)
        ratio = i1 * (i2 - i1) / (i3 * (i3 - i2)) * (1 + mpf(relative))
        best: tuple[Any, np.ndarray] = mpf(1), omega
        for _ in range(200 if abs(relative) < 1e-16 else 1):
            exact = abs(mpf(omega[0])) * mpmath.sqrt(ratio)
            third = float(exact)
            error = abs(exact / mpf(third) - 1)
            if error < best[0]:
                best = error, np.array([omega[0], omega[1], third * np.sign(omega[2])])
            omega[0] = np.nextafter(omega[0], 10 * omega[0])
    return best[1]


def starts(count: int, seed: int = SEED) -> list[Start]:
    """k′ from 0.1 to 1e-16, both sides in turn, half of them by cancelling, half near the middle axis."""
    rng = np.random.default_rng(seed)
    drawn: list[Start] = []
    while len(drawn) < count:
        moments = _moments(rng)
        k = 10.0 ** rng.uniform(-16.0, -1.0)
        side = 1.0 if len(drawn) % 2 else -1.0
        if len(drawn) % 4 < 2:
            omega = _cancelling(rng, moments, side * k * k)
        else:
            tilt = rng.uniform(0.2, 1.0, 2) * [k * (side < 0), k * (side > 0)]
            omega = np.array([tilt[0], rng.choice([-1.0, 1.0]), tilt[1]]) * rng.choice([-1.0, 1.0], 3)
            if len(drawn) % 8 >= 6:
                near = _cancelling(rng, moments, side * rng.uniform(1e-16, 1e-3))
                omega = np.array([k * near[0], omega[1], k * near[2]])
        if complement(moments, omega) == 0.0:
            continue
        attitude = rng.normal(size=4)
        rotation = 2 * np.pi * moments[1] / np.linalg.norm(moments * omega)
        times = ROTATIONS * rotation * rng.uniform(0.5, 1.0, len(ROTATIONS))
        drawn.append(Start(moments, omega, attitude / np.linalg.norm(attitude), times))
    return drawn


class TopStart(NamedTuple):
    """A top about the third axis, its start under gravity (0, 0, −4), the times to ask for in turns."""

    mass: float
    moments: np.ndarray
    height: float
    omega: np.ndarray
    attitude: np.ndarray
    gravity: float
    times: np.ndarray


def top_starts(count: int, seed: int = SEED) -> list[TopStart]:
    """Tops that nearly come to rest upright: `a − b` and the energy left there vanish but for little."""
    rng = np.random.default_rng(seed)
    drawn: list[TopStart] = []
    while len(drawn) < count:
        mass, height, gravity = rng.uniform(0.5, 2.0), rng.uniform(0.2, 0.8), 4.0
        across, along = rng.uniform(0.3, 1.0), rng.uniform(0.1, 0.6)
        theta = rng.uniform(0.3, 2.5)
        attitude = np.array([np.sin(theta / 2), 0.0, 0.0, np.cos(theta / 2)])
        relative = rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-17.0, -3.0)
        with mp.workdps(60):
            I_t = mpf(across) + mpf(mass) * mpf(height) ** 2
            kappa = mpf(mass) * mpf(gravity) * mpf(height) / I_t
            x, w = mpf(attitude[0]), mpf(attitude[3])
            norm = x * x + w * w
            top, sine = 2 * x * x / norm, 2 * x * w / norm
            # b² < 2κ (1 + u)/(1 − u): the axis reaches the top with spin to spare.
            least = mpmath.sqrt(2 * kappa * (2 - top) / top)
            spin = float(rng.uniform(0.1, 0.9) * min(least, 2 * mpmath.sqrt(kappa)) * I_t / mpf(along))
            b = mpf(along) * mpf(spin) / I_t
            second = float(b * top / sine)
            square = 2 * kappa * top * (1 + mpf(relative)) - mpf(second) ** 2
            if square <= 0:
                continue
            first = float(mpmath.sqrt(square))
        omega = np.array([first * rng.choice([-1.0, 1.0]), second, spin])
        fastest = max(float(np.linalg.norm(omega)), float(mpmath.sqrt(kappa)))
        turns = 2 * np.pi / fastest * ROTATIONS * rng.uniform(0.5, 1.0, len(ROTATIONS))
        moments = np.array([across, across, along])
        drawn.append(TopStart(mass, moments, height, omega, attitude, gravity, turns))
    return drawn


def exact_axes(tensor: Any, axes: Any, digits: int = 100) -> tuple[Any, list[list[mpf]]]:
    """Moments and principal axes of a tensor of doubles; or the rotation nearest to `axes`. As rows."""
    with mp.workdps(digits + 20):
        if tensor is not None:
            values, vectors = mpmath.eigsy(mpmath.matrix(np.asarray(tensor).tolist()))
            vectors[:, 2] *= mpmath.sign(mpmath.det(vectors))
            return list(values), vectors.tolist()
        v = mpmath.matrix(np.asarray(axes).tolist())
        for _ in range(8):
            v = (v + (v.T) ** -1) / 2
        return None, v.tolist()
