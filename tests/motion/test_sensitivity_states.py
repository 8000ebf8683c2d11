"""Derivatives of motions under loads with states of their own, against complex steps and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles import complex_step
from oracles.wheels import ATTITUDE, BODY, OMEGA
from polhode import RigidBody, Uncertain, loads
from polhode.errors import PolhodeError

AXES = np.array([(1.0, 2.0, -2.0), (0.0, 0.3, 0.1)])
INERTIA, RATES = np.array([0.2, 0.11]), np.array([3.0, -5.0])
TIME = 3.0
AIM = np.array([0.2, -0.1, 0.05, 1.0]) / np.linalg.norm([0.2, -0.1, 0.05, 1.0])
K, D = np.array([(0.9, 0.1, 0.0), (0.0, 1.1, 0.2), (0.3, 0.0, 0.7)]), np.diag((0.4, 0.5, 0.6))
ELEMENTS = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))


def motion(*, feedback: bool = False, states: Any = None, time: float = TIME) -> Any:
    """Two wheels, the second with a motor, a slug and a torque from outside."""
    torque: Any = loads.feedback(K, D, AIM) if feedback else 0.3
    load = (
        loads.wheel(AXES[0], 0.2, 3.0, friction=0.1, torque=0.05)
        + loads.wheel(AXES[1], 0.11, -5.0, friction=0.02, torque=torque)
        + loads.slug(0.3, 0.4)
        + loads.constant_torque((0.1, -0.2, 0.3))
    )
    return BODY.simulate([0.0, time / 2, time], OMEGA, ATTITUDE, load=load, states=states)


def numbers(*, feedback: bool = False) -> complex_step.Numbers:
    """The same for the oracle."""
    found: complex_step.Numbers = {
        "q": ATTITUDE,
        "turn": np.zeros(3),
        "omega": OMEGA,
        "sigma": OMEGA,
        "tensor": BODY.inertia,
        "axis": AXES,
        "inertia": INERTIA,
        "rate": RATES,
        "friction": np.array([0.1, 0.02]),
        "torque": np.array([0.05, 0.0 if feedback else 0.3]),
        "slug": 0.3,
        "damping": 0.4,
        "outer": np.array([0.1, -0.2, 0.3]),
    }
    if feedback:
        found |= {"K": K, "D": D, "aim": AIM, "target": np.zeros(3)}
    units = np.array([a / np.linalg.norm(a) for a in AXES])
    return found | {"h": INERTIA * (RATES + units @ OMEGA)}


def begun(its: complex_step.Numbers) -> complex_step.Numbers:
    """The momenta that follow from axis, inertia and rate, with ω held."""
    units = np.array([a / np.sqrt(a @ a) for a in its["axis"]])
    return its | {"h": its["inertia"] * (its["rate"] + units @ OMEGA)}


def by_tensor(found: Any) -> np.ndarray:
    """By the elements of the tensor in the body frame, from those in its principal axes."""
    V, columns = BODY.principal.axes, []
    for i, j in ELEMENTS:
        change = np.zeros((3, 3))
        change[i, j] = change[j, i] = 1.0
        turned = V.T @ change @ V
        off = np.array([turned[1, 2], turned[2, 0], turned[0, 1]])
        columns.append(found.moments[-1] @ np.diag(turned) + found.products[-1] @ off)
    return np.array(columns).T


def near(got: np.ndarray, exact: np.ndarray, allowed: float = 2e-11) -> None:
    """Relative to the largest of a kind."""
    assert got.shape == exact.shape
    assert np.abs(got - exact).max() <= allowed * np.abs(exact).max()


@pytest.mark.parametrize("feedback", [False, True])
def test_wheels_and_a_slug(feedback: bool) -> None:
    time = 1.0 if feedback else TIME  # before the feedback takes the other way round
    found = motion(feedback=feedback, time=time).sensitivity()
    its = numbers(feedback=feedback)
    states = ["turn", "omega", "h", "sigma"]
    names = [name for name in its if name not in (*states, "q", "aim")]
    own = complex_step.derivatives(its, time, states)
    exact = complex_step.derivatives(its, time, names, begun)
    start = np.hstack([own[name] for name in states])
    near(found.state[-1], start)
    tensor = exact["tensor"]
    elements = [tensor[:, i, j] + (tensor[:, j, i] if i != j else 0) for i, j in ELEMENTS]
    near(by_tensor(found), np.array(elements).T)
    first, second, slug, outer = found.load
    for k, wheel in enumerate((first, second)):
        near(wheel["axis"][-1], exact["axis"][:, k])
        for name in ("inertia", "rate", "friction"):
            near(wheel[name][-1], exact[name][:, k])
    near(first["torque"][-1], exact["torque"][:, 0])
    if feedback:
        for name in ("K", "D", "target"):
            near(second[name][-1], exact[name])
    else:
        near(second["torque"][-1], exact["torque"][:, 1])
    near(slug["inertia"][-1], exact["slug"])
    near(slug["damping"][-1], exact["damping"])
    near(outer["vector"][-1], exact["outer"])
    assert not found.mass.any()
    # At the first time: the states that begin with ω.
    assert np.array_equal(found.state[0], np.eye(11))
    units = np.array([a / np.linalg.norm(a) for a in AXES])
    np.testing.assert_allclose(found.begins, np.vstack([INERTIA[:, None] * units, np.eye(3)]), atol=1e-16)
    assert first["inertia"][0][6] == pytest.approx(3.0 + units[0] @ OMEGA, rel=1e-15)


def test_states_that_are_given_do_not_follow_from_the_numbers() -> None:
    start = {name: values[0] for name, values in motion().states.items()}
    found = motion(states=start).sensitivity()
    exact = complex_step.derivatives(numbers(), TIME, ["axis", "inertia"])
    assert not found.begins.any()
    assert not found.load[0]["rate"].any()
    near(found.load[0]["axis"][-1], exact["axis"][:, 0])
    near(found.load[1]["inertia"][-1], exact["inertia"][:, 1])


def test_two_spans_make_one() -> None:
    """The transition matrices of two runs, one after the other, multiply to that of both."""
    whole = motion()
    late = whole.body.simulate([TIME / 2, TIME], **whole.state(1)._asdict(), load=whole.load)
    together = late.sensitivity().state[-1] @ whole.sensitivity().state[1]
    near(together, whole.sensitivity().state[-1], 1e-12)


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_speed_that_is_given(method: Any) -> None:
    """Differences of runs: the speeds at the times of a table, the inertia, ω."""
    times, speeds = np.array([0.0, 2.0, 7.0]), np.array([1.0, 4.0, -3.0])

    def run(
        inertia: float = 0.2, speeds: np.ndarray = speeds, axis: Any = (1, 2, -2), omega: Any = OMEGA
    ) -> Any:
        load = loads.wheel(axis, inertia, speed=speeds, times=times)
        return BODY.simulate(
            [0.0, TIME], omega, ATTITUDE, load=load, rtol=1e-14 if method == "taylor" else 2.3e-15
        )

    def column(change: Any, step: float = 1e-4) -> np.ndarray:
        """By differences of order four."""
        ends = []
        for part in (-2, -1, 1, 2):
            moved = change(part * step)
            ends.append(np.concatenate([moved.omega[-1], moved.states["wheel"][-1]]))
        a, b, c, d = ends
        return np.asarray((a - 8 * b + 8 * c - d) / (12 * step))

    found = run().sensitivity()
    (wheel,) = found.load
    assert set(wheel) == {"axis", "inertia", "speed"}
    near(wheel["inertia"][-1][3:], column(lambda e: run(inertia=0.2 + e)), 1e-9)
    for k in range(3):
        near(wheel["speed"][-1][3:, k], column(lambda e, k=k: run(speeds=speeds + e * np.eye(3)[k])), 1e-9)
        near(
            wheel["axis"][-1][3:, k],
            column(lambda e, k=k: run(axis=np.array([1, 2, -2]) + e * np.eye(3)[k])),
            1e-9,
        )
        near(found.state[-1][3:, 3 + k], column(lambda e, k=k: run(omega=OMEGA + e * np.eye(3)[k])), 1e-9)
    assert not found.state[:, :, 6].any()
    assert not found.begins.any()


def test_a_torque_that_changes_at_times() -> None:
    """About one axis: h is the sum of torques times their spans, and (I − J) ω takes it from the body."""
    load = loads.wheel((0, 0, 2), 0.5, torque=[0.1, -0.3, 0.2], times=[0.0, 1.0, 2.5])
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    found = body.simulate([0.0, 2.0, 4.0], (0, 0, 0.3), load=load).sensitivity()
    spans = np.array([(0, 0, 0), (1.0, 1.0, 0.0), (1.0, 1.5, 1.5)])
    np.testing.assert_allclose(found.load[0]["torque"][:, 6], spans, atol=1e-14)
    np.testing.assert_allclose(found.load[0]["torque"][:, 5], -spans / 2.0, atol=1e-14)


def test_a_motor_whose_feedback_turns_round() -> None:
    """Beyond half a turn the torque changes its sign, and derivatives of h jump with those of ω.

    About one axis the body less the wheel, I − J, moves as one under the feedback alone: h = L − (I − J) ω.
    """
    J, k, start, speed, t = 0.5, 0.3, 1.0, 1.5, 4.5
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
    less = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0 - J))
    attitude = (0, 0, np.sin(start / 2), np.cos(start / 2))
    times = np.linspace(0.0, t, 4)
    feedback = loads.feedback(k, 0.0)
    alone = less.simulate(times, (0, 0, speed), attitude, load=feedback)
    run = body.simulate(times, (0, 0, speed), attitude, load=loads.wheel((0, 0, 1), J, 2.0, torque=feedback))
    assert run.quaternion[-1, 3] < 0 < run.quaternion[0, 3]
    found, exact = run.sensitivity(), alone.sensitivity()
    for i in (2, 5):
        np.testing.assert_allclose(found.state[:, i, [2, 5]], exact.state[:, i, [2, 5]], atol=1e-13)
    # h = L − (I − J) ω, L by ω at the start I − J.
    expected = np.array([0.0, 3.0 - J]) - (3.0 - J) * exact.state[:, 5][:, [2, 5]]
    np.testing.assert_allclose(found.state[:, 6][:, [2, 5]], expected, atol=1e-12)
    by_gain = exact.load[0]["K"][:, 5, 2, 2]
    np.testing.assert_allclose(found.load[0]["K"][:, 6, 2, 2], -(3.0 - J) * by_gain, atol=1e-12)


def test_feedback_beyond_half_a_turn_about_any_axis() -> None:
    """Differences of runs whose torques turn round at times of their own."""
    feedback = loads.feedback(K, D, AIM)

    def run(h: float = 0.0, gain: float = 0.0, times: Any = (0.0, 6.0)) -> Any:
        load = loads.wheel(
            AXES[0], 0.2, 3.0, torque=loads.feedback(K + gain * np.eye(3), D, AIM)
        ) + loads.wheel(AXES[1], 0.11, -5.0, friction=0.02, torque=feedback)
        states = {"wheel": run_states[0] + h, "wheel_2": run_states[1]}
        return BODY.simulate(times, OMEGA, ATTITUDE, load=load, states=states, rtol=1e-14)

    units = np.array([a / np.linalg.norm(a) for a in AXES])
    run_states = (INERTIA * (RATES + units @ OMEGA))[:, None]
    found = run().sensitivity()
    scalars = run(times=np.linspace(0, 6, 61)).quaternion @ AIM
    assert (np.diff(np.sign(scalars)) != 0).any()
    by_gain = np.einsum("...ii->...", found.load[0]["K"][-1])
    for got, change in ((found.state[-1][:, 6], {"h": 1e-4}), (by_gain, {"gain": 1e-4})):
        name, step = next(iter(change.items()))
        ends = [run(**{name: part * step}) for part in (-2, -1, 1, 2)]
        a, b, c, d = (np.concatenate([one.omega[-1], *(x[-1] for x in one.states.values())]) for one in ends)
        near(got[3:], (a - 8 * b + 8 * c - d) / (12 * step), 1e-8)


def test_gravity_pulls_the_wheels_too() -> None:
    """A gradient pulls the locked body, whatever turns freely in it: differences of runs."""
    orbit = loads.gravity_gradient(1.0, (1.0, 0.25, 0.125), (-0.125, 1.125, 0.25), epoch=-0.7)

    def run(inertia: float, x: float) -> Any:
        load = orbit + loads.wheel((x, 2, -2), inertia, 3.0)
        return BODY.simulate([0.0, TIME], OMEGA, ATTITUDE, load=load, rtol=1e-14)

    _, wheel = run(0.2, 1.0).sensitivity().load
    for name, change in (("inertia", (1.0, 0.0)), ("axis", (0.0, 1.0))):
        ends = [run(0.2 + e * 1e-4 * change[0], 1.0 + e * 1e-4 * change[1]) for e in (-2, -1, 1, 2)]
        a, b, c, d = (np.concatenate([one.omega[-1], one.states["wheel"][-1]]) for one in ends)
        slope = (a - 8 * b + 8 * c - d) / 12e-4
        got = wheel[name][-1][3:]
        near(got[:, 0] if got.ndim > 1 else got, slope, 1e-9)


def test_covariance_holds_the_rate_of_a_wheel() -> None:
    """Against many runs: ω at the start is uncertain, and the wheel begins with its rate, the slug with ω."""
    sigma = 1e-5
    load = motion().load
    run = BODY.simulate([0.0, TIME], Uncertain(OMEGA, sigma=sigma), ATTITUDE, load=load)
    columns, spins = [], []
    for axis in np.eye(3):
        ends = []
        for e in (-1, 1):
            moved = BODY.simulate([0.0, TIME], OMEGA + 1e-4 * e * axis, ATTITUDE, load=load, rtol=1e-14)
            ends.append((moved.omega[-1], moved.angular_momentum().spin[-1]))
        columns.append((ends[1][0] - ends[0][0]) / 2e-4)
        spins.append((ends[1][1] - ends[0][1]) / 2e-4)
    square = sigma**2 * np.array(columns).T @ np.array(columns)
    assert run.covariance is not None
    assert run.covariance.shape == (2, 6, 6)
    near(run.covariance[-1, 3:, 3:], square, 1e-6)
    spin = sigma**2 * np.array(spins).T @ np.array(spins)
    found = run._spin_covariance("space")
    assert found is not None
    near(found[-1], spin, 1e-6)
    assert run.sigma is not None
    assert run.sigma.linear.omega.all()


def test_stacks() -> None:
    load = loads.wheel((0, 3, 4), [0.1, 0.2], [1.0, 2.0], friction=0.1) + loads.slug(0.3, 0.4)
    found = BODY.simulate([0, 1, 2], OMEGA, load=load).sensitivity()
    assert found.state.shape == (2, 3, 10, 10)
    assert found.begins.shape == (2, 4, 3)
    assert found.load[0]["axis"].shape == (2, 3, 10, 3)
    alone = BODY.simulate([0, 1, 2], OMEGA, load=load[1]).sensitivity()
    assert np.array_equal(alone.state, found.state[1])
    assert np.array_equal(alone.load[1]["damping"], found.load[1]["damping"][1])


def test_without_series_there_are_none() -> None:
    for load in (
        loads.wheel((0, 0, 1), 0.1, 1.0, dry_friction=0.1),
        loads.wheel((0, 0, 1), 0.1, torque=loads.feedback(1.0, 1.0), max_torque=0.1),
    ):
        with pytest.raises(PolhodeError, match="a motor with a limit and dry friction"):
            BODY.simulate([0, 1], OMEGA, load=load).sensitivity()
