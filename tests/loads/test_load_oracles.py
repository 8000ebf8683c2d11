"""The committed cases of simulated motion against SciPy, conservation laws and Kovalevskaya's integral."""

from __future__ import annotations

import json
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from oracles import load_cases
from oracles.by_scipy import by_dop853, full_tensor, product
from oracles.motion_cases import MotionCase, State, angle, apart, load_table, named, relative_error
from oracles.returning import unit
from oracles.rotation import apply, inverse, turned

CASES = load_table(load_cases.NAME)
SOON = (
    "constant torque: body, full tensor",
    "damping: both",
    "feedback: generic",
    "six degrees of freedom: thrust",
)


def of_kind(*kinds: str) -> pytest.MarkDecorator:
    return named(case for case in CASES if case.kind in kinds)


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
            # Errors of 1e-10 change a difference over 2e-5 by less than a hundredth of the bar.
            if k < 3:
                turn = np.array([*sign * push / 2, 1.0])
                attitude = product(np.array(unit_floats(case)), turn)
                pair.append(by_dop853(case, t, attitude=attitude, rtol=1e-10, atol=1e-11))
            else:
                omega = np.array(case.omega) + sign * rate * push
                pair.append(by_dop853(case, t, omega=omega, rtol=1e-10, atol=1e-11))
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
