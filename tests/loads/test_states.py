"""States that loads have of their own: in runs that go on, files, events, stacks, functions."""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from oracles.wheels import ATTITUDE, BODY, OMEGA, T
from polhode import Event, RigidBody, Trajectory, loads
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from pathlib import Path


class TestStates:
    LOAD = (
        loads.wheel((1.0, 2.0, -2.0), 0.2, 3.0, friction=0.1)
        + loads.slug(0.3, 0.4)
        + loads.rotor((0, 0, 0.3))
    )

    def test_a_run_goes_on(self) -> None:
        whole = BODY.simulate([0, 3, 7], OMEGA, ATTITUDE, load=self.LOAD, rtol=1e-13)
        half = BODY.simulate([0, 3], OMEGA, ATTITUDE, load=self.LOAD, rtol=1e-13)
        for again in (
            half.resume([3, 7], rtol=1e-13),
            BODY.simulate([3, 7], **half.state()._asdict(), load=self.LOAD, rtol=1e-13),
        ):
            assert np.abs(again.omega[-1] - whole.omega[-1]).max() < 1e-13
            assert np.abs(again.states["slug"][-1] - whole.states["slug"][-1]).max() < 1e-13
        with pytest.raises(ValueError, match="the total angular momentum would jump"):
            half.resume([3, 7], load=loads.slug(0.3, 0.4))  # the wheel is gone

    def test_back_in_time(self) -> None:
        there = BODY.simulate([0, 5], OMEGA, ATTITUDE, load=self.LOAD, rtol=1e-14)
        back = BODY.simulate([5, 0], **there.state()._asdict(), load=self.LOAD, rtol=1e-14)
        assert np.abs(back.omega[-1] - OMEGA).max() < 1e-11
        assert np.abs(back.states["slug"][-1] - OMEGA).max() < 1e-11

    def test_files_pickles_and_copies_hold_them(self, tmp_path: Path) -> None:
        run = BODY.simulate(T, OMEGA[None] * [[1], [2]], load=self.LOAD)
        whole = run.angular_momentum().total
        for again in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
            assert np.array_equal(again.states["slug"], run.states["slug"])
            assert np.array_equal(again.angular_momentum().total, whole)
        for name in ("motion.json", "motion.npz"):
            run.save(tmp_path / name)
            again = Trajectory.from_file(tmp_path / name)
            assert {key: value.shape for key, value in again.states.items()} == {
                "wheel": (2, 4, 1),
                "slug": (2, 4, 3),
            }
            assert np.array_equal(again.states["wheel"], run.states["wheel"])
            assert np.array_equal(again.angular_momentum().total, whole)
            assert np.array_equal(again.kinetic_energy().total, run.kinetic_energy().total)
        load = pickle.loads(pickle.dumps(self.LOAD))
        assert np.array_equal(
            BODY.simulate(T, OMEGA, load=load).omega, BODY.simulate(T, OMEGA, load=self.LOAD).omega
        )

    def test_stacks_have_the_bits_of_single_runs(self) -> None:
        momenta = np.linspace(0.1, 0.3, 9)
        stack = loads.wheel((0, 3, 4), momenta, np.linspace(-5, 5, 9), friction=0.1) + loads.slug(
            momenta, 0.4
        )
        run = BODY.simulate(T, OMEGA, load=stack)
        for k in range(9):
            alone = BODY.simulate(T, OMEGA, load=stack[k])
            assert np.abs(run.omega[k] - alone.omega).max() < 1e-14
            assert np.abs(run.states["slug"][k] - alone.states["slug"]).max() < 1e-14

    def test_events_see_them(self) -> None:
        wheel = loads.wheel((0, 0, 1), 0.5, torque=0.1, name="w")
        crossing = Event(lambda *arguments: arguments[-1]["w"][0] - 0.5, terminal=True)
        for method in ("taylor", "dop853"):
            run = BODY.simulate([0, 20], (0, 0, 0), load=wheel, events=crossing, method=method)
            assert run.events.t[0] == pytest.approx(5.0, abs=1e-12)
            assert run.events.states["w"].shape == (1, 1)
            assert run.events.states["w"][0, 0] == pytest.approx(0.5, abs=1e-12)
            assert run.status == "event"
            assert np.isnan(run.states["w"][-1, 0])

    def test_the_torque_is_that_of_the_locked_body(self) -> None:
        t = np.linspace(0, 0.02, 21)
        run = BODY.simulate(t, OMEGA, load=self.LOAD, rtol=1e-14)
        slope = np.polyfit(t - 0.01, run.omega, 8)[-2]
        assert np.abs(run.angular_acceleration()[10] - slope).max() < 1e-9

    def test_a_pivoted_body(self) -> None:
        body = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5), center_of_mass=(0, 0, 0.3))
        load = loads.uniform_gravity((0, 0, -9.8)) + loads.wheel((0, 0, 1), 0.2, 60.0)
        runs = [
            body.simulate(
                [0, 2, 5], (0, 0, 0), (0.28, 0, 0, 0.96), load=load, about="origin", method=method, rtol=1e-13
            )
            for method in ("taylor", "dop853")
        ]
        assert np.abs(runs[0].omega - runs[1].omega).max() < 1e-9
        assert runs[0].invariants().energy_drift < 1e-12
        upward = runs[0].angular_momentum().total[:, 2]
        assert np.abs(upward - upward[0]).max() < 1e-11

    def test_xarray_names_them(self) -> None:
        pytest.importorskip("xarray")
        data = BODY.simulate(T, OMEGA, load=self.LOAD).to_xarray()
        assert data["slug"].dims == ("time", "slug_component")

    def test_a_failed_run_has_none_after_its_end(self) -> None:
        def rates(t: float, *_: Any) -> list[float]:
            return [1.0 if t < 1 else np.nan]

        with pytest.raises(PolhodeError, match="must be finite"):
            BODY.simulate([0, 2], OMEGA, load=loads.with_states(rates, [0.0]))


class TestFunctions:
    def test_functions_solve_what_a_slug_solves(self) -> None:
        def rates(_t: float, w: Any, _q: Any, _r: Any, _v: Any, states: Any) -> Any:
            return -0.4 / 0.3 * (states["own"] - w) - np.cross(w, states["own"])

        def wrench(_t: float, w: Any, _q: Any, _r: Any, _v: Any, states: Any) -> Any:
            return (0, 0, 0), 0.4 * (states["own"] - w)

        own = loads.with_states(rates, OMEGA, wrench, "own")
        exact = BODY.simulate(T, OMEGA, load=loads.slug(0.3, 0.4), rtol=2.3e-15)
        cases: list[tuple[Any, float, float]] = [("dop853", 1e-12, 1e-10), ("radau", 1e-8, 1e-6)]
        for method, rtol, allowed in cases:
            run = BODY.simulate(T, OMEGA, load=own, method=method, rtol=rtol)
            assert np.abs(run.omega - exact.omega).max() < allowed
            assert np.abs(run.states["own"] - exact.states["slug"]).max() < allowed
        both = BODY.simulate(T, OMEGA, load=own + loads.wheel((0, 0, 1), 0.1), rtol=1e-12)
        other = BODY.simulate(T, OMEGA, load=loads.slug(0.3, 0.4) + loads.wheel((0, 0, 1), 0.1), rtol=1e-12)
        assert np.abs(both.omega - other.omega).max() < 1e-10

    def test_many_states(self) -> None:
        for count in (3, 4, 11, 12, 51):
            slow = np.linspace(0.1, 1.0, count)

            def rates(*arguments: Any, slow: Any = slow) -> Any:
                return -slow * arguments[-1]["states"]

            methods: list[Any] = ["dop853", "radau"]
            for method in methods:
                load = loads.with_states(rates, np.ones(count))
                run = BODY.simulate([0, 1, 2], OMEGA, load=load, method=method)
                assert np.abs(run.states["states"] - np.exp(-slow * run.t[:, None])).max() < 1e-8
        with pytest.raises(ValueError, match="from 1 to 51 states, got 52"):
            loads.with_states(None, np.zeros(52))
        two = loads.with_states(None, np.zeros(30)) + loads.with_states(None, np.zeros(30))
        with pytest.raises(ValueError, match="60 states of its own, more than the 51"):
            BODY.simulate(T, OMEGA, load=two)


def test_too_many_updates_are_refused() -> None:
    control = loads.with_states(None, [0.0], update=lambda *_: [0.0], period=1e-6)
    with pytest.raises(ValueError, match=r"period: 1e-6 makes 1\.1e8 updates in this run, more than 1e8"):
        BODY.simulate([0, 110], OMEGA, load=control)
