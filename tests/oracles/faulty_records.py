"""Records of motions with one mistake each, by SciPy's integrator and by simple steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from polhode import RigidBody
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Floats = NDArray[Any]
Rate = Callable[[Floats, Floats], Floats]


class Record(NamedTuple):
    """What a program writes: times, attitudes, angular velocities."""

    t: Floats
    quaternion: Floats
    omega: Floats


def random_body(rng: np.random.Generator) -> RigidBody:
    """A body whose tensor has products of inertia of some size."""
    while True:
        moments = np.sort(rng.uniform(1.0, 3.0, 3))
        if moments[2] < 0.95 * moments[:2].sum() and np.diff(moments).min() > 0.15:
            turn = Rotation.random(rng=rng).as_matrix()
            tensor = turn @ np.diag(moments) @ turn.T
            if np.abs(tensor - np.diag(tensor.diagonal())).max() > 0.1:
                return RigidBody(1.0, tensor)


def integrated(t: Floats, start: Floats, rate: Rate, attitude: Floats) -> Record:
    """Integrate ω̇ = rate(ω, R) and the attitude, by SciPy's method of eighth order."""

    def slope(_: float, y: Floats) -> Floats:
        omega, q = y[:3], y[3:]
        x, y_, z, w = q
        a, b, c = omega
        turned = 0.5 * np.array(
            [w * a + y_ * c - z * b, w * b + z * a - x * c, w * c + x * b - y_ * a, -(x * a + y_ * b + z * c)]
        )
        return np.concatenate((rate(omega, q), turned))

    found = solve_ivp(slope, (t[0], t[-1]), [*start, *attitude], "DOP853", t, rtol=1e-12, atol=1e-13).y.T
    return Record(t, found[:, 3:] / np.linalg.norm(found[:, 3:], axis=1, keepdims=True), found[:, :3])


def stepped(t: Floats, start: Floats, tensor: Floats, attitude: Floats, *, late: bool, inside: int) -> Record:
    """Take explicit steps of Euler's method in ω; the attitude turns with the old ω, or with the new one."""
    inverse = np.linalg.inv(tensor)
    step = (t[1] - t[0]) / inside
    omega, turn = start, Rotation.from_quat(attitude)
    rows = [(turn.as_quat(), omega)]
    for _ in t[1:]:
        for _ in range(inside):
            new = omega - step * inverse @ np.cross(omega, tensor @ omega)
            turn = turn * Rotation.from_rotvec(step * (omega if late else new))
            omega = new
        rows.append((turn.as_quat(), omega))
    return Record(t, np.array([q for q, _ in rows]), np.array([w for _, w in rows]))


def kept_momentum(t: Floats, start: Floats, tensor: Floats, attitude: Floats) -> Record:
    """Keep the angular momentum in space, and turn by steps of first order."""
    inverse, step = np.linalg.inv(tensor), t[1] - t[0]
    turn = Rotation.from_quat(attitude)
    momentum = turn.apply(tensor @ start)
    rows = []
    for _ in t:
        omega = inverse @ turn.inv().apply(momentum)
        rows.append((turn.as_quat(), omega))
        turn = turn * Rotation.from_rotvec(step * omega)
    return Record(t, np.array([q for q, _ in rows]), np.array([w for _, w in rows]))


def free(tensor: Floats, gyroscopic: float = 1.0) -> Rate:
    inverse = np.linalg.inv(tensor)
    return lambda omega, _: -gyroscopic * inverse @ np.cross(omega, tensor @ omega)


def records(body: RigidBody, rng: np.random.Generator, rows: int = 600) -> dict[str, tuple[str, Record]]:
    """One record for each mistake, by its name, with the kind of the finding; "" for those without one."""
    tensor = np.array(body.inertia)
    inverse = np.linalg.inv(tensor)
    start = rng.normal(size=3)
    start *= 1.0 / np.linalg.norm(start)
    attitude = Rotation.random(rng=rng).as_quat()
    step = rng.uniform(0.03, 0.08)
    t = step * np.arange(rows)
    uneven = np.cumsum(rng.uniform(0.5, 1.5, rows) * step)
    right = integrated(t, start, free(tensor), attitude)
    turn = Rotation.from_quat(right.quaternion)
    diagonal = np.diag(tensor.diagonal())
    push, rate = 0.02 * rng.normal(size=3), rng.uniform(0.005, 0.02)
    jumped = t.copy()
    row = int(rng.integers(rows // 4, 3 * rows // 4))
    jumped[row:] += rng.uniform(1.0, 20.0) * step

    def plus(torque: Rate, at: Floats = t) -> Record:
        plain = free(tensor)
        return integrated(at, start, lambda w, q: plain(w, q) + inverse @ torque(w, q), attitude)

    return {
        "right": ("", right),
        "right, uneven": ("", integrated(uneven, start, free(tensor), attitude)),
        "scalar first": ("scalar-first", right._replace(quaternion=right.quaternion[:, [3, 0, 1, 2]])),
        "inverse": ("inverse attitude", right._replace(quaternion=turn.inv().as_quat())),
        "space axes": ("space-axes omega", right._replace(omega=turn.apply(right.omega))),
        "degrees": ("degrees", right._replace(omega=np.rad2deg(right.omega))),
        "jump": ("clock", right._replace(t=jumped)),
        "no gyroscopic term": ("no gyroscopic term", integrated(t, start, free(tensor, 0.0), attitude)),
        "doubled": ("doubled gyroscopic term", integrated(uneven, start, free(tensor, 2.0), attitude)),
        "diagonal": ("diagonal tensor", integrated(uneven, start, free(diagonal), attitude)),
        "products": (
            "products of the other sign",
            integrated(t, start, free(2 * diagonal - tensor), attitude),
        ),
        "torque": ("undeclared torque", plus(lambda *_: push, uneven)),
        "torque in space": (
            "undeclared torque",
            plus(lambda _, q: Rotation.from_quat(q).inv().apply(push)),
        ),
        "drag": ("undeclared damping", plus(lambda w, _: -rate * w)),
        "damping of momentum": ("undeclared damping", plus(lambda w, _: -rate * tensor @ w)),
        "explicit": ("first-order step", stepped(t, start, tensor, attitude, late=True, inside=1)),
        "semi-implicit": ("first-order step", stepped(t, start, tensor, attitude, late=False, inside=1)),
        "substeps": ("first-order step", stepped(t, start, tensor, attitude, late=False, inside=4)),
        "kept momentum": ("first-order step", kept_momentum(t, start, tensor, attitude)),
    }


def noisy(record: Record, noise: float, rng: np.random.Generator) -> Record:
    """Add white noise: of rotations, and relative to the size of ω."""
    if not noise:
        return record
    shake = Rotation.from_rotvec(noise * rng.normal(size=record.omega.shape))
    size = np.linalg.norm(record.omega, axis=1).mean()
    return record._replace(
        quaternion=_shaken(record.quaternion, shake),
        omega=record.omega + noise * size * rng.normal(size=record.omega.shape),
    )


def _shaken(quaternions: Floats, shake: Any) -> Floats:
    found: Floats = (Rotation.from_quat(quaternions) * shake).as_quat()
    return np.asarray(found * np.sign((found * quaternions).sum(1, keepdims=True)))
