"""Trajectories of records: every form of attitude, gaps, derived velocities, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, Trajectory, euler_angles, loads, wheel
from polhode.errors import PolhodeError

BODY = RigidBody.from_principal(2.0, (1.0, 1.6, 2.0), center_of_mass=(0.0, 0.0, 0.25))
T = np.sort(np.random.default_rng(3).uniform(0.0, 5.0, 200))
MOTION: Any = BODY.free_motion((0.3, 1.0, 0.2), (0.1, 0.7, 0.1, 0.7)).at(T)
WEIGHT = loads.uniform_gravity((0.0, 0.0, -9.81))
FREE = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))


def forms() -> dict[str, tuple[Any, str | None]]:
    rotation = MOTION.rotation
    return {
        "quaternions": (MOTION.quaternion, None),
        "matrices": (rotation.as_matrix(), None),
        "rotation": (rotation, None),
        "yaw, pitch, roll": (rotation.as_euler("ZYX"), "ZYX"),
        "extrinsic": (rotation.as_euler("xyz"), "xyz"),
        "goldstein": (euler_angles.from_quaternion(MOTION.quaternion), "goldstein"),
    }


@pytest.mark.parametrize("form", forms())
def test_every_form_is_the_same_motion(form: str) -> None:
    attitude, sequence = forms()[form]
    record = Trajectory.from_samples(BODY, T, attitude, MOTION.omega, sequence=sequence)
    same = np.sign((record.quaternion * MOTION.quaternion).sum(1))[0]
    np.testing.assert_allclose(record.quaternion, same * MOTION.quaternion, atol=4e-15)
    np.testing.assert_allclose(record.angular_momentum().spin, MOTION.angular_momentum().spin, atol=3e-14)
    derived = Trajectory.from_samples(BODY, T, attitude, sequence=sequence)
    np.testing.assert_allclose(derived.omega, MOTION.omega, atol=1e-8)
    assert derived.invariants().energy_drift < 1e-8


def test_rows_that_are_not_there() -> None:
    attitude, omega = MOTION.quaternion.copy(), MOTION.omega.copy()
    attitude[3], omega[5, 1] = np.nan, np.nan
    record = Trajectory.from_samples(BODY, T, attitude, omega)
    assert np.flatnonzero(np.isnan(record.quaternion).any(1)).tolist() == [3]
    assert np.flatnonzero(np.isnan(record.angular_momentum().spin).any(1)).tolist() == [3, 5]


def test_position_and_velocity() -> None:
    place = np.stack((np.sin(T), T, np.cos(T)), axis=1)
    record = Trajectory.from_samples(BODY, T, MOTION.quaternion, position=place)
    slope = np.stack((np.cos(T), np.ones_like(T), -np.sin(T)), axis=1)
    np.testing.assert_allclose(record.velocity, slope, atol=1e-8)
    given = Trajectory.from_samples(BODY, T, MOTION.quaternion, position=place, velocity=slope)
    np.testing.assert_array_equal(given.velocity, slope)
    np.testing.assert_array_equal(given.about, [0.0, 0.0, 0.25])


def test_of_a_top() -> None:
    """About its pivot, with its weight: energy and the vertical part of L are those of the closed form."""
    top = RigidBody.from_principal(1.0, (0.2, 0.2, 0.1), center_of_mass=(0.0, 0.0, 0.3))
    run = top.simulate(
        np.linspace(0, 2, 400), (0, 0, 40), (0.2, 0, 0, 0.96**0.5), load=WEIGHT, about="origin"
    )
    record = Trajectory.from_samples(top, run.t, run.quaternion, run.omega, load=WEIGHT, about="origin")
    assert record.pivoted
    kept = record.invariants()
    assert kept.energy_drift < 1e-10
    assert kept.angular_momentum_drift < 1e-10
    np.testing.assert_allclose(record.torque(), run.torque(), atol=1e-13)


def test_of_a_rotor() -> None:
    run = BODY.simulate(T, (0.3, 1.0, 0.2), load=loads.rotor((0.0, 0.5, 1.0)))
    record = Trajectory.from_samples(BODY, T, run.quaternion, run.omega, load=run.load)
    np.testing.assert_allclose(record.angular_momentum().spin, run.angular_momentum().spin, atol=1e-14)


@pytest.mark.parametrize("path", ["run.csv", "run.json", "run.npz"])
def test_it_is_written(path: str, tmp_path: Any) -> None:
    record = Trajectory.from_samples(BODY, T, MOTION.quaternion)
    record.save(tmp_path / path)
    assert (tmp_path / path).stat().st_size > 1000


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"t": [0.0, 2.0, 1.0]}, "t: row 2 is 1.0 after 2.0, and times must ascend"),
        ({"attitude": FREE * 1.1}, r"row 0 is no rotation: the norm of the quaternion is 1\.1"),
        ({"attitude": np.tile(np.diag([1.0, 1.0, -1.0]), (3, 1, 1))}, "no rotation: the determinant is -1"),
        ({"attitude": np.tile(np.diag([1.0, 1.0, 2.0]), (3, 1, 1))}, "no rotation: the largest element"),
        ({"attitude": FREE[:2]}, r"attitude: expected 3 rows like t"),
        ({"attitude": np.stack((FREE, FREE))}, "attitude: expected one body, got a stack"),
        ({"body": RigidBody.stack([BODY, BODY])}, r"got a stack of shape \(2,\); take one: body\[0\]"),
        ({"omega": np.zeros((2, 3))}, r"omega: expected shape \(3, 3\)"),
        ({"omega": np.full((3, 3), np.inf)}, "omega: row 0 is infinite"),
        ({"velocity": np.zeros((3, 3))}, "velocity: needs position="),
        (
            {"load": wheel(axis=(0, 0, 1), inertia=0.1, rate=1.0)},
            "load: the states wheel of it are in no record",
        ),
        ({"load": loads.constant_torque(np.ones((2, 3)))}, "load: a record is of one body"),
        ({"about": "com"}, "about: 'com' is not"),
    ],
)
def test_what_is_refused(given: dict[str, Any], words: str) -> None:
    asked: dict[str, Any] = {"body": BODY, "t": [0.0, 1.0, 2.0], "attitude": FREE} | given
    with pytest.raises((PolhodeError, ValueError), match=words):
        Trajectory.from_samples(**asked)
