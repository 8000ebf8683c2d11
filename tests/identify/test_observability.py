"""What logs and periods leave open: each direction that they do not determine is named, and no other.

The oracle computes the predictions by SciPy or by closed forms, their derivatives by central differences, and
the directions whose relative sigma exceeds 10 % by a singular value decomposition.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polhode import RigidBody, Uncertain, identify
from polhode.errors import IdentificationError
from scipy.integrate import solve_ivp
from scipy.linalg import subspace_angles
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
TENSOR_NAMES = ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
NUMBERS = ("mass", "cx", "cy", "cz", *TENSOR_NAMES)
OPEN = 0.1
"""The relative sigma beyond which a direction is named."""
CLEAR = 1.25
"""No sigma of a case is nearer to the limit than by this factor."""
LOST = 1e-6
"""Share of the largest singular value below which only rounding and differences are left."""
G = 9.81
X, Y, Z = np.eye(3)
OBLIQUE = np.array([1.0, 2.0, 2.0]) / 3.0


def tensor(numbers: Any) -> Floats:
    found = np.zeros((3, 3))
    for x, (i, j) in zip(numbers, ELEMENTS, strict=True):
        found[i, j] = found[j, i] = x
    return found


def elements(inertia: Floats) -> Floats:
    return np.array([inertia[place] for place in ELEMENTS])


def slopes(predict: Callable[[Floats], Floats], at: Floats, steps: Floats) -> Floats:
    """Derivatives of predictions, in units of their sigmas, by central differences."""
    moves = np.diag(steps)
    return np.stack(
        [(predict(at + h) - predict(at - h)).ravel() / (2.0 * s) for h, s in zip(moves, steps, strict=True)],
        1,
    )


@dataclass(frozen=True)
class Told:
    """What was reported, and what the oracle says."""

    directions: Any
    parameters: tuple[str, ...]
    sizes: Floats
    """Of the parameters."""
    wanted: Floats
    """Basis of the open directions in units of the sizes, one a row."""
    inverse: Floats | None = None
    """The covariance of the parameters in units of the sizes, where all are determined."""
    warned: bool = True
    """Whether a noisy log is refused, or its body comes with a warning."""


def open_rows(jacobian: Floats, lost_only: bool = False) -> Floats:
    """Directions whose relative sigma exceeds the limit, of a Jacobian in units of sigmas and sizes."""
    is_wide = len(jacobian) < jacobian.shape[1]
    values, rows = np.linalg.svd(jacobian, full_matrices=is_wide)[1:]
    values = np.append(values, np.zeros(len(rows) - len(values)))
    if lost_only:
        return np.asarray(rows[values < LOST * values.max()])
    assert ((OPEN * values < 1.0 / CLEAR) | (OPEN * values > CLEAR)).all(), 1.0 / values
    return np.asarray(rows[OPEN * values < 1.0])


def undetermined(call: Callable[[], Any]) -> Any:
    """The directions of the error."""
    with pytest.raises(IdentificationError, match="undetermined") as caught:
        call()
    assert caught.value.kind == "undetermined"
    return caught.value.observability


# Tumbles

SIGMA = 0.01
MOMENTS = (0.2, 0.35, 0.45)
AXES = Rotation.from_rotvec([0.4, -0.7, 0.5]).as_matrix()
TURNED = AXES @ np.diag(MOMENTS) @ AXES.T


def motions(inertias: Floats, starts: Floats, t: Floats, rotor: Any) -> Floats:
    """ω of bodies (n, 3, 3) at times, (n, times, 3), by Euler's equations; all of them in the same steps."""
    inverses, h = np.linalg.inv(inertias), np.asarray(rotor)[:, None]
    tensors, inverses = inertias.transpose(1, 2, 0).copy(), inverses.transpose(1, 2, 0).copy()

    def turn(_: float, flat: Floats) -> Floats:
        omega = flat.reshape(3, -1)
        (a, b, c), (x, y, z) = np.einsum("ijn,jn->in", tensors, omega) + h, omega
        torque = np.stack([b * z - c * y, c * x - a * z, a * y - b * x])
        return np.asarray(np.einsum("ijn,jn->in", inverses, torque).ravel())

    found = solve_ivp(turn, (t[0], t[-1]), starts.T.ravel(), "DOP853", t, rtol=1e-12, atol=1e-14)
    return np.asarray(found.y.reshape(3, len(starts), len(t)).transpose(1, 2, 0))


def motion_slopes(inertia: Floats, start: Floats, t: Floats, rotor: Any, size: float) -> Floats:
    """Derivatives of ω, in units of its sigma, by start and tensor: by differences of motions at once."""
    steps = np.repeat([1e-5, 1e-5 * size], [3, 6])
    rows = np.concatenate([start, elements(inertia)]) + np.concatenate([np.diag(steps), -np.diag(steps)])
    found = motions(np.array([tensor(row[3:]) for row in rows]), rows[:, :3], t, rotor)
    ahead, behind = found.reshape(2, 9, -1) / SIGMA
    return np.asarray(((ahead - behind) / (2.0 * steps[:, None])).T)


def thrown(inertia: Any, start: Any, end: float, bias: bool = False, rotor: Any = None) -> Told:
    """A throw as `design` sees it, and a noisy log of it."""
    inertia = np.diag(inertia) if np.ndim(inertia) == 1 else np.asarray(inertia)
    inertia = inertia if rotor is not None else inertia / np.trace(inertia)
    start, t, size = (
        np.asarray(start, dtype=float),
        np.linspace(0.0, end, round(100 * end)),
        np.trace(inertia) / 3.0,
    )
    body = RigidBody(mass=1.0, inertia=inertia)
    told = identify.design(body, start, t, SIGMA, bias=bias, rotor=rotor)
    inside = np.zeros(3) if rotor is None else rotor
    jacobian = motion_slopes(inertia, start, t, inside, size)
    # What is left where start and offset may be any.
    others = np.hstack([jacobian[:, :3], *[np.tile(np.eye(3), (len(t), 1)) / SIGMA] * bias])
    left, values, _ = np.linalg.svd(others / np.linalg.norm(others, axis=0), full_matrices=False)
    basis = left[:, values > 1e-6]
    of_tensor = (jacobian[:, 3:] - basis @ (basis.T @ jacobian[:, 3:])) * size
    # Without a rotor the trace is 1, and the scale is open.
    allowed = np.eye(6)
    if rotor is None:
        allowed = np.linalg.svd(np.array([[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]]))[2][1:].T
    wanted = open_rows(of_tensor @ allowed) @ allowed.T
    shapes = len(wanted)
    if rotor is None:
        wanted = np.vstack([wanted, elements(inertia) / size])
    whole = np.zeros((len(wanted), len(told.parameters)))
    whole[:, 3:9] = wanted
    rows = motions(inertia[None], start[None], t, inside)[0] + np.random.default_rng(0).normal(
        0.0, SIGMA, (len(t), 3)
    )
    try:
        found = identify.from_tumble(t, rows, sigma=SIGMA, bias=bias, rotor=rotor)
    except IdentificationError as error:
        warned = error.kind == "undetermined" and len(error.observability) > (rotor is None)
    else:
        warned = len(found.observability) > (rotor is None)
    return Told(
        told.observability, told.parameters, np.full(whole.shape[1], size), whole, warned=warned or not shapes
    )


def near_separatrix(offset: float, size: float) -> Floats:
    """A motion that starts half way, off the separatrix by a share of ω₃."""
    a, b, c = MOMENTS
    return size * np.array([0.5, 0.7, 0.5 * np.sqrt(a * (b - a) / (c * (c - b))) * (1.0 + offset)])


TUMBLES: dict[str, Callable[[], Told]] = {
    "spin about the axis of the least moment": lambda: thrown(MOMENTS, 3.0 * X, 5.0),
    "spin about the middle axis": lambda: thrown(MOMENTS, 3.0 * Y, 1.0),
    "spin about the axis of the largest moment": lambda: thrown(MOMENTS, 3.0 * Z, 5.0, bias=True),
    "spin about an axis that is none of the gyro": lambda: thrown(TURNED, 3.0 * AXES[:, 2], 5.0),
    "sphere": lambda: thrown((1.0, 1.0, 1.0), (1.0, 2.0, 2.0), 5.0),
    "0.6 s": lambda: thrown(MOMENTS, (0.5, 1.0, 0.3), 0.6, bias=True),
    "symmetric body, spin about near its axis": lambda: thrown((0.3, 0.3, 0.4), (0.001, 0.0005, 6.0), 5.0),
    "plane of the separatrix": lambda: thrown(MOMENTS, near_separatrix(1e-4, 2.0), 4.0),
    "plane of the separatrix, other axes": lambda: thrown(TURNED, AXES @ near_separatrix(1e-4, 2.0), 4.0),
    "spin along a rotor": lambda: thrown(MOMENTS, 3.0 * Z, 5.0, rotor=0.5 * Z),
    "spin across a rotor": lambda: thrown(MOMENTS, 3.0 * Z, 2.0, rotor=0.05 * X),
    "tumble": lambda: thrown(TURNED, AXES @ (1.0, 3.0, 0.5), 8.0, bias=True),
    "tumble with a rotor": lambda: thrown(MOMENTS, (1.0, 3.0, 0.5), 8.0, rotor=(0.3, -0.2, 0.5)),
    "symmetric body that precesses": lambda: thrown((0.3, 0.3, 0.4), (2.0, 0.0, 4.0), 8.0),
}


# Wrists

LOAD = RigidBody.from_principal(2.0, (0.02, 0.03, 0.04)).rotated(
    Rotation.from_rotvec([0.3, 0.5, -0.2]).as_quat()
)
LOAD = LOAD.translated((0.03, 0.02, 0.1))
WRENCH_SIGMAS = np.repeat([0.1, 0.01], 3)


def swing(t: Floats, axis: Floats, phase: float = 0.0) -> tuple[Floats, Floats]:
    """Angular velocity and acceleration about an axis."""
    omega = 2.0 * np.sin(1.7 * t + phase) + np.sin(3.1 * t + 2.0 * phase)
    turn = 3.4 * np.cos(1.7 * t + phase) + 3.1 * np.cos(3.1 * t + 2.0 * phase)
    return np.multiply.outer(omega, axis), np.multiply.outer(turn, axis)


def swings(t: Floats, share: float = 1.0) -> tuple[Floats, Floats]:
    """The same about all axes at once."""
    three = [swing(t, axis, phase) for axis, phase in zip(np.eye(3), (0.0, 1.0, 2.0), strict=True)]
    omega, turn = (share * sum(parts, np.zeros((len(t), 3))) for parts in zip(*three, strict=True))
    return omega, turn


def turning(t: Floats, rate: float = 1.0) -> Floats:
    """A specific force that takes many directions."""
    a, b = 0.7 * rate * t, 1.1 * rate * t
    return G * np.stack([np.sin(a), np.cos(a) * np.sin(b), np.cos(a) * np.cos(b)], 1)


def about(axis: Floats, t: Floats) -> Floats:
    """The specific force in a sensor that a level axis turns."""
    angle = -2.0 / 1.7 * np.cos(1.7 * t) - np.cos(3.1 * t) / 3.1
    down = np.cross(axis, (0.3, -0.5, 0.8))
    turned = Rotation.from_rotvec(np.multiply.outer(-angle, axis)).apply(down / np.linalg.norm(down))
    return np.asarray(G * turned)


def wrench(x: Floats, omega: Floats, turn: Floats, push: Floats) -> Floats:
    """Force and torque by Newton and Euler, of mass, centre and tensor about it."""
    mc, shift = x[0] * x[1:4], x[1:4]
    origin = tensor(x[4:]) + x[0] * (shift @ shift * np.eye(3) - np.outer(shift, shift))
    force = x[0] * push + np.cross(turn, mc) + np.cross(omega, np.cross(omega, mc))
    torque = np.cross(mc, push) + turn @ origin + np.cross(omega, omega @ origin)
    return np.hstack([force, torque])


def held(omega: Floats, turn: Floats, push: Floats, gyro: float = 0.0) -> Told:
    """A load on a wrist; with noise of the gyro the angular acceleration is not given."""
    rng, t = np.random.default_rng(1), np.linspace(0.0, 10.0, len(omega))
    truth = np.concatenate([[LOAD.mass], LOAD.center_of_mass, elements(LOAD.inertia)])
    rows = wrench(truth, omega, turn, push) + rng.normal(0.0, 1.0, (len(t), 6)) * WRENCH_SIGMAS
    given: dict[str, Any] = {"force_sigma": 0.1, "torque_sigma": 0.01, "angular_acceleration": turn}
    if gyro:
        del given["angular_acceleration"]
    measured = omega + rng.normal(0.0, gyro, omega.shape)
    moment = float(np.trace(LOAD.inertia)) / 3.0
    sizes = np.repeat([truth[0], np.sqrt(moment / truth[0]), moment], [1, 3, 6])
    jacobian = slopes(lambda x: wrench(x, omega, turn, push) / WRENCH_SIGMAS, truth, 1e-4 * sizes) * sizes

    def fit() -> Any:
        return identify.from_wrench(t, rows[:, :3], rows[:, 3:], measured, push, **given)

    if len(open_rows(jacobian, lost_only=True)) and not gyro:
        return Told(undetermined(fit), NUMBERS, sizes, open_rows(jacobian, lost_only=True))
    found = fit()
    if not gyro:
        sizes = np.repeat([*found.estimate[:1], np.nan, np.nan], [1, 3, 6])
        moment = float(found.estimate[4:7].mean())
        sizes[1:4], sizes[4:] = np.sqrt(moment / sizes[0]), moment
        jacobian = slopes(
            lambda x: wrench(x, omega, turn, push) / WRENCH_SIGMAS, found.estimate, 1e-4 * sizes
        )
        jacobian = jacobian * sizes
    inverse = np.linalg.inv(jacobian.T @ jacobian) if not gyro else None
    return Told(found.observability, found.parameters, sizes, open_rows(jacobian), inverse)


T = np.linspace(0.0, 10.0, 500)
STILL = np.zeros((500, 3))


def both(first: tuple[Floats, Floats], second: tuple[Floats, Floats], push: Floats) -> Told:
    """One axis after the other."""
    half = np.arange(500)[:, None] < 250
    return held(np.where(half, first[0], second[0]), np.where(half, first[1], second[1]), push)


WRISTS: dict[str, Callable[[], Told]] = {
    "wrist that rests": lambda: held(STILL, STILL, np.tile(G * np.array([0.0, 0.6, 0.8]), (500, 1))),
    "wrist that rests in many attitudes": lambda: held(STILL, STILL, turning(T)),
    "quasi-static wrist": lambda: held(*swings(T, 0.01), turning(T)),
    "wrist with one level axis": lambda: held(*swing(T, Z), about(Z, T)),
    "wrist with one oblique axis": lambda: held(*swing(T, OBLIQUE), about(OBLIQUE, T)),
    "wrist with one upright axis": lambda: held(*swing(T, Z), np.tile(G * Z, (500, 1))),
    "wrist with one upright, oblique axis": lambda: held(*swing(T, OBLIQUE), np.tile(G * OBLIQUE, (500, 1))),
    "wrist that spins steadily": lambda: held(np.tile(3.0 * Z, (500, 1)), STILL, turning(T)),
    "wrist with two axes, one after the other": lambda: both(swing(T, X), swing(T, Z), turning(T)),
    "wrist with two oblique axes, one after the other": lambda: both(
        swing(T, AXES[:, 0]), swing(T, AXES[:, 1]), turning(T)
    ),
    "wrist with one axis and a noisy gyro": lambda: held(*swing(T, Z), turning(T), gyro=0.003),
    "wrist that turns about all axes": lambda: held(*swings(T), turning(T)),
}


# Pendulums

BRICK = RigidBody.from_principal(2.0, (0.03, 0.05, 0.06)).rotated(
    Rotation.from_rotvec([0.3, 0.2, -0.4]).as_quat()
)
STIFFNESS = 0.5
SHORT = 1e-4
"""Sigma of a period."""


def compound_period(mass: float, center: Floats, inertia: Floats, axis: Floats, point: Floats) -> float:
    arm = np.cross(axis, center - point)
    return float(
        2.0 * np.pi * np.sqrt((axis @ inertia @ axis + mass * arm @ arm) / (mass * G * np.sqrt(arm @ arm)))
    )


def torsional_period(inertia: Floats, axis: Floats, stiffness: float) -> float:
    return float(2.0 * np.pi * np.sqrt(axis @ inertia @ axis / stiffness))


def bifilar_period(mass: float, inertia: Floats, axis: Floats) -> float:
    return float(2.0 * np.pi * np.sqrt(4.0 * (axis @ inertia @ axis) / (mass * G * 0.3**2)))  # wires of 1


def hung(
    rows: Any,
    body: RigidBody = BRICK,
    mass: bool = True,
    center: bool = True,
    wire: bool = True,
    basis: Any = None,
    sigmas: Any = None,
    **given: Any,
) -> Told:
    """Periods of devices ("compound", axis, point), ("torsional", axis) and ("bifilar", axis).

    `mass`, `center` and `wire` say whether these are known; `basis` spans the tensors that a symmetry allows.
    """
    space = np.eye(6) if basis is None else np.array([elements(one) for one in basis])
    moment = float(np.trace(body.inertia)) / 3.0
    names = [*["mass"] * (not mass), *["cx", "cy", "cz"] * (not center), *TENSOR_NAMES]
    names += ["stiffness of the wire"] * (not wire)
    sizes = [*[body.mass] * (not mass), *[np.sqrt(moment / body.mass)] * (3 * (not center)), *[moment] * 6]
    sizes += [STIFFNESS] * (not wire)
    head = len(names) - 6 - (not wire)
    maps = np.zeros((len(names), head + len(space) + (not wire)))
    maps[:head, :head] = np.eye(head)
    maps[head : head + 6, head : head + len(space)] = space.T
    if not wire:
        maps[-1, -1] = 1.0
    truth = np.concatenate(
        [
            [body.mass] * (not mass),
            body.center_of_mass[: 3 * (not center)],
            elements(body.inertia),
            [STIFFNESS] * (not wire),
        ]
    )
    units = [(row[1] / np.linalg.norm(row[1]), *row[2:]) for row in rows]

    def periods(numbers: Floats) -> Floats:
        m = body.mass if mass else numbers[0]
        at = 0 if mass else 1
        c = body.center_of_mass if center else numbers[at : at + 3]
        inertia, k = tensor(numbers[head : head + 6]), STIFFNESS if wire else numbers[-1]
        found = []
        for (device, *_), (n, *rest) in zip(rows, units, strict=True):
            if device == "compound":
                found.append(compound_period(m, c, inertia, n, rest[0]))
            elif device == "torsional":
                found.append(torsional_period(inertia, n, k))
            else:
                found.append(bifilar_period(m, inertia, n))
        return np.array(found)

    own = np.full(len(rows), SHORT) if sigmas is None else np.asarray(sigmas)
    # Steps along what the symmetry allows.
    lengths = np.array(sizes)
    along = maps * (1.0 / np.linalg.norm(maps / lengths[:, None], axis=0))
    jacobian = slopes(
        lambda z: periods(truth + along @ z) / own, np.zeros(maps.shape[1]), np.full(maps.shape[1], 1e-5)
    )
    # Orthonormal in units of the sizes.
    q, r = np.linalg.qr(along / lengths[:, None])
    jacobian = jacobian @ np.linalg.inv(r)
    swings: list[Any] = []
    for (device, *_), (n, *rest), period, sigma in zip(rows, units, periods(truth), own, strict=True):
        measured = Uncertain(period, sigma)
        if device == "compound":
            swings.append(identify.compound(n, rest[0], measured))
        elif device == "torsional":
            swings.append(identify.torsional(n, measured, STIFFNESS if wire else None))
        else:
            swings.append(identify.bifilar(n, measured, 1.0, 0.3))

    def fit() -> Any:
        return identify.from_pendulum(
            swings,
            gravity=G,
            mass=body.mass if mass else None,
            center_of_mass=body.center_of_mass if center else None,
            **given,
        )

    wanted = open_rows(jacobian, lost_only=True)
    if len(wanted):
        return Told(undetermined(fit), tuple(names), lengths, wanted @ q.T)
    found = fit()
    inverse = q @ np.linalg.inv(jacobian.T @ jacobian) @ q.T
    return Told(found.observability, found.parameters, lengths, open_rows(jacobian) @ q.T, inverse)


def mirrored(normal: Floats) -> Any:
    """A body with a plane of symmetry, the normal, and the tensors of such bodies."""
    side = np.linalg.svd(normal[None])[2][1:]
    a, b = side
    body = RigidBody(
        mass=2.0,
        inertia=np.array([a, b, normal]).T
        @ [[0.03, 0.004, 0], [0.004, 0.05, 0], [0, 0, 0.06]]
        @ np.array([a, b, normal]),
    )
    basis = [np.outer(normal, normal), np.outer(a, a), np.outer(b, b), np.outer(a, b) + np.outer(b, a)]
    return {"body": body, "basis": basis, "normal": normal}


def round_about(axis: Floats) -> Any:
    """A body of revolution, its axis, and the tensors of such bodies."""
    along, across = np.outer(axis, axis), np.eye(3) - np.outer(axis, axis)
    return {
        "body": RigidBody(mass=2.0, inertia=0.03 * along + 0.05 * across),
        "basis": [along, across],
        "axis": axis,
    }


POINT = np.array([0.1, -0.2, 0.3])
SIX: list[Any] = [X, Y, Z, X + Y, X + Z, Y + Z]
PENDULUMS: dict[str, Callable[[], Told]] = {
    "compound about one axis": lambda: hung([("compound", Y, POINT)]),
    "compound about one oblique axis": lambda: hung([("compound", OBLIQUE, POINT)]),
    "compound about two parallel axes": lambda: hung([("compound", Y, POINT), ("compound", Y, 2.0 * POINT)]),
    "torsional about one axis": lambda: hung([("torsional", Z)]),
    "torsional about one oblique axis": lambda: hung([("torsional", OBLIQUE)]),
    "torsional about two parallel axes": lambda: hung([("torsional", X), ("torsional", -X)]),
    "torsional about the axes alone": lambda: hung([("torsional", one) for one in SIX[:3]]),
    "torsional about axes of one plane": lambda: hung([("torsional", one) for one in (X, Y, X + Y, X - Y)]),
    "wire that nothing calibrates": lambda: hung([("torsional", one) for one in SIX], wire=False),
    "mass and centre, compound about parallel axes": lambda: hung(
        [*[("torsional", one) for one in SIX], *[("compound", Y, k * POINT) for k in (1, -1, 2)]],
        mass=False, center=False,
    ),
    "mirrored body about its normal": lambda: hung([("torsional", Z)], **mirrored(Z)),
    "mirrored body about an oblique normal": lambda: hung([("torsional", OBLIQUE)], **mirrored(OBLIQUE)),
    "round body about its axis": lambda: hung([("torsional", Y)], **round_about(Y)),
    "round body about its oblique axis": lambda: hung([("bifilar", OBLIQUE)], **round_about(OBLIQUE)),
    "round body across its oblique axis": lambda: hung(
        [("bifilar", np.cross(OBLIQUE, X))], **round_about(OBLIQUE)
    ),
    "poor stopwatch": lambda: hung(
        [("torsional", one) for one in SIX], sigmas=[SHORT, SHORT, 0.4, *[SHORT] * 3]
    ),
    "torsional about six axes": lambda: hung([("torsional", one) for one in SIX]),
}  # fmt: skip

CASES = TUMBLES | WRISTS | PENDULUMS
DETERMINED = ("tumble with a rotor", "wrist that turns about all axes", "torsional about six axes")
SCALE_ALONE = ("tumble", "symmetric body that precesses")


def named(words: str, told: Told) -> Floats | None:
    """The direction that words name, in units of the sizes; None for a combination."""
    found = np.zeros(len(told.parameters))
    if match := re.fullmatch(r"the moment about (?:([xyz])|\((.+), (.+), (.+)\))", words):
        axis = (
            np.eye(3)["xyz".index(match[1])]
            if match[1]
            else np.array([float(one) for one in match.groups()[1:]])
        )
        first = told.parameters.index("Ixx")
        found[first : first + 6] = elements(np.outer(axis, axis))
    elif match := re.fullmatch(r"the product of inertia ([xyz]{2})", words):
        found[told.parameters.index(f"I{match[1]}")] = 1.0
    elif match := re.fullmatch(r"the centre of mass along ([xyz])", words):
        found[told.parameters.index(f"c{match[1]}")] = 1.0
    else:
        return None
    return found / np.linalg.norm(found)


@pytest.mark.parametrize("case", CASES)
def test_what_is_named_is_what_is_open(case: str) -> None:
    told = CASES[case]()
    assert (len(told.directions) == 0) == (case in DETERMINED)
    assert (len(told.wanted) == 1 and told.directions[0].words == "the scale of the tensor") == (
        case in SCALE_ALONE
    )
    assert told.warned
    assert len(told.directions) == len(told.wanted)
    if case in DETERMINED:
        return
    reported = np.array([one.parameters for one in told.directions]) / told.sizes
    assert np.rad2deg(subspace_angles(reported.T, told.wanted.T)).max() < 1.0
    basis = np.linalg.qr(told.wanted.T)[0]
    for one, direction in zip(told.directions, reported, strict=True):
        assert one.remedy
        named_one = named(one.words, told)
        if named_one is not None and one.words.startswith("the centre"):
            # The tensor about the centre follows it, where that about the origin is known.
            known = np.linalg.qr(told.wanted[:, :4].T)[0]
            assert np.linalg.norm(known.T @ named_one[:4]) > 0.95, one.words
            continue
        if named_one is not None:
            # Parts below 15 % have no name.
            assert np.linalg.norm(basis.T @ named_one) > 0.95, one.words
        elif one.words != "the scale of the tensor":
            assert one.words.startswith("a combination of ")
        if told.inverse is not None:
            unit = direction / np.linalg.norm(direction)
            assert one.relative == pytest.approx(np.sqrt(unit @ told.inverse @ unit), rel=0.02)


def test_open_directions_have_short_names_of_their_own() -> None:
    words = [one.words for one in CASES["spin about the axis of the largest moment"]().directions]
    assert len(set(words)) == len(words)
    assert not any("combination" in one for one in words)
    assert {f"the product of inertia {pair}" for pair in ("xy", "xz", "yz")} < set(words)


def test_there_are_enough_cases() -> None:
    assert len(CASES) - len(DETERMINED) - len(SCALE_ALONE) >= 12
