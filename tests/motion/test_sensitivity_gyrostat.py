"""Derivatives of motions of gyrostats, against differences of motions in 50 digits and of closed forms."""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import numpy as np
import polhode
import pytest
from mpmath import mp, mpf
from oracles.gyrostat import Motion
from oracles.rotation import conjugate
from oracles.rotation import times as product
from polhode import RigidBody

TENSOR = np.array([(3.0, 0.2, -0.1), (0.2, 2.0, 0.3), (-0.1, 0.3, 4.0)])
INSIDE, OMEGA = np.array([0.3, -0.2, 0.5]), np.array([0.3, 0.7, -0.9])
ATTITUDE = np.array([0.5, -0.25, 0.125, 0.8]) / np.linalg.norm([0.5, -0.25, 0.125, 0.8])
TIME = 12.0
CHANGE = mpf("1e-24")


def end(change: Any = None) -> Any:
    """The state at the time, after a change of tensor, momentum inside and ω at the start."""
    tensor = [[mpf(float(x)) for x in row] for row in TENSOR]
    inside, omega = [mpf(float(x)) for x in INSIDE], [mpf(float(x)) for x in OMEGA]
    if change is not None:
        change(tensor, inside, omega, CHANGE)
    q = [mpf(float(x)) for x in ATTITUDE]
    return Motion(tensor, inside, omega, q, digits=50, longest=TIME, returns=False).straight(mpf(TIME))


@cache
def unchanged() -> Any:
    with mp.workdps(70):
        return end()


def in_many_digits(change: Any) -> np.ndarray:
    """(δ, ω) at the time by a change of tensor, momentum inside, ω: a difference of motions in 50 digits."""
    with mp.workdps(70):
        here, there = unchanged(), end(change)
        *tilt, scalar = product(conjugate(here.quaternion), there.quaternion)
        turned = [2 * mpmath.sign(scalar) * x / CHANGE for x in tilt]
        rates = [(b - a) / CHANGE for a, b in zip(here.omega, there.omega, strict=True)]
        return np.array([float(x) for x in [*turned, *rates]])


@pytest.fixture(scope="module")
def held() -> Any:
    """The derivatives of a gyrostat whose momentum inside is held."""
    body = RigidBody(1.0, TENSOR)
    run = body.gyrostat(INSIDE).free_motion(OMEGA, ATTITUDE).at([0.0, TIME])
    return body, run.sensitivity()


@pytest.mark.parametrize("k", range(3))
def test_by_momentum_inside_and_rates(held: Any, k: int) -> None:
    _, found = held

    def inside(_tensor: Any, inside: Any, _omega: Any, step: Any) -> None:
        inside[k] += step

    def rates(_tensor: Any, _inside: Any, omega: Any, step: Any) -> None:
        omega[k] += step

    (rotor,) = found.load
    exact = in_many_digits(inside)
    np.testing.assert_allclose(rotor["momentum"][-1][:, k], exact, atol=1e-12 * np.abs(exact).max())
    exact = in_many_digits(rates)
    np.testing.assert_allclose(found.state[-1][:, 3 + k], exact, atol=1e-12 * np.abs(exact).max())


def test_by_the_tensor(held: Any) -> None:
    body, found = held
    V = body.principal.axes
    change = np.array([(0.3, 0.1, -0.2), (0.1, -0.4, 0.5), (-0.2, 0.5, 0.2)])
    turned = V.T @ change @ V
    got = found.moments[-1] @ np.diag(turned)
    got += found.products[-1] @ [turned[1, 2], turned[2, 0], turned[0, 1]]

    def tensor(tensor: Any, _inside: Any, _omega: Any, step: Any) -> None:
        for i, j in np.ndindex(3, 3):
            tensor[i][j] += mpf(float(change[i, j])) * step

    exact = in_many_digits(tensor)
    np.testing.assert_allclose(got, exact, atol=1e-12 * np.abs(exact).max())


def differences(motion: Any, step: float = 1e-3) -> np.ndarray:
    """ω at the time, by differences of order six of closed forms."""
    found = 0.0
    for part, weight in ((1, 45.0), (2, -9.0), (3, 1.0)):
        found = found + weight * (motion(part * step) - motion(-part * step))
    return np.asarray(found) / (60 * step)


@pytest.mark.parametrize("start", [0.0, 3.0])
def test_a_free_wheel(start: float) -> None:
    """By its inertia, axis and rate and by ω, the rate being that at the first time."""
    body, axis = RigidBody(1.0, TENSOR), np.array([0.6, 0.0, 0.8])
    times = np.array([start, start + TIME])
    wheel = polhode.wheel(axis=axis, inertia=0.3, rate=5.0)
    whole = body.gyrostat(wheels=[wheel]).free_motion(OMEGA, ATTITUDE)
    run = whole.at(times)
    found = run.sensitivity()
    first, spin = run.omega[0], float(whole.rotor @ axis) / 0.3
    rate = spin - axis @ first

    def end(J: float = 0.3, a: Any = axis, W: float = rate, omega: Any = first) -> np.ndarray:
        one = polhode.wheel(axis=a, inertia=J, rate=W)
        moved: np.ndarray = body.gyrostat(wheels=[one]).free_motion(omega, run.quaternion[0]).at(TIME).omega
        return moved

    slopes, rotor = found.load
    assert set(rotor) == {"momentum"}
    by_axis = found.load[0]["axis"][-1][3:6]
    exact = differences(lambda e: end(J=0.3 + e))
    np.testing.assert_allclose(slopes["inertia"][-1][3:6], exact, atol=1e-10)
    # The axis of the wheel of the load may point the other way, and turn the other way then.
    exact = differences(lambda e: end(W=rate + e))
    np.testing.assert_allclose(np.abs(slopes["rate"][-1][3:6]), np.abs(exact), atol=1e-10)
    by_omega = found.state[-1][3:6, 3:6] + found.state[-1][3:6, 6:] @ found.begins
    for k in range(3):
        exact = differences(lambda e, k=k: end(omega=first + e * np.eye(3)[k]))
        np.testing.assert_allclose(by_omega[:, k], exact, atol=1e-10)
        exact = differences(lambda e, k=k: end(a=axis + e * np.eye(3)[k]))
        np.testing.assert_allclose(np.abs(by_axis[:, k]), np.abs(exact), atol=1e-10)


def test_free_and_held_wheels_in_a_stack() -> None:
    """Rows are those of single gyrostats; a run goes on as the closed form does."""
    body = RigidBody(1.0, TENSOR)
    wheels = [
        polhode.wheel(axis=(0, 0, 1), inertia=[0.2, 0.3], rate=[3.0, 4.0]),
        polhode.wheel(axis=(0, 1, 1), inertia=0.1, momentum=-2.0),
        polhode.wheel(axis=(1, 0, 0), inertia=0.1, rate=7.0, mode="held"),
    ]
    motion = body.gyrostat(wheels=wheels).free_motion(OMEGA)
    run = motion.at([0.0, 1.0, 2.0])
    found = run.sensitivity()
    assert found.state.shape == (2, 3, 8, 8)
    alone = [polhode.wheel(axis=(0, 0, 1), inertia=0.3, rate=4.0), *wheels[1:]]
    one = body.gyrostat(wheels=alone).free_motion(OMEGA).at([0.0, 1.0, 2.0]).sensitivity()
    np.testing.assert_allclose(found.state[1, ..., :6, :6], one.state[..., :6, :6], atol=1e-13)
    on = run.resume([2.0, 5.0], rtol=1e-14)
    np.testing.assert_allclose(on.omega[:, -1], motion.at(5.0).omega, atol=1e-12)
    np.testing.assert_allclose(
        on.angular_momentum().spin[:, -1], run.angular_momentum().spin[:, 0], atol=1e-12
    )


def test_wheels_along_different_numbers_of_axes() -> None:
    body = RigidBody(1.0, TENSOR)
    axes = np.array([(0.0, 0.0, 1.0), (0.0, 1.0, 1.0)])
    wheels = [
        polhode.wheel(axis=(0, 0, 1), inertia=0.2, rate=3.0),
        polhode.wheel(axis=axes, inertia=0.2, rate=1.0),
    ]
    run = body.gyrostat(wheels=wheels).free_motion(OMEGA).at([0.0, 1.0])
    with pytest.raises(ValueError, match="one, two or three axes; ask one by one"):
        run.sensitivity()
