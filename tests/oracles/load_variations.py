"""Derivatives of motions under loads, by differences of Taylor series in 34 digits.

A change of 1e-16 of one number leaves sixteen digits of the quotient. The variables are, in this order: a
small rotation δ of the attitude, ``R → R exp(δ×)``, and the rates; the elements 11, 22, 33, 23, 31, 12 of
the tensor about the point that the torques refer to; the centre of mass; the mass; and the numbers of the
load, term by term and argument by argument.

``python -m oracles.load_variations`` in the folder ``tests`` writes ``oracles/tables/variations.json``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import mpmath
import numpy as np
from mpmath import mp, mpf

from oracles import acting
from oracles.load_cases import ATTITUDE, CASES, PIVOTED
from oracles.motion_cases import TABLES
from oracles.returning import unit
from oracles.rotation import Rotation, Term, Vector, conjugate, exponential, times
from oracles.taylor import steps

__all__ = ["NAMES", "TURNS", "Setting", "end", "jacobian", "setting", "table"]

# The cases and their rotations: the eccentric orbit is chaotic, and after ten no difference is small enough.
TURNS = {
    "heavy asymmetric top: fast": 10,
    "Kovalevskaya top: generic": 10,
    "constant torque: body, full tensor": 10,
    "constant torque: space, full tensor": 10,
    "damping: both": 10,
    "gravity gradient: eccentric": 3,
    "feedback: matrices, a target": 10,
    "six degrees of freedom: force in space, at a point": 10,
    "six degrees of freedom: thrust": 10,
    "sum: weight, damping and torque on a pivot": 10,
}
NAMES = tuple(TURNS)
DIGITS = 34
CHANGE = mpf("1e-16")
TABLE = TABLES / "variations.json"


class Setting(NamedTuple):
    """A motion and everything that can vary in it."""

    body: dict[str, Any]
    omega: Sequence[Any]
    load: list[dict[str, Any]]
    pivoted: bool
    time: float


def setting(name: str) -> Setting:
    """The motion of this name, for its rotations at the first rate."""
    kind, short = name.split(": ")
    (body, omega, load), *_ = (case[2:5] for case in CASES if case[:2] == (kind, short))
    rotation = 2 * float(np.pi) / float(np.hypot.reduce(omega))
    return Setting(body, omega, load, kind in PIVOTED, TURNS[name] * rotation)


def table() -> dict[str, np.ndarray]:
    """The derivatives, (6, variables), of each of `NAMES`."""
    return {name: np.array(rows) for name, rows in json.loads(TABLE.read_text("utf-8")).items()}


class _Numbers(NamedTuple):
    """All that a motion is computed from."""

    attitude: Vector
    omega: Vector
    tensor: list[Vector]
    center: Vector
    mass: mpf
    load: list[tuple[str, dict[str, Any]]]


def end(given: Setting, digits: int = DIGITS) -> tuple[list[float], list[float]]:
    """ω and the attitude (x, y, z, w) at the time."""
    with mp.workdps(digits + 20):
        omega, attitude = _flow(_numbers(given), given, digits)
        return [float(x) for x in omega], [float(x) for x in attitude]


def jacobian(given: Setting, digits: int = DIGITS, change: mpf = CHANGE) -> np.ndarray:
    """(6, variables): of (δ, ω) at the time by the variables, from a change of each of them."""
    with mp.workdps(digits + 20):
        start = _numbers(given)
        omega, attitude = _flow(start, given, digits)
        columns = []
        for changed in _changed(start, change):
            rates, other = _flow(changed, given, digits)
            *turn, scalar = times(conjugate(attitude), other)
            tilt = [2 * mpmath.sign(scalar) * x / change for x in turn]
            columns.append([*tilt, *((b - a) / change for a, b in zip(omega, rates, strict=True))])
        return np.array([[float(x) for x in column] for column in columns]).T


def _numbers(given: Setting) -> _Numbers:
    body = given.body
    mass, center = mpf(body["mass"]), [mpf(x) for x in body.get("center_of_mass", (0, 0, 0))]
    if "moments" in body:
        tensor = [[mpf(x) if i == j else mpf(0) for j in range(3)] for i, x in enumerate(body["moments"])]
    else:
        tensor = [[mpf(x) for x in row] for row in body["inertia"]]
    if given.pivoted:
        square = mpmath.fdot(center, center)
        for i in range(3):
            for j in range(3):
                tensor[i][j] += mass * ((square if i == j else 0) - center[i] * center[j])
    load = [(term["kind"], _arguments(term)) for term in given.load]
    return _Numbers(unit(ATTITUDE), [mpf(x) for x in given.omega], tensor, center, mass, load)


def _arguments(term: dict[str, Any]) -> dict[str, Any]:
    """Arguments in the order of `polhode.loads`; damping and gains as matrices; of a target its rotation."""
    match term["kind"]:
        case "constant_torque" | "constant_force":
            named = {name: _exact(term[name]) for name in ("vector", "point") if name in term}
            return named | {"frame": term["frame"]}
        case "uniform_gravity":
            return {"gravity": _exact(term["gravity"])}
        case "gravity_gradient":
            return {name: _exact(term[name]) for name in ("mu", "position", "velocity")}
        case "damping":
            return {name: _matrix(term.get(name, 0.0)) for name in ("matrix", "quadratic")}
        case "feedback":
            gains = {name: _matrix(term[name]) for name in ("K", "D")}
            return gains | {"target": [mpf(0)] * 3, "aim": unit(term["target"])}
        case kind:
            raise ValueError(f"no variables for the load {kind}")


def _exact(value: Any) -> Any:
    return [mpf(x) for x in value] if isinstance(value, list | tuple) else mpf(value)


def _matrix(value: Any) -> list[Vector]:
    if isinstance(value, list | tuple):
        return [[mpf(x) for x in row] for row in value]
    return [[mpf(value) if i == j else mpf(0) for j in range(3)] for i in range(3)]


def _changed(start: _Numbers, h: mpf) -> Iterator[_Numbers]:
    """The numbers with each variable changed in turn."""
    for i in range(3):
        push = [h if k == i else mpf(0) for k in range(3)]
        yield start._replace(attitude=times(start.attitude, exponential(push)))
    for i in range(3):
        yield start._replace(omega=_nudged(start.omega, (i,), h))
    for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)):
        tensor = _nudged(start.tensor, (i, j), h)
        yield start._replace(tensor=tensor if i == j else _nudged(tensor, (j, i), h))
    for i in range(3):
        yield start._replace(center=_nudged(start.center, (i,), h))
    yield start._replace(mass=start.mass + h)
    for k, (kind, arguments) in enumerate(start.load):
        for name, value in arguments.items():
            if name in ("frame", "aim"):
                continue
            for index in np.ndindex(np.shape(value)):
                moved = arguments | {name: _nudged(value, index, h)}
                yield start._replace(load=[*start.load[:k], (kind, moved), *start.load[k + 1 :]])


def _nudged(value: Any, index: tuple[int, ...], h: mpf) -> Any:
    if not index:
        return value + h
    return [_nudged(x, index[1:], h) if i == index[0] else x for i, x in enumerate(value)]


def _flow(numbers: _Numbers, given: Setting, digits: int) -> tuple[Vector, Vector]:
    """Rates and attitude at the time."""
    body = Rotation(numbers.tensor, digits, terms=_terms(numbers, given.pivoted))
    end = body.fixed(given.time)
    for step in steps(body, body.begin(numbers.omega, numbers.attitude), end):
        last = step
    values = last.at(end)
    return [body.real(x) for x in body.rate_of(values)], unit([body.real(x) for x in values[3:7]])


def _terms(numbers: _Numbers, pivoted: bool) -> list[Term]:
    mass, center = numbers.mass, numbers.center
    made: list[Term] = []
    for kind, its in numbers.load:
        match kind:
            case "uniform_gravity":
                made.append(acting.Weight(mass, center if pivoted else (0, 0, 0), its["gravity"]))
            case "constant_torque" if its["frame"] == "body":
                made.append(acting.BodyTorque(its["vector"]))
            case "constant_torque":
                made.append(acting.SpaceForce(mass, torque=its["vector"]))
            case "constant_force":
                arm = [p - (0 if pivoted else c) for p, c in zip(its["point"], center, strict=True)]
                force = acting.BodyForce if its["frame"] == "body" else acting.SpaceForce
                made.append(force(mass, arm, its["vector"]))
            case "damping":
                made.append(acting.Damping(its["matrix"], its["quadratic"]))
            case "gravity_gradient":
                made.append(acting.Gradient(its["mu"], its["position"], its["velocity"]))
            case "feedback":
                target = times(its["aim"], exponential(its["target"]))
                made.append(acting.Feedback(its["K"], its["D"], target))
    return made


if __name__ == "__main__":
    wanted = sys.argv[1:] or NAMES
    found = {name: rows.tolist() for name, rows in table().items()} if TABLE.exists() else {}
    for name in wanted:
        found[name] = jacobian(setting(name)).tolist()
        rows = (f"{json.dumps(key)}: {json.dumps(found[key])}" for key in NAMES if key in found)
        TABLE.write_text("{\n" + ",\n".join(rows) + "\n}\n", "utf-8")
