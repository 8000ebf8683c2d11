"""Random free bodies, from needles to near-spheres, up to 1e12 rotations, against elliptic functions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from oracles.jacobi import JacobiMotion
from oracles.motion_cases import angle, relative_error
from polhode import RigidBody

SEED = 20261121
ROTATIONS = np.array([1.0, 10.0, 1e3, 1e6, 1e9, 1e12])


class Start(NamedTuple):
    moments: np.ndarray
    omega: np.ndarray
    attitude: np.ndarray
    times: np.ndarray


def starts(count: int) -> list[Start]:
    """Second moments over three decades, rates over two; the first `count` of one endless sequence."""
    rng = np.random.default_rng(SEED)
    drawn: list[Start] = []
    while len(drawn) < count:
        x, y, z = 10.0 ** rng.uniform(-3.0, 0.0, 3)
        moments = np.sort([y + z, z + x, x + y])
        omega = rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 0.0, 3)
        attitude = rng.normal(size=4)
        rotation = 2 * np.pi * moments[1] / np.linalg.norm(moments * omega)
        times = ROTATIONS * rotation * rng.uniform(0.5, 1.0, len(ROTATIONS))
        drawn.append(Start(moments, omega, attitude / np.linalg.norm(attitude), times))
    return drawn


def errors(start: Start) -> list[float]:
    """The larger of the angle and the relative error of ω, at each time."""
    exact = JacobiMotion(start.moments, start.omega, start.attitude)
    body = RigidBody.from_principal(1.0, start.moments)
    motion = body.free_motion(start.omega, start.attitude).at(start.times)
    worst = []
    for t, omega, quaternion in zip(start.times, motion.omega, motion.quaternion, strict=True):
        rates, attitude = exact.at(t)
        worst.append(max(angle(quaternion, attitude), relative_error(omega, rates)))
    return worst


def assert_errors(count: int) -> None:
    found = np.array([errors(start) for start in starts(count)])
    assert (np.median(found, axis=0) <= 2e-15).all()
    assert found[:, ROTATIONS <= 1e6].max() <= 1e-13
    assert found.max() <= 1e-10


@pytest.mark.timeout(600)
def test_a_hundred_random_bodies() -> None:
    assert_errors(100)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_nine_hundred_random_bodies() -> None:
    assert_errors(900)
