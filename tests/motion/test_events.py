"""Events, resumption, statuses and reports of a run."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from polhode import Event, RigidBody, Trajectory, loads, solids
from polhode.errors import IntegrationError

BALL = RigidBody(1.0, np.eye(3))
BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))


def angle(_t: float, _omega: Any, quaternion: Any, *_: Any) -> float:
    """Zero at each half turn of a ball that turns about z: sin of the angle."""
    return float(2 * quaternion[2] * quaternion[3])


class TestEvents:
    def test_times_of_a_steady_turn(self) -> None:
        rate = 0.7
        motion = BALL.simulate([0, 30], (0, 0, rate), events=[angle], rtol=3e-15)
        want = np.pi / rate * np.arange(1, len(motion.events.t) + 1)
        assert len(want) == 6
        assert np.abs(motion.events.t - want).max() < 1e-13 * 30
        assert np.array_equal(motion.events.event, np.zeros(6))
        assert np.array_equal(motion.events.row, np.zeros(6))
        assert np.abs(motion.events.omega - (0, 0, rate)).max() == 0.0
        assert np.abs([angle(0, 0, q) for q in motion.events.quaternion]).max() < 1e-13

    @pytest.mark.parametrize("direction", [1, -1, 0])
    @pytest.mark.parametrize("forward", [True, False])
    def test_direction_is_in_time(self, direction: int, forward: bool) -> None:
        event = Event(lambda t, *_: np.sin(t), direction=direction)
        times = [0.5, 20.0] if forward else [20.0, 0.5]
        found = BALL.simulate(times, (0, 0, 1), events=event).events.t
        zeros = np.pi * np.arange(1, 7)
        rising = np.arange(1, 7) % 2 == 0
        want = zeros if direction == 0 else zeros[rising] if direction > 0 else zeros[~rising]
        want = want if forward else want[::-1]
        assert np.abs(found - want).max() < 1e-14 * 20

    def test_terminal_events_end_the_run(self) -> None:
        event = Event(angle, terminal=2)
        t = np.linspace(0, 10, 101)
        motion = BALL.simulate(t, (0, 0, 1), events=[event, lambda t, *_: t - 1.0])
        assert motion.status == "event"
        assert motion.events.event.tolist() == [1, 0, 0]
        end = motion.events.t[-1]
        assert end == pytest.approx(2 * np.pi, abs=1e-8)
        assert np.isfinite(motion.omega[t <= end]).all()
        assert np.isnan(motion.omega[t > end]).all()
        assert np.isnan(motion.position[t > end]).all()

    def test_scipys_attributes_are_read(self) -> None:
        def falls(_t: float, omega: Any, *_: Any) -> float:
            return float(omega[1])

        event: Any = falls
        event.terminal, event.direction = True, -1.0
        motion = BODY.simulate([0, 200], (1e-3, 1.0, 1e-3), events=event)
        assert len(motion.events.t) == 1

    def test_a_zero_on_a_step_s_end_counts_once(self) -> None:
        windows = [(1.0, 2.0)]
        load = loads.schedule(loads.constant_torque((0, 0, 1.0)), windows)
        found = BALL.simulate([0, 3], (0, 0, 1), load=load, events=lambda t, *_: t - 1.0).events.t
        assert found.tolist() == [1.0]
        assert BALL.simulate([0, 3], (0, 0, 1), events=lambda t, *_: t).events.t.tolist() == []

    def test_in_stacks_each_row_has_its_own(self) -> None:
        rates = np.array([0.5, 1.0, 2.0])[:, None] * (0, 0, 1)
        motion = BALL.simulate([0, 10], rates, events=Event(angle, terminal=3))
        assert motion.events.row.tolist() == [0, 1, 1, 1, 2, 2, 2]
        assert motion.status.tolist() == ["complete", "event", "event"]
        want = np.pi * np.array([2, 1, 2, 3, 0.5, 1, 1.5])
        assert np.abs(motion.events.t - want).max() < 1e-8

    def test_the_floor_is_hit_when_it_is(self) -> None:
        drop = solids.sphere(0.1, mass=1.0)
        floor = Event(lambda _t, _w, _q, position, _v: position[2], terminal=True)
        fall = drop.simulate(
            [0, 10], (0, 0, 1), position=(0, 0, 5.0), load=loads.uniform_gravity((0, 0, -9.81)), events=floor
        )
        assert fall.events.t[0] == pytest.approx(np.sqrt(2 * 5 / 9.81), rel=1e-14)
        assert abs(fall.events.position[0, 2]) < 1e-14

    LOADS = (
        loads.constant_torque((0.1, 0.0, 0.2)) + loads.damping(0.1, 0.02),
        loads.schedule(loads.constant_torque((0.3, 0.1, 0.0), "space"), [(1.0, 2.5), (4.0, 5.0)]),
        loads.feedback(2.0, 0.3),
        loads.uniform_gravity((0, 0, -1.0))
        + loads.constant_force((0.3, 0.2, 0.1), "body", point=(0.1, 0, 0)),
        loads.sampled(np.linspace(0, 8, 9), np.cos(np.arange(27.0)).reshape(9, 3), "body"),
        loads.gravity_gradient(1.0, (1, 0, 0), (0, 1, 0)),
    )

    @pytest.mark.parametrize("load", LOADS)
    @pytest.mark.parametrize("t", [np.linspace(0, 8, 33), np.linspace(7.5, 0.5, 5)])
    def test_along_taylor_series(self, load: Any, t: Any) -> None:
        """They leave the samples as they are, and lie where DOP853 sees them."""
        events = [
            Event(lambda _t, omega, *_: omega[1] - 0.1),
            Event(lambda _t, _omega, q, *_: 2 * (q[0] * q[3] + q[1] * q[2])),
            Event(lambda _t, _w, _q, position, velocity: position[2] + velocity[0]),
        ]
        start: dict[str, Any] = {"omega": (3.0, 1.2, -2.4), "velocity": (0.1, 0.0, 0.2), "load": load}
        run = BODY.simulate(t, events=events, method="taylor", rtol=1e-13, **start)
        plain = BODY.simulate(t, method="taylor", rtol=1e-13, **start)
        assert np.array_equal(run.omega, plain.omega)
        assert np.array_equal(run.quaternion, plain.quaternion)
        assert np.array_equal(run.position, plain.position)
        assert run.steps == plain.steps
        other = BODY.simulate(t, events=events, method="dop853", rtol=1e-13, **start)
        assert np.array_equal(run.events.event, other.events.event)
        assert len(run.events.t) >= 3
        for ours, theirs in zip(run.events[2:], other.events[2:], strict=True):
            assert np.abs(ours - theirs).max() < 1e-9
        auto = BODY.simulate(t, events=events, rtol=1e-13, **start)
        assert np.array_equal(auto.events.t, run.events.t)

    def test_a_terminal_event_along_taylor_series(self) -> None:
        t = np.linspace(0, 20, 201)
        load = loads.damping(0.05)
        event = Event(lambda _t, omega, *_: omega[1], terminal=2)
        run = BODY.simulate(t, (3.0, 1.2, -2.4), load=load, events=event)
        end = run.events.t[-1]
        assert run.status == "event"
        assert len(run.events.t) == 2
        assert np.isfinite(run.omega[t <= end]).all()
        assert np.isnan(run.quaternion[t > end]).all()
        plain = BODY.simulate(t, (3.0, 1.2, -2.4), load=load)
        assert np.array_equal(run.omega[t <= end], plain.omega[t <= end])
        on_time = Event(lambda t, *_: t - 3.0, terminal=True)
        run = BODY.simulate(t, (3.0, 1.2, -2.4), load=load, events=on_time)
        assert np.isnan(run.omega[:, 0]).tolist() == (t > 3.0).tolist()

    def test_an_exception_along_taylor_series(self) -> None:
        error = ZeroDivisionError("mine")

        def fail(t: float, *_: Any) -> float:
            if t > 3:
                raise error
            return 1.0

        with pytest.raises(ZeroDivisionError) as caught:
            BODY.simulate([0, 10], (1.0, 0.4, -0.8), load=loads.damping(0.05), events=fail)
        assert caught.value is error

    @pytest.mark.parametrize("method", ["taylor", "dop853", "radau"])
    @pytest.mark.parametrize("share", [0.01, 0.3, 0.99])
    def test_a_run_that_is_refused_has_those_of_its_steps(self, method: Any, share: float) -> None:
        options: Any = {"events": [lambda _t, omega, *_: omega[0]], "method": method, "rtol": 1e-6}
        times, start = np.linspace(0.0, 60.0, 21), (0.3, 0.2, 1.1)
        whole = BODY.simulate(times, start, **options)
        most = max(1, int(share * int(whole.steps)))
        part = BODY.simulate(times, start, **options, max_steps=most, on_failure="keep")
        assert (str(whole.status), str(part.status)) == ("complete", "failed")
        samples, events = np.isfinite(part.omega[:, 0]).sum(), len(part.events.t)
        assert samples < len(times)
        assert np.array_equal(part.omega[:samples], whole.omega[:samples])
        assert np.array_equal(part.events.t, whole.events.t[:events])
        # None is missing before the last sample; none lies beyond the next one, which no step has reached.
        assert (whole.events.t < times[samples - 1]).sum() <= events
        assert not events or part.events.t[-1] < times[samples]

    def test_ctrl_c_along_taylor_series(self) -> None:
        def interrupt(fraction: float) -> None:
            if fraction > 0.001:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt) as caught:
            BODY.simulate(
                np.linspace(0, 1e6, 1001),
                (1, 0.2, 1),
                progress=interrupt,
                load=loads.constant_torque((0, 0, 1e-9)),
                events=lambda t, *_: t + 1.0,
            )
        interrupted: Any = caught.value
        partial = interrupted.partial
        assert partial.status == "stopped"
        assert np.isfinite(partial.omega[1]).all()
        assert np.isnan(partial.omega[-1]).all()

    @pytest.mark.parametrize("method", ["exact", "taylor", "dop853", "radau", "splitting"])
    def test_a_narrow_peak_is_found(self, method: Any) -> None:
        """A function that is flat but for a peak with corners, a quarter of a radian of rotation wide."""
        half = 0.125

        def peak(t: float, *_: Any, middle: float) -> float:
            return max(-1e-3, half - abs(t - middle))

        rng = np.random.default_rng(7)
        for _ in range(40):
            middle, omega = rng.uniform(1.0, 9.0), rng.normal(size=3)
            omega /= np.linalg.norm(omega)
            rtol = 10.0 ** rng.uniform(-9, -6)
            run = BODY.simulate(
                [0, 10],
                omega,
                events=partial(peak, middle=middle),
                method=method,
                rtol=rtol,
            )
            assert run.events.t == pytest.approx([middle - half, middle + half], abs=1e-9)

    @pytest.mark.parametrize("method", ["exact", "taylor", "dop853", "splitting"])
    def test_steps_of_many_turns_are_looked_through(self, method: Any) -> None:
        """Without a load steps of `splitting` have many turns: every zero of ω₁ is found all the same."""
        omega = (0.4, 0.1, 1.0)
        period = BODY.free_motion(omega).periods.rotation
        run = BODY.simulate([0, 300 * period], omega, events=lambda _, w, *__: w[0], method=method)
        assert len(run.events.t) == 600
        assert np.diff(run.events.t) == pytest.approx(0.5 * period, rel=1e-6)

    def test_mistakes(self) -> None:
        def run(events: Any) -> Trajectory:
            return BALL.simulate([0, 10], (0, 0, 1), events=events)

        with pytest.raises(TypeError, match="events: expected a function or a sequence"):
            run(3)
        with pytest.raises(TypeError, match="event 1 is no function"):
            run([angle, "angle"])
        with pytest.raises(TypeError, match="event 0 must return a number"):
            run(lambda *_: "x")
        with pytest.raises(ValueError, match="terminal of event 0"):
            run(Event(angle, terminal=-1))
        with pytest.raises(ValueError, match="direction of event 0"):
            run(Event(angle, direction=np.nan))
        error = ZeroDivisionError("mine")

        def fail(t: float, *_: Any) -> float:
            if t > 3:
                raise error
            return 1.0

        with pytest.raises(ZeroDivisionError) as caught:
            run(fail)
        assert caught.value is error


class TestResume:
    def test_a_run_in_two_parts_is_the_run(self) -> None:
        load = loads.damping(0.05) + loads.uniform_gravity((0, 0, -1.0))
        options: dict[str, Any] = {"load": load, "rtol": 1e-13}
        whole = BODY.simulate([0, 3, 8], (1, 0.5, 0.2), velocity=(1, 0, 0), **options)
        half = BODY.simulate([0, 3], (1, 0.5, 0.2), velocity=(1, 0, 0), **options)
        rest = half.resume([3, 8], rtol=1e-13)
        for name in ("omega", "quaternion", "position", "velocity"):
            assert np.abs(getattr(rest, name)[-1] - getattr(whole, name)[-1]).max() < 1e-11
        again = BODY.simulate([3, 8], **half.state()._asdict(), load=load, rtol=1e-13)
        assert np.array_equal(again.omega, rest.omega)
        with pytest.raises(ValueError, match=r"goes on from t = 3\.0"):
            half.resume([4, 8])

    def test_pivoted_bodies_and_stacks(self) -> None:
        top = solids.cone(0.4, 1.0, mass=2.0).translated((0, 0, 0.75))
        load = loads.uniform_gravity((0, 0, -9.81))
        starts = np.array([(0.1, 0.0, 30.0), (0.0, 0.2, 20.0)])
        half = top.simulate([0, 1], starts, load=load, about="origin", rtol=1e-13)
        whole = top.simulate([0, 1, 2], starts, load=load, about="origin", rtol=1e-13)
        assert np.abs(half.resume([1, 2], rtol=1e-13).omega[:, -1] - whole.omega[:, -1]).max() < 1e-9


class TestFailures:
    LOAD = loads.torque_callback(lambda _t, w, _q: (0.0, 0.0, w[2] ** 2))
    STARTS = np.array([[0, 0, 0.1], [0, 0, 0.5], [0, 0, 0.2]])

    def test_rows_that_fail_are_kept(self) -> None:
        """ω̇ = ω² has a pole at 1/ω₀."""
        motion = BALL.simulate([0.0, 1.0, 3.0], self.STARTS, load=self.LOAD, on_failure="keep")
        assert motion.status.tolist() == ["complete", "failed", "complete"]
        assert motion.omega[0, :, 2] == pytest.approx([0.1, 1 / 9, 1 / 7], rel=1e-8)
        assert motion.omega[2, :, 2] == pytest.approx([0.2, 1 / 4, 1 / 2], rel=1e-8)
        assert np.isnan(motion.omega[1, 2]).all()
        (failure,) = motion.failures
        assert isinstance(failure, IntegrationError)
        assert failure.row == 1
        assert failure.time == pytest.approx(2.0, abs=1e-6)
        assert "row 1" in str(failure)

    def test_or_raise(self) -> None:
        with pytest.raises(IntegrationError, match="row 1") as caught:
            BALL.simulate([0.0, 1.0, 3.0], self.STARTS, load=self.LOAD)
        assert caught.value.partial is not None
        assert caught.value.partial.status.tolist() == ["complete", "failed", "not run"]
        unknown: Any = "ignore"
        with pytest.raises(ValueError, match="on_failure"):
            BALL.simulate([0, 1], (0, 0, 1), on_failure=unknown)

    def test_an_interrupted_run_keeps_what_it_has(self) -> None:
        def interrupt(fraction: float) -> None:
            if fraction > 0.001:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt) as caught:
            BODY.simulate(np.linspace(0, 1e7, 1001), (1, 0.2, 1), progress=interrupt, method="dop853")
        interrupted: Any = caught.value
        partial = interrupted.partial
        assert partial.status == "stopped"
        assert np.isfinite(partial.omega[1]).all()
        assert np.isnan(partial.omega[-1]).all()


class TestReports:
    def test_pivot_reaction_counts_the_weight_in_the_load(self) -> None:
        bob = solids.sphere(0.1, mass=2.0).translated((0, 0, -1.0))
        weight = loads.uniform_gravity((0, 0, -9.81))
        hanging = bob.simulate([0, 1], (0, 0, 0), load=weight, about="origin")
        assert np.abs(hanging.pivot_reaction() - (0, 0, 2 * 9.81)).max() < 1e-14
        swinging = bob.simulate(np.linspace(0, 1, 5), (2.0, 0, 0), load=weight, about="origin", rtol=1e-13)
        torque = loads.torque_callback(lambda t, w, q: weight.torque(t, w, q, body=bob, about="origin"))
        other = bob.simulate(swinging.t, (2.0, 0, 0), load=torque, about="origin", rtol=1e-13)
        want = other.pivot_reaction(gravity=(0, 0, -9.81))
        assert np.abs(swinging.pivot_reaction() - want).max() < 1e-9

    def test_unwrapped_angles_run_on(self) -> None:
        motion = BALL.simulate(np.linspace(0, 50, 201), (0, 0, 1), (0.6, 0, 0, 0.8))
        angles = motion.euler_angles(unwrap=True)
        assert np.abs(np.diff(angles[:, 2]) - 0.25).max() < 1e-9
        upright = BALL.simulate(np.linspace(0, 50, 201), (0.3, 0, 0))
        masked = upright.euler_angles(singular="nan", unwrap=True)
        assert np.isnan(masked[0]).any()
        assert np.isfinite(masked[1:]).all()

    def test_energies_of_a_thrown_body(self) -> None:
        weight = loads.uniform_gravity((0, 0, -9.81))
        motion = BODY.simulate(
            np.linspace(0, 2, 9), (1, 0.3, 0.2), load=weight, velocity=(3, 0, 4), rtol=1e-13
        )
        total = motion.kinetic_energy().total + motion.potential_energy()
        assert np.abs(total - total[0]).max() < 1e-11
        kept = motion.invariants()
        assert kept.energy_drift < 1e-12
        assert kept.angular_momentum_drift < 1e-11
        damped = BODY.simulate([0, 1], (1, 0, 0), load=loads.damping(0.1))
        assert damped.invariants().energy is None
        assert damped.invariants().angular_momentum is None
        with pytest.raises(ValueError, match="no potential"):
            damped.potential_energy()

    def test_drift_of_stacks_and_of_rest(self) -> None:
        motion = BODY.simulate([0, 1, 2], np.zeros((2, 3)))
        kept = motion.invariants()
        assert kept.energy_drift.tolist() == [0.0, 0.0]
        top = solids.cone(0.4, 1.0, mass=2.0).translated((0, 0, 0.75))
        load = loads.uniform_gravity(np.array([[0, 0, -9.81], [0, 1.0, -9.81]]))
        spun = top.simulate(
            np.linspace(0, 2, 5), (0.1, 0.2, 20.0), load=load, about="origin", rtol=1e-13
        ).invariants()
        assert spun.angular_momentum is not None
        assert spun.angular_momentum.shape == (2, 5)
        assert (spun.angular_momentum_drift < 1e-11).all()
        assert (spun.energy_drift < 1e-11).all()
