"""What wheels, slugs, states and gyrostats did wrong when attacked; each marked until it is mended."""

from __future__ import annotations

import copy
import ctypes
import math
import pickle
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from oracles.wheels import turned, turning
from polhode import Event, RigidBody, Trajectory, loads
from polhode.errors import InvalidInertiaError, PolhodeError
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
OMEGA = np.array([0.3, 1.0, 0.2])


class TestWrongInSilence:
    @pytest.mark.parametrize("axis", [(1, 2, 2), (1, 1, 1), (1, 2, 3)])
    def test_a_free_wheel_in_a_sphere(self, axis: tuple[int, ...]) -> None:
        ball = RigidBody.from_principal(1.0, (1, 1, 1))
        motion = ball.gyrostat(wheels=[polhode.wheel(axis=axis, inertia=0.1, rate=10.0)]).free_motion(OMEGA)
        assert np.abs(motion.at(0.0).omega - OMEGA).max() < 1e-12
        run = ball.simulate([0, 1], OMEGA, load=loads.wheel(axis, 0.1, 10.0), rtol=1e-14)
        assert np.abs(motion.at(1.0).omega - run.omega[-1]).max() < 1e-12

    @pytest.mark.parametrize("seed", [3, 4, 5])
    def test_a_free_wheel_along_the_axis_of_symmetry(self, seed: int) -> None:
        axes = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
        body = RigidBody.from_principal(1.0, (1, 1, 2), axes=axes)
        wheel = polhode.wheel(axis=body.principal.axes[:, 2], inertia=0.1, rate=10.0)
        assert np.abs(body.gyrostat(wheels=[wheel]).free_motion(OMEGA).at(0.0).omega - OMEGA).max() < 1e-12

    def test_the_bifurcations_do_not_depend_on_axes(self) -> None:
        ball = RigidBody.from_principal(1.0, (1, 1, 1))
        found = [
            ball.gyrostat(wheels=[polhode.wheel(axis=axis, inertia=0.1, rate=10.0)])
            .free_motion(np.array([0.3, 0.2, 1.1]))
            .equilibria()
            .bifurcations.meeting.tolist()
            for axis in ((0, 0, 1), (1, 2, 2))
        ]
        assert found[0] == found[1]

    @pytest.mark.parametrize("method", ["auto", "taylor", "dop853"])
    def test_a_gravity_gradient_pulls_the_wheels_too(self, method: Any) -> None:
        tensor, inertia, axis = np.diag([1.0, 2.0, 2.5]), 0.5, np.array([0.48, 0.6, 0.64])
        position, velocity = np.array([2.0, 0, 0]), np.array([0, np.sqrt(1.5), 0])
        mass = np.eye(4) * inertia
        mass[:3, :3], mass[:3, 3], mass[3, :3] = tensor, inertia * axis, inertia * axis

        def rates(_: float, y: np.ndarray) -> np.ndarray:
            q, w, r = y[:4], y[4:7], y[8:11]
            d = np.linalg.norm(r)
            n = turned(q).T @ r / d
            torque = 9.0 / d**3 * np.cross(n, tensor @ n)
            spin = tensor @ w + inertia * y[7] * axis
            push = np.linalg.solve(mass, np.append(torque - np.cross(w, spin), 0.0))
            return np.concatenate([turning(q, w), push, y[11:], -3.0 * r / d**3])

        start = np.concatenate([[0, 0, 0, 1], OMEGA, [2.0], position, velocity])
        exact = solve_ivp(rates, (0, 5), start, "DOP853", rtol=1e-12, atol=1e-13).y[4:7, -1]
        load = loads.gravity_gradient(3.0, position=position, velocity=velocity)
        load = load + loads.wheel(axis, inertia, 2.0)
        assert np.abs(BODY.simulate([0, 5], OMEGA, load=load, method="dop853").omega[-1] - exact).max() < 1e-7
        assert np.abs(BODY.simulate([0, 5], OMEGA, load=load, method=method).omega[-1] - exact).max() < 1e-7

    @pytest.mark.parametrize("method", ["dop853", "radau"])
    @pytest.mark.parametrize(
        "carried",
        [
            loads.wheel((0, 0, 1), 0.2, 60.0),
            loads.slug(0.1, 0.1),
            loads.wheel((0, 0, 1), 0.2, speed=3.0),
            loads.with_states(lambda *_: [1.0], [0.0]),
        ],
        ids=["wheel", "slug", "speed", "states"],
    )
    def test_a_pivot_holds(self, method: Any, carried: loads.Load) -> None:
        body = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5), center_of_mass=(0.1, 0, 0.3))
        run = body.simulate(
            [0, 1, 3],
            (0.1, 0, 0),
            load=loads.uniform_gravity((0, 0, -9.8)) + carried,
            about="origin",
            method=method,
        )
        assert not run.position.any()
        assert not run.velocity.any()
        assert np.abs(run.kinetic_energy().translational).max() == 0

    def test_functions_see_the_pivot_at_rest(self) -> None:
        body = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5), center_of_mass=(0.1, 0, 0.3))

        def wrench(_t: float, _w: Any, _q: Any, r: Any, *_: Any) -> Any:
            return (0, 0, -1.0), (r[2], 0, 0)

        load = loads.with_states(None, [0.0], wrench)
        run = body.simulate([0, 2], (0, 0, 1.0), load=load, about="origin")
        plain = body.simulate([0, 2], (0, 0, 1.0), about="origin")
        assert np.abs(run.omega[-1] - plain.omega[-1]).max() < 1e-9

    def test_a_gyrostat_goes_on_as_one(self) -> None:
        motion = BODY.gyrostat((0, 0.3, 0.5)).free_motion(OMEGA)
        went_on = motion.at(np.array([0.0, 1.0])).resume([1.0, 2.0])
        assert np.abs(went_on.omega[-1] - motion.at(2.0).omega).max() < 1e-9

    def test_a_gyrostat_accelerates(self) -> None:
        motion = BODY.gyrostat((0, 0.3, 0.5)).free_motion(OMEGA)
        slope = (motion.at(1 + 1e-5).omega - motion.at(1 - 1e-5).omega) / 2e-5
        assert np.abs(motion.at(1.0).angular_acceleration() - slope).max() < 1e-8

    def test_a_gyrostat_is_sensitive_as_one(self) -> None:
        gyrostat = BODY.gyrostat((0, 0.3, 0.5))
        found = gyrostat.free_motion(OMEGA).at(np.array([0.0, 2.0])).sensitivity().state[-1, 3:, 3:]
        steps = 1e-6 * np.eye(3)
        ends = [[gyrostat.free_motion(OMEGA + s * d).at(2.0).omega for s in (1, -1)] for d in steps]
        expected = np.array([(a - b) / 2e-6 for a, b in ends]).T
        assert np.abs(found - expected).max() < 1e-7

    @pytest.mark.parametrize("load", [loads.rotor((0, 0, 3.0)), loads.constant_torque((0, 0, 3.0))])
    def test_a_load_that_the_file_lost_is_missed(self, tmp_path: Path, load: loads.Load) -> None:
        run = BODY.simulate([0, 1], OMEGA, load=load)
        run.save(tmp_path / "motion.json")
        again = Trajectory.from_file(tmp_path / "motion.json")
        with pytest.raises(ValueError, match="load"):
            again.resume([1, 2])

    @pytest.mark.parametrize("names", [("wheel_2", "wheel"), ("a_3", "a", "a")])
    def test_every_state_has_a_name(self, names: tuple[str, ...]) -> None:
        load: Any = sum(loads.wheel((0, 0, 1), 0.1, k + 1.0, name=name) for k, name in enumerate(names))
        assert len(BODY.simulate([0, 1], OMEGA, load=load).states) == len(names)

    def test_a_rod_cannot_resist_a_wheel(self) -> None:
        rod = RigidBody.from_principal(1.0, (0, 1, 1))
        with pytest.raises(InvalidInertiaError):
            rod.simulate([0, 1], (2, 1, 0.5), load=loads.wheel((0, 1, 0), 0.1, speed=30.0))

    @pytest.mark.parametrize("name", ["omega", "position", "velocity", "time", "component"])
    def test_names_of_the_motion_are_taken(self, name: str) -> None:
        with pytest.raises(ValueError, match="is a name of the motion itself"):
            loads.slug(0.1, 0.1, name=name)

    def test_states_that_are_not_taken_are_refused(self) -> None:
        load = loads.wheel((0, 0, 1), 0.1, speed=3.0)
        kept = 0.1 * (3.0 + OMEGA[2])
        with pytest.raises(ValueError, match=r"states: a wheel whose speed is known has the momentum 0\.32"):
            BODY.simulate([0, 1], OMEGA, load=load, states={"wheel": [99.0]})
        with pytest.raises(ValueError, match="states: a wheel whose speed is known"):
            BODY.simulate([0, 1], OMEGA, load=load, states={"wheel": [kept * (1 + 3e-9)]})
        with pytest.raises(ValueError, match="states: a wheel whose speed is known"):
            load.torque(0.0, OMEGA, (0, 0, 0, 1), states={"wheel": [99.0]})
        run = BODY.simulate([0, 1], OMEGA, load=load, states={"wheel": [kept * (1 + 3e-10)]})
        again = run.resume([1, 2])
        assert np.abs(again.omega[-1] - BODY.simulate([0, 2], OMEGA, load=load).omega[-1]).max() < 1e-9

    @pytest.mark.parametrize("power", range(1, 13))
    def test_a_thin_gyrostat_is_right_or_refused(self, power: int) -> None:
        body = RigidBody.from_principal(1.0, (10.0**-power, 1.0, 1.0 + 0.3 * 10.0**-power))
        rng = np.random.default_rng(power)
        for _ in range(50):
            h, omega = rng.normal(size=3) * 10 ** rng.uniform(-6, 1), rng.normal(size=3)
            try:
                motion = body.gyrostat(h).free_motion(omega)
            except PolhodeError as error:
                assert power >= 6
                assert "loads.rotor(momentum)" in str(error)  # noqa: PT017
                continue
            off = np.abs(motion.at(0.0).omega - omega).max() / np.abs(omega).max()
            assert off <= min(1e-15 * 10.0**power, 1e-9)

    @pytest.mark.parametrize("power", [5, 10, 16, 18, 20, 22, 26, 40, 310])
    def test_a_gyrostat_that_hardly_turns_is_right_or_refused(self, power: int) -> None:
        omega, gyrostat = OMEGA * 10.0**-power, BODY.gyrostat((0.1, 0.2, 0.3))
        if power > 25:
            with pytest.raises(
                PolhodeError, match="the closed form would give ω at the start with an error of"
            ):
                gyrostat.free_motion(omega)
            return
        motion = gyrostat.free_motion(omega)
        run = BODY.simulate([0, 1, 10], omega, load=loads.rotor((0.1, 0.2, 0.3)), method="taylor", rtol=1e-20)
        off = np.abs(motion.at([0, 1, 10]).omega - run.omega).max() / np.abs(omega).max()
        assert off <= max(3e-15, 1e-31 * 10.0**power)

    def test_equilibria_of_a_tiny_momentum(self) -> None:
        for size in (1e-160, 1.01e-290):
            assert np.isfinite(BODY.gyrostat((0, 0, 1.0)).equilibria(size).direction).all()
        with pytest.raises(PolhodeError, match="momentum must be at least 1e-290 times the momentum inside"):
            BODY.gyrostat((0, 0, 1.0)).equilibria(0.99e-290)

    def test_equilibria_of_a_huge_momentum(self) -> None:
        plain, huge = BODY.gyrostat((0, 1.0, 0)).equilibria(2.0), BODY.gyrostat((0, 2.0**1020, 0))
        assert np.array_equal(huge.equilibria(2.0**1021).direction, plain.direction)

    def test_wheels_never_change(self) -> None:
        axis = np.array([0.0, 0.0, 1.0])
        gyrostat = BODY.gyrostat(wheels=[polhode.wheel(axis=axis, inertia=0.1, rate=3.0)])
        axis[:] = (1, 0, 0)
        assert pickle.loads(pickle.dumps(gyrostat)) == gyrostat


class TestAfterTheEnd:
    """States after the end of a run are not numbers, and what carries them must bear it."""

    @staticmethod
    def ended() -> Trajectory:
        end = Event(lambda t, *_: t - 1.5, terminal=True)
        return BODY.simulate([0, 1, 2], OMEGA, load=loads.wheel((0, 0, 1), 0.1, 3.0), events=end)

    @pytest.mark.parametrize(
        "ask",
        [
            lambda run: run.angular_momentum(),
            lambda run: run.kinetic_energy(),
            lambda run: run.invariants(),
            lambda run: run.torque(),
            lambda run: run.angular_acceleration(),
            lambda run: pickle.dumps(run),
            copy.deepcopy,
            lambda run: hasattr(run, "carried"),
        ],
        ids=["L", "T", "invariants", "torque", "acceleration", "pickle", "copy", "hasattr"],
    )
    def test_all_can_be_asked(self, ask: Callable[[Trajectory], Any]) -> None:
        ask(self.ended())

    @pytest.mark.parametrize("name", ["motion.json", "motion.npz"])
    def test_it_can_be_saved(self, tmp_path: Path, name: str) -> None:
        self.ended().save(tmp_path / name)

    def test_the_other_bodies_are_told(self) -> None:
        bodies = RigidBody.from_principal(np.ones(2), [(1, 2, 2.5), (0.05, 0.05, 0.05)])
        load = loads.wheel((0, 0, 1), 0.1, 3.0)
        run = bodies.simulate([0, 1], OMEGA, load=load, on_failure="keep")
        assert np.isfinite(run.angular_momentum().spin[0]).all()


class TestCrashes:
    @pytest.mark.parametrize("method", ["dop853", "radau"])
    def test_many_wheels(self, method: Any) -> None:
        def run(count: int) -> Trajectory:
            load: Any = sum(loads.wheel((0, 0, 1), 0.001, 1.0) for _ in range(count))
            return BODY.simulate([0, 1], OMEGA, load=load, method=method)

        assert len(run(51).states) == 51
        with pytest.raises(ValueError, match="a load with 51 states of its own at most"):
            run(52)


class TestErrors:
    def test_a_state_from_zero_in_a_long_run(self) -> None:
        load = loads.with_states(lambda _t, w, *_: [w[0]], [0.0])
        found = []

        def look(fraction: float) -> None:
            found.append(fraction)
            raise StopIteration

        with pytest.raises(StopIteration):  # once it has begun all is well
            BODY.simulate([0, 1e7], (1, 1, 1), load=load, progress=look)
        assert found

    @pytest.mark.parametrize("method", ["dop853", "radau"])
    @pytest.mark.parametrize("scale", [1.0, None])
    @pytest.mark.parametrize("count", [4, 6])
    def test_a_chain_of_lags_from_zero(self, count: int, scale: float | None, method: Any) -> None:
        """The last of them grows as that power of the time: xₖ = 1 - exp(-10 t) Σ (10 t)ʲ/j!, j < k."""

        def rates(*arguments: Any) -> Any:
            x = arguments[-1]["x"]
            return 10 * (np.concatenate([[1.0], x[:-1]]) - x)

        load = loads.with_states(rates, np.zeros(count), name="x", scale=scale)
        found = BODY.simulate([0, 0.3, 1], OMEGA, load=load, method=method, rtol=1e-8).states["x"]
        for row, t in zip(found, (0.0, 0.3, 1.0), strict=True):
            terms = np.array([(10 * t) ** j / math.factorial(j) for j in range(count)])
            assert np.abs(row - (1 - math.exp(-10 * t) * np.cumsum(terms))).max() < 1e-6

    def test_radau_at_small_scales(self) -> None:
        s, u = 1e-40, 1e-40
        body = RigidBody.from_principal(s, np.multiply((1.0, 2.0, 2.5), s))
        wheel = loads.wheel((0, 3, 4), 0.1 * s, 5.0 * u, friction=0.05 * s * u, torque=0.2 * s * u * u)
        load = wheel + loads.slug(0.3 * s, 0.4 * s * u)
        run = body.simulate(np.array([0, 1, 3]) / u, OMEGA * u, load=load, method="radau")
        assert np.isfinite(run.omega).all()

    @pytest.mark.parametrize(
        "numbers",
        [
            {"axis": (0, 0, 0), "inertia": 0.1, "rate": 1.0},
            {"axis": (0, 0, np.nan), "inertia": 0.1, "rate": 1.0},
            {"axis": (0, 0, 1), "inertia": -1.0, "rate": 1.0},
            {"axis": (0, 0, 1), "inertia": 0.1, "rate": np.nan},
            {"axis": (0, 0, 1), "inertia": 0.1, "rate": np.inf},
        ],
        ids=str,
    )
    def test_a_wheel_is_checked_when_it_is_made(self, numbers: Any) -> None:
        with pytest.raises(ValueError, match=r"axis|inertia|rate"):
            polhode.wheel(**numbers)

    def test_shapes_of_a_wheel(self) -> None:
        with pytest.raises(ValueError, match="inertia"):
            polhode.wheel(axis=(0, 0, 1), inertia=[0.1, 0.2], rate=[1, 2, 3])

    def test_times_are_named(self) -> None:
        with pytest.raises(
            ValueError, match=r"times must be strictly ascending: times\[1\] = 0.0 follows 1.0"
        ):
            loads.wheel((0, 0, 1), 0.1, torque=[1.0, 2.0], times=[1, 0])

    def test_keys_of_states_are_named(self) -> None:
        with pytest.raises(TypeError, match="states: names are strings, got 1"):
            BODY.simulate([0, 1], OMEGA, load=loads.wheel((0, 0, 1), 0.1), states={1: [1.0]})  # type: ignore[dict-item]

    def test_one_wheel_in_place_of_a_sequence(self) -> None:
        with pytest.raises(TypeError, match="wheels: expected a sequence of wheels"):
            BODY.gyrostat(wheels=polhode.wheel(axis=(0, 0, 1), inertia=0.1, rate=1.0))  # type: ignore[arg-type]

    def test_a_name_that_no_archive_holds(self) -> None:
        with pytest.raises(ValueError, match="nor hold the character 0"):
            loads.slug(0.1, 0.1, name="\0")


class TestEquality:
    def test_equal_wheels_have_one_hash(self) -> None:
        one, other = (polhode.wheel(axis=(zero, 0, 1), inertia=0.1, rate=3.0) for zero in (0.0, -0.0))
        assert one == other
        assert hash(one) == hash(other)

    def test_gyrostats_of_other_wheels_differ(self) -> None:
        wheel = polhode.wheel(axis=(0, 0, 1), inertia=0.1, rate=3.0, mode="held")
        assert BODY.gyrostat(wheels=[wheel]) != BODY.gyrostat((0, 0, wheel.momentum))


def test_functions_do_not_reach_each_other() -> None:
    def rude(*arguments: Any) -> Any:
        arguments[-1]["one"][:] = 1e9
        return (0, 0, 0), (0, 0, 0)

    seen: list[float] = []

    def wrench(*arguments: Any) -> Any:
        seen.append(arguments[-1]["one"][0])
        return (0, 0, 0), (0, 0, 0)

    load = loads.with_states(None, [0.0], rude, "one") + loads.with_states(None, [0.0], wrench, "two")
    BODY.simulate([0, 1], OMEGA, load=load)
    assert max(seen) == 0.0


def test_a_compiled_function_sees_the_pivot_at_rest() -> None:
    kind = ctypes.CFUNCTYPE(
        None,
        ctypes.c_double,
        ctypes.POINTER(ctypes.c_double),
        ctypes.POINTER(ctypes.c_double),
        ctypes.c_void_p,
    )

    def push(_t: float, state: Any, out: Any, _data: Any) -> None:
        out[2] = -1.0
        out[3] = state[9]

    kept = kind(push)
    load = loads.compiled(ctypes.cast(kept, ctypes.c_void_p).value or 0, initial=[0.0])
    run = BODY.simulate([0, 2], (0, 0, 1.0), load=load, about="origin")
    assert np.abs(run.omega[-1] - (0, 0, 1.0)).max() < 1e-12
