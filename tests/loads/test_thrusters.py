"""Thrusters: pulses of known lengths, their switches, what they exert, and the impulse that they use."""

from __future__ import annotations

import itertools
import pickle
from typing import Any

import numpy as np
import pytest
from oracles.wheels import ATTITUDE, BODY, OMEGA, turned, turning
from polhode import Event, RigidBody, loads
from polhode.errors import PolhodeError
from scipy.integrate import solve_ivp

PLAIN = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5))
ARM, FORCE, I3 = 0.4, 0.3, 2.5
PAIR: Any = ([(ARM, 0, 0), (ARM, 0, 0)], [(0, 1, 0), (0, -3, 0)])
TIGHT: Any = {"method": "DOP853", "rtol": 3e-14, "atol": 1e-14}

PLACES = np.array(
    [(1.0, 0.2, 0), (-1.0, 0.1, 0.3), (0, 1.0, -0.2), (0.1, -1.0, 0), (0.3, 0, 1.0), (0, 0.2, -1.0)]
)
ALONG = np.array([(0, 1.0, 0.2), (0.1, 1.0, 0), (0, 0.3, 1.0), (0.2, 0, -1.0), (1.0, 0, 0), (-1.0, 0.4, 0)])
UNIT = ALONG / np.linalg.norm(ALONG, axis=1, keepdims=True)
FORCES = np.array([0.2, 0.3, 0.25, 0.15, 0.3, 0.2])


def one(**options: Any) -> Any:
    """Make a thruster that turns PLAIN about its third axis, beside one the other way."""
    return loads.thrusters(PAIR[0], PAIR[1], FORCE, **({"period": 1.0} | options))


def pulses(run: Any, number: int = 0) -> Any:
    return run.events.t[run.events.event == number]


class TestClosedForms:
    """About the third axis alone: ω = (r F/I) times the time of firing."""

    def test_pulses_of_given_duties(self) -> None:
        t = np.array([0.0, 0.25, 0.3, 1.0, 1.2, 5.0])
        load = one(command=[0.25, 0.0])
        run = PLAIN.simulate(t, (0, 0, 0), load=load, events=[Event.pulse(0), Event.pulse(1)])
        fired = np.array([0.0, 0.25, 0.25, 0.25, 0.45, 1.25])
        assert run.omega[:, 2] == pytest.approx(ARM * FORCE / I3 * fired, abs=1e-14)
        assert run.states["thrusters"] == pytest.approx(
            np.column_stack([FORCE * fired, 0 * fired]), abs=1e-14
        )
        assert np.array_equal(pulses(run), np.sort(np.concatenate([np.arange(5.0), np.arange(5) + 0.25])))
        assert not len(pulses(run, 1))

    def test_it_pushes_too(self) -> None:
        """Along its line through the centre of mass a thruster pushes the body without turning it."""
        jet = loads.thrusters([(0, 0, -1.0)], [(0, 0, 2.0)], 3.0, command=[0.5], period=0.5)
        run = PLAIN.simulate([0, 2.0], (0, 0, 0), load=jet)
        assert np.array_equal(run.omega[-1], np.zeros(3))
        rate = 3.0 / 2.0
        # Each pulse of 0.25 at 0, 0.5, 1, 1.5: v = a 0.25, then straight on.
        place = sum(rate * 0.25 * (2.0 - start - 0.125) for start in (0.0, 0.5, 1.0, 1.5))
        assert run.velocity[-1] == pytest.approx([0, 0, rate], abs=1e-14)
        assert run.position[-1] == pytest.approx([0, 0, place], abs=1e-13)

    def test_about_a_pivot_the_arm_is_from_the_origin(self) -> None:
        body = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5), center_of_mass=(0, 0, 0.5))
        load = loads.thrusters([(0.4, 0, 0.7)], [(0, 1, 0)], FORCE, command=[1.0], period=1.0)
        run: Any = {"t": 0.0, "omega": (0, 0, 0), "quaternion": (0, 0, 0, 1), "body": body}
        states = {"thrusters": [0.0], "thrusters_pulse": [1.0]}
        arms: Any = (("origin", (0.4, 0, 0.7)), ("center_of_mass", (0.4, 0, 0.2)))
        for about, arm in arms:
            torque = load.torque(**run, about=about, states=states)
            assert torque == pytest.approx(np.cross(arm, (0, FORCE, 0)), abs=1e-16)
        assert np.array_equal(load.force(**run, states=states), [0, FORCE, 0])
        with pytest.raises(TypeError, match="pass body="):
            load.torque(0.0, (0, 0, 0), (0, 0, 0, 1), states=states)

    def test_a_table(self) -> None:
        """A row holds for the periods that start at its time, or later: that of 1.5 from 2 on."""
        rows = [(0.5, 0), (0.25, 0), (0.0, 0.75)]
        load = one(command=rows, times=[0.0, 1.0, 1.5])
        run = PLAIN.simulate(np.arange(5.0), (0, 0, 0), load=load)
        assert run.states["thrusters"] / FORCE == pytest.approx(
            np.array([(0, 0), (0.5, 0), (0.75, 0), (0.75, 0.75), (0.75, 1.5)]), abs=1e-14
        )
        assert run.states["thrusters_pulse"][1:] == pytest.approx(
            np.array([(0.5, 0), (0.25, 0), (0, 0.75), (0, 0.75)]), abs=0
        )

    def test_the_least_pulse_on_both_sides(self) -> None:
        for duty, fires in (
            (0.3, True),
            (0.3 * (1 + 1e-14), True),
            (0.3 * (1 - 1e-15), True),
            (0.3 * (1 - 1e-14), False),
            (0.29, False),
        ):
            run = PLAIN.simulate([0, 0.1], (0, 0, 0), load=one(command=[duty, 0], period=0.1, min_on=0.03))
            used = run.states["thrusters"][-1, 0]
            assert used == pytest.approx(FORCE * 0.03 if fires else 0.0, abs=1e-15)

    def test_the_longest_pulse(self) -> None:
        for duty in (0.69, 0.7, 0.71, 1.0, 5.0):
            run = PLAIN.simulate([0, 2], (0, 0, 0), load=one(command=[duty, 0], max_on=0.7))
            assert run.states["thrusters"][-1, 0] == pytest.approx(2 * FORCE * min(duty, 0.7), abs=1e-14)

    def test_duties_are_clipped(self) -> None:
        run = PLAIN.simulate([0, 3], (0, 0, 0), load=one(command=[1.5, -0.5]), events=Event.pulse())
        assert run.states["thrusters"][-1] == pytest.approx([3 * FORCE, 0], abs=1e-14)
        # Fires without a pause: switched on once.
        assert np.array_equal(run.events.t, [0.0])

    def test_on_or_off(self) -> None:
        for duty, fires in ((np.nextafter(0.4, 0), 0), (0.4, 1), (0.9, 1), (-0.9, 0)):
            run = PLAIN.simulate([0, 2], (0, 0, 0), load=one(command=[duty, 0], deadband=0.4, max_on=0.6))
            assert run.states["thrusters"][-1, 0] == pytest.approx(fires * 2 * 0.6 * FORCE, abs=1e-14)

    def test_a_sampled_controller(self) -> None:
        """Its duty takes the rate away, as far as one period can."""
        calls: list[float] = []

        def command(t: float, omega: np.ndarray, *_: Any) -> Any:
            calls.append(t)
            return np.array([-1.0, 1.0]) * omega[2] * I3 / (ARM * FORCE)

        run = PLAIN.simulate(
            np.arange(6.0), (0, 0, 0.2), load=one(command=command), events=[Event.pulse(0), Event.pulse(1)]
        )
        step = ARM * FORCE / I3
        exact = np.maximum(0.2 - step * np.arange(6), 0)
        assert run.omega[:, 2] == pytest.approx(exact, abs=1e-13)
        assert calls == [0.0, 1.0, 2.0, 3.0, 4.0]
        # Four whole periods, then a pulse that ends when the rate is gone.
        assert pulses(run, 1)[:2] == pytest.approx([0, 0.2 / step], abs=1e-12)
        assert run.states["thrusters"][-1, 1] * ARM == pytest.approx(0.2 * I3, abs=1e-12)

    def test_a_limit_cycle_of_a_deadband(self) -> None:
        """Under a torque from outside a thruster fires when the controller sees too high a rate."""
        push = 0.02

        def command(_t: float, omega: np.ndarray, *_: Any) -> Any:
            return [0.0, float(omega[2] > 0.05)]

        load = one(command=command, deadband=0.5, period=0.5) + loads.constant_torque((0, 0, push))
        run = PLAIN.simulate(np.arange(0, 40.5, 0.5), (0, 0, 0), load=load, events=Event.pulse(1))
        rate, on, times = 0.0, False, []
        exact = [0.0]
        for k in range(80):
            if (rate > 0.05) != on:
                on = not on
                times.append(0.5 * k)
            rate += 0.5 * (push - on * ARM * FORCE) / I3
            exact.append(rate)
        assert run.omega[:, 2] == pytest.approx(exact, abs=1e-13)
        assert len(times) > 4
        assert np.array_equal(run.events.t, times)


class Law:
    """Duties by the signs of a torque −2 e − 3 ω along the arms of the thrusters."""

    def __init__(self, body: RigidBody) -> None:
        self.rows = np.linalg.pinv(np.cross(PLACES - body.center_of_mass, UNIT * FORCES[:, None]).T)

    def __call__(self, _t: float, omega: Any, q: Any, *_: Any) -> Any:
        return self.rows @ (-0.4 * np.sign(q[3]) * np.asarray(q[:3]) - 0.5 * np.asarray(omega))


def by_pieces(body: RigidBody, law: Any, period: float, count: int, min_on: float) -> Any:
    """Integrate by SciPy, from switch to switch: the states at the ends of periods, and the impulses."""
    tensor, mass, arms = body.inertia, body.mass, PLACES - body.center_of_mass
    inverse = np.linalg.inv(tensor)
    y = np.concatenate([ATTITUDE, OMEGA, body.center_of_mass * 0, np.zeros(3)])
    found, impulse, switches = [y], np.zeros(len(FORCES)), []
    for k in range(count):
        length = np.clip(law(k * period, y[4:7], y[:4]), 0, 1) * period
        length[length < min_on] = 0.0
        impulse += length * FORCES
        edges = np.unique(np.concatenate([[0, period], length]))
        switches.append(length)
        for low, high in itertools.pairwise(edges):
            thrust = (UNIT * FORCES[:, None])[length > low]
            push, turn = thrust.sum(axis=0), np.cross(arms[length > low], thrust).sum(axis=0)

            def rates(_t: float, y: np.ndarray, push: Any = push, turn: Any = turn) -> Any:
                q, w = y[:4], y[4:7]
                spin = inverse @ (turn - np.cross(w, tensor @ w))
                return np.concatenate([turning(q, w), spin, y[10:], turned(q) @ push / mass])

            y = solve_ivp(rates, (low, high), y, **TIGHT).y[:, -1]
        found.append(y)
    return np.array(found), impulse, switches


class TestAgainstSciPy:
    PERIOD, COUNT, LEAST = 0.7, 9, 0.05

    def load(self, body: RigidBody = BODY, **options: Any) -> Any:
        return loads.thrusters(
            PLACES, ALONG, FORCES, command=Law(body), period=self.PERIOD, min_on=self.LEAST, **options
        )

    @pytest.mark.parametrize("body", [BODY, BODY.translated((0.3, -0.2, 0.1))])
    def test_six_thrusters_with_a_controller(self, body: RigidBody) -> None:
        t = self.PERIOD * np.arange(self.COUNT + 1)
        run = body.simulate(t, OMEGA, ATTITUDE, load=self.load(body), rtol=1e-13)
        exact, impulse, lengths = by_pieces(body, Law(body), self.PERIOD, self.COUNT, self.LEAST)
        some = np.concatenate(lengths)
        assert np.count_nonzero((some > 0) & (some < self.PERIOD)) > 10
        assert np.abs(run.omega - exact[:, 4:7]).max() < 1e-10
        assert np.abs(run.quaternion - exact[:, :4]).max() < 1e-10
        assert np.abs(run.position - exact[:, 7:10]).max() < 1e-10
        assert np.abs(run.velocity - exact[:, 10:]).max() < 1e-10
        assert np.abs(run.states["thrusters"][-1] - impulse).max() < 1e-10
        assert np.abs(run.states["thrusters_pulse"][1:] - lengths).max() < 1e-10

    @pytest.mark.parametrize(("method", "allowed"), [("radau", 1e-8), ("dop853", 1e-10)])
    def test_methods(self, method: Any, allowed: float) -> None:
        exact, impulse, _ = by_pieces(BODY, Law(BODY), self.PERIOD, self.COUNT, self.LEAST)
        end = self.PERIOD * self.COUNT
        run = BODY.simulate([0, end], OMEGA, ATTITUDE, load=self.load(), method=method, rtol=1e-12)
        assert np.abs(run.omega[-1] - exact[-1, 4:7]).max() < allowed
        assert np.abs(run.states["thrusters"][-1] - impulse).max() < allowed

    def test_chains_keep_the_phase_within_a_period(self) -> None:
        """A stepper has the bits of runs that go on one after the other, cut anywhere in a period."""
        ends = np.array([0.0, 0.3, 0.7, 0.75, 2.0, 2.1, 4.9])
        whole = BODY.simulate(ends, OMEGA, ATTITUDE, load=self.load(), rtol=1e-12)
        chain = BODY.simulate(ends[:2], OMEGA, ATTITUDE, load=self.load(), rtol=1e-12)
        stepper = BODY.stepper(OMEGA, ATTITUDE, load=self.load(), rtol=1e-12)
        stepper.step(ends[1])
        for k in range(2, len(ends)):
            stepper.step(ends[k] - stepper.t)
            chain = chain.resume([chain.t[-1], stepper.t], rtol=1e-12)
            state = stepper.state()
            assert np.array_equal(state.omega, chain.omega[-1])
            for name, values in chain.states.items():
                assert state.states is not None
                assert np.array_equal(state.states[name], values[-1])
                assert np.abs(values[-1] - whole.states[name][k]).max() < 1e-10
            assert np.abs(chain.omega[-1] - whole.omega[k]).max() < 1e-10

    def test_stacks_of_bodies(self) -> None:
        other = RigidBody.from_principal(4.0, (2.0, 2.5, 3.0))
        both = RigidBody.stack([BODY, other])
        run = both.simulate([0, 2.0], OMEGA, load=self.load())
        alone = other.simulate([0, 2.0], OMEGA, load=self.load())
        assert np.array_equal(run.omega[1], alone.omega)
        assert np.array_equal(run.states["thrusters"][1], alone.states["thrusters"])
        given = loads.thrusters(PLACES, ALONG, FORCES, command=np.full(6, 0.3), period=0.7)
        run = both.simulate([0, 2.0], OMEGA, load=given)
        alone = other.simulate([0, 2.0], OMEGA, load=given)
        assert np.array_equal(run.omega[1], alone.omega)

    def test_beside_other_loads_with_states(self) -> None:
        """Wheels, a slug and functions beside them; a controller of duties reads the states of all."""
        seen: list[Any] = []

        def command(_t: float, _w: Any, _q: Any, _r: Any, _v: Any, states: Any) -> Any:
            seen.append(sorted(states))
            return np.clip([states["wheel"][0], -states["wheel"][0]], 0, 1)

        wheel = loads.wheel((0, 0, 1), 0.5, torque=0.2)
        filtered = loads.with_states(lambda *a: a[1][2] - a[-1]["f"], [0.0], name="f")
        jets = one(command=command, period=0.5, name="jets")
        run = PLAIN.simulate(np.arange(0, 3.5, 0.5), (0, 0, 0), load=jets + filtered + wheel)
        assert seen[0] == ["f", "jets", "jets_pulse", "wheel"]
        h = run.states["wheel"][:, 0]
        assert h == pytest.approx(0.2 * run.t, abs=1e-13)
        assert run.states["jets_pulse"][1:, 0] == pytest.approx(0.5 * h[:-1], abs=1e-13)
        spin = run.angular_momentum().spin[:, 2]
        assert spin == pytest.approx(ARM * (run.states["jets"] @ [1, -1]), abs=1e-13)
        two = one(command=[0.5, 0]) + one(command=[0, 0.25])
        run = PLAIN.simulate([0, 2], (0, 0, 0), load=two, events=Event.pulse(1, "thrusters_2"))
        assert sorted(run.states) == ["thrusters", "thrusters_2", "thrusters_2_pulse", "thrusters_pulse"]
        assert run.states["thrusters_2"][-1] == pytest.approx([0, 0.5 * FORCE], abs=1e-15)
        assert np.array_equal(run.events.t, [0, 0.25, 1, 1.25])


class TestEvents:
    def test_directions_and_terminals(self) -> None:
        load = one(command=[0.25, 0])
        events = [Event.pulse(direction=1), Event.pulse(direction=-1)]
        run = PLAIN.simulate([0, 2.1], (0, 0, 0), load=load, events=events)
        assert np.array_equal(pulses(run, 0), [0, 1, 2])
        assert np.array_equal(pulses(run, 1), [0.25, 1.25])
        stop = Event.pulse(direction=-1, terminal=2)
        run = PLAIN.simulate([0, 9], (0, 0, 0), load=load, events=stop)
        assert run.status == "event"
        assert np.array_equal(run.events.t, [0.25, 1.25])
        assert run.omega[-1, 2] != 0.0 or np.isnan(run.omega[-1, 2])

    def test_a_run_goes_on_from_a_switch(self) -> None:
        load, stop = one(command=[0.25, 0]), Event.pulse(terminal=True)
        step = PLAIN.stepper((0, 0, 0), load=load, events=stop)
        reached = []
        for _ in range(8):
            step.step(0.6)
            reached.append(step.t)
        assert np.allclose(reached, [0, 0.25, 0.85, 1.0, 1.25, 1.85, 2.0, 2.25], atol=1e-15)
        assert step.state().omega[2] == pytest.approx(ARM * FORCE / I3 * 0.75, abs=1e-14)

    def test_across_the_ends_of_runs(self) -> None:
        """Cut at a switch, within a pulse and at the start of a period: each switch is found once."""
        load = one(command=[0.25, 0])
        stepper = PLAIN.stepper((0, 0, 0), load=load, events=Event.pulse())
        for end in (0.1, 0.25, 0.3, 1.0, 1.1, 1.6, 2.0, 2.5):
            stepper.step(end - stepper.t)
        run = stepper.trajectory()
        assert run.events.t == pytest.approx([0, 0.25, 1, 1.25, 2, 2.25], abs=1e-15)

    def test_refused(self) -> None:
        load = one(command=[0.25, 0])
        with pytest.raises(ValueError, match=r"the thruster 2 of .*, which has those from 0 to 1"):
            PLAIN.simulate([0, 1], (0, 0, 0), load=load, events=Event.pulse(2))
        with pytest.raises(ValueError, match="asks for thrusters with the name"):
            PLAIN.simulate([0, 1], (0, 0, 0), load=load, events=Event.pulse(0, "jets"))
        with pytest.raises(ValueError, match="asks for thrusters with the name"):
            PLAIN.simulate(
                [0, 1], (0, 0, 0), load=loads.wheel((0, 0, 1), 0.1), events=Event.pulse(0, "wheel")
            )


class TestAsALoad:
    def test_pickle_and_repr(self) -> None:
        for command in (Law(BODY), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]):
            load = loads.thrusters(
                PLACES, ALONG, FORCES, command=command, period=0.7, min_on=0.1, name="jets"
            )
            again = pickle.loads(pickle.dumps(load))
            runs = [BODY.simulate([0, 2], OMEGA, ATTITUDE, load=one) for one in (load, again)]
            assert np.array_equal(runs[0].omega, runs[1].omega)
            assert repr(load) == "<Load: thrusters>"
            saved = pickle.loads(pickle.dumps(runs[0]))
            assert np.array_equal(saved.resume([2, 3]).omega, runs[0].resume([2, 3]).omega)

    def test_arrays_are_copied(self) -> None:
        duties = np.array([0.5, 0.0])
        load = one(command=duties)
        duties[:] = 0.9
        again = pickle.loads(pickle.dumps(load))
        assert PLAIN.simulate([0, 1], (0, 0, 0), load=again).states["thrusters"][-1, 0] == pytest.approx(0.15)

    def test_states_can_be_given(self) -> None:
        run = PLAIN.simulate([0, 1], (0, 0, 0), load=one(command=[0.5, 0]), states={"thrusters": [7.0, 1.0]})
        assert run.states["thrusters"][-1] == pytest.approx([7.15, 1.0], abs=1e-14)

    def test_keeps_nothing(self) -> None:
        load = one(command=[0.5, 0])
        assert load.keeps_momentum() is None
        assert load.states == {"thrusters": 2, "thrusters_pulse": 2}
        assert load.potential(PLAIN, (0, 0, 0, 1)) is None

    def test_refused(self) -> None:
        good: dict[str, Any] = {"command": [0.5, 0.0]}
        cases: list[tuple[dict[str, Any], str]] = [
            ({"period": 0.0}, "period must be positive"),
            ({"period": np.inf}, "period must be"),
            ({"min_on": -1e-3}, "min_on must be zero or more"),
            ({"min_on": 1.1}, r"min_on must be .* max_on"),
            ({"min_on": 0.6, "max_on": 0.5}, r"min_on must be .* max_on"),
            ({"max_on": 1.1}, "max_on must be the period or less"),
            ({"max_on": 0.0}, "max_on must be positive"),
            ({"deadband": 0.0}, "deadband must be above 0"),
            ({"deadband": 1.1}, "deadband must be above 0"),
            ({"deadband": 0.5, "min_on": 0.1}, "min_on must be left out beside deadband"),
            ({"command": [0.5]}, r"command: expected the shape \(2,\)"),
            ({"command": [[0.5, 0.1]]}, r"rows of duties need times="),
            ({"command": [[0.5, 0.1]], "times": [0, 1]}, r"command: expected the shape \(2, 2\)"),
            ({"command": [np.nan, 0]}, "command must be finite"),
            ({"name": "omega"}, "name of the motion itself"),
        ]
        for options, words in cases:
            with pytest.raises((PolhodeError, ValueError), match=words):
                one(**(good | options))
        for arguments, words in (
            ((PAIR[0], [(0, 0, 0), (0, 1, 0)], FORCE), "directions must not be the zero vector"),
            ((PAIR[0], [(0, 1, 0)], FORCE), "directions: expected one for each of the 2 thrusters"),
            ((PAIR[0], PAIR[1], -0.1), "forces must be positive"),
            ((PAIR[0], PAIR[1], (0.1, 0.0)), "forces must be positive"),
            ((PAIR[0], PAIR[1], (0.1, 0.2, 0.3)), "forces: expected one number, or one for each of the 2"),
            ((np.zeros((26, 3)), np.ones((26, 3)), 1), "from 1 to 25 thrusters, got 26"),
            (([(np.nan, 0, 0), (0, 0, 0)], PAIR[1], FORCE), "positions must be finite"),
        ):
            with pytest.raises((PolhodeError, ValueError), match=words):
                loads.thrusters(*arguments, command=np.zeros(len(arguments[0])), period=1.0)
        with pytest.raises(TypeError, match="a load asks for a torque, not for duties"):
            one(command=loads.feedback(1, 1))
        with pytest.raises(TypeError, match="times: not beside a function"):
            one(command=Law(BODY), times=[0, 1])
        with pytest.raises(PolhodeError, match="a motor exerts a torque alone"):
            loads.wheel((0, 0, 1), 0.1, torque=one(**good))
        for change in (lambda load: 2 * load, lambda load: loads.schedule(load, [(0, 1)])):
            with pytest.raises(PolhodeError, match="states"):
                change(one(**good))

    def test_refused_in_a_run(self) -> None:
        with pytest.raises(ValueError, match="a load with thrusters cannot go backward in time"):
            PLAIN.simulate([0, -1], (0, 0, 0), load=one(command=[0.5, 0]))
        with pytest.raises(PolhodeError, match="command"):
            PLAIN.simulate([0, 1], (0, 0, 0), load=one(command=[[0.5, 0]], times=[0.5]))
        with pytest.raises(ValueError, match="expected 2, as many as there are thrusters, got 1"):
            PLAIN.simulate([0, 1], (0, 0, 0), load=one(command=lambda *_: [0.5]))
        with pytest.raises(
            PolhodeError, match="duties that command returned must be finite, got NaN at t = 0"
        ):
            PLAIN.simulate([0, 1], (0, 0, 0), load=one(command=lambda *_: [np.nan, 0]))

        def breaks(*_: Any) -> Any:
            raise KeyError("sensor")

        with pytest.raises(KeyError, match="sensor"):
            PLAIN.simulate([0, 1], (0, 0, 0), load=one(command=breaks))


def test_how_a_motion_depends_on_thrusters() -> None:
    """By differences: with the thrust of one pulse the rate is r F t/I."""
    load = one(command=[0.25, 0.0])
    run = PLAIN.simulate([0, 0.9, 2.6], (0, 0, 0), load=load, rtol=1e-12)
    by = run.sensitivity(method="differences").load[0]
    assert by["forces"][1, 5] == pytest.approx(ARM * 0.25 / I3, abs=1e-9)
    assert by["command"][2, 5, 0] == pytest.approx(3 * ARM * FORCE / I3, abs=1e-9)
