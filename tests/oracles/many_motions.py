"""Many motions at once by a Runge-Kutta method of order 8 at small steps, in plain NumPy.

The law of an attitude feedback changes where the scalar part w of its error passes through zero. Each row
keeps the side that its law is for over a step; where w passes through zero within the step, or dips below it
between two positive ends, the row steps to that place alone. The coefficients are those of SciPy's DOP853.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate._ivp import dop853_coefficients as table

__all__ = ["Motions"]

Floats = NDArray[np.float64]


def _cross(a: Floats, b: Floats) -> Floats:
    (x, y, z), (u, v, w) = a.T, b.T
    out = np.empty_like(a)
    out[:, 0], out[:, 1], out[:, 2] = y * w - z * v, z * u - x * w, x * v - y * u
    return out


def _product(p: Floats, q: Floats) -> Floats:
    """Of quaternions (x, y, z, w)."""
    (a, b, c, d), (x, y, z, w) = p.T, q.T
    out = np.empty_like(p)
    out[:, 0], out[:, 1] = d * x + a * w + b * z - c * y, d * y - a * z + b * w + c * x
    out[:, 2], out[:, 3] = d * z + a * y - b * x + c * w, d * w - a * x - b * y - c * z
    return out


def _apply(matrices: Floats, vectors: Floats) -> Floats:
    return np.asarray(np.einsum("nij,nj->ni", matrices, vectors))


@dataclass(frozen=True)
class Motions:
    """Bodies, and of each row one load of each kind, zero where there is none.

    Every load acts in one window of time, from ``windows[kind][:, 0]`` to ``windows[kind][:, 1]``.
    """

    inertia: Floats
    body_torque: Floats
    space_torque: Floats
    linear: Floats
    quadratic: Floats
    stiffness: Floats
    damping: Floats
    target: Floats
    windows: dict[str, Floats]

    @cached_property
    def _inverse(self) -> Floats:
        return np.asarray(np.linalg.inv(self.inertia), dtype=np.float64)

    def rows(self, which: NDArray[np.intp]) -> Motions:
        """Some of the rows."""
        parts = {field.name: getattr(self, field.name)[which] for field in fields(self)[:-1]}
        return Motions(**parts, windows={kind: window[which] for kind, window in self.windows.items()})

    def _at(self, t: Floats) -> Motions:
        """The loads that act at these times, those that do not as zeros."""

        def on(kind: str, numbers: Floats) -> Floats:
            window = self.windows[kind]
            acts = (window[:, 0] < t) & (t < window[:, 1])
            return numbers * acts.reshape(-1, *[1] * (numbers.ndim - 1))

        return replace(
            self,
            body_torque=on("body_torque", self.body_torque),
            space_torque=on("space_torque", self.space_torque),
            linear=on("linear", self.linear) + on("feedback", self.damping),
            quadratic=on("quadratic", self.quadratic),
            stiffness=on("feedback", self.stiffness),
        )

    def _rates(self, side: Floats, y: Floats) -> Floats:
        q, w = y[:, :4], y[:, 4:]
        vector, scalar = q[:, :3], q[:, 3:]
        twice = 2.0 * _cross(self.space_torque, vector)
        torque = self.body_torque + self.space_torque + scalar * twice + _cross(twice, vector)
        speed = np.sqrt((w * w).sum(1))[:, None]
        torque -= _apply(self.linear, w) + _apply(self.quadratic, w * speed)
        torque -= _apply(self.stiffness, _product(_conjugate(self.target), q)[:, :3] * side)
        torque -= _cross(w, _apply(self.inertia, w))
        out = np.empty_like(y)
        out[:, :3] = 0.5 * (scalar * w + _cross(vector, w))
        out[:, 3] = -0.5 * (vector * w).sum(1)
        out[:, 4:] = _apply(self._inverse, torque)
        return out

    def _step(self, side: Floats, y: Floats, h: Floats) -> Floats:
        slopes = np.empty((table.N_STAGES, *y.shape))
        for stage in range(table.N_STAGES):
            moved = np.tensordot(table.A[stage, :stage], slopes[:stage], 1)
            slopes[stage] = self._rates(side[:, None], y + h[:, None] * moved)
        y = y + h[:, None] * np.tensordot(table.B, slopes, 1)
        y[:, :4] /= np.sqrt((y[:, :4] ** 2).sum(1))[:, None]
        return y

    def _switch(self, y: Floats) -> tuple[Floats, Floats]:
        """The scalar part w of the error, and its rate."""
        error = _product(_conjugate(self.target), y[:, :4])
        return error[:, 3], -0.5 * np.einsum("ni,ni->n", error[:, :3], y[:, 4:])

    def run(self, y: Floats, start: Floats, end: Floats, step: float) -> Floats:
        """The states (x, y, z, w, ω) at the times ``end`` from ``y`` at the times ``start``."""
        y, t = y.copy(), start.copy()
        forward = np.where(end >= start, 1.0, -1.0)
        ends = np.concatenate([*self.windows.values(), end[:, None]], 1)
        stop = _next(ends, t, end, forward)
        side = np.where(self._switch(y)[0] < 0, -1.0, 1.0)
        for _ in range(100_000):
            busy = np.flatnonzero(t != end)
            if not busy.size:
                return y
            # As long as rates are near one, and shorter for what turns faster.
            longest = step / np.maximum(1.0, np.linalg.norm(y[busy, 4:], axis=1))
            h = np.minimum(longest, np.abs(stop[busy] - t[busy])) * forward[busy]
            middle = t[busy] + 0.5 * (stop[busy] - t[busy])
            arrives = np.abs(h) >= np.abs(stop[busy] - t[busy]) * (1 - 1e-12)
            new, length, flips = self.rows(busy)._at(middle)._land(side[busy], y[busy], h)
            y[busy] = new
            arrives &= ~flips
            t[busy] = np.where(arrives, stop[busy], t[busy] + length)
            side[busy[flips]] *= -1.0
            stop = _next(ends, t, end, forward)
        raise RuntimeError(f"the reference does not end: {busy}")

    def _land(self, side: Floats, y: Floats, h: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """A step of each row: its state and length, cut where w leaves its side."""
        new = self._step(side, y, h)
        sign = np.sign(h)
        (value, rate), (value_end, rate_end) = self._switch(y), self._switch(new)
        value, value_end = value * side, value_end * side
        rate, rate_end = rate * side * sign, rate_end * side * sign
        # A row just past its flip begins on the other side, by rounding.
        beyond = (value_end < 0) & ((value > 0) | (rate_end < 0))
        dips = ~beyond & (rate < 0) & (rate_end > 0) & (value < -rate * np.abs(h))
        high = h.copy()
        if dips.any():
            which = np.flatnonzero(dips)
            some = self.rows(which)
            bottom = some._zero(side[which], y[which], np.stack([0 * h[which], h[which]]), 1)
            state = some._step(side[which], y[which], bottom)
            below = some._switch(state)[0] * side[which] < 0
            high[which[below]] = bottom[below]
            beyond[which[below]] = True
        if beyond.any():
            which = np.flatnonzero(beyond)
            some = self.rows(which)
            bracket = np.stack([0 * h[which], high[which]])
            # Those that begin on the other side, by rounding, first rise to this one, if they do.
            late = np.flatnonzero(value[which] <= 0)
            if late.size:
                these = which[late]
                top = self.rows(these)._zero(side[these], y[these], bracket[:, late], 1)
                state = self.rows(these)._step(side[these], y[these], top)
                rises = (self.rows(these)._switch(state)[0] * side[these] > 0) & (rate[these] > 0)
                bracket[0, late] = np.where(rises, top, 0.0)
                bracket[1, late] = np.where(rises, bracket[1, late], 0.0)
            h = h.copy()
            h[which] = some._zero(side[which], y[which], bracket, 0)
            new[which] = some._step(side[which], y[which], h[which])
        return new, h, beyond

    def _zero(self, side: Floats, y: Floats, bracket: Floats, derivative: int) -> Floats:
        """The length of step after which w, or its rate, is zero, by secants in a bracket (Illinois)."""

        def value(h: Floats) -> Floats:
            return self._switch(self._step(side, y, h))[derivative] * side

        (a, b), (f, g) = bracket, (value(bracket[0]), value(bracket[1]))
        for _ in range(11):
            with np.errstate(invalid="ignore", divide="ignore"):
                x = np.where(g == f, b, b - g * (b - a) / (g - f))
            at = value(x)
            crosses = at * g < 0
            a, f = np.where(crosses, b, a), np.where(crosses, g, 0.5 * f)
            b, g = x, at
        return np.asarray(b)


def _conjugate(q: Floats) -> Floats:
    return np.asarray(q * np.array([-1.0, -1.0, -1.0, 1.0]))


def _next(ends: Floats, t: Floats, end: Floats, forward: Floats) -> Floats:
    """The next end of a window, or the end of the run."""
    ahead = (ends - t[:, None]) * forward[:, None]
    within = (ahead > 0) & ((end[:, None] - ends) * forward[:, None] >= 0)
    nearest = np.where(within, ahead, np.inf).argmin(1)
    found = within.any(1)
    return np.where(found, ends[np.arange(len(t)), nearest], end)
