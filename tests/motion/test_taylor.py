"""Taylor series against the committed cases to forty digits, in stacks, and where they do not serve."""

from __future__ import annotations

import _thread
import threading
import time
from typing import Any

import numpy as np
import pytest
from oracles import free_cases, load_cases, top_cases
from oracles.motion_cases import MotionCase, angle, load_table, named, relative_error
from polhode import RigidBody, loads, solids

TIGHTEST_IN_DOUBLES = 2.3e-15
TIGHTEST = 1e-28
ROUNDING = 4e-16
"""Of four components of a quaternion, as an angle."""
TORN = 1e4
"""Neighbours that part by more are no neighbours in doubles."""
CASES = load_table(free_cases.NAME) + load_table(top_cases.NAME)
BRICK = solids.box((8.0, 4.0, 2.25), mass=1.0)


def motion(case: MotionCase, omega: Any, attitude: Any, t: float, rtol: float = TIGHTEST_IN_DOUBLES) -> Any:
    """Rates and attitude at `t`."""
    given = dict(case.body)
    body = RigidBody.from_principal(**given) if "moments" in given else RigidBody(**given)
    load = loads.uniform_gravity(case.gravity) if case.gravity else None
    trajectory = body.simulate(
        [0.0, t], omega, attitude, load=load, about=case.about, method="taylor", rtol=rtol
    )
    return trajectory.omega[-1], trajectory.quaternion[-1]


def product(a: Any, b: Any) -> np.ndarray:
    (u, p), (v, s) = (a[:3], a[3]), (b[:3], b[3])
    return np.array([*(p * v + s * u + np.cross(u, v)), p * s - u @ v])


def condition(case: MotionCase, n: int) -> float:
    """‖∂(attitude, ω/|ω₀|)(t)/∂(attitude, ω/|ω₀|)(0)‖₂ at the time number n, by differences."""
    speed, small = float(np.linalg.norm(case.omega)), 1e-11
    q = np.array(case.attitude) / np.linalg.norm(case.attitude)
    columns = []
    for k in range(6):
        ends = []
        for side in (small, -small):
            turn, omega = np.array([0.0, 0.0, 0.0, 1.0]), np.array(case.omega)
            if k < 3:
                turn[k] = side / 2
            else:
                omega[k - 3] += side * speed
            ends.append(motion(case, omega, product(q, turn / np.linalg.norm(turn)), case.times[n]))
        (w, p), (v, s) = ends
        turned = 2 * product(s * [-1, -1, -1, 1], p)
        columns.append(np.concatenate([turned[:3] * np.sign(turned[3]), (w - v) / speed]) / (2 * small))
    return float(np.linalg.norm(np.array(columns), 2))


# The largest ‖∂(attitude, ω/|ω₀|)(t)/∂(attitude, ω/|ω₀|)(s)‖₂ over s, t at ten rotations, of those that pass
# by an unstable motion: what is rounded at s grows by it, while κ(t, 0) is small once more.
GROWTH = {
    "near the separatrix: off the intermediate axis by 0.001": 6.4e5,
    "near the separatrix: off the intermediate axis by 1e-08": 1.9e7,
    "near the separatrix: off the intermediate axis by 1e-05, long": 1.0e10,
    "sleeping, unstable: 1e-2 off": 7.0e4,
    "sleeping, unstable: pushed 1e-9": 4.0e9,
}


def error(case: MotionCase, n: int, rtol: float) -> float:
    """Of attitude and rates at the time number n."""
    omega, quaternion = motion(case, case.omega, case.attitude, case.times[n], rtol)
    speed, want = float(np.linalg.norm(case.omega)), case.expected[n]
    return max(angle(quaternion, want.quaternion), relative_error(omega, want.omega, speed))


@named(CASES)
def test_ten_rotations_in_doubles(case: MotionCase) -> None:
    for n in (0, 1):
        kappa = max(case.kappa[n] if case.kappa else condition(case, n), GROWTH.get(case.name, 0.0))
        assert error(case, n, TIGHTEST_IN_DOUBLES) <= 1e-13 + 30 * 1.1e-16 * kappa


@named(case for case in CASES if case.kappa and case.name not in GROWTH)
def test_condition_numbers_are_those_of_differences(case: MotionCase) -> None:
    """Where neighbours stay neighbours in doubles all the way: at the first time at least."""
    assert case.kappa[0] < TORN
    for n in range(1 + (case.kappa[1] < TORN)):
        assert condition(case, n) == pytest.approx(case.kappa[n], rel=0.01)


@named(case for case in CASES if case.name in GROWTH and "0.001" in case.name)
def test_growth_on_the_way_is_that_of_the_variations(case: MotionCase) -> None:
    exact = case._replace(times=tuple(case.times[1] * part for part in (0.225, 1.0)))
    assert load_cases.growth(exact, 32) == pytest.approx(GROWTH[case.name], rel=0.05)


@named(case for case in CASES if case.name in GROWTH and "1e-05, long" in case.name)
def test_growth_on_the_way_is_far_above_that_from_the_start(case: MotionCase) -> None:
    """What is rounded after about a third of the way grows most."""
    exact = case._replace(times=tuple(case.times[1] * part for part in (0.35, 1.0)))
    assert load_cases.growth(exact, 32) == pytest.approx(GROWTH[case.name], rel=0.1)
    assert case.kappa[1] == pytest.approx(9e4, rel=0.05)


@named(CASES)
def test_ten_rotations_to_the_last_digit(case: MotionCase) -> None:
    """Beyond doubles nothing is lost on the way: what is left is the rounding of the result."""
    for n in (0, 1):
        assert error(case, n, TIGHTEST) <= ROUNDING


# In a thousand rotations they pass by an unstable motion again and again, or come to rest on it.
BEYOND = (
    "1e-14",
    "1e-12, both",
    "separatrix: towards",
    "separatrix: from",
    "unstable: 1e-6",
    "pushed 1e-9",
    "asleep",
    "to the top",
)


@named(
    (case for case in CASES if not any(name in case.name for name in BEYOND)),
    long=("thin: needle", "thin: needle, spinning", "full tensor: thin", "long axis: T-handle"),
)
def test_a_thousand_rotations_to_the_last_digit(case: MotionCase) -> None:
    assert error(case, 2, 1e-27) <= ROUNDING


class TestBeyondDoubles:
    @pytest.mark.parametrize("seed", range(12))
    def test_doubles_are_wrong_by_no_more_than_doubles_are(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        body = RigidBody.from_particles(
            rng.uniform(0.1, 1.0, 6), rng.normal(size=(6, 3)) * 10.0 ** rng.uniform(-9, 9)
        )
        inertia, mass = body.inertia_about((0.0, 0.0, 0.0)), body.mass
        rate = 10.0 ** rng.uniform(-6, 6)
        omega, attitude = rate * rng.normal(size=3), rng.normal(size=4)
        attitude /= np.linalg.norm(attitude)
        torque = 0.3 * rate**2 * float(np.trace(inertia)) * rng.normal(size=3)
        lever = mass * float(np.linalg.norm(body.center_of_mass))
        load = (
            loads.constant_torque(torque, "space"),
            loads.constant_torque(torque, "body"),
            loads.damping(0.1 * rate * inertia),
            loads.uniform_gravity(torque / lever),
        )[seed % 4]
        t = [0.0, 12.0 / float(np.linalg.norm(omega))]

        def end(omega: Any, attitude: Any, rtol: float = 1e-24) -> Any:
            run = body.simulate(t, omega, attitude, load=load, about="origin", method="taylor", rtol=rtol)
            return run.quaternion[-1], run.omega[-1] / rate

        def apart(a: Any, b: Any) -> np.ndarray:
            turn = 2 * product(b[0] * [-1, -1, -1, 1], a[0])
            return np.concatenate([turn[:3] * np.sign(turn[3]), a[1] - b[1]])

        exact, small, columns = end(omega, attitude), 1e-7, []
        for k in range(6):
            turn, push = np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3)
            (turn if k < 3 else push)[k % 3] = small / 2 if k < 3 else small * rate
            moved = end(omega + push, product(attitude, turn / np.linalg.norm(turn)))
            columns.append(apart(moved, exact) / small)
        kappa = float(np.linalg.norm(np.array(columns), 2))
        assert float(np.linalg.norm(apart(end(omega, attitude, TIGHTEST_IN_DOUBLES), exact))) <= (
            1e-13 + 30 * 1.1e-16 * kappa
        )

    def test_a_row_alone_has_the_bits_of_the_row_in_the_stack(self, rng: Any) -> None:
        t, starts, load = [0.0, 3.0, 8.0], rng.normal(size=(5, 3)), loads.constant_torque((0.1, 0.0, 0.2))
        together = BRICK.simulate(t, starts, load=load, rtol=1e-22)
        for row, start in enumerate(starts):
            alone = BRICK.simulate(t, start, load=load, rtol=1e-22)
            assert np.array_equal(alone.omega, together.omega[row])
            assert np.array_equal(alone.quaternion, together.quaternion[row])

    def test_auto_takes_it_for_a_free_body(self) -> None:
        t, start = [0.0, 20.0], (0.3, 1.0, 0.2)
        auto = BRICK.simulate(t, start, rtol=1e-24)
        assert auto.steps > 0
        assert np.array_equal(auto.omega, BRICK.simulate(t, start, rtol=1e-24, method="taylor").omega)
        assert np.abs(auto.omega - BRICK.simulate(t, start).omega).max() < 1e-14

    @pytest.mark.parametrize("method", ["exact", "dop853", "radau", "splitting"])
    def test_the_others_say_what_they_need(self, method: Any) -> None:
        with pytest.raises(ValueError, match=r'needs an rtol of 2.3e-15 or more.*method="taylor"'):
            BRICK.simulate([0.0, 1.0], (1.0, 0.0, 0.0), method=method, rtol=1e-20)

    def test_what_taylor_cannot_serve_is_not_served(self) -> None:
        callback = loads.torque_callback(lambda _t, _omega, _quaternion: np.zeros(3))
        with pytest.raises(ValueError, match=r"rtol must be 2.3e-15 or more"):
            BRICK.simulate([0.0, 1.0], (1.0, 0.0, 0.0), load=callback, rtol=1e-20)
        with pytest.raises(ValueError, match=r"rtol must be between 1e-28 and 0.1"):
            BRICK.simulate([0.0, 1.0], (1.0, 0.0, 0.0), rtol=1e-29)

    def test_events_are_those_of_doubles(self) -> None:
        """A torque in space on a brick: where the first component of the quaternion changes its sign."""
        load, t = loads.constant_torque((0.1, 0.2, 0.3), "space"), [0.0, 20.0]

        def changes(_t: float, _omega: Any, q: Any, _x: Any, _v: Any) -> float:
            return float(q[0])

        times = [
            BRICK.simulate(t, (0.5, -1.0, 0.25), load=load, events=changes, rtol=rtol).events.t
            for rtol in (TIGHTEST_IN_DOUBLES, 1e-24)
        ]
        assert len(times[0]) > 3
        np.testing.assert_allclose(times[0], times[1], rtol=1e-14)

    def test_samples_of_a_cubic_are_the_cubic(self) -> None:
        """N = t³ about an axis, in dyadic samples: ω = t⁴/4 I."""
        knots = np.arange(6.0)
        torque = np.outer(knots**3, (0.0, 0.0, 1.0))
        body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        run = body.simulate(
            np.linspace(0.0, 5.0, 9), np.zeros(3), load=loads.sampled(knots, torque), rtol=1e-24
        )
        # The spline is found in doubles.
        np.testing.assert_allclose(run.omega[:, 2], run.t**4 / 10.0, rtol=3e-16, atol=1e-15)


class TestStacks:
    @pytest.mark.parametrize("load", [None, loads.uniform_gravity((0.0, 0.0, -9.81))])
    def test_a_row_alone_has_the_bits_of_the_row_in_the_stack(self, load: Any, rng: Any) -> None:
        body, t = BRICK.translated((1.0, 0.5, 2.0)), np.linspace(0.0, 20.0, 7)
        starts = rng.normal(size=(50, 3))
        together = body.simulate(t, starts, load=load, about="origin", method="taylor")
        for row in range(0, 50, 7):
            alone = body.simulate(t, starts[row], load=load, about="origin", method="taylor")
            assert np.array_equal(alone.omega, together.omega[row])
            assert np.array_equal(alone.quaternion, together.quaternion[row])
            assert alone.steps == together.steps[row]

    def test_loads_differ_from_row_to_row(self) -> None:
        torques = np.array([[0.0, 0.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
        t = [0.0, 3.0]
        together = BRICK.simulate(t, np.zeros(3), load=loads.constant_torque(torques), method="taylor")
        for row, torque in enumerate(torques):
            alone = BRICK.simulate(t, np.zeros(3), load=loads.constant_torque(torque), method="taylor")
            assert np.array_equal(alone.omega, together.omega[row])


class TestChoice:
    def test_auto_takes_it_for_analytic_loads(self) -> None:
        load = loads.constant_torque((0.1, 0.2, 0.3), "space")
        t, start = np.linspace(0.0, 9.0, 5), (0.5, -1.0, 0.25)
        auto = BRICK.simulate(t, start, load=load)
        named = BRICK.simulate(t, start, load=load, method="taylor")
        assert np.array_equal(auto.omega, named.omega)
        assert np.array_equal(auto.quaternion, named.quaternion)
        other = BRICK.simulate(t, start, load=load, method="dop853", rtol=1e-13)
        assert np.abs(named.omega - other.omega).max() < 1e-9

    def test_it_says_what_it_needs(self) -> None:
        callback = loads.torque_callback(lambda _t, _omega, _quaternion: np.zeros(3))
        with pytest.raises(ValueError, match=r'"taylor" needs .*callbacks.*method="dop853"'):
            BRICK.simulate([0.0, 1.0], (1.0, 0.0, 0.0), load=callback, method="taylor")


@pytest.mark.alone
@pytest.mark.parametrize("count", [1, 3000])
def test_ctrl_c_ends_a_long_run_soon(count: int) -> None:
    starts = np.ones((count, 3)) if count > 1 else np.ones(3)
    threading.Timer(0.3, _thread.interrupt_main).start()
    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        BRICK.simulate([0.0, 1e9], starts, method="taylor")
    assert time.perf_counter() - began < 1.0
