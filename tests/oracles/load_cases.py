"""The committed cases of simulated motion: every analytic load, 10 to 100 rotations, with condition numbers.

``python -m oracles.load_cases`` in the folder ``tests`` writes ``oracles/tables/simulate.json``. A rotation
is 2π/|ω| at the start. Each case is computed by Taylor series twice, with 42 and 48 digits, and as many more
as its condition number eats; what the two do not share to 41 digits is not written.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import mpmath
import numpy as np
from mpmath import mp, mpf

from oracles import acting
from oracles.motion_cases import Floats, MotionCase, State, apart, generate, unit_floats
from oracles.returning import unit
from oracles.rotation import Rotation, Term, conjugate, exponential, times
from oracles.taylor import steps

__all__ = ["NAME", "cases", "condition", "condition_numbers", "growth", "solve"]

NAME = "simulate"
ATTITUDE = unit_floats(0.3, -0.2, 0.4, 0.7)
UNSTABLE = 1e3
"""Condition numbers up to here are within the digits that every computation has to spare."""

FREE = {"mass": 2.0, "moments": (1.0, 2.0, 2.5)}
FULL = {"mass": 1.0, "inertia": ((3.0, 0.2, -0.1), (0.2, 2.0, 0.3), (-0.1, 0.3, 4.0))}
LOPSIDED = {"mass": 1.0, "moments": (0.8, 1.0, 1.3), "center_of_mass": (0.1, -0.2, 0.5)}
SHIFTED = {"mass": 2.0, "moments": (1.0, 2.0, 2.5), "center_of_mass": (0.25, -0.5, 0.125)}
# About the origin A = B = 2 C = 2, the centre of mass on the equator.
KOVALEVSKAYA = {"mass": 1.0, "moments": (2.0, 1.75, 0.75), "center_of_mass": (0.5, 0.0, 0.0)}
SYMMETRIC = {"mass": 1.0, "moments": (0.75, 0.75, 0.5), "center_of_mass": (0.0, 0.0, 0.5)}

BODY_TORQUE, SPACE_TORQUE = (
    {"kind": "constant_torque", "vector": (0.01, -0.02, 0.015), "frame": frame} for frame in ("body", "space")
)
STRONG_BODY_TORQUE = {"kind": "constant_torque", "vector": (0.05, -0.02, 0.03), "frame": "body"}
STRONG_SPACE_TORQUE = {"kind": "constant_torque", "vector": (0.1, -0.2, 0.15), "frame": "space"}
DRIVE = {"kind": "constant_torque", "vector": (0.05, 0.0, 0.1), "frame": "space"}
SPIN_UP_3, SPIN_UP_2 = (
    {"kind": "constant_torque", "vector": v, "frame": "body"} for v in ((0.0, 0.0, 0.01), (0.0, 0.01, 0.0))
)
SINE = {"kind": "sinusoidal_torque", "vector": (0.1, 0.05, -0.02), "rate": 0.75, "phase": 0.5}
WEIGHT = {"kind": "uniform_gravity", "gravity": (0.0, 0.0, -2.0)}
MILD = ((0.02, 0.001, 0.0), (0.001, 0.01, 0.002), (0.0, 0.002, 0.03))
STIFF = ((300.0, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.01))
COUPLED = ((200.0, 100.0, 0.0), (100.0, 50.0, 0.0), (0.0, 0.0, 0.01))
DRAG = {"kind": "damping", "matrix": MILD}
CIRCLE, ELLIPSE, HYPERBOLA = (
    {"kind": "gravity_gradient", "mu": 1.0, "position": r, "velocity": v}
    for r, v in (
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        ((1.0, 0.25, 0.125), (-0.125, 1.125, 0.25)),
        ((-4.0, 2.0, 1.0), (1.5, 0.25, -0.125)),
    )
)
CONTROL = {"kind": "feedback", "K": 1.5, "D": 0.25, "target": (0.0, 0.0, 0.0, 1.0)}
STIFFNESS = ((2.0, 0.1, 0.0), (0.1, 1.5, 0.0), (0.0, 0.0, 1.0))
AIM = {"kind": "feedback", "K": STIFFNESS, "D": MILD, "target": (0.0, 0.6, 0.0, 0.8)}
SPACE_FORCE = {
    "kind": "constant_force", "vector": (0.01, -0.02, 0.03), "frame": "space", "point": (0.5, 0.25, -0.5)
}  # fmt: skip
THRUST = {
    "kind": "constant_force", "vector": (0.02, 0.01, 0.25), "frame": "body", "point": (0.25, -0.4375, -0.5)
}  # fmt: skip

A, B = (0.3, 0.7, -0.9), (0.1, 0.2, 1.5)
CASES: list[tuple[str, str, dict[str, Any], Floats, list[dict[str, Any]], Floats]] = [
    ("heavy symmetric top", "nodding", SYMMETRIC, (0.7, 0.3, 5.0), [WEIGHT], (1, 10, 100)),
    ("heavy asymmetric top", "fast", LOPSIDED, (0.3, 0.2, 6.0), [WEIGHT], (1, 3, 10, 100)),
    ("heavy asymmetric top", "swinging", LOPSIDED, (0.5, -0.3, 0.9), [WEIGHT], (1, 3, 10, 100)),
    ("heavy asymmetric top", "tumbling", LOPSIDED, (2.0, -1.0, 1.5), [WEIGHT], (1, 10)),
    ("heavy asymmetric top", "chaotic", LOPSIDED, (1.0, 0.5, -1.0), [WEIGHT], (1, 10, 30)),
    ("Kovalevskaya top", "generic", KOVALEVSKAYA, (1.2, 0.4, 1.5), [WEIGHT], (1, 10, 100)),
    ("Kovalevskaya top", "fast", KOVALEVSKAYA, (0.1, 3.0, 5.0), [WEIGHT], (1, 3, 10)),
    ("constant torque", "body", FREE, A, [BODY_TORQUE], (1, 3, 10, 100)),
    ("constant torque", "body, full tensor", FULL, A, [STRONG_BODY_TORQUE], (1, 3, 10, 100)),
    ("constant torque", "space", FREE, A, [SPACE_TORQUE], (1, 10, 100)),
    ("constant torque", "space, full tensor", FULL, (0.5, -1.0, 0.25), [STRONG_SPACE_TORQUE], (1, 3, 10)),
    ("spin-up", "about the axis of the largest moment", FREE, (0.01, 0.02, 1.0), [SPIN_UP_3], (1, 3, 10)),
    (
        "spin-up",
        "about the axis of the intermediate moment",
        FREE,
        (0.01, 1.0, 0.02),
        [SPIN_UP_2],
        (1, 3, 10),
    ),
    ("sinusoidal torque", "generic", FREE, A, [SINE], (1, 3, 10)),
    ("damping", "mild", FREE, A, [DRAG], (1, 3, 10, 100)),
    ("damping", "quadratic", FULL, A, [{"kind": "damping", "matrix": 0.0, "quadratic": 0.03}], (1, 3, 10)),
    ("damping", "both", FREE, A, [DRAG | {"quadratic": MILD}], (1, 3, 10, 100)),
    ("damping", "stiff", FREE, A, [{"kind": "damping", "matrix": STIFF}], (0.5, 1)),
    ("damping", "stiff, coupled", FULL, A, [{"kind": "damping", "matrix": COUPLED}], (1, 3, 10)),
    ("gravity gradient", "circular", FREE, (0.1, 0.2, 1.0), [CIRCLE], (1, 3, 10)),
    ("gravity gradient", "eccentric", FREE, (0.3, -0.2, 1.0), [ELLIPSE], (1, 3, 10)),
    ("gravity gradient", "hyperbolic, full tensor", FULL, (0.3, -0.2, 1.0), [HYPERBOLA], (1, 3, 10)),
    ("feedback", "generic", FREE, (0.3, 0.2, -0.1), [CONTROL], (0.25, 1, 3, 10)),
    ("feedback", "matrices, a target", FULL, (0.3, 0.2, -0.1), [AIM], (0.25, 1, 3, 10)),
    ("six degrees of freedom", "force in space, at a point", SHIFTED, A, [SPACE_FORCE], (1, 3, 10)),
    ("six degrees of freedom", "thrust", SHIFTED, B, [THRUST], (1, 3, 10, 100)),
    ("six degrees of freedom", "thrust, weight, damping", SHIFTED, B, [THRUST, WEIGHT, DRAG], (1, 3, 10)),
    (
        "sum",
        "weight, damping and torque on a pivot",
        LOPSIDED,
        (0.3, 0.2, 3.0),
        [WEIGHT, DRAG, DRIVE],
        (1, 3, 10, 100),
    ),
]
PIVOTED = ("heavy symmetric top", "heavy asymmetric top", "Kovalevskaya top", "sum")
START = ((1.0, -2.0, 0.5), (0.25, 0.5, -0.125))


def cases() -> Iterator[MotionCase]:
    """The cases without their states."""
    for kind, name, body, omega, load, turns in CASES:
        rotation = 2 * math.pi / math.hypot(*omega)
        case = MotionCase(f"{kind}: {name}", kind, body, omega, ATTITUDE, tuple(n * rotation for n in turns))
        if kind in PIVOTED:
            case = case._replace(about="origin")
        if kind == "six degrees of freedom":
            case = case._replace(position=START[0], velocity=START[1])
        yield case._replace(load=tuple(load))


def inertia_of(case: MotionCase) -> Any:
    """Moments or tensor about the centre of mass, or about the origin that is held."""
    if "inertia" in case.body or case.about == "center_of_mass":
        return case.body.get("moments", case.body.get("inertia"))
    m, c = mpf(case.body["mass"]), [mpf(x) for x in case.body["center_of_mass"]]
    parallel = m * mpmath.fdot(c, c)
    diagonal = [mpf(x) + parallel for x in case.body["moments"]]
    return [[(diagonal[i] if i == j else 0) - m * c[i] * c[j] for j in range(3)] for i in range(3)]


def terms_of(case: MotionCase) -> list[Term]:
    """The loads as terms of the series."""
    mass = case.body["mass"]
    center = case.body.get("center_of_mass", (0.0, 0.0, 0.0))
    pivoted = case.about == "origin"
    made: list[Term] = []
    for load in case.load:
        match load["kind"]:
            case "uniform_gravity":
                weight = [mpf(mass) * mpf(x) for x in load["gravity"]]
                made.append(acting.SpaceForce(mass, center if pivoted else (0, 0, 0), weight))
            case "constant_torque" if load["frame"] == "body":
                made.append(acting.BodyTorque(load["vector"]))
            case "constant_torque":
                made.append(acting.SpaceForce(mass, torque=load["vector"]))
            case "constant_force":
                arm = [
                    mpf(p) - (0 if pivoted else mpf(c)) for p, c in zip(load["point"], center, strict=True)
                ]
                kind = acting.BodyForce if load["frame"] == "body" else acting.SpaceForce
                made.append(kind(mass, arm, load["vector"]))
            case "sinusoidal_torque":
                made.append(acting.Oscillating(load["vector"], load["rate"], load["phase"]))
            case "damping":
                made.append(acting.Damping(load["matrix"], load.get("quadratic")))
            case "gravity_gradient":
                made.append(acting.Gradient(load["mu"], load["position"], load["velocity"]))
            case "feedback":
                made.append(acting.Feedback(load["K"], load["D"], load["target"]))
            case kind:
                raise ValueError(f"no series for the load {kind}")
    return made


def solve(
    case: MotionCase, digits: int, *, omega: Sequence[Any] = (), attitude: Sequence[Any] = ()
) -> list[State]:
    """The states of a case, from its own start or from another."""
    with mp.workdps(digits + 20):
        body = Rotation(inertia_of(case), digits, terms=terms_of(case))
        path = (case.position, case.velocity) if case.position else None
        start = body.begin(omega or case.omega, attitude or unit(case.attitude), path)
        ends = [body.fixed(t) for t in case.times]
        states: list[State] = []
        for step in steps(body, start, max(ends)):
            for end in ends[len(states) :]:
                if end <= step.end:
                    values = step.at(end)
                    rest = [body.real(x) for x in values[3:13]]
                    rates = [body.real(x) for x in body.rate_of(values)]
                    where = (rest[4:7], rest[7:10]) if case.position else ((), ())
                    states.append(State(rates, unit(rest[:4]), *where))
        return states


def condition(case: MotionCase, digits: int = 16) -> list[float]:
    """‖∂(attitude, ω/|ω₀|)(t)/∂(attitude, ω/|ω₀|)(0)‖₂, from differences too small to be seen."""
    return [float(x) for x in np.linalg.norm(variations(case, digits), 2, axis=(1, 2))]


def condition_numbers(case: MotionCase) -> tuple[float, ...]:
    """Return the condition numbers at the times of a case, as its table holds them."""
    for digits in (16, 32, 64):
        kappa = condition(case, digits)
        if max(kappa) <= UNSTABLE * 10 ** (digits // 2 - 8):  # neighbours stay neighbours
            break
    return tuple(float(f"{x:.3e}") for x in kappa)


def growth(case: MotionCase, digits: int) -> float:
    """The largest ‖∂(attitude, ω/|ω₀|)(t)/∂(attitude, ω/|ω₀|)(s)‖₂ over the times s, t the last of them."""
    *before, last = variations(case, digits)
    return max(float(np.linalg.norm(np.linalg.solve(at.T, last.T), 2)) for at in before)


def variations(case: MotionCase, digits: int) -> Any:
    """∂(attitude, ω/|ω₀|)(t)/∂(attitude, ω/|ω₀|)(0) at each time, (T, 6, 6)."""
    with mp.workdps(digits + 20):
        small = mpf(10) ** -(digits // 2)
        rate = mpmath.norm([mpf(x) for x in case.omega])
        start = unit(case.attitude)
        base = solve(case, digits)
        columns = []
        for k in range(6):
            push = [small if k % 3 == i else mpf(0) for i in range(3)]
            if k < 3:
                moved = solve(case, digits, attitude=times(start, exponential(push)))
            else:
                shifted = [mpf(w) + rate * x for w, x in zip(case.omega, push, strict=True)]
                moved = solve(case, digits, omega=shifted)
            columns.append([_difference(a, b, rate, small) for a, b in zip(base, moved, strict=True)])
        return np.array(columns).transpose(1, 2, 0)


def _difference(a: State, b: State, rate: Any, small: Any) -> list[float]:
    """How far b is from a, over `small`: a small turn, and the rates over the first rate."""
    *turn, scalar = times(conjugate(a.quaternion), b.quaternion)
    sign = 2 * mpmath.sign(scalar) / small
    return [
        *(float(sign * x) for x in turn),
        *(float((y - x) / (rate * small)) for x, y in zip(a.omega, b.omega, strict=True)),
    ]


def proven(case: MotionCase) -> MotionCase:
    """The case with its states, if two computations agree, and its condition numbers."""
    kappa = condition_numbers(case)
    eaten = max(0, math.ceil(math.log10(max(kappa) / UNSTABLE)))
    once, again = solve(case, 42 + eaten), solve(case, 48 + eaten)
    difference = max(apart(a, b) for a, b in zip(once, again, strict=True))
    if difference > mpf(10) ** -41:
        raise ArithmeticError(f"{case.name}: two computations differ by {mpmath.nstr(difference, 3)}")
    return case._replace(expected=tuple(again), kappa=kappa)


if __name__ == "__main__":
    generate(NAME, cases(), proven)
