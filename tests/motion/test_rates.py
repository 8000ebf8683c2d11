"""Angular velocities of attitudes, and attitudes of angular velocities, beside exact motions and SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, Trajectory, euler_angles, kinematics
from polhode.errors import PolhodeError
from scipy.spatial.transform import Rotation, RotationSpline

T = np.linspace(0.0, 4.0, 81)
BODY = RigidBody.from_principal(1.0, (1.0, 1.6, 2.0))
MOTION: Any = BODY.free_motion((0.3, 1.0, 0.2), (0.1, 0.7, 0.1, 0.7)).at(T)


def size(values: Any) -> float:
    """Root of the mean square of the lengths of vectors."""
    return float(np.sqrt((np.asarray(values) ** 2).sum(-1).mean()))


def drawn(rng: np.random.Generator, rows: int = 400) -> tuple[Trajectory, Any]:
    """An exact motion at uneven times, ω Δt from 1e-4 to 0.5 on the average."""
    moments = np.sort(rng.uniform(1.0, 2.0, 3))
    moments[2] = min(moments[2], moments[:2].sum() - 0.05)
    omega = rng.normal(size=3)
    step = 10.0 ** rng.uniform(-4.0, np.log10(0.5)) / np.linalg.norm(omega)
    t = np.cumsum(rng.uniform(0.5, 1.5, rows) * step)
    body = RigidBody.from_principal(1.0, moments)
    return body.free_motion(omega, Rotation.random(rng=rng).as_quat()).at(t), t


def turned_off(found: Any, exact: Any) -> Any:
    """Rotation vectors from exact to found attitudes."""
    return (Rotation.from_quat(exact).inv() * Rotation.from_quat(found)).as_rotvec()


def of_spline(t: Any, quaternions: Any) -> Any:
    """Angular velocity in the body by SciPy's spline, which gives it in space."""
    turn = Rotation.from_quat(quaternions)
    return turn.inv().apply(RotationSpline(t, turn)(t, 1))


def of_central_differences(t: Any, quaternions: Any) -> Any:
    """Angular velocity in the body by differences of second order."""
    turn = Rotation.from_quat(quaternions)
    here = turn[1:-1].inv()
    back, ahead = (here * turn[:-2]).as_rotvec(), (here * turn[2:]).as_rotvec()
    a, b = np.diff(t)[:-1, None], np.diff(t)[1:, None]
    return -b / (a * (a + b)) * back + a / (b * (a + b)) * ahead


def test_errors_of_exact_motions_are_as_reported_and_below_those_of_others(rng: np.random.Generator) -> None:
    """rms error ≤ 1.5 of the reported one in 95 % of the motions, the median reported ≤ 5 of the true one."""
    ratios = []
    for _ in range(60):
        motion, t = drawn(rng)
        omega, error = kinematics.angular_velocity(t, motion.quaternion)
        off = omega - motion.omega
        rate, rate_error = kinematics.angular_acceleration(t, motion.omega)
        rate_off = rate - motion.angular_acceleration()
        attitude, turn_error = kinematics.quaternion(t, motion.omega, motion.quaternion[0])
        turned = turned_off(attitude, motion.quaternion)
        for gap, told in ((off, error), (rate_off, rate_error), (turned, turn_error)):
            middle = np.median(told) / np.median(np.linalg.norm(gap, axis=1))
            ratios.append((size(gap) / np.sqrt((told**2).mean()), middle))
        spline = of_spline(t, motion.quaternion) - motion.omega
        central = of_central_differences(t, motion.quaternion) - motion.omega[1:-1]
        assert size(off) < 0.02 * size(spline)
        assert size(off[1:-1]) < 0.1 * size(central)
        back, back_error = kinematics.quaternion(t, omega, motion.quaternion[0])
        allowed = (
            np.concatenate(([0.0], np.cumsum(np.maximum(error[1:], error[:-1]) * np.diff(t)))) + back_error
        )
        assert size(turned_off(back, motion.quaternion)) < np.sqrt((allowed**2).mean())
    found = np.array(ratios).reshape(60, 3, 2)
    assert (np.quantile(found[..., 0], 0.95, axis=0) <= 1.5).all()
    assert (np.median(found[..., 1], axis=0) <= 1.6).all()
    assert (found[..., 1] <= 5.0).all()


@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_an_order_is_the_order(order: int) -> None:
    """Half the step divides the error by 2 to the order."""
    motion: Any = BODY.free_motion((0.3, 1.0, 0.2))
    sizes = []
    for rows in (41, 81):
        exact = motion.at(np.linspace(0.0, 10.0, rows))
        omega, _ = kinematics.angular_velocity(exact.t, exact.quaternion, order=order)
        sizes.append(size((omega - exact.omega)[6:-6]))
    assert order - 0.4 < np.log2(sizes[0] / sizes[1]) < order + 0.6


def test_every_form_of_attitude_is_read() -> None:
    want, _ = kinematics.angular_velocity(T, MOTION.quaternion)
    flipped = MOTION.quaternion * np.where(np.arange(len(T)) % 2, -1.0, 1.0)[:, None]
    angles = euler_angles.from_quaternion(MOTION.quaternion, "ZYX")
    for attitude in (flipped, MOTION.rotation, MOTION.rotation.as_matrix()):
        np.testing.assert_allclose(kinematics.angular_velocity(T, attitude)[0], want, atol=1e-11)
    found, _ = kinematics.angular_velocity(T, angles, sequence="ZYX")
    np.testing.assert_allclose(found, want, atol=1e-11)


def test_frames() -> None:
    in_space, _ = kinematics.angular_velocity(T, MOTION.quaternion, "space")
    np.testing.assert_allclose(in_space, MOTION.rotation.apply(MOTION.omega), atol=1e-8)
    back, error = kinematics.quaternion(T, MOTION.rotation.apply(MOTION.omega), MOTION.rotation[0], "space")
    assert np.abs(back - MOTION.quaternion).max() < 2.0 * error.max() < 1e-6


def test_rows_that_are_not_there() -> None:
    attitude = MOTION.quaternion.copy()
    attitude[[0, 7, 8, 40]] = np.nan
    omega, error = kinematics.angular_velocity(T, attitude)
    gone = np.isnan(attitude).any(1)
    assert (np.isnan(omega).any(1) == gone).all()
    assert (np.isnan(error) == gone).all()
    assert np.abs(omega - MOTION.omega)[~gone].max() < 1e-8
    rates = MOTION.omega.copy()
    rates[[3, 80]] = np.nan
    found, _ = kinematics.quaternion(T, rates, MOTION.quaternion[0])
    assert np.nanmax(np.abs(found - MOTION.quaternion)) < 1e-6
    assert np.flatnonzero(np.isnan(found).any(1)).tolist() == [3, 80]


@pytest.mark.parametrize("sigma", [1e-6, 1e-3])
def test_smoothing(sigma: float, rng: np.random.Generator) -> None:
    t = np.sort(rng.uniform(0.0, 30.0, 1500))
    exact: Any = BODY.free_motion((0.3, 1.0, 0.2)).at(t)
    noisy = exact.rotation * Rotation.from_rotvec(sigma * rng.normal(size=(1500, 3)))
    plain, plain_error = kinematics.angular_velocity(t, noisy)
    smooth, error = kinematics.angular_velocity(t, noisy, sigma=sigma)
    assert size(smooth - exact.omega) < 0.1 * size(plain - exact.omega)
    assert size(smooth - exact.omega) < 1.5 * np.sqrt((error**2).mean())
    assert size(plain - exact.omega) < 1.5 * np.sqrt((plain_error**2).mean())
    assert np.median(error) < 5.0 * np.median(np.linalg.norm(smooth - exact.omega, axis=1))
    rates = exact.omega + sigma * rng.normal(size=(1500, 3))
    rate, error = kinematics.angular_acceleration(t, rates, sigma=sigma)
    assert size(rate - exact.angular_acceleration()) < 1.5 * np.sqrt((error**2).mean())


@pytest.mark.parametrize("rows", [3, 4, 5, 7])
def test_few_rows(rows: int) -> None:
    t = T[:rows]
    omega, error = kinematics.angular_velocity(t, MOTION.quaternion[:rows])
    assert (np.linalg.norm(omega - MOTION.omega[:rows], axis=1) <= 3.0 * error).all()
    found, error = kinematics.quaternion(t, MOTION.omega[:rows], MOTION.quaternion[0])
    assert np.abs(found - MOTION.quaternion[:rows]).max() < 3e-5
    assert np.isfinite(error).all()


def test_rest_and_large_turns() -> None:
    still, error = kinematics.angular_velocity(T, np.tile([0.5, 0.5, 0.5, 0.5], (81, 1)))
    assert (still == 0.0).all()
    assert (error == 0.0).all()
    t = np.arange(20.0)
    about_z = Rotation.from_rotvec(np.outer(2.9 * t, [0, 0, 1.0]))
    omega, _ = kinematics.angular_velocity(t, about_z)
    np.testing.assert_allclose(omega, np.tile([0, 0, 2.9], (20, 1)), atol=1e-12)


@pytest.mark.parametrize(
    ("t", "attitude", "words"),
    [
        ([0, 1, 1], np.tile([0, 0, 0, 1.0], (3, 1)), "t: row 2 is 1.0 after 1.0, and times must ascend"),
        ([0, 1, np.nan], np.tile([0, 0, 0, 1.0], (3, 1)), "t: row 2 is nan"),
        (
            [0, 1, 2],
            np.diag([1, 1, 2.0, 1])[1:],
            r"attitude: row 1 is no rotation: the norm of the quaternion is 2",
        ),
        ([0, 1, 2], np.tile(-np.eye(3), (3, 1, 1)), "row 0 is no rotation: the determinant is -1"),
        ([0, 1, 2], np.tile([0, 0, np.inf, 1.0], (3, 1)), "attitude: row 0 is infinite"),
        ([0, 1, 2], np.zeros((2, 3, 4)), "attitude: expected one body, got a stack"),
        ([0, 1], np.tile([0, 0, 0, 1.0], (2, 1)), "attitude: needs at least 3 rows without NaN, got 2"),
    ],
)
def test_what_is_refused(t: Any, attitude: Any, words: str) -> None:
    with pytest.raises((PolhodeError, ValueError), match=words):
        kinematics.angular_velocity(t, attitude)


def test_words_that_are_refused() -> None:
    for bad in ({"order": 3}, {"sigma": -1.0}, {"frame": "B"}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            kinematics.angular_velocity(T, MOTION.quaternion, **bad)
    with pytest.raises(ValueError, match="omega: expected shape"):
        kinematics.quaternion(T, MOTION.omega[:3])
    with pytest.raises(ValueError, match=r"attitude: expected shape \(4,\)"):
        kinematics.quaternion(T, MOTION.omega, MOTION.quaternion)


@pytest.mark.parametrize("size", [1e-150, 1e-8, 1e8, 1e150])
def test_units_of_any_size(size: float) -> None:
    """The same digits in any unit of time; beyond floats, and of steps that differ too much, an error."""
    near = 2.0 ** np.round(np.log2(size))
    plain, told = kinematics.angular_velocity(T, MOTION.quaternion)
    found, error = kinematics.angular_velocity(near * T, MOTION.quaternion)
    assert np.array_equal(found * near, plain)
    assert np.array_equal(error * near, told)
    attitude, _ = kinematics.quaternion(near * T, MOTION.omega / near)
    assert np.array_equal(attitude, kinematics.quaternion(T, MOTION.omega)[0])


def test_what_is_beyond() -> None:
    with pytest.raises(PolhodeError, match="t: its steps go from 1e-17 to 1"):
        kinematics.angular_velocity([0.0, 1e-17, 1.0], MOTION.quaternion[:3])
    with pytest.raises(PolhodeError, match="t: the rates are beyond floating-point numbers"):
        kinematics.angular_velocity(1e-308 * np.arange(81), Rotation.from_rotvec(np.outer(T * 40, [0, 0, 1])))
    with pytest.raises(PolhodeError, match=r"omega: the body would turn by 5\.2e\+08 rad"):
        kinematics.quaternion(T, 1e10 * MOTION.omega)
    with pytest.raises(PolhodeError, match="sigma: 100 is more than 10"):
        kinematics.angular_velocity(T, MOTION.quaternion, sigma=100.0)
