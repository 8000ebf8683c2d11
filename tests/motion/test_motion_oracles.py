"""The committed cases of motion against what they were not made with: closed forms, SciPy, laws."""

from __future__ import annotations

import json
from typing import Any

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from oracles import free_cases, top_cases
from oracles.acting import Weight
from oracles.jacobi import JacobiMotion
from oracles.motion_cases import MotionCase, State, angle, apart, load_table, named, relative_error
from oracles.rotation import Rotation, apply, cross, inverse, turned
from oracles.taylor import steps
from scipy.integrate import solve_ivp

FREE = load_table(free_cases.NAME)
TOPS = load_table(top_cases.NAME)


def tensor(case: MotionCase) -> np.ndarray:
    """About the centre of mass, or about the origin where that is held."""
    body = case.body
    I = np.diag(body["moments"]) if "moments" in body else np.array(body["inertia"])
    c = np.array(body.get("center_of_mass", (0, 0, 0)))
    return I + body["mass"] * (c @ c * np.eye(3) - np.outer(c, c)) if case.about == "origin" else I


def by_dop853(case: MotionCase, t: float) -> State:
    """Rates and attitude by SciPy, with weight in a body that is held at its origin."""
    I = tensor(case)
    rod = np.diag(I) == 0
    solve = np.linalg.inv(I + np.diag(rod * I.max()))
    c, g = (
        case.body["mass"] * np.array(case.body.get("center_of_mass", (0, 0, 0))),
        np.array(case.gravity or (0, 0, 0)),
    )

    def rhs(_t: float, y: np.ndarray) -> np.ndarray:
        w, v, s = y[:3], y[3:6], y[6]
        weight = g - 2 * s * np.cross(v, g) + 2 * np.cross(v, np.cross(v, g))
        rate = solve @ (np.cross(I @ w, w) + np.cross(c, weight))
        return np.array([*(rate * ~rod), *(s * w + np.cross(v, w)) / 2, -v @ w / 2])

    q = np.array(case.attitude) / np.linalg.norm(case.attitude)
    y = solve_ivp(rhs, (0, t), [*case.omega, *q], "DOP853", rtol=1e-12, atol=1e-13 * min(1, 1 / t)).y[:, -1]
    return State(y[:3], y[3:])


LATER = [case.name for at, case in enumerate(FREE + TOPS) if at % 3 or case.name == "thin: needle, spinning"]
"""Of three cases two, and the slowest one, run in `make test-long`."""


@named(FREE + TOPS, long=LATER)
def test_scipy_agrees(case: MotionCase) -> None:
    got, want = by_dop853(case, case.times[0]), case.expected[0]
    rate = 2 * np.pi / case.times[0]
    assert angle(got.quaternion, want.quaternion) < 1e-8
    assert relative_error(got.omega, want.omega, at_least=rate) < 1e-8


def asymmetric(case: MotionCase) -> bool:
    """Three different moments, and a motion that returns."""
    moments = case.body.get("moments", (0, 0, 0))
    return 0 < moments[0] < moments[1] < moments[2] and case.kind not in ("separatrix", "pure spin")


@named(tuple(filter(asymmetric, FREE)))
def test_jacobi_agrees_to_38_digits(case: MotionCase) -> None:
    motion = JacobiMotion(case.body["moments"], case.omega, case.attitude)
    for t, want in zip(case.times, case.expected, strict=True):
        assert apart(want, State(*motion.at(t))) < mpf(10) ** -38


@named(FREE)
def test_free_bodies_keep_energy_and_momentum(case: MotionCase) -> None:
    with mp.workdps(50):
        start = State(case.omega, unit(case.attitude))
        energy, momentum = invariants(case, start)
        for state in case.expected:
            after, turned_to = invariants(case, state)
            assert abs(after / energy - 1) < mpf(10) ** -37
            assert mpmath.norm(minus(turned_to, momentum)) < mpf(10) ** -37 * mpmath.norm(momentum)


@named(TOPS)
def test_tops_keep_energy_and_two_momenta(case: MotionCase) -> None:
    with mp.workdps(50):
        start = State([mpf(x) for x in case.omega], unit(case.attitude))
        values = [top_invariants(case, state) for state in (start, *case.expected)]
        scale = [max(mpf(1), abs(x)) for x in values[0]]
        for after in values[1:]:
            assert (
                max(abs(x - y) / s for x, y, s in zip(after, values[0], scale, strict=True)) < mpf(10) ** -36
            )


@pytest.mark.parametrize("name", ["loop: oblate", "wave: gravity aslant", "pendulum: spherical, a point"])
def test_returns_are_what_series_without_them_give(name: str) -> None:
    """Steps from the start to ten rotations, more than one period, without any use of the symmetry."""
    case = next(case for case in TOPS if case.name == name)
    with mp.workdps(60):
        c = case.body["center_of_mass"]
        diagonal = [about(case)[i][i] for i in range(3)]
        body = Rotation(diagonal, 45, terms=[Weight(case.body["mass"], c, case.gravity)])
        start = body.begin(case.omega, unit(case.attitude))
        end = body.fixed(case.times[1])
        last = list(steps(body, start, end))[-1].at(end)
        state = State([body.real(x) for x in body.rate_of(last)], [body.real(x) for x in last[3:7]])
        assert apart(state, case.expected[1]) < mpf(10) ** -38


def unit(q: Any) -> list[Any]:
    q = [mpf(x) for x in q]
    return [x / mpmath.norm(q) for x in q]


def minus(a: Any, b: Any) -> list[Any]:
    return [x - y for x, y in zip(a, b, strict=True)]


def about(case: MotionCase) -> list[list[Any]]:
    """The exact tensor, about the centre of mass or the origin that is held."""
    body = case.body
    if "inertia" in body:
        return [[mpf(x) for x in row] for row in body["inertia"]]
    c = [mpf(x) for x in body.get("center_of_mass", (0, 0, 0))] if case.about == "origin" else [mpf(0)] * 3
    parallel = mpf(body["mass"]) * mpmath.fdot(c, c)
    diagonal = [
        mpf(i) + parallel - mpf(body["mass"]) * x * x for i, x in zip(body["moments"], c, strict=True)
    ]
    return [[diagonal[i] if i == j else mpf(0) for j in range(3)] for i in range(3)]


def invariants(case: MotionCase, state: State) -> tuple[Any, list[Any]]:
    L = apply(about(case), state.omega)
    return mpmath.fdot(L, state.omega), turned(state.quaternion, L)


def top_invariants(case: MotionCase, state: State) -> list[Any]:
    """Energy, momentum about the vertical and rate about the axis."""
    twice, L = invariants(case, state)
    mass, c = mpf(case.body["mass"]), case.body["center_of_mass"]
    center = turned(state.quaternion, [mpf(x) for x in c])
    return [
        twice / 2 - mass * mpmath.fdot(center, case.gravity),
        mpmath.fdot(L, case.gravity),
        state.omega[2],
    ]


SOON = (
    "short axis: generic",
    "long axis: Toutatis",
    "symmetric: prolate",
    "pure spin: 2",
    "full tensor: Apollo",
)


@named(tuple(case for case in FREE if case.name in SOON))
def test_the_table_of_free_bodies_comes_out_again(case: MotionCase) -> None:
    for state, want in zip(free_cases.solve(case, 60), case.expected, strict=True):
        assert apart(state, want) < mpf(10) ** -38


@named(tuple(case for case in TOPS if case.kind in ("cusp", "loop", "sleeping, stable")))
def test_the_table_of_tops_comes_out_again(case: MotionCase) -> None:
    for state, want in zip(top_cases.solve(case, 60), case.expected, strict=True):
        assert apart(state, want) < mpf(10) ** -37


@pytest.mark.parametrize("module", [free_cases, top_cases])
def test_the_tables_hold_the_cases_of_their_scripts(module: Any) -> None:
    assert [inputs(case) for case in load_table(module.NAME)] == [inputs(case) for case in module.cases()]


def inputs(case: MotionCase) -> Any:
    return json.loads(json.dumps(case._replace(expected=(), kappa=())._asdict()))


def test_weights_and_vectors() -> None:
    """The helpers of the oracles on the simplest turn."""
    quarter = [mpf(0), mpf(0), mpmath.sqrt(mpf(0.5)), mpmath.sqrt(mpf(0.5))]
    assert [round(float(x), 12) for x in turned(quarter, [1, 0, 0])] == [0, 1, 0]
    assert [round(float(x), 12) for x in inverse(quarter, [0, 1, 0])] == [1, 0, 0]
    assert cross([1, 0, 0], [0, 1, 0]) == [0, 0, 1]
