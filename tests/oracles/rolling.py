"""A body that rolls on a plane, in more digits: Newton's and Euler's equations with the force unknown.

In axes of space, with r from C to the contact and the velocity u = Ω n×(P − O) of the plane at P = C + r,

    m a = m g + F,    I α + ω×I ω = r×F,    a + α×r + ω×ṙ = Ω n×(v + ṙ),

are nine linear equations for a, α and F: the third is the time derivative of the constraint v + ω×r = u. The
contact is where the outward normal of the surface is −n. Its rate ṙ = ω×r + R dp/dt is a difference quotient
of the contact in twice the digits, so that no formula for it is shared with the package. `RollingBody.solve`
solves them in 30 digits. For a body that slips, `SlidingBody` has the force N along n as unknown
in place of F, and n·(a + α×r + ω×ṙ) = 0 in place of the third. `motion` integrates them in extended doubles
(64 bits), the rate of the contact by a
complex step, with Gragg's midpoint rule and Richardson's extrapolation, which know nothing of Taylor series.
"""

from __future__ import annotations

import json
import math
import random
import sys
from collections.abc import Sequence
from itertools import compress
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from mpmath import mp, mpf

__all__ = ["RollingBody", "SlidingBody", "cases", "motion", "motions"]

TABLES = Path(__file__).parent / "tables"
DIGITS = 30
"""Of the numbers that the equations are solved in; differences are computed in twice as many."""
LONG = np.longdouble
COLUMNS = 9
"""Of an extrapolation."""
STEP = LONG(1e-30)
SETTLED = 1e-14
"""A motion is known where it changes by less with half the steps, beside a change of its start by as much."""
MOVE = LONG(1e-10)
MOST_GROWTH = 1e4
"""Motions that depend more on their start are left out: what is asked of them would say little."""
FEWEST_STEPS, MOST_STEPS = 16, 64
"""In a rotation."""
GROUP = 6
"""Motions of one kind of surface that are computed side by side."""
LEAST_MARGIN = 0.05
"""Motions that come nearer to lying flat, or to the rim of their surface, are left out."""
KINDS = ("sphere", "ellipsoid", "disk", "torus", "paraboloid")
SHORT, LONGER = 50, 70
"""How many motions are drawn of less than about 5 rotations, and of 5 to 60; some are not known."""
SLIPPING, LONGER_SLIPPING = 50, 40

Wide = Any
Vector = list[mpf]
Matrix = list[Vector]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Sequence[Any], b: Sequence[Any]) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def add(*vectors: Sequence[Any]) -> Vector:
    return [sum(parts[1:], parts[0]) for parts in zip(*vectors, strict=True)]


def times(s: Any, a: Sequence[Any]) -> Vector:
    return [s * x for x in a]


def mul(m: Sequence[Sequence[Any]], a: Sequence[Any]) -> Vector:
    return [dot(row, a) for row in m]


def transpose(m: Sequence[Sequence[Any]]) -> Matrix:
    return [list(column) for column in zip(*m, strict=True)]


def unit(a: Sequence[Any]) -> Vector:
    return times(1 / mpmath.sqrt(dot(a, a)), a)


def rotation(q: Sequence[Any]) -> Matrix:
    x, y, z, w = q
    n = x * x + y * y + z * z + w * w
    return [
        [1 - 2 * (y * y + z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
        [2 * (x * y + w * z) / n, 1 - 2 * (x * x + z * z) / n, 2 * (y * z - w * x) / n],
        [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, 1 - 2 * (x * x + y * y) / n],
    ]


def contact_point(surface: dict[str, Any], normal: Sequence[mpf]) -> Vector:
    """Return the point of a surface with the outward normal −γ: by Lagrange's rule, grad f ∥ −γ."""
    center = [mpf(x) for x in surface.get("center", (0, 0, 0))]
    kind = surface["kind"]
    if kind == "sphere":
        return add(center, times(-mpf(surface["radius"]), normal))
    if kind == "ellipsoid":
        squares = [mpf(a) ** 2 for a in surface["semi_axes"]]
        axes = [[mpf(x) for x in row] for row in surface.get("axes", ((1, 0, 0), (0, 1, 0), (0, 0, 1)))]
        own = mul(transpose(axes), normal)
        # f = Σ x²/a²: x = −λ a² γ with f = 1.
        point = [-a * g for a, g in zip(squares, own, strict=True)]
        size = mpmath.sqrt(sum((x * x / a for x, a in zip(point, squares, strict=True)), mpf(0)))
        return add(center, mul(axes, times(1 / size, point)))
    if kind == "paraboloid":
        one, other = (mpf(r) for r in surface["radii"])
        x, y = -one * normal[0] / normal[2], -other * normal[1] / normal[2]
        return [x, y, -mpf(surface["apex"]) + x * x / (2 * one) + y * y / (2 * other)]
    axis = unit([mpf(x) for x in surface.get("axis", (0, 0, 1))])
    in_plane = unit(add(normal, times(-dot(normal, axis), axis)))
    if kind == "disk":
        return add(center, times(-mpf(surface["radius"]), in_plane))
    return add(
        center, times(-mpf(surface["major_radius"]), in_plane), times(-mpf(surface["minor_radius"]), normal)
    )


class RollingBody:
    """A case: mass, tensor about C, C, surface, normal, point and rate of the plane, gravity and start."""

    def __init__(self, case: dict[str, Any]) -> None:
        self.case = case
        self.mass = mpf(case["mass"])
        self.inertia = [[mpf(x) for x in row] for row in case["inertia"]]
        self.center = [mpf(x) for x in case["center_of_mass"]]
        self.normal = unit([mpf(x) for x in case["normal"]])
        self.point = [mpf(x) for x in case["point"]]
        self.turntable = mpf(case["turntable"])
        self.gravity = [mpf(x) for x in case["gravity"]]

    def arm(self, q: Sequence[mpf]) -> Vector:
        """Return r from C to the contact, in space."""
        frame = rotation(q)
        in_body = contact_point(self.case["surface"], mul(transpose(frame), self.normal))
        return mul(frame, add(in_body, times(mpf(-1), self.center)))

    def start(self) -> list[mpf]:
        """Return (q, ω in space, C): the contact is at the point of the plane."""
        q = unit4([mpf(x) for x in self.case["attitude"]])
        omega = mul(rotation(q), [mpf(x) for x in self.case["omega"]])
        return [*q, *omega, *add(self.point, times(mpf(-1), self.arm(q)))]

    def plane_velocity(self, place: Sequence[mpf]) -> Vector:
        return times(self.turntable, cross(self.normal, add(place, times(mpf(-1), self.point))))

    def turning(self, q: Sequence[mpf], omega: Sequence[mpf]) -> tuple[list[mpf], Vector, Vector, Matrix]:
        """Return the rate of q, r from C to the contact, its rate, and the tensor in space."""
        spin = quaternion_rate(q, omega)
        arm = self.arm(q)
        with mp.workdps(2 * DIGITS):
            h = mpf(10) ** -DIGITS
            ahead, behind = (self.arm([a + s * b for a, b in zip(q, spin, strict=True)]) for s in (h, -h))
            arm_rate = [(a - b) / (2 * h) for a, b in zip(ahead, behind, strict=True)]
        frame = rotation(q)
        rows_of_inertia = [mul(self.inertia, frame[i]) for i in range(3)]
        inertia = [[dot(row, frame[j]) for j in range(3)] for row in rows_of_inertia]
        return spin, arm, arm_rate, inertia

    def solve(self, state: Sequence[mpf]) -> tuple[list[mpf], Vector, Vector]:
        """Return the rates of a state, the force of the plane and the velocity of C."""
        q, omega, place = state[:4], state[4:7], state[7:]
        spin, arm, arm_rate, inertia = self.turning(q, omega)
        velocity = add(self.plane_velocity(add(place, arm)), times(mpf(-1), cross(omega, arm)))
        plane = times(self.turntable, cross(self.normal, add(velocity, arm_rate)))
        # The unknowns are α and F; a from the constraint.
        fixed = add(plane, times(mpf(-1), cross(omega, arm_rate)))
        gyroscopic = cross(omega, mul(inertia, omega))
        # I α − r×F = −gyroscopic;   −m α×r − F = −m (fixed − g)
        rows = [[mpf(0)] * 7 for _ in range(6)]
        unit_vectors = [[mpf(i == j) for j in range(3)] for i in range(3)]
        for j in range(3):
            by_force, by_turn = cross(arm, unit_vectors[j]), cross(unit_vectors[j], arm)
            for i in range(3):
                rows[i][j] = inertia[i][j]
                rows[i][3 + j] = -by_force[i]
                rows[3 + i][j] = self.mass * by_turn[i]
            rows[3 + j][3 + j] = mpf(1)
        for i in range(3):
            rows[i][6] = -gyroscopic[i]
            rows[3 + i][6] = self.mass * (fixed[i] - self.gravity[i])
        found = eliminate(rows)
        return [*spin, *found[:3], *velocity], found[3:], velocity


class SlidingBody(RollingBody):
    """A case with friction, ("coulomb", μ), ("normal", k) or ("plain", c), and a velocity of C."""

    def velocity(self, state: Sequence[mpf]) -> Vector:
        """Return the velocity at the start, without what it has along the normal at the contact."""
        given = [mpf(x) for x in self.case["velocity"]]
        slip = self.slip(state, given)
        return add(given, times(-dot(slip, self.normal), self.normal))

    def slip(self, state: Sequence[mpf], velocity: Sequence[mpf]) -> Vector:
        arm = self.arm(state[:4])
        plane = self.plane_velocity(add(state[7:10], arm))
        return add(velocity, cross(state[4:7], arm), times(mpf(-1), plane))

    def solve_slipping(self, state: Sequence[mpf], velocity: Sequence[mpf]) -> tuple[Vector, Vector, Vector]:
        """Return the accelerations α and a, and the force of the plane."""
        q, omega = state[:4], state[4:7]
        _, arm, arm_rate, inertia = self.turning(q, omega)
        kind, coefficient = self.case["friction"][0], mpf(self.case["friction"][1])
        slip = self.slip(state, velocity)
        slip = add(slip, times(-dot(slip, self.normal), self.normal))
        push, drag = list(self.normal), [mpf(0)] * 3
        if kind == "coulomb":
            push = add(push, times(-coefficient, unit(slip)))
        elif kind == "normal":
            push = add(push, times(-coefficient, slip))
        else:
            drag = times(-coefficient, slip)
        # The unknowns are α, a and N: I α − N r×push = r×drag − ω×Iω;  m a − N push = m g + drag;
        # n·(a + α×r) = −n·ω×ṙ.
        rows = [[mpf(0)] * 8 for _ in range(7)]
        torque = add(cross(arm, drag), times(mpf(-1), cross(omega, mul(inertia, omega))))
        by_force, lever = cross(arm, push), cross(arm, self.normal)
        for i in range(3):
            for j in range(3):
                rows[i][j] = inertia[i][j]
            rows[i][6], rows[i][7] = -by_force[i], torque[i]
            rows[3 + i][3 + i], rows[3 + i][6] = self.mass, -push[i]
            rows[3 + i][7] = self.mass * self.gravity[i] + drag[i]
            rows[6][i], rows[6][3 + i] = lever[i], self.normal[i]
        rows[6][7] = -dot(self.normal, cross(omega, arm_rate))
        found = eliminate(rows)
        return found[:3], found[3:6], add(times(found[6], push), drag)


def unit4(q: Sequence[mpf]) -> list[mpf]:
    size = mpmath.sqrt(sum((x * x for x in q), mpf(0)))
    return [x / size for x in q]


def quaternion_rate(q: Sequence[mpf], omega: Sequence[mpf]) -> list[mpf]:
    """Return ½ ω∘q with ω in space."""
    vector = add(cross(omega, q[:3]), times(q[3], omega))
    return [*(x / 2 for x in vector), -dot(omega, q[:3]) / 2]


def eliminate(rows: Matrix) -> list[mpf]:
    """Solve linear equations by Gauss, with the largest pivot of each column."""
    n = len(rows)
    table = [list(row) for row in rows]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(table[i][k]))
        table[k], table[pivot] = table[pivot], table[k]
        for i in range(k + 1, n):
            factor = table[i][k] / table[k][k]
            if factor:
                table[i] = [a - factor * b for a, b in zip(table[i], table[k], strict=True)]
    found = [mpf(0)] * n
    for k in reversed(range(n)):
        known = sum((table[k][j] * found[j] for j in range(k + 1, n)), mpf(0))
        found[k] = (table[k][n] - known) / table[k][k]
    return found


class Extended:
    """Cases with one kind of surface, side by side in extended doubles; the force is eliminated."""

    def __init__(self, cases: Sequence[dict[str, Any]]) -> None:
        def column(name: str) -> Wide:
            return np.array([case[name] for case in cases], dtype=LONG)

        self.surfaces = [case["surface"] for case in cases]
        self.mass, self.inertia, self.center = column("mass"), column("inertia"), column("center_of_mass")
        self.point, self.gravity, self.turntable = column("point"), column("gravity"), column("turntable")
        self.normal = directions(column("normal"))
        with mp.workdps(DIGITS):
            starts = [[mpmath.nstr(x, 24) for x in RollingBody(case).start()] for case in cases]
        self.start = np.array([[LONG(x) for x in row] for row in starts])
        self.t = column("t")

    def add_copies(self, move: Wide) -> None:
        """Put a copy beside each case, with a start that is turned and spun up by so much."""
        self.surfaces = [*self.surfaces, *self.surfaces]
        for name, value in list(vars(self).items()):
            if isinstance(value, np.ndarray):
                setattr(self, name, np.concatenate([value, value]))
        self.start[len(self.start) // 2 :, :7] += move * np.array([0.3, -0.5, 0.4, 0.6, 0.5, -0.6, 0.7], LONG)

    def rates(self, state: Wide) -> Wide:
        """Return the rates of (q, ω in space, C); that of the contact by a complex step."""
        q, omega, place = state[:, :4], state[:, 4:7], state[:, 7:]
        frame = rotations(q)
        normal = np.einsum("nij,ni->nj", frame, self.normal)
        turned = np.einsum("nij,ni->nj", frame, omega)
        found = contacts(self.surfaces, normal + 1j * (STEP * product(normal, turned)))
        arm = np.einsum("nij,nj->ni", frame, found.real - self.center)
        arm_rate = product(omega, arm) + np.einsum("nij,nj->ni", frame, found.imag / STEP)
        inertia = np.einsum("nij,njk,nlk->nil", frame, self.inertia, frame)
        table = self.turntable[:, None]
        velocity = table * product(self.normal, place + arm - self.point) - product(omega, arm)
        fixed = table * product(self.normal, velocity + arm_rate) - product(omega, arm_rate)
        # F = m (fixed − g − α×r) in I α + ω×I ω = r×F.
        mass = self.mass[:, None]
        right = product(arm, mass * (fixed - self.gravity)) - product(omega, applied(inertia, omega))
        axes = np.eye(3, dtype=LONG)
        columns = [
            applied(inertia, np.broadcast_to(axis, arm.shape)) + mass * product(arm, product(axis, arm))
            for axis in axes
        ]
        # By Cramer's rule, with products of columns.
        volume = inner(columns[0], product(columns[1], columns[2]))
        turn = [inner(right, product(columns[i - 2], columns[i - 1])) / volume for i in range(3)]
        spin = (product(omega, q[:, :3]) + q[:, 3:] * omega) / 2
        return np.concatenate(
            [spin, -inner(omega, q[:, :3])[:, None] / 2, np.stack(turn, axis=1), velocity], axis=1
        )

    def ends(self, steps: int) -> tuple[Wide, Wide]:
        """Return the states at the times of the cases, after so many steps, and their errors in a step."""
        state, h = self.start, (self.t / steps)[:, None]
        error = np.zeros(len(state), dtype=LONG)
        self.least_margin = self.margins(state)
        for _ in range(steps):
            found, off = self.extrapolate(state, h)
            error = np.maximum(error, off)
            found[:, :4] /= np.sqrt(inner(found[:, :4], found[:, :4]))[:, None]
            state = found
            self.least_margin = np.minimum(self.least_margin, self.margins(state))
        return state, error

    def margins(self, state: Wide) -> Wide:
        """Return how far the contacts are from lying flat, as a sine, or from the rim, over the depth."""
        normal = np.einsum("nij,ni->nj", rotations(state[:, :4]), self.normal)
        kind = self.surfaces[0]["kind"]
        if kind == "paraboloid":
            apex = np.array([surface["apex"] for surface in self.surfaces], dtype=LONG)
            return -contacts(self.surfaces, normal)[:, 2] / apex
        if kind in ("sphere", "ellipsoid"):
            return np.ones(len(state), dtype=LONG)
        axis = directions(np.array([surface.get("axis", (0, 0, 1)) for surface in self.surfaces], dtype=LONG))
        along = inner(normal, axis)
        return np.sqrt(1 - along * along)

    def extrapolate(self, state: Wide, step: Wide) -> tuple[Wide, Wide]:
        """Return the states after a step by Gragg's rule and Richardson's extrapolation, and their errors."""
        first = self.rates(state)
        before_row: list[Wide] = []
        for row in range(COLUMNS):
            n = 2 * (row + 1)
            h = step / n
            before, now = state, state + h * first
            for _ in range(n - 1):
                before, now = now, before + 2 * h * self.rates(now)
            table = [(before + now + h * self.rates(now)) / 2]
            for k in range(1, row + 1):
                factor = (LONG(n) / (2 * (row - k + 1))) ** 2 - 1
                table.append(table[k - 1] + (table[k - 1] - before_row[k - 1]) / factor)
            before_row, last_row = table, before_row
        # The last but one of this row and the last of the one before have the same order.
        return table[-1], np.max(np.abs(table[-2] - last_row[-1]), axis=1)


class ExtendedSliding(Extended):
    """Cases of bodies that slip: the state has the velocity of C too."""

    def __init__(self, cases: Sequence[dict[str, Any]]) -> None:
        super().__init__(cases)
        kinds = [case["friction"][0] for case in cases]
        coefficient = np.array([case["friction"][1] for case in cases], dtype=LONG)
        self.laws = [
            np.where([kind == one for kind in kinds], coefficient, LONG(0))[:, None]
            for one in ("coulomb", "normal", "plain")
        ]
        with mp.workdps(DIGITS):
            bodies = [SlidingBody(case) for case in cases]
            starts = [[mpmath.nstr(x, 24) for x in body.velocity(body.start())] for body in bodies]
        velocity = np.array([[LONG(x) for x in row] for row in starts])
        self.start = np.concatenate([self.start, velocity], axis=1)

    def add_copies(self, move: Wide) -> None:
        super().add_copies(move)
        self.laws = [np.concatenate([law, law]) for law in self.laws]

    def rates(self, state: Wide) -> Wide:
        """Return the rates of (q, ω in space, C, its velocity)."""
        q, omega, place, velocity = state[:, :4], state[:, 4:7], state[:, 7:10], state[:, 10:]
        frame = rotations(q)
        normal = np.einsum("nij,ni->nj", frame, self.normal)
        turned = np.einsum("nij,ni->nj", frame, omega)
        found = contacts(self.surfaces, normal + 1j * (STEP * product(normal, turned)))
        arm = np.einsum("nij,nj->ni", frame, found.real - self.center)
        arm_rate = product(omega, arm) + np.einsum("nij,nj->ni", frame, found.imag / STEP)
        inertia = np.einsum("nij,njk,nlk->nil", frame, self.inertia, frame)
        plane = self.turntable[:, None] * product(self.normal, place + arm - self.point)
        slip = velocity + product(omega, arm) - plane
        slip = slip - inner(slip, self.normal)[:, None] * self.normal
        coulomb, by_normal, plain = self.laws
        push = self.normal - coulomb * directions(slip) - by_normal * slip
        drag = -plain * slip
        columns = [inertia[:, :, i] for i in range(3)]
        volume = inner(columns[0], product(columns[1], columns[2]))

        def solved(right: Wide) -> Wide:
            parts = [inner(right, product(columns[i - 2], columns[i - 1])) / volume for i in range(3)]
            return np.stack(parts, axis=1)

        mass = self.mass[:, None]
        by_push = solved(product(arm, push))
        without = solved(product(arm, drag) - product(omega, applied(inertia, omega)))
        lever = product(arm, self.normal)
        bracket = inner(self.normal, push / mass) + inner(lever, by_push)
        free = inner(self.normal, self.gravity + drag / mass + product(omega, arm_rate)) + inner(
            lever, without
        )
        pressure = (-free / bracket)[:, None]
        turn = without + pressure * by_push
        acceleration = self.gravity + (pressure * push + drag) / mass
        spin = (product(omega, q[:, :3]) + q[:, 3:] * omega) / 2
        return np.concatenate(
            [spin, -inner(omega, q[:, :3])[:, None] / 2, turn, velocity, acceleration], axis=1
        )


def inner(a: Wide, b: Wide) -> Wide:
    return np.sum(a * b, axis=-1)


def applied(matrices: Wide, vectors: Wide) -> Wide:
    return np.einsum("nij,nj->ni", matrices, vectors)


def product(a: Wide, b: Wide) -> Wide:
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)


def directions(vectors: Wide) -> Wide:
    return vectors / np.sqrt(np.sum(vectors * vectors, axis=-1))[..., None]


def rotations(q: Wide) -> Wide:
    x, y, z, w = q.T
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    rows = [
        [ww + xx - yy - zz, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), ww - xx + yy - zz, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), ww - xx - yy + zz],
    ]
    return np.moveaxis(np.array(rows), -1, 0) / (xx + yy + zz + ww)[:, None, None]


def contacts(surfaces: Sequence[dict[str, Any]], normal: Wide) -> Wide:
    """Return the points with the outward normals −γ, for complex normals too."""

    def column(name: str, default: Any = (0, 0, 0)) -> Wide:
        return np.array([surface.get(name, default) for surface in surfaces], dtype=LONG)

    kind = surfaces[0]["kind"]
    if kind == "sphere":
        return column("center") - column("radius")[:, None] * normal
    if kind == "ellipsoid":
        axes, lengths = column("axes", np.eye(3)), column("semi_axes")
        stretched = lengths * np.einsum("nij,ni->nj", axes, normal)
        own = lengths * stretched / np.sqrt(np.sum(stretched * stretched, axis=1))[:, None]
        return column("center") - np.einsum("nij,nj->ni", axes, own)
    if kind == "paraboloid":
        radii = column("radii")
        flat = -radii * normal[:, :2] / normal[:, 2:]
        height = np.sum(flat * flat / (2 * radii), axis=1) - column("apex")
        return np.concatenate([flat, height[:, None]], axis=1)
    axis = directions(column("axis", (0, 0, 1)))
    flat = directions(normal - np.sum(normal * axis, axis=1)[:, None] * axis)
    if kind == "disk":
        return column("center") - column("radius")[:, None] * flat
    return (
        column("center") - column("major_radius")[:, None] * flat - column("minor_radius")[:, None] * normal
    )


def motion(case: dict[str, Any], steps: int = 256) -> Wide:
    """Return the state of a case at its time: (q, ω in space, C), and the velocity of C if it slips."""
    kind = ExtendedSliding if "friction" in case else Extended
    return kind([case]).ends(steps)[0][0]


def motions(cases: Sequence[dict[str, Any]], steps: int) -> Wide:
    """Return the states of cases that roll, of one kind of surface, at their times: computed side by side."""
    return Extended(cases).ends(steps)[0]


def draw(number: int, rng: random.Random) -> dict[str, Any]:
    """Draw a case: every surface in turn, every second plane tilted, every third a turntable."""
    kind = KINDS[number % 5]

    def near(size: float, *middle: float) -> list[float]:
        return [x + size * rng.uniform(-1, 1) for x in middle]

    surface: dict[str, Any] = {"kind": kind}
    if kind == "sphere":
        surface |= {"radius": 0.5, "center": near(0.15, 0, 0, 0)}
    elif kind == "ellipsoid":
        surface |= {"semi_axes": near(0.15, 0.5, 0.6, 0.8), "center": near(0.1, 0, 0, 0)}
        if number % 2:
            cos, sin = 0.8, 0.6
            surface |= {"axes": [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]}
    elif kind == "disk":
        surface |= {"radius": 0.5, "center": near(0.05, 0, 0, 0)}
    elif kind == "torus":
        surface |= {"major_radius": 0.4, "minor_radius": 0.15, "center": near(0.05, 0, 0, 0)}
    else:
        surface |= {"radii": near(0.1, 0.6, 0.9), "apex": 0.4}
    if kind in ("disk", "torus"):
        surface |= {"axis": near(0.3, 0, 0, 1)}
    one, two, three = near(0.03, 0.12, 0.15, 0.2)
    products = near(0.02, 0, 0, 0)
    fast = kind in ("disk", "torus")
    omega = near(2.0, 0, 0, 14) if fast else near(12.0, 0, 0, 0)
    if kind == "paraboloid":
        omega = near(0.4, 0, 0, 6)
    tilt = 0.9 if fast else 0.1 if kind == "paraboloid" else 2.0
    attitude = [*near(0.05, 1, 0, 0), 1.0] if fast else [*near(tilt / 2, 0, 0, 0), 1.0]
    is_tilted = number // 5 % 2 == 1
    # On an incline a paraboloid would roll over its rim.
    lean = 0.02 if kind == "paraboloid" else 0.15
    return {
        "surface": surface,
        "mass": 1.0 + rng.random(),
        "inertia": [
            [one, products[0], products[1]],
            [products[0], two, products[2]],
            [products[1], products[2], three],
        ],
        "center_of_mass": near(0.03, 0, 0, 0),
        "normal": near(lean, 0, 0, 1) if is_tilted else [0.0, 0.0, 1.0],
        "point": near(1.0, 0, 0, 0),
        "turntable": 0.8 if number % 3 == 2 and kind != "paraboloid" else 0.0,
        "gravity": [0.0, 0.0, -9.81],
        "omega": omega,
        "attitude": attitude,
        "t": 2.25 if fast else 2.5,
    }


def longer(number: int, count: int, rng: random.Random, least: float = 5.0) -> dict[str, Any]:
    """Draw one of so many cases over `least` to 60 rotations, with the less tilt the longer it lasts."""
    case = draw(number, rng)
    rotations = least * (60 / least) ** (number // 5 / (count // 5 - 1))
    t = 2 * math.pi * rotations / math.hypot(*case["omega"])
    tilt = [x * case["t"] / t for x in case["normal"][:2]]
    return case | {"t": t, "normal": [*tilt, case["normal"][2]]}


def is_body(case: dict[str, Any]) -> bool:
    """Return whether some distribution of mass has these moments."""
    moments = np.linalg.eigvalsh(np.array(case["inertia"]))
    return bool(moments[2] < moments[0] + moments[1])


def rotations_of(case: dict[str, Any]) -> float:
    return float(case["t"] * math.hypot(*case["omega"]) / (2 * math.pi))


def slipping(number: int, case: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    """Return the case with half the spin, so that the plane need not pull, friction and a slip that lasts."""
    share = min(2.5 / case["t"], 1.0)
    friction = [("coulomb", 0.02 * share), ("normal", 0.1 * share), ("plain", 0.6 * share)][number // 5 % 3]
    case = case | {"omega": [0.5 * x for x in case["omega"]]}
    with mp.workdps(DIGITS):
        body = RollingBody(case)
        _, _, rolling = body.solve(body.start())
    angle = rng.uniform(0, 2 * math.pi)
    slip = [5 * math.cos(angle), 5 * math.sin(angle), 0.0]
    normal = [float(x) for x in body.normal]
    slip = [s - dot(slip, normal) * n for s, n in zip(slip, normal, strict=True)]
    velocity = [float(v) + s for v, s in zip(rolling, slip, strict=True)]
    return case | {"friction": friction, "velocity": velocity}


def add_ends(drawn: list[dict[str, Any]], kind: type[Extended]) -> None:
    """Add the ends of cases with one kind of surface, as far as they are known.

    A case beside each, whose start is turned and spun up a little, shows how much changes of the start grow.
    """
    left, per_rotation = drawn, FEWEST_STEPS
    before: Wide = None
    while left and per_rotation <= MOST_STEPS:
        steps = math.ceil(per_rotation * max(rotations_of(case) for case in left))
        extended = kind(left)
        extended.add_copies(MOVE)
        both, _ = extended.ends(steps)
        now, moved = both[: len(left)], both[len(left) :]
        growth = np.max(np.abs(moved - now), axis=1) / MOVE
        margin = np.minimum(*np.split(extended.least_margin, 2))
        # Of what comes near to lying flat, or to a rim, too little is known.
        is_left = (margin > LEAST_MARGIN) & np.isfinite(growth) & (growth < MOST_GROWTH)
        if before is None:
            is_known = np.zeros(len(left), dtype=bool)
        else:
            off = np.max(np.abs(now - before), axis=1)
            is_known = is_left & (off < SETTLED * (1 + growth))
            print(kind.__name__, steps, np.array(off, dtype=float), file=sys.stderr)
        print(np.array(growth, dtype=float), np.array(margin, dtype=float), file=sys.stderr, flush=True)
        for case, end in zip(compress(left, is_known), now[is_known], strict=True):
            case["end"] = [np.format_float_scientific(x, unique=False, precision=20) for x in end]
        is_left &= ~is_known
        left, before = list(compress(left, is_left)), now[is_left]
        per_rotation *= 2


def main() -> None:
    """Write the tables, or the one that is named, which takes half an hour each."""
    for name in sys.argv[1:] or ("rolling", "sliding"):
        rng = random.Random(47)
        if name == "rolling":
            drawn = [draw(number, rng) for number in range(SHORT)]
            rng = random.Random(48)
            drawn += [longer(number, LONGER, rng) for number in range(LONGER)]
        else:
            drawn = [draw(number, rng) for number in range(SLIPPING)]
            drawn = [slipping(number, case, rng) for number, case in enumerate(drawn)]
            rng = random.Random(48)
            # Half the spin is left of these.
            more = [longer(number, LONGER_SLIPPING, rng, 10.0) for number in range(LONGER_SLIPPING)]
            drawn += [slipping(number, case, rng) for number, case in enumerate(more)]
        for kind in KINDS:
            alike = [case for case in drawn if case["surface"]["kind"] == kind and is_body(case)]
            alike.sort(key=rotations_of)
            for first in range(0, len(alike), GROUP):
                add_ends(alike[first : first + GROUP], Extended if name == "rolling" else ExtendedSliding)
            found = [case for case in drawn if "end" in case]
            (TABLES / f"{name}.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def cases() -> list[dict[str, Any]]:
    """Return the cases of the tables, first of bodies that roll, then of those that slip."""
    found: list[dict[str, Any]] = []
    for name in ("rolling", "sliding"):
        found += json.loads((TABLES / f"{name}.json").read_text(encoding="utf-8"))
    return found


if __name__ == "__main__":
    main()
