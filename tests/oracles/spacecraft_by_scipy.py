"""A scenario of :mod:`oracles.basilisk_scenarios` by SciPy: body and wheels as bodies that push each other.

Body and wheels are solved for together, from the matrix of all their accelerations. A run ends a piece at
each switch, at each sample of a controller, and where a wheel passes zero or comes to its largest rate.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from oracles.basilisk_scenarios import Scenario, attitude_law
from oracles.wheels import turned, turning

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Vector = NDArray[np.float64]

__all__ = ["by_scipy"]

NOTHING = np.zeros(3)


class _Model:
    """What acts during a piece of the run."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.tensor = np.array(scenario.inertia)
        self.center = np.array(scenario.center)
        wheels = scenario.wheels
        self.axes = np.reshape([wheel.axis for wheel in wheels], (-1, 3)).T
        self.inertias = np.array([wheel.inertia for wheel in wheels])
        n = len(wheels)
        self.matrix = np.zeros((3 + n, 3 + n))
        self.matrix[:3, :3] = self.tensor
        self.matrix[:3, 3:] = self.axes * self.inertias
        self.matrix[3:, :3] = (self.axes * self.inertias).T
        self.matrix[3:, 3:] = np.diag(self.inertias)
        self.asked, self.signs, self.stopped = NOTHING, np.zeros(n), np.zeros(n, bool)
        self.motors = np.zeros(n)

    def begin(self, t: float, y: Vector) -> None:
        """Read all tables and the controller, and see which wheels are at their limits."""
        scenario, wheels = self.scenario, self.scenario.wheels
        self.t = t
        omega, quaternion, rates = y[:3], y[3:7], y[13:]
        control = scenario.control
        if control and (t / control.period) % 1.0 == 0.0:
            target = Rotation.from_mrp(control.target)
            error = (target.inv() * Rotation.from_quat(quaternion)).as_mrp()
            momenta = self.inertias * (rates + omega @ self.axes)
            self.asked = attitude_law(scenario, omega, error, momenta.tolist())
        if not wheels:
            return
        asked = scenario.request.at(t) if scenario.request else self.asked
        motors = scenario.motors.at(t) if scenario.motors else -np.linalg.pinv(self.axes) @ asked
        most = np.array([np.inf if wheel.max_torque is None else wheel.max_torque for wheel in wheels])
        self.motors = np.clip(motors, -most, most)
        limits = np.array([np.inf if wheel.max_rate is None else wheel.max_rate for wheel in wheels])
        self.stopped = (np.abs(rates) >= limits * (1.0 - 1e-12)) & (self.motors * rates > 0.0)
        near = np.abs(rates) < 1e-9
        self.signs = np.where(near, np.sign(self.motors), np.sign(rates))

    def rates(self, _t: float, y: Vector) -> Vector:
        scenario = self.scenario
        omega, quaternion, place, rates = y[:3], y[3:7], y[7:10], y[13:]
        turn = turned(quaternion)
        force, torque = self.load(omega, turn, place)
        pull = NOTHING
        if scenario.mu:
            down = turn.T @ place
            distance = np.linalg.norm(place)
            torque = torque + 3.0 * scenario.mu / distance**5 * np.cross(down, self.tensor @ down)
            pull = -scenario.mu / distance**3 * place
        momentum = self.tensor @ omega + self.axes @ (self.inertias * rates)
        friction = np.array(
            [
                wheel.friction * rate + wheel.dry_friction * sign
                for wheel, rate, sign in zip(scenario.wheels, rates, self.signs, strict=True)
            ]
        )
        right = np.concatenate([torque - np.cross(omega, momentum), self.motors - friction])
        matrix = self.matrix
        if self.stopped.any():
            matrix, right = matrix.copy(), right.copy()
            for k in np.flatnonzero(self.stopped) + 3:
                matrix[k], right[k] = np.eye(len(matrix))[k], 0.0
        found = np.linalg.solve(matrix, right)
        return np.concatenate(
            [found[:3], turning(quaternion, omega), y[10:13], turn @ force / scenario.mass + pull, found[3:]]
        )

    def load(self, omega: Vector, turn: Vector, _place: Vector) -> tuple[Vector, Vector]:
        """Return force and torque about the centre of mass, in the body."""
        scenario, t = self.scenario, self.t
        force, torque = NOTHING, NOTHING
        for table, matrix in ((scenario.force, np.eye(3)), (scenario.force_in_space, turn.T)):
            if table:
                one = matrix @ table.at(t)
                force, torque = force + one, torque + np.cross(-self.center, one)
        if scenario.torque:
            torque = torque + scenario.torque.at(t)
        if scenario.control and not scenario.wheels:
            torque = torque + self.asked
        if scenario.coils:
            torque = torque + self.magnetic(omega, turn)
        if scenario.thrusters:
            jets = scenario.thrusters
            begun = np.floor(t / jets.period) * jets.period
            for place, along, size, pulse in zip(
                jets.positions, jets.directions, jets.forces, jets.pulses.at(begun), strict=True
            ):
                if pulse >= jets.min_on and t < begun + pulse:
                    one = size * np.array(along) / np.linalg.norm(along)
                    force, torque = force + one, torque + np.cross(np.array(place) - self.center, one)
        return force, torque

    def magnetic(self, omega: Vector, turn: Vector) -> Vector:
        coils = self.scenario.coils
        assert coils is not None
        field = turn.T @ coils.fields.at(self.t)
        if coils.dipoles:
            moments = np.array(coils.dipoles.at(self.t))
        else:
            moments = coils.gain * np.cross(omega, field)
            moments = moments + np.cross(field, -coils.damping * omega) / (field @ field)
        moments = np.clip(moments, -np.array(coils.limits), coils.limits)
        found: Vector = np.cross(moments @ np.array(coils.axes, float), field)
        return found


def _switches(scenario: Scenario) -> list[float]:
    times, end = set(scenario.times()), max(scenario.t)
    if scenario.control:
        times |= set(np.arange(0.0, end, scenario.control.period))
    if scenario.thrusters:
        jets = scenario.thrusters
        for start in np.arange(0.0, end, jets.period):
            times |= {start + pulse for pulse in jets.pulses.at(start)}
    return sorted(time for time in times if time <= end)


def _events(model: _Model) -> list[Any]:
    """Return what ends a piece: a wheel with dry friction at rest, a wheel at its limit."""
    found: list[Any] = []
    for k, wheel in enumerate(model.scenario.wheels):
        if wheel.dry_friction and abs(model.signs[k]) > 0.0:
            found.append(lambda _t, y, k=k, sign=model.signs[k]: -sign * y[13 + k] - 1e-12)
        if wheel.max_rate and not model.stopped[k]:
            found.append(lambda _t, y, k=k, most=wheel.max_rate: abs(y[13 + k]) - most)
    for event in found:
        event.terminal, event.direction = True, 1
    return found


def by_scipy(scenario: Scenario) -> NDArray[np.float64]:
    """Return ω, Rodrigues parameters, position and velocity of the centre, and rates of the wheels."""
    model = _Model(scenario)
    y = np.concatenate(
        [
            scenario.omega,
            Rotation.from_mrp(scenario.mrp).as_quat(),
            scenario.position,
            scenario.velocity,
            [wheel.rate for wheel in scenario.wheels],
        ]
    )
    # Attitudes and rates of a satellite are small beside its distance.
    large = max(float(np.linalg.norm(scenario.position)), 1.0)
    speed = max(float(np.linalg.norm(scenario.velocity)), 1.0)
    scale = np.concatenate([[1e-3] * 3, [1.0] * 4, [large] * 3, [speed] * 3, [1.0] * len(scenario.wheels)])
    found = []
    for t, end in pairwise(_switches(scenario)):
        now = t
        while now < end:
            model.begin(t, y)
            run = solve_ivp(
                model.rates, (now, end), y, "DOP853", rtol=1e-13, atol=1e-14 * scale, events=_events(model)
            )
            y, now = run.y[:, -1].copy(), float(run.t[-1])
            y[3:7] /= np.linalg.norm(y[3:7])
        if end in scenario.t:
            found.append([*y[:3], *Rotation.from_quat(y[3:7]).as_mrp(), *y[7:]])
    return np.array(found)
