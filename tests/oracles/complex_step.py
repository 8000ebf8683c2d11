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
    a, b, c, d = np.moveaxis(p, -1, 0)
    x, y, z, w = np.moveaxis(q, -1, 0)
    parts = (
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    )
    return np.stack(parts, axis=-1)


def _with(vectors: Any, last: float) -> Any:
    """Give the vectors with one more component, which is the same in all."""
    return np.concatenate([vectors, np.full((len(vectors), 1), last)], axis=1)


def _applied(matrices: Any, vectors: Any) -> Any:
    return np.einsum("nij,nj->ni", matrices, vectors)


def _units(axes: Any) -> Any:
    return axes / np.sqrt(np.sum(axes * axes, axis=-1))[..., None]


def _mass(numbers: Numbers) -> Any:
    """Give the mass matrix of a body and its wheels."""
    inertia = numbers["inertia"]
    spun = _units(numbers["axis"]) * inertia[:, :, None]
    n, wheels = inertia.shape
    mass = np.zeros((n, 3 + wheels, 3 + wheels), dtype=complex)
    mass[:, :3, :3], mass[:, :3, 3:], mass[:, 3:, :3] = numbers["tensor"], spun.transpose(0, 2, 1), spun
    for k in range(wheels):
        mass[:, 3 + k, 3 + k] = inertia[:, k]
    return mass


def _rates(numbers: Numbers, mass: Any, y: Any) -> Any:
    """Give the rates of (q, ω, Ω of the wheels, σ of the slug); motions are rows, as in `numbers`."""
    wheels = numbers["inertia"].shape[1]
    q, w, speed, slug = y[:, :4], y[:, 4:7], y[:, 7 : 7 + wheels], y[:, 7 + wheels :]
    spin = _applied(mass[:, :3], np.concatenate([w, speed], axis=1))
    torque = numbers["outer"] - np.cross(w, spin)
    motors = numbers["torque"] - numbers["friction"] * speed
    if "K" in numbers:
        # The last wheel has a feedback toward q_target, turned by a small rotation.
        target = _times(numbers["aim"], _with(numbers["target"] / 2, 1.0))
        error = _times(np.array([-1, -1, -1, 1]) * target, q)
        asked = -(_applied(numbers["K"], error[:, :3]) + _applied(numbers["D"], w))
        motors[:, -1] -= np.sum(_units(numbers["axis"])[:, -1] * asked, axis=1)
    drag = numbers["damping"][:, None] * (slug - w)
    force = np.concatenate([torque + drag, motors], axis=1)
    turned = 0.5 * _times(q, _with(w, 0.0))
    of_slug = -drag / numbers["slug"][:, None] - np.cross(w, slug)
    return np.concatenate([turned, np.linalg.solve(mass, force[..., None])[..., 0], of_slug], axis=1)


def _ends(numbers: Numbers, time: float) -> Any:
    """Give (q, ω, h, σ) at the end from such at the start, of motions that are rows: in the same steps."""
    axes, J, w = _units(numbers["axis"]), numbers["inertia"], numbers["omega"]
    speed = numbers["h"] / J - _applied(axes, w)
    turned = _times(numbers["q"], _with(numbers["turn"] / 2, 1.0))
    start = np.concatenate([turned, w, speed, numbers["sigma"]], axis=1).astype(complex)
    mass = _mass(numbers)
    run = solve_ivp(
        lambda _, y: _rates(numbers, mass, y.reshape(start.shape)).ravel(),
        (0.0, time),
        start.ravel(),
        "DOP853",
        rtol=3e-14,
        atol=1e-15,
    )
    y = run.y[:, -1].reshape(start.shape)
    count = J.shape[1]
    y[:, 7 : 7 + count] = J * (y[:, 7 : 7 + count] + _applied(axes, y[:, 4:7]))
    return y


def derivatives(
    numbers: Numbers, time: float, names: Iterable[str], begin: Callable[[Numbers], Numbers] = lambda it: it
) -> Numbers:
    """Give, by their names, the derivatives of (δ, ω, h, σ) at the time by each of these numbers.

    `begin` fills in the numbers that follow from others.
    """
    values = {name: np.asarray(numbers[name]) for name in names}
    moved = []
    for name, value in values.items():
        for index in np.ndindex(value.shape):
            changed = value.astype(complex)
            changed[index] += 1j * STEP
            moved.append(begin(numbers | {name: changed}))
    rows = {name: np.array([one[name] for one in moved]) for name in moved[0]}
    y = _ends(rows, time)
    q, by = y[:, :4].real, y.imag / STEP
    tilt = 2 * _times(np.array([-1, -1, -1, 1]) * q, by[:, :4])[:, :3] / np.sum(q * q, axis=1)[:, None]
    columns = np.concatenate([tilt, by[:, 4:]], axis=1).T
    found, at = {}, 0
    for name, value in values.items():
        found[name] = columns[:, at : at + value.size].reshape(-1, *value.shape)
        at += value.size
    return found
