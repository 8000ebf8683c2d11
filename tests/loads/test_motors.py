"""Motors of wheels: any controller, limits, and the allocation of a torque to a set of wheels."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from oracles.wheels import ATTITUDE, BODY, OMEGA, T, by_scipy, of_wheels
from polhode import Event, RigidBody, loads
from polhode.errors import PolhodeError

AXES = np.array([(1.0, 2.0, -2.0), (0.0, 1.0, 1.0), (3.0, 0.0, 4.0)])
UNIT = AXES / np.linalg.norm(AXES, axis=1, keepdims=True)
J = np.array([0.2, 0.15, 0.1])
NONE = np.zeros(3)

PLAIN = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
I3, J3 = 2.5, 0.5
LESS = I3 - J3  # the moment of the body without its wheel
PYRAMID = np.array([(1.0, 0.0, 1.0), (0.0, 1.0, 1.0), (-1.0, 0.0, 1.0), (0.0, -1.0, 1.0)])


def set_of(control: Any, **options: Any) -> Any:
    return sum(
        loads.wheel(axis, inertia, torque=control, **options) for axis, inertia in zip(AXES, J, strict=True)
    )


def one(**options: Any) -> Any:
    return loads.wheel((0, 0, 1), J3, **options)


class Held:
    """A controller that looks at the rate once in each period, and counts how often."""

    def __init__(self, gain: float) -> None:
        self.gain, self.count = gain, 0

    def update(self, _t: float, omega: Any, *_: Any) -> Any:
        self.count += 1
        return -self.gain * omega

    def wrench(self, *arguments: Any) -> tuple[Any, Any]:
        return (0, 0, 0), arguments[-1]["law"]

    def load(self, period: float = 1.0) -> loads.Load:
        return loads.with_states(None, NONE, self.wrench, "law", update=self.update, period=period)


def pull(_t: float, omega: Any, q: Any) -> Any:
    return -np.sign(q[3]) * 2.0 * q[:3] - 1.5 * omega


class TestAnyController:
    FEEDBACK = loads.feedback(K=2.0, D=1.5)

    def run(self, control: Any, **options: Any) -> Any:
        return BODY.simulate(T, OMEGA, ATTITUDE, load=set_of(control, **options), rtol=1e-12)

    @pytest.mark.parametrize(
        "control",
        [
            loads.torque_callback(pull),
            loads.callback(lambda t, w, q, *_: ((0, 0, 0), pull(t, w, q))),
            loads.feedback(K=2.0, D=0.5) + loads.damping(1.0),
            0.5 * loads.feedback(K=1.0, D=1.0)
            + loads.torque_callback(lambda t, w, q: pull(t, w, q) * 0.75)
            + loads.damping(-0.125),
            loads.schedule(loads.feedback(K=2.0, D=1.5), [(-1.0, 20.0)]),
            loads.with_states(None, [0.0], lambda t, w, q, *_: ((0, 0, 0), pull(t, w, q)), "law"),
        ],
    )
    def test_the_same_law_in_every_form(self, control: Any) -> None:
        want, got = self.run(self.FEEDBACK), self.run(control)
        if "law" in repr(got.states):
            assert got.states["law"].shape == (len(T), 1)
        assert np.abs(got.omega - want.omega).max() < 3e-9
        for name in ("wheel", "wheel_2", "wheel_3"):
            assert np.abs(got.states[name] - want.states[name]).max() < 3e-9
        kept = got.invariants()
        assert kept.angular_momentum_drift < 1e-10
        # Outside a run the load exerts the same.
        torque = got.load.torque(T[0], OMEGA, ATTITUDE, body=BODY, states=got.state(0).states)
        right = want.load.torque(T[0], OMEGA, ATTITUDE, body=BODY, states=want.state(0).states)
        assert np.abs(torque - right).max() < 1e-12

    def test_against_scipy(self) -> None:
        def torque(t: float, q: np.ndarray, w: np.ndarray) -> Any:
            on_body = pull(t, w, q) + np.array([0.3 * np.sin(2 * t), 0.0, 0.1])
            return np.clip(-UNIT @ on_body, -0.8, 0.8)

        exact = by_scipy(of_wheels(UNIT, J, NONE, torque), [0.0, 0.0, 0.0], [0.0, 15.0])
        control = (
            self.FEEDBACK
            + loads.torque_callback(lambda t, *_: (0.3 * np.sin(2 * t), 0, 0))
            + loads.constant_torque((0, 0, 0.1))
        )
        run = self.run(control, max_torque=0.8)
        assert np.abs(run.omega - exact[:, 4:7]).max() < 1e-8

    def test_modes_by_schedules(self) -> None:
        """Detumble for 3 s, then point: two feedbacks, each with a sign of its own."""
        control = loads.schedule(loads.damping(1.5), [(0.0, 3.0)]) + loads.schedule(
            loads.feedback(K=2.0, D=1.5, target=(0, 0, 1, 0)), [(3.0, 99.0)]
        )
        first = BODY.simulate([0, 3], OMEGA, ATTITUDE, load=set_of(loads.damping(1.5)), rtol=1e-12)
        pointed = set_of(loads.feedback(K=2.0, D=1.5, target=(0, 0, 1, 0)))
        second = first.resume([3, 15], load=pointed, rtol=1e-12)
        run = self.run(control)
        assert np.abs(run.omega[-1] - second.omega[-1]).max() < 1e-9

    def test_a_sampled_controller(self) -> None:
        """Each second it holds −g ω on the body: ω goes down by the factor 1 − g/(I − J)."""
        law = Held(0.5)
        run = PLAIN.simulate(np.arange(6.0), (0, 0, 1), load=one(torque=law.load()))
        exact = (1 - 0.5 / LESS) ** np.arange(6.0)
        assert run.omega[:, 2] == pytest.approx(exact, abs=1e-12)
        momentum = I3 * 1.0 - (I3 - J3) * exact - J3 * 0.0
        assert run.states["wheel"][:, 0] == pytest.approx(momentum - 0.0, abs=1e-12)
        assert run.states["law"][1:, 2] == pytest.approx(-0.5 * run.omega[:-1, 2], abs=1e-12)
        part = PLAIN.simulate([0, 2.5], (0, 0, 1), load=one(torque=law.load()))
        assert part.resume([2.5, 5]).omega[-1, 2] == pytest.approx(exact[-1], abs=1e-12)
        step = PLAIN.stepper((0, 0, 1), load=one(torque=law.load()))
        for _ in range(10):
            step.step(0.5)
        assert step.state().omega[2] == pytest.approx(exact[-1], abs=1e-12)

    def test_a_sampled_controller_that_saturates(self) -> None:
        limit = 0.3
        events = Event.limit("wheel")
        load = one(torque=Held(0.5).load(), max_torque=limit)
        run = PLAIN.simulate(np.arange(9.0), (0, 0, 1), load=load, events=events)
        exact = [1.0]
        for _ in range(8):
            exact.append(exact[-1] - min(limit, 0.5 * exact[-1]) / LESS)
        assert run.omega[:, 2] == pytest.approx(exact, abs=1e-12)
        # It ceases to saturate at the update at which 0.5 ω is below the limit first.
        ends = next(k for k, rate in enumerate(exact) if 0.5 * rate < limit)
        assert run.events.t[-1] == pytest.approx(ends, abs=1e-12)

    def test_one_object_is_one_controller(self) -> None:
        law = Held(0.2)
        control = law.load()
        run = BODY.simulate([0.0, 4.5], OMEGA, load=set_of(control))
        assert law.count == 5
        assert sorted(run.states) == ["law", "wheel", "wheel_2", "wheel_3"]
        law.count = 0
        run.resume([4.5, 6.5])
        assert law.count == 2
        law.count = 0
        apart: Any = sum(loads.wheel(a, j, torque=law.load()) for a, j in zip(AXES, J, strict=True))
        separate = BODY.simulate([0.0, 4.5], OMEGA, load=apart)
        assert law.count == 15
        assert sorted(separate.states)[:3] == ["law", "law_2", "law_3"]
        assert np.abs(separate.omega - run.omega).max() < 1e-12

    def test_pickles(self) -> None:
        control = self.FEEDBACK + loads.torque_callback(pull)
        load = set_of(control)
        again = pickle.loads(pickle.dumps(load))
        runs = [BODY.simulate([0, 2], OMEGA, ATTITUDE, load=one) for one in (load, again)]
        assert np.array_equal(runs[0].omega, runs[1].omega)
        wheel = pickle.loads(pickle.dumps(one(torque=control, max_torque=0.5, max_rate=3.0)))
        assert (wheel.max_torque, wheel.max_rate, wheel.max_momentum) == (0.5, 3.0, None)
        assert repr(wheel.motor) == repr(control)

    def test_stacks(self) -> None:
        control = loads.feedback([1.0 * np.eye(3), 2.0 * np.eye(3)], 0.5) + loads.torque_callback(pull)
        load = one(torque=control)
        assert load.shape == (2,)
        runs = BODY.simulate([0, 2], OMEGA, ATTITUDE, load=load)
        for k in range(2):
            alone = BODY.simulate([0, 2], OMEGA, ATTITUDE, load=load[k])
            assert np.array_equal(runs.omega[k], alone.omega)

    def test_an_exception_of_a_controller(self) -> None:
        def breaks(*_: Any) -> Any:
            raise KeyError("sensor")

        with pytest.raises(KeyError, match="sensor"):
            PLAIN.simulate([0, 1], (0, 0, 1), load=one(torque=loads.torque_callback(breaks)))

    def test_what_is_no_controller(self) -> None:
        for other in (loads.wheel((0, 0, 1), 0.1), loads.slug(0.1, 0.1), loads.uniform_gravity((0, 0, 1))):
            with pytest.raises(
                PolhodeError, match=r"a motor exerts a torque alone, .* give torque= the controller alone"
            ):
                one(torque=other)
        pushes = loads.callback(lambda *_: ((0, 0, 1.5), (0, 0, 0)))
        with pytest.raises(ValueError, match=r"its controller asks for the force \[0\.0, 0\.0, 1\.5\] at t"):
            PLAIN.simulate([0, 1], (0, 0, 1), load=one(torque=pushes))
        with pytest.raises(TypeError, match="times: not beside a controller"):
            one(torque=self.FEEDBACK, times=[0, 1])
        with pytest.raises(PolhodeError, match="taylor"):
            PLAIN.simulate([0, 1], (0, 0, 1), load=one(torque=self.FEEDBACK + self.FEEDBACK), method="taylor")


class TestLimits:
    RATE = 1 / J3 + 1 / LESS  # Ω̇ = τ (1/J + 1/(I − J)) about one axis

    def test_a_given_torque_is_clipped(self) -> None:
        table = one(torque=[1.0, -0.2, -3.0], times=[0.0, 1.0, 2.5], max_torque=0.5)
        run = PLAIN.simulate([0, 1, 2.5, 4], (0, 0, 0), load=table)
        assert run.states["wheel"][:, 0] == pytest.approx([0.0, 0.5, 0.2, -0.55], abs=1e-14)
        found = PLAIN.simulate([0, 4], (0, 0, 0), load=table, events=Event.limit()).events
        assert found.t == pytest.approx([1.0, 2.5], abs=1e-12)
        constant = PLAIN.simulate([0, 4], (0, 0, 0), load=one(torque=-3.0, max_torque=0.5))
        assert constant.states["wheel"][-1, 0] == pytest.approx(-2.0, abs=1e-14)
        # Both sides of the threshold.
        for most, clipped in ((0.5, 0.5), (np.nextafter(0.6, 0), 0.6), (0.6, 0.6), (7.0, 0.6)):
            run = PLAIN.simulate([0, 1], (0, 0, 0), load=one(torque=0.6, max_torque=most))
            assert run.states["wheel"][-1, 0] == pytest.approx(clipped, abs=1e-15)

    @pytest.mark.parametrize("sign", [1.0, -1.0])
    @pytest.mark.parametrize(
        "given", [{"max_rate": 2.0}, {"max_momentum": 1.0}, {"max_rate": 2.0, "max_momentum": 9.0}]
    )
    def test_the_limit_of_a_rate(self, sign: float, given: dict[str, float]) -> None:
        """It comes there at 2/Ω̇, and leaves when the torque changes its sign."""
        torque, turn = 0.1 * sign, 12.0
        load = one(torque=[torque, -torque], times=[0.0, turn], **given)
        events = [Event.rate_limit(), Event.momentum_limit(direction=1), Event.rate_limit(direction=-1)]
        t = np.array([0, 4, 10, 12, 14.0])
        run = PLAIN.simulate(t, (0, 0, 0), load=load, events=events)
        reach = 2.0 / (0.1 * self.RATE)
        rate = run.states["wheel"][:, 0] / J3 - run.omega[:, 2]
        exact = sign * np.array([0, 0.4 * self.RATE, 2, 2, 2 - 0.2 * self.RATE])
        assert rate == pytest.approx(exact, abs=1e-12)
        assert run.omega[2:4, 2] == pytest.approx(-torque * reach / LESS, abs=1e-12)
        for event, times in enumerate(([reach, turn], [reach], [turn])):
            assert run.events.t[run.events.event == event] == pytest.approx(times, abs=1e-12)
        assert run.angular_momentum().spin == pytest.approx(0.0, abs=1e-13)

    def test_with_friction_it_holds_and_leaves(self) -> None:
        """The motor keeps the rate against c Ω; when it is asked for less, Ω decays to τ/c."""
        friction, most = 0.02, 2.0
        load = one(torque=[0.1, 0.02], times=[0.0, 12.0], friction=friction, max_rate=most)
        run = PLAIN.simulate([0, 11, 12, 15], (0, 0, 0), load=load, events=Event.rate_limit(), rtol=1e-13)
        decay = friction * self.RATE
        reach = -np.log(1 - most * friction / 0.1) / decay
        assert run.events.t == pytest.approx([reach, 12.0], abs=1e-11)
        rate = run.states["wheel"][:, 0] / J3 - run.omega[:, 2]
        last = 1.0 + (most - 1.0) * np.exp(-3 * decay)
        assert rate == pytest.approx([0, most, most, last], abs=1e-12)

    def test_a_demand_that_falls(self) -> None:
        """τ = 0.5 cos t: at the limit from where 0.5 sin t (1/J + 1/(I − J)) is the limit, until t = π/2."""
        load = one(torque=loads.torque_callback(lambda t, *_: (0, 0, -0.5 * np.cos(t))), max_rate=0.5)
        run = PLAIN.simulate([0, 2.5, 3.0], (0, 0, 0), load=load, events=Event.rate_limit(), rtol=1e-13)
        reach = np.arcsin(0.5 / (0.5 * self.RATE))
        other = np.pi - np.arcsin(1 - 1 / (0.5 * self.RATE))
        assert run.events.t == pytest.approx([reach, np.pi / 2, other], abs=1e-12)
        rate = run.states["wheel"][:, 0] / J3 - run.omega[:, 2]
        assert rate == pytest.approx([0, 0.5 + 0.5 * (np.sin(2.5) - 1) * self.RATE, -0.5], abs=1e-12)

    def test_a_torque_on_the_body_turns_both(self) -> None:
        """At its limit the wheel turns with the body: ω̇ = N/I."""
        load = one(rate=2.0, torque=5.0, max_rate=2.0) + loads.constant_torque((0, 0, 0.3))
        run = PLAIN.simulate([0, 2], (0, 0, 0), load=load)
        assert run.omega[-1, 2] == pytest.approx(0.6 / I3, abs=1e-13)
        assert run.states["wheel"][-1, 0] == pytest.approx(J3 * (2.0 + 0.6 / I3), abs=1e-13)

    def test_in_space_against_scipy(self) -> None:
        """Three wheels, one of which comes to its limit: then it is held, by a matrix without it."""
        from scipy.integrate import solve_ivp

        torques, most = np.array([0.3, -0.1, 0.05]), 1.2
        free = of_wheels(UNIT, J, NONE, lambda *_: torques)

        def held(t: float, y: np.ndarray) -> Any:
            # The torque of the first motor is the one with Ω̇ = 0: the rates are linear in it.
            some = [of_wheels(UNIT, J, NONE, lambda *_, k=k: torques * (k, 1, 1))(t, y) for k in (0.0, 1.0)]
            share = -some[0][7] / (some[1][7] - some[0][7])
            return some[0] + share * (some[1] - some[0])

        def limit(_t: float, y: np.ndarray) -> Any:
            return y[7] - most

        stop: Any = limit
        stop.terminal = True
        exact: Any = {"method": "DOP853", "rtol": 3e-14, "atol": 1e-14}
        start = np.concatenate([ATTITUDE, OMEGA, NONE])
        one = solve_ivp(free, (0, 15), start, events=stop, **exact)
        two = solve_ivp(held, (one.t[-1], 15), one.y[:, -1], **exact)
        load: Any = sum(
            loads.wheel(axis, j, torque=torque, max_rate=most if k == 0 else None)
            for k, (axis, j, torque) in enumerate(zip(AXES, J, torques, strict=True))
        )
        run = BODY.simulate([0, 15], OMEGA, ATTITUDE, load=load, events=Event.rate_limit(), rtol=1e-13)
        assert len(run.events.t) == 1
        assert run.events.t[0] == pytest.approx(one.t[-1], abs=1e-10)
        assert run.omega[-1] == pytest.approx(two.y[4:7, -1], abs=1e-10)
        axes_rate = [run.states[n][-1, 0] for n in ("wheel", "wheel_2", "wheel_3")] / J - UNIT @ run.omega[-1]
        assert axes_rate == pytest.approx(two.y[7:, -1], abs=1e-10)
        methods: Any = (("radau", 1e-7), ("dop853", 1e-10))
        for method, allowed in methods:
            again = BODY.simulate([0, 15], OMEGA, ATTITUDE, load=load, method=method, rtol=1e-12)
            assert again.omega[-1] == pytest.approx(two.y[4:7, -1], abs=allowed)

    def test_with_dry_friction_it_stops_too(self) -> None:
        """To its limit, held there, then against the friction to rest."""
        load = one(torque=[0.2, 0.0], times=[0.0, 10.0], dry_friction=0.05, max_rate=1.5)
        events = [Event.rate_limit(), Event.stop()]
        run = PLAIN.simulate([0, 40], (0, 0, 0), load=load, events=events)
        reach = 1.5 / (0.15 * self.RATE)
        stop = 10 + 1.5 / (0.05 * self.RATE)
        assert run.events.t == pytest.approx([reach, 10.0, stop], abs=1e-11)
        assert run.events.event.tolist() == [0, 0, 1]
        assert run.omega[-1, 2] == pytest.approx(0.0, abs=1e-13)

    def test_a_terminal_limit_goes_on(self) -> None:
        load = one(torque=0.1, max_rate=2.0)
        stop = Event.rate_limit(terminal=True)
        run = PLAIN.stepper((0, 0, 0), load=load, events=stop)
        run.step(100.0)
        assert run.t == pytest.approx(2.0 / (0.1 * self.RATE), abs=1e-12)
        after = run.step(5.0)
        assert run.trajectory().status == "complete"
        assert after.omega[2] == pytest.approx(-2.0 / self.RATE / LESS, abs=1e-12)

    def test_refused(self) -> None:
        with pytest.raises(PolhodeError, match=r"rate must be within the limit of the wheel"):
            one(rate=2.1, torque=0.1, max_rate=2.0)
        assert one(rate=2.0, torque=0.1, max_rate=2.0).rate == 2.0
        for name in ("max_rate", "max_momentum"):
            with pytest.raises(PolhodeError, match=f"{name} must be positive"):
                one(torque=0.1, **{name: 0.0})
        with pytest.raises(PolhodeError, match="ascending where a wheel has dry friction or a largest rate"):
            PLAIN.simulate([0, -1], (0, 0, 0), load=one(torque=0.1, max_rate=2.0))
        with pytest.raises(ValueError, match=r"Event\.rate_limit asks for a wheel with a largest rate"):
            PLAIN.simulate([0, 1], (0, 0, 0), load=one(torque=0.1), events=Event.rate_limit())
        fast = PLAIN.simulate([0, 1], (0, 0, 0), load=one(rate=3.0, torque=0.1))
        with pytest.raises(ValueError, match=r"a wheel has the rate .* beyond its limit 2\.0"):
            fast.resume([1, 2], load=one(torque=0.1, max_rate=2.0))


class TestAllocation:
    def exerted(self, wheels: Any) -> Any:
        """Return the torque on a body at rest, from the rates of the momenta."""
        run = BODY.simulate([0, 0.5], (0, 0, 0), load=wheels, rtol=1e-13)
        axes = PYRAMID / np.linalg.norm(PYRAMID, axis=1, keepdims=True)
        momenta = np.array([run.states[name][-1, 0] for name in ("wheel", "wheel_2", "wheel_3", "wheel_4")])
        # ḣ = τ as long as the controller asks for a constant torque in the body.
        return -axes.T @ momenta / 0.5, momenta / 0.5

    def test_the_pseudo_inverse(self) -> None:
        torque = np.array([0.3, -0.2, 0.1])
        axes = PYRAMID / np.linalg.norm(PYRAMID, axis=1, keepdims=True)
        control = loads.constant_torque(torque)
        on_body, motors = self.exerted(loads.wheels(PYRAMID, 0.02, torque=control))
        assert on_body == pytest.approx(torque, abs=1e-13)
        assert motors == pytest.approx(-np.linalg.pinv(axes.T) @ torque, abs=1e-13)
        # Wheels that each take their own component exert A Aᵀ N.
        each = sum(loads.wheel(axis, 0.02, torque=control) for axis in PYRAMID)
        assert self.exerted(each)[0] == pytest.approx(axes.T @ axes @ torque, abs=1e-13)

    def test_a_given_one(self) -> None:
        torque = np.array([0.3, -0.2, 0.1])
        axes = PYRAMID / np.linalg.norm(PYRAMID, axis=1, keepdims=True)
        weights = np.diag([1.0, 2.0, 3.0, 4.0])
        rows = weights @ axes @ np.linalg.inv(axes.T @ weights @ axes)
        control = loads.torque_callback(lambda *_: torque)
        on_body, motors = self.exerted(loads.wheels(PYRAMID, 0.02, torque=control, allocation=rows))
        assert on_body == pytest.approx(torque, abs=1e-13)
        assert motors == pytest.approx(-rows @ torque, abs=1e-13)
        for wrong, words in (
            (axes, "A M A must be A"),
            (rows[:3], "a row for each of the 4 wheels"),
            ("best", 'expected "pseudo-inverse" or an array'),
        ):
            with pytest.raises(ValueError, match=words):
                loads.wheels(PYRAMID, 0.02, torque=control, allocation=wrong)
        for off, good in ((1e-7, True), (1e-4, False)):
            given = rows * (1 + off)
            if good:
                loads.wheels(PYRAMID, 0.02, torque=control, allocation=given)
            else:
                with pytest.raises(ValueError, match=r"off by \d"):
                    loads.wheels(PYRAMID, 0.02, torque=control, allocation=given)

    def test_axes_in_a_plane(self) -> None:
        flat = np.array([(1.0, 0, 0), (0, 1.0, 0), (1.0, 1.0, 0)])
        load = loads.wheels(flat, 0.02, torque=loads.constant_torque((0.2, 0.1, 0.5)))
        run = BODY.simulate([0, 0.5], (0, 0, 0), load=load, rtol=1e-13)
        momenta = [run.states[name][-1, 0] for name in ("wheel", "wheel_2", "wheel_3")]
        unit = flat / np.linalg.norm(flat, axis=1, keepdims=True)
        assert -unit.T @ momenta / 0.5 == pytest.approx([0.2, 0.1, 0.0], abs=1e-13)

    def test_three_at_right_angles_are_three_wheels(self) -> None:
        control = loads.feedback(K=2.0, D=1.5)
        axes = np.linalg.qr(AXES)[0]
        together = loads.wheels(axes, J, torque=control, rate=(1, 2, 3), friction=0.01, name="w")
        alone: Any = sum(
            loads.wheel(a, j, r, torque=control, friction=0.01, name="w")
            for a, j, r in zip(axes, J, (1, 2, 3), strict=True)
        )
        runs = [BODY.simulate(T, OMEGA, ATTITUDE, load=load, rtol=1e-12) for load in (together, alone)]
        assert np.abs(runs[0].omega - runs[1].omega).max() < 1e-9
        assert sorted(runs[0].states) == ["w", "w_2", "w_3"]

    def test_limits_of_each(self) -> None:
        load = loads.wheels(PYRAMID, 0.02, torque=loads.feedback(1, 1), max_torque=(1, 2, 3, 4), max_rate=5)
        run = BODY.simulate([0, 1], (0, 0, 0.1), load=load)
        assert run.status == "complete"
        with pytest.raises(
            ValueError, match="max_torque: expected one number, or one for each of the 4 wheels"
        ):
            loads.wheels(PYRAMID, 0.02, torque=loads.feedback(1, 1), max_torque=(1, 2))
        with pytest.raises(TypeError, match="torque: expected a controller"):
            loads.wheels(PYRAMID, 0.02, torque=0.1)  # type: ignore[arg-type]
        with pytest.raises(PolhodeError, match="axes must not be the zero vector"):
            loads.wheels([(0, 0, 0), (1, 0, 0)], 0.02, torque=loads.feedback(1, 1))
