"""Exact motions at times of any shape: one time, a series, a grid, none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import RigidBody, Trajectory

if TYPE_CHECKING:
    from collections.abc import Callable

ONE = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
TWO = RigidBody.from_principal([1.0, 2.0], [(1.0, 2.0, 2.5), (2.0, 3.0, 4.0)])
TOP = RigidBody.from_principal(1.0, (0.2, 0.2, 0.1), center_of_mass=(0, 0, 0.3))
OMEGA = np.array([0.3, 1.0, 0.2])
MOTIONS: dict[str, Any] = {
    "free": ONE.free_motion(OMEGA, (0.6, 0, 0, 0.8)),
    "free stack": TWO.free_motion([OMEGA, OMEGA + 1], (0.6, 0, 0, 0.8)),
    "gyrostat": ONE.gyrostat((0, 0.3, 0.1)).free_motion(OMEGA, (0.6, 0, 0, 0.8)),
    "gyrostat stack": TWO.gyrostat((0, 0.3, 0.1)).free_motion(OMEGA, (0.6, 0, 0, 0.8)),
    "top": TOP.heavy_top((0, 0, 4.0), (0.28, 0, 0, 0.96), gravity=(0, 0, -9.81)),
}
STACKS = {"free stack": (2,), "gyrostat stack": (2,)}
GRID = np.array([[0.3, 1.0, 7.0], [2.0, 0.0, 5.0]])
ASKED: dict[str, Callable[[Trajectory], Any]] = {
    "kinetic energy": lambda run: run.kinetic_energy().total,
    "angular momentum": lambda run: run.angular_momentum().spin,
    "energy": lambda run: run.invariants().energy,
    "kept": lambda run: run.invariants().angular_momentum,
    "angles": lambda run: run.euler_angles(),
    "rates": lambda run: run.euler_rates(),
    "torque": lambda run: run.torque(),
    "force": lambda run: run.force(),
    "acceleration": lambda run: run.angular_acceleration(),
    "potential": lambda run: run.potential_energy(),
    "point": lambda run: run.point((0.1, 0.2, 0.3)),
}


@pytest.mark.parametrize("asked", ASKED)
@pytest.mark.parametrize("name", MOTIONS)
def test_a_grid_and_one_time_give_what_a_series_gives(name: str, asked: str) -> None:
    motion, ask, stack = MOTIONS[name], ASKED[asked], STACKS.get(name, ())
    series = ask(motion.at(GRID.ravel()))
    grid = ask(motion.at(GRID))
    assert grid.shape == (*stack, *GRID.shape, *series.shape[len(stack) + 1 :])
    assert np.array_equal(grid.reshape(series.shape), series)
    for k, t in enumerate(GRID.ravel()):
        assert np.array_equal(ask(motion.at(t)), np.take(series, k, axis=len(stack)))
    for shape in ((0,), (2, 0)):
        assert ask(motion.at(np.zeros(shape))).shape[: len(stack) + len(shape)] == (*stack, *shape)


@pytest.mark.parametrize("name", MOTIONS)
def test_drift_is_that_over_all_times(name: str) -> None:
    motion, stack = MOTIONS[name], STACKS.get(name, ())
    series, grid = motion.at(GRID.ravel()).invariants(), motion.at(GRID).invariants()
    for which in ("energy_drift", "angular_momentum_drift"):
        found = getattr(grid, which)
        assert np.shape(found) == stack
        assert np.array_equal(found, getattr(series, which))
        assert np.max(found) < 1e-14
        for times in (1.0, np.zeros(0), np.zeros((0, 2))):
            assert np.array_equal(getattr(motion.at(times).invariants(), which), np.zeros(stack))


@pytest.mark.parametrize("name", MOTIONS)
def test_the_state_at_one_time(name: str) -> None:
    motion = MOTIONS[name]
    state, series = motion.at(7.0).state(), motion.at(np.array([1.0, 7.0]))
    assert np.array_equal(state.omega, series.omega[..., 1, :])
    assert np.array_equal(state.attitude, series.quaternion[..., 1, :])
    again, whole = motion.at(7.0).resume([7.0, 8.0]), motion.at(np.array([7.0, 8.0]))
    assert np.abs(again.omega - whole.omega).max() < 1e-8
    with pytest.raises(ValueError, match=r"the motion goes on from t = 7.0"):
        motion.at(7.0).resume([6.0, 8.0])


@pytest.mark.parametrize("shape", [(), (2, 3), (0,), (0, 2)])
@pytest.mark.parametrize("name", MOTIONS)
def test_what_needs_a_series_says_so(name: str, shape: tuple[int, ...]) -> None:
    pytest.importorskip("matplotlib")
    run = MOTIONS[name].at(np.ones(shape))
    asked: list[Callable[[], Any]] = [
        run.plot,
        run.sensitivity,
        lambda: run.animate("x.html"),
        lambda: run.euler_angles(unwrap=True),
    ]
    if shape:
        asked += [run.state, lambda: run.resume([1.0, 2.0])]
    for ask in asked:
        with pytest.raises(ValueError, match=r"needs a series of times, and t of this motion has the shape"):
            ask()


def test_a_dataset_needs_a_series() -> None:
    pytest.importorskip("xarray")
    with pytest.raises(ValueError, match=r"to_xarray: needs a series of times"):
        MOTIONS["free"].at(GRID).to_xarray()
