"""Committed cases of motion: exact inputs, and states to forty digits at given times.

Tables are written by ``python -m oracles.free_cases``, ``oracles.top_cases`` and ``oracles.load_cases`` in
the folder ``tests``. Inputs and times are doubles, taken at their exact binary values; the attitude is made a
unit quaternion before anything else.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias

import mpmath
import pytest
from mpmath import mp, mpf

from oracles.rotation import conjugate
from oracles.rotation import times as product

__all__ = [
    "MotionCase",
    "State",
    "angle",
    "apart",
    "generate",
    "load_table",
    "named",
    "relative_error",
    "unit_floats",
    "write_table",
]

TABLES = Path(__file__).parent / "tables"
DIGITS = 40
"""Digits that a table holds, and that its generator proves."""

Floats: TypeAlias = tuple[float, ...]


class State(NamedTuple):
    """A state: rates in the body, the attitude, and, where the body goes somewhere, its path in space."""

    omega: Sequence[Any]
    quaternion: Sequence[Any]
    position: Sequence[Any] = ()
    velocity: Sequence[Any] = ()


class MotionCase(NamedTuple):
    """What is simulated, and what comes of it.

    Attributes
    ----------
    name, kind : str
        A name of its own; the regime it stands for.
    body : dict
        Arguments of ``RigidBody.from_principal`` where "moments" is among them, else of ``RigidBody``.
    omega, attitude : tuple of float
        The start.
    times : tuple of float
        When, from 0 at the start.
    expected : tuple of State
        One state for each time.
    load : tuple of dict
        Each acts: ``{"kind": name in polhode.loads, argument: value, …}``. "sinusoidal_torque" is the
        torque vector·sin(rate·t + phase) in the body.
    about : str
        "center_of_mass", or "origin" where that point is held.
    kappa : tuple of float
        For each time ‖∂(attitude, ω/|ω₀|)(t)/∂(attitude, ω/|ω₀|)(0)‖₂; of free bodies and tops for the first
        two times; of a body with a moment of zero none.
    gravity : tuple of float
        Of a heavy top, in space; else empty.
    position, velocity : tuple of float
        The path's start; empty where the body goes nowhere.
    rotor : tuple of float
        The constant momentum inside a gyrostat, in the body. Its `kappa` is, for each time, the largest
        change of the state (angle of the attitude, ω over the largest |ω|) by a relative change of one
        number of I, h, ω(0) or t.
    fastest : float
        The largest |ω| of a gyrostat's whole motion.
    periods : tuple of str
        To all digits: the time in which a gyrostat's ω returns in the body, and the angle, −π to π, by which
        the body has then turned about its total angular momentum; empty where it does not return.
    """

    name: str
    kind: str
    body: dict[str, Any]
    omega: Floats
    attitude: Floats
    times: Floats
    expected: tuple[State, ...] = ()
    load: tuple[dict[str, Any], ...] = ()
    about: Literal["center_of_mass", "origin"] = "center_of_mass"
    kappa: Floats = ()
    gravity: Floats = ()
    position: Floats = ()
    velocity: Floats = ()
    rotor: Floats = ()
    fastest: float = 0.0
    periods: tuple[str, ...] = ()


@cache
def load_table(name: str) -> tuple[MotionCase, ...]:
    """The cases of one table, their expected states as mpmath numbers."""
    return tuple(_case(entry) for entry in json.loads((TABLES / f"{name}.json").read_text("utf-8")))


def named(cases: Iterable[MotionCase], *, long: Sequence[str] = ()) -> pytest.MarkDecorator:
    """Run a test with cases by their names, those of `long` with this mark."""
    params = [pytest.param(one, id=one.name, marks=[pytest.mark.long] * (one.name in long)) for one in cases]
    return pytest.mark.parametrize("case", params)


def generate(name: str, cases: Iterable[MotionCase], proven: Callable[[MotionCase], MotionCase]) -> None:
    """Compute the cases and write their table; words on the command line pick cases, the others stay."""
    words = sys.argv[1:]
    fresh = list(cases)
    done = list(fresh)
    wanted = [i for i, case in enumerate(fresh) if not words or any(word in case.name for word in words)]
    if words:
        kept = {case.name: case for case in load_table(name)}
        done = [kept.get(case.name, case) for case in fresh]
    with ProcessPoolExecutor() as pool:
        futures = {pool.submit(_written, proven, fresh[i]): i for i in wanted}
        for future in as_completed(futures):
            i = futures[future]
            done[i] = _case(json.loads(future.result()))
            print(done[i].name, file=sys.stderr)
            write_table(name, [case for case in done if case.expected])


def write_table(name: str, cases: Iterable[MotionCase]) -> None:
    """A table, one line for each state."""
    text = "[\n" + ",\n".join(map(_text, cases)) + "\n]\n"
    TABLES.mkdir(exist_ok=True)
    (TABLES / f"{name}.json").write_text(text, encoding="utf-8")


def _written(proven: Callable[[MotionCase], MotionCase], case: MotionCase) -> str:
    """A proven case as text: numbers of mpmath lose digits on their way between processes."""
    return _text(proven(case))


def _text(case: MotionCase) -> str:
    fields = {
        key: value
        for key, value in case._asdict().items()
        if key != "expected" and (value or key in ("omega", "times"))
    }
    lines = [f'  "{key}": {json.dumps(value)}' for key, value in fields.items()]
    states = [
        json.dumps([[_digits(x) for x in part] for part in state if len(part)]) for state in case.expected
    ]
    lines.append('  "expected": [\n    ' + ",\n    ".join(states) + "\n  ]")
    return "{\n" + ",\n".join(lines) + "\n}"


def _digits(x: Any) -> str:
    return str(mpmath.nstr(x, DIGITS, strip_zeros=True))


def _case(entry: dict[str, Any]) -> MotionCase:
    with mp.workdps(DIGITS + 10):
        states = tuple(
            State(*(tuple(mpf(x) for x in part) for part in state)) for state in entry.pop("expected")
        )
    lists = {key: tuple(value) for key, value in entry.items() if isinstance(value, list)}
    return MotionCase(**{**entry, **lists}, expected=states)


def apart(a: State, b: State) -> Any:
    """How far two exact states are from each other: attitudes up to sign, vectors over their lengths."""
    with mp.workdps(60):
        vector = product(conjugate(a.quaternion), b.quaternion)[:3]
        differences = [2 * mpmath.norm(vector)]
        for x, y in ((a.omega, b.omega), (a.position, b.position), (a.velocity, b.velocity)):
            differences.append(mpmath.norm(_minus(x, y)) / (mpmath.norm(y) or 1))
        return max(differences)


def _minus(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [mpf(x) - y for x, y in zip(a, b, strict=True)]


def unit_floats(*components: float) -> Floats:
    """A vector over its length, rounded: as near to a unit quaternion as floats come."""
    length = math.hypot(*components)
    return tuple(x / length for x in components)


def angle(computed: Any, exact: Sequence[Any]) -> float:
    """Angle between a computed attitude and the exact one, in rad; small ones to full relative accuracy."""
    with mp.workdps(DIGITS + 10):
        *vector, scalar = product(conjugate(exact), [mpf(float(x)) for x in computed])
        return float(2 * mpmath.atan2(mpmath.sqrt(mpmath.fdot(vector, vector)), abs(scalar)))


def relative_error(computed: Any, exact: Sequence[Any], at_least: float = 0.0) -> float:
    """Length of the error of a vector over that of the exact one, or over `at_least` where that is more."""
    with mp.workdps(DIGITS + 10):
        error = mpmath.norm(_minus([float(x) for x in computed], exact))
        return float(error / max(mpmath.norm(exact), at_least)) if error else 0.0
