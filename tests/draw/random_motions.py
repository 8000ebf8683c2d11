"""Random motions of every kind: free, with wheels, driven inside, under loads, tops; degenerate ones too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import polhode
from polhode import RigidBody, loads
from random_matter import generator, power

__all__ = ["KINDS", "Motion", "motion"]

Rng = np.random.Generator
Load = Any
"""A load, or None."""


class Motion(NamedTuple):
    """A motion and what is known of it from how it was made.

    ``tensor`` is I in the equations of motion about the reference point, ``rotor`` the constant momentum h in
    the body, None where there is none; ``end`` is the time to which a motion in closed form is shown.
    """

    kind: str
    motion: Any
    end: float | None
    tensor: np.ndarray
    rotor: np.ndarray | None = None


def motion(kind: str, number: int) -> Motion:
    """Draw a motion of a kind, by its number alone."""
    return KINDS[kind](generator(f"motion {kind}", number))


def body(rng: Rng) -> RigidBody:
    """A body with turned axes: asymmetric, or with equal moments, or a needle, or flat."""
    a, b, c = rng.uniform(0.05, 1.0, 3)
    match rng.integers(8):
        case 0:
            a = b  # symmetric
        case 1:
            a = b = c
        case 2:
            b = c = 1e-3 * a  # a needle, whose ellipsoid is long
        case 3:
            c = 0.0  # flat
    moments = power(rng, -2, 3) * np.sort([b + c, a + c, a + b])
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    center = rng.normal(size=3) if rng.integers(2) else np.zeros(3)
    return RigidBody.from_principal(power(rng, -1, 2), moments, axes, center)


def spin(rng: Rng) -> np.ndarray:
    omega: np.ndarray = rng.normal(size=3) * power(rng, -2, 2)
    return omega


def attitude(rng: Rng) -> np.ndarray:
    four = rng.normal(size=4)
    unit: np.ndarray = four / np.linalg.norm(four)
    return unit


def length(omega: np.ndarray) -> float:
    """How long a body turns about twice."""
    return 12.0 / max(float(np.linalg.norm(omega)), 1e-3)


def run(rng: Rng, one: RigidBody, omega: np.ndarray, load: Load, about: Any = "center_of_mass") -> Any:
    """A run whose samples are close enough for a page, however fast the load makes the body turn."""
    start, end = attitude(rng), length(omega)
    while True:
        t = np.linspace(0.0, end, 101)
        made = one.simulate(t, omega, start, load=load, about=about)
        if np.linalg.norm(made.omega, axis=1).max() * t[1] < 1.0:
            return made
        end /= 10.0


def free(rng: Rng) -> Motion:
    one, omega = body(rng), spin(rng)
    match rng.integers(8):
        case 0:  # steady
            omega = one.principal.axes[:, rng.integers(3)] * power(rng, -2, 2)
        case 1:  # hardly about the intermediate axis
            omega = one.principal.axes @ (1e-4, 1.0, 1e-4) * power(rng, -2, 2)
        case 2:
            omega = np.zeros(3)
        case 3:  # a rod
            moment = power(rng, -2, 2)
            one = RigidBody.from_principal(1.0, (0.0, moment, moment), one.principal.axes)
            if rng.integers(2):
                omega = omega - one.principal.axes[:, 0] * (one.principal.axes[:, 0] @ omega)
        case 4:  # about a fixed point, without a torque
            made = run(rng, one, omega, None, "origin")
            return Motion("free", made, None, one.inertia_about("origin"))
        case 5:  # thrown
            made = run(rng, one, omega, loads.uniform_gravity((0.0, 0.0, -9.81)))
            return Motion("free", made, None, one.inertia)
        case 6:
            return Motion("free", run(rng, one, omega, None), None, one.inertia)
    return Motion("free", one.free_motion(omega, attitude(rng)), length(omega), one.inertia)


def inside(rng: Rng, one: RigidBody, omega: np.ndarray) -> np.ndarray:
    """A momentum inside, from far less to more than that of the body."""
    h = rng.normal(size=3) * power(rng, -1.5, 0.7)
    momentum: np.ndarray = h * max(float(np.linalg.norm(one.inertia @ omega)), 1e-3)
    return momentum


def wheels(rng: Rng, one: RigidBody, omega: np.ndarray) -> list[tuple[np.ndarray, float, float, str]]:
    """Axes, inertias, rates and modes of one to three wheels; free ones take part of a moment of the body."""
    made = []
    for _ in range(rng.integers(1, 4)):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        inertia = rng.uniform(0.02, 0.25) / float(axis @ np.linalg.inv(one.inertia) @ axis)
        rate = float(inside(rng, one, omega)[0]) / inertia
        made.append((axis, inertia, rate, str(rng.choice(["free", "held"]))))
    return made


def gyrostat(rng: Rng) -> Motion:
    one, omega = body(rng), spin(rng)
    if rng.integers(2):
        h = inside(rng, one, omega)
        if rng.integers(4) == 0:  # along an axis
            h = one.principal.axes[:, rng.integers(3)] * np.linalg.norm(h)
        made = one.gyrostat(h)
        if rng.integers(3) == 0:  # near a saddle, if there is one
            size = float(np.linalg.norm(one.inertia @ omega + h))
            found = made.equilibria(size)
            saddles = found.omega[found.kind == "saddle"]
            if len(saddles):
                omega = saddles[0] * (1.0 + 1e-3 * rng.normal(size=3))
        tensor = one.inertia
    else:
        parts = wheels(rng, one, omega)
        turning = [
            polhode.wheel(axis=axis, inertia=inertia, rate=rate, mode=mode)  # type: ignore[arg-type]
            for axis, inertia, rate, mode in parts
        ]
        made = one.gyrostat(wheels=turning)
        tensor, h = constants(one.inertia, omega, parts)
    shown, end = made.free_motion(omega, attitude(rng)), length(omega)
    if rng.integers(3) == 0:
        return Motion("gyrostat", shown.at(np.linspace(0.5 * end, end, 101)), None, tensor, h)
    return Motion("gyrostat", shown, end, tensor, h)


def constants(
    tensor: np.ndarray, omega: np.ndarray, parts: list[tuple[np.ndarray, float, float, str]]
) -> tuple[np.ndarray, np.ndarray]:
    """I without the free wheels and h with the constant momenta of all."""
    tensor, h = tensor.copy(), np.zeros(3)
    for axis, inertia, rate, mode in parts:
        if mode == "free":
            tensor -= inertia * np.outer(axis, axis)
            h += inertia * (rate + axis @ omega) * axis
        else:
            h += inertia * rate * axis
    return tensor, h


def simulated_gyrostat(rng: Rng) -> Motion:
    """A gyrostat as a load: rotors, free wheels and wheels at constant speeds; about C or a fixed point."""
    one, omega = body(rng), spin(rng)
    pivoted = bool(rng.integers(2))
    parts = wheels(rng, one, omega)
    load: Load = sum(
        loads.wheel(axis, inertia, rate) if mode == "free" else loads.wheel(axis, inertia, speed=rate)
        for axis, inertia, rate, mode in parts
    )
    base = one.inertia_about("origin") if pivoted else one.inertia
    tensor, h = constants(base, omega, parts)
    if rng.integers(2):
        rotor = inside(rng, one, omega)
        load, h = load + 0.5 * loads.rotor(2.0 * rotor), h + rotor
    if rng.integers(2) and not pivoted:
        load = load + loads.uniform_gravity((0.0, -1.0, 0.0))
    made = run(rng, one, omega, load, "origin" if pivoted else "center_of_mass")
    return Motion("gyrostat", made, None, tensor, h)


def torque_free(rng: Rng) -> Motion:
    """Motors, friction and dampers inside the body."""
    one, omega = body(rng), spin(rng)
    ((axis, inertia, rate, _), *_) = wheels(rng, one, omega)
    push = inertia * rate * float(np.linalg.norm(omega))
    end = length(omega)
    match rng.integers(5):
        case 0:
            load: Load = loads.wheel(axis, inertia, rate, torque=push)
        case 1:
            load = loads.wheel(axis, inertia, rate, friction=0.3 * inertia * float(np.linalg.norm(omega)))
        case 2:
            load = loads.wheel(axis, inertia, speed=[0.0, rate], times=[0.0, end])
        case 3:
            load = loads.slug(inertia, 0.5 * inertia * float(np.linalg.norm(omega)))
        case _:
            size = float(np.linalg.norm(omega))
            control = loads.feedback(K=inertia * size**2, D=inertia * size, target=(0, 0, 0, 1))
            load = loads.wheel(axis, inertia, rate, torque=control)
    return Motion("torque-free", run(rng, one, omega, load), None, one.inertia)


def loaded(rng: Rng) -> Motion:
    one, omega = body(rng), spin(rng)
    size, moment = float(np.linalg.norm(omega)), float(one.principal_moments[2])
    torque = 0.2 * moment * size**2
    match rng.integers(5):
        case 0:
            load: Load = loads.constant_torque(rng.normal(size=3) * torque, "body")
        case 1:
            load = loads.damping(0.1 * moment * size * np.eye(3))
        case 2:
            load = loads.gravity_gradient(size**2, (1.0, 0.0, 0.0), (0.0, size, 0.0))
        case 3:
            load = loads.feedback(K=torque, D=torque / size, target=(0, 0, 0, 1))
        case _:
            load = loads.sampled([0.0, 1e6], rng.normal(size=(2, 3)) * torque)
    if rng.integers(3) == 0:
        load = load + loads.rotor(0.3 * inside(rng, one, omega))
    return Motion("loaded", run(rng, one, omega, load), None, one.inertia)


def top(rng: Rng) -> Motion:
    """Bodies with a fixed point under gravity: symmetric ones in closed form, others simulated."""
    moment, axial = power(rng, -1, 1), power(rng, -1, 0)
    arm = rng.uniform(0.1, 1.0)
    omega = rng.normal(size=3) * power(rng, -0.3, 1)
    if rng.integers(2):
        one = RigidBody(1.0, np.diag([moment, moment, 2.0 * axial * moment]), (0.0, 0.0, arm))
        shown = one.heavy_top(omega, attitude(rng), (0.0, 0.0, -power(rng, -1, 1)))
        return Motion("loaded", shown, length(omega), one.inertia_about("origin"))
    one = RigidBody(1.0, moment * np.diag([1.0, 1.2, 1.5]), rng.normal(size=3) * arm)
    gravity: Load = loads.uniform_gravity((0.0, 0.0, -power(rng, -1, 1)))
    if rng.integers(2):
        gravity = gravity + loads.wheel((0.0, 0.0, 1.0), 0.1 * moment, 3.0)
    return Motion("loaded", run(rng, one, omega, gravity, "origin"), None, one.inertia_about("origin"))


KINDS: dict[str, Callable[[Rng], Motion]] = {
    "free": free,
    "gyrostat": gyrostat,
    "simulated gyrostat": simulated_gyrostat,
    "torque-free": torque_free,
    "loaded": loaded,
    "top": top,
}
