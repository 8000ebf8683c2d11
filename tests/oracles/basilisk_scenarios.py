"""Scenarios of a spacecraft with actuators, as data: Basilisk and polhode both run them.

The tensor is about the centre of mass C and includes the wheels as if they were locked. Points are in the
body frame, position and velocity are those of C. All steps of Basilisk are powers of two, and everything that
switches does so at whole steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    Vector = NDArray[np.float64]

__all__ = ["SCENARIOS", "Coils", "Control", "Scenario", "Steps", "Thrusters", "Wheel", "attitude_law"]


@dataclass(frozen=True)
class Steps:
    """Rows, each of which is held from its time to the next one; the last one to the end."""

    times: Sequence[float]
    rows: Sequence[Sequence[float]]

    def at(self, t: float) -> list[float]:
        return list(self.rows[int(np.searchsorted(self.times, t, side="right")) - 1])

    def windows(self) -> list[tuple[Sequence[float], tuple[float, float]]]:
        ends = [*self.times[1:], np.inf]
        return [(row, (start, end)) for row, start, end in zip(self.rows, self.times, ends, strict=True)]


def held(*row: float) -> Steps:
    return Steps((0.0,), (row,))


@dataclass(frozen=True)
class Wheel:
    axis: Sequence[float]
    """Of unit length."""
    inertia: float
    rate: float = 0.0
    friction: float = 0.0
    dry_friction: float = 0.0
    max_torque: float | None = None
    max_rate: float | None = None


@dataclass(frozen=True)
class Control:
    """Feedback of attitude and rate, asked once a period; it acts by the wheels, or on the body without them.

    Of kind 1 is the one that adds the gyroscopic torque of body and wheels.
    """

    period: float
    K: float
    P: float
    target: Sequence[float] = (0.0, 0.0, 0.0)
    kind: int = 0


@dataclass(frozen=True)
class Coils:
    """Coils with dipoles at times; or of three along the axes of the body, by a law of control."""

    fields: Steps
    dipoles: Steps | None = None
    axes: Sequence[Sequence[float]] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    limits: Sequence[float] = (1e9, 1e9, 1e9)
    gain: float = 0.0
    """k of ``m = -k dB/dt``."""
    damping: float = 0.0
    """D of the torque ``-D ω``, of which the coils exert the part across the field."""

    @property
    def follows(self) -> bool:
        return self.dipoles is None


@dataclass(frozen=True)
class Thrusters:
    positions: Sequence[Sequence[float]]
    directions: Sequence[Sequence[float]]
    forces: Sequence[float]
    pulses: Steps
    """Times of firing; the times of the rows are whole periods."""
    period: float
    min_on: float = 0.0


@dataclass(frozen=True)
class Scenario:
    kind: str
    name: str
    inertia: Sequence[Sequence[float]]
    omega: Sequence[float]
    mass: float = 90.0
    center: Sequence[float] = (0.0, 0.0, 0.0)
    mrp: Sequence[float] = (0.0, 0.0, 0.0)
    position: Sequence[float] = (0.0, 0.0, 0.0)
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    t: Sequence[float] = (4.0, 10.0, 20.0)
    step: float = 2.0**-7
    wheels: tuple[Wheel, ...] = ()
    motors: Steps | None = None
    request: Steps | None = None
    """Torque on the body that the wheels share by the pseudo-inverse of their axes."""
    control: Control | None = None
    coils: Coils | None = None
    thrusters: Thrusters | None = None
    force: Steps | None = None
    """At the origin of the body frame, components in the body frame."""
    force_in_space: Steps | None = None
    torque: Steps | None = None
    mu: float = 0.0
    """Of the attractor, whose gravity gradient acts."""
    jumps: bool = False
    """Basilisk is late by a part of a step: its error is of first order in the step."""

    def times(self) -> list[float]:
        """Return the times of all rows and of all that changes, for a run in pieces."""
        found = {0.0, *self.t}
        tables = [self.motors, self.request, self.force, self.force_in_space, self.torque]
        if self.coils:
            tables += [self.coils.fields, self.coils.dipoles]
        if self.thrusters:
            found |= set(np.arange(0.0, max(self.t), self.thrusters.period))
        for table in tables:
            found |= set(table.times if table else ())
        return sorted(time for time in found if time <= max(self.t))

    def without_wheels(self) -> NDArray[np.float64]:
        """Return the tensor less the moments of the wheels about their axes."""
        return np.array(self.inertia) - sum(
            (wheel.inertia * np.outer(wheel.axis, wheel.axis) for wheel in self.wheels),
            start=np.zeros((3, 3)),
        )

    @property
    def first_order(self) -> bool:
        return self.jumps or self.thrusters is not None or (self.coils is not None and self.coils.follows)


def attitude_law(
    scenario: Scenario, omega: Vector, error: Vector, momenta: Sequence[float]
) -> NDArray[np.float64]:
    """Return the torque on the body that the control asks for.

    The error is in Rodrigues parameters, and a momentum that of a wheel about its axis, with the body's rate.
    """
    control = scenario.control
    assert control is not None
    torque = -control.K * error - control.P * omega
    if control.kind == 1:
        axes = np.reshape([wheel.axis for wheel in scenario.wheels], (-1, 3))
        torque = torque + np.cross(omega, scenario.without_wheels() @ omega + np.array(momenta) @ axes)
    return torque


def _unit(v: Any) -> tuple[float, ...]:
    return tuple(float(x) for x in np.array(v) / np.linalg.norm(v))


def _body(seed: int, **change: Any) -> Scenario:
    """Return a body with products of inertia, a centre off the origin and a random start."""
    random = np.random.default_rng(seed)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    inertia = turn @ np.diag(random.uniform((7, 8, 9), (8, 9, 11))) @ turn.T
    inertia = (inertia + inertia.T) / 2.0
    start: dict[str, Any] = {
        "inertia": inertia.tolist(),
        "omega": random.uniform(-0.1, 0.1, 3).tolist(),
        "mass": float(random.uniform(50, 150)),
        "center": random.uniform(-0.2, 0.2, 3).tolist(),
        "mrp": random.uniform(-0.4, 0.4, 3).tolist(),
        "velocity": random.uniform(-0.1, 0.1, 3).tolist(),
    }
    return Scenario(**(start | change))


def _wheels(seed: int, count: int, **same: Any) -> tuple[Wheel, ...]:
    random = np.random.default_rng(1000 + seed)
    return tuple(
        Wheel(
            _unit(random.normal(size=3)),
            float(random.uniform(0.01, 0.05)),
            float(random.uniform(30.0, 120.0) * random.choice((-1, 1))),
            **same,
        )
        for _ in range(count)
    )


def _rows(seed: int, times: Sequence[float], count: int, size: float) -> Steps:
    random = np.random.default_rng(2000 + seed)
    return Steps(times, random.uniform(-size, size, (len(times), count)).tolist())


PYRAMID = [_unit(axis) for axis in ((1, 0, 1), (0, 1, 1), (-1, 0, 1), (0, -1, 1))]
CROSS = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
EARTH = 3.986004415e14


def _pyramid(**same: Any) -> tuple[Wheel, ...]:
    return tuple(
        Wheel(axis, 0.03, rate, **same) for axis, rate in zip(PYRAMID, (40, -30, 20, 60), strict=True)
    )


def _motors() -> list[Scenario]:
    free = [
        _body(
            k,
            kind="wheels",
            name=f"{k} wheels, torques constant",
            wheels=_wheels(k, k),
            motors=_rows(k, (0.0,), k, 0.05),
        )
        for k in (1, 2, 3, 4)
    ]
    tables = [
        _body(
            10 + k,
            kind="wheels",
            name=f"{k} wheels, torques at times, clipped",
            wheels=_wheels(10 + k, k, max_torque=0.06),
            motors=_rows(10 + k, (0.0, 3.0, 7.5, 12.0), k, 0.12),
        )
        for k in (1, 2, 3, 4)
    ]
    viscous = [
        _body(
            20 + k,
            kind="friction",
            name=f"{k} wheels, viscous",
            wheels=_wheels(20 + k, k, friction=2e-4 * k),
            motors=_rows(20 + k, (0.0, 5.0), k, 0.04),
        )
        for k in (1, 2, 4)
    ]
    dry = [
        _body(
            30 + k,
            kind="friction",
            name=f"{k} wheels, dry and viscous",
            wheels=_wheels(30 + k, k, friction=1e-4, dry_friction=4e-3),
            motors=_rows(30 + k, (0.0, 5.0), k, 0.01),
        )
        for k in (1, 2, 3)
    ]
    # About a principal axis the rate is linear in time. It passes zero at the beginning of a step, in whose
    # first stage Basilisk's friction has the sign before.
    inertia, torque, dry_torque = 0.05, -0.04, 0.01
    share = 1.0 / inertia + 1.0 / (8.0 - inertia)
    crossing = Scenario(
        "friction",
        "1 wheel, dry, through zero",
        np.diag((6.0, 7.0, 8.0)).tolist(),
        (0.0, 0.0, 0.02),
        wheels=(
            Wheel((0, 0, 1), inertia, 8.0 * (-torque + dry_torque) * share + 1e-10, dry_friction=dry_torque),
        ),
        motors=held(torque),
        jumps=True,
    )
    return [*free, *tables, *viscous, *dry, crossing]


def _limits() -> list[Scenario]:
    """Wheels about a principal axis of a body that turns about it: they come to their limits after 8 s.

    Beyond its limit Basilisk's wheel has no torque, and keeps its rate where the body turns uniformly.
    """
    body = Scenario("limits", "", np.diag((6.0, 7.0, 8.0)).tolist(), (0.0, 0.0, 0.02), mrp=(0.1, -0.2, 0.3))
    inertia = 0.05
    share = 1.0 / inertia + 1.0 / (8.0 - inertia)

    def limited(name: str, start: float, torque: float, motors: Steps, **more: Any) -> Scenario:
        limit = abs(start + 8.0 * torque * share)
        wheel = Wheel((0, 0, 1), inertia, start, max_rate=limit, **more)
        return replace(body, name=name, wheels=(wheel,), motors=motors)

    return [
        limited("up", 10.0, 0.04, held(0.04)),
        limited("down, and back", -10.0, -0.05, Steps((0.0, 12.0, 15.0), ((-0.05,), (0.03,), (0.01,)))),
        limited("clipped", 20.0, 0.04, held(0.3), max_torque=0.04),
    ]


def _allocation() -> list[Scenario]:
    six = tuple(
        Wheel(_unit(axis), 0.02, 10.0 * k)
        for k, axis in enumerate((*CROSS, (1, 1, 0), (0, 1, -1), (1, -1, 1)))
    )
    cases = {
        "4 wheels, a pyramid": _pyramid(),
        "4 wheels, a pyramid, clipped": _pyramid(max_torque=0.05),
        "3 skew wheels": _wheels(41, 3),
        "6 wheels": six,
        "4 wheels, viscous": _pyramid(friction=3e-4),
    }
    return [
        _body(
            40 + k,
            kind="allocation",
            name=name,
            wheels=wheels,
            request=_rows(40 + k, (0.0, 4.0, 11.0), 3, 0.12),
        )
        for k, (name, wheels) in enumerate(cases.items())
    ]


def _feedback() -> list[Scenario]:
    cross = tuple(Wheel(axis, 0.03, rate) for axis, rate in zip(CROSS, (30, -20, 10), strict=True))
    cases: dict[str, tuple[tuple[Wheel, ...], Control]] = {
        "3 wheels": (cross, Control(0.5, 0.4, 2.0)),
        "4 wheels, to a target": (_pyramid(), Control(0.25, 0.5, 3.0, target=(0.2, -0.1, 0.3))),
        "4 wheels, gyroscopic": (_pyramid(), Control(0.5, 0.4, 2.5, kind=1)),
        "4 wheels, clipped": (_pyramid(max_torque=0.08), Control(0.5, 2.0, 5.0, kind=1)),
        "4 wheels, friction": (_pyramid(friction=2e-4, dry_friction=1e-3), Control(0.125, 0.4, 3.0)),
        "on the body": ((), Control(0.25, 0.5, 3.0, target=(-0.3, 0.1, 0.2), kind=1)),
    }
    return [
        _body(50 + k, kind="feedback", name=name, wheels=wheels, control=control)
        for k, (name, (wheels, control)) in enumerate(cases.items())
    ]


def _magnets() -> list[Scenario]:
    field = (1e-5, -3e-5, 2e-5)
    turning = Steps((0.0, 6.0, 13.0), ((1e-5, -3e-5, 2e-5), (-2e-5, 1e-5, 3e-5), (2e-5, 2e-5, -1e-5)))
    random = np.random.default_rng(60)
    skew = [_unit(v) for v in random.normal(size=(4, 3))]
    cases = {
        "3 coils": Coils(held(*field), held(900.0, -700.0, 500.0)),
        "3 coils, clipped": Coils(held(*field), held(5e3, -2e4, 1.25e3), limits=(4e3, 2.5e3, 1e4)),
        "dipoles at times": Coils(held(*field), _rows(62, (0.0, 5.0, 12.0), 3, 3e3), limits=(2e3, 2e3, 2e3)),
        "fields at times": Coils(turning, held(1500.0, -1000.0, 700.0)),
        "4 skew coils, clipped": Coils(
            turning, _rows(64, (0.0, 8.0), 4, 4e3), axes=skew, limits=(2e3, 1e3, 3e3, 2e3)
        ),
        "1 coil": Coils(held(*field), held(2000.0), axes=skew[:1], limits=(5e3,)),
        "B-dot": Coils(held(*field), gain=8e8),
        "B-dot, clipped": Coils(held(*field), gain=8e8, limits=(2e3, 1e3, 2e3)),
        "torque across the field": Coils(held(*field), damping=0.4),
        "torque across the field, clipped": Coils(held(*field), damping=0.8, limits=(900.0, 500.0, 700.0)),
    }
    return [
        _body(
            60 + k,
            kind="coils",
            name=name,
            coils=coils,
            t=(2.0, 4.0, 6.0) if coils.follows else (4.0, 10.0, 20.0),
        )
        for k, (name, coils) in enumerate(cases.items())
    ]


def _thrusters() -> list[Scenario]:
    four = Thrusters(
        [(1.0, 0.2, 0), (-1.0, 0.1, 0.3), (0, 1.0, -0.2), (0.1, -1.0, 0)],
        [(0, 1.0, 0.2), (0.1, 1.0, 0), (0, 0.3, 1.0), (0.2, 0, -1.0)],
        [0.2, 0.3, 0.25, 0.15],
        Steps((0.0, 4.0, 6.0), ((0.5, 1.0, 1.5, 0.0), (1.75, 0.25, 0.0, 0.5), (0.0, 1.25, 0.375, 1.0))),
        2.0,
    )
    one = Thrusters([(0.5, -0.3, 0.2)], [(0.2, 1.0, 0.1)], [0.4], Steps((0.0,), ((0.625,),)), 1.0)
    pair = replace(
        one,
        positions=[(0.6, 0, 0), (-0.6, 0, 0)],
        directions=[(0, 1, 0), (0, -1, 0)],
        forces=[0.3, 0.3],
        pulses=Steps((0.0, 3.0), ((0.25, 0.25), (0.75, 0.5))),
    )
    cases: dict[str, Thrusters] = {
        "1, a train of pulses": one,
        "2, a couple": pair,
        "4, a table": four,
        "4, the shortest pulses are left out": replace(four, min_on=0.5),
        "1, one pulse": replace(one, pulses=Steps((0.0, 1.0), ((0.875,), (0.0,)))),
        "2, the whole period": replace(
            pair, pulses=Steps((0.0, 2.0, 5.0), ((1.0, 0.0), (0.0, 1.0), (0.5, 0.25)))
        ),
    }
    return [
        _body(80 + k, kind="thrusters", name=name, thrusters=thrusters, t=(2.0, 5.0, 8.0))
        for k, (name, thrusters) in enumerate(cases.items())
    ]


def _orbit(radius: float, eccentricity: float, inclination: float) -> dict[str, Any]:
    """Return the state at the periapsis, at this distance."""
    speed = np.sqrt(EARTH * (1.0 + eccentricity) / radius)
    return {
        "mu": EARTH,
        "position": (radius, 0.0, 0.0),
        "velocity": (0.0, float(speed * np.cos(inclination)), float(speed * np.sin(inclination))),
        "step": 2.0**-1,
        "t": (400.0, 1600.0, 3000.0),
    }


def _gradients() -> list[Scenario]:
    rods = [np.diag((2.0, 90.0, 91.0)).tolist(), [[60.0, 4.0, -2.0], [4.0, 80.0, 3.0], [-2.0, 3.0, 30.0]]]
    cases: dict[str, tuple[dict[str, Any], int, float]] = {
        "a circle": (_orbit(7.0e6, 0.0, 0.0), 0, 1.1e-3),
        "a circle, inclined": (_orbit(6.9e6, 0.0, 0.9), 1, 2e-3),
        "an ellipse": (_orbit(7.2e6, 0.3, 0.4), 1, 1e-3),
        "an ellipse, long": (_orbit(6.8e6, 0.72, 1.1), 0, 2e-3),
        "a hyperbola": (_orbit(6.7e6, 1.2, 0.2), 1, 1e-3),
    }
    random = np.random.default_rng(90)
    return [
        _body(
            90 + k,
            kind="gravity gradient",
            name=name,
            inertia=rods[which],
            omega=(size * random.uniform(-1, 1, 3)).tolist(),
            center=(0.0, 0.0, 0.0),
            **orbit,
        )
        for k, (name, (orbit, which, size)) in enumerate(cases.items())
    ]


def _external() -> list[Scenario]:
    return [
        _body(100, kind="force and torque", name="torque constant", torque=held(0.05, -0.02, 0.03)),
        _body(
            101, kind="force and torque", name="torques at times", torque=_rows(101, (0.0, 2.0, 9.0), 3, 0.1)
        ),
        _body(102, kind="force and torque", name="force off the centre", force=held(0.2, -0.1, 0.4)),
        _body(
            103,
            kind="force and torque",
            name="all, at times",
            force=_rows(103, (0.0, 5.0), 3, 0.5),
            force_in_space=_rows(104, (0.0, 8.0), 3, 0.4),
            torque=_rows(105, (0.0, 11.0), 3, 0.1),
        ),
    ]


def _together() -> list[Scenario]:
    field = held(1e-5, -3e-5, 2e-5)
    coils = Coils(field, _rows(110, (0.0, 8.0), 3, 2e3), limits=(1.5e3, 1e3, 1e3))
    jets = _thrusters()[2].thrusters
    control = Control(0.5, 0.4, 2.5, kind=1)
    orbit = _orbit(6.9e6, 0.05, 0.7)
    return [
        _body(
            110,
            kind="together",
            name="wheels and coils",
            wheels=_wheels(110, 3),
            motors=_rows(110, (0.0, 6.0), 3, 0.05),
            coils=coils,
        ),
        _body(
            111,
            kind="together",
            name="controlled wheels and coils",
            wheels=_pyramid(friction=2e-4),
            control=control,
            coils=coils,
        ),
        _body(
            112,
            kind="together",
            name="wheels and thrusters",
            wheels=_wheels(112, 2),
            motors=_rows(112, (0.0, 4.0), 2, 0.05),
            thrusters=jets,
            t=(2.0, 5.0, 8.0),
        ),
        _body(
            113,
            kind="together",
            name="controlled wheels and thrusters",
            wheels=_pyramid(max_torque=0.1),
            control=control,
            thrusters=jets,
            t=(2.0, 5.0, 8.0),
        ),
        _body(
            114, kind="together", name="coils and thrusters", coils=coils, thrusters=jets, t=(2.0, 5.0, 8.0)
        ),
        _body(
            115,
            kind="together",
            name="wheels and external loads",
            wheels=_wheels(115, 4, friction=1e-4),
            motors=_rows(115, (0.0,), 4, 0.04),
            torque=held(0.02, 0.03, -0.01),
            force=held(0.1, 0.2, -0.3),
        ),
        _body(
            116,
            kind="together",
            name="gravity gradient, wheels and coils",
            wheels=_wheels(116, 3, friction=1e-5),
            motors=held(2e-3, -1e-3, 1e-3),
            coils=Coils(field, held(3.0, -2.0, 1.0)),
            **(
                orbit
                | {
                    "center": (0.0, 0.0, 0.0),
                    "omega": (1e-3, -5e-4, 2e-3),
                    "step": 2.0**-5,
                    "t": (100.0, 300.0),
                }
            ),
        ),
        _body(
            117,
            kind="together",
            name="gravity gradient and controlled wheels",
            wheels=_pyramid(),
            control=control,
            **(
                orbit
                | {
                    "center": (0.0, 0.0, 0.0),
                    "omega": (1e-2, -5e-3, 2e-2),
                    "step": 2.0**-6,
                    "t": (30.0, 100.0),
                }
            ),
        ),
    ]


def _validated() -> list[Scenario]:
    """Two in round numbers, whose results are rows of ``polhode validate``."""
    inertia = [[9.0, 0.4, -0.2], [0.4, 8.0, 0.3], [-0.2, 0.3, 10.0]]
    return [
        Scenario(
            "wheels",
            "of polhode validate",
            inertia,
            (0.05, -0.08, 0.1),
            wheels=_pyramid(friction=2e-4, max_torque=0.035),
            motors=Steps((0.0, 8.0), ((0.04, -0.02, 0.03, 0.01), (-0.03, 0.05, 0.0, 0.02))),
            t=(20.0,),
        ),
        Scenario(
            "gravity gradient",
            "of polhode validate",
            [[60.0, 4.0, -2.0], [4.0, 80.0, 3.0], [-2.0, 3.0, 30.0]],
            (1e-3, -5e-4, 2e-3),
            position=(7.2e6, 0.0, 0.0),
            velocity=(0.0, 8e3, 2e3),
            mu=EARTH,
            step=2.0**-1,
            t=(3000.0,),
        ),
    ]


_PARTS: tuple[Callable[[], list[Scenario]], ...] = (
    _motors,
    _limits,
    _allocation,
    _feedback,
    _magnets,
    _thrusters,
    _gradients,
    _external,
    _together,
    _validated,
)
SCENARIOS = [scenario for part in _PARTS for scenario in part()]
