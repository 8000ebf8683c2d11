"""The committed cases of simulated motion against SciPy, conservation laws and Kovalevskaya's integral."""

from __future__ import annotations

import json
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from oracles import load_cases
from oracles.bodies import matrix
from oracles.motion_cases import MotionCase, State, angle, apart, load_table, relative_error
from oracles.returning import unit
from oracles.rotation import apply, inverse, turned
from scipy.integrate import solve_ivp

CASES = load_table(load_cases.NAME)
SOON = (
    "constant torque: body, full tensor",
    "damping: both",
    "feedback: generic",
    "six degrees of freedom: thrust",
)


def named(cases: Any) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("case", tuple(cases), ids=lambda case: case.name)


def of_kind(*kinds: str) -> pytest.MarkDecorator:
    return named(case for case in CASES if case.kind in kinds)


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    vector = p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3])
    return np.array([*vector, p[3] * q[3] - p[:3] @ q[:3]])


def wrench(
    load: dict[str, Any], t: float, w: np.ndarray, q: np.ndarray, r: np.ndarray, case: MotionCase
) -> Any:
    """Torque in the body and force in space of one load, written down once more in plain NumPy."""
    R, nothing = matrix(q), np.zeros(3)
    c = np.array(case.body.get("center_of_mass", (0, 0, 0)))
    reference = nothing if case.about == "origin" else c
    full = {key: value for key, value in load.items() if key != "kind"}
    match load["kind"]:
        case "uniform_gravity":
            force = case.body["mass"] * np.array(full["gravity"])
            return np.cross(c - reference, R.T @ force), force
        case "constant_torque":
            v = np.array(full["vector"])
            return (v if full["frame"] == "body" else R.T @ v), nothing
        case "constant_force":
            v = np.array(full["vector"])
            force = R @ v if full["frame"] == "body" else v
            return np.cross(np.array(full["point"]) - reference, R.T @ force), force
        case "sinusoidal_torque":
            return np.array(full["vector"]) * np.sin(full["rate"] * t + full["phase"]), nothing
        case "damping":
            linear, quadratic = (_matrix(full.get(key, 0.0)) for key in ("matrix", "quadratic"))
            return -linear @ w - quadratic @ w * np.linalg.norm(w), nothing
        case "gravity_gradient":
            body = R.T @ r
            pull = 3 * full["mu"] / np.linalg.norm(r) ** 5
            return pull * np.cross(body, tensor(case) @ body), nothing
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


def by_dop853(case: MotionCase, t: float, omega: Any = None, attitude: Any = None) -> State:
    I, mass = tensor(case), case.body["mass"]
    orbit = next((load for load in case.load if load["kind"] == "gravity_gradient"), None)
    position, velocity = case.position or (0, 0, 0), case.velocity or (0, 0, 0)
    if orbit:
        position, velocity = orbit["position"], orbit["velocity"]

    def rhs(t: float, y: np.ndarray) -> np.ndarray:
        w, q, r, v = y[:3], y[3:7], y[7:10], y[10:]
        pairs = [wrench(load, t, w, q / np.linalg.norm(q), r, case) for load in case.load]
        torque, force = (sum(x) for x in zip(*pairs, strict=True))
        rate = np.linalg.solve(I, torque - np.cross(w, I @ w))
        fall = -orbit["mu"] * r / np.linalg.norm(r) ** 3 if orbit else force / mass
        return np.array([*rate, *product(q, np.array([*w, 0.0])) / 2, *v, *fall])

    q = np.array(case.attitude if attitude is None else attitude)
    start = [*(case.omega if omega is None else omega), *q / np.linalg.norm(q), *position, *velocity]
    y = solve_ivp(rhs, (0, t), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    return State(y[:3], y[3:7], y[7:10], y[10:])


@named(CASES)
def test_scipy_agrees(case: MotionCase) -> None:
    got, want = by_dop853(case, case.times[0]), case.expected[0]
    assert angle(got.quaternion, want.quaternion) < 1e-9
    assert relative_error(got.omega, want.omega, at_least=float(np.linalg.norm(case.omega))) < 1e-9
    if case.position:
        assert relative_error(got.position, want.position) < 1e-9
        assert relative_error(got.velocity, want.velocity) < 1e-9


@named(case for case in CASES if case.name in SOON)
def test_the_table_comes_out_again(case: MotionCase) -> None:
    soon = case._replace(times=case.times[:1])
    assert apart(load_cases.solve(soon, 45)[0], case.expected[0]) < mpf(10) ** -38


def test_the_table_holds_the_cases_of_its_script() -> None:
    assert [inputs(case) for case in CASES] == [inputs(case) for case in load_cases.cases()]


def inputs(case: MotionCase) -> Any:
    return json.loads(json.dumps(case._replace(expected=(), kappa=())._asdict()))


@named(
    case for case in CASES if case.name in (*SOON, "Kovalevskaya top: generic", "gravity gradient: circular")
)
def test_condition_numbers_are_those_of_finite_differences(case: MotionCase) -> None:
    rate, small, t = np.linalg.norm(case.omega), 1e-5, case.times[0]
    columns = []
    for k in range(6):
        push = small * np.eye(3)[k % 3]
        pair = []
        for sign in (1, -1):
            if k < 3:
                turn = np.array([*sign * push / 2, 1.0])
                pair.append(by_dop853(case, t, attitude=product(np.array(unit_floats(case)), turn)))
            else:
                pair.append(by_dop853(case, t, omega=np.array(case.omega) + sign * rate * push))
        plus, minus = pair
        turn = product(np.array(minus.quaternion) * np.array([-1, -1, -1, 1]), np.array(plus.quaternion))
        columns.append([*turn[:3] * 2 * np.sign(turn[3]), *(np.array(plus.omega) - minus.omega) / rate])
    found = np.linalg.norm(np.array(columns).T / (2 * small), 2)
    assert found == pytest.approx(case.kappa[0], rel=1e-3)


def unit_floats(case: MotionCase) -> list[float]:
    return [float(x) for x in unit(case.attitude)]


def invariants(case: MotionCase, state: State) -> tuple[Any, Any]:
    """Energy, and angular momentum in space, of a body that only gravity acts on."""
    L = apply(full_tensor(case), state.omega)
    center = turned(state.quaternion, [mpf(x) for x in case.body.get("center_of_mass", (0, 0, 0))])
    weight = next((x["gravity"] for x in case.load if x["kind"] == "uniform_gravity"), (0, 0, 0))
    energy = mpmath.fdot(L, state.omega) / 2 - mpf(case.body["mass"]) * mpmath.fdot(center, weight)
    return energy, turned(state.quaternion, L)


def start(case: MotionCase) -> State:
    return State([mpf(x) for x in case.omega], unit(case.attitude))


@of_kind("heavy symmetric top", "heavy asymmetric top", "Kovalevskaya top")
def test_tops_keep_energy_and_vertical_momentum(case: MotionCase) -> None:
    with mp.workdps(50):
        energy, momentum = invariants(case, start(case))
        for state in case.expected:
            later, turned_to = invariants(case, state)
            assert abs(later - energy) < mpf(10) ** -37
            assert abs(turned_to[2] - momentum[2]) < mpf(10) ** -37


@of_kind("Kovalevskaya top")
def test_kovalevskaya_keeps_her_integral(case: MotionCase) -> None:
    """|(ω₁ + i ω₂)² − (m g l/C)(γ₁ + i γ₂)|², γ the upward vertical in the body, l along axis 1."""

    def integral(state: State) -> Any:
        inertia = load_cases.inertia_of(case)
        assert inertia[0][0] == inertia[1][1] == 2 * inertia[2][2]
        weight = mpf(case.body["mass"]) * case.body["center_of_mass"][0] * -case.load[0]["gravity"][2]
        up = inverse(state.quaternion, [mpf(0), mpf(0), mpf(1)])
        zeta = mpmath.mpc(state.omega[0], state.omega[1])
        return abs(zeta**2 - weight / inertia[2][2] * mpmath.mpc(up[0], up[1])) ** 2

    with mp.workdps(50):
        for state in case.expected:
            assert abs(integral(state) - integral(start(case))) < mpf(10) ** -37


def test_a_torque_in_space_is_the_rate_of_momentum() -> None:
    for case in CASES:
        if case.name.startswith("constant torque: space"):
            with mp.workdps(50):
                momentum = invariants(case, start(case))[1]
                for t, state in zip(case.times, case.expected, strict=True):
                    grown = invariants(case, state)[1]
                    torque = case.load[0]["vector"]
                    want = [x + mpf(t) * mpf(y) for x, y in zip(momentum, torque, strict=True)]
                    assert max(abs(x - y) for x, y in zip(grown, want, strict=True)) < mpf(10) ** -36
