"""Derivatives of motions of a body with wheels and a slug, by complex steps through SciPy's DOP853.

An imaginary part of 1e-30 in a number goes through the equations of motion as its derivative does, without
the difference of two close numbers: what is left is the error of the integration. The wheels are bodies of
their own in one mass matrix with the body, rather than momenta beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = ["STEP", "Numbers", "derivatives"]

STEP = 1e-30

Numbers = dict[str, Any]
"""The numbers of a motion, by name: arrays of any shape."""


def _times(p: Any, q: Any) -> Any:
    a, b, c, d = p
    x, y, z, w = q
    return np.array(
        [
            d * x + a * w + b * z - c * y,
            d * y - a * z + b * w + c * x,
            d * z + a * y - b * x + c * w,
            d * w - a * x - b * y - c * z,
        ]
    )


def _rates(numbers: Numbers, y: Any) -> Any:
    """Give the rates of (q, ω, Ω of the wheels, σ of the slug)."""
    wheels = len(numbers["inertia"])
    q, w, speed, slug = y[:4], y[4:7], y[7 : 7 + wheels], y[7 + wheels :]
    axes = np.array([a / np.sqrt(a @ a) for a in numbers["axis"]])
    spun = axes * numbers["inertia"][:, None]
    mass = np.block([[numbers["tensor"], spun.T], [spun, np.diag(numbers["inertia"])]])
    spin = numbers["tensor"] @ w + speed @ spun
    torque = numbers["outer"] - np.cross(w, spin)
    motors = numbers["torque"] - numbers["friction"] * speed
    if "K" in numbers:
        # The last wheel has a feedback toward q_target, turned by a small rotation.
        half = np.append(numbers["target"] / 2, 1.0)
        target = _times(numbers["aim"], half)
        error = _times(np.array([-1, -1, -1, 1]) * target, q)
        asked = -(numbers["K"] @ error[:3] + numbers["D"] @ w)
        motors = motors + np.append(np.zeros(wheels - 1), -(axes[-1] @ asked))
    drag = numbers["damping"] * (slug - w)
    force = np.concatenate([torque + drag, motors])
    turned = 0.5 * _times(q, np.append(w, 0.0))
    of_slug = -drag / numbers["slug"] - np.cross(w, slug)
    return np.concatenate([turned, np.linalg.solve(mass, force), of_slug])


def _end(numbers: Numbers, time: float) -> Any:
    """Give (q, ω, h, σ) at the end from such at the start."""
    axes = np.array([a / np.sqrt(a @ a) for a in numbers["axis"]])
    J, w = numbers["inertia"], numbers["omega"]
    half = np.append(numbers["turn"] / 2, 1.0)
    start = np.concatenate([_times(numbers["q"], half), w, numbers["h"] / J - axes @ w, numbers["sigma"]])
    run = solve_ivp(
        lambda _, y: _rates(numbers, y),
        (0.0, time),
        start.astype(complex),
        "DOP853",
        rtol=3e-14,
        atol=1e-15,
    )
    y = run.y[:, -1]
    count = len(J)
    y[7 : 7 + count] = J * (y[7 : 7 + count] + axes @ y[4:7])
    return y


def derivatives(
    numbers: Numbers, time: float, names: Iterable[str], begin: Callable[[Numbers], Numbers] = lambda it: it
) -> Numbers:
    """Give, by their names, the derivatives of (δ, ω, h, σ) at the time by each of these numbers.

    `begin` fills in the numbers that follow from others.
    """
    found = {}
    for name in names:
        value, columns = np.asarray(numbers[name]), []
        for index in np.ndindex(value.shape):
            moved = value.astype(complex)
            moved[index] += 1j * STEP
            y = _end(begin(numbers | {name: moved}), time)
            q, by = y[:4].real, y.imag / STEP
            tilt = 2 * _times(np.array([-1, -1, -1, 1]) * q, by[:4])[:3] / (q @ q)
            columns.append(np.concatenate([tilt, by[4:]]))
        found[name] = np.array(columns).T.reshape(-1, *value.shape)
    return found
