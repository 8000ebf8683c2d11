"""What a trajectory of a gyrostat tells beside its states: the same as one under the rotor's load."""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from page_data import data
from polhode import GyrostatMotion, RigidBody, Trajectory, loads, wheel

if TYPE_CHECKING:
    from pathlib import Path

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
INSIDE = np.array([0.1, 0.5, 1.0])
OMEGA = (0.3, 0.2, 1.1)
TIMES = np.linspace(0.0, 2.0, 5)
WHEELS = [
    polhode.wheel(axis=(0, 1, 1), inertia=0.3, rate=3.0),
    polhode.wheel(axis=(1, 1, 0), inertia=0.1, rate=-2.0),
]


def both() -> tuple[Trajectory, Trajectory]:
    exact = BODY.gyrostat(INSIDE).free_motion(OMEGA).at(TIMES)
    return exact, BODY.simulate(TIMES, OMEGA, load=loads.rotor(INSIDE), rtol=2.3e-15)


def test_torque_and_acceleration() -> None:
    exact, run = both()
    for found in (exact, pickle.loads(pickle.dumps(exact))):
        np.testing.assert_allclose(found.torque(), run.torque(), atol=1e-12)
        np.testing.assert_allclose(found.angular_acceleration(), run.angular_acceleration(), atol=1e-12)


def test_acceleration_with_free_wheels_and_in_stacks() -> None:
    step = 1e-5
    for inside in (INSIDE, np.arange(12.0).reshape(4, 1, 3) / 10.0):
        start: Any = OMEGA if inside.ndim == 1 else [OMEGA, (1.0, 0.2, -0.4)]
        motion = BODY.gyrostat(inside, wheels=WHEELS).free_motion(start)
        found = motion.at(1.0 + step * np.array([-1.0, 0.0, 1.0]))
        slope = (found.omega[..., 2, :] - found.omega[..., 0, :]) / (2.0 * step)
        np.testing.assert_allclose(found.angular_acceleration()[..., 1, :], slope, atol=1e-9)


def test_resume_and_sensitivity() -> None:
    exact, run = both()
    later = exact.resume([2.0, 3.0])
    known = BODY.gyrostat(INSIDE).free_motion(OMEGA).at([2.0, 3.0])
    np.testing.assert_allclose(later.omega, known.omega, atol=1e-11)
    np.testing.assert_allclose(exact.sensitivity().state, run.sensitivity().state, atol=1e-11)


def test_free_wheels_go_on() -> None:
    motion = BODY.gyrostat(wheels=WHEELS).free_motion(OMEGA)
    on = motion.at(TIMES).resume([TIMES[-1], 3.0], rtol=1e-14)
    np.testing.assert_allclose(on.omega[-1], motion.at(3.0).omega, atol=1e-13)


def test_a_file_does_not_hold_what_acts(tmp_path: Path) -> None:
    both()[0].save(tmp_path / "motion.npz")
    read = Trajectory.from_file(tmp_path / "motion.npz")
    np.testing.assert_allclose(
        read.angular_momentum().spin - read.angular_momentum().spin[0], 0.0, atol=1e-14
    )
    for what in (read.torque, read.sensitivity, lambda: read.resume([2.0, 3.0])):
        with pytest.raises(ValueError, match="is unknown: its file holds only"):
            what()
    read.resume([2.0, 3.0], load=loads.rotor(INSIDE))


@pytest.mark.parametrize("suffix", ["npz", "json"])
def test_a_loaded_motion_from_a_file_is_drawn_by_its_samples(suffix: str, tmp_path: Path) -> None:
    """Not as the free motion from its first state, and not after a second saving either."""
    run = BODY.simulate(np.linspace(0.0, 1.0, 5), OMEGA, load=loads.constant_torque((0.0, 0.0, 3.0)))
    run.save(tmp_path / f"a.{suffix}")
    Trajectory.from_file(tmp_path / f"a.{suffix}").save(tmp_path / f"b.{suffix}")
    for name in ("a", "b"):
        read = Trajectory.from_file(tmp_path / f"{name}.{suffix}")
        with pytest.warns(UserWarning, match="more than the 30"):
            shown = data(read.animate(tmp_path / "page.html"))
        assert shown["t"].tolist() == run.t.tolist()
        np.testing.assert_allclose(shown["quaternion"], run.quaternion, atol=1e-7)


def test_states_know_their_wheels() -> None:
    """From states the motion goes on with its wheels: free ones keep ``J (Ω + a·ω)``, held ones Ω."""
    axis = np.array([1.0, 2.0, 2.0]) / 3.0
    free = wheel(axis=3.0 * axis, inertia=0.1, rate=4.0)
    held = wheel(axis=(0, 0, 1), inertia=0.2, rate=-3.0, mode="held")
    whip = wheel(axis=(1, 0, 0), inertia=0.0, momentum=0.3)
    motion = BODY.gyrostat((0.0, 0.1, 0.0), wheels=[free, held, whip]).free_motion(OMEGA)
    states = motion.at(np.linspace(2.0, 9.0, 8))
    for known in (states, pickle.loads(pickle.dumps(states)), copy.copy(states)):
        again = known._exact()
        assert isinstance(again, GyrostatMotion)
        one, two, three = again.gyrostat.wheels
        assert one.rate + axis @ states.omega[0] == pytest.approx(4.0 + axis @ motion.omega, rel=1e-14)
        assert (two, three) == (held, whip)
        np.testing.assert_allclose(again.rotor, motion.rotor, rtol=1e-14)
        np.testing.assert_allclose(again.at(7.0).omega, states.omega[-1], rtol=1e-13)
