"""The committed cases of the gyrostat: every regime there is, up to 1e12 rotations, with condition numbers.

``python -m oracles.gyrostat_cases`` in the folder ``tests`` writes ``oracles/tables/gyrostat.json``. A
rotation is 2π/|ω| at the start; the first time of each case is a quarter of the shorter of that and
2π I₂/|h|. Each case is computed twice, with 75 and 95 digits and a different share of the attitude taken out;
what the two do not share to 42 digits is not written. Three are also followed straight through 1e3 rotations.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import mpmath
import numpy as np
from mpmath import mp, mpf

from oracles.gyrostat import Motion
from oracles.motion_cases import DIGITS, Floats, MotionCase, State, apart, generate, unit_floats
from oracles.rotation import conjugate
from oracles.rotation import times as product

__all__ = ["NAME", "STARTS", "cases", "condition", "motion", "proven", "straight"]

NAME = "gyrostat"
ROTATIONS = (1.0, 10.0, 1e3, 1e6, 1e12)
ATTITUDE = unit_floats(0.5, -0.25, 0.125, 0.8)
STRAIGHT = ("generic: generic, short", "generic: h in a principal plane", "tilted: generic")
"""Cases that are also followed through 1e3 rotations without any return."""
UNSETTLED = ("separatrix", "unstable")
"""Kinds that never return, or whose changes grow without end: to moderate times alone."""
CHANGE = mpmath.ldexp(mpf(1), -100)
"""Relative change of an input in differences: small beside one over any condition number there is."""


class Start(NamedTuple):
    """What is inside, and the start."""

    name: str
    inertia: Any
    rotor: Floats
    omega: Floats
    rotations: Floats = ROTATIONS
    axes: Floats = ()


GENERIC = (1.0, 2.0, 2.5)
CYCLIC = (0.5, 0.5, 0.5, 0.5)
TILTED = ((3.0, 0.2, -0.1), (0.2, 2.0, 0.3), (-0.1, 0.3, 4.0))
SATELLITE = ((1250.0, -31.0, 12.5), (-31.0, 980.0, 7.25), (12.5, 7.25, 1610.0))
THIN = ((0.50001, -0.49999, 1e-6), (-0.49999, 0.50001, 2e-6), (1e-6, 2e-6, 1.00001))
NEARLY_SYMMETRIC = ((2.0, 1e-9, 0.0), (1e-9, 2.0, 2e-9), (0.0, 2e-9, 3.0))
W = (0.3, 0.7, -0.9)
SHORT: Floats = (0.5, 1.0, 2.0, 4.0)
LONG: Floats = (1.0, 10.0, 100.0, 1000.0)

NEAR = tuple(
    s * 2.0**-k
    for s, k in ((1, 10), (-1, 10), (1, 20), (-1, 27), (1, 30), (-1, 34), (1, 37), (-1, 40), (1, 40))
)
"""Relative distances from the separatrix, 1e-3 … 1e-12."""

STARTS: dict[str, list[Start]] = {
    "generic": [
        Start("generic, short", GENERIC, (0.1, -0.2, 0.3), W),
        Start("generic, long", GENERIC, (0.1, -0.2, 0.3), (1.5, 0.7, -0.4)),
        Start("against the spin", GENERIC, (-0.3, 0.5, 1.5), (0.2, -0.4, -0.9)),
        Start("h as large as the rest", GENERIC, (0.4, 1.3, -2.0), W),
        Start("large h", GENERIC, (4.0, -3.0, 7.0), W),
        Start("h in a principal plane", GENERIC, (0.5, 0.0, -0.75), W),
        Start("h in another plane", GENERIC, (0.5, 0.25, 0.0), (1.5, 0.7, -0.4)),
        Start("h and spin in a plane", GENERIC, (0.0, 0.25, -0.75), (0.0, 0.7, -0.9)),
        Start("two lobes, one", (1.0, 1.5, 2.25), (0.05, 0.1, 0.05), (0.2, 0.1, 1.0)),
        Start("two lobes, the other", (1.0, 1.5, 2.25), (0.05, 0.1, 0.05), (0.2, 0.1, -1.0)),
        Start("inner lobe about the long axis", (1.0, 1.5, 2.25), (0.05, 0.1, 0.05), (1.1, -0.2, 0.1)),
        Start("no rotation at first but a little", GENERIC, (0.3, -0.5, 0.4), (1e-3, 2e-3, -1e-3)),
    ],
    "axis": [
        Start("h along the axis of the smallest moment", GENERIC, (0.8, 0.0, 0.0), W),
        Start("h along that of the middle one", GENERIC, (0.0, 0.6, 0.0), W),
        Start("h along that of the largest", GENERIC, (0.0, 0.0, -0.5), W),
        Start("h along the first, long", GENERIC, (-0.4, 0.0, 0.0), (1.5, 0.7, -0.4)),
        Start("h along the middle, oscillating", GENERIC, (0.0, 3.0, 0.0), (0.2, 1.0, 0.3)),
        Start("h along the third, across", GENERIC, (0.0, 0.0, 2.5), (0.9, 0.4, -0.1)),
    ],
    "little inside": [
        *(Start(f"{h:g} along none", GENERIC, (h, -2 * h, h), W) for h in (1e-4, 1e-8, 1e-16, 1e-300)),
        *(
            Start(f"{h:g} along the middle axis, long", GENERIC, (0.0, h, 0.0), (1.5, 0.7, -0.4))
            for h in (1e-8, 1e-300)
        ),
        Start("1e-4 in a sphere", (1.5, 1.5, 1.5), (1e-4, -1e-4, 2e-4), W),
        Start("1e-16 in a symmetric body", (1.0, 1.0, 1.7), (1e-16, -1e-16, 2e-16), W),
    ],
    "much inside": [
        Start("1e3", GENERIC, (1e3, -2e3, 3e3), W),
        Start("1e6", GENERIC, (2e6, 1e6, -2e6), W),
        Start("1e12", GENERIC, (2e12, 1e12, -2e12), W),
        Start("1e8 along the middle axis", GENERIC, (0.0, 1e8, 0.0), W),
    ],
    "dual spin": [
        Start(
            "oblate, despun platform", (1200.0, 1150.0, 900.0), (0.0, 0.0, 3500.0), (0.002, -0.001, 0.00007)
        ),
        Start("prolate, fast rotor", (300.0, 310.0, 120.0), (0.0, 0.0, 40.0), (0.01, -0.02, 0.3)),
        Start("symmetric platform", (300.0, 300.0, 120.0), (0.0, 0.0, 40.0), (0.01, -0.02, 0.3)),
        Start("rotor against the spin", (300.0, 310.0, 420.0), (0.0, 0.0, -100.0), (0.05, -0.02, 0.25)),
        Start("momentum bias, tilted wheel", SATELLITE, (1.5, -48.0, 0.75), (1e-4, -1.1e-3, 5e-5)),
    ],
    "symmetric": [
        Start("oblate, h along none", (1.0, 1.0, 1.7), (0.2, -0.1, 0.3), W),
        Start("prolate, h along none", (0.4, 1.3, 1.3), (0.2, -0.1, 0.3), (1.5, -0.4, 0.7)),
        Start("oblate, h along its axis", (1.0, 1.0, 1.7), (0.0, 0.0, -0.8), W),
        Start("prolate, h along its axis", (0.4, 1.3, 1.3), (0.9, 0.0, 0.0), (1.5, -0.4, 0.7)),
        Start("oblate, h across", (1.0, 1.0, 1.7), (0.5, 0.0, 0.0), W),
    ],
    "nearly symmetric": [
        Start("oblate 1e-9", (1.0, 1.0 + 1e-9, 1.7), (0.2, -0.1, 0.3), W),
        Start("last bit, h along its axis", (1.0, 1.0 + 2.0**-52, 1.7), (0.0, 0.0, 0.3), W),
        Start(
            "prolate 1e-6, h nearly along its axis",
            (0.4, 1.3, 1.3 + 1e-6),
            (0.9, 1e-9, 0.0),
            (1.5, -0.4, 0.7),
        ),
        Start("planet", (8.0101e37, 8.0103e37, 8.0365e37), (1e31, -2e31, 5e32), (7e-11, 3e-11, 7.292115e-5)),
        Start("tilted tensor", NEARLY_SYMMETRIC, (0.1, 0.2, -0.3), (0.3, 0.4, 1.0)),
    ],
    "spherical": [
        Start("h along none", (1.5, 1.5, 1.5), (0.2, 0.5, -0.3), W),
        Start("h along an axis", (1.5, 1.5, 1.5), (0.0, 0.0, 2.0), W),
        Start("nearly 1e-9", (1.0, 1.0 + 1e-9, 1.0 + 3e-9), (0.2, 0.5, -0.3), W),
        Start("nearly, little inside", (1.0, 1.0 + 1e-9, 1.0 + 3e-9), (1e-9, 2e-9, -1e-9), W),
    ],
    "thin": [
        Start("rod", (1e-6, 1.0, 1.0 + 5e-7), (1e-7, 0.02, 0.3), (2.0, 0.7, -0.9)),
        Start("rod, h along it", (1e-6, 1.0, 1.0 + 5e-7), (1e-3, 0.0, 0.0), (0.1, 0.05, 1.0)),
        Start("plate", (1.0, 2.0, 3.0), (0.3, -0.2, 0.4), (0.3, 0.5, 0.7)),
        Start("plate, long", (1.0, 2.0, 3.0), (0.3, -0.2, 0.4), (1.3, 0.2, 0.4)),
        Start("round plate", (1.0, 1.0, 2.0), (0.3, -0.2, 0.4), (0.3, 0.5, 0.7)),
        Start("tilted rod", THIN, (0.1, -0.1, 0.2), (0.7, 0.9, 0.3)),
    ],
    "tilted": [
        Start("generic", TILTED, (0.3, 0.1, -0.4), (0.1, -0.2, 0.9)),
        Start("generic, long", TILTED, (0.3, 0.1, -0.4), (0.25, -1.0, 0.1)),
        Start("large h", TILTED, (13.0, -8.0, 6.0), (0.1, -0.2, 0.9)),
        Start("axes permuted", GENERIC, (0.1, -0.2, 0.3), W, axes=CYCLIC),
    ],
    "scaled": [
        Start("molecule", (1.0226e-47, 1.9191e-47, 2.9417e-47), (3e-36, 1e-35, -2e-35), (1e12, 2e12, 9e12)),
        Start(
            "planet with a core", (8.0101e37, 8.0903e37, 9.0365e37), (3e32, -2e32, 5e33), (7e-6, 3e-6, 7.3e-5)
        ),
    ],
    "stable": [
        Start("at rest", GENERIC, (0.3, -0.5, 0.4), (0.0, 0.0, 0.0)),
        Start("along the third axis with h", GENERIC, (0.0, 0.0, 0.5), (0.0, 0.0, 1.5)),
        Start("along the middle axis, held by h", GENERIC, (0.0, 2.5, 0.0), (0.0, 0.5, 0.0)),
        Start("along none", (2.0, 3.0, 4.0), (0.75, 1.0, 1.0), (0.25, 0.5, 1.0)),
        Start("along none, of most energy", (2.0, 3.0, 4.0), (-0.25, -1.0, -3.0), (0.25, 0.5, 1.0)),
        *(
            Start(f"near the third axis by {d:g}", GENERIC, (0.0, 0.0, 0.5), (d, -d, 1.5))
            for d in (1e-4, 1e-10, 1e-16)
        ),
        Start("near the middle axis by 1e-8", GENERIC, (0.0, 2.5, 0.0), (1e-8, 0.5, -1e-8)),
        Start("near one along none, 2⁻³⁰", (2.0, 3.0, 4.0), (0.75, 1.0, 1.0), (0.25 + 2.0**-30, 0.5, 1.0)),
        Start(
            "near one along none, last bit", (2.0, 3.0, 4.0), (-0.25, -1.0, -3.0), (0.25 + 2.0**-54, 0.5, 1.0)
        ),
    ],
    "unstable": [
        Start("along the middle axis, little h", GENERIC, (0.0, 0.1, 0.0), (0.0, 1.0, 0.0), SHORT),
        Start("along none", (2.0, 3.0, 4.0), (1.0, 1.0, 2.0), (1.5, -3.0, -1.5), SHORT),
        Start("in a principal plane", (3.0, 4.0, 6.0), (2.5, 0.0, -1.0), (2.5, 1.0, 0.5), SHORT),
    ],
    "separatrix": [
        Start("h along the middle axis", (1.0, 2.0, 2.5), (0.0, 1.0, 0.0), (-2.0, -0.5, 0.0), SHORT),
        Start("h along the middle axis, wide", (3.0, 4.0, 6.0), (0.0, 1.5, 0.0), (2.0, 0.0, -2.0), SHORT),
        Start(
            "h in the plane of the first and third",
            (3.0, 4.0, 6.0),
            (2.5, 0.0, -1.0),
            (-1.5, 1.0, -1.5),
            SHORT,
        ),
        Start(
            "h in the plane of the first and second", (2.0, 3.0, 4.0), (2.0, 1.0, 0.0), (0.5, 3.0, 1.0), SHORT
        ),
        Start(
            "h in the plane of the second and third", (3.0, 4.0, 5.0), (0.0, 1.5, 0.5), (2.0, 1.5, 2.0), SHORT
        ),
        Start("h along the first axis", (3.0, 4.0, 6.0), (3.0, 0.0, 0.0), (-1.0, -0.5, 2.0), SHORT),
        Start("h along the third axis", (2.0, 3.0, 4.0), (0.0, 0.0, 2.0), (2.0, 0.0, -0.5), SHORT),
        Start("h along none", (2.0, 3.0, 4.0), (1.0, 1.0, 2.0), (-2.5, 1.0, -2.5), SHORT),
        Start("h along none, once more", (3.0, 4.0, 5.0), (1.5, 1.5, 1.0), (2.5, -1.5, 2.5), SHORT),
        Start("symmetric body, h along none", (2.0, 2.0, 3.0), (0.5, 0.5, 1.5), (-2.5, -2.5, 1.0), SHORT),
        Start("cusp, h along none", (2.0, 3.0, 4.0), (4.0, 1.0, 4.0), (-6.0, -3.0, 3.0), LONG),
        Start("cusp, h in a principal plane", (2.0, 3.0, 4.0), (1.0, 0.0, 2.0), (-2.5, 0.0, 0.5), LONG),
    ],
    "near the separatrix": [
        *(
            Start(f"h along none, {d:.0e}", (2.0, 3.0, 4.0), (1.0, 1.0, 2.0), (-2.5, 1.0, -2.5 * (1 + d)))
            for d in NEAR
        ),
        *(
            Start(
                f"h in a principal plane, {d:.0e}",
                (3.0, 4.0, 6.0),
                (2.5, 0.0, -1.0),
                (-1.5 * (1 + d), 1.0, -1.5),
            )
            for d in NEAR[1::3]
        ),
        *(
            Start(
                f"h along the middle axis, {d:.0e}",
                (1.0, 2.0, 2.5),
                (0.0, 1.0, 0.0),
                (-2.0 * (1 + d), -0.5, 0.0),
            )
            for d in NEAR[::4]
        ),
        *(
            Start(f"from the saddle, {d:.0e}", (2.0, 3.0, 4.0), (1.0, 1.0, 2.0), (1.5 + d, -3.0, -1.5))
            for d in NEAR[3::4]
        ),
        Start("little h, 1e-12 off the middle axis", GENERIC, (1e-8, -1e-8, 2e-8), (1e-12, 1.0, -1e-12)),
        *(
            Start(f"cusp, {d:.0e}", (2.0, 3.0, 4.0), (4.0, 1.0, 4.0), (-6.0 * (1 + d), -3.0, 3.0))
            for d in NEAR[:2]
        ),
    ],
}


def cases() -> Iterator[MotionCase]:
    """The cases without their states."""
    for kind, starts in STARTS.items():
        for start in starts:
            full = np.ndim(start.inertia) == 2
            body = {"mass": 1.0, ("inertia" if full else "moments"): start.inertia}
            middle = float(np.sort(np.linalg.eigvalsh(start.inertia) if full else start.inertia)[1])
            inside, spin = math.hypot(*start.rotor) / middle, math.hypot(*start.omega)
            rotation = 2 * math.pi / (spin or inside)
            first = 0.25 * 2 * math.pi / max(inside, spin)
            times = (first, *(n * rotation for n in start.rotations))
            yield MotionCase(
                f"{kind}: {start.name}",
                kind,
                {**body, "axes": start.axes} if start.axes else body,
                start.omega,
                ATTITUDE,
                times,
                rotor=start.rotor,
            )


def motion(
    case: MotionCase, digits: int, share: Any = 1, changed: int | None = None, returns: bool = True
) -> Motion:
    """The motion of a case; `changed` counts the moments or the tensor's six numbers, then h, then ω."""
    with mp.workdps(digits + 50):
        full = "inertia" in case.body
        inertia = case.body["inertia" if full else "moments"]
        six = [inertia[i][j] for i, j in SIX] if full else list(inertia)
        numbers = [mpf(x) for x in (*six, *case.rotor, *case.omega)]
        if changed is not None:
            numbers[changed] *= 1 + CHANGE
        rotor, omega = numbers[-6:-3], numbers[-3:]
        tensor: Any = numbers[:-6]
        if full:
            tensor = [[numbers[SIX.index((min(i, j), max(i, j)))] for j in range(3)] for i in range(3)]
        elif "axes" in case.body:
            tensor = _in_axes(tensor, case.body["axes"])
        longest = 1.001 * max(case.times) if case.kind in UNSETTLED else None
        return Motion(
            tensor, rotor, omega, case.attitude, digits=digits, share=share, longest=longest, returns=returns
        )


SIX = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def _in_axes(moments: Sequence[Any], axes: Sequence[float]) -> list[list[Any]]:
    """R diag(moments) Rᵀ of the quaternion R."""
    columns = [product(product(axes, [mpf(i == k) for k in range(4)]), conjugate(axes))[:3] for i in range(3)]
    return [
        [sum(m * c[i] * c[j] for m, c in zip(moments, columns, strict=True)) for j in range(3)]
        for i in range(3)
    ]


def condition(case: MotionCase, digits: int = 66) -> Floats:
    """For each time the largest relative change of the state by that of a number of I, h, ω or the time."""
    base = motion(case, digits)
    before = [base.at(t) for t in case.times]
    largest = base.largest()
    found = [_per_time(base, t, state) for t, state in zip(case.times, before, strict=True)]
    numbers = (6 if "inertia" in case.body else 3) + 6
    for i in range(numbers):
        six = "inertia" in case.body
        value = ([case.body["inertia"][a][b] for a, b in SIX] if six else [*case.body["moments"]]) + [
            *case.rotor,
            *case.omega,
        ]
        if not value[i]:
            continue
        changed = motion(case, digits, changed=i)
        for k, t in enumerate(case.times):
            with mp.workdps(digits):
                after = changed.at(t)
                turned = 2 * mpmath.norm(product(conjugate(before[k].quaternion), after.quaternion)[:3])
                faster = [x - y for x, y in zip(after.omega, before[k].omega, strict=True)]
                change = mpmath.norm(faster) / largest if largest else mpf(0)
                found[k] = max(found[k], turned / CHANGE, change / CHANGE)
    return tuple(float(mpmath.nstr(x, 4)) for x in found)


def _per_time(base: Motion, t: float, state: State) -> Any:
    """|t d(state)/dt|."""
    with mp.workdps(50):
        largest = base.largest()
        if not largest:
            return mpf(0)
        rates = base.acceleration(state.omega)
        return t * max(mpmath.norm(state.omega), mpmath.norm(rates) / largest)


def proven(case: MotionCase) -> MotionCase:
    """The case with its states, if two computations agree."""
    slow = case.kind == "spherical" or "sphere" in case.name
    extra = 35 if case.kind == "much inside" else 15 if case.kind == "near the separatrix" else 0
    once = motion(case, 75 + extra, 1 if slow else 0.5)
    again = motion(case, 95 + extra)
    states = [again.at(t) for t in case.times]
    difference = max(
        apart(once.at(t), state) if again.largest() else mpf(0)
        for t, state in zip(case.times, states, strict=True)
    )
    if difference > mpf(10) ** (-DIGITS - 2):
        raise ArithmeticError(f"{case.name}: two computations differ by {mpmath.nstr(difference, 3)}")
    if case.name in STRAIGHT:
        off = straight(case, 1e3)
        if off > mpf(10) ** -DIGITS:
            raise ArithmeticError(f"{case.name}: differs by {mpmath.nstr(off, 3)} from the straight way")
    kappa = condition(case, 66 + (extra if extra > 20 else 0))
    digits = [mpmath.nstr(x, DIGITS) for x in (again.time(), again.turn())] if again.period else []
    return case._replace(
        expected=tuple(states), kappa=kappa, fastest=float(again.largest()), periods=tuple(digits)
    )


def straight(case: MotionCase, rotations: float, digits: int = 50) -> Any:
    """How far the state at this many rotations is from the one that Taylor series reach straight."""
    t = rotations * 2 * math.pi / math.hypot(*case.omega)
    return apart(motion(case, digits, returns=False).straight(t), motion(case, digits).at(t))


if __name__ == "__main__":
    generate(NAME, cases(), proven)
