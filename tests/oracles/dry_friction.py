"""A body and wheels in bearings with dry friction, by SciPy, from one stop or slip to the next."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

from oracles.wheels import turning

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Model"]


class Crossing:
    """A function whose fall through zero ends a run of SciPy."""

    terminal, direction = True, -1

    def __init__(self, function: Callable[[float, np.ndarray], float]) -> None:
        self.function = function

    def __call__(self, t: float, y: np.ndarray) -> float:
        """Evaluate it."""
        return self.function(t, y)


class Model:
    """Body and wheels as one system with a mass matrix; a wheel at rest is a row of it less.

    The state is (q, ω, Ω); `push` gives the torque on the body and those of the motors.
    """

    def __init__(
        self,
        tensor: np.ndarray,
        axes: np.ndarray,
        inertia: np.ndarray,
        most: np.ndarray,
        push: Callable[[float, np.ndarray], tuple[np.ndarray, np.ndarray]],
    ) -> None:
        """Keep the numbers and the mass matrix of body and wheels."""
        self.tensor, self.axes, self.inertia, self.most, self.push = tensor, axes, inertia, most, push
        spun = axes * inertia[:, None]
        self.mass = np.block([[tensor, spun.T], [spun, np.diag(inertia)]])

    def accelerations(self, t: float, y: np.ndarray, turns: np.ndarray) -> np.ndarray:
        """Give (ω̇, Ω̇) of wheels that turn these ways; zero is at rest."""
        w, speed = y[4:7], y[7:]
        outer, motors = self.push(t, y)
        spin = self.tensor @ w + (self.inertia * speed) @ self.axes
        (a, b, c), (u, v, x) = w, spin
        turning = [b * x - c * v, c * u - a * x, a * v - b * u]  # ω×L; np.cross takes as long as all the rest
        force = np.concatenate([outer - turning, motors - self.most * turns])
        free = np.concatenate([[True] * 3, turns != 0])
        found = np.zeros(len(force))
        found[free] = np.linalg.solve(self.mass[np.ix_(free, free)], force[free])
        return found

    def held(self, t: float, y: np.ndarray, turns: np.ndarray) -> np.ndarray:
        """Give the torques that keep wheels at rest, of the bearings alone."""
        needed: np.ndarray = (self.mass @ self.accelerations(t, y, turns))[3:]
        found: np.ndarray = needed - self.push(t, y)[1]
        return found

    def rates(self, t: float, y: np.ndarray, turns: np.ndarray) -> np.ndarray:
        """Give the rates of the state."""
        return np.concatenate([turning(y[:4], y[4:7]), self.accelerations(t, y, turns)])

    def settled(self, t: float, y: np.ndarray, turns: np.ndarray) -> np.ndarray:
        """Let wheels at rest slip that are not held: that beyond its most by the largest share first."""
        turns = turns.copy()
        while True:
            beyond = np.where(turns == 0, np.abs(self.held(t, y, turns)) / self.most, 0.0)
            worst = int(np.argmax(beyond))
            if beyond[worst] <= 1 + 1e-9:
                return turns
            turns[worst] = -np.sign(self.held(t, y, turns)[worst])

    def run(self, y: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, list[float]]:
        """Go through; the states at the times, and when a wheel stopped or slipped."""
        turns = self.settled(times[0], y, np.sign(y[7:]))
        states, changes = [y], []
        for low, high in itertools.pairwise(times):
            t = low
            while t < high:
                events = [Crossing(self._event(k, turns)) for k in range(len(self.axes))]
                run = solve_ivp(
                    lambda t, y, turns=turns: self.rates(t, y, turns), (t, high), y, "DOP853",
                    events=events, rtol=1e-13, atol=1e-14, max_step=0.05,
                )  # fmt: skip
                t, y = run.t[-1], run.y[:, -1]
                if run.status == 1:
                    changes.append(t)
                    which = next(k for k, found in enumerate(run.t_events) if len(found))
                    turns = turns.copy()
                    if turns[which] == 0:
                        turns[which] = -np.sign(self.held(t, y, turns)[which])
                    else:
                        turns[which] = 0
                        y = y.copy()
                        y[7 + which] = 0.0
                    turns = self.settled(t, y, turns)
            states.append(y)
        return np.array(states), changes

    def _event(self, k: int, turns: np.ndarray) -> Callable[[float, np.ndarray], float]:
        if turns[k] == 0:
            return lambda t, y: float(self.most[k] * (1 + 1e-9) - abs(self.held(t, y, turns)[k]))
        # Just after a slip the rate is a rounding away from zero.
        return lambda _, y: float(y[7 + k] * turns[k] + 1e-13)
