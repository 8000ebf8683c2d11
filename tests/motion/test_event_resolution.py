"""All passages of smooth functions are found, however fast they are, or the run says that they are not."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from polhode import Event, RigidBody, loads
from polhode.errors import IntegrationError

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
BALL = RigidBody(1.0, np.eye(3))
METHODS = ("exact", "taylor", "dop853", "radau", "splitting")
STILL, TURNING = (1e-9, 2e-9, 1e-9), (0.3, 0.4, 1.1)
MOST = 2**24


@dataclass
class Wave:
    """Smooth functions of the phase ``rate t + phase`` that are zero where its sine is `level`."""

    cycles: float
    phase: float
    level: float
    shape: int
    span: float
    start: float

    def function(self) -> Callable[..., float]:
        rate, phase, level, start = math.tau * self.cycles / self.span, self.phase, self.level, self.start
        sine, cosine, exponential = math.sin, math.cos, math.exp
        shapes: list[Callable[..., float]] = [
            lambda t, *_: sine(rate * (t - start) + phase) - level,
            lambda t, *_: exponential(sine(rate * (t - start) + phase)) - exponential(level),
            lambda t, *_: (
                (sine(rate * (t - start) + phase) - level) * (2 + cosine(0.37 * rate * (t - start)))
            ),
        ]
        return shapes[self.shape]

    def times(self) -> Any:
        """The zeros within the run, in order."""
        rate, last = math.tau * self.cycles / self.span, self.phase + math.tau * self.cycles
        found: list[float] = []
        for first in (math.asin(self.level), math.pi - math.asin(self.level)):
            turns = np.arange(
                math.ceil((self.phase - first) / math.tau), math.floor((last - first) / math.tau) + 1
            )
            found.extend((first + math.tau * turns - self.phase) / rate)
        return self.start + np.sort(found)


def waves(count: int, decades: float, seed: int) -> list[Wave]:
    rng = np.random.default_rng(seed)
    return [
        Wave(
            cycles=10.0 ** rng.uniform(-3, decades),
            phase=rng.uniform(0, math.tau),
            level=rng.choice([0.0, rng.uniform(-0.95, 0.95)]),
            shape=int(rng.integers(3)),
            span=10.0 ** rng.uniform(-1, 4),
            start=rng.choice([0.0, rng.uniform(-10, 10)]),
        )
        for _ in range(count)
    ]


def check(wave: Wave, method: Any, omega: Any) -> bool:
    """Say whether all zeros are found; False where the run says that they are not."""
    turning = np.asarray(omega) * (1.0 if omega is STILL else 20.0 / wave.span)
    t = [wave.start, wave.start + wave.span]
    options: dict[str, Any] = {"method": method, "rtol": 1e-8, "on_failure": "keep"}
    run = BODY.simulate(t, turning, events=wave.function(), **options)
    if run.failures:
        assert "event 0 changes too fast" in str(run.failures[0])
        return False
    want = wave.times()
    assert len(run.events.t) == len(want), (wave, method)
    room = 1e-7 * wave.span / wave.cycles + 1e-14 * (abs(wave.start) + wave.span)
    assert not len(want) or np.abs(run.events.t - want).max() < room, (wave, method)
    return True


@pytest.mark.parametrize("omega", [STILL, TURNING], ids=["still", "turning"])
@pytest.mark.parametrize("method", METHODS)
def test_waves_faster_than_the_body(method: Any, omega: Any) -> None:
    assert all(check(wave, method, omega) for wave in waves(12, 2.3, 5))


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("method", METHODS)
def test_waves_up_to_a_hundred_thousand_cycles(method: Any) -> None:
    found = [check(wave, method, (STILL, TURNING)[k % 2]) for k, wave in enumerate(waves(200, 5.0, 11))]
    assert sum(found) >= 0.98 * len(found)


def test_a_satellite_that_hardly_turns_and_a_whistle() -> None:
    day, still = 86400.0, (1e-9, 0, 0)
    shadow = BODY.simulate(
        [0, 30 * day], still, events=lambda t, *_: math.cos(math.tau * t / 5400.0) - 0.3
    ).events.t
    assert len(shadow) == 960
    assert np.diff(shadow)[::2] == pytest.approx(5400.0 * (1 - math.acos(0.3) / math.pi), rel=1e-6)
    whistle = BODY.simulate([0, 1], still, events=lambda t, *_: math.sin(math.tau * 200.5 * t + 0.3)).events.t
    assert np.abs(whistle - (np.arange(1, 402) * np.pi - 0.3) / (math.tau * 200.5)).max() < 1e-12


@pytest.mark.parametrize("method", METHODS)
def test_a_function_of_the_attitude_and_stacks(method: Any) -> None:
    """Of a ball that turns about z: the sine of forty-one times its angle."""

    def fast(_t: float, _omega: Any, q: Any, *_: Any) -> float:
        return math.sin(41.0 * 2.0 * math.atan2(q[2], q[3]))

    rates = np.array([0.5, 1.0])
    run = BALL.simulate([0.1, 9.1], rates[:, None] * (0, 0, 1), events=fast, method=method, rtol=1e-12)
    for row, rate in enumerate(rates):
        want = 0.1 + np.arange(1, 9.0 * rate * 41 / np.pi) * np.pi / (41 * rate)
        found = run.events.t[run.events.row == row]
        assert len(found) == len(want)
        assert np.abs(found - want).max() < 1e-7


def test_a_chirp_a_burst_and_a_wheel_s_limit() -> None:
    chirp = BODY.simulate([0, 10], STILL, events=lambda t, *_: math.sin(30 * t * t)).events.t
    assert np.abs(chirp - np.sqrt(np.pi * np.arange(1, 955) / 30)).max() < 1e-10
    burst = BODY.simulate([0, 10], STILL, events=lambda t, *_: math.exp(-(((t - 3.3) / 0.1) ** 2)) - 0.5)
    assert burst.events.t == pytest.approx([3.3 - 0.1 * math.log(2) ** 0.5, 3.3 + 0.1 * math.log(2) ** 0.5])


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("method", ["exact", "taylor", "dop853"])
def test_what_is_not_followed_is_an_error(method: Any) -> None:
    """Rounding errors about zero: no part of a step resolves them. The other bodies of a stack go on."""
    calls = [0]

    def noise(t: float, omega: Any, *_: Any) -> float:
        calls[0] += omega[2] > 0.7
        return math.sin(1e13 * t * t) if omega[2] > 0.7 else omega[2]

    rates = np.array([0.5, 1.0])[:, None] * (0, 0, 1.0)
    run = BALL.simulate([0, 10], rates, events=noise, method=method, on_failure="keep")
    assert run.status.tolist() == ["complete", "failed"]
    # Parts that were halved 24 times count as 4096 evaluations each: noise ends the run before so many calls.
    assert MOST / 4096 < calls[0] < MOST
    (failure,) = run.failures
    assert isinstance(failure, IntegrationError)
    assert f"events: event 0 changes too fast to find all its zeros: {MOST} evaluations in parts" in str(
        failure
    )
    assert "go on from its end with resume" in str(failure)


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_two_hundred_thousand_cycles() -> None:
    run = BODY.simulate([0, 1], STILL, events=lambda t, *_: math.sin(math.tau * 2e5 * t + 0.1))
    assert len(run.events.t) == 400_000


def test_a_terminal_event_ends_the_search() -> None:
    """No function is asked beyond where another one has ended the run, but within the part of the step."""
    calls = [0]

    def fast(t: float, *_: Any) -> float:
        calls[0] += 1
        return math.sin(1e4 * t + 0.1)

    run = BODY.simulate([0, 100], STILL, events=Event(fast, terminal=2))
    assert run.status == "event"
    assert run.events.t == pytest.approx([(math.pi - 0.1) / 1e4, (2 * math.pi - 0.1) / 1e4])
    assert calls[0] < 2000


@pytest.mark.parametrize("method", METHODS)
def test_slow_functions_cost_little(method: Any) -> None:
    """A zero of ω takes a few looks in each step, and ten to be located."""
    calls = [0]

    def component(_t: float, omega: Any, *_: Any) -> float:
        calls[0] += 1
        return float(omega[0])

    run = BODY.simulate([0, 200], (0.3, 0.2, 1.1), events=component, method=method)
    assert calls[0] < 12 * max(int(run.steps), 200 * 1.2 / 1.2) + 16 * len(run.events.t)


def test_jumps_and_corners_are_found_to_the_last_digit() -> None:
    for function, want in (
        (lambda t, *_: math.copysign(1.0, t - 1.7), [1.7]),
        (lambda t, *_: abs(t - 5.3) - 0.25, [5.05, 5.55]),
        (lambda t, *_: math.floor(t / 3) - 1.5, [6.0]),
    ):
        for omega in (STILL, TURNING):
            found = BODY.simulate([0, 10], omega, events=function, load=loads.damping(1e-3)).events.t
            assert found == pytest.approx(want, rel=1e-15)
