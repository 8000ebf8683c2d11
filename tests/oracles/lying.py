"""A cylinder or a cone that lies on the plane z = 0 and rolls, by Newton and Euler in many digits.

The unknowns are the accelerations a and α, the force F, the couple of the plane across the line of contact,
and λ, by which ω changes along it: with ω = w e and the point r from C to the line,

    m a = m g + F,   I α + ω×I ω = r×F + τ,   α − λ e = w ė,   a + α×r + ω×ṙ = 0,

where ė and ṙ are difference quotients of e and r, which follow from the attitude alone. `motion` integrates
them with Gragg's midpoint rule and Richardson's extrapolation.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mpmath import mp, mpf

from oracles.rolling import (
    Matrix,
    Vector,
    add,
    cross,
    dot,
    eliminate,
    mul,
    quaternion_rate,
    rotation,
    times,
    unit,
    unit4,
)

__all__ = ["LyingBody", "motion"]

DIGITS = 25
COLUMNS = 7
"""Of an extrapolation."""
UP = [mpf(0), mpf(0), mpf(1)]


class LyingBody:
    """A case: mass, tensor about C, radius, height, C from the top along the axis z, gravity."""

    def __init__(self, case: dict[str, Any]) -> None:
        self.kind = case["kind"]
        self.mass = mpf(case["mass"])
        self.inertia = [[mpf(x) for x in row] for row in case["inertia"]]
        self.radius, self.height = mpf(case["radius"]), mpf(case["height"])
        self.from_top = mpf(case["from_top"])
        self.gravity = [mpf(x) for x in case["gravity"]]

    def line(self, q: Sequence[mpf]) -> tuple[Vector, Vector]:
        """Return the direction e of the line of contact, and r from C to a point of it, in space."""
        axis = [row[2] for row in rotation(q)]
        if self.kind == "cylinder":
            below = add(UP, times(-dot(UP, axis), axis))
            return axis, times(-self.radius, unit(below))
        # The apex is on the line.
        flat = unit([-axis[0], -axis[1], mpf(0)])
        return flat, times(self.from_top, axis)

    def solve(self, state: Sequence[mpf]) -> tuple[list[mpf], Vector, Vector]:
        """Return the rates of (q, ω in space, C), the force, and the couple that acts besides it at r."""
        q, omega = state[:4], state[4:7]
        spin = quaternion_rate(q, omega)
        line, arm = self.line(q)
        with mp.workdps(2 * DIGITS):
            h = mpf(10) ** -DIGITS
            ahead, behind = (self.line([a + s * b for a, b in zip(q, spin, strict=True)]) for s in (h, -h))
            line_rate, arm_rate = (
                [(a - b) / (2 * h) for a, b in zip(one, other, strict=True)]
                for one, other in zip(ahead, behind, strict=True)
            )
        frame = rotation(q)
        rows_of_inertia = [mul(self.inertia, frame[i]) for i in range(3)]
        inertia = [[dot(row, frame[j]) for j in range(3)] for row in rows_of_inertia]
        gyroscopic = cross(omega, mul(inertia, omega))
        rate, across = dot(omega, line), cross(UP, line)
        swept = cross(omega, arm_rate)
        # Columns: a, α, F, couples about `across` and about the normal, λ; the right side.
        rows: Matrix = [[mpf(0)] * 13 for _ in range(12)]
        unit_vectors = [[mpf(i == j) for j in range(3)] for i in range(3)]
        of_force = [cross(arm, one) for one in unit_vectors]
        of_turn = [cross(one, arm) for one in unit_vectors]
        for i in range(3):
            rows[i][i], rows[i][6 + i] = self.mass, mpf(-1)
            rows[i][12] = self.mass * self.gravity[i]
            for j in range(3):
                rows[3 + i][3 + j] = inertia[i][j]
                rows[3 + i][6 + j] = -of_force[j][i]
                rows[9 + i][3 + j] = of_turn[j][i]
            rows[3 + i][9], rows[3 + i][10] = -across[i], -UP[i]
            rows[3 + i][12] = -gyroscopic[i]
            rows[6 + i][3 + i], rows[6 + i][11] = mpf(1), -line[i]
            rows[6 + i][12] = rate * line_rate[i]
            rows[9 + i][i] = mpf(1)
            rows[9 + i][12] = -swept[i]
        found = eliminate(rows)
        velocity = times(mpf(-1), cross(omega, arm))
        return [*spin, *found[3:6], *velocity], found[6:9], times(found[9], across)

    def pressure_from(self, state: Sequence[mpf]) -> tuple[Vector, Vector]:
        """Return the force and the centre of pressure, where F alone has the couple across the line."""
        line, arm = self.line(state[:4])
        _, force, couple = self.solve(state)
        # (s e)×F has along `across` the component −s F_z.
        across = cross(UP, line)
        along = -dot(couple, across) / force[2]
        return force, add(state[7:], arm, times(along, line))


def motion(case: dict[str, Any], start: Sequence[Any], t: float, steps: int) -> list[mpf]:
    """Return the state (q, ω in space, C) at a time, from the one at zero."""
    with mp.workdps(DIGITS):
        body, state, h = LyingBody(case), [mpf(x) for x in start], mpf(t) / steps
        for _ in range(steps):
            state = extrapolate(lambda now: body.solve(now)[0], state, h)
            state = [*unit4(state[:4]), *state[4:]]
        return state


def extrapolate(rates: Any, state: list[mpf], step: mpf) -> list[mpf]:
    first = rates(state)
    before_row: list[list[mpf]] = []
    for row in range(COLUMNS):
        n = 2 * (row + 1)
        h = step / n
        before, now = state, add(state, times(h, first))
        for _ in range(n - 1):
            before, now = now, add(before, times(2 * h, rates(now)))
        table = [times(mpf(1) / 2, add(before, now, times(h, rates(now))))]
        for k in range(1, row + 1):
            factor = (mpf(n) / (2 * (row - k + 1))) ** 2 - 1
            change = times(1 / factor, add(table[k - 1], times(mpf(-1), before_row[k - 1])))
            table.append(add(table[k - 1], change))
        before_row = table
    return before_row[-1]
