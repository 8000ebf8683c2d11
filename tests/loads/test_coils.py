"""Coils: their limit, tables and controllers of their moment, and the unloading of wheels by them."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from oracles.wheels import ATTITUDE, BODY, OMEGA, turned, turning
from polhode import Event, RigidBody, loads, orbits
from polhode.errors import PolhodeError
from scipy.integrate import solve_ivp

B = np.array([0.3, -0.4, 1.2])
BALL = RigidBody.from_principal(1.0, (2.0, 2.0, 2.0))
TIGHT: Any = {"method": "DOP853", "rtol": 3e-14, "atol": 1e-14}
J = np.array([0.2, 0.15, 0.1])
WHEELS = ("wheel", "wheel_2", "wheel_3")


def by_scipy(torque: Any, t: Any) -> Any:
    """Integrate q and ω of BODY under a torque (t, q, ω) in B."""
    inverse = np.linalg.inv(BODY.inertia)

    def rates(s: float, y: np.ndarray) -> np.ndarray:
        q, w = y[:4], y[4:]
        return np.concatenate([turning(q, w), inverse @ (torque(s, q, w) - np.cross(w, BODY.inertia @ w))])

    start = np.concatenate([ATTITUDE, OMEGA])
    return solve_ivp(rates, (t[0], t[-1]), start, t_eval=t, **TIGHT).y.T


class TestLimit:
    def test_each_component_is_clipped(self) -> None:
        dipole, most = np.array([0.5, -2.0, 0.125]), np.array([0.4, 0.25, 1.0])
        clipped = np.array([0.4, -0.25, 0.125])
        for given, right in ((most, clipped), (0.3, [0.3, -0.3, 0.125])):
            load = loads.magnetic(dipole, B, max_dipole=given)
            torque = load.torque(0.0, OMEGA, ATTITUDE)
            assert torque == pytest.approx(np.cross(right, turned(ATTITUDE).T @ B), abs=1e-15)
        run = BODY.simulate([0, 3], OMEGA, ATTITUDE, load=loads.magnetic(dipole, B, max_dipole=most))
        same = BODY.simulate([0, 3], OMEGA, ATTITUDE, load=loads.magnetic(clipped, B), method="dop853")
        assert np.abs(run.omega - same.omega).max() < 1e-14

    def test_both_sides_of_the_limit(self) -> None:
        for dipole, right in ((np.nextafter(0.5, 0), np.nextafter(0.5, 0)), (0.5, 0.5), (0.5 + 1e-12, 0.5)):
            torque = loads.magnetic((dipole, 0, 0), (0, 1, 0), max_dipole=0.5).torque(0, OMEGA, (0, 0, 0, 1))
            assert torque[2] == right

    def test_the_times_at_which_coils_saturate_against_scipy(self) -> None:
        """B-dot of a body that tumbles: the components go over the limit and back."""
        gain, most, tensor = 0.02, 0.02, BODY.inertia
        load = loads.magnetic((0, 0, 0), B, gain=gain, max_dipole=most)
        run = BODY.simulate([0, 15], OMEGA, ATTITUDE, load=load, events=Event.dipole_limit(), rtol=1e-13)

        def demand(y: np.ndarray) -> np.ndarray:
            return gain * np.cross(y[4:], turned(y[:4]).T @ B)

        def over(_t: float, y: np.ndarray) -> float:
            return float(np.abs(demand(y)).max() - most)

        def rates(_t: float, y: np.ndarray) -> np.ndarray:
            q, w = y[:4], y[4:]
            push = np.cross(np.clip(demand(y), -most, most), turned(q).T @ B)
            return np.concatenate([turning(q, w), np.linalg.solve(tensor, push - np.cross(w, tensor @ w))])

        start = np.concatenate([ATTITUDE, OMEGA])
        exact = solve_ivp(rates, (0, 15), start, events=over, max_step=0.02, **TIGHT)
        assert len(run.events.t) == len(exact.t_events[0]) == 6
        assert run.events.t == pytest.approx(exact.t_events[0], abs=1e-10)
        assert run.omega[-1] == pytest.approx(exact.y[4:, -1], abs=1e-10)

    def test_a_limit_that_is_passed_by_a_table(self) -> None:
        load = loads.magnetic(
            [(0.5, 0, 0), (2.0, 0, 0), (-0.5, 0, 0)], B, dipole_times=[0.0, 1.5, 2.5], max_dipole=1.0
        )
        both = BODY.simulate([0, 4], OMEGA, load=load, events=Event.dipole_limit()).events
        assert both.t == pytest.approx([1.5, 2.5], abs=1e-12)
        for direction, time in ((1, 1.5), (-1, 2.5)):
            event = Event.dipole_limit(direction=direction, terminal=True)
            run = BODY.simulate([0, 4], OMEGA, load=load, events=event)
            assert run.status == "event"
            assert run.events.t == pytest.approx([time], abs=1e-12)

    def test_the_time_by_a_closed_form(self) -> None:
        """A controller asks for the torque 0.1 t across B: m = 0.1 t/B reaches the limit."""
        asked = loads.torque_callback(lambda t, *_: (0.1 * t, 0, 0))
        field, most = 0.7, 0.31
        load = loads.magnetic(asked, (field, 0, 0), max_dipole=most)
        # Where B lies along the torque the coils exert none of it.
        still = BALL.simulate([0, 9], (0, 0, 0), load=load, events=Event.dipole_limit())
        assert not len(still.events.t)
        assert np.array_equal(still.omega[-1], np.zeros(3))
        # A heavy body hardly turns.
        heavy = RigidBody.from_principal(1.0, (1e9, 1e9, 1e9))
        load = loads.magnetic(asked, (0, 0, field), max_dipole=most)
        run = heavy.simulate([0, 9], (0, 0, 0), load=load, events=Event.dipole_limit(), rtol=1e-13)
        reach = field * most / 0.1
        assert run.events.t == pytest.approx([reach], abs=1e-12)
        impulse = 0.05 * reach**2 + field * most * (9 - reach)
        assert run.omega[-1, 0] * 1e9 == pytest.approx(impulse, abs=1e-9)

    def test_a_factor_scales_what_is_exerted(self) -> None:
        load = loads.magnetic((2.0, 0.1, 0), B, max_dipole=0.5)
        once, twice = (one.torque(0, OMEGA, ATTITUDE) for one in (load, -2.0 * load))
        assert twice == pytest.approx(-2 * once, abs=1e-15)
        assert np.array_equal((0.0 * load).torque(0, OMEGA, ATTITUDE), np.zeros(3))
        asked = loads.magnetic(loads.feedback(3.0, 2.0), B, max_dipole=0.5)
        once, twice = (one.torque(0, OMEGA, ATTITUDE) for one in (asked, -2.0 * asked))
        assert twice == pytest.approx(-2 * once, abs=1e-15)

    def test_stacks_pickles_and_schedules(self) -> None:
        load = loads.magnetic((2.0, 0.1, 0), B, max_dipole=[(0.5, 1, 1), (1.0, 2, 2)])
        assert load.shape == (2,)
        runs = BODY.simulate([0, 2], OMEGA, ATTITUDE, load=load)
        alone = BODY.simulate([0, 2], OMEGA, ATTITUDE, load=load[1])
        assert np.array_equal(runs.omega[1], alone.omega)
        again = pickle.loads(pickle.dumps(load))
        assert np.array_equal(BODY.simulate([0, 2], OMEGA, ATTITUDE, load=again).omega, runs.omega)
        assert repr(load[0]) == "<Load: magnetic>"
        asked = loads.magnetic(loads.feedback(1, 1), B, max_dipole=0.3)
        pulse = loads.schedule(asked, [(1.0, 2.0)])
        on = BODY.simulate([0, 1], OMEGA, ATTITUDE, rtol=1e-13).resume([1, 2], load=asked, rtol=1e-13)
        run = BODY.simulate([0, 2, 3], OMEGA, ATTITUDE, load=pulse, rtol=1e-13)
        assert np.abs(run.omega[1] - on.omega[-1]).max() < 1e-12
        free = BODY.simulate([2, 3], on.omega[-1], on.quaternion[-1], rtol=1e-13)
        assert np.abs(run.omega[2] - free.omega[-1]).max() < 1e-11

    def test_refused(self) -> None:
        for most in (0.0, -1.0, (1, 1, 0), np.nan, np.inf):
            with pytest.raises(PolhodeError, match="max_dipole must be"):
                loads.magnetic((1, 0, 0), B, max_dipole=most)
        with pytest.raises(ValueError, match=r"Event\.dipole_limit asks for coils with a limit"):
            BODY.simulate([0, 1], OMEGA, load=loads.magnetic((1, 0, 0), B), events=Event.dipole_limit())
        with pytest.raises(PolhodeError, match="so do coils"):
            loads.magnetic(loads.wheel((0, 0, 1), 0.1), B)
        with pytest.raises(TypeError, match="dipole_times: not beside a controller"):
            loads.magnetic(loads.feedback(1, 1), B, dipole_times=[0, 1])
        with pytest.raises(ValueError, match="dipole: expected one for each of the 2 times, got 3"):
            loads.magnetic(np.zeros((3, 3)), B, dipole_times=[0, 1])
        with pytest.raises(PolhodeError, match=r"dipole"):
            BODY.simulate([0, 1], OMEGA, load=loads.magnetic(np.zeros((1, 3)), B, dipole_times=[0.5]))
        pushes = loads.magnetic(loads.callback(lambda *_: ((0, 0, 1.5), (0, 0, 0))), B)
        with pytest.raises(ValueError, match="its controller asks for the force"):
            BODY.simulate([0, 1], OMEGA, load=pushes)


class TestControllers:
    def test_they_exert_the_part_across_the_field(self) -> None:
        asked = np.array([0.3, -0.2, 0.7])
        for control in (loads.constant_torque(asked), loads.torque_callback(lambda *_: asked)):
            torque = loads.magnetic(control, B).torque(0.0, OMEGA, ATTITUDE)
            along = turned(ATTITUDE).T @ B / np.linalg.norm(B)
            assert torque == pytest.approx(asked - along * (asked @ along), abs=1e-15)
        assert np.array_equal(
            loads.magnetic(loads.constant_torque(asked), (0, 0, 0)).torque(0, OMEGA, ATTITUDE), np.zeros(3)
        )

    @pytest.mark.parametrize("scale", [1e-300, 1e-5, 1e300])
    def test_fields_of_any_size(self, scale: float) -> None:
        torque = loads.magnetic(loads.constant_torque((1, 0, 1)), (0, 0, scale)).torque(
            0, OMEGA, (0, 0, 0, 1)
        )
        assert torque == pytest.approx([1, 0, 0], abs=1e-15)

    def test_against_scipy(self) -> None:
        """A feedback by coils in a field along an orbit, with a limit."""
        orbit = orbits.kepler(1.0, (1.0, 0, 0), (0, 0.2, 0.99))
        field = orbit.dipole_field((0.1, 0.2, 1.5))
        most = np.array([0.15, 0.2, 0.1])
        law = loads.feedback(K=0.3, D=0.2) + loads.torque_callback(lambda t, *_: (0.1 * np.sin(t), 0, 0))
        coils = loads.magnetic(law, field, gain=0.05, max_dipole=most)
        t = np.array([0.0, 1.7, 6.0])
        # The moments reach their limit at times that no step is cut at: the step control finds them.
        run = BODY.simulate(t, OMEGA, ATTITUDE, load=coils, rtol=1e-14)

        def in_space(s: float) -> tuple[np.ndarray, np.ndarray]:
            r, v = orbit.at(s)
            m, d = np.array([0.1, 0.2, 1.5]), np.linalg.norm(r)
            field = 3 * (m @ r) * r / d**5 - m / d**3
            out = r @ v / d
            rate = 3 * ((m @ v) * r + (m @ r) * v) / d**5 - 15 * (m @ r) * r * out / d**6 + 3 * m * out / d**4
            return field, rate

        def torque(s: float, q: np.ndarray, w: np.ndarray) -> np.ndarray:
            field, rate = (turned(q).T @ vector for vector in in_space(s))
            e = np.sign(q[3]) * q[:3] / np.linalg.norm(q)
            asked = -0.3 * e - 0.2 * w + np.array([0.1 * np.sin(s), 0, 0])
            moment = np.cross(field, asked) / (field @ field) - 0.05 * (rate - np.cross(w, field))
            return np.cross(np.clip(moment, -most, most), field)

        exact = by_scipy(torque, t)
        assert np.abs(run.omega - exact[:, 4:]).max() < 1e-10

    def test_a_sampled_controller(self) -> None:
        """About an axis across B it holds −g ω: ω falls by the factor 1 − g/I in each period."""
        control = loads.with_states(
            None,
            [0.0],
            lambda *a: ((0, 0, 0), (a[-1]["law"][0], 0, 0)),
            "law",
            update=lambda _t, w, *_: [-0.5 * w[0]],
            period=1.0,
        )
        # The body turns about x, so B, across x, stays across it.
        run = BALL.simulate(np.arange(6.0), (1, 0, 0), load=loads.magnetic(control, (0, 0, 2.0)), rtol=1e-13)
        assert run.omega[:, 0] == pytest.approx(0.75 ** np.arange(6.0), abs=1e-12)
        part = BALL.simulate([0, 2.5], (1, 0, 0), load=loads.magnetic(control, (0, 0, 2.0)), rtol=1e-13)
        assert part.resume([2.5, 5]).omega[-1, 0] == pytest.approx(0.75**5, abs=1e-12)

    def test_the_momentum_along_a_uniform_field_is_kept(self) -> None:
        load = loads.magnetic(loads.feedback(0.5, 0.5), B)
        run = BODY.simulate([0, 9], OMEGA, ATTITUDE, load=load, rtol=1e-13)
        momentum = run.angular_momentum(frame="space").spin
        assert momentum @ B == pytest.approx(momentum[0] @ B, abs=1e-11)
        assert np.abs(load.keeps_momentum() - B / np.linalg.norm(B)).max() < 1e-15


def momenta(states: dict[str, Any]) -> np.ndarray:
    return np.concatenate([states[name] for name in WHEELS])


class TestUnloading:
    """N = −k h across B takes the momentum out of the wheels, all but the part along B."""

    K = 0.4
    START = np.array([0.3, -0.2, 0.5])

    def dump(self, *arguments: Any) -> tuple[Any, Any]:
        return (0, 0, 0), -self.K * momenta(arguments[-1])

    def test_by_a_closed_form(self) -> None:
        """The motors exert the opposite of the coils, so that the body stays at rest."""
        along = B / np.linalg.norm(B)

        def hold(*arguments: Any) -> tuple[Any, Any]:
            h = momenta(arguments[-1])
            return (0, 0, 0), self.K * (h - along * (h @ along))

        dump, motors = (
            loads.with_states(None, [0.0], law, name) for law, name in ((self.dump, "d"), (hold, "m"))
        )
        wheels: Any = sum(
            loads.wheel(axis, j, h / j, torque=motors)
            for axis, j, h in zip(np.eye(3), J, self.START, strict=True)
        )
        t = np.linspace(0, 10, 6)
        run = BODY.simulate(t, (0, 0, 0), load=wheels + loads.magnetic(dump, B), rtol=1e-13, atol=1e-15)
        h = np.column_stack([run.states[name][:, 0] for name in WHEELS])
        kept = along * (self.START @ along)
        exact = kept + np.exp(-self.K * t)[:, None] * (self.START - kept)
        assert np.abs(h - exact).max() < 1e-12
        assert np.abs(run.omega).max() < 1e-13

    def test_against_scipy(self) -> None:
        """A feedback holds the attitude by the wheels, while coils with a limit unload them."""
        most, pull, brake = np.array([0.1, 0.12, 0.08]), 2.0, 3.0
        dump = loads.with_states(None, [0.0], self.dump, "d")
        wheels = loads.wheels(np.eye(3), J, rate=self.START / J, torque=loads.feedback(pull, brake))
        t = np.array([0.0, 2.0, 9.0])
        run = BODY.simulate(
            t, (0.01, 0, -0.02), load=wheels + loads.magnetic(dump, B, max_dipole=most), rtol=1e-13
        )
        less = np.linalg.inv(BODY.inertia - np.diag(J))

        def rates(_t: float, y: np.ndarray) -> np.ndarray:
            q, w, h = y[:4], y[4:7], y[7:]
            field = turned(q).T @ B
            moment = np.cross(field, -self.K * h) / (B @ B)
            asked = -pull * q[:3] * np.sign(q[3]) - brake * w
            outside = np.cross(np.clip(moment, -most, most), field)
            own = BODY.inertia @ w - J * w
            turn = less @ (outside + asked - np.cross(w, own + h))
            return np.concatenate([turning(q, w), turn, -asked])

        start = np.concatenate([[0, 0, 0, 1], [0.01, 0, -0.02], self.START + J * np.array([0.01, 0, -0.02])])
        exact = solve_ivp(rates, (0, 9), start, t_eval=t, **TIGHT).y.T
        h = np.column_stack([run.states[name][:, 0] for name in WHEELS])
        assert np.abs(run.omega - exact[:, 4:7]).max() < 1e-10
        assert np.abs(h - exact[:, 7:]).max() < 1e-10
