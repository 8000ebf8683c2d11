"""Attitude and rates relative to the local frame of an orbit, beside the frame from position and velocity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, loads, orbits, solids
from scipy.spatial.transform import Rotation

MU = 3.986004418e14
BODY = RigidBody.from_principal(50.0, (10.0, 14.0, 17.0))


def local_frames(position: Any, velocity: Any) -> Rotation:
    """Return R_NL by its definition: z to the attractor, y against the normal of the orbit."""
    down = -position / np.linalg.norm(position, axis=-1, keepdims=True)
    across = -np.cross(position, velocity)
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    return Rotation.from_matrix(np.stack([np.cross(across, down), across, down], axis=-1))


def inclined(epoch: float | None = None, **oblate: Any) -> orbits.Orbit:
    return orbits.kepler(MU, (7e6, 1e5, -2e5), (100.0, 5.5e3, 5.2e3), epoch, **oblate)


@pytest.mark.parametrize("kind", ["kepler", "oblate", "sampled"])
def test_by_position_and_velocity(kind: str) -> None:
    orbit: Any = inclined(40.0, **({"j2": 1.08e-3, "radius": 6.378e6} if kind == "oblate" else {}))
    if kind == "sampled":
        table = np.linspace(0.0, 4000.0, 801)
        orbit = orbits.sampled(MU, table, orbit.at(table).position)
    t = np.linspace(100.0, 3900.0, 301)
    load = loads.gravity_gradient(orbit)
    run = BODY.simulate(t, (1e-3, -2e-3, 3e-3), np.array([0.1, -0.3, 0.2, 0.9]) / 0.95**0.5, load=load)
    found = run.relative_to(orbit)
    frames = local_frames(*orbit.at(t))
    exact = frames.inv() * run.rotation
    assert np.max((found.rotation.inv() * exact).magnitude()) < 1e-14
    assert np.max(np.abs(np.diff(found.quaternion, axis=0))) < 0.1
    yaw, pitch, roll = exact.as_euler("ZYX").T
    for name, angle in (("yaw", yaw), ("pitch", pitch), ("roll", roll)):
        assert np.max(np.abs(np.sin(getattr(found, name) - angle))) < 1e-11
    assert found.angles(degrees=True) == pytest.approx(np.rad2deg(found.angles()))
    # ω of B relative to L by a difference of the attitudes.
    h = 0.05
    ahead, behind = (local_frames(*orbit.at(t + s)) for s in (h, -h))
    turn = (ahead * behind.inv()).as_rotvec() / (2 * h)
    exact_omega = run.omega - run.rotation.inv().apply(turn)
    assert np.max(np.abs(found.omega - exact_omega)) < 1e-9


def test_the_epoch_of_an_orbit_without_one_is_the_start() -> None:
    t = np.linspace(500.0, 900.0, 5)
    run = BODY.simulate(t, (1e-3, 0, 0), load=loads.gravity_gradient(inclined()))
    found, same = run.relative_to(inclined()), run.relative_to(inclined(500.0))
    assert np.array_equal(found.quaternion, same.quaternion)
    assert np.array_equal(found.omega, same.omega)
    assert not np.allclose(found.omega, run.relative_to(inclined(0.0)).omega)


def test_stacks_and_times_of_any_shape() -> None:
    bodies = RigidBody.stack([BODY, BODY.scaled(mass=2.0)])
    t = np.linspace(0.0, 100.0, 4)
    run = bodies.simulate(t, (1e-3, 0, 1e-3))
    found = run.relative_to(inclined())
    assert found.quaternion.shape == (2, 4, 4)
    assert found.omega.shape == (2, 4, 3)
    assert found.roll.shape == (2, 4)
    two = orbits.kepler(MU, [(7e6, 0, 0), (8e6, 0, 0)], (0, 7e3, 1e3))
    both = run.relative_to(two)
    alone = BODY.simulate(t, (1e-3, 0, 1e-3)).relative_to(orbits.kepler(MU, (7e6, 0, 0), (0, 7e3, 1e3)))
    assert both.quaternion[0] == pytest.approx(alone.quaternion, abs=1e-15)
    square = BODY.free_motion((1e-3, 0, 0)).at([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]).relative_to(two)
    assert square.yaw.shape == (2, 2, 3)
    three = orbits.kepler(MU, [(7e6, 0, 0)] * 3, (0, 7e3, 1e3))
    with pytest.raises(
        ValueError, match=r"orbit: its stack of shape \(3,\) does not broadcast with .*\(2,\)"
    ):
        run.relative_to(three)
    wrong: Any = (7e6, 0, 0)
    with pytest.raises(TypeError, match=r"orbit: expected one of polhode\.orbits"):
        run.relative_to(wrong)


def test_a_satellite_that_looks_up_pitches_by_a_right_angle() -> None:
    """Turned about y by a quarter, yaw and roll are not defined."""
    orbit = orbits.kepler(1.0, (1, 0, 0), (0, 1, 0))
    frame = Rotation.from_quat(orbit.frame(0.0).quaternion)
    attitude = (frame * Rotation.from_rotvec([0, np.pi / 2, 0])).as_quat()
    ball = solids.sphere(0.1, mass=1.0)
    spin = (frame * Rotation.from_rotvec([0, np.pi / 2, 0])).inv().apply((0, 0, 1.0))
    found = ball.free_motion(spin, attitude).at([0.0, 1.0]).relative_to(orbit)
    assert found.pitch == pytest.approx(np.pi / 2)
    assert np.max(np.abs(found.omega)) < 1e-15
    assert np.isnan(found.roll).all()
    assert "local frame" in repr(found)
