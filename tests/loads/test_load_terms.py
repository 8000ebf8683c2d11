"""Every analytic load, against its formula in NumPy, and its motions against closed forms and SciPy."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.bodies import matrix
from polhode import RigidBody, loads, orbits, solids
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

Floats = NDArray[np.float64]

BODY = RigidBody(
    2.0, np.array([[3.0, 0.2, -0.1], [0.2, 2.0, 0.3], [-0.1, 0.3, 4.0]]), center_of_mass=(0.3, -0.1, 0.5)
)
Q = np.array([0.1, -0.5, 0.3, 0.8]) / np.sqrt(0.99)
W = np.array([0.5, -1.0, 0.25])
G = np.array([0.2, 0.1, -9.81])
TURN = matrix(Q)


def close(got: Any, want: Any, size: float = 1.0) -> bool:
    return bool(np.abs(np.asarray(got) - want).max() <= 4e-15 * size)


class TestFormulas:
    def test_weight(self) -> None:
        load = loads.uniform_gravity(G)
        assert not load.torque(0.0, W, Q, body=BODY).any()
        assert close(load.force(0.0, W, Q, body=BODY), 2.0 * G, 20.0)
        arm = np.array([0.3, -0.1, 0.5])
        want = np.cross(arm, TURN.T @ (2.0 * G))
        assert close(load.torque(0.0, W, Q, body=BODY, about="origin"), want, 20.0)

    @pytest.mark.parametrize("about", ["center_of_mass", "origin"])
    @pytest.mark.parametrize("frame", ["body", "space"])
    def test_force_at_a_point(self, frame: Any, about: Any) -> None:
        force, point = np.array([1.0, -2.0, 0.5]), np.array([0.4, 0.0, -1.0])
        load = loads.constant_force(force, frame, point)
        in_body = force if frame == "body" else TURN.T @ force
        reference = BODY.center_of_mass if about == "center_of_mass" else np.zeros(3)
        got = load.torque(0.0, W, Q, body=BODY, about=about)
        assert close(got, np.cross(point - reference, in_body), 4.0)
        assert close(load.force(0.0, W, Q, body=BODY, about=about), TURN @ in_body, 4.0)
        at_center = loads.constant_force(force, frame).torque(0.0, W, Q, body=BODY, about=about)
        assert close(at_center, np.cross(BODY.center_of_mass - reference, in_body), 4.0)

    def test_damping(self, rng: np.random.Generator) -> None:
        linear, quadratic = rng.normal(size=(2, 3, 3))
        want = -linear @ W - quadratic @ W * np.linalg.norm(W)
        assert close(loads.damping(linear, quadratic).torque(0.0, W, Q), want, 8.0)
        assert close(loads.damping(0.5).torque(0.0, W, Q), -0.5 * W)

    def test_feedback(self, rng: np.random.Generator) -> None:
        gains, rates = rng.normal(size=(2, 3, 3))
        target = np.array([0.5, -0.5, 0.5, 0.5])
        relative = matrix(target).T @ TURN
        # of the quaternion with w >= 0
        w = np.sqrt(1 + np.trace(relative)) / 2
        vector = np.array([relative[2, 1] - relative[1, 2], relative[0, 2] - relative[2, 0]])
        vector = np.array([*vector, relative[1, 0] - relative[0, 1]]) / (4 * w)
        want = -gains @ vector - rates @ W
        for sign in (1, -1):
            assert close(loads.feedback(gains, rates, target).torque(0.0, W, sign * Q), want, 20.0)

    @pytest.mark.parametrize("frame", ["body", "space"])
    @pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
    def test_samples_are_scipys_spline(self, count: int, frame: Any, rng: np.random.Generator) -> None:
        t = np.cumsum(rng.uniform(0.1, 2.0, count))
        values = rng.normal(size=(count, 3))
        load = loads.sampled(t, values, frame)
        times = np.linspace(t[0], t[-1], 101)
        want = CubicSpline(t, values)(times)
        if frame == "space":
            want = want @ TURN
        assert np.abs(load.torque(times, W, Q) - want).max() < 1e-12 * np.abs(want).max()

    @pytest.mark.parametrize(
        ("position", "velocity"),
        [
            ((1.0, 0.2, -0.3), (0.1, 0.9, 0.3)),
            ((0.5, 0.0, 0.0), (0.0, 1.7, 0.1)),
            ((1.0, 0.2, 0.5), (-1.0, 1.5, 2.0)),
        ],
        ids=["ellipse", "eccentric", "hyperbola"],
    )
    def test_gravity_gradient_on_its_orbit(self, position: Any, velocity: Any) -> None:
        """The orbit by Kepler's equation in 40 digits."""
        load = loads.gravity_gradient(1.0, position, velocity, epoch=2.0)
        r = _kepler(position, velocity, 7.5)
        body = TURN.T @ r
        want = 3 / np.linalg.norm(r) ** 5 * np.cross(body, BODY.inertia @ body)
        assert close(load.torque(9.5, W, Q, body=BODY), want, 100.0 * np.abs(want).max())

    def test_orbits_begin_with_the_motion(self) -> None:
        load = loads.gravity_gradient(1.0, (1.0, 0.0, 0.0), (0.0, 1.1, 0.0))
        one = BODY.simulate([0.0, 5.0], W, load=load)
        two = BODY.simulate([10.0, 15.0], W, load=load)
        assert np.abs(one.omega - two.omega).max() < 1e-12
        assert one.load is not None
        with_epoch = load.with_epoch(0.0).torque(3.0, W, Q, body=BODY)
        assert np.array_equal(with_epoch, one.load.torque(3.0, W, Q, body=BODY, start=0.0))
        rest = one.resume([5.0, 9.0], rtol=1e-12)
        whole = BODY.simulate([0.0, 9.0], W, load=load, rtol=1e-12)
        assert np.abs(rest.omega[-1] - whole.omega[-1]).max() < 1e-8


def _kepler(position: Any, velocity: Any, t: float) -> Floats:
    """The place after `t` for mu = 1, by Kepler's equation from the perihelion, in 40 digits."""
    with mpmath.workdps(40):
        r, v = mpmath.matrix(position), mpmath.matrix(velocity)

        def dot(a: Any, b: Any) -> Any:
            return mpmath.fsum(x * y for x, y in zip(a, b, strict=True))

        distance = mpmath.sqrt(dot(r, r))
        axis = 1 / (2 / distance - dot(v, v))
        sigma = dot(r, v)
        if axis > 0:
            cosine, sine = 1 - distance / axis, sigma / mpmath.sqrt(axis)
            n = axis ** mpmath.mpf(-1.5)
            turned = mpmath.findroot(
                lambda x: x - cosine * mpmath.sin(x) + sine * (1 - mpmath.cos(x)) - n * t, n * t
            )
            f = 1 - axis / distance * (1 - mpmath.cos(turned))
            g = t + (mpmath.sin(turned) - turned) / n
        else:
            a = -axis
            n = a ** mpmath.mpf(-1.5)
            cosine, sine = 1 + distance / a, sigma / mpmath.sqrt(a)
            turned = mpmath.findroot(
                lambda x: cosine * mpmath.sinh(x) + sine * (mpmath.cosh(x) - 1) - x - n * t,
                mpmath.asinh(n * t),
            )
            f = 1 - a / distance * (mpmath.cosh(turned) - 1)
            g = t - (mpmath.sinh(turned) - turned) / n
        place = f * r + g * v
        return np.array([float(x) for x in place])


class TestMotions:
    def test_a_thrown_body_falls_and_turns_freely(self) -> None:
        t = np.linspace(0, 3, 7)
        thrown = BODY.simulate(t, W, Q, load=loads.uniform_gravity(G), position=(1, 2, 3), velocity=(5, 0, 2))
        free = BODY.simulate(t, W, Q)
        want = np.array([1, 2, 3]) + t[:, None] * [5, 0, 2] + t[:, None] ** 2 / 2 * G
        assert np.abs(thrown.position - want).max() < 1e-13 * np.abs(want).max()
        assert np.abs(thrown.velocity - ([5, 0, 2] + t[:, None] * G)).max() < 1e-13
        assert np.abs(thrown.omega - free.omega).max() < 1e-8
        assert thrown.invariants().energy_drift < 1e-9

    def test_a_pendulum_swings_with_its_elliptic_period(self) -> None:
        bob = solids.sphere(0.2, mass=1.5).translated((0, 0, -0.8))
        amplitude, moment = 2.0, 1.5 * (0.4 * 0.2**2 + 0.8**2)
        rate = np.sqrt(1.5 * 9.81 * 0.8 / moment)
        period = 4 / rate * float(mpmath.ellipk(np.sin(amplitude / 2) ** 2))
        start = (np.sin(amplitude / 2), 0.0, 0.0, np.cos(amplitude / 2))
        swing = bob.simulate(
            [0, period / 2, period],
            (0, 0, 0),
            start,
            load=loads.uniform_gravity((0, 0, -9.81)),
            about="origin",
            rtol=1e-13,
        )
        want = [[1, 0, 0, 1], [-1, 0, 0, 1], [1, 0, 0, 1]] * np.array(start)
        assert np.abs(swing.quaternion - want).max() < 1e-11
        assert swing.invariants().energy_drift < 1e-12
        kept = swing.resume(period + np.linspace(0, period, 9), rtol=1e-13).invariants()
        assert kept.angular_momentum_drift < 1e-12
        assert kept.angular_momentum is not None
        assert kept.angular_momentum.shape == (9,)
        assert not swing.position.any()

    def test_six_degrees_of_freedom_as_scipy_has_them(self) -> None:
        """A thruster off the axis, wind, weight and damping on a free body."""
        force, point, wind = np.array([0.0, 0.3, 2.0]), np.array([0.4, 0.0, -1.0]), np.array([1.0, 0.0, 0.5])
        load = loads.constant_force(force, "body", point) + loads.constant_force(wind, "space")
        load += loads.uniform_gravity(G) + loads.damping(0.2)

        def slope(_t: float, y: Floats) -> Floats:
            q, w = y[:4] / np.linalg.norm(y[:4]), y[4:7]
            turn = matrix(q)
            torque = np.cross(point - BODY.center_of_mass, force) - 0.2 * w
            turning = np.linalg.solve(BODY.inertia, torque - np.cross(w, BODY.inertia @ w))
            x, z = q[:3], q[3]
            rate = 0.5 * np.array([*(z * w + np.cross(x, w)), -x @ w])
            return np.concatenate([rate, turning, y[10:], (turn @ force + wind) / 2.0 + G])

        start = np.concatenate([Q, W, [1, 2, 3], [-1, 0, 1]])
        t = np.linspace(0, 6, 13)
        want = solve_ivp(slope, (0, 6), start, "DOP853", t, rtol=1e-13, atol=1e-13).y.T
        got = BODY.simulate(t, W, Q, load=load, position=(1, 2, 3), velocity=(-1, 0, 1), rtol=1e-13)
        assert np.abs(got.omega - want[:, 4:7]).max() < 1e-10
        assert np.abs(got.position - want[:, 7:10]).max() < 1e-9
        assert np.abs(got.velocity - want[:, 10:]).max() < 1e-10
        force_then = got.force()
        assert np.abs(force_then - 2 * np.array([slope(0, y)[10:] for y in want])).max() < 1e-9

    def test_a_force_callback_moves_the_body(self) -> None:
        def spring(_t: float, omega: Any, _q: Any, position: Any, velocity: Any) -> Any:
            assert position.shape == velocity.shape == (3,)
            return -2.0 * position, -0.1 * omega

        t = np.linspace(0, 10, 21)
        got = BODY.simulate(
            t, W, load=loads.callback(spring), position=(1, 0, 0), velocity=(0, 2, 0), rtol=1e-13
        )
        assert np.abs(got.position - np.column_stack([np.cos(t), 2 * np.sin(t), 0 * t])).max() < 1e-11
        damped = BODY.simulate(t, W, load=loads.damping(0.1), rtol=1e-13)
        assert np.abs(got.omega - damped.omega).max() < 1e-11

    def test_steps_land_on_switches(self) -> None:
        ball = RigidBody(1.0, np.eye(3))
        windows = [(0.5, 1.25), (2.0, np.pi), (9.0, 10.0)]
        load = loads.schedule(loads.constant_torque((0, 0, 3.0)), windows)
        t = np.linspace(0, 4, 33)
        got = ball.simulate(t, (0, 0, 0), load=load, method="dop853")
        on = np.clip(t, 0.5, 1.25) - 0.5 + np.clip(t, 2.0, np.pi) - 2.0
        assert np.abs(got.omega[:, 2] - 3 * on).max() < 1e-14
        assert int(got.steps) < 40
        called = loads.schedule(loads.torque_callback(lambda _t, _w, _q: (0.0, 0.0, 3.0)), windows)
        assert np.array_equal(ball.simulate(t, (0, 0, 0), load=called).omega, got.omega)
        series = ball.simulate(t, (0, 0, 0), load=load, method="taylor")
        assert np.abs(series.omega - got.omega).max() < 1e-14
        back = ball.simulate(t[::-1], got.omega[-1], got.quaternion[-1], load=load)
        assert np.abs(back.omega[::-1] - got.omega).max() < 1e-14

    def test_a_sampled_torque_is_integrated_piece_by_piece(self, rng: np.random.Generator) -> None:
        t = np.linspace(0, 5, 11)
        values = rng.normal(size=(11, 3))
        ball = RigidBody(1.0, np.eye(3))
        got = ball.simulate([0, 5], (0, 0, 0), load=loads.sampled(t, values), rtol=1e-12)
        want = CubicSpline(t, values).antiderivative()
        # the body of equal moments has no gyroscopic torque, so ω is the integral
        assert np.abs(got.omega[-1] - (want(5.0) - want(0.0))).max() < 1e-13
        with pytest.raises(ValueError, match=r"known from t = 0.0 to t = 5.0, and needed at t = 6.0"):
            ball.simulate([0, 6], (0, 0, 0), load=loads.sampled(t, values))
        within = loads.schedule(loads.sampled(t, values), [(1.0, 2.0)])
        assert ball.simulate([0, 6], (0, 0, 0), load=within).status == "complete"

    def test_a_controller_reaches_its_target(self) -> None:
        target = (0.5, 0.5, 0.5, 0.5)
        got = BODY.simulate([0, 60], W, Q, load=loads.feedback(6.0, 5.0, target))
        assert np.abs(np.abs(got.quaternion[-1]) - 0.5).max() < 1e-6
        assert np.abs(got.omega[-1]).max() < 1e-6
        spring = BODY.simulate(
            np.linspace(0, 20, 50), 0.1 * W, Q, load=loads.feedback(6.0, 0.0, target), rtol=1e-12
        )
        assert spring.invariants().energy_drift < 1e-9

    def test_a_gravity_gradient_needs_a_free_body(self) -> None:
        load = loads.gravity_gradient(1.0, (1, 0, 0), (0, 1, 0))
        with pytest.raises(ValueError, match="whose centre of mass is free"):
            BODY.simulate([0, 1], W, load=load, about="origin")


LOADS = {
    "constant_torque": loads.constant_torque((1.0, 2.0, 3.0), "space"),
    "constant_force": loads.constant_force((1.0, 2.0, 3.0), "body", (0.1, 0.2, 0.3)),
    "uniform_gravity": loads.uniform_gravity(G),
    "gravity_gradient": loads.gravity_gradient(1.0, (1, 0, 0.2), (0, 1, 0.1)),
    "damping": loads.damping(np.diag([1.0, 2.0, 3.0]), 0.2),
    "sampled": loads.sampled([0.0, 1.0, 3.0, 4.0], np.arange(12.0).reshape(4, 3) ** 1.5),
    "feedback": loads.feedback(2.0, 0.3, (0.0, 0.6, 0.0, 0.8)),
    "magnetic": loads.magnetic((1.0, 2.0, 3.0), (0.1, 0.2, -0.3)),
    "magnetic on an orbit": loads.magnetic(
        (1.0, 2.0, 3.0), orbits.kepler(1.0, (1, 0, 0.2), (0, 1, 0.1)).dipole_field((0, 0.1, 1.0)), gain=0.2
    ),
    "magnetic at times": loads.magnetic(
        (1.0, 2.0, 3.0), np.arange(12.0).reshape(4, 3) ** 1.5, times=[0.0, 1.0, 3.0, 4.0]
    ),
    "panels": loads.panels(
        ([(1.0, 2.0, 3.0)], [2.0], [(0.1, 0.2, 1.0)]),
        coefficients=(0.2, 0.3),
        direction=(0.1, 0.2, 0.5),
        pressure=0.1,
    ),
    "scheduled": loads.schedule(
        loads.damping(1.0) + loads.constant_torque((1, 0, 0)), [(0.0, 1.0), (2.0, 3.0)]
    ),
}


class TestAlgebra:
    @pytest.mark.parametrize("name", LOADS)
    def test_scaling_sums_and_differences(self, name: str) -> None:
        load = LOADS[name]
        other = loads.constant_torque((0.1, 0.2, 0.3))

        def of(load: loads.Load) -> Floats:
            arguments = (0.5, W, Q)
            return np.concatenate([load.torque(*arguments, body=BODY), load.force(*arguments, body=BODY)])

        assert close(of(2.5 * load), 2.5 * of(load), 100.0)
        assert close(of(load * 2), 2 * of(load), 100.0)
        assert close(of(-load), -of(load), 100.0)
        assert close(of(load - other), of(load) - of(other), 100.0)
        total: Any = sum([load, other, load])
        assert close(of(total), 2 * of(load) + of(other), 100.0)

    @pytest.mark.parametrize("name", LOADS)
    def test_pickles_and_copies(self, name: str) -> None:
        load = 2.0 * LOADS[name] + loads.schedule(-LOADS[name], [(0.0, 0.7)])
        for again in (pickle.loads(pickle.dumps(load)), copy.copy(load), copy.deepcopy(load)):
            assert repr(again) == repr(load)
            for t in (0.5, 0.9):
                want = load.torque(t, W, Q, body=BODY)
                assert np.array_equal(again.torque(t, W, Q, body=BODY), want)

    def test_stacks_of_loads(self, rng: np.random.Generator) -> None:
        torques = rng.normal(size=(4, 3))
        load = (
            loads.constant_torque(torques) + loads.damping(0.1) + loads.uniform_gravity(np.zeros((2, 1, 3)))
        )
        assert load.shape == (2, 4)
        motion = BODY.simulate([0.0, 1.0, 2.0], W, load=load)
        assert motion.omega.shape == (2, 4, 3, 3)
        for k in range(4):
            alone = BODY.simulate(
                [0.0, 1.0, 2.0],
                W,
                load=loads.constant_torque(torques[k])
                + loads.damping(0.1)
                + loads.uniform_gravity((0, 0, 0)),
            )
            assert np.array_equal(motion.omega[1, k], alone.omega)
        assert np.array_equal(
            load[1, 2].torque(0.0, W, Q, body=BODY), load.torque(0.0, W, Q, body=BODY)[1, 2]
        )
        again = pickle.loads(pickle.dumps(load[..., 1:]))
        assert again.shape == (2, 3)
        assert motion.torque().shape == (2, 4, 3, 3)
        with pytest.raises(ValueError, match="broadcast"):
            load + loads.constant_torque(np.zeros((3, 3)))

    def test_nonsense_is_named(self) -> None:
        load = LOADS["damping"]
        for wrong in ("2", None, (1.0, 2.0)):
            with pytest.raises(TypeError):
                load * wrong  # type: ignore[operator]
        with pytest.raises(TypeError):
            1 + load
        with pytest.raises(ValueError, match="factor"):
            np.nan * load
        with pytest.raises(TypeError, match="body"):
            LOADS["uniform_gravity"].torque(0.0, W, Q)

    @pytest.mark.parametrize(
        ("make", "word"),
        [
            (lambda: loads.gravity_gradient(0.0, (1, 0, 0), (0, 1, 0)), "mu must be more than zero"),
            (lambda: loads.gravity_gradient(1.0, (0, 0, 0), (0, 1, 0)), "distance from the attractor"),
            (lambda: loads.gravity_gradient(1.0, (1, 0, 0), (1, 0, 0)), "radial orbit"),
            (lambda: loads.gravity_gradient(1.0, (1, 0, 0), (0, 1, 0), epoch=np.nan), "epoch must be finite"),
            (lambda: loads.damping(np.nan), "matrix must be finite"),
            (lambda: loads.damping((1.0, 2.0, 3.0)), "matrix: expected shape"),
            (lambda: loads.feedback(1.0, 1.0, (0, 0, 0, 2)), "target must be a unit quaternion"),
            (lambda: loads.sampled([0.0], np.zeros((1, 3))), "at least 2"),
            (lambda: loads.sampled([0.0, 0.0], np.zeros((2, 3))), "t must be strictly ascending"),
            (lambda: loads.sampled([0.0, 1.0, 2.0], np.zeros((2, 3))), "one for each of the 3 times, got 2"),
            (lambda: loads.schedule(LOADS["damping"], [(1.0, 0.0)]), "window 0 is from 1.0 to 0.0"),
            (lambda: loads.schedule(LOADS["damping"], [(0.0, 2.0), (1.0, 3.0)]), "ends at 2.0"),
            (lambda: loads.schedule(LOADS["damping"], (0.0, 2.0)), "windows: expected shape"),
            (lambda: loads.constant_force((np.inf, 0, 0)), "vector must be finite"),
            (lambda: loads.uniform_gravity((0, 0)), "gravity: expected shape"),
        ],
    )
    def test_bad_arguments(self, make: Any, word: str) -> None:
        with pytest.raises(ValueError, match=word):
            make()


# Torques and rates of any size: bodies at rest or hardly rotating.


@pytest.mark.parametrize("frame", ["body", "space"])
@pytest.mark.parametrize("size", [1e230, 1e40, 1e-10, 1e-20, 1e-40, 1e-80, 1e-160, 1e-300])
def test_a_sampled_torque_of_any_size_on_a_body_at_rest(size: float, frame: Any) -> None:
    """Seconds between the samples, zero at one sample, at all but one, or nowhere."""
    t = np.array([0.0, 1.0, 3.0, 6.0])
    # So heavy that it does not turn far.
    moments = np.array([1.0, 1.4, 1.9]) * max(1.0, 1e12 * size)
    body = RigidBody.from_principal(1.0, moments)
    for rows in (*np.eye(4), 1 - np.eye(4)[1], np.ones(4)):
        values = size * np.outer(rows, (1.0, -2.0, 0.5))
        want = CubicSpline(t, values).antiderivative()
        for times in (t, t[::-1]):
            exact = (want(times) - want(times[0])) / moments
            got = body.simulate(times, (0, 0, 0), load=loads.sampled(t, values, frame))
            assert np.abs(got.omega - exact).max() < 1e-10 * np.abs(exact).max()


@pytest.mark.parametrize("moment", [1e-40, 1.0, 1e30])
@pytest.mark.parametrize("begins", [0.0, 1e-300, 1e-40, 1e-16, 1e-12, 1e-9, 1e-7, 1e-5, 1e-2, -1e-9, -1e-40])
def test_quadratic_damping_from_hardly_any_rotation(begins: float, moment: float) -> None:
    """I ω̇ = N − s ω|ω|: from ω₀ on ω is √(N/s) tanh; a tiny ω₀ < 0 is as good as zero."""
    torque, quadratic = 2.0 * moment, 0.5 * moment
    body = RigidBody.from_principal(1.0, moment * np.array([1.0, 1.0, 1.5]))
    load = loads.constant_torque((0, 0, torque)) + loads.damping(0.0, quadratic=quadratic)
    times = np.array([0.0, 1e-3, 1.0, 3.0])
    got = body.simulate(times, (0, 0, begins), load=load, method="taylor", rtol=1e-13)
    end, rate = np.sqrt(torque / quadratic), np.sqrt(torque * quadratic) / (1.5 * moment)
    exact = end * np.tanh(rate * times + np.arctanh(begins / end))
    assert np.abs(got.omega[1:, 2] / exact[1:] - 1).max() < 1e-12


@pytest.mark.parametrize("amplitude", [1e-20, 1e-13, 1e-9])
def test_quadratic_damping_of_tiny_oscillations(amplitude: float) -> None:
    """φ̈ = −φ − s φ̇|φ̇|: with s times the amplitude the same, so is the motion over its amplitude."""
    body, times = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0)), np.linspace(0.0, 30.0, 40)

    def run(size: float) -> np.ndarray:
        load = loads.feedback(2.0, 0.0) + loads.damping(0.0, quadratic=0.3 / size)
        return body.simulate(times, (0, 0, size), load=load, method="taylor", rtol=1e-13).omega[:, 2] / size

    assert np.abs(run(1e-6)).max(where=times > 20, initial=0.0) < 0.3
    assert np.abs(run(amplitude) - run(1e-6)).max() < 1e-10
