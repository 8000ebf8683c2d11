"""The committed cases of free motion: every regime there is, at 1, 10, 1e3 and 1e6 rotations.

``python -m oracles.free_cases`` in the folder ``tests`` writes ``oracles/tables/free_motion.json``. A
rotation is 2π I₂/|L|. Each case is computed twice, with 80 and 105 digits (more where a small number is
squared) and a different share of the attitude taken out; what the two do not share to 42
digits is not written.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import mpmath
import numpy as np
from mpmath import mp, mpf

from oracles import load_cases
from oracles.motion_cases import MotionCase, State, apart, generate, unit_floats
from oracles.returning import free_states

__all__ = ["NAME", "cases", "solve"]

NAME = "free_motion"
ROTATIONS = (1.0, 10.0, 1e3, 1e6)
ATTITUDE = unit_floats(0.5, -0.25, 0.125, 0.8)
TINY = 2.0**-47

ISS = ((1.02e8, -6.96e6, -5.48e6), (-6.96e6, 9.1e7, 5.9e5), (-5.48e6, 5.9e5, 1.64e8))
APOLLO = ((36502.7, 27.1, -233.2), (27.1, 38372.4, -1152.4), (-233.2, -1152.4, 36514.9))
GENERIC = ((3.0, 0.2, -0.1), (0.2, 2.0, 0.3), (-0.1, 0.3, 4.0))

PRINCIPAL: dict[str, list[tuple[str, Sequence[float], Sequence[float]]]] = {
    "short axis": [
        ("generic", (1.0, 2.0, 2.5), (0.3, 0.7, -0.9)),
        ("NASA check case 2", (0.001894220, 0.006211019, 0.007194665), tuple(np.radians([10.0, 20.0, 30.0]))),
        ("box 1×2×3", (5.0, 10.0, 13.0), (0.1, -0.2, 1.5)),
        ("Apophis", (0.61, 0.965, 1.0), (1.4e-5, -2.0e-5, 5.9e-5)),
        ("reversed", (1.0, 2.0, 2.5), (-0.3, 0.1, -0.9)),
        ("molecule", (1.0226e-47, 1.9191e-47, 2.9417e-47), (1e12, 2e12, 9e12)),
    ],
    "long axis": [
        ("generic", (1.0, 2.0, 2.5), (1.5, 0.7, -0.4)),
        ("Toutatis", (1.0, 3.01307, 3.18992), (2.2e-5, 0.8e-5, 0.5e-5)),
        ("reversed", (2.0, 3.0, 4.0), (-2.0, 0.25, -0.5)),
        ("T-handle", (0.3, 1.0, 1.2), (3.0, -0.1, 0.2)),
    ],
    "near the separatrix": [
        *(
            (f"off the intermediate axis by {d:g}", (1.0, 2.0, 3.0), (0.0, 1.0, d))
            for d in (1e-3, 1e-8, 1e-14)
        ),
        *(
            (f"off the intermediate axis by {d:g}, long", (1.0, 2.0, 3.0), (d, -1.0, 0.0))
            for d in (1e-5, 1e-11)
        ),
        ("off the intermediate axis by 1e-12, both", (1.0, 2.0, 2.5), (1e-12, 1.0, -1e-12)),
        *((f"offset {d:.0e}", (3.0, 4.0, 6.0), (2.0, 0.5, 1.0 + d)) for d in (2.0**-10, 2.0**-30, TINY)),
        *((f"offset {-d:.0e}", (3.0, 4.0, 6.0), (-2.0, 1.5, 1.0 - d)) for d in (2.0**-17, 2.0**-36, TINY)),
    ],
    "separatrix": [
        ("towards +2", (3.0, 4.0, 6.0), (2.0, -0.5, 1.0)),
        ("towards -2", (3.0, 4.0, 6.0), (-2.0, 1.0, 1.0)),
        ("from the middle", (3.0, 4.0, 6.0), (2.0, 0.0, -1.0)),
        ("from afar", (3.0, 4.0, 6.0), (-(2.0**-20), 1.5, 2.0**-21)),
    ],
    "symmetric": [
        ("oblate", (1.0, 1.0, 1.7), (0.3, -0.4, 2.0)),
        ("prolate", (0.4, 1.3, 1.3), (1.5, -0.4, 0.7)),
        ("oblate, slow", (1.0, 1.0, 1.5), (0.6, 0.3, -1e-3)),
        ("Earth with A = B", (8.0102e37, 8.0102e37, 8.0365e37), (7e-11, 3e-11, 7.292115e-5)),
    ],
    "nearly symmetric": [
        ("oblate 1e-9", (1.0, 1.0 + 1e-9, 2.0), (0.3, 0.2, 1.1)),
        ("oblate, last bit", (1.0, 1.0 + 2.0**-52, 1.5), (0.7, -0.2, 0.9)),
        ("prolate 1e-12", (1.0, 2.0, 2.0 + 1e-12), (0.8, 0.5, -0.3)),
        ("prolate, across", (1.0, 2.0, 2.0 + 1e-6), (1e-4, 0.5, -0.3)),
        ("Earth", (8.0101e37, 8.0103e37, 8.0365e37), (7e-11, 3e-11, 7.292115e-5)),
    ],
    "spherical": [
        ("exact", (1.5, 1.5, 1.5), (0.4, -0.3, 1.0)),
        ("nearly 1e-9", (1.0, 1.0 + 1e-9, 1.0 + 3e-9), (0.4, -0.3, 1.0)),
        ("nearly, last bits", (1.0, 1.0 + 2.0**-51, 1.0 + 5 * 2.0**-52), (0.4, 0.6, -0.1)),
    ],
    "thin": [
        ("needle", (1e-6, 1.0, 1.0 + 1e-7), (2.0, 0.5, 0.7)),
        ("needle, spinning", (1e-6, 1.0, 1.0 + 5e-7), (0.09, 1e-3, 2e-3)),
        ("needle, across", (1e-6, 1.0, 1.0 + 5e-7), (0.1, 0.05, 1.0)),
        ("lamina", (1.0, 2.0, 3.0), (0.3, 0.5, 0.7)),
        ("lamina, long axis", (1.0, 2.0, 3.0), (1.3, 0.2, 0.4)),
        ("rod", (0.0, 1.0, 1.0), (0.5, 0.3, -0.2)),
        ("rod, at rest along itself", (0.0, 1.0, 1.0), (0.0, 0.3, 0.2)),
    ],
    "pure spin": [
        ("1", (1.0, 2.0, 2.5), (1.25, 0.0, 0.0)),
        ("2", (1.0, 2.0, 2.5), (0.0, -0.75, 0.0)),
        ("3", (1.0, 2.0, 2.5), (0.0, 0.0, 1.5)),
    ],
    "nearly pure spin": [
        ("3 by 1e-10", (1.0, 2.0, 2.5), (1e-10, 2e-10, 1.0)),
        ("3 by 1e-16", (1.0, 2.0, 2.5), (1e-16, 0.0, -1.0)),
        ("1 by 1e-7", (1.0, 2.0, 2.5), (1.0, 1e-7, 0.0)),
        ("1 by 1e-15", (1.0, 2.0, 2.5), (1.0, 3e-16, -1e-15)),
    ],
}

FULL: list[tuple[str, Sequence[Sequence[float]], Sequence[float]]] = [
    ("generic, short axis", GENERIC, (0.1, -0.2, 0.9)),
    ("generic, long axis", GENERIC, (0.25, -1.0, 0.1)),
    ("space station", ISS, (1e-3, -5e-4, 2e-3)),
    ("Apollo", APOLLO, (0.02, 0.01, -0.03)),
    ("nearly symmetric", ((2.0, 1e-9, 0.0), (1e-9, 2.0, 2e-9), (0.0, 2e-9, 3.0)), (0.3, 0.4, 1.0)),
    ("nearly spherical", ((1.0, 1e-8, 2e-8), (1e-8, 1.0, -1e-8), (2e-8, -1e-8, 1.0)), (0.3, 0.4, 1.0)),
    ("thin", ((0.50001, -0.49999, 1e-6), (-0.49999, 0.50001, 2e-6), (1e-6, 2e-6, 1.00001)), (0.7, 0.9, 0.3)),
]


def cases() -> Iterator[MotionCase]:
    """The cases without their states."""
    for kind, rows in PRINCIPAL.items():
        for name, moments, omega in rows:
            yield _case(
                f"{kind}: {name}", kind, {"moments": moments}, np.array(moments) * omega, moments[1], omega
            )
    for name, tensor, omega in FULL:
        middle = float(np.linalg.eigvalsh(np.array(tensor))[1])
        yield _case(
            f"full tensor: {name}",
            "full tensor",
            {"inertia": tensor},
            np.array(tensor) @ omega,
            middle,
            omega,
        )


def _case(
    name: str, kind: str, body: dict[str, Any], L: Any, middle: float, omega: Sequence[float]
) -> MotionCase:
    rotation = 2 * math.pi / math.hypot(*(L / middle))
    times = tuple(n * rotation for n in ROTATIONS)
    return MotionCase(name, kind, {"mass": 1.0, **body}, tuple(map(float, omega)), ATTITUDE, times)


def solve(case: MotionCase, digits: int = 80, share: float = 1.0) -> list[State]:
    """The states of a case. `share` is that of the attitude's steady part that is taken out."""
    with mp.workdps(digits + 30):
        inertia = case.body["moments"] if "moments" in case.body else case.body["inertia"]
        size = math.frexp(np.abs(inertia).max())[1]
        rate = math.frexp(max(map(abs, case.omega)))[1]
        scaled = mpmath.matrix(inertia) * mpmath.ldexp(1, -size)
        scaled = list(scaled) if "moments" in case.body else scaled.tolist()
        omega = [mpmath.ldexp(x, -rate) for x in case.omega]
        times = [mpmath.ldexp(t, rate) for t in case.times]
        middle = scaled[1] if "moments" in case.body else sum(scaled[i][i] for i in range(3)) / 3
        settles = case.kind == "separatrix"
        states = free_states(
            scaled, omega, case.attitude, times, drift=share / middle, settles=settles, digits=digits
        )
        return [State([mpmath.ldexp(x, rate) for x in s.omega], s.quaternion) for s in states]


def proven(case: MotionCase) -> MotionCase:
    """The case with its states, if two computations agree, and its first two condition numbers."""
    extra = 60 if case.kind == "separatrix" else 40 if "near the" in case.kind or "1e-1" in case.name else 0
    # On the separatrix and near a sphere only what is left without the whole steady part settles or is slow.
    share = (
        1.0 if case.kind in ("separatrix", "spherical", "thin") or "nearly spherical" in case.name else 0.5
    )
    once, again = solve(case, 80 + extra), solve(case, 105 + extra, share)
    difference = max(apart(a, b) for a, b in zip(once, again, strict=True))
    if difference > mpf(10) ** -42:
        raise ArithmeticError(f"{case.name}: two computations differ by {mpmath.nstr(difference, 3)}")
    return case._replace(expected=tuple(again), kappa=condition_numbers(case))


def condition_numbers(case: MotionCase) -> tuple[float, ...]:
    """Return the condition numbers at the first two times; rates and moments have a size of about 1 in it."""
    key = "moments" if "moments" in case.body else "inertia"
    size = math.frexp(np.abs(case.body[key]).max())[1]
    rate = math.frexp(max(map(abs, case.omega)))[1]
    return load_cases.condition_numbers(
        case._replace(
            body=case.body | {key: np.ldexp(case.body[key], -size).tolist()},
            omega=tuple(math.ldexp(x, -rate) for x in case.omega),
            times=tuple(math.ldexp(t, rate) for t in case.times[:2]),
        )
    )


if __name__ == "__main__":
    generate(NAME, cases(), proven)
