"""Motion by `simulate`, against arbitrary-precision series and against the laws of mechanics."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from oracles.bodies import Body, attitudes, bodies, matrix, vectors
from oracles.free_motion import as_floats, taylor_motion
from polhode import RigidBody, Trajectory, loads, solids
from polhode.errors import PolhodeError

# NASA/TM-2015-218675 (NESC), check case 2: 8 x 4 x 2.25 in brick, slug and foot
BRICK = RigidBody.from_principal(0.155404754, [0.001894220, 0.006211019, 0.007194665])
START = np.radians([10.0, 20.0, 30.0])
END = np.array([12.61839077591422, -17.39747476161139, 31.11958888694434])  # deg/s at 30 s, exact

TENSORS: dict[str, np.ndarray] = {
    "asymmetric": np.array([[3.0, 0.2, -0.1], [0.2, 2.0, 0.3], [-0.1, 0.3, 4.0]]),
    "prolate": np.diag([1.0, 3.0, 3.0]),
    "oblate": np.diag([2.0, 2.0, 3.0]),
    "spherical": np.diag([1.5, 1.5, 1.5]),
    "needle": np.diag([1e-3, 1.0, 1.0]),
}
TIMES = (0.0, 0.7, 3.0, 11.0)
RATES = (0.5, -1.0, 0.25)
ATTITUDE = (0.5, -0.5, 0.5, 0.5)


@functools.cache
def oracle(name: str, body_torque: Any = (0, 0, 0), space_torque: Any = (0, 0, 0)) -> tuple[Any, Any]:
    states = taylor_motion(
        TENSORS[name],
        RATES,
        TIMES,
        attitude=ATTITUDE,
        body_torque=body_torque,
        space_torque=space_torque,
        digits=40,
    )
    return as_floats(states)


def assert_motion(trajectory: Trajectory, want: tuple[Any, Any], bar: float) -> None:
    """Rates and attitudes within `bar`; the sign of a quaternion carries no attitude."""
    rates, quaternions = want
    assert np.abs(trajectory.omega - rates).max() <= bar * np.abs(rates).max()
    sign = np.sign((trajectory.quaternion * quaternions).sum(axis=-1, keepdims=True))
    assert np.abs(trajectory.quaternion - sign * quaternions).max() <= bar


class TestAccuracy:
    @pytest.mark.parametrize(("rtol", "bar"), [(1e-13, 1e-11), (1e-10, 1e-8)])
    def test_nasa_check_case_2(self, rtol: float, bar: float) -> None:
        t = np.linspace(0.0, 30.0, 301)
        trajectory = BRICK.simulate(t, START) if rtol == 1e-10 else BRICK.simulate(t, START, rtol=rtol)
        assert np.abs(np.degrees(trajectory.omega[-1]) - END).max() < bar
        alone = BRICK.simulate([0.0, 30.0], START, rtol=rtol)
        assert np.abs(np.degrees(alone.omega[-1]) - END).max() < bar

    @pytest.mark.parametrize(("rtol", "bar"), [(1e-13, 1e-11), (1e-10, 1e-8), (1e-6, 1e-4)])
    @pytest.mark.parametrize("name", TENSORS)
    def test_free_bodies(self, name: str, rtol: float, bar: float) -> None:
        body = RigidBody(1.0, TENSORS[name])
        assert_motion(body.simulate(TIMES, RATES, ATTITUDE, rtol=rtol), oracle(name), bar)

    @pytest.mark.parametrize(("rtol", "bar"), [(1e-13, 1e-11), (1e-10, 1e-8)])
    @pytest.mark.parametrize("frame", ["body", "space"])
    @pytest.mark.parametrize("name", ["asymmetric", "oblate", "spherical"])
    def test_constant_torques(self, name: str, frame: Any, rtol: float, bar: float) -> None:
        torque = (0.1, -0.2, 0.3)
        load = loads.constant_torque(torque, frame=frame)
        body = RigidBody(1.0, TENSORS[name])
        want = oracle(name, torque) if frame == "body" else oracle(name, (0, 0, 0), torque)
        assert_motion(body.simulate(TIMES, RATES, ATTITUDE, load=load, rtol=rtol), want, bar)

    def test_torques_in_body_and_space_add(self) -> None:
        load = loads.constant_torque((0.1, 0.0, -0.2)) + loads.constant_torque((0.0, 0.3, 0.1), "space")
        trajectory = RigidBody(1.0, TENSORS["asymmetric"]).simulate(
            TIMES, RATES, ATTITUDE, load=load, rtol=1e-13
        )
        assert_motion(trajectory, oracle("asymmetric", (0.1, 0.0, -0.2), (0.0, 0.3, 0.1)), 1e-11)

    @pytest.mark.parametrize("scale", [1e-47, 1e-12, 1e12, 1e37])
    def test_no_scale_is_special(self, scale: float) -> None:
        body = RigidBody(1.0, scale * TENSORS["asymmetric"])
        assert_motion(body.simulate(TIMES, RATES, ATTITUDE, rtol=1e-13), oracle("asymmetric"), 1e-11)

    @pytest.mark.parametrize("rate", [1e-9, 1e13])
    def test_no_time_scale_is_special(self, rate: float) -> None:
        body, times = RigidBody(1.0, TENSORS["asymmetric"]), np.array(TIMES) / rate
        trajectory = body.simulate(times, np.array(RATES) * rate, ATTITUDE, rtol=1e-13)
        rates, quaternions = oracle("asymmetric")
        assert_motion(trajectory, (rates * rate, quaternions), 1e-11)


class TestClosedForms:
    def test_spin_up_about_a_principal_axis(self) -> None:
        body, t = solids.box((1.0, 2.0, 3.0), mass=12.0), np.linspace(0, 10, 41)
        torque, start = 2.6, 0.5
        trajectory = body.simulate(t, (start, 0, 0), load=loads.constant_torque((torque, 0, 0)), rtol=1e-13)
        acceleration = torque / 13
        angle = start * t + acceleration * t**2 / 2
        assert np.abs(trajectory.omega[:, 0] - (start + acceleration * t)).max() < 1e-13
        assert not trajectory.omega[:, 1:].any()
        want = np.column_stack([np.sin(angle / 2), 0 * t, 0 * t, np.cos(angle / 2)])
        assert np.abs(trajectory.quaternion - want).max() < 1e-12

    def test_steady_rotation_of_a_sphere(self) -> None:
        trajectory = solids.sphere(1.0, mass=1.0).simulate([0.0, 100.0], (1.0, 2.0, 2.0), rtol=1e-13)
        assert np.array_equal(trajectory.omega, [[1.0, 2.0, 2.0]] * 2)
        want = np.array([*np.sin(150.0) * np.array([1.0, 2, 2]) / 3, np.cos(150.0)])
        assert np.abs(trajectory.quaternion[1] - want).max() < 1e-11

    def test_a_body_at_rest_stays_at_rest(self) -> None:
        trajectory = BRICK.simulate([0.0, 1e6], (0, 0, 0), ATTITUDE)
        assert not trajectory.omega.any()
        assert np.array_equal(trajectory.quaternion, [ATTITUDE] * 2)

    def test_a_rod_keeps_its_rate_along_itself(self) -> None:
        rod = RigidBody.from_principal(1.0, [0.0, 2.0, 2.0])
        trajectory = rod.simulate(np.linspace(0, 5, 11), (0.7, 0.3, 0.0), rtol=1e-12)
        # across the rod ω turns backward about it at the rate ω_1
        turn = np.linspace(0, 5, 11) * 0.7
        assert np.array_equal(trajectory.omega[:, 0], np.full(11, 0.7))
        assert np.abs(trajectory.omega[:, 1] - 0.3 * np.cos(turn)).max() < 1e-10
        with pytest.raises(ValueError, match="torque"):
            rod.simulate([0.0, 1.0], (0, 0, 0), load=loads.constant_torque((1.0, 0, 0)))

    def test_the_center_of_mass_of_a_free_body_moves_uniformly(self) -> None:
        t = np.array([0.0, 1.0, 2.5])
        trajectory = BRICK.simulate(t, START, position=(1.0, 2.0, 3.0), velocity=(0.5, 0.0, -1.0))
        assert np.array_equal(trajectory.position, np.array([1.0, 2, 3]) + t[:, None] * [0.5, 0.0, -1.0])
        assert np.array_equal(trajectory.velocity, [[0.5, 0.0, -1.0]] * 3)

    @pytest.mark.parametrize("torque", [(0.0, 0.0, 0.0), (0.2, -0.1, 0.4)])
    def test_a_fixed_origin_rules_by_its_own_tensor(self, torque: tuple[float, float, float]) -> None:
        body = RigidBody(2.0, np.diag([1.0, 1.5, 2.0]), center_of_mass=(0.3, -0.2, 0.5))
        load = loads.constant_torque(torque, "space") if any(torque) else None
        trajectory = body.simulate(TIMES, RATES, ATTITUDE, load=load, about="origin", rtol=1e-13)
        tensor = body.inertia_about("origin")
        states = taylor_motion(tensor, RATES, TIMES, attitude=ATTITUDE, space_torque=torque, digits=25)
        assert_motion(trajectory, as_floats(states), 1e-11)
        assert not trajectory.position.any()
        assert not trajectory.velocity.any()
        assert np.array_equal(trajectory.about, np.zeros(3))

    @pytest.mark.parametrize("method", ["dop853", "radau", "taylor"])
    def test_a_pivot_holds_against_every_force(self, method: Any) -> None:
        body = RigidBody(2.0, np.diag([1.0, 1.5, 2.0]), center_of_mass=(0.3, -0.2, 0.5))
        gravity = loads.uniform_gravity((0.0, 0.0, -9.81))
        trajectory = body.simulate(TIMES, RATES, ATTITUDE, load=gravity, about="origin", method=method)
        assert not trajectory.position.any()
        assert not trajectory.velocity.any()


class TestLaws:
    @settings(max_examples=25)
    @given(body=bodies(thinnest=2, decades=3), omega=vectors(), attitude=attitudes())
    def test_free_motion_keeps_energy_and_angular_momentum(
        self, body: Body, omega: np.ndarray, attitude: np.ndarray
    ) -> None:
        made = RigidBody.from_principal(*body)
        span = 10 / max(float(np.linalg.norm(omega)), 1e-3)
        trajectory = made.simulate(np.linspace(0, span, 7), omega, attitude, rtol=1e-12)
        w, q = trajectory.omega, trajectory.quaternion
        energy = np.einsum("ti,ij,tj->t", w, made.inertia, w)
        spin = w @ made.inertia
        space = np.array([matrix(turn) @ s for turn, s in zip(q, spin, strict=True)])
        assert np.abs(energy - energy[0]).max() <= 1e-9 * energy[0]
        assert np.abs(space - space[0]).max() <= 1e-9 * np.linalg.norm(space[0])
        assert np.abs((q * q).sum(axis=1) - 1).max() < 1e-14

    def test_a_torque_fixed_in_space_adds_angular_momentum_evenly(self) -> None:
        torque, t = np.array([0.3, -0.1, 0.2]), np.linspace(0, 20, 21)
        body = RigidBody(1.0, TENSORS["asymmetric"])
        trajectory = body.simulate(
            t, RATES, ATTITUDE, load=loads.constant_torque(torque, "space"), rtol=1e-13
        )
        momentum = [
            matrix(q) @ body.inertia @ w for q, w in zip(trajectory.quaternion, trajectory.omega, strict=True)
        ]
        assert np.abs(momentum - (momentum[0] + t[:, None] * torque)).max() < 1e-10

    def test_energy_grows_by_the_work_done(self) -> None:
        """Gauss quadrature of the power N·ω over ten panels, on output times of the trajectory itself."""
        torque, body = np.array([0.3, -0.1, 0.2]), RigidBody(1.0, TENSORS["asymmetric"])
        nodes, weights = np.polynomial.legendre.leggauss(8)
        panels = 2 * np.arange(10)[:, None] / 10
        t = np.concatenate([[0.0], (panels + (nodes + 1) / 10).ravel(), [2.0]])
        w = body.simulate(t, RATES, load=loads.constant_torque(torque), rtol=1e-13).omega
        work = (w[1:-1] @ torque) @ np.tile(weights / 10, 10)
        energy = np.einsum("ti,ij,tj->t", w, body.inertia, w) / 2
        assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-11)

    def test_backward_in_time_is_the_way_back(self) -> None:
        forth = BRICK.simulate([0.0, 30.0], START, ATTITUDE, rtol=1e-13)
        back = BRICK.simulate([30.0, 0.0], forth.omega[-1], forth.quaternion[-1], rtol=1e-13)
        assert np.abs(back.omega[-1] - START).max() < 1e-12
        assert np.abs(back.quaternion[-1] - np.array(ATTITUDE)).max() < 1e-11

    def test_turning_the_laboratory_turns_the_motion(self) -> None:
        """Attitudes are multiplied from the left, rates in the body do not change at all."""
        one = BRICK.simulate(TIMES, START)
        two = BRICK.simulate(TIMES, START, (0.0, 0.0, np.sin(0.4), np.cos(0.4)))
        assert np.abs(one.omega - two.omega).max() < 1e-10
        turn = matrix(np.array([0.0, 0.0, np.sin(0.4), np.cos(0.4)]))
        for a, b in zip(one.quaternion, two.quaternion, strict=True):
            assert np.abs(turn @ matrix(a) - matrix(b)).max() < 1e-9


class TestOutput:
    def test_the_start_is_given_back(self) -> None:
        trajectory = BRICK.simulate([5.0, 6.0], START, ATTITUDE)
        assert np.array_equal(trajectory.t, [5.0, 6.0])
        assert np.array_equal(trajectory.omega[0], START)
        assert np.array_equal(trajectory.quaternion[0], ATTITUDE)
        assert trajectory.body == BRICK

    def test_attitude_defaults_to_identity_and_may_be_an_object(self) -> None:
        class Attitude:
            def as_quat(self) -> Any:
                return np.array(ATTITUDE)

        assert np.array_equal(BRICK.simulate([0.0, 1.0], START).quaternion[0], [0, 0, 0, 1])
        by_object = BRICK.simulate([0.0, 1.0], START, Attitude())
        assert np.array_equal(by_object.quaternion, BRICK.simulate([0.0, 1.0], START, ATTITUDE).quaternion)

    def test_dense_output_is_as_good_as_the_steps(self) -> None:
        fine = BRICK.simulate(np.linspace(0, 30, 3001), START)
        coarse = BRICK.simulate(np.linspace(0, 30, 7), START)
        assert np.abs(fine.omega[::500] - coarse.omega).max() < 1e-9
        assert np.abs(fine.quaternion[::500] - coarse.quaternion).max() < 1e-9
        sharp = BRICK.simulate(np.linspace(0, 30, 3001), START, rtol=1e-13)
        assert np.abs(fine.omega - sharp.omega).max() < 1e-9
        assert np.abs(fine.quaternion - sharp.quaternion).max() < 1e-8

    def test_quaternions_are_unit_and_continuous(self) -> None:
        q = BRICK.simulate(np.linspace(0, 200, 2001), START).quaternion
        assert np.abs((q * q).sum(axis=1) - 1).max() < 1e-15
        assert ((q[1:] * q[:-1]).sum(axis=1) > 0.9).all()

    def test_one_time_is_the_start_alone(self) -> None:
        trajectory = BRICK.simulate([3.0], START)
        assert trajectory.omega.shape == (1, 3)
        assert np.array_equal(trajectory.omega[0], START)

    def test_work_is_counted(self) -> None:
        trajectory = BRICK.simulate([0.0, 30.0], START, method="dop853")
        assert 5 < int(trajectory.steps) < 1000
        assert int(trajectory.evaluations) > 11 * int(trajectory.steps)
        sharper = BRICK.simulate([0.0, 30.0], START, rtol=1e-13, method="dop853")
        assert int(sharper.steps) > int(trajectory.steps)

    @pytest.mark.parametrize(
        ("method", "load"),
        [
            ("exact", None),
            ("taylor", loads.damping(1e-3)),
            ("dop853", loads.torque_callback(lambda _t, w, _q: -1e-3 * w)),
        ],
    )
    def test_auto_is_the_first_that_can(self, method: Any, load: Any) -> None:
        auto, named = (BRICK.simulate(TIMES, START, load=load, method=name) for name in ("auto", method))
        assert np.array_equal(auto.omega, named.omega)
        assert np.array_equal(auto.quaternion, named.quaternion)

    @pytest.mark.parametrize(("rtol", "method"), [(2.3e-15, "exact"), (2.2e-15, "taylor"), (1e-28, "taylor")])
    def test_auto_beyond_doubles_takes_series(self, rtol: float, method: Any) -> None:
        auto = BRICK.simulate(TIMES, START, rtol=rtol)
        assert (int(auto.steps) == 0) == (method == "exact")
        assert np.array_equal(auto.omega, BRICK.simulate(TIMES, START, rtol=rtol, method=method).omega)

    def test_a_method_that_cannot_says_which_can(self) -> None:
        call = loads.torque_callback(lambda _t, w, _q: -w)
        refused: tuple[tuple[Any, ...], ...] = (
            ("exact", loads.damping(1.0), '"taylor" can serve this run: method="taylor"'),
            ("exact", call, '"dop853" can serve this run: method="dop853"'),
            ("taylor", call, '"dop853" can serve this run: method="dop853"'),
        )
        for method, load, word in refused:
            with pytest.raises(PolhodeError, match=word):
                BRICK.simulate(TIMES, START, load=load, method=method)
        with pytest.raises(ValueError, match='method: expected one of "auto", "exact", "taylor", "dop853"'):
            BRICK.simulate(TIMES, START, method="euler")  # type: ignore[arg-type]


class TestArguments:
    @pytest.mark.parametrize("kind", [list, tuple, np.array])
    def test_numbers_in_any_sequence(self, kind: Any) -> None:
        want = BRICK.simulate(np.array([0.0, 2.0]), np.array([1.0, 0.0, 2.0]), np.array([0.0, 0.6, 0.0, 0.8]))
        got = BRICK.simulate(kind([0, 2]), kind([np.float64(1), 0, 2.0]), kind([0, 0.6, 0, np.float64(0.8)]))
        assert np.array_equal(got.omega, want.omega)
        assert np.array_equal(got.quaternion, want.quaternion)

    @pytest.mark.parametrize(
        ("t", "error", "message"),
        [
            ([], PolhodeError, "t"),
            ([0.0, True, 2.0], None, ""),
            ([0, 2**70], TypeError, "t: expected real numbers"),
            ([0.0, "1"], TypeError, "t: expected real numbers"),
            ([0.0, 1j], TypeError, "t: expected real numbers"),
            ([0.0, None], TypeError, "t: expected real numbers"),
            ([[0.0, 1.0]], ValueError, r"t: expected shape \(T,\), got \(1, 2\)"),
            (1.0, ValueError, r"t: expected shape \(T,\), got \(\)"),
        ],
    )
    def test_what_numpy_makes_of_others(self, t: Any, error: Any, message: str) -> None:
        if error is None:
            assert len(BRICK.simulate(t, START)) == len(t)
            return
        with pytest.raises(error, match=message):
            BRICK.simulate(t, START)

    def test_vectors_have_three_components(self) -> None:
        for omega, shape in (([1, 2], r"\(2,\)"), ((1.0, 2.0, 3.0, 4.0), r"\(4,\)"), ([], r"\(0,\)")):
            with pytest.raises(ValueError, match=rf"omega: expected shape \(\.\.\., 3\), got {shape}"):
                BRICK.simulate(TIMES, omega)


class TestStacks:
    def test_bodies_and_starts_broadcast(self, rng: np.random.Generator) -> None:
        stack = solids.box(rng.uniform(1, 3, size=(4, 3)), mass=1.0)
        starts = rng.normal(size=(5, 1, 3))
        trajectory = stack.simulate(np.linspace(0, 1, 6), starts)
        assert trajectory.omega.shape == (5, 4, 6, 3)
        assert trajectory.quaternion.shape == (5, 4, 6, 4)
        assert trajectory.position.shape == trajectory.velocity.shape == (5, 4, 6, 3)
        assert trajectory.steps.shape == trajectory.evaluations.shape == (5, 4)

    def test_a_row_alone_has_the_bits_of_the_row_in_the_stack(self, rng: np.random.Generator) -> None:
        stack = solids.box(rng.uniform(1, 3, size=(9, 3)), mass=1.0)
        starts = rng.normal(size=(9, 3))
        torque = loads.constant_torque((0.1, 0.2, 0.3), "space")
        together = stack.simulate(TIMES, starts, load=torque)
        for i, body in enumerate(stack):
            alone = body.simulate(TIMES, starts[i], load=torque)
            assert np.array_equal(alone.omega, together.omega[i])
            assert np.array_equal(alone.quaternion, together.quaternion[i])

    def test_attitudes_positions_and_velocities_make_stacks_too(self) -> None:
        assert BRICK.simulate(TIMES, START, np.full((3, 4), 0.5)).omega.shape == (3, 4, 3)
        assert BRICK.simulate(TIMES, START, position=np.zeros((3, 3))).omega.shape == (3, 4, 3)
        assert BRICK.simulate(TIMES, START, velocity=np.zeros((2, 1, 3))).omega.shape == (2, 1, 4, 3)

    def test_an_empty_stack_has_empty_motion(self) -> None:
        assert BRICK.simulate(TIMES, np.zeros((0, 3))).omega.shape == (0, 4, 3)


class TestFirstStep:
    """The first step of the methods for functions."""

    @pytest.mark.parametrize("method", ["dop853", "radau"])
    @pytest.mark.parametrize("power", [-20, -3, 3, 20])
    def test_is_the_same_in_any_unit_of_time(self, method: Any, power: int) -> None:
        """A power of two changes no digit of a number: all digits of the motion are the same."""

        def run(unit: float) -> Trajectory:
            def torque(t: float, omega: np.ndarray, _: np.ndarray) -> np.ndarray:
                swing = np.array([np.sin(unit * t), 0.3, np.cos(2 * unit * t)])
                return unit * (unit * swing - 0.3 * omega)

            body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
            load, omega = loads.torque_callback(torque), unit * np.array([0.5, -1.0, 0.25])
            return body.simulate([0.0, 4.0 / unit], omega, load=load, method=method, rtol=1e-8)

        unit = 2.0**power
        one, other = run(1.0), run(unit)
        assert one.evaluations == other.evaluations
        np.testing.assert_array_equal(one.quaternion, other.quaternion)
        np.testing.assert_array_equal(unit * one.omega, other.omega)

    @pytest.mark.parametrize("span", [1e-6, 1e-3, 0.1, 1.0])
    def test_short_time_takes_one_step(self, span: float) -> None:
        """A slow body for less than a tenth of a radian, as in a step of a control loop."""
        body = RigidBody.from_principal(20.0, (0.30, 0.25, 0.13))
        load = loads.torque_callback(lambda *_: (1e-4, -2e-4, 5e-5))
        run = body.simulate([0.0, span], (0.05, -0.03, 0.02), load=load, method="dop853")
        assert (int(run.steps), int(run.evaluations)) == (1, 14)
        far = body.simulate([0.0, 60.0], (0.05, -0.03, 0.02), load=load, method="dop853")
        assert far.steps > 1

    @pytest.mark.parametrize("phase", [0.0, 0.5 * np.pi, 1.0])
    def test_slope_at_its_maximum(self, phase: float) -> None:
        """N = cos(t + phase): the slope may not change at the start; one step at most is tried in vain."""
        body = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
        load = loads.torque_callback(lambda t, *_: (0.0, 0.0, np.cos(t + phase)))
        run = body.simulate([0.0, 1.0], (0, 0, 0.5), load=load, method="dop853", rtol=1e-10)
        exact = 0.5 + np.sin(1.0 + phase) - np.sin(phase)
        np.testing.assert_allclose(run.omega[-1, 2], exact, rtol=0, atol=1e-10)
        assert run.evaluations <= 2 + 12 * run.steps + 11

    def test_slope_that_begins_at_zero(self) -> None:
        """ω = (1 - cos t)/I: at the start neither ω nor its rate tells how fast it will change."""
        body = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
        load = loads.torque_callback(lambda t, *_: (0.0, 0.0, np.sin(t)))
        methods: Any = (("dop853", 1e-10), ("radau", 1e-7))
        for method, rtol in methods:
            run = body.simulate([0.0, 3.0, 40.0], (0, 0, 0), load=load, method=method, rtol=rtol)
            np.testing.assert_allclose(run.omega[1:, 2], 1 - np.cos([3.0, 40.0]), rtol=0, atol=30 * rtol)
