"""Motions that go on: the momentum and the clock do not jump, and a chain of runs is the single run."""

from __future__ import annotations

from copy import copy
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import Event, RigidBody, Trajectory, loads, orbits

BODY = RigidBody.from_principal(3.0, (1.0, 2.0, 2.5))
WHEEL = loads.wheel((0.0, 0.6, 0.8), inertia=0.5, rate=10.0, friction=0.02)
OPTIONS: dict[str, Any] = {"rtol": 1e-12}


def controller(period: float = 0.7) -> loads.Load:
    """A torque that is held between updates, each of which counts the updates and reads the rate."""

    def update(_t: float, omega: Any, _q: Any, _r: Any, _v: Any, states: Any) -> tuple[float, float]:
        return states["law"][0] + 1.0, -0.4 * omega[1]

    def wrench(_t: float, _w: Any, _q: Any, _r: Any, _v: Any, states: Any) -> Any:
        return (0.0, 0.0, 0.0), (0.0, states["law"][1], 0.05)

    return loads.with_states(None, (0.0, 0.0), update=update, period=period, wrench=wrench, name="law")


LOADS = {
    "wheel": WHEEL,
    "wheels and slug": WHEEL
    + loads.wheel((1, 0, 0), inertia=0.1, rate=-4.0, torque=0.03)
    + loads.slug(inertia=0.05, damping=0.02),
    "a speed that changes": loads.wheel((0, 0, 1), inertia=0.3, speed=[0.0, 5.0, 1.0], times=[0.0, 2.0, 6.0]),
    "sampled controller": controller() + WHEEL,
    "an orbit without epoch": loads.gravity_gradient(orbits.kepler(1.0, (1.0, 0, 0), (0, 1.1, 0.2))) + WHEEL,
}


def total(motion: Trajectory, index: int) -> Any:
    return motion.angular_momentum().spin[..., index, :]


@pytest.mark.parametrize("name", LOADS)
@pytest.mark.parametrize("passes_load", [False, True], ids=["as it was", "the load passed again"])
def test_a_chain_is_the_single_run(name: str, passes_load: bool) -> None:
    load, cuts = LOADS[name], [0.0, 1.0, 2.45, 2.8, 5.0]
    whole = BODY.simulate(cuts, (0.3, 0.5, -0.2), load=load, **OPTIONS)
    again: dict[str, Any] = {"load": load} if passes_load else {}
    part = BODY.simulate(cuts[:2], (0.3, 0.5, -0.2), load=load, **OPTIONS)
    for index, pair in enumerate(pairwise(cuts[1:]), start=2):
        before, part = part, part.resume(pair, **again, **OPTIONS)
        assert np.array_equal(total(part, 0), total(before, -1))
        assert np.abs(part.omega[-1] - whole.omega[index]).max() < 1e-9
        for own, values in whole.states.items():
            assert np.abs(part.states[own][-1] - values[index]).max() < 1e-9


def test_stacks_and_motions_from_files(tmp_path: Path) -> None:
    load = LOADS["sampled controller"]
    starts = np.array([(0.3, 0.5, -0.2), (0.1, -0.7, 0.4)])
    whole = BODY.simulate([0.0, 1.0, 2.3, 5.0], starts, load=load, **OPTIONS)
    middle = BODY.simulate([0.0, 1.0], starts, load=load, **OPTIONS).resume([1.0, 2.3], **OPTIONS)
    copies = [middle, copy(middle)]
    for suffix in (".npz", ".json"):
        middle.save(tmp_path / f"middle{suffix}")
        copies.append(Trajectory.from_file(tmp_path / f"middle{suffix}"))
    for copied in copies:
        rest = copied.resume([2.3, 5.0], load=load, **OPTIONS)
        assert np.abs(rest.omega[:, -1] - whole.omega[:, -1]).max() < 1e-9
        assert np.array_equal(total(rest, 0), total(middle, -1))


class TestAnotherLoad:
    RUN = BODY.simulate([0, 1, 2], (0.1, 0.2, 0.3), load=WHEEL)

    @pytest.mark.parametrize(
        "other",
        [
            WHEEL + loads.constant_torque((0, 0.2, 1.0)),
            loads.constant_torque((0, 0.2, 1.0)) + WHEEL,
            loads.wheel((0.0, 0.6, 0.8), inertia=0.5, rate=-3.0, torque=0.2),
            WHEEL + loads.wheel((1, 0, 0), inertia=0.2, name="at rest", friction=0.1),
            WHEEL + loads.sampled([2, 3], [(0, 0, 0), (0.1, 0, 0)]),
        ],
    )
    def test_wheels_of_the_same_name_go_on(self, other: Any) -> None:
        on = self.RUN.resume([2, 3], load=other)
        assert on.states["wheel"][0] == self.RUN.states["wheel"][-1]
        assert np.abs(total(on, 0) - total(self.RUN, -1)).max() < 1e-14

    @pytest.mark.parametrize(
        "other",
        [
            None,
            loads.constant_torque((0, 0, 1.0)),
            loads.wheel((0.0, 0.6, 0.8), inertia=0.5, rate=3.0, name="other"),
            loads.wheel((1.0, 0, 0), inertia=0.5),
            loads.wheel((0.0, 0.6, 0.8), inertia=0.4),
            WHEEL + loads.wheel((1, 0, 0), inertia=0.2, rate=1e-6, name="turns"),
            WHEEL + loads.rotor((0, 0, 1.0)),
            WHEEL + loads.slug(inertia=0.1, damping=0.1),
        ],
    )
    def test_a_momentum_that_would_jump_is_refused(self, other: Any) -> None:
        with pytest.raises(
            ValueError, match=r"total angular momentum would jump at t = 2\.0.*load=motion\.load \+"
        ):
            self.RUN.resume([2, 3], load=other)

    def test_no_motor_makes_a_wheel_jump(self) -> None:
        with pytest.raises(ValueError, match="give the wheel another speed"):
            self.RUN.resume([2, 3], load=loads.wheel((0.0, 0.6, 0.8), inertia=0.5, speed=3.0))

    def test_a_rotor_and_states_of_functions(self) -> None:
        run = BODY.simulate([0, 1], (0.1, 0.2, 0.3), load=loads.rotor((0, 0, 2.0)))
        on = run.resume([1, 2], load=loads.rotor((0, 0, 2.0)) + loads.damping(0.1))
        assert np.array_equal(total(on, 0), total(run, -1))
        run = BODY.simulate([0, 1], (0.1, 0.2, 0.3), load=controller())
        assert (
            run.resume([1, 2], load=controller()).states["law"][0].tolist() == run.states["law"][-1].tolist()
        )
        assert run.resume([1, 2], states={"law": (0.0, 0.0)}).states["law"][0].tolist() == [0.0, 0.0]
        assert run.resume([1, 2], load=None).states == {}
        with pytest.raises(ValueError, match="would jump"):
            self.RUN.resume([2, 3], states={"wheel": [1.0]})

    @pytest.mark.parametrize("name", ["omega", "attitude", "position", "velocity", "about"])
    def test_the_state_is_that_of_the_motion(self, name: str) -> None:
        other: dict[str, Any] = {name: "origin" if name == "about" else (0.0, 0.0, 1.0)}
        with pytest.raises(TypeError, match=f"resume: {name}: .* begin anew"):
            self.RUN.resume([2, 3], **other)
        assert self.RUN.resume([2, 3], about="center_of_mass").status == "complete"


class TestSavedRuns:
    """What a file says of states, and when, holds; else it is refused."""

    def spoilt(self, run: Trajectory, path: Path, **changes: Any) -> Path:
        run.save(path / "run.npz")
        arrays = {name: values.copy() for name, values in np.load(path / "run.npz").items()}
        for name, change in changes.items():
            arrays[name] = change(arrays[name])
        np.savez(path / "spoilt.npz", **arrays)
        return path / "spoilt.npz"

    RUN = BODY.simulate([0, 1, 2, 3], (0.1, 0.2, 0.3), load=LOADS["wheels and slug"])
    STACK = BODY.simulate([0, 1, 2, 3], [(0.1, 0.2, 0.3), (0, 0, 1)], load=WHEEL)
    ALONG = ("omega", "quaternion", "position", "velocity", "states_wheel", "states_slug", "carried_momentum")

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    @pytest.mark.parametrize("name", [*ALONG, "carried_energy"])
    @pytest.mark.parametrize("index", [0, 1, 3])
    def test_states_of_a_complete_run_are_numbers(
        self, name: str, value: float, index: int, tmp_path: Path
    ) -> None:
        def spoil(values: Any) -> Any:
            values[index] = value
            return values

        with pytest.raises(
            ValueError, match=r"where the status 'complete' says otherwise.* save the motion again"
        ):
            Trajectory.from_file(self.spoilt(self.RUN, tmp_path, **{name: spoil}))

    def test_one_number_of_one_body(self, tmp_path: Path) -> None:
        def spoil(values: Any) -> Any:
            values[1, 2, 0] = np.nan
            return values

        with pytest.raises(ValueError, match=r"omega of body \(1,\) is \[nan, .*t = 2\.0"):
            Trajectory.from_file(self.spoilt(self.STACK, tmp_path, omega=spoil))

    @pytest.mark.parametrize("order", [(0, 2, 1, 3), (0, 1, 1, 2), (1, 0, 2, 3)])
    def test_times_of_a_run_are_in_order(self, order: Any, tmp_path: Path) -> None:
        with pytest.raises(ValueError, match=r"t\[.\] does not follow the time before it"):
            Trajectory.from_file(self.spoilt(self.RUN, tmp_path, t=lambda t: t[list(order)]))

    def test_those_of_a_closed_form_need_not_be(self, tmp_path: Path) -> None:
        motion = BODY.free_motion((0.1, 0.2, 0.3)).at([3.0, 1.0, 2.0, 2.0])
        motion.save(tmp_path / "free.npz")
        assert np.array_equal(Trajectory.from_file(tmp_path / "free.npz").omega, motion.omega)

    @pytest.mark.parametrize("suffix", [".npz", ".json"])
    def test_runs_that_ended_early_come_back(self, suffix: str, tmp_path: Path) -> None:
        end = Event(lambda t, *_: t - 1.5, terminal=True)
        load = loads.torque_callback(lambda _t, w, _q: (0.0, 0.0, 2.5 * w[2] ** 2)) + WHEEL
        starts = np.array([(0, 0, 0.01), (0, 0, 0.9), (0, 0, 0.02)])
        for run in (
            BODY.simulate([0, 1, 2, 3], (0.1, 0.2, 0.3), load=WHEEL, events=end),
            BODY.simulate([0, 1, 2, 3], starts, load=load, on_failure="keep"),
        ):
            assert np.any(np.asarray(run.status) != "complete")
            run.save(tmp_path / f"run{suffix}")
            read = Trajectory.from_file(tmp_path / f"run{suffix}")
            assert np.array_equal(read.status, run.status)
            assert np.array_equal(read.omega, run.omega, equal_nan=True)

    def test_numbers_after_the_end_are_refused(self, tmp_path: Path) -> None:
        def spoil(values: Any) -> Any:
            values[3] = 0.0
            return values

        end = Event(lambda t, *_: t - 1.5, terminal=True)
        run = BODY.simulate([0, 1, 2, 3], (0.1, 0.2, 0.3), load=WHEEL, events=end)
        for name in ("omega", "position", "states_wheel"):
            with pytest.raises(ValueError, match="'event' says otherwise"):
                Trajectory.from_file(self.spoilt(run, tmp_path, **{name: spoil}))
