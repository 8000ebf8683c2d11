"""Controllers whose target moves: with a rate, along samples, down to the attractor of an orbit."""

from __future__ import annotations

import pickle
import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import RigidBody, loads, orbits
from polhode.errors import PolhodeError
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Callable

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
OMEGA = np.array([0.2, -0.1, 0.3])
K, D = np.diag([2.0, 3.0, 4.0]), np.diag([1.5, 2.0, 2.5])
T = np.linspace(0.0, 12.0, 7)
ORBIT = orbits.from_elements(1.0, eccentricity=0.3, periapsis=1.2, inclination=0.4, node=0.3)
RATE = np.array([0.1, 0.2, -0.3])
SAMPLES_AT = np.linspace(-1.0, 13.0, 15)
SAMPLES = (
    Rotation.from_rotvec(np.outer(SAMPLES_AT, RATE)) * Rotation.from_rotvec([0.1, 0.2, 0.3])
).as_quat() * np.where(np.arange(15) % 2, 1, -1)[:, None]
Target = tuple[Rotation, np.ndarray]


def turning(t: float) -> Target:
    """Give the target with a rate, and its rate in its own frame."""
    now = Rotation.from_rotvec(RATE * t) * Rotation.from_quat([0.1, 0.3, 0.3, 0.9])
    return now, now.inv().apply(RATE)


def down(t: float) -> Target:
    """Give the frame with z to the attractor and y along minus the normal."""
    r, v = ORBIT.at(t)
    z, y = -r / np.linalg.norm(r), -np.cross(r, v) / np.linalg.norm(np.cross(r, v))
    rate = np.cross(r, v) / (r @ r)
    now = Rotation.from_matrix(np.stack([np.cross(y, z), y, z], axis=-1))
    return now, now.inv().apply(rate)


def sampled(t: float) -> Target:
    """Give the smooth path through the samples."""
    signs = np.where(np.arange(15) % 2, 1, -1)[:, None]
    path = CubicSpline(SAMPLES_AT, SAMPLES * signs)

    def at(t: float) -> Rotation:
        return Rotation.from_quat(path(t))

    h = 1e-5
    return at(t), (at(t - h).inv() * at(t + h)).as_rotvec() / (2 * h)


def law(target: Callable[[float], Target]) -> Callable[[float, np.ndarray, np.ndarray], np.ndarray]:
    """Give the torque of a controller, from its definition."""

    def torque(t: float, omega: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
        aim, rate = target(t)
        error = aim.inv() * Rotation.from_quat(quaternion)
        x, y, z, w = error.as_quat()
        found: np.ndarray = -K @ (np.sign(w) * np.array([x, y, z])) - D @ (omega - error.inv().apply(rate))
        return found

    return torque


TARGETS: dict[str, tuple[dict[str, Any], Callable[[float], Target]]] = {
    "with a rate": ({"target": (0.1, 0.3, 0.3, 0.9), "rate": RATE}, turning),
    "down": ({"target": ORBIT}, down),
    "sampled": ({"target": SAMPLES, "times": SAMPLES_AT}, sampled),
}


@pytest.mark.parametrize("name", TARGETS)
@pytest.mark.parametrize("attitude", [(0, 0, 0, 1), (0.1, 0.9, 0.3, -0.2)])
def test_it_is_the_law_toward_where_the_target_is(name: str, attitude: tuple[float, ...]) -> None:
    arguments, target = TARGETS[name]
    control = loads.feedback(K, D, **arguments)
    start = np.array(attitude) / np.linalg.norm(attitude)
    for t in (0.0, 3.7):
        expected = law(target)(t, OMEGA, start)
        got = control.torque(t, OMEGA, start, start=0.0)
        np.testing.assert_allclose(got, expected, atol=1e-9 if name == "sampled" else 1e-14)
    run = BODY.simulate(T, OMEGA, start, load=control, rtol=1e-11)
    called = BODY.simulate(T, OMEGA, start, load=loads.torque_callback(law(target)), rtol=1e-11)
    np.testing.assert_allclose(run.omega, called.omega, atol=1e-8)
    np.testing.assert_allclose(np.abs(np.sum(run.quaternion * called.quaternion, axis=-1)), 1.0, atol=1e-8)


@pytest.mark.parametrize("name", TARGETS)
def test_the_body_comes_to_move_with_the_target(name: str) -> None:
    arguments, target = TARGETS[name]
    ball = RigidBody.from_principal(1.0, (0.01, 0.01, 0.01))  # nothing holds it back
    control = loads.feedback(2.0, 1.0, **arguments)
    run = ball.simulate([0.0, 12.0], OMEGA, (0.1, 0.5, 0.5, 0.7), load=control, method="radau", rtol=1e-9)
    aim, rate = target(12.0)
    error = aim.inv() * Rotation.from_quat(run.quaternion[-1])
    assert error.magnitude() < 0.02
    np.testing.assert_allclose(run.omega[-1], rate, atol=0.02)


@pytest.mark.parametrize("name", TARGETS)
def test_motors_follow_it_too(name: str) -> None:
    arguments, _ = TARGETS[name]
    control = loads.feedback(K, D, **arguments)
    outside = BODY.simulate(T, OMEGA, load=control, rtol=1e-11)
    wheels = [loads.wheel(axis, 1e-9, torque=control) for axis in np.eye(3)]
    inside = BODY.simulate(T, OMEGA, load=wheels[0] + wheels[1] + wheels[2], rtol=1e-11)
    # The body of the first keeps no momentum, that of the second has it in its wheels.
    total = inside.angular_momentum().spin
    np.testing.assert_allclose(total, np.broadcast_to(total[0], total.shape), atol=1e-9)
    assert np.abs(inside.omega[0] - outside.omega[0]).max() == 0.0
    spread = loads.wheel((0, 0, 1), 1e-9, torque=control, max_torque=0.5, dry_friction=0.01)
    assert np.isfinite(BODY.simulate(T, OMEGA, load=spread).omega).all()


@pytest.mark.parametrize("name", TARGETS)
def test_resumed_pickled_and_scaled_it_is_the_same(name: str) -> None:
    arguments, _ = TARGETS[name]
    control = loads.feedback(K, D, **arguments)
    whole = BODY.simulate(T, OMEGA, load=control, rtol=1e-11)
    again = BODY.simulate(T, OMEGA, load=pickle.loads(pickle.dumps(control)), rtol=1e-11)
    np.testing.assert_array_equal(again.omega, whole.omega)
    rest = BODY.simulate(T[:4], OMEGA, load=control, rtol=1e-11).resume(T[3:])
    np.testing.assert_allclose(rest.omega[-1], whole.omega[-1], atol=1e-9)
    double = loads.feedback(2 * K, 2 * D, **arguments)
    twice = BODY.simulate(T, OMEGA, load=2 * control, rtol=1e-11)
    np.testing.assert_array_equal(twice.omega, BODY.simulate(T, OMEGA, load=double, rtol=1e-11).omega)


def test_an_epoch_is_when_the_target_is_there() -> None:
    late = loads.feedback(K, D, (0.1, 0.3, 0.3, 0.9), rate=RATE, epoch=-3.0)
    aim, _ = turning(3.0)
    now = loads.feedback(K, D, aim.as_quat(), rate=RATE)
    got = [BODY.simulate(T, OMEGA, load=control, rtol=1e-11).omega for control in (late, now)]
    np.testing.assert_allclose(got[0], got[1], atol=1e-9)


def test_a_target_without_a_rate_stays() -> None:
    still = loads.feedback(K, D, (0, 0, 0.6, 0.8), rate=(0, 0, 0))
    plain = loads.feedback(K, D, (0, 0, 0.6, 0.8))
    runs = [BODY.simulate(T, OMEGA, load=control, method="dop853") for control in (still, plain)]
    np.testing.assert_allclose(runs[0].omega, runs[1].omega, rtol=1e-13, atol=1e-15)


def test_a_stack_of_orbits_is_a_stack_of_loads() -> None:
    orbit = orbits.from_elements(1.0, eccentricity=[0.0, 0.5], periapsis=1.0)
    run = BODY.simulate(T, OMEGA, load=loads.feedback(K, D, orbit))
    for row, e in enumerate((0.0, 0.5)):
        one = loads.feedback(K, D, orbits.from_elements(1.0, eccentricity=e, periapsis=1.0))
        np.testing.assert_array_equal(run.omega[row], BODY.simulate(T, OMEGA, load=one).omega)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: loads.feedback(1, 1, ORBIT, rate=(0, 0, 1)), TypeError, "rate: not beside an orbit"),
        (lambda: loads.feedback(1, 1, ORBIT, times=[0, 1]), TypeError, "times: not beside an orbit"),
        (lambda: loads.feedback(1, 1, ORBIT, epoch=0.0), TypeError, "epoch: not beside an orbit"),
        (lambda: loads.feedback(1, 1, epoch=1.0), TypeError, "epoch: it is that of a target with rate="),
        (lambda: loads.feedback(1, 1, rate=(0, np.nan, 0)), PolhodeError, "rate must be finite"),
        (lambda: loads.feedback(1, 1, SAMPLES, times=SAMPLES_AT, rate=RATE), TypeError, "not beside times="),
        (lambda: loads.feedback(1, 1, SAMPLES, times=SAMPLES_AT[1:]), ValueError, "each of the 14 times"),
        (lambda: loads.feedback(1, 1, SAMPLES[:2], times=[1, 1]), PolhodeError, "times"),
        (lambda: loads.feedback(1, 1, SAMPLES[:1], times=[1]), PolhodeError, "at least 2"),
        (
            lambda: loads.feedback(1, 1, [(0, 0, 0, 1), (0, 0, 0.8, 0.6)], times=[0, 1]),
            PolhodeError,
            "less than a quarter of a turn",
        ),
        (
            lambda: BODY.simulate([0, 99], OMEGA, load=loads.feedback(1, 1, SAMPLES, times=SAMPLES_AT)),
            PolhodeError,
            "99",
        ),
        (
            lambda: BODY.simulate(T, OMEGA, load=loads.feedback(1, 1, ORBIT), method="taylor"),
            PolhodeError,
            "no feedback on a target that moves",
        ),
    ],
)
def test_what_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=re.escape(message)):
        make()


def test_samples_up_to_a_quarter_of_a_turn_apart() -> None:
    near = Rotation.from_rotvec([[0, 0, 0], [0, 0, np.pi / 2 - 1e-6]]).as_quat()
    assert loads.feedback(1, 1, near, times=[0, 1])
    far = Rotation.from_rotvec([[0, 0, 0], [0, 0, np.pi / 2 + 1e-6]]).as_quat()
    with pytest.raises(PolhodeError, match=r"1\.5707"):
        loads.feedback(1, 1, far, times=[0, 1])
