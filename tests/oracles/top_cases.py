"""The committed cases of the heavy symmetric top, at 1, 10, 1e3 and 1e6 rotations.

``python -m oracles.top_cases`` in the folder ``tests`` writes ``oracles/tables/heavy_top.json``. The axis of
symmetry is z of the body. A rotation is 2π over the largest of |ω| at the start and √(m g l/I_t). Each case
is computed twice, with 80 and 105 digits (more where the motion is unstable); what the two do not share to
42 digits is not written.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import mpmath
from mpmath import mp, mpf

from oracles import load_cases
from oracles.motion_cases import MotionCase, State, apart, generate, unit_floats
from oracles.returning import free_states, top_states

__all__ = ["NAME", "cases", "solve"]

NAME = "heavy_top"
SETTLING = ("pendulum: plane, to the top", "sleeping, unstable: falling asleep")
"""They rise to the top for ever."""
ROTATIONS = (1.0, 10.0, 1e3, 1e6)

UP = (0.0, 0.0, 0.0, 1.0)
DOWN = (1.0, 0.0, 0.0, 0.0)


def leaning(theta: float) -> tuple[float, ...]:
    """The attitude whose axis leans by θ from the vertical."""
    return math.sin(theta / 2), 0.0, 0.0, math.cos(theta / 2)


# I_t about the pivot is 1, m g l is 2 and the least spin of a sleeping top 2√2/I_s for the first three.
OBLATE = {"mass": 1.0, "moments": (0.75, 0.75, 1.25), "center_of_mass": (0.0, 0.0, 0.5)}
PROLATE = {"mass": 1.0, "moments": (0.75, 0.75, 0.5), "center_of_mass": (0.0, 0.0, 0.5)}
BALL = {"mass": 1.0, "moments": (0.75, 0.75, 0.75), "center_of_mass": (0.0, 0.0, 0.5)}
# m g l = 1, I_t = 1 about the pivot, I_s = 1: sleeps from ω₃ = 2 on, exactly.
MARGINAL = {"mass": 0.5, "moments": (0.875, 0.875, 1.0), "center_of_mass": (0.0, 0.0, 0.5)}
GYROSCOPE = {"mass": 0.5, "moments": (2e-4, 2e-4, 3e-4), "center_of_mass": (0.0, 0.0, 0.04)}
POINT = {"mass": 2.0, "moments": (0.0, 0.0, 0.0), "center_of_mass": (0.0, 0.0, 0.5)}
ROD = {"mass": 1.0, "moments": (0.75, 0.75, 0.0), "center_of_mass": (0.0, 0.0, 0.5)}
BELOW = {"mass": 1.0, "moments": (0.75, 0.75, 0.5), "center_of_mass": (0.0, 0.0, -0.5)}
HELD = {"mass": 1.0, "moments": (0.75, 0.75, 0.5), "center_of_mass": (0.0, 0.0, 0.0)}
G = (0.0, 0.0, -4.0)

CASES: list[tuple[str, str, dict[str, Any], tuple[float, ...], tuple[float, ...], tuple[float, ...]]] = [
    ("cusp", "oblate", OBLATE, (0.0, 0.0, 5.0), leaning(0.6), G),
    ("cusp", "prolate, near the horizon", PROLATE, (0.0, 0.0, 9.0), leaning(1.5), G),
    ("cusp", "nearly, 1e-10", OBLATE, (0.0, 1e-10, 5.0), leaning(0.6), G),
    ("loop", "oblate", OBLATE, (0.0, -0.5, 5.0), leaning(0.6), G),
    ("loop", "prolate, on its way", PROLATE, (0.4, -0.75, 9.0), leaning(1.0), G),
    ("wave", "oblate", OBLATE, (0.0, 0.3, 5.0), leaning(0.6), G),
    ("wave", "prolate, hanging", PROLATE, (0.7, 0.3, 3.0), leaning(2.4), G),
    ("wave", "backwards", OBLATE, (-0.2, -0.6, -5.0), unit_floats(0.3, -0.2, 0.4, 0.7), G),
    ("wave", "ball", BALL, (1.0, 0.5, 4.0), unit_floats(0.3, -0.2, 0.4, 0.7), G),
    ("wave", "gyroscope in SI units", GYROSCOPE, (0.5, 0.7, 250.0), leaning(0.5), (0.0, 0.0, -9.81)),
    ("wave", "gravity aslant", PROLATE, (0.7, 0.3, 5.0), unit_floats(0.3, -0.2, 0.4, 0.7), (1.0, -2.0, -3.0)),
    ("wave", "centre of mass below", BELOW, (0.7, 0.3, 5.0), unit_floats(0.3, -0.2, 0.4, 0.7), G),
    (
        "regular precession",
        "to the last bit",
        PROLATE,
        (0.0, math.sin(0.6), math.cos(0.6) * 2.0 + 4.0),
        leaning(0.6),
        G,
    ),
    ("regular precession", "1e-8 off", MARGINAL, (1e-8, 1.25 * math.sin(1.0), 2.0), leaning(1.0), G),
    ("sleeping, stable", "upright", OBLATE, (0.0, 0.0, 3.0), UP, G),
    ("sleeping, stable", "1e-3 off", OBLATE, (0.0, 0.0, 3.0), leaning(1e-3), G),
    ("sleeping, stable", "1e-8 off", OBLATE, (1e-8, 0.0, 3.0), leaning(1e-8), G),
    ("sleeping, marginal", "upright", MARGINAL, (0.0, 0.0, 2.0), UP, G),
    ("sleeping, marginal", "1e-3 off", MARGINAL, (0.0, 0.0, 2.0), leaning(1e-3), G),
    ("sleeping, marginal", "0.1 off", MARGINAL, (0.05, 0.0, -2.0), leaning(0.1), G),
    ("sleeping, marginal", "pushed", MARGINAL, (1e-4, 0.0, 2.0), UP, G),
    ("sleeping, unstable", "upright", OBLATE, (0.0, 0.0, 1.5), UP, G),
    ("sleeping, unstable", "1e-2 off", OBLATE, (0.0, 0.0, 1.5), leaning(1e-2), G),
    ("sleeping, unstable", "1e-6 off", PROLATE, (0.0, 1e-6, 4.0), leaning(1e-6), G),
    ("sleeping, unstable", "pushed 1e-9", OBLATE, (1e-9, 0.0, -1.5), UP, G),
    ("sleeping, unstable", "falling asleep", PROLATE, (0.0, 2.0, 4.0), unit_floats(1.0, 0.0, 0.0, 1.0), G),
    ("vertical", "through the top, fast", OBLATE, (1.0, 0.5, 4.0), UP, G),
    ("vertical", "through the top, slow", PROLATE, (3.0, 0.5, 1.0), UP, G),
    ("vertical", "through the bottom", OBLATE, (1.0, 0.5, 4.0), DOWN, G),
    ("vertical", "hanging still", PROLATE, (0.0, 0.0, 2.0), DOWN, G),
    ("pendulum", "spherical, a point", POINT, (0.7, 1.9, 0.0), unit_floats(0.9, 0.1, 0.0, 0.4), G),
    ("pendulum", "spherical, a body", BALL, (0.7, 0.4, 0.0), unit_floats(0.3, -0.2, 0.4, 0.7), G),
    ("pendulum", "spherical, a rod that turns", ROD, (0.7, 0.4, 1.0), unit_floats(0.8, -0.2, 0.4, 0.3), G),
    (
        "pendulum",
        "conical",
        POINT,
        (0.0, 4.0 * math.sin(2.0), 0.0),
        leaning(2.0),
        (0.0, 0.0, 8.0 * math.cos(2.0)),
    ),
    ("pendulum", "plane, swinging", BALL, (0.5, 0.0, 0.0), leaning(2.5), G),
    ("pendulum", "plane, turning over", BALL, (3.5, 0.0, 0.0), leaning(2.5), G),
    ("pendulum", "plane, turning over by 1e-12", BALL, (math.sqrt(8.0) * (1 + 1e-12), 0.0, 0.0), DOWN, G),
    ("pendulum", "plane, to the top", BALL, (4.0, 0.0, 0.0), DOWN, (0.0, 0.0, -8.0)),
    ("no torque", "held at its centre", HELD, (1.0, 0.3, 2.0), unit_floats(0.3, -0.2, 0.4, 0.7), G),
    ("no torque", "weightless", PROLATE, (1.0, 0.3, 2.0), unit_floats(0.3, -0.2, 0.4, 0.7), (0.0, 0.0, 0.0)),
]


def cases() -> Iterator[MotionCase]:
    """The cases without their states."""
    for kind, name, body, omega, attitude, gravity in CASES:
        about = body["moments"][0] + body["mass"] * body["center_of_mass"][2] ** 2
        weight = body["mass"] * math.hypot(*gravity) * abs(body["center_of_mass"][2])
        rotation = 2 * math.pi / max(math.hypot(*omega), math.sqrt(weight / about))
        times = tuple(n * rotation for n in ROTATIONS)
        yield MotionCase(
            f"{kind}: {name}", kind, body, omega, attitude, times, about="origin", gravity=gravity
        )


def solve(case: MotionCase, digits: int = 80) -> list[State]:
    """The states of a case, computed in units of its own moment, length l and time of a turn."""
    with mp.workdps(digits + 30):
        mass, height = mpf(case.body["mass"]), mpf(case.body["center_of_mass"][2])
        across, _, along = (mpf(x) for x in case.body["moments"])
        across += mass * height**2
        size = int(mpmath.ceil(mpmath.log(across, 2)))
        rate = math.frexp(max(math.hypot(*case.omega), 2 * math.pi / case.times[0]))[1]
        length = 0 if not height else int(mpmath.ceil(mpmath.log(abs(height), 2)))
        moments = [mpmath.ldexp(x, -size) for x in (across, across, along)]
        omega = [mpmath.ldexp(x, -rate) for x in case.omega]
        times = [mpmath.ldexp(t, rate) for t in case.times]
        if any(case.gravity):
            weight = mpmath.ldexp(mass, 2 * length - size), mpmath.ldexp(height, -length)
            gravity = [mpmath.ldexp(x, -2 * rate - length) for x in case.gravity]
            settles = case.name in SETTLING
            states = top_states(
                moments, *weight, omega, case.attitude, gravity, times, settles=settles, digits=digits
            )
        else:
            states = free_states(moments, omega, case.attitude, times, digits=digits)
        return [State([mpmath.ldexp(x, rate) for x in s.omega], s.quaternion) for s in states]


def proven(case: MotionCase) -> MotionCase:
    """The case with its states, if two computations agree, and its condition numbers at the first two times.

    A body without matter off an axis has none.
    """
    extra = 60 if case.name in SETTLING else 40 if "unstable" in case.kind or "plane" in case.name else 0
    once, again = solve(case, 80 + extra), solve(case, 105 + extra)
    difference = max(apart(a, b) for a, b in zip(once, again, strict=True))
    if difference > mpf(10) ** -42:
        raise ArithmeticError(f"{case.name}: two computations differ by {mpmath.nstr(difference, 3)}")
    if 0.0 in case.body["moments"]:  # a turn about this axis has no inertia
        return case._replace(expected=tuple(again))
    weight = ({"kind": "uniform_gravity", "gravity": case.gravity},) if any(case.gravity) else ()
    kappa = load_cases.condition_numbers(case._replace(times=case.times[:2], load=weight))
    return case._replace(expected=tuple(again), kappa=kappa)


if __name__ == "__main__":
    generate(NAME, cases(), proven)
