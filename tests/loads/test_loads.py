"""Loads that are Python functions: what they see, what they may return, how they stop a run."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, loads
from polhode.errors import IntegrationError
from scipy.spatial.transform import Rotation

BODY = RigidBody(1.0, np.array([[3.0, 0.2, -0.1], [0.2, 2.0, 0.3], [-0.1, 0.3, 4.0]]))
RATES = (0.5, -1.0, 0.25)
TORQUE = (0.1, -0.2, 0.3)


def constant(value: Any) -> Callable[[float, Any, Any], Any]:
    """A load's function that returns `value` whatever happens."""
    return lambda _t, _omega, _quaternion: value


class TestCallback:
    def test_a_callback_that_returns_a_constant_is_the_constant_torque(self) -> None:
        t = np.linspace(0, 10, 11)
        want = BODY.simulate(t, RATES, load=loads.constant_torque(TORQUE), method="dop853")
        for value in (TORQUE, list(TORQUE), np.array(TORQUE), np.array(TORQUE, dtype=np.float64)[::1]):
            got = BODY.simulate(t, RATES, load=loads.torque_callback(constant(value)))
            assert np.array_equal(got.omega, want.omega)
            assert np.array_equal(got.quaternion, want.quaternion)

    def test_it_sees_time_rates_and_attitude(self) -> None:
        seen: list[tuple[float, Any, Any]] = []

        def look(t: float, omega: Any, quaternion: Any) -> Any:
            seen.append((t, omega.copy(), quaternion.copy()))
            return (0.0, 0.0, 0.0)

        BODY.simulate([2.0, 3.0], RATES, (0.5, 0.5, 0.5, 0.5), load=loads.torque_callback(look))
        t, omega, quaternion = seen[0]
        assert (type(t), omega.shape, quaternion.shape) == (float, (3,), (4,))
        assert t == 2.0
        assert np.abs(omega - RATES).max() < 1e-15
        assert np.abs(quaternion - 0.5).max() < 1e-15
        assert all(2.0 <= when <= 3.1 for when, _, _ in seen)

    def test_what_it_keeps_is_not_overwritten(self) -> None:
        kept: list[Any] = []

        def keep(_t: float, omega: Any, _quaternion: Any) -> Any:
            kept.append(omega)
            return (0.0, 0.0, 0.0)

        BODY.simulate([0.0, 5.0], RATES, load=loads.torque_callback(keep))
        assert np.abs(kept[0] - RATES).max() < 1e-15
        assert np.abs(kept[0] - kept[-1]).max() > 0.1

    def test_damping_slows_exponentially(self) -> None:
        ball = RigidBody(1.0, 2.0 * np.eye(3))
        t = np.linspace(0, 3, 7)
        trajectory = ball.simulate(
            t, RATES, load=loads.torque_callback(lambda _t, w, _q: -0.5 * w), rtol=1e-12
        )
        assert np.abs(trajectory.omega - np.exp(-0.25 * t)[:, None] * RATES).max() < 1e-11

    def test_a_torque_of_time_alone_integrates(self) -> None:
        ball = RigidBody(1.0, np.eye(3))
        load = loads.torque_callback(lambda t, _w, _q: (0.0, 0.0, np.cos(t)))
        t = np.linspace(1, 9, 9)
        trajectory = ball.simulate(t, (0, 0, 0), load=load, rtol=1e-12)
        assert np.abs(trajectory.omega[:, 2] - (np.sin(t) - np.sin(1))).max() < 1e-11

    def test_it_adds_to_other_loads(self) -> None:
        t = np.linspace(0, 10, 11)
        half = tuple(x / 2 for x in TORQUE)
        both = loads.torque_callback(lambda _t, _w, _q: half) + loads.constant_torque(half)
        want = BODY.simulate(t, RATES, load=loads.constant_torque(TORQUE), method="dop853")
        assert np.abs(BODY.simulate(t, RATES, load=both).omega - want.omega).max() < 1e-13

    def test_in_a_stack_it_is_asked_row_by_row(self) -> None:
        stack = RigidBody.stack([BODY, BODY.scaled(mass=2.0)])

        def look(_t: float, omega: Any, quaternion: Any) -> Any:
            assert (omega.shape, quaternion.shape) == ((3,), (4,))
            return TORQUE

        load = loads.torque_callback(look)
        together = stack.simulate([0.0, 1.0], RATES, load=load)
        assert np.array_equal(together.omega[0], BODY.simulate([0.0, 1.0], RATES, load=load).omega)

    def test_what_it_does_to_its_arguments_stays_with_it(self) -> None:
        def scribble(_t: float, omega: Any, quaternion: Any) -> Any:
            omega[:] = 99.0
            quaternion[:] = 0.0
            return (0.0, 0.0, 0.0)

        free = BODY.simulate([0.0, 5.0], RATES, method="dop853")
        scribbled = BODY.simulate([0.0, 5.0], RATES, load=loads.torque_callback(scribble))
        assert np.array_equal(scribbled.omega, free.omega)

    def test_it_may_simulate_itself(self) -> None:
        def nested(_t: float, omega: Any, _quaternion: Any) -> Any:
            return 0 * BODY.simulate([0.0, 0.1], omega).omega[-1]

        free = BODY.simulate([0.0, 1.0], RATES, method="dop853")
        assert np.array_equal(
            BODY.simulate([0.0, 1.0], RATES, load=loads.torque_callback(nested)).omega, free.omega
        )


class TestScaling:
    """A load is scaled by one real number, whoever's it is, and by nothing else."""

    @pytest.mark.parametrize(
        "two",
        [
            2,
            2.0,
            Fraction(2),
            np.int64(2),
            np.uint8(2),
            np.float32(2),
            np.float64(2),
            np.array(2.0),
            np.array(2),
        ],
    )
    def test_by_a_number_of_any_kind(self, two: Any) -> None:
        load = loads.constant_torque((0, 0, 1.5))
        for scaled in (load * two, two * load):
            assert repr(scaled) == "<Load: 2.0 * constant_torque>"
            assert scaled.torque(0.0, RATES, (0, 0, 0, 1))[2] == 3.0

    @pytest.mark.parametrize(
        "factor",
        [
            *(
                np.ma.masked_array(2.0),
                np.ma.masked_array([1.0, 2.0], [False, True]),
                np.ones(2),
                np.ones((1,)),
            ),
            *(np.array(1j), [2.0], "2", 1j, np.complex128(1), None, loads.constant_torque((0, 0, 1))),
        ],
        ids=repr,
    )
    def test_by_anything_else_it_is_refused(self, factor: Any) -> None:
        load = loads.constant_torque((0, 0, 1.5))
        refused = r"a load is scaled by one number|unsupported operand|can't multiply|not support ufuncs"
        with pytest.raises(TypeError, match=refused):
            load * factor
        with pytest.raises(TypeError, match=refused):
            factor * load


class TestMistakes:
    @pytest.mark.parametrize(
        "kind", [RuntimeError, ZeroDivisionError, KeyboardInterrupt, StopIteration, ValueError]
    )
    def test_the_users_own_exception_comes_back_as_it_was(self, kind: type[BaseException]) -> None:
        error, calls = kind("mine"), []

        def fail(_t: float, _omega: Any, _quaternion: Any) -> Any:
            calls.append(1)
            if len(calls) > 30:
                raise error
            return TORQUE

        with pytest.raises(kind) as caught:
            BODY.simulate([0.0, 1e3], RATES, load=loads.torque_callback(fail))
        assert caught.value is error
        assert len(calls) == 31
        assert any("fail" in str(entry.name) for entry in caught.traceback)

    @pytest.mark.parametrize(
        "value", [(1.0, 2.0), 1.0, np.zeros((3, 3)), None, "abc", ("a", "b", "c"), (1j, 0, 0)]
    )
    def test_what_is_no_torque_is_named(self, value: Any) -> None:
        with pytest.raises((TypeError, ValueError), match=r"(?i)callback|torque"):
            BODY.simulate([0.0, 1.0], RATES, load=loads.torque_callback(lambda _t, _w, _q: value))

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    def test_a_torque_that_is_no_number_names_the_time(self, value: float) -> None:
        def late(t: float, _omega: Any, _quaternion: Any) -> Any:
            return (0.0, value if t > 1.0 else 0.0, 0.0)

        with pytest.raises(ValueError, match=r"(?i)torque|finite|nan|inf"):
            BODY.simulate([0.0, 5.0], RATES, load=loads.torque_callback(late))

    def test_a_function_is_needed(self) -> None:
        with pytest.raises(TypeError, match=r"call|function"):
            loads.torque_callback(3)  # type: ignore[arg-type]
        with pytest.raises(TypeError, match=r"(?i)load"):
            BODY.simulate([0.0, 1.0], RATES, load=lambda _t, _w, _q: TORQUE)  # type: ignore[arg-type]
        with pytest.raises(TypeError):
            loads.constant_torque(TORQUE) + 1  # type: ignore[operator]

    def test_constant_torques_are_checked(self) -> None:
        with pytest.raises(ValueError, match="vector"):
            loads.constant_torque((1.0, 2.0))
        with pytest.raises(ValueError, match="vector"):
            loads.constant_torque((1.0, 2.0, np.nan))
        with pytest.raises(ValueError, match="frame"):
            loads.constant_torque(TORQUE, frame="inertial")  # type: ignore[arg-type]


class TestBlowUp:
    def test_a_motion_that_leaves_every_bound_is_told_with_time_state_and_what_was_done(self) -> None:
        """ω̇ = ω² has a pole at t = 1/ω₀ = 2."""
        ball = RigidBody(1.0, np.eye(3))
        load = loads.torque_callback(lambda _t, w, _q: (0.0, 0.0, w[2] ** 2))
        with pytest.raises(IntegrationError) as caught:
            ball.simulate([0.0, 1.0, 1.5, 3.0], (0.0, 0.0, 0.5), load=load)
        error = caught.value
        assert error.time == pytest.approx(2.0, abs=1e-6)
        quaternion, omega = error.state
        assert np.asarray(quaternion).shape == (4,)
        assert np.asarray(omega)[2] > 1e3
        assert error.partial is not None
        rates = error.partial.omega[:, 2]
        assert rates[:3] == pytest.approx([0.5, 1.0, 2.0], rel=1e-8)
        assert np.isnan(rates[3])
        assert "2.0" in str(error) or "1.99" in str(error)

    def test_in_a_stack_the_row_is_named_and_the_others_are_kept(self) -> None:
        stack = RigidBody.stack([RigidBody(1.0, np.eye(3))] * 3)
        load = loads.torque_callback(lambda _t, w, _q: (0.0, 0.0, w[2] ** 2))
        with pytest.raises(IntegrationError, match=r"\b1\b") as caught:
            stack.simulate([0.0, 1.0, 3.0], [[0, 0, 0.1], [0, 0, 0.5], [0, 0, 0.6]], load=load)
        assert caught.value.partial is not None
        rates = caught.value.partial.omega[..., 2]
        assert rates[0] == pytest.approx([0.1, 1 / 9, 1 / 7], rel=1e-8)
        assert rates[1, :2] == pytest.approx([0.5, 1.0], rel=1e-8)
        assert np.isnan(rates[1:, 2]).all()


INTERRUPT = """
import os, signal, threading, time
import numpy as np
from polhode import RigidBody, loads
body = RigidBody(1.0, np.diag([1.0, 2.0, 2.5]))
run = {run}
struck = []
def strike():
    struck.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(0.5, strike).start()
try:
    run()
except KeyboardInterrupt:
    print(time.perf_counter() - struck[0])
else:
    print("ended by itself")
"""

LONG_RUNS = {
    "dop853": "lambda: body.simulate([0.0, 1e9], (1.0, 1e-3, 1.0), method='dop853')",
    "taylor": "lambda: body.simulate([0.0, 1e9], (1.0, 1e-3, 1.0), method='taylor')",
    "a stack by dop853": "lambda: body.simulate([0.0, 1e8], np.ones((64, 3)) + np.arange(64)[:, None],"
    " method='dop853')",
    "a stack by taylor": "lambda: body.simulate([0.0, 1e8], np.ones((64, 3)) + np.arange(64)[:, None],"
    " method='taylor')",
    "events": "lambda: body.simulate([0.0, 1e9], (1.0, 1e-3, 1.0), events=lambda t, *_: 1.0)",
    "dense output": "lambda: body.simulate(np.linspace(0.0, 1e9, 100_000), (1.0, 1e-3, 1.0),"
    " method='dop853')",
    "a callback": "lambda: body.simulate([0.0, 1e9], (1.0, 1e-3, 1.0),"
    " load=loads.torque_callback(lambda t, w, q: (0.0, 0.0, 0.0)))",
}


@pytest.mark.alone
@pytest.mark.parametrize("name", LONG_RUNS)
def test_ctrl_c_ends_a_long_run_within_a_fifth_of_a_second(name: str) -> None:
    """In a process of its own; the timer's thread also shows that the run leaves others alive."""
    script = INTERRUPT.format(run=LONG_RUNS[name])
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) < 0.2


class TestProgress:
    def test_the_fraction_done_rises_to_one_at_most(self) -> None:
        seen: list[float] = []
        BODY.simulate([0.0, 2e4], RATES, progress=seen.append, method="dop853")
        assert seen
        assert all(isinstance(x, float) for x in seen)
        assert seen == sorted(seen)
        assert 0 <= seen[0] <= seen[-1] <= 1

    def test_its_exception_comes_back_as_it_was(self) -> None:
        error = RuntimeError("stop here")

        def stop(_fraction: float) -> None:
            raise error

        with pytest.raises(RuntimeError) as caught:
            BODY.simulate([0.0, 1e7], RATES, progress=stop, method="dop853")
        assert caught.value is error


class TestTorque:
    """What a load exerts at a time and a state, asked for outside a run."""

    def test_terms_in_body_and_in_space(self, rng: np.random.Generator) -> None:
        load = loads.constant_torque(TORQUE) + loads.constant_torque((1.0, 2.0, 3.0), "space")
        q = rng.normal(size=(7, 4))
        turn = Rotation.from_quat(q)
        got = load.torque(0.0, RATES, turn)
        assert np.abs(got - TORQUE - turn.inv().apply((1.0, 2.0, 3.0))).max() < 1e-14

    def test_functions_see_each_row(self) -> None:
        load = loads.torque_callback(lambda t, omega, q: t * omega + q[:3])
        t, omega = np.array([1.0, 2.0]), np.ones((3, 1, 3))
        got = load.torque(t, omega, (0.6, 0.0, 0.0, 0.8))
        assert got.shape == (3, 2, 3)
        assert np.array_equal(got[1], [[1.6, 1.0, 1.0], [2.6, 2.0, 2.0]])

    def test_errors(self) -> None:
        def fail(_t: float, _omega: Any, _q: Any) -> Any:
            raise KeyError("its own")

        with pytest.raises(KeyError, match="its own"):
            loads.torque_callback(fail).torque(0.0, RATES, (0, 0, 0, 1))
        load = loads.constant_torque(TORQUE)
        with pytest.raises(ValueError, match=r"row 1: quaternion must be a unit quaternion"):
            load.torque(0.0, RATES, [(0, 0, 0, 1), (0, 0, 0, 2)])
        got = load.torque([0.0, 1.0], RATES, [(0, 0, 0, 1), (np.nan,) * 4])
        assert np.array_equal(got[0], TORQUE)
        assert np.isnan(got[1]).all()
        with pytest.raises(ValueError, match="omega: expected shape"):
            load.torque(0.0, 1.0, (0, 0, 0, 1))

    def test_pickle_and_copy(self) -> None:
        load = loads.constant_torque(TORQUE, "space") + loads.torque_callback(module_level)
        state = (0.5, RATES, (0.0, 0.6, 0.0, 0.8))
        for again in (pickle.loads(pickle.dumps(load)), copy.copy(load), copy.deepcopy(load)):
            assert repr(again) == repr(load)
            assert np.array_equal(again.torque(*state), load.torque(*state))


def module_level(t: float, omega: Any, _quaternion: Any) -> Any:
    """A function that pickle finds by its name."""
    return t * omega
