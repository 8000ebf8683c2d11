"""When events happen, against closed forms with fifty digits, by every method that can serve the motion.

A crossing at t is as well known as its conditioning lets it: a relative error ε of the rates moves it by ε t,
one of the state by ε ‖∂g/∂y‖ ‖y‖/|dg/dt|. Times are held to a multiple of the sum of the two.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from mpmath import mp, mpf
from polhode import Event, RigidBody, loads, solids

TIGHTEST = 2.3e-15
BAR = 1e-13


class Crossings(NamedTuple):
    """A motion, a function, when it passes through zero, and the time in which it changes by its size."""

    run: dict[str, Any]
    body: RigidBody
    event: Callable[..., float]
    times: list[mpf]
    scale: float
    methods: tuple[str, ...]


BALL = RigidBody(1.0, np.eye(3))
EVERY = ("taylor", "dop853", "splitting", "radau")


def half_turns() -> Crossings:
    """Steady spin: the half turns."""
    rate = mpf(0.7)
    run = {"omega": (0.0, 0.0, 0.7)}
    times = [n * mp.pi / rate for n in range(1, 21)]
    return Crossings(run, BALL, lambda _t, _w, q, *_: 2 * q[2] * q[3], times, 1 / 0.7, ("exact", *EVERY))


def spun_up() -> Crossings:
    """A constant torque: ω₀ t + ½ α t² = n π."""
    rate, torque = mpf(0.3), mpf(0.05)
    run = {"omega": (0.0, 0.0, 0.3), "load": loads.constant_torque((0.0, 0.0, 0.05))}
    times = [(mp.sqrt(rate**2 + 2 * torque * n * mp.pi) - rate) / torque for n in range(1, 13)]
    return Crossings(run, BALL, lambda _t, _w, q, *_: 2 * q[2] * q[3], times, 1 / 0.3, EVERY)


def pendulum() -> Crossings:
    """A bob let go at 1 rad passes its lowest point: (n + ½) half periods 2K(sin ½)/√(g/l)."""
    start = (float(np.sin(0.5)), 0.0, 0.0, float(np.cos(0.5)))
    k2 = mpf(start[0]) ** 2 / (mpf(start[0]) ** 2 + mpf(start[3]) ** 2)
    half = 2 * mp.ellipk(k2) / mp.sqrt(mpf(9.81))
    bob = solids.sphere(radius=0.0, mass=1.0).translated((0, 0, -1))
    load = loads.uniform_gravity((0.0, 0.0, -9.81))
    run = {"omega": (0.0, 0.0, 0.0), "attitude": start, "load": load, "about": "origin"}
    times = [(n + mpf(1) / 2) * half for n in range(10)]
    return Crossings(run, bob, lambda _t, _w, q, *_: q[0], times, float(half) / 3, ("exact", *EVERY))


def flips() -> Crossings:
    """A free body: ω₂ = 0 every 2K/p."""
    moments, (w1, w3) = (1.0, 2.0, 2.5), (0.4, 1.1)
    i1, i2, i3 = map(mpf, moments)
    twice_energy = i1 * mpf(w1) ** 2 + i3 * mpf(w3) ** 2
    square = (i1 * mpf(w1)) ** 2 + (i3 * mpf(w3)) ** 2
    p = mp.sqrt((i3 - i2) * (square - twice_energy * i1) / (i1 * i2 * i3))
    m = (i2 - i1) * (twice_energy * i3 - square) / ((i3 - i2) * (square - twice_energy * i1))
    times = [n * 2 * mp.ellipk(m) / p for n in range(1, 11)]
    body = RigidBody.from_principal(1.0, moments)
    return Crossings({"omega": (w1, 0.0, w3)}, body, lambda _t, w, *_: w[1], times, 2.0, ("exact", *EVERY))


def fall() -> Crossings:
    """A body that turns while it is thrown: its height is h again and again zero."""
    g, h, v = mpf(9.81), mpf(5), mpf(13)
    load = loads.uniform_gravity((0.0, 0.0, -9.81))
    run = {"omega": (0.3, 0.4, 1.1), "load": load, "position": (0, 0, -5.0), "velocity": (0, 0, 13.0)}
    root = mp.sqrt(v * v - 2 * g * h)
    times = [(v - root) / g, (v + root) / g]
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    return Crossings(run, body, lambda _t, _w, _q, r, _v: r[2], times, 5.0 / float(root), EVERY)


with mp.workdps(50):
    MOTIONS = [make() for make in (half_turns, spun_up, pendulum, flips, fall)]
NAMES = ("half turns", "spun up", "pendulum", "flips", "fall")


@pytest.mark.parametrize("forward", [True, False], ids=["forward", "backward"])
@pytest.mark.parametrize(
    ("motion", "method"),
    [
        pytest.param(motion, method, id=f"{name}, {method}")
        for name, motion in zip(NAMES, MOTIONS, strict=True)
        for method in motion.methods
    ],
)
def test_times(motion: Crossings, method: Any, forward: bool) -> None:
    run = dict(motion.run)
    last = float(motion.times[-1]) * 1.01
    if not forward:
        # The same path, walked the other way.
        if "load" in run and "position" in run:
            run["velocity"] = tuple(-v for v in run["velocity"])
        run["omega"] = tuple(-w for w in run["omega"])
    t = [0.0, last if forward else -last]
    rtol = TIGHTEST if method != "radau" else 1e-12
    found = motion.body.simulate(t, events=Event(motion.event), method=method, rtol=rtol, **run)
    assert len(found.events.t) == len(motion.times)
    worst = max(
        abs(float(abs(mpf(float(t))) - want)) / (float(want) + motion.scale)
        for t, want in zip(found.events.t, motion.times, strict=True)
    )
    assert worst <= BAR, f"{worst:.1e}"
