"""A heavy symmetric top about a fixed point on its axis, in arbitrary precision.

The equations of motion are summed as Taylor series. What makes long times cheap is that the inclination
is periodic: over one period, found by Newton's method on the series, the attitude gains a turn about the
vertical and one about the axis, which are measured and repeated. No elliptic function is used.

With α = q_w + i q_z, β = q_x + i q_y and W = ω₁ + i ω₂ for a top whose axis is the third of the body, and
gravity against the third axis of space,

    α̇ = ½ (i ω₃ α − β W*)    β̇ = ½ (α W − i ω₃ β)    Ẇ = −i (1 − I_s/I_t) ω₃ W + 2 κ α*β,

κ = m g l/I_t, I_t about the pivot; ω₃ is constant.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from operator import itemgetter
from typing import Any

import mpmath
from mpmath import mp, mpc, mpf

__all__ = ["HeavyTop"]

State = tuple[mpc, mpc, mpc]


class HeavyTop:
    """The motion from a state ``(omega, attitude)`` on; floats are taken at their exact values."""

    def __init__(
        self,
        axial: float,
        transverse: float,
        mass_moment: float,
        omega: Sequence[float],
        attitude: Iterable[float],
        gravity: float,
        *,
        about_center: tuple[float, float] | None = None,
        digits: int = 60,
    ) -> None:
        """`transverse` is about the pivot; with ``about_center = (mass, length)`` about C."""
        self.digits = digits
        with mp.workdps(digits):
            I_t = mpf(transverse)
            if about_center is not None:
                I_t += mpf(about_center[0]) * mpf(about_center[1]) ** 2
            self.kappa = mpf(mass_moment) * mpf(gravity) / I_t
            x, y, z, w = (mpf(c) for c in attitude)
            norm = mpmath.sqrt(x * x + y * y + z * z + w * w)
            self.w3 = mpf(omega[2])
            self.drift = (1 - mpf(axial) / I_t) * self.w3
            self.start = mpc(w, z) / norm, mpc(x, y) / norm, mpc(omega[0], omega[1])
            self.order = int(digits * 1.16) + 4
            self.period: mpf | None = None
            self._pieces: list[tuple[mpf, list[list[mpc]]]] = []
            self.turns = mpc(1), mpc(1)

    def find_period(self) -> None:
        """The time after which the inclination repeats, and the factors that α and β then have gained."""
        with mp.workdps(self.digits):
            times: list[mpf] = []
            t, state = mpf(0), self.start
            while len(times) < 3 or t < times[2] + (times[2] - times[0]) / 7:
                series, step = self._series(state)
                self._pieces.append((t, series))
                now, later = self._rate(state), self._rate(_sum(series, step))
                if mpmath.sign(now) * mpmath.sign(later) < 0:

                    def rate(h: mpf, series: Any = series) -> mpf:
                        return self._rate(_sum(series, h))

                    times.append(t + _zero(rate, step))
                state, t = _sum(series, step), t + step
            self.period = times[2] - times[0]
            early, late = (self._found(self.period / 7 + turn) for turn in (mpf(0), self.period))
            self.turns = tuple(b / a for a, b in zip(early[:2], late[:2], strict=True))

    def _found(self, time: mpf) -> State:
        """A state on the way on which the period was found."""
        start, series = max((piece for piece in self._pieces if piece[0] <= time), key=itemgetter(0))
        return _sum(series, time - start)

    def at(self, t: float) -> tuple[list[mpf], list[mpf]]:
        """ω in the body and the quaternion (x, y, z, w)."""
        with mp.workdps(self.digits):
            time, factors = mpf(t), (mpc(1), mpc(1))
            if self.period is not None:
                count = int(mpmath.floor(time / self.period))
                factors = tuple(f**count for f in self.turns)
                alpha, beta, w = self._found(time - count * self.period)
            else:
                alpha, beta, w = self._advance(self.start, time)
            w *= factors[1] * mpmath.conj(factors[0])
            alpha, beta = alpha * factors[0], beta * factors[1]
            return [w.real, w.imag, self.w3], [beta.real, beta.imag, alpha.imag, alpha.real]

    def _advance(self, state: State, span: mpf) -> State:
        while span != 0:
            series, step = self._series(state)
            step = mpmath.sign(span) * min(step, abs(span))
            state, span = _sum(series, step), span - step
        return state

    @staticmethod
    def _rate(state: State) -> mpf:
        """The rate of the cosine of the inclination, Im(G* W)."""
        alpha, beta, w = state
        return (mpmath.conj(2j * mpmath.conj(alpha) * beta) * w).imag

    def _series(self, state: State) -> tuple[list[list[mpc]], mpf]:
        """Coefficients of the three, and a step for which the rest is negligible."""
        a, b, w = ([x] for x in state)
        a_, w_ = [mpmath.conj(state[0])], [mpmath.conj(state[2])]
        for n in range(self.order):

            def dot(x: list[mpc], y: list[mpc], n: int = n) -> mpc:
                return mpmath.fdot(x[: n + 1], y[n::-1])

            half = mpf(1) / (2 * (n + 1))
            next_a = (1j * self.w3 * a[n] - dot(b, w_)) * half
            next_b = (dot(a, w) - 1j * self.w3 * b[n]) * half
            next_w = (-1j * self.drift * w[n] + 2 * self.kappa * dot(a_, b)) * 2 * half
            a.append(next_a)
            b.append(next_b)
            w.append(next_w)
            a_.append(mpmath.conj(next_a))
            w_.append(mpmath.conj(next_w))
        rate = abs(w[0]) + abs(self.w3) + mpmath.sqrt(self.kappa)
        scales = mpf(1), mpf(1), rate
        radius = min(
            mpmath.root(
                scale / max(abs(row[-1]), abs(row[-2]), scale * mpf(10) ** (-4 * self.digits)), self.order
            )
            for row, scale in zip((a, b, w), scales, strict=True)
        )
        return [a, b, w], min(radius * mpmath.exp(-2), 1 / rate)


def _zero(function: Callable[[mpf], mpf], end: mpf) -> mpf:
    """The zero between 0 and `end` by false positions (Illinois), until rounding ends them."""
    far, near = mpf(0), end
    at_far, at_near = function(far), function(near)
    while True:
        place = (far * at_near - near * at_far) / (at_near - at_far)
        value = function(place)
        if value == 0 or abs(place - near) <= 8 * mp.eps * abs(end):
            return place
        if mpmath.sign(value) != mpmath.sign(at_near):
            far, at_far = near, at_near
        else:
            at_far /= 2
        near, at_near = place, value


def _sum(series: list[list[mpc]], h: mpf) -> State:
    values = []
    for row in series:
        total = mpc(0)
        for coefficient in reversed(row):
            total = total * h + coefficient
        values.append(total)
    return values[0], values[1], values[2]
