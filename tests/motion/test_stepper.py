"""A motion step by step: the bits of a chain of `resume`, events and states kept, other loads on the way."""

from __future__ import annotations

import copy
import gc
import weakref
from itertools import pairwise
from typing import Any

import numpy as np
import polhode
import pytest
from polhode import Event, RigidBody, Trajectory, loads, orbits, solids
from polhode.errors import IntegrationError

BODY = RigidBody.from_principal(3.0, (1.0, 2.0, 2.5))
OMEGA = (0.3, 0.5, -0.2)
WHEEL = loads.wheel((0.0, 0.6, 0.8), inertia=0.5, rate=10.0, friction=0.02)
THREE: Any = sum(
    loads.wheel(axis, inertia=0.05, rate=3.0, torque=0.01, name=name)
    for axis, name in zip(np.eye(3), "xyz", strict=True)
)
CUTS = [0.0, 1.0, 1.75, 2.5, 2.8125, 5.0]  # their differences are exact


def sampled(period: float = 0.7) -> loads.Load:
    """Return a controller whose torque is held between updates, which count themselves."""

    def update(_t: float, omega: Any, _q: Any, _r: Any, _v: Any, states: Any) -> tuple[float, float]:
        return states["law"][0] + 1.0, -0.4 * omega[1]

    def wrench(_t: float, _w: Any, _q: Any, _r: Any, _v: Any, states: Any) -> Any:
        return (0.0, 0.0, 0.0), (0.0, states["law"][1], 0.05)

    return loads.with_states(None, (0.0, 0.0), update=update, period=period, wrench=wrench, name="law")


CASES: dict[str, dict[str, Any]] = {
    "nothing": {},
    "three wheels": {"load": THREE},
    "wheels and slug": {"load": WHEEL + loads.slug(inertia=0.05, damping=0.02)},
    "dry friction": {"load": loads.wheel((0, 0, 1), inertia=0.3, rate=0.4, dry_friction=0.05)},
    "a speed that changes": {
        "load": loads.wheel((0, 0, 1), inertia=0.3, speed=[0.0, 5.0, 1.0], times=[0.0, 2.0, 6.0])
    },
    "sampled controller": {"load": sampled() + WHEEL},
    "an orbit without epoch": {
        "load": loads.gravity_gradient(orbits.kepler(1.0, (1.0, 0, 0), (0, 1.1, 0.2))) + WHEEL
    },
    "a schedule": {"load": loads.schedule(loads.constant_torque((0, 0, 1)), [(0.4, 1.2), (2.6, 2.7)])},
    "a feedback": {"load": loads.feedback(K=1.0, D=0.4, target=(0, 0, 1, 0))},
    "a function": {"load": loads.torque_callback(lambda t, omega, _q: (np.sin(t), -omega[1], 0.0))},
    "a force": {"load": loads.constant_force((0, 1, 0), "body", point=(1, 0, 0)), "velocity": (1, 2, 3)},
    "a top": {"load": loads.uniform_gravity((0, 0, -9.81)), "about": "origin"},
    "radau": {"load": loads.damping(5.0), "method": "radau"},
    "splitting": {"load": loads.feedback(K=1.0, D=0.0), "method": "splitting", "rtol": 1e-6},
    "twice the precision": {"load": WHEEL, "rtol": 1e-18},
    "given states": {"load": THREE, "states": {"y": [0.3]}},
}
TOP = solids.cone(0.2, 0.6, mass=2.0).translated((0, 0, 0.45))


def chain(body: RigidBody, cuts: Any, omega: Any, *, loads: Any = None, **options: Any) -> list[Trajectory]:
    """Simulate to the first cut, and resume from each."""
    first = {name: options.pop(name) for name in ("velocity", "states") if name in options}
    load = options.pop("load", None)
    about = {"about": options["about"]} if "about" in options else {}
    runs = [body.simulate(cuts[:2], omega, load=load, **first, **options)]
    options = {name: value for name, value in options.items() if name != "about"} | about
    for index, pair in enumerate(pairwise(cuts[1:])):
        other = {} if loads is None or loads[index] is None else {"load": loads[index]}
        runs.append(runs[-1].resume(pair, **other, **options))
    return runs


def equal(run: Any, parts: list[Trajectory]) -> None:
    """Check that the states of a stepper have the bits of a chain."""
    motion = run.trajectory()
    for name in ("omega", "quaternion", "position", "velocity"):
        values = getattr(motion, name)
        for index, part in enumerate(parts, start=1):
            assert np.array_equal(values[index], getattr(part, name)[-1]), (name, index)
    for name, values in parts[-1].states.items():
        assert np.array_equal(motion.states[name][-1], values[-1])
    assert motion.steps == sum(part.steps for part in parts)
    assert motion.evaluations == sum(part.evaluations for part in parts)


@pytest.mark.parametrize("name", CASES)
def test_the_bits_of_a_chain(name: str) -> None:
    options = dict(CASES[name])
    body = TOP if name == "a top" else BODY
    parts = chain(body, CUTS, OMEGA, **options)
    run = body.stepper(OMEGA, **options)
    for before, after in pairwise(CUTS):
        state = run.step(after - before)
        assert run.t == after
    equal(run, parts)
    assert np.array_equal(state.omega, parts[-1].omega[-1])
    assert np.array_equal(run.state().attitude, parts[-1].quaternion[-1])
    motion = run.trajectory()
    assert motion.t.tolist() == CUTS
    assert motion.status == run.status == "complete"
    assert motion.pivoted is parts[0].pivoted
    for frame in ("body", "space"):
        whole, part = (one.angular_momentum(frame).spin[-1] for one in (motion, parts[-1]))
        assert np.abs(whole - part).max() < 1e-14 * max(1.0, np.abs(part).max())


@pytest.mark.parametrize("name", ["three wheels", "nothing", "sampled controller"])
def test_many_equal_steps(name: str) -> None:
    load = CASES[name].get("load")
    run, motion = BODY.stepper(OMEGA, load=load, start=5.0), None
    for _ in range(20):
        t = run.t
        state = run.step(0.1)
        pair = [t, t + 0.1]
        motion = motion.resume(pair) if motion else BODY.simulate(pair, OMEGA, load=load)
        assert run.t == t + 0.1
        assert np.array_equal(state.omega, motion.omega[-1])
        assert np.array_equal(state.attitude, motion.quaternion[-1])


def test_another_load_on_the_way() -> None:
    others: list[Any] = [
        None,
        THREE + loads.constant_torque((0, 0.2, 1.0)),
        None,
        loads.constant_torque((0, 0.2, 1.0)) + THREE + loads.wheel((1, 0, 0), inertia=0.2, name="new"),
    ]
    parts = chain(BODY, CUTS, OMEGA, load=THREE, loads=others)
    run = BODY.stepper(OMEGA, load=THREE)
    for index, (before, after) in enumerate(pairwise(CUTS)):
        run.step(after - before, load=others[index - 1] if index else None)
    equal(run, parts)
    motion = run.trajectory()
    assert motion.load is None
    assert np.isnan(motion.states["new"][:-1]).all()
    assert not np.isnan(motion.states["x"]).any()
    for index, part in enumerate(parts, start=1):
        for of in ("angular_momentum", "kinetic_energy"):
            mine, theirs = getattr(motion, of)(), getattr(part, of)()
            assert np.abs(mine.total[index] - theirs.total[-1]).max() < 1e-13
    with pytest.raises(ValueError, match="torque: the load of this motion is unknown"):
        motion.torque()
    on = motion.resume([5.0, 6.0], load=parts[-1].load)
    assert np.array_equal(on.omega[-1], parts[-1].resume([5.0, 6.0]).omega[-1])
    run = BODY.stepper(OMEGA)
    run.step(1.0, load=loads.damping(0.1))
    with pytest.raises(ValueError, match="force: a load acted on this motion"):
        run.trajectory().force()


@pytest.mark.parametrize(
    "other",
    [
        loads.constant_torque((0, 0, 1.0)),
        loads.wheel((0.0, 0.6, 0.8), inertia=0.5, rate=3.0, name="other"),
        WHEEL + loads.rotor((0, 0, 1.0)),
    ],
)
def test_a_momentum_that_would_jump_is_refused(other: Any) -> None:
    run = BODY.stepper(OMEGA, load=WHEEL)
    run.step(1.0)
    with pytest.raises(ValueError, match=r"total angular momentum would jump at t = 1\.0"):
        run.step(1.0, load=other)
    assert run.t == 1.0
    assert np.array_equal(run.step(1.0).omega, chain(BODY, [0, 1, 2], OMEGA, load=WHEEL)[-1].omega[-1])


class TestEvents:
    FLIP = Event(lambda _t, omega, *_: omega[1])
    THIRD = Event(lambda _t, omega, *_: omega[1], terminal=3)
    EACH = Event(lambda _t, omega, *_: omega[1], terminal=True)
    START = (1.0, 0.3, 0.6)

    def test_they_are_those_of_one_run(self) -> None:
        whole = BODY.simulate([0, 40], self.START, events=self.FLIP)
        run = BODY.stepper(self.START, events=self.FLIP)
        for _ in range(40):
            run.step(1.0)
        found = run.trajectory().events
        assert len(found.t) == len(whole.events.t) > 4
        assert np.abs(found.t - whole.events.t).max() < 1e-8

    LOADS = (None, loads.damping(1e-9), loads.torque_callback(lambda *_: (0, 0, 0)))

    @pytest.mark.parametrize("load", LOADS)
    def test_a_terminal_event_ends_a_step(self, load: Any) -> None:
        times = BODY.simulate([0, 40], self.START, load=load, events=self.FLIP).events.t
        run = BODY.stepper(self.START, load=load, events=[self.EACH])
        motion = BODY.simulate([0, 40], self.START, load=load, events=self.EACH)
        for index, time in enumerate(times):
            run.step(40 - run.t)
            assert run.status == "event"
            assert abs(run.t - time) < 1e-8
            assert run.t == motion.events.t[-1]
            assert np.array_equal(run.state().omega, motion.events.omega[-1])
            assert len(run.trajectory().events.t) == index + 1
            motion = motion.resume([run.t, 40], from_event=True, events=self.EACH)
        run.step(40 - run.t)
        assert run.status == motion.status == "complete"
        assert np.array_equal(run.state().omega, motion.omega[-1])
        assert len(run.trajectory().t) == len(times) + 2

    def test_passages_are_counted_over_the_steps(self) -> None:
        times = BODY.simulate([0, 60], self.START, events=self.FLIP).events.t
        run = BODY.stepper(self.START, events=self.THIRD)
        ends = []
        while run.t < 60:
            run.step(min(1.0, 60 - run.t))
            ends += [run.t] if run.status == "event" else []
        assert len(times) >= 7
        assert np.abs(np.array(ends) - times[2::3]).max() < 1e-8
        assert len(run.trajectory().events.t) == len(times)

    def test_wheels_that_stop_and_break_away(self) -> None:
        # The wheel stops at Ω₀ J (1 − J/I)/c₀; then Ω̇ is (τ − c₀) (1/J + 1/(I − J)).
        def wheel(**options: Any) -> loads.Load:
            return loads.wheel((0, 0, 1), inertia=0.5, dry_friction=0.25, **options)

        body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
        both = [Event.stop("wheel", terminal=True), Event.breakaway("wheel", terminal=True)]
        run = body.stepper((0, 0, 0), load=wheel(rate=10.0), events=both)
        run.step(100.0)
        assert run.status == "event"
        assert run.t == pytest.approx(0.5 * 10 * (1 - 0.5 / 3) / 0.25, rel=1e-12)
        start = run.t
        strong = wheel(torque=0.4)
        run.step(2.0, load=strong)
        assert (run.status, run.t) == ("event", start)  # it breaks away at once
        run.step(2.0)
        assert (run.status, run.t) == ("complete", start + 2.0)
        omega, momentum = run.state().omega[2], run.trajectory().states["wheel"][-1, 0]
        rate = momentum / 0.5 - omega
        assert rate == pytest.approx(0.15 * 2.0 * (1 / 0.5 + 1 / 2.5), rel=1e-12)
        kinds = run.trajectory().events.event.tolist()
        assert kinds == [0, 1]

        first = body.simulate([0, 100], (0, 0, 0), load=wheel(rate=10.0), events=both)
        second = first.resume([first.events.t[-1], 30], from_event=True, load=strong, events=both)
        third = second.resume([second.events.t[-1], start + 2.0], from_event=True, events=both)
        assert (third.status, third.omega[-1][2]) == ("complete", omega)

    def test_a_motor_at_its_limit(self) -> None:
        wheel = loads.wheel((0, 0, 1), inertia=0.5, torque=loads.feedback(K=1.0, D=2.0), max_torque=0.05)
        event = Event.limit("wheel", terminal=True)
        start: Any = {"omega": (0, 0, 0), "attitude": (0, 0, np.sin(0.4), np.cos(0.4))}
        times = BODY.simulate([0, 60], **start, load=wheel, events=Event.limit("wheel")).events.t
        run, ends = BODY.stepper(**start, load=wheel, events=event), []
        while run.t < 60:
            run.step(60 - run.t)
            ends += [run.t] if run.status == "event" else []
        assert np.abs(np.array(ends) - times).max() < 1e-8

    def test_what_no_event_ended(self) -> None:
        complete = BODY.simulate([0, 1], OMEGA)
        with pytest.raises(ValueError, match="no terminal event ended this motion, its status is 'complete'"):
            complete.resume([1, 2], from_event=True)
        stack = BODY.simulate([0, 40], [self.START, self.START], events=self.EACH)
        with pytest.raises(ValueError, match="the bodies of a stack end at different times"):
            stack.resume([1, 2], from_event=True)
        ended = BODY.simulate([0, 40], self.START, events=self.EACH)
        with pytest.raises(ValueError, match="go on from the event: from_event=True"):
            ended.resume([40, 50])
        with pytest.raises(ValueError, match="the motion goes on from t ="):
            ended.resume([0, 50], from_event=True)
        copied = copy.deepcopy(ended)  # which does not know the function any more
        for motion in (ended, copied):
            on = motion.resume([motion.events.t[-1], 40], from_event=True, events=self.EACH)
            assert on.events.t[0] > motion.events.t[-1] + 0.1
        # Without the event, or with another one, it goes on too.
        time = ended.events.t[-1]
        plain = ended.resume([time, 40], from_event=True)
        other = ended.resume([time, 40], from_event=True, events=lambda _t, omega, *_: omega[1])
        assert plain.status == other.status == "complete"


class TestRefused:
    RUN = BODY.stepper(OMEGA)

    @pytest.mark.parametrize("dt", [0.0, np.nan, np.inf, 1e308 * 10])
    def test_steps_that_are_none(self, dt: float) -> None:
        with pytest.raises(ValueError, match="dt: expected a finite time that is not zero"):
            self.RUN.step(dt)
        assert self.RUN.t == 0.0

    def test_steps_that_rounding_swallows(self) -> None:
        run = BODY.stepper(OMEGA, start=1e9)
        with pytest.raises(ValueError, match="is lost in the rounding of t = 1000000000"):
            run.step(1e-9)
        run.step(1e-6)
        assert run.t > 1e9

    def test_steps_back_and_forth(self) -> None:
        run = BODY.stepper(OMEGA)
        run.step(-1.0)
        assert np.array_equal(run.state().omega, BODY.simulate([0, -1], OMEGA).omega[-1])
        with pytest.raises(ValueError, match=r"all steps go the same way in time, .* from 0\.0 to -1\.0"):
            run.step(0.5)
        run.step(-0.5)
        again = BODY.stepper(**run.state()._asdict(), start=run.t)
        again.step(1.5)
        assert np.abs(again.state().omega - OMEGA).max() < 1e-9

    def test_stacks(self) -> None:
        for given in (
            {"omega": [OMEGA, OMEGA]},
            {"omega": OMEGA, "load": loads.constant_torque([(0, 0, 1), (0, 1, 0)])},
        ):
            with pytest.raises(ValueError, match="a stepper moves one body, got a stack of shape"):
                BODY.stepper(**given)
        with pytest.raises(ValueError, match="the body: a stepper moves one body"):
            RigidBody.stack([BODY, BODY]).stepper(OMEGA)
        with pytest.raises(ValueError, match="load: a stepper moves one body"):
            self.RUN.step(1.0, load=loads.constant_torque([(0, 0, 1), (0, 1, 0)]))

    def test_other_arguments(self) -> None:
        with pytest.raises(TypeError, match="contact"):
            BODY.stepper(OMEGA, contact=None)  # type: ignore[call-arg]
        with pytest.raises(TypeError, match="load"):
            self.RUN.step(1.0, load="wheel")  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="start: expected a finite time"):
            BODY.stepper(OMEGA, start=np.nan)
        run = BODY.stepper(OMEGA, load=sampled())
        with pytest.raises(ValueError, match='the states "law" are 2 numbers until now and 1 under this'):
            run.step(1.0, load=loads.wheel((0, 0, 1), inertia=0.1, name="law"))

    def test_a_step_that_fails_is_not_made(self) -> None:
        def breaks(t: float, _omega: Any, _q: Any) -> Any:
            if t > 1.5:
                raise KeyError("sensor")
            return (0.0, 0.0, 0.1)

        run = BODY.stepper(OMEGA, load=loads.torque_callback(breaks))
        before = run.step(1.0)
        with pytest.raises(KeyError, match="sensor"):
            run.step(1.0)
        assert run.t == 1.0
        assert np.array_equal(run.state().omega, before.omega)
        assert len(run.trajectory()) == 2
        blows = loads.torque_callback(lambda t, *_: (0.0, 0.0, 1.0 / (1.5 - t) ** 2))
        run = BODY.stepper(OMEGA, load=blows)
        run.step(1.0)
        with pytest.raises(IntegrationError) as caught:
            run.step(1.0)
        assert caught.value.partial is not None
        assert caught.value.partial.t.tolist() == [0.0, 1.0]
        assert 1.0 < caught.value.time <= 1.5
        assert run.t == 1.0

    def test_a_step_within_a_step(self) -> None:
        run: Any = None

        def again(*_: Any) -> Any:
            run.step(0.1)

        run = BODY.stepper(OMEGA, load=loads.torque_callback(again))
        with pytest.raises(RuntimeError, match="borrowed"):
            run.step(1.0)

    def test_it_is_collected(self) -> None:
        class Law:
            run: Any = None

            def __call__(self, *_: Any) -> Any:
                return (0.0, 0.0, 0.0)

        law = Law()
        law.run = BODY.stepper(OMEGA, load=loads.torque_callback(law))
        gone = weakref.ref(law)
        del law
        gc.collect()
        assert gone() is None


def test_sigmas_of_the_start_are_kept() -> None:
    omega = polhode.Uncertain((0.3, 0.5, -0.2), sigma=0.01)
    run = BODY.stepper(omega)
    run.step(2.0)
    whole = BODY.simulate([0, 2], omega)
    found, exact = run.trajectory().covariance, whole.covariance
    assert found is not None
    assert exact is not None
    assert np.abs(found - exact).max() < 1e-15


def test_a_day_of_a_flight_program() -> None:
    """A torque that is told each second: momentum goes into the wheel, and the sum stays."""
    run = BODY.stepper((0, 0, 0.1), load=loads.wheel((0, 0, 1), inertia=0.1))
    for _ in range(200):
        torque = 0.2 * run.state().omega[2]
        run.step(1.0, load=loads.wheel((0, 0, 1), inertia=0.1, torque=torque))
    motion = run.trajectory()
    # ω(k + 1) = ω(k) (1 − 0.2/(I − J)).
    exact = 0.1 * (1 - 0.2 / 2.4) ** np.arange(201)
    assert np.abs(motion.omega[:, 2] - exact).max() < 1e-14
    assert np.abs(motion.angular_momentum().spin[:, 2] - 0.25).max() < 1e-14
