"""Loaded bodies by SciPy's DOP853, the loads written down once more in plain NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import mpf
from scipy.integrate import solve_ivp

from oracles import load_cases
from oracles.bodies import matrix
from oracles.motion_cases import MotionCase, State

__all__ = ["by_dop853", "full_tensor", "product"]


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a×b of two vectors: that of NumPy takes ten times as long for a single pair."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    vector = p[3] * q[:3] + q[3] * p[:3] + cross(p[:3], q[:3])
    return np.array([*vector, p[3] * q[3] - p[:3] @ q[:3]])


def wrench(
    load: dict[str, Any],
    t: float,
    w: np.ndarray,
    q: np.ndarray,
    r: np.ndarray,
    case: MotionCase,
    I: np.ndarray,
) -> Any:
    """Torque in the body and force in space of one load, written down once more in plain NumPy."""
    R, nothing = matrix(q), np.zeros(3)
    c = np.array(case.body.get("center_of_mass", (0, 0, 0)))
    reference = nothing if case.about == "origin" else c
    full = {key: value for key, value in load.items() if key != "kind"}
    match load["kind"]:
        case "uniform_gravity":
            force = case.body["mass"] * np.array(full["gravity"])
            return cross(c - reference, R.T @ force), force
        case "constant_torque":
            v = np.array(full["vector"])
            return (v if full["frame"] == "body" else R.T @ v), nothing
        case "constant_force":
            v = np.array(full["vector"])
            force = R @ v if full["frame"] == "body" else v
            return cross(np.array(full["point"]) - reference, R.T @ force), force
        case "sinusoidal_torque":
            return np.array(full["vector"]) * np.sin(full["rate"] * t + full["phase"]), nothing
        case "damping":
            linear, quadratic = (_matrix(full.get(key, 0.0)) for key in ("matrix", "quadratic"))
            return -linear @ w - quadratic @ w * np.linalg.norm(w), nothing
        case "gravity_gradient":
            body = R.T @ r
            pull = 3 * full["mu"] / np.linalg.norm(r) ** 5
            return pull * cross(body, I @ body), nothing
    target = np.array(full["target"]) * np.array([-1, -1, -1, 1])
    e = product(target, q)
    return -_matrix(full["K"]) @ e[:3] * np.sign(e[3]) - _matrix(full["D"]) @ w, nothing


def _matrix(x: Any) -> np.ndarray:
    return np.array(x * np.eye(3) if np.ndim(x) == 0 else x)


def tensor(case: MotionCase) -> np.ndarray:
    """About the reference point, rounded."""
    I = np.array([[float(x) for x in row] for row in full_tensor(case)])
    return np.asarray((I + I.T) / 2)


def full_tensor(case: MotionCase) -> list[list[Any]]:
    """About the reference point, exact."""
    I = load_cases.inertia_of(case)
    if isinstance(I[0], list | tuple):
        return [[mpf(x) for x in row] for row in I]
    return [[mpf(x) if i == j else mpf(0) for j in range(3)] for i, x in enumerate(I)]


def by_dop853(
    case: MotionCase,
    t: float,
    omega: Any = None,
    attitude: Any = None,
    rtol: float = 1e-12,
    atol: float = 1e-13,
) -> State:
    """By SciPy, at one tolerance for all components."""
    I, mass = tensor(case), case.body["mass"]
    orbit = next((load for load in case.load if load["kind"] == "gravity_gradient"), None)
    position, velocity = case.position or (0, 0, 0), case.velocity or (0, 0, 0)
    if orbit:
        position, velocity = orbit["position"], orbit["velocity"]

    def rhs(t: float, y: np.ndarray) -> np.ndarray:
        w, q, r, v = y[:3], y[3:7], y[7:10], y[10:]
        pairs = [wrench(load, t, w, q / np.linalg.norm(q), r, case, I) for load in case.load]
        torque, force = (sum(x) for x in zip(*pairs, strict=True))
        rate = np.linalg.solve(I, torque - cross(w, I @ w))
        fall = -orbit["mu"] * r / np.linalg.norm(r) ** 3 if orbit else force / mass
        return np.array([*rate, *product(q, np.array([*w, 0.0])) / 2, *v, *fall])

    q = np.array(case.attitude if attitude is None else attitude)
    start = [*(case.omega if omega is None else omega), *q / np.linalg.norm(q), *position, *velocity]
    y = solve_ivp(rhs, (0, t), start, "DOP853", rtol=rtol, atol=atol).y[:, -1]
    return State(y[:3], y[3:7], y[7:10], y[10:])
