"""Wheels in bearings with dry friction: they stop, rest and slip at times that are found."""

from __future__ import annotations

import functools
import operator
import re
from typing import TYPE_CHECKING, Literal

import numpy as np
import polhode
import pytest
from oracles.dry_friction import Model
from oracles.wheels import ATTITUDE, BODY, OMEGA, turned
from polhode import RigidBody, loads
from polhode.errors import InvalidInertiaError, PolhodeError
from polhode.motion.events import Event

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from polhode.loads import Load

Method = Literal["auto", "dop853", "radau"]
I3, J = 3.0, 0.5
PLAIN = RigidBody.from_principal(1.0, (1.0, 2.0, I3))
ALONG = (0.0, 0.0, 1.0)
BETWEEN = 1 / J + 1 / (I3 - J)  # of what the wheel gains and the casing loses


def speed(run: polhode.Trajectory, name: str = "wheel") -> np.ndarray:
    """Give Ω about the third axis."""
    return run.states[name][:, 0] / J - run.omega[:, 2]


def together(wheels: Iterable[Load]) -> Load:
    """Add loads."""
    return functools.reduce(operator.add, wheels)


METHODS = pytest.mark.parametrize("method", ["auto", "dop853", "radau"])


@METHODS
def test_a_wheel_runs_down_and_rests(method: Method) -> None:
    wheel = loads.wheel(ALONG, J, rate=10.0, dry_friction=0.25)
    stop = 10.0 / (0.25 * BETWEEN)
    t = np.array([0.0, 0.5 * stop, stop, stop + 1e-9, 3 * stop])
    run = PLAIN.simulate(t, omega=(0, 0, 0), load=wheel, method=method, rtol=1e-12)
    expected = [10.0, 5.0, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(speed(run), expected, atol=2e-13)
    np.testing.assert_allclose(run.omega[:, 2] * I3 + J * speed(run), 10.0 * J, rtol=1e-14)
    assert speed(run)[-1] == pytest.approx(0.0, abs=1e-15)


@METHODS
def test_a_wheel_is_dragged_along_until_it_slips(method: Method) -> None:
    # N = k t about the axis: held while J N/I ≤ c₀, and then dragged by c₀.
    k, most = 0.3, 0.2
    slip = most * I3 / (J * k)
    t = np.array([0.0, 0.5 * slip, slip, slip + 1e-6, 1.5 * slip, 2.5 * slip])
    push = loads.sampled([0.0, 1.0, 10.0, 20.0], [[0, 0, k * x] for x in (0.0, 1.0, 10.0, 20.0)])
    wheel = loads.wheel(ALONG, J, dry_friction=most)
    run = PLAIN.simulate(t, omega=(0, 0, 0.1), load=push + wheel, method=method, rtol=1e-12)
    before, after = np.minimum(t, slip), np.maximum(t - slip, 0.0)
    omega = 0.1 + k * before**2 / 2 / I3
    h = J * omega + most * after
    omega = omega + (k * slip * after + k * after**2 / 2 - most * after) / (I3 - J)
    np.testing.assert_allclose(run.omega[:, 2], omega, rtol=2e-12)
    np.testing.assert_allclose(run.states["wheel"][:, 0], h, rtol=2e-12)


@pytest.mark.parametrize(
    ("torque", "moves"), [(0.2, False), (0.25, False), (-0.25, False), (0.3, True), (-0.3, True)]
)
def test_a_motor_moves_the_wheel_only_beyond_the_friction(torque: float, moves: bool) -> None:
    wheel = loads.wheel(ALONG, J, torque=torque, dry_friction=0.25)
    run = PLAIN.simulate([0.0, 4.0], omega=(0, 0, 0.7), load=wheel)
    gain = np.sign(torque) * 0.05 * BETWEEN * 4.0 if moves else 0.0
    assert speed(run)[-1] == pytest.approx(gain, abs=1e-13)


@pytest.mark.parametrize(("more", "moves"), [(1e-14, False), (1e-12, True)])
def test_what_has_just_been_found_to_hold_holds(more: float, moves: bool) -> None:
    # By so much more than the friction, relative to it.
    wheel = loads.wheel(ALONG, J, torque=0.25 * (1 + more), dry_friction=0.25)
    run = PLAIN.simulate([0.0, 4e6], omega=(0, 0, 0), load=wheel)
    assert bool(speed(run)[-1] > 1e-7) is moves


def test_a_wheel_turns_about_without_rest_where_the_motor_is_strong() -> None:
    wheel = loads.wheel(ALONG, J, rate=2.0, torque=-0.5, dry_friction=0.25)
    stop = 2.0 / (0.75 * BETWEEN)
    run = PLAIN.simulate([0.0, stop, stop + 3.0], omega=(0, 0, 0), load=wheel, rtol=1e-13)
    np.testing.assert_allclose(speed(run), [2.0, 0.0, -0.25 * BETWEEN * 3.0], atol=1e-13)


@pytest.mark.parametrize(
    ("rate", "inertia", "most"),
    [(1e-150, J, 0.01), (1.0, 1e-170, 0.01), (1.0, J, 1e156), (1e-12, 1e-300, 1.0)],
)
def test_a_wheel_stops_at_once(rate: float, inertia: float, most: float) -> None:
    wheel = loads.wheel(ALONG, inertia, rate=rate, dry_friction=most)
    run = PLAIN.simulate([0.0, 5.0, 10.0], omega=(0, 0, 0.3), load=wheel)
    np.testing.assert_allclose(run.omega[1:, 2], 0.3 + inertia * rate / I3, rtol=1e-15)


@METHODS
@pytest.mark.parametrize("above", [1e-3, 1e-9])
def test_the_stop_is_an_event_where_it_is(method: Method, above: float) -> None:
    wheel = loads.wheel(ALONG, J, rate=10.0, dry_friction=0.25)
    slow = Event(lambda *state: state[-1]["wheel"][0] / J - state[1][2] - above)
    run = PLAIN.simulate([0.0, 40.0], omega=(0, 0, 0), load=wheel, events=[slow], method=method, rtol=1e-12)
    assert len(run.events.t) == 1
    assert run.events.t[0] == pytest.approx((10.0 - above) / (0.25 * BETWEEN), rel=1e-12)


def random_case(seed: int) -> tuple[polhode.Trajectory, np.ndarray, list[float]]:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 4))
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0][:count]
    inertia, most = rng.uniform(0.02, 0.2, count), rng.uniform(0.01, 0.2, count)
    start = rng.normal(size=count) * rng.choice([0.0, 1.0, 3.0], count)
    motors = rng.normal(size=count) * rng.choice([0.0, 0.1], count)
    outer = rng.normal(size=3) * rng.choice([0.0, 0.3])
    drag = rng.choice([0.0, 0.1])
    load = loads.constant_torque(outer, frame="space") + loads.damping(drag)
    for k in range(count):
        load = load + loads.wheel(axes[k], inertia[k], start[k], torque=motors[k], dry_friction=most[k])
    model = Model(
        BODY.inertia, axes, inertia, most, lambda _, y: (turned(y[:4]).T @ outer - drag * y[4:7], motors)
    )
    t = np.linspace(0.0, 12.0, 9)
    states, changes = model.run(np.concatenate([ATTITUDE, OMEGA, start]), t)
    run = BODY.simulate(t, OMEGA, ATTITUDE, load=load, rtol=1e-12)
    own = np.stack([run.states[name][:, 0] for name in run.states], axis=-1)
    found = np.concatenate([run.quaternion, run.omega, own / inertia - run.omega @ axes.T], axis=-1)
    sign = np.sign(np.sum(found[:, :4] * states[:, :4], axis=-1, keepdims=True))
    found[:, :4] *= sign
    return run, found - states, changes


@pytest.mark.parametrize("count", [10, pytest.param(100, marks=pytest.mark.long)])
def test_random_bodies_against_an_own_model(count: int) -> None:
    changes = []
    for seed in range(count):
        _, off, found = random_case(seed)
        assert np.abs(off).max() < 2e-8, seed  # the model slips 1e-9 late
        changes += found
    assert len(changes) > 1.5 * count  # they do stop and slip


def test_four_wheels_stop_at_once() -> None:
    # Alike about the axes of a body with three equal moments: by symmetry they stop together.
    axes = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)
    ball = RigidBody.from_principal(1.0, (2.0, 2.0, 2.0))
    load = together(loads.wheel(axis, 0.1, 5.0, dry_friction=0.02) for axis in axes)
    stop = 5.0 / (0.02 * (1 / 0.1))
    run = ball.simulate([0.0, 0.5 * stop, 2 * stop], omega=(0, 0, 0), load=load, rtol=1e-12)
    for values in run.states.values():
        np.testing.assert_allclose(values[:, 0], [0.5, 0.25, 0.0], atol=1e-13)


def test_momentum_is_kept_and_energy_goes_into_friction() -> None:
    rng = np.random.default_rng(5)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    load = together(
        loads.wheel(axis, 0.1, rate, dry_friction=0.03) for axis, rate in zip(axes, (5, -3, 2), strict=True)
    )
    t = np.linspace(0, 30, 3001)
    run = BODY.simulate(t, OMEGA, load=load, rtol=1e-13)
    spin = run.angular_momentum().spin
    assert np.abs(spin - spin[0]).max() < 1e-12 * np.linalg.norm(spin[0])
    energy = run.kinetic_energy().total
    assert np.diff(energy).max() < 1e-13 * energy[0]
    rates = [
        run.states[name][:, 0] / 0.1 - run.omega @ axis for name, axis in zip(run.states, axes, strict=True)
    ]
    power = -0.03 * np.abs(rates).sum(axis=0)
    work = np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(t))
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-5)  # of the trapezoidal rule
    assert min(abs(rates[k][-1]) for k in range(3)) < 1e-14


@pytest.mark.parametrize("seed", range(6))
def test_the_torque_outside_a_run_is_that_within(seed: int) -> None:
    run, _, _ = random_case(seed)
    at, step = 6, 1e-5
    state = {name: values[at] for name, values in run.states.items()}
    assert run.load is not None
    torque = run.load.torque(run.t[at], run.omega[at], run.quaternion[at], body=BODY, states=state)
    ahead = BODY.simulate(
        run.t[at] + np.array([0, step]),
        run.omega[at],
        run.quaternion[at],
        load=run.load,
        states=state,
        rtol=1e-13,
    )
    rate = (ahead.omega[1] - ahead.omega[0]) / step
    middle = 0.5 * (ahead.omega[1] + ahead.omega[0])
    # I ω̇ + ω × I ω = N with the wheels locked in I.
    expected = BODY.inertia @ rate + np.cross(middle, BODY.inertia @ middle)
    np.testing.assert_allclose(torque, expected, atol=2e-4)


def test_a_controller_with_dry_friction_stops_short() -> None:
    # The motor cannot move the wheel where it asks for less than the friction: the body stays off its target.
    control = loads.feedback(K=1.0, D=2.0)
    wheel = loads.wheel(ALONG, J, torque=control, dry_friction=0.05)
    run = PLAIN.simulate([0.0, 400.0], (0, 0, 0), (0, 0, np.sin(0.15), np.cos(0.15)), load=wheel)
    assert abs(speed(run)[-1]) < 1e-14
    assert 0.0 < abs(run.quaternion[-1, 2]) <= 0.05
    small = PLAIN.simulate([0.0, 400.0], (0, 0, 0), (0, 0, np.sin(0.04), np.cos(0.04)), load=wheel)
    np.testing.assert_array_equal(small.quaternion[-1], small.quaternion[0])  # it never moves


def test_a_stack_a_resumed_run_and_a_pickle_are_the_same() -> None:
    stack = loads.wheel(ALONG, J, rate=[1.0, 10.0], dry_friction=[0.25, 0.1])
    t = [0.0, 3.0, 8.0]
    both = PLAIN.simulate(t, (0.1, 0, 0.2), load=stack)
    for row, (rate, most) in enumerate([(1.0, 0.25), (10.0, 0.1)]):
        wheel = loads.wheel(ALONG, J, rate=rate, dry_friction=most)
        single = PLAIN.simulate(t, (0.1, 0, 0.2), load=wheel)
        np.testing.assert_array_equal(both.omega[row], single.omega)
        parts = PLAIN.simulate(t[:2], (0.1, 0, 0.2), load=wheel).resume(t[1:])
        np.testing.assert_allclose(parts.omega[-1], single.omega[-1], atol=1e-10)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: loads.wheel(ALONG, J, dry_friction=-1),
            PolhodeError,
            "dry_friction must be positive or zero, got -1",
        ),
        (lambda: loads.wheel(ALONG, J, dry_friction=np.inf), PolhodeError, "dry_friction must be finite"),
        (
            lambda: loads.wheel(ALONG, J, speed=1, dry_friction=1),
            TypeError,
            "dry_friction: not beside speed=",
        ),
        (
            lambda: PLAIN.simulate(
                [0, 1], OMEGA, load=loads.wheel(ALONG, J, dry_friction=1), method="taylor"
            ),
            PolhodeError,
            "no dry friction",
        ),
        (
            lambda: PLAIN.simulate([0, -1], OMEGA, load=loads.wheel(ALONG, J, dry_friction=1)),
            PolhodeError,
            "t must be ascending where a wheel has dry friction",
        ),
        (
            lambda: PLAIN.simulate([0, 1], OMEGA, load=loads.wheel(ALONG, 3, dry_friction=1)),
            InvalidInertiaError,
            "moments",
        ),
    ],
)
def test_what_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=re.escape(message)):
        make()


def test_without_dry_friction_bits_are_those_of_a_wheel_without_it() -> None:
    runs = [
        BODY.simulate([0, 5], OMEGA, load=loads.wheel(ALONG, J, 2.0, friction=0.1, dry_friction=none))
        for none in (None, 0.0)
    ]
    np.testing.assert_array_equal(runs[0].omega, runs[1].omega)


@pytest.mark.parametrize("friction", [[0.0, 0.02], [0.02, 0.0], [0.0, 0.0, 0.02]])
def test_in_a_stack_some_wheels_may_have_none(friction: list[float]) -> None:
    """The method is chosen for the wheel that asks most of it, wherever it stands."""
    t, omega = np.array([0.0, 3.0, 9.0, 30.0]), (0.2, 0.1, 1.0)
    together = BODY.simulate(
        t, omega, load=loads.wheel(ALONG, J, rate=1.0, dry_friction=friction), rtol=1e-12
    )
    for row, torque in enumerate(friction):
        alone = BODY.simulate(t, omega, load=loads.wheel(ALONG, J, rate=1.0, dry_friction=torque), rtol=1e-12)
        np.testing.assert_allclose(together.omega[row], alone.omega, atol=1e-10)
        np.testing.assert_allclose(together.states["wheel"][row], alone.states["wheel"], atol=1e-10)
    with pytest.raises(PolhodeError, match="no dry friction"):
        BODY.simulate(t, omega, load=loads.wheel(ALONG, J, rate=1.0, dry_friction=friction), method="taylor")


@METHODS
def test_the_stop_is_told(method: Method) -> None:
    """At Ω₀ over the friction times 1/J + 1/(I − J), with h = J ω of the locked body."""
    wheel = loads.wheel(ALONG, J, rate=10.0, dry_friction=0.25)
    events = [Event.stop(), Event.breakaway()]
    run = PLAIN.simulate([0.0, 40.0], (0, 0, 0), load=wheel, events=events, method=method, rtol=1e-12)
    assert run.events.event.tolist() == [0]
    assert run.events.t[0] == pytest.approx(10.0 / (0.25 * BETWEEN), rel=1e-13)
    assert run.events.states["wheel"][0, 0] == pytest.approx(J * 10.0 * J / I3, rel=1e-13)
    assert run.events.omega[0, 2] == pytest.approx(10.0 * J / I3, rel=1e-13)
    plain = PLAIN.simulate([0.0, 40.0], (0, 0, 0), load=wheel, method=method, rtol=1e-12)
    assert np.array_equal(run.omega, plain.omega)


def test_a_run_may_end_at_a_stop_or_a_slip() -> None:
    wheel = loads.wheel(
        ALONG, J, rate=2.0, torque=[0.0, -0.5], times=[0.0, 12.0], dry_friction=0.25, name="w"
    )
    stop = 2.0 / (0.25 * BETWEEN)
    t = [0.0, 1.0, stop + 1.0, 20.0]
    ended = PLAIN.simulate(t, (0, 0, 0), load=wheel, events=Event.stop("w", terminal=True), rtol=1e-12)
    assert ended.status == "event"
    assert np.isfinite(ended.omega[:2]).all()
    assert np.isnan(ended.omega[2:]).all()
    both = [Event.stop("w"), Event.breakaway("w", terminal=1)]
    ended = PLAIN.simulate(t, (0, 0, 0), load=wheel, events=both, rtol=1e-12)
    np.testing.assert_allclose(ended.events.t, [stop, 12.0], rtol=1e-12)
    assert ended.events.event.tolist() == [0, 1]
    assert ended.status == "event"
    assert np.isfinite(ended.omega[2]).all()
    # A motor that is stronger turns it on at once.
    through = loads.wheel(ALONG, J, rate=2.0, torque=-0.5, dry_friction=0.25)
    run = PLAIN.simulate(
        [0.0, 9.0], (0, 0, 0), load=through, events=[Event.stop(), Event.breakaway()], rtol=1e-12
    )
    np.testing.assert_allclose(run.events.t, [2.0 / (0.75 * BETWEEN)] * 2, rtol=1e-12)
    assert run.events.event.tolist() == [0, 1]


@pytest.mark.parametrize("seed", range(4))
def test_stops_and_slips_are_those_of_the_model(seed: int) -> None:
    """All of them, of several wheels, against SciPy from one to the next."""
    run, _, changes = random_case(seed)
    wheels = [name for name in run.states if name.startswith("wheel")]
    events = [make(name) for name in wheels for make in (Event.stop, Event.breakaway)]
    again = run.body.simulate(
        run.t, run.omega[0], run.quaternion[0], load=run.load, events=events, method="dop853", rtol=1e-12
    )
    found = again.events.t[again.events.t > run.t[0]]
    once = found[np.append(True, np.diff(found) > 1e-9)] if len(found) else found
    told = np.array(changes)
    told = told[np.append(True, np.diff(told) > 1e-9)] if len(told) else told
    np.testing.assert_allclose(once, told, atol=1e-7)


def test_saturation_is_told() -> None:
    """About one axis from rest at the target: the motor saturates while K sin(φ/2) is beyond its limit."""
    feedback = loads.feedback(K=1.0, D=0.0)
    wheel = loads.wheel(ALONG, J, torque=feedback, max_torque=0.3)
    less, speed_at_zero = I3 - J, 0.4
    run = PLAIN.simulate(
        [0.0, 30.0], (0, 0, speed_at_zero), load=wheel, events=[Event.limit()], rtol=1e-12, method="dop853"
    )
    # Up to sin(φ/2) = 0.3 the motion is that of a pendulum; beyond it the torque is constant.
    edge = 2 * np.arcsin(0.3)
    phi = 2 * np.arctan2(run.events.quaternion[:, 2], run.events.quaternion[:, 3])
    np.testing.assert_allclose(np.abs(phi), edge, rtol=1e-9)
    square = speed_at_zero**2 - 4 / less * (1 - np.cos(edge / 2))
    np.testing.assert_allclose(np.abs(run.events.omega[:, 2]), np.sqrt(square), rtol=1e-8)
    # Out and back under the constant torque.
    back = 2 * np.sqrt(square) * less / 0.3
    assert run.events.t[1] - run.events.t[0] == pytest.approx(back, rel=1e-8)
    only = [Event.limit(direction=1.0, terminal=2)]
    ended = PLAIN.simulate([0.0, 30.0], (0, 0, speed_at_zero), load=wheel, events=only, rtol=1e-12)
    np.testing.assert_allclose(ended.events.t, run.events.t[[0, 2]], rtol=1e-8)
    assert ended.status == "event"


def test_events_of_wheels_that_cannot_be() -> None:
    wheel = loads.wheel(ALONG, J, rate=2.0)

    def run(event: Event, load: Load = wheel) -> None:
        PLAIN.simulate([0.0, 1.0], (0, 0, 0), load=load, events=event)

    with pytest.raises(
        ValueError, match=r'Event\.stop asks for a wheel with dry friction, which "wheel" is not'
    ):
        run(Event.stop())
    with pytest.raises(ValueError, match=r"Event\.limit asks for a wheel with a motor with a limit"):
        run(Event.limit())
    words = r'Event\.breakaway asks for the wheel "w"; the load carries "wheel"'
    with pytest.raises(ValueError, match=words):
        run(Event.breakaway("w"))
    with pytest.raises(ValueError, match="the load carries nothing"):
        run(Event.breakaway("w"), loads.constant_torque((0, 0, 1)))
    with pytest.raises(TypeError, match="found by simulate"):
        Event.stop()(0.0, np.zeros(3), np.zeros(4), np.zeros(3), np.zeros(3))
