"""Rotors, wheels and slugs: against SciPy on the equations of both bodies, and against closed forms."""

from __future__ import annotations

import copy
import math
import pickle
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.wheels import ATTITUDE, BODY, OMEGA, T, by_scipy, of_wheels, turning
from polhode import RigidBody, Trajectory, loads
from polhode.errors import InvalidInertiaError, PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable

METHODS = [("taylor", 2.3e-15, 2e-11), ("dop853", 1e-12, 2e-10), ("radau", 1e-9, 1e-6)]


def apart(run: Trajectory, exact: np.ndarray) -> float:
    return float(max(np.abs(run.omega - exact[:, 4:7]).max(), np.abs(run.quaternion - exact[:, :4]).max()))


AXES = np.array([[1.0, 2.0, -2.0], [0.0, 3.0, 4.0]])
UNIT = AXES / np.linalg.norm(AXES, axis=1)[:, None]
J, RATES, FRICTION = np.array([0.2, 0.15]), np.array([3.0, -7.0]), np.array([0.05, 0.3])


@pytest.mark.parametrize(("method", "rtol", "allowed"), METHODS)
class TestAgainstBothBodies:
    def test_friction_and_a_motor(self, method: Any, rtol: float, allowed: float) -> None:
        first = loads.wheel(AXES[0], J[0], RATES[0], friction=FRICTION[0], torque=0.1)
        pair = first + loads.wheel(AXES[1], J[1], RATES[1], friction=FRICTION[1], name="second")
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=pair, method=method, rtol=rtol)
        rates = of_wheels(UNIT, J, FRICTION, lambda *_: np.array([0.1, 0.0]))
        exact = by_scipy(rates, list(RATES), [0.0, 15.0])
        assert apart(run, exact) < allowed
        momenta = J * (exact[:, 7:] + exact[:, 4:7] @ UNIT.T)
        assert np.abs(run.states["wheel"][:, 0] - momenta[:, 0]).max() < allowed
        assert np.abs(run.states["second"][:, 0] - momenta[:, 1]).max() < allowed
        spin = run.angular_momentum().spin
        assert np.abs(spin - spin[0]).max() < 10 * allowed
        energy = 0.5 * np.einsum("ti,ij,tj->t", exact[:, 4:7], BODY.inertia, exact[:, 4:7])
        energy += (J * exact[:, 7:] * (exact[:, 4:7] @ UNIT.T + 0.5 * exact[:, 7:])).sum(axis=1)
        assert np.abs(run.kinetic_energy().total - energy).max() < 10 * allowed

    def test_a_torque_that_is_held(self, method: Any, rtol: float, allowed: float) -> None:
        times, values = np.array([-1.0, 2.5, 7.0]), np.array([0.3, -0.7, 0.1])
        wheel = loads.wheel(AXES[0], J[0], RATES[0], torque=values, times=times)
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=wheel, method=method, rtol=rtol)

        def torque(t: float, *_: Any) -> np.ndarray:
            return values[[np.searchsorted(times, t, "right") - 1]]

        exact = by_scipy(of_wheels(UNIT[:1], J[:1], np.zeros(1), torque), [3.0], [0.0, 2.4999999999999, 15.0])
        assert apart(run, exact[[0, 1, 2, 3]]) < max(allowed, 1e-9)

    def test_a_feedback_on_the_attitude(self, method: Any, rtol: float, allowed: float) -> None:
        three = np.eye(3)
        control = loads.feedback(K=2.0, D=1.5, target=(0, 0, 0, 1))
        load: Any = sum(loads.wheel(axis, 0.1, torque=control) for axis in three)
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=load, method=method, rtol=rtol)

        def torque(_: float, q: np.ndarray, w: np.ndarray) -> Any:
            return np.sign(q[3]) * 2.0 * q[:3] + 1.5 * w

        exact = by_scipy(of_wheels(three, np.full(3, 0.1), np.zeros(3), torque), [0.0] * 3, [0.0, 15.0])
        assert apart(run, exact) < max(allowed, 1e-9)
        assert set(run.states) == {"wheel", "wheel_2", "wheel_3"}

    def test_a_given_speed(self, method: Any, rtol: float, allowed: float) -> None:
        wheel = loads.wheel(AXES[0], J[0], speed=[2.0, 5.0, -1.0], times=[0.0, 4.0, 15.0])
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=wheel, method=method, rtol=rtol)

        def rates(t: float, y: np.ndarray) -> np.ndarray:
            speed = np.interp(t, [0.0, 4.0, 15.0], [2.0, 5.0, -1.0])
            slope = 0.75 if t < 4.0 else -6.0 / 11.0
            w = y[4:7]
            spin = BODY.inertia @ w + J[0] * speed * UNIT[0]
            return np.concatenate(
                [
                    turning(y[:4], w),
                    np.linalg.solve(BODY.inertia, -np.cross(w, spin) - J[0] * slope * UNIT[0]),
                ]
            )

        exact = by_scipy(rates, [], [0.0, 3.99999999999999, 15.0])
        assert apart(run, exact) < max(allowed, 1e-9)
        speed = np.interp(T, [0.0, 4.0, 15.0], [2.0, 5.0, -1.0])
        assert np.abs(run.states["wheel"][:, 0] - J[0] * (speed + exact[:, 4:7] @ UNIT[0])).max() < 1e-6

    def test_a_slug(self, method: Any, rtol: float, allowed: float) -> None:
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=loads.slug(0.3, 0.4), method=method, rtol=rtol)

        def rates(_: float, y: np.ndarray) -> np.ndarray:
            w, s = y[4:7], y[7:]
            push = 0.4 * (s - w)
            rate = np.linalg.solve(BODY.inertia, push - np.cross(w, BODY.inertia @ w))
            return np.concatenate([turning(y[:4], w), rate, -push / 0.3 - np.cross(w, s)])

        exact = by_scipy(rates, list(OMEGA), [0.0, 15.0])
        assert apart(run, exact) < allowed
        assert np.abs(run.states["slug"] - exact[:, 7:]).max() < allowed
        energies = run.kinetic_energy().total
        assert (np.diff(energies) < 0).all()

    def test_a_rotor(self, method: Any, rtol: float, allowed: float) -> None:
        h = np.array([0.4, -0.2, 0.9])
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=loads.rotor(h), method=method, rtol=rtol)

        def rates(_: float, y: np.ndarray) -> np.ndarray:
            w = y[4:7]
            return np.concatenate(
                [turning(y[:4], w), np.linalg.solve(BODY.inertia, -np.cross(w, BODY.inertia @ w + h))]
            )

        assert apart(run, by_scipy(rates, [], [0.0, 15.0])) < allowed
        kept = run.invariants()
        assert kept.energy_drift < 10 * allowed
        assert kept.angular_momentum_drift < 10 * allowed


class TestLimits:
    CONTROL = loads.feedback(K=2.0, D=1.5, target=(0, 0, 0, 1))

    @pytest.mark.parametrize(("method", "rtol", "allowed"), [("auto", 1e-11, 1e-8), *METHODS[1:]])
    def test_a_motor_with_a_limit(self, method: Any, rtol: float, allowed: float) -> None:
        def torque(_: float, q: np.ndarray, w: np.ndarray) -> Any:
            return np.clip(UNIT @ (np.sign(q[3]) * 2.0 * q[:3] + 1.5 * w), -0.4, 0.4)

        exact = by_scipy(of_wheels(UNIT, J, FRICTION, torque), list(RATES), [0.0, 15.0])
        load: Any = sum(
            loads.wheel(axis, inertia, rate, torque=self.CONTROL, friction=friction, max_torque=0.4)
            for axis, inertia, rate, friction in zip(AXES, J, RATES, FRICTION, strict=True)
        )
        run = BODY.simulate(T, OMEGA, ATTITUDE, load=load, method=method, rtol=rtol)
        assert apart(run, exact) < allowed
        without = BODY.simulate(T, OMEGA, ATTITUDE, load=loads.wheel(AXES[0], 0.2, torque=self.CONTROL))
        assert np.abs(run.omega - without.omega).max() > 0.1

    def test_a_limit_that_is_not_reached(self) -> None:
        wide, free = (
            loads.wheel(AXES[0], 0.2, torque=self.CONTROL, max_torque=limit) for limit in (1e9, None)
        )
        runs = [BODY.simulate(T, OMEGA, ATTITUDE, load=load, rtol=1e-12).omega for load in (wide, free)]
        assert np.abs(runs[0] - runs[1]).max() < 1e-9
        again = pickle.loads(pickle.dumps(wide))
        assert np.array_equal(BODY.simulate(T, OMEGA, ATTITUDE, load=again, rtol=1e-12).omega, runs[0])


def test_a_gravity_gradient_beside_wheels() -> None:
    """Tilted wheels, alone and in a stack, by series of two precisions and by steps."""
    rng = np.random.default_rng(8)
    axes, momenta = rng.normal(size=(7, 3)), rng.uniform(0.05, 0.3, 7)
    pull = loads.gravity_gradient(3.0, position=(2.0, 0.3, 0.1), velocity=(0.1, 1.2, 0.3))
    load = pull + loads.wheel(axes, momenta, 2.0, friction=0.1) + loads.wheel((0, 1, 1), 0.2, 1.0, name="w")
    runs = BODY.simulate(T, OMEGA, ATTITUDE, load=load, method="taylor")
    exact = BODY.simulate(T, OMEGA, ATTITUDE, load=load, method="taylor", rtol=1e-22)
    steps = BODY.simulate(T, OMEGA, ATTITUDE, load=load, method="dop853", rtol=1e-13)
    assert np.abs(runs.omega - exact.omega).max() < 1e-9
    assert np.abs(steps.omega - exact.omega).max() < 1e-9
    for k in range(7):
        alone = BODY.simulate(T, OMEGA, ATTITUDE, load=load[k], method="taylor")
        assert np.abs(alone.omega - runs.omega[k]).max() < 1e-13


class TestOneAxis:
    """About one principal axis all is known by hand."""

    BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))

    def test_a_wheel_that_is_spun_up(self) -> None:
        run = self.BODY.simulate([0, 10], (0, 0, 0), load=loads.wheel((0, 0, 5), 0.5, torque=0.1))
        assert run.omega[-1] == pytest.approx((0, 0, -1.0 / (2.5 - 0.5)), abs=1e-14)
        assert run.states["wheel"][-1, 0] == pytest.approx(1.0, abs=1e-14)

    def test_friction_brings_them_together(self) -> None:
        """Body and wheel end with one rate; the difference decays with c (1/J + 1/(I − J))."""
        run = self.BODY.simulate(
            [0, 3], (0, 0, 1), load=loads.wheel((0, 0, 1), 0.5, 8.0, friction=0.2), rtol=1e-13
        )
        rate = 0.2 * (1 / 0.5 + 1 / 2.0)
        mean = (2.5 + 0.5 * 8.0) / 2.5
        expected = mean - 0.5 * 8.0 / 2.5 * np.exp(-3 * rate)
        assert run.omega[-1, 2] == pytest.approx(expected, abs=1e-13)

    def test_a_given_speed_that_is_constant_is_a_rotor(self) -> None:
        wheel = self.BODY.simulate([0, 9], OMEGA, load=loads.wheel((3, 0, 4), 0.5, speed=4.0), rtol=1e-13)
        rotor = self.BODY.simulate([0, 9], OMEGA, load=loads.rotor((1.2, 0, 1.6)), rtol=1e-13)
        assert np.abs(wheel.omega - rotor.omega).max() < 1e-13
        assert np.abs(wheel.angular_momentum().spin - rotor.angular_momentum().spin).max() < 1e-12

    def test_a_damping_matrix_is_a_rotor(self) -> None:
        h = np.array([0.4, -0.2, 0.9])
        skew = np.array([[0, -h[2], h[1]], [h[2], 0, -h[0]], [-h[1], h[0], 0]])
        one = BODY.simulate(T, OMEGA, load=loads.rotor(h), rtol=1e-13)
        other = BODY.simulate(T, OMEGA, load=loads.damping(-skew), rtol=1e-13)
        assert np.abs(one.omega - other.omega).max() < 1e-13

    def test_a_sampled_controller(self) -> None:
        """Each second it holds −g ω: ω goes down by the factor 1 − g/I."""

        def update(_t: float, w: np.ndarray, *_: Any) -> np.ndarray:
            return -0.5 * w

        def wrench(*arguments: Any) -> tuple[Any, Any]:
            return (0, 0, 0), arguments[-1]["control"]

        control = loads.with_states(None, np.zeros(3), wrench, "control", update=update, period=1.0)
        for method in ("dop853", "radau"):
            run = self.BODY.simulate(np.arange(6.0), (0, 0, 1), load=control, method=method)
            assert run.omega[:, 2] == pytest.approx((1 - 0.5 / 2.5) ** np.arange(6.0), abs=1e-12)
            assert run.states["control"][1:, 2] == pytest.approx(-0.5 * run.omega[:-1, 2], abs=1e-12)
        half = self.BODY.simulate([0, 2.5], (0, 0, 1), load=control)
        assert half.resume([2.5, 5.0]).omega[-1] == pytest.approx(run.omega[-1], abs=1e-12)


ANY: Any = 1
UPDATE: Any = len
REFUSED: list[tuple[Callable[[], Any], type[Exception], str]] = [
    (lambda: 2 * loads.slug(1, 1), PolhodeError, "cannot be scaled"),
    (lambda: -loads.wheel((0, 0, 1), 1), PolhodeError, "cannot be scaled"),
    (lambda: 2 * loads.with_states(None, [0]), PolhodeError, "cannot be scaled"),
    (lambda: loads.schedule(loads.rotor((0, 0, 1)), [(0, 1)]), PolhodeError, "cannot be scheduled"),
    (lambda: loads.schedule(loads.with_states(None, [0]), [(0, 1)]), PolhodeError, "cannot be scheduled"),
    (lambda: loads.wheel((0, 0, 0), 1), PolhodeError, "axis must not be the zero vector"),
    (lambda: loads.wheel((0, 0, 1), 0), PolhodeError, "inertia must be positive, got 0.0"),
    (lambda: loads.wheel((0, 0, 1), 1, friction=-1), PolhodeError, "friction must be positive or zero"),
    (lambda: loads.wheel((0, 0, 1), 1, speed=1, friction=1), TypeError, "friction: not beside speed="),
    (lambda: loads.wheel((0, 0, 1), 1, times=[0]), TypeError, "times: give torque= or speed= too"),
    (lambda: loads.wheel((0, 0, 1), 1, torque=[1, 2]), TypeError, "give the times= from which each holds"),
    (lambda: loads.wheel((0, 0, 1), 1, torque=[1, 2], times=[1]), ValueError, "one for each of the 1 times"),
    (
        lambda: loads.wheel((0, 0, 1), 1, torque=loads.rotor((0, 0, 1))),
        PolhodeError,
        "a motor exerts a torque",
    ),
    (lambda: loads.wheel((0, 0, 1), 1, name=""), ValueError, "name: must not be empty"),
    (
        lambda: loads.wheel((0, 0, 1), 1, torque=0.1, limit=ANY),  # type: ignore[call-arg]
        TypeError,
        "unexpected keyword argument 'limit'; it takes .*max_torque",
    ),
    (lambda: loads.wheel((0, 0, 1), 1, max_torque=1), TypeError, "max_torque: it is a limit of a motor"),
    (lambda: loads.wheel((0, 0, 1), 1, speed=1, max_rate=2), TypeError, "max_rate: it is a limit of a motor"),
    (
        lambda: loads.wheel((0, 0, 1), 1, torque=loads.feedback(1, 1), max_torque=0),
        PolhodeError,
        "max_torque must be positive, got 0.0",
    ),
    (
        lambda: run(loads.wheel((0, 0, 1), 1, torque=loads.feedback(1, 1), max_torque=1), method="taylor"),
        PolhodeError,
        "no motor with a limit",
    ),
    (lambda: loads.slug(-1, 1), PolhodeError, "inertia must be positive, got -1.0"),
    (lambda: loads.slug(1, -1), PolhodeError, "damping must be positive or zero, got -1.0"),
    (lambda: loads.rotor((0, np.inf, 0)), PolhodeError, "momentum must be finite"),
    (lambda: loads.with_states(ANY, [0]), TypeError, "rates: expected a callable"),
    (lambda: loads.with_states(None, [0], update=UPDATE), TypeError, "update= and period= together"),
    (lambda: loads.with_states(None, [0], update=UPDATE, period=0.0), ValueError, "period: must be positive"),
    (lambda: loads.with_states(None, [np.nan]), ValueError, "initial: must be finite"),
    (lambda: loads.with_states(None, [0, 1], scale=[1, 2, 3]), ValueError, "scale: expected one number or 2"),
    (lambda: run(loads.wheel((0, 0, 1), 2.5)), InvalidInertiaError, "must have positive moments"),
    (lambda: run(loads.wheel((0, 0, 1), 1), method="splitting"), PolhodeError, "without states of its own"),
    (lambda: run(loads.wheel((0, 0, 1), 1), states={"x": [1]}), ValueError, 'no "x"; the load has "wheel"'),
    (
        lambda: run(loads.wheel((0, 0, 1), 1), states={"wheel": [1, 2]}),
        ValueError,
        r"expected shape \(..., 1\)",
    ),
    (lambda: run(loads.wheel((0, 0, 1), 1), states=ANY), TypeError, "expected a dict"),
    (
        lambda: run(loads.wheel((0, 0, 1), 1, torque=[1], times=[0.5])),
        PolhodeError,
        "torque of a wheel is known from",
    ),
    (
        lambda: run(loads.wheel((0, 0, 1), 1, speed=[1, 2], times=[0, 0.5])),
        PolhodeError,
        "speed of a wheel is known",
    ),
    (
        lambda: run(loads.wheel((0, 0, 1), 1, dry_friction=1)).sensitivity(),
        PolhodeError,
        "no series from which derivatives come",
    ),
    (lambda: loads.slug(1, 1).torque(0, (0, 0, 0), (0, 0, 0, 1)), TypeError, "pass states= with"),
]


def run(load: loads.Load, **options: Any) -> Trajectory:
    return RigidBody.from_principal(1.0, (1.0, 2.0, 2.5)).simulate([0, 1], (0, 0, 1), load=load, **options)


@pytest.mark.parametrize(("call", "kind", "message"), REFUSED)
def test_what_is_refused(call: Callable[[], Any], kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        call()


# What is conserved: momentum at any scale and over long times, balance of energy.


@settings(max_examples=25, deadline=None)
@given(
    moments=st.tuples(*[st.floats(1.0, 1.9)] * 3),
    omega=st.tuples(*[st.floats(-3, 3)] * 3),
    axis=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda a: np.linalg.norm(a) > 0.1),
    numbers=st.tuples(
        st.floats(0.01, 0.9), st.floats(-50, 50), st.floats(0, 2), st.floats(0.01, 2), st.floats(0, 2)
    ),
    scale=st.sampled_from([1e-30, 1.0, 1e25]),
)
def test_momentum_is_kept_at_any_scale(
    moments: Any, omega: Any, axis: Any, numbers: Any, scale: float
) -> None:
    inertia, rate, friction, slug, damping = numbers
    body = RigidBody.from_principal(scale, np.multiply(moments, scale))
    load = loads.wheel(axis, inertia * scale, rate, friction=friction * scale) + loads.slug(
        slug * scale, damping * scale
    )
    run = body.simulate([0, 1, 5], omega, load=load, rtol=2.3e-15)
    spin = run.angular_momentum().spin / scale
    size = np.linalg.norm(spin[0]) + np.linalg.norm(omega) + abs(inertia * rate)
    assert np.abs(spin - spin[0]).max() <= 1e-13 * size
    energy = run.kinetic_energy().total / scale
    assert (np.diff(energy) <= 1e-12 * size**2).all()


@pytest.mark.parametrize(("rtol", "allowed"), [(1e-20, 1e-14), (2.3e-15, 2e-13)])
@pytest.mark.parametrize("name", ["slug", "driven"])
def test_momentum_over_ten_thousand_rotations(name: str, rtol: float, allowed: float) -> None:
    """In doubles its error grows as the root of the steps; beyond them nothing is lost."""
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    omega = np.array([0.3, 0.4, 1.1])
    end = 2e4 * np.pi / np.linalg.norm(omega)
    times = np.linspace(0, end, 1000, endpoint=False)
    all_loads = {
        "slug": loads.slug(0.1, 1e-3),
        "driven": loads.wheel((1, 2, 2), 0.1, 3.0, torque=np.tile([0.01, -0.01], 500), times=times),
    }
    run = body.simulate(np.array([0, end / 2, end]), omega, load=all_loads[name], method="taylor", rtol=rtol)
    spin = run.angular_momentum().spin
    assert np.linalg.norm(spin - spin[0], axis=1).max() <= allowed * np.linalg.norm(spin[0])


class TestEnergyBalance:
    """What the energy loses over ten thousand rotations is the work that bearings and motors do."""

    BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    OMEGA = np.array([0.3, 0.4, 1.1])
    END = 53000.0

    def error(self, load: loads.Load, power: Callable[[Trajectory], np.ndarray]) -> float:
        """Integrate the power by Gauss's formula, on pieces of one second."""
        x, weights = np.polynomial.legendre.leggauss(12)
        inside = (np.arange(self.END)[:, None] + 0.5 * (x + 1)).ravel()
        times = np.concatenate([[0.0], inside, [self.END]])
        run = self.BODY.simulate(times, self.OMEGA, load=load, method="taylor", rtol=1e-20)
        work = math.fsum(power(run)[1:-1].reshape(-1, 12) @ weights * 0.5)
        energy = run.kinetic_energy().total
        assert abs(work) > 1e-3 * energy[0]
        return float(abs(energy[-1] - energy[0] - work) / energy[0])

    def test_a_slug(self) -> None:
        def power(run: Trajectory) -> Any:
            return -1e-3 * ((run.states["slug"] - run.omega) ** 2).sum(1)

        assert self.error(loads.slug(0.1, 1e-3), power) <= 1e-15

    def test_a_motor_and_friction(self) -> None:
        times, torques = np.arange(1000) * 53.0, np.tile([0.01, -0.01], 500)

        def power(run: Trajectory) -> Any:
            speed = run.states["wheel"][:, 0] / 0.1 - run.omega @ (np.array([1, 2, 2]) / 3)
            motor = torques[np.searchsorted(times, run.t, side="right") - 1]
            return motor * speed - 1e-3 * speed**2

        wheel = loads.wheel((1, 2, 2), 0.1, 3.0, torque=torques, times=times, friction=1e-3)
        assert self.error(wheel, power) <= 1e-13

    @pytest.mark.parametrize(
        ("method", "rtol", "rotations"),
        [
            ("dop853", 1e-14, 30),
            ("radau", 1e-12, 10),
            pytest.param("dop853", 1e-14, 10_000, marks=pytest.mark.long),
        ],
    )
    @pytest.mark.parametrize("name", ["slug", "wheel"])
    def test_the_work_as_one_more_state_of_the_run(
        self, name: str, method: Any, rtol: float, rotations: int
    ) -> None:
        along = np.array([1, 2, 2]) / 3

        def power(_t: float, omega: Any, _q: Any, _r: Any, _v: Any, states: Any) -> float:
            if name == "slug":
                slip = states["slug"] - omega
                return -1e-3 * float(slip @ slip)
            speed = float(states["wheel"][0] / 0.1 - omega @ along)
            return (0.002 - 1e-3 * speed) * speed

        inside = {
            "slug": loads.slug(0.1, 1e-3),
            "wheel": loads.wheel((1, 2, 2), 0.1, 3.0, torque=0.002, friction=1e-3),
        }
        load = inside[name] + loads.with_states(power, [0.0], name="work", scale=1.0)
        end = rotations * 2 * np.pi / float(np.linalg.norm(self.OMEGA))
        run = self.BODY.simulate([0.0, end], self.OMEGA, load=load, method=method, rtol=rtol)
        energy, work = run.kinetic_energy().total, run.states["work"][-1, 0]
        assert abs(work) > 1e-3 * energy[0]
        assert abs(energy[-1] - energy[0] - work) <= 1e-13 * energy[0]


class TestOneWheel:
    """A wheel is a record, which a gyrostat takes, and a load."""

    AXIS = np.array([1.0, 2.0, 2.0]) / 3.0

    @pytest.mark.parametrize("mode", ["free", "held"])
    def test_it_serves_both_sides(self, mode: Any) -> None:
        wheel = polhode.wheel(axis=3.0 * self.AXIS, inertia=0.2, rate=5.0, mode=mode)
        given: dict[str, Any] = {"rate": 5.0} if mode == "free" else {"speed": 5.0}
        same = loads.wheel(3.0 * self.AXIS, 0.2, **given)
        assert wheel == same
        assert (same.mode, same.inertia, same.rate, same.momentum) == (mode, 0.2, 5.0, 1.0)
        times = [0.0, 2.0, 5.0]
        exact = BODY.gyrostat(wheels=[same]).free_motion(OMEGA).at(times)
        runs = [BODY.simulate(times, OMEGA, load=one, rtol=1e-14) for one in (wheel, same)]
        assert np.array_equal(runs[0].omega, runs[1].omega)
        np.testing.assert_allclose(runs[0].omega, exact.omega, atol=1e-12)

    def test_it_acts_in_sums_and_stacks(self) -> None:
        wheel = polhode.wheel(axis=(0, 0, 1), inertia=[0.2, 0.3], rate=5.0, name="z")
        assert isinstance(wheel, loads.Load)
        assert wheel.shape == (2,)
        assert wheel[1] == polhode.wheel(axis=(0, 0, 1), inertia=0.3, rate=5.0, name="z")
        total: Any = sum([wheel, loads.constant_torque((0.1, 0, 0)), wheel])
        run = BODY.simulate([0, 1], OMEGA, load=total)
        assert list(run.states) == ["z", "z_2"]
        assert run.torque().shape == (2, 2, 3)
        one = BODY.simulate([0, 1], OMEGA, load=wheel[1] + loads.constant_torque((0.1, 0, 0)) + wheel[1])
        assert np.array_equal(run.omega[1], one.omega)
        held = polhode.wheel(axis=(0, 0, 1), inertia=0.1, rate=[1.0, 2.0], mode="held")
        again = pickle.loads(pickle.dumps(held))
        runs = [BODY.simulate([0, 1], OMEGA, load=wheel).omega for wheel in (held, again)]
        assert np.array_equal(runs[0], runs[1])
        other = polhode.wheel(axis=(0, 0, 1), inertia=0.1, rate=2.0, mode="held")
        assert np.array_equal(runs[0][1], BODY.simulate([0, 1], OMEGA, load=other).omega)

    def test_rows_of_a_stack_have_their_own_numbers(self) -> None:
        control = loads.feedback([1.0 * np.eye(3), 2.0 * np.eye(3)], 0.5)
        stack = loads.wheel(
            (0, 0, 1), 0.1, [1.0, 2.0], friction=[[0.1], [0.2]], torque=control, max_torque=0.3
        )
        assert stack.shape == (2, 2)
        for one in (stack[1, 0], pickle.loads(pickle.dumps(stack[1, 0])), stack[1][0]):
            assert (one.shape, one.rate, one.momentum, one.friction, one.max_torque) == (
                (),
                1.0,
                0.1,
                0.2,
                0.3,
            )
            assert one.motor.shape == ()
            assert one.motor.potential(BODY, ATTITUDE) == control[0].potential(BODY, ATTITUDE)
        table = loads.wheel((0, 0, 1), [0.1, 0.2], torque=[0.1, 0.2, 0.3], times=[0, 1, 2])[1]
        assert (table.inertia, table.times.tolist(), table.motor.tolist()) == (
            0.2,
            [0, 1, 2],
            [0.1, 0.2, 0.3],
        )

    def test_without_moment_it_is_a_rotor(self) -> None:
        wheel = polhode.wheel(axis=(0, 3, 4), inertia=0.0, momentum=0.5)
        run = BODY.simulate([0, 1], OMEGA, load=wheel)
        assert np.array_equal(run.omega, BODY.simulate([0, 1], OMEGA, load=loads.rotor((0, 0.3, 0.4))).omega)
        assert np.isnan(wheel.rate)
        with pytest.raises(ValueError, match="1 of the 2 wheels of a stack have no moment"):
            polhode.wheel(axis=(0, 0, 1), inertia=[0.0, 0.1], momentum=1.0)

    @pytest.mark.parametrize(
        "wheel",
        [
            polhode.wheel(axis=(0, 0, 1), inertia=0.1, momentum=0.7),
            polhode.wheel(axis=(0, 0, 1), inertia=[0.1, 0.3], rate=7.0, name="fast"),
            polhode.wheel(axis=(0, 0, 1), inertia=0.0, momentum=0.7, mode="held"),
        ],
        ids=repr,
    )
    def test_copies_are_equal(self, wheel: polhode.Wheel) -> None:
        again = pickle.loads(pickle.dumps(wheel))
        assert again == wheel == copy.deepcopy(wheel)
        assert hash(again) == hash(wheel)
        assert repr(again) == repr(wheel)
        assert again.name == wheel.name
        run, other = (BODY.simulate([0, 1], OMEGA, load=one) for one in (wheel, again))
        assert np.array_equal(run.omega, other.omega)
        assert list(run.states) == list(other.states)

    def test_a_wheel_with_a_motor_survives_pickle(self) -> None:
        wheel = loads.wheel((0, 0, 1), 0.1, 2.0, torque=[0.1, 0.2], times=[0, 1], friction=0.01, name="m")
        again = pickle.loads(pickle.dumps(wheel))
        assert (again.mode, again.name, again.friction) == ("driven", "m", 0.01)
        assert again.motor.tolist() == [0.1, 0.2]
        again.motor[0] = 9.0  # a copy
        assert again.motor.tolist() == [0.1, 0.2]
        assert (wheel == wheel, again == wheel) == (True, False)
        with pytest.raises(ValueError, match=r"wheels\[0\]: it has a motor \(torque=\)"):
            BODY.gyrostat(wheels=[again])

    @pytest.mark.parametrize(
        ("options", "words"),
        [
            ({"torque": 0.1}, r"a motor \(torque=\)"),
            ({"torque": loads.feedback(1.0, 1.0), "max_torque": 0.1}, r"a motor \(torque=\)"),
            ({"friction": 0.1}, r"friction in its bearing \(friction=\)"),
            ({"dry_friction": 0.1}, r"friction in its bearing \(dry_friction=\)"),
            ({"speed": [1.0, 2.0], "times": [0.0, 1.0]}, r"a speed that changes \(times=\)"),
        ],
    )
    def test_what_a_closed_form_does_not_know(self, options: Any, words: str) -> None:
        wheel = loads.wheel((0, 0, 1), 0.1, **options)
        assert wheel.mode == "driven"
        way_out = r"body\.simulate\(t, omega, load=wheel\)"
        with pytest.raises(ValueError, match=rf"wheels\[1\]: it has {words}.*{way_out}"):
            BODY.gyrostat(wheels=[polhode.wheel(axis=(0, 0, 1), inertia=0.1, rate=1.0), wheel])

    @pytest.mark.parametrize("inertia", [0.1, 0.0])
    def test_no_factor(self, inertia: float) -> None:
        wheel = polhode.wheel(axis=(0, 0, 1), inertia=inertia, momentum=0.1)
        scaled: list[Callable[[], loads.Load]] = [lambda: 2 * wheel, lambda: wheel * 0.5, lambda: -wheel]
        for one in scaled:
            with pytest.raises(PolhodeError, match="cannot be scaled"):
                one()
