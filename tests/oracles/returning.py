"""Free bodies and heavy symmetric tops at any time, from one period of their reduced motion.

Taylor series follow the body until its reduced motion returns; the secant method on the last polynomial gives
the period T. What a period does to the attitude is then exact and the same every time:

* free body: L(T) = L(0) in the body, and q(nT + s) = q(0) Mⁿ U(s), where U is the motion from attitude 1
  and M = U(T);
* symmetric top: a turn a about the vertical and a turn b about the symmetry axis, q(nT + s) = aⁿ q(s) bⁿ.

Nothing here knows an elliptic function.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import mpmath
from mpmath import mp, mpf

from oracles.acting import Weight
from oracles.rotation import (
    Rotation,
    Vector,
    apply,
    conjugate,
    cross,
    exponential,
    inverse,
    power,
    turned,
)
from oracles.rotation import (
    times as product,
)
from oracles.taylor import State, Step, steps

__all__ = ["free_states", "top_states", "unit"]

DIGITS = 80
"""Working digits: ten for 1e6 rotations, twice the digits of the smallest offset from a steady spin."""


class Motion(NamedTuple):
    """Angular velocity in the body and the unit quaternion."""

    omega: Vector
    quaternion: Vector


def unit(quaternion: Any) -> Vector:
    """The quaternion over its length."""
    q = [mpf(x) for x in quaternion]
    return [x / mpmath.sqrt(mpmath.fdot(q, q)) for x in q]


def free_states(
    inertia: Any,
    omega: Any,
    attitude: Any,
    at: Sequence[Any],
    *,
    drift: Any = 0,
    settles: bool = False,
    digits: int = DIGITS,
) -> list[Motion]:
    """States of a free body. Unknown units; moments, rates and times are scaled by the caller to order one.

    Parameters
    ----------
    inertia : (3,) or (3, 3)
        Principal moments or tensor.
    drift : number
        What is taken out of the attitude's motion, over L: the inverse of a moment where that makes the
        rest slow.
    settles : bool
        The motion approaches a steady spin (the separatrix) and is that spin once the difference is below
        3/8 of the digits.
    """
    with mp.workdps(digits + 20):
        body = Rotation(inertia, digits, drift=drift)
        w0, q0 = [mpf(x) for x in omega], unit(attitude)
        momentum = turned(q0, apply(body.inertia, w0))
        first = body.begin(w0, [0, 0, 0, 1])
        rate = [body.real(x) for x in _slope(body, first)]
        if max(map(abs, rate[:3])) < mpf(10) ** (20 - digits):
            return [Motion(w0, product(q0, exponential([x * mpf(t) for x in w0]))) for t in at]

        def section(state: State) -> int:
            return sum((state[i] - first[i]) * slope[i] for i in range(3)) >> body.bits

        slope = _slope(body, first)
        tolerance = mpf(10) ** (-digits // 4) * max(map(abs, rate[:3]))
        orbit = _Orbit(body, first, at, section, lambda s: _near(body, s[:3], first[:3], tolerance), settles)
        cycle = [body.real(x) for x in orbit.last[3:7]]
        states = []
        for t in at:
            n, state = orbit.state(t)
            turn = product(power(unit(cycle), n), [body.real(x) for x in state[3:7]])
            steady = exponential([body.drift * mpf(t) * x for x in momentum])
            rates = [body.real(x) for x in body.rate_of(state)]
            states.append(Motion(rates, unit(product(steady, product(q0, turn)))))
        return states


def top_states(
    moments: Any,
    mass: Any,
    height: Any,
    omega: Any,
    attitude: Any,
    gravity: Any,
    at: Sequence[Any],
    *,
    settles: bool = False,
    digits: int = DIGITS,
) -> list[Motion]:
    """States of a symmetric top about z, its origin held and its centre of mass at (0, 0, height).

    The moments are those about the origin. With `settles` it rises to the upright position for ever, and is
    there once the difference is below 3/8 of the digits.
    """
    with mp.workdps(digits + 20):
        body = Rotation(moments, digits, terms=[Weight(mass, (0, 0, height), gravity)])
        q0 = unit(attitude)
        first = body.begin(omega, q0)
        here = _lean(body, first)
        slope = _lean_rates(body, first)
        tolerance = mpf(10) ** (-digits // 4) * max(abs(body.real(x)) for x in slope)
        if tolerance < mpf(10) ** (10 - digits):
            # A relative equilibrium: every moment is a return.
            ended = list(steps(body, first, body.fixed(1)))[-1]
            orbit = _Orbit.fixed(body, first, ended)
        else:

            def section(state: State) -> int:
                return (
                    sum((x - y) * z for x, y, z in zip(_lean(body, state), here, slope, strict=True))
                    >> body.bits
                )

            orbit = _Orbit(
                body, first, at, section, lambda s: _near(body, _lean(body, s), here, tolerance), settles
            )
        about_axis = _spin(body, first, orbit.last)
        last = unit([body.real(x) for x in orbit.last[3:7]])
        about_vertical = product(product(last, conjugate(about_axis)), conjugate(q0))
        if orbit.returned:
            _assert_axis(about_vertical, gravity, digits)
        states = []
        for t in at:
            n, state = orbit.state(t)
            spin = power(about_axis, n)
            q = product(product(power(about_vertical, n), [body.real(x) for x in state[3:7]]), spin)
            states.append(Motion(inverse(spin, [body.real(x) for x in body.rate_of(state)]), unit(q)))
        return states


class _Orbit:
    """The steps of one period; a state at any time is a number of returns and a state within the period."""

    def __init__(
        self,
        body: Rotation,
        first: State,
        at: Sequence[Any],
        section: Callable[[State], int],
        returned: Callable[[State], bool],
        settles: bool = False,
    ) -> None:
        self.body, self.steps, self.period = body, [], 0
        self.last, self.returned, self.settled = first, False, False
        before = 0
        for step in steps(body, first, body.fixed(max(map(mpf, at))) + 1):
            self.steps.append(step)
            after = section(step.at_fraction(step.reach))
            if before < 0 <= after:
                sigma = step.root(section, 0, step.reach)
                state = step.at_fraction(sigma)
                if returned(state):
                    self.period, self.last = step.start + body.scaled(step.h, sigma), state
                    self.returned = True
                    return
            if settles and max(map(abs, _slope(body, step.at_fraction(step.reach))[:3])) < self._calm:
                self.settled = True
                return
            before = after

    @property
    def _calm(self) -> int:
        """What counts as steady: 3/8 of the digits, before rounding grows into a departure again."""
        return 1 << 5 * self.body.bits // 8

    @classmethod
    def fixed(cls, body: Rotation, first: State, step: Step) -> _Orbit:
        """An orbit of which any time is a period."""
        made = cls.__new__(cls)
        made.body, made.steps = body, list(steps(body, first, step.end))
        made.period, made.last, made.returned, made.settled = (
            step.end,
            step.at_fraction(step.reach),
            True,
            False,
        )
        return made

    def state(self, t: Any) -> tuple[int, State]:
        """Returns before the time t, and the state at what is left of it."""
        n, rest = divmod(self.body.fixed(t), self.period) if self.returned else (0, self.body.fixed(t))
        end = self.steps[-1].end
        if self.settled and rest > end:
            return n, self._spinning(self.steps[-1].at_fraction(self.steps[-1].reach), rest - end)
        step = next(step for step in self.steps if rest <= step.end)
        return n, step.at(rest)

    def _spinning(self, state: State, time: int) -> State:
        """The state after steady turning for a time; what is left of the approach is taken for none."""
        body = self.body
        left = [0 if abs(L) < self._calm << 8 else L for L in state[:3]]
        relative = [
            w - body.scaled(body.fixed(body.drift), L) for w, L in zip(body.rate_of(left), left, strict=True)
        ]
        turn = exponential([body.real(x) * body.real(time) for x in relative])
        q = product([body.real(x) for x in state[3:7]], turn)
        return [*left, *(body.fixed(x) for x in q), *state[7:]]


def _slope(body: Rotation, state: State) -> list[int]:
    return body.rates([[x] for x in state], 0)


def _near(body: Rotation, a: Sequence[int], b: Sequence[int], tolerance: mpf) -> bool:
    return all(abs(body.real(x - y)) < tolerance for x, y in zip(a, b, strict=True))


def _lean(body: Rotation, state: State) -> tuple[int, int]:
    """The vertical's component along the axis, and its rate."""
    w, g = body.rate_of(state), state[7:10]
    return g[2], body.scaled(g[0], w[1]) - body.scaled(g[1], w[0])


def _lean_rates(body: Rotation, state: State) -> tuple[int, int]:
    rate = _slope(body, state)
    w, g = body.rate_of(state), state[7:10]
    still = [body._held[i] if not any(body.J[i]) else 0 for i in range(3)]
    dw = [x - y for x, y in zip(body.rate_of(rate), still, strict=True)]
    dg = rate[7:10]
    second = sum(body.scaled(a, b) for a, b in ((dg[0], w[1]), (g[0], dw[1]), (-dg[1], w[0]), (-g[1], dw[0])))
    return dg[2], second


def _spin(body: Rotation, first: State, last: State) -> Vector:
    """The turn about z by which the body at its return differs from the start."""
    pairs = [(first[7:9], last[7:9]), (body.rate_of(first)[:2], body.rate_of(last)[:2])]
    before, after = max(pairs, key=lambda pair: max(map(abs, pair[0])))
    (a, b), (c, d) = [[body.real(x) for x in v] for v in (before, after)]
    if not (a or b):
        return [mpf(0), mpf(0), mpf(0), mpf(1)]
    # The components turn backwards while the body turns forwards.
    return exponential([mpf(0), mpf(0), -mpmath.atan2(a * d - b * c, a * c + b * d)])


def _assert_axis(turn: Vector, axis: Any, digits: int) -> None:
    scale = mpmath.sqrt(mpmath.fdot([mpf(x) for x in axis], [mpf(x) for x in axis]))
    off = mpmath.sqrt(sum(x * x for x in cross(turn[:3], axis))) / scale
    if off > mpf(10) ** (-digits // 2):
        raise ArithmeticError(f"the return is no turn about the vertical: {mpmath.nstr(off, 5)}")
