"""Sensors beside the gyro: attitudes, an accelerometer, known torques. Logs and bounds are SciPy's."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polhode import RigidBody, identify
from polhode.errors import IdentificationError, PolhodeError
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
GYRO, TURN, FORCE = 0.01, 0.02, 0.05
"""Sigmas of the three sensors."""
TENSOR = Rotation.random(random_state=5).as_matrix()
TENSOR = TENSOR @ np.diag((0.2, 0.35, 0.45)) @ TENSOR.T
START, FIRST = np.array([1.0, 3.0, 0.5]), Rotation.random(random_state=6)
PLACE, BIAS, SCALE = (
    np.array([0.12, -0.3, 0.05]),
    np.array([0.05, -0.02, 0.03]),
    np.array([0.01, -0.02, 0.015]),
)
T = np.linspace(0.0, 8.0, 600)
NONE = np.zeros(3)


Row = tuple[float, ...]


def states(
    inertia: Floats, start: Floats, t: Floats, torque: Any, rotor: Any
) -> tuple[Floats, Rotation, Floats]:
    """ω, the attitude from that at the first time, and ω̇, by Euler's equations."""
    given = (tuple(np.ravel(one).tolist()) for one in (inertia, start, t, torque, rotor))
    return solved(*given)


@functools.cache
def solved(tensor: Row, start: Row, t: Row, torque: Row, rotor: Row) -> tuple[Floats, Rotation, Floats]:
    inertia, n, h = np.reshape(tensor, (3, 3)), np.array(torque), np.array(rotor)
    inverse = np.linalg.inv(inertia)

    def alpha(omega: Floats) -> Floats:
        momentum = inertia @ omega + h
        (x, y, z), (a, b, c) = omega.tolist(), momentum.tolist()
        return np.asarray(inverse @ (n - (y * c - z * b, z * a - x * c, x * b - y * a)))

    def rates(_: float, state: Floats) -> Floats:
        omega, (x, y, z, a, b, c, w) = state[:3], state.tolist()
        turn = (w * x + b * z - c * y, w * y + c * x - a * z, w * z + a * y - b * x, -a * x - b * y - c * z)
        return np.concatenate([alpha(omega), 0.5 * np.array(turn)])

    first = np.concatenate([start, [0.0, 0.0, 0.0, 1.0]])
    found = solve_ivp(rates, (t[0], t[-1]), first, "DOP853", t, rtol=1e-12, atol=1e-13).y.T
    omega = found[:, :3]
    return omega, Rotation.from_quat(found[:, 3:]), np.array([alpha(one) for one in omega])


def readings(
    start: Floats = START,
    inertia: Floats = TENSOR,
    bias: Floats = NONE,
    scale: Floats = NONE,
    turn: Floats = NONE,
    place: Floats = PLACE,
    t: Floats = T,
    torque: Any = NONE,
    rotor: Any = NONE,
) -> tuple[Floats, Rotation, Floats]:
    """What gyro, camera and accelerometer read without noise."""
    omega, turned, alpha = states(inertia, start, t, torque, rotor)
    force = np.cross(alpha, place) + np.cross(omega, np.cross(omega, place))
    return (1.0 + scale) * omega + bias, FIRST * Rotation.from_rotvec(turn) * turned, force


def log(seed: int, **changes: Any) -> tuple[Floats, Floats, Floats]:
    """The same with noise."""
    rng = np.random.default_rng(seed)
    omega, attitude, force = readings(**changes)
    n = (len(omega), 3)
    measured = attitude * Rotation.from_rotvec(rng.normal(0.0, TURN, n))
    return omega + rng.normal(0.0, GYRO, n), measured.as_quat(), force + rng.normal(0.0, FORCE, n)


def elements(inertia: Any) -> Floats:
    return np.array([inertia[place] for place in ELEMENTS])


SENSORS: dict[str, Any] = {"attitude_sigma": TURN, "specific_force_sigma": FORCE, "scale": True, "bias": True}


@functools.cache
def jacobian() -> Floats:
    """Derivatives of all readings by ω₀, tensor, bias, scales, turn and place, in units of the sigmas."""
    truth = np.concatenate([START, elements(TENSOR), BIAS, SCALE, NONE, PLACE])

    def predicted(x: Floats) -> Floats:
        inertia = np.zeros((3, 3))
        for value, (i, j) in zip(x[3:9], ELEMENTS, strict=True):
            inertia[i, j] = inertia[j, i] = value
        omega, attitude, force = readings(x[:3], inertia, x[9:12], x[12:15], x[15:18], x[18:21])
        turns = (attitude_at_truth.inv() * attitude).as_rotvec()
        return np.concatenate([(omega / GYRO).ravel(), (turns / TURN).ravel(), (force / FORCE).ravel()])

    attitude_at_truth = readings(bias=BIAS, scale=SCALE)[1]
    h = 1e-5
    return np.array([(predicted(truth + h * e) - predicted(truth - h * e)) / (2 * h) for e in np.eye(21)]).T


def bound() -> Floats:
    """The bound of Cramér and Rao for tensors of one trace."""
    maps = np.delete(np.eye(21), 5, axis=0)
    maps[3:5, 5] = -1.0
    upper = np.linalg.qr(jacobian() @ maps.T, mode="r")
    root = maps.T @ np.linalg.inv(upper)
    return np.asarray(root @ root.T)


class TestAllSensors:
    def test_exact_readings_give_all_exactly(self) -> None:
        omega, attitude, force = readings(bias=BIAS, scale=SCALE)
        found = identify.from_tumble(T, omega, sigma=GYRO, attitude=attitude, specific_force=force, **SENSORS)
        assert np.allclose(found.body.inertia, TENSOR, rtol=0.0, atol=1e-8)
        assert found.bias is not None
        assert found.scale is not None
        assert found.sensor_place is not None
        assert found.start is not None
        assert np.allclose(found.bias.value, BIAS, rtol=0.0, atol=1e-8)
        assert np.allclose(found.scale.value, SCALE, rtol=0.0, atol=1e-8)
        assert np.allclose(found.sensor_place.value, PLACE, rtol=0.0, atol=1e-8)
        off = (Rotation.from_quat(found.start.attitude).inv() * FIRST).magnitude()
        assert off < 1e-8
        assert found.motion is not None
        assert (Rotation.from_quat(found.motion.at(T).quaternion).inv() * attitude).magnitude().max() < 1e-7
        assert found.chi2 < 1e-8
        assert found.degrees_of_freedom == 9 * len(T) - 20
        assert found.residuals.shape == (len(T), 9)
        assert found.columns[3:6] == ("attitude x", "attitude y", "attitude z")

    def test_the_bound_is_that_of_differences(self) -> None:
        body = RigidBody(mass=1.0, inertia=TENSOR)
        told = identify.design(body, START, T, GYRO, sensor_place=PLACE, **SENSORS)
        assert told.crlb.shape == (21, 21)
        sigma = np.sqrt(np.diagonal(bound()))
        # The scales multiply what is measured, 1 + 0.02 at most: the design has none.
        assert np.allclose(told.crlb / np.outer(sigma, sigma), bound() / np.outer(sigma, sigma), atol=0.04)
        exact = identify.design(body, START, T, GYRO, sensor_place=PLACE, bias=True, attitude_sigma=TURN,
                                specific_force_sigma=FORCE)  # fmt: skip
        rest = [k for k in range(21) if not 12 <= k < 15]
        maps = np.delete(np.eye(21), [5, 12, 13, 14], axis=0)
        maps[3:5, 5] = -1.0
        own = jacobian().copy()
        own[: 3 * len(T), :9] /= np.tile(1.0 + SCALE, len(T))[:, None]
        root = maps.T @ np.linalg.inv(np.linalg.qr(own @ maps.T, mode="r"))
        assert np.allclose(exact.crlb, (root @ root.T)[np.ix_(rest, rest)], rtol=1e-5, atol=1e-13)

    def test_errors_are_as_large_as_their_covariance(self) -> None:
        squares, chi2 = [], []
        free = np.delete(np.arange(21), 5)
        truth = np.concatenate([START, elements(TENSOR), BIAS, SCALE, NONE, PLACE])
        for seed in range(20):
            omega, attitude, force = log(seed, bias=BIAS, scale=SCALE)
            found = identify.from_tumble(
                T, omega, sigma=GYRO, attitude=attitude, specific_force=force, **SENSORS
            )
            assert found.start is not None
            off = found.estimate - truth
            off[15:18] = (FIRST.inv() * Rotation.from_quat(found.start.attitude)).as_rotvec()
            squares.append(off[free] @ np.linalg.solve(found.covariance[np.ix_(free, free)], off[free]))
            chi2.append(found.p_value)
        # Of chi-square with 20 degrees: 20 ± 1.4.
        assert 15.0 < np.mean(squares) < 25.0
        assert min(chi2) > 1e-4


class TestAttitude:
    def test_few_attitudes_beside_a_fast_gyro(self) -> None:
        omega, attitude, _ = log(3, scale=SCALE)
        attitude[np.arange(len(T)) % 20 != 7] = np.nan
        found = identify.from_tumble(T, omega, sigma=GYRO, attitude=attitude, attitude_sigma=TURN, scale=True)
        assert found.scale is not None
        assert np.abs((found.scale.value - SCALE) / found.scale.sigma).max() < 4.0
        assert found.degrees_of_freedom == 3 * len(T) + 3 * 30 - 14
        assert np.isnan(found.residuals[0, 3:]).all()
        # Without the scales it is the log of no free motion.
        with pytest.raises(IdentificationError, match="no free motion"):
            identify.from_tumble(T, omega, sigma=GYRO, bias=True)

    def test_attitudes_make_the_tensor_surer(self) -> None:
        omega, attitude, _ = log(4)
        alone = identify.from_tumble(T, omega, sigma=GYRO, bias=True)
        both = identify.from_tumble(
            T, omega, sigma=GYRO, bias=True, attitude=Rotation.from_quat(attitude), attitude_sigma=TURN
        )
        assert np.all(np.diagonal(both.covariance)[3:9] < np.diagonal(alone.covariance)[3:9])
        assert both.bias is not None
        assert alone.bias is not None
        assert np.all(both.bias.sigma < alone.bias.sigma)

    def test_a_long_log_with_a_scale_that_is_off(self) -> None:
        # By 2 % of 100 radians the attitude is off by more than half a turn at the end.
        t = np.linspace(0.0, 30.0, 1500)
        omega, attitude, _ = log(5, scale=np.full(3, 0.04), t=t)
        found = identify.from_tumble(t, omega, sigma=GYRO, attitude=attitude, attitude_sigma=TURN, scale=True)
        assert found.scale is not None
        assert np.abs((found.scale.value - 0.04) / found.scale.sigma).max() < 4.0
        assert found.p_value > 1e-4

    def test_outliers(self) -> None:
        omega, attitude, _ = log(6)
        wild = np.random.default_rng(0).random(len(T)) < 0.03
        attitude[wild] = Rotation.random(int(wild.sum()), random_state=1).as_quat()
        found = identify.from_tumble(
            T, omega, sigma=GYRO, attitude=attitude, attitude_sigma=TURN, loss="student"
        )
        off = (found.estimate[3:9] - elements(TENSOR)) / np.sqrt(np.diagonal(found.covariance)[3:9])
        assert np.abs(off).max() < 4.0


class TestAccelerometer:
    def test_its_place(self) -> None:
        omega, _, force = log(7)
        found = identify.from_tumble(
            T, omega, specific_force=force, specific_force_sigma=(FORCE, FORCE, FORCE)
        )
        assert found.sensor_place is not None
        assert np.abs((found.sensor_place.value - PLACE) / found.sensor_place.sigma).max() < 4.0
        assert found.noise is not None
        assert np.allclose(found.noise.value, GYRO, rtol=0.06)
        assert found.parameters[-3:] == ("sensor_place_x", "sensor_place_y", "sensor_place_z")

    def test_it_is_nowhere_on_the_axis_of_a_spin(self) -> None:
        body = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
        told = identify.design(body, (0.0, 0.0, 3.0), T, GYRO, specific_force_sigma=FORCE)
        assert np.isnan(told.covariance).any()


class TestTorque:
    @pytest.mark.parametrize("rotor", [None, (0.3, -0.1, 0.2)])
    def test_a_known_torque_tells_the_scale(self, rotor: Any) -> None:
        torque = np.array([0.3, -0.2, 0.4])
        inertia = 3.0 * TENSOR
        omega, _, _ = log(8, inertia=inertia, torque=torque, rotor=NONE if rotor is None else rotor)
        found = identify.from_tumble(T, omega, sigma=GYRO, torque=torque, rotor=rotor)
        assert found.scale_known
        assert found.motion is None
        off = found.estimate[3:9] - elements(inertia)
        assert off @ np.linalg.solve(found.covariance[3:9, 3:9], off) < 25.0
        assert found.p_value > 1e-4
        # Half of the torque is that of half of the body.
        if rotor is None:
            half = identify.from_tumble(T, omega, sigma=GYRO, torque=0.5 * torque)
            assert np.allclose(2.0 * half.body.inertia, found.body.inertia, rtol=1e-6)


class TestFiles:
    def test_a_result_is_read_as_it_was_written(self, tmp_path: Path) -> None:
        omega, attitude, force = log(9)
        found = identify.from_tumble(T, omega, sigma=GYRO, attitude=attitude, specific_force=force, **SENSORS)
        found.save(tmp_path / "throw.json")
        again = identify.Identified.from_file(tmp_path / "throw.json")
        assert again.columns == found.columns
        assert again.scale is not None
        assert found.scale is not None
        assert np.array_equal(again.scale.value, found.scale.value)
        assert again.start is not None
        assert found.start is not None
        assert np.array_equal(again.start.attitude, found.start.attitude)
        torque = identify.from_tumble(
            T, log(8, torque=(0.1, 0.2, 0.1))[0], sigma=GYRO, torque=(0.1, 0.2, 0.1)
        )
        torque.save(tmp_path / "torque.json")
        assert identify.Identified.from_file(tmp_path / "torque.json").motion is None

    def test_the_picture_names_its_columns(self) -> None:
        pytest.importorskip("matplotlib")
        omega, attitude, _ = log(9)
        found = identify.from_tumble(T, omega, sigma=GYRO, attitude=attitude, attitude_sigma=TURN)
        ax = found.plot(t=T)
        legend = ax.get_legend()
        assert legend is not None
        labels = [one.get_text() for one in legend.get_texts()]
        assert labels == [f"{name} {axis}" for axis in "xyz" for name in ("omega", "attitude")]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"scale": True}, "scale: the scales of a gyro follow only beside attitude="),
        (
            {"attitude": FIRST.as_quat() * np.ones((len(T), 1))},
            "attitude_sigma: it is needed beside attitude",
        ),
        ({"attitude_sigma": 0.1}, "attitude: it is needed beside attitude_sigma"),
        ({"specific_force": np.zeros((len(T), 3)), "specific_force_sigma": 0.0}, "specific_force_sigma"),
        ({"specific_force": np.zeros((3, 3)), "specific_force_sigma": 1.0}, "specific_force: expected"),
        ({"attitude": np.ones((len(T), 4)), "attitude_sigma": 0.1}, "attitude: row 0 is no rotation"),
        ({"attitude": np.full((len(T), 4), np.nan), "attitude_sigma": 0.1}, "attitude: no row is finite"),
        ({"torque": (1.0, np.inf, 0.0)}, "torque: expected three finite numbers"),
    ],
)
def test_arguments(given: Any, words: str) -> None:
    with pytest.raises((ValueError, PolhodeError), match=words):
        identify.from_tumble(T, log(0)[0], **given)
