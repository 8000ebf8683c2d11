"""The exact motion of heavy symmetric tops against series in high precision; laws, scales, stacks, errors."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any, NamedTuple

import numpy as np
import polhode
import pytest
from mpmath import mp, mpf
from oracles.heavy_top import HeavyTop as Series
from oracles.motion_cases import MotionCase, angle, load_table, relative_error
from oracles.rotation import conjugate, turned
from oracles.rotation import times as composed
from polhode import RigidBody, euler_angles, loads, solids, tops
from polhode._core import rotate
from polhode.errors import PolhodeError

G = (0.0, 0.0, -9.81)


class Case(NamedTuple):
    """A top on the third axis: moments about C, distance of C from the pivot, and the state."""

    moments: tuple[float, float]
    length: float
    omega: tuple[float, float, float]
    theta: float
    gravity: float = 9.81
    recurs: bool = True

    @property
    def body(self) -> RigidBody:
        across, along = self.moments
        return RigidBody.from_principal(1.0, (across, across, along), center_of_mass=(0, 0, self.length))

    @property
    def attitude(self) -> np.ndarray:
        """Exactly vertical where theta is 0 or π."""
        if self.theta in {0.0, math.pi}:
            return np.array([0.0, 0.0, 0.0, 1.0] if self.theta == 0.0 else [1.0, 0.0, 0.0, 0.0])
        return euler_angles.to_quaternion((0.1, self.theta, 0.4))

    @property
    def rate(self) -> float:
        """The faster of |ω| and the pendulum's rate."""
        inertia = self.moments[0] + self.length**2
        return max(math.hypot(*self.omega), math.sqrt(self.gravity * self.length / inertia))


SPIN, SLOW = (0.3, 0.5), (0.3, 0.05)
CASES = {
    "cusp": Case(SPIN, 0.7, (0.0, 0.0, 20.0), 0.6),
    "loop": Case(SPIN, 0.7, (1.5, -2.0, 20.0), 0.6),
    "wave": Case(SPIN, 0.7, (1.0, 2.0, -2.0), 2.6),
    "fast": Case(SPIN, 0.7, (1.0, 2.0, 3000.0), 1.0),
    "slow spin": Case(SLOW, 0.7, (0.1, 0.3, 3.0), 0.2),
    "sleeping, stable": Case(SPIN, 0.7, (1e-6, 0.0, 30.0), 1e-5),
    "sleeping, at the limit": Case((1.0, 1.0), 1.0, (0.0, 1e-3, 4.0), 1e-3, gravity=2.0),
    "sleeping, unstable": Case(SPIN, 0.7, (0.0, 0.0, 6.0), 1e-5),
    "sleeping, unstable, moved": Case(SPIN, 0.7, (1e-4, 0.0, 6.0), 0.0),
    "through the upper vertical": Case(SPIN, 0.7, (3.0, 1.0, 5.0), 0.0),
    "through the lower vertical": Case(SPIN, 0.7, (3.0, 1.0, 5.0), math.pi),
    "spherical pendulum": Case((0.0, 0.0), 0.7, (1.0, 2.0, 0.0), 2.0),
    "plane pendulum": Case((0.0, 0.0), 0.7, (1.0, 0.0, 0.0), math.pi),
    "plane pendulum, turning over": Case((0.0, 0.0), 0.7, (12.0, 0.0, 0.0), math.pi),
    "plane pendulum, near the separatrix": Case((0.0, 0.0), 1.0, (2 - 1e-9, 0.0, 0.0), math.pi, gravity=1.0),
    "rod": Case((0.4, 0.0), 0.7, (2.0, 1.0, 3.0), 2.0),
    "without weight": Case(SPIN, 0.0, (1.0, 2.0, 3.0), 1.0),
    "separatrix, pendulum": Case((0.0, 0.0), 1.0, (2.0, 0.0, 0.0), math.pi, gravity=1.0, recurs=False),
}


def errors(case: Case, times: list[float]) -> tuple[float, float]:
    """The largest error of the attitude in radians, and of ω relative to the case's rate."""
    across, along = case.moments
    oracle = Series(
        along,
        across,
        case.length,
        case.omega,
        case.attitude,
        case.gravity,
        about_center=(1.0, case.length),
        digits=32,
    )
    if case.recurs:
        oracle.find_period()
    motion = case.body.heavy_top(case.omega, case.attitude, (0, 0, -case.gravity)).at(times)
    angle = rate = mpf(0)
    for k, t in enumerate(times):
        omega, quaternion = oracle.at(t)
        with mp.workdps(40):
            chords = [
                mp.norm([mpf(a) - sign * b for a, b in zip(motion.quaternion[k], quaternion, strict=True)])
                for sign in (1, -1)
            ]
            angle = max(angle, 2 * min(chords))
            wrong = mp.norm([mpf(a) - b for a, b in zip(motion.omega[k], omega, strict=True)])
            rate = max(rate, wrong / mpf(case.rate))
    return float(angle), float(rate)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.long, pytest.mark.timeout(900)])
        if name.startswith(("sleeping, at the limit", "sleeping, unstable"))  # long periods: 10 s and 60 s
        else name
        for name in CASES
    ],
)
def test_it_is_the_motion_to_the_last_digits(name: str) -> None:
    """At 1, 10, 1e3 and 1e6 rotations; on a separatrix as long as it moves."""
    case = CASES[name]
    turns = [1.0, 10.0, 1e3, 1e6] if case.recurs else [0.5, -1.0, 3.0]
    angle, rate = errors(case, [2 * math.pi / case.rate * n for n in turns])
    assert angle < 1e-14
    assert rate < 1e-14


def test_an_axis_that_is_tilted_in_the_body() -> None:
    """Along (1, −4, 8)/9, tensor and centre exact in doubles: a million rotations on as after one."""
    tilt = np.array([1.0, -4.0, 8.0])
    across, difference, length, gravity = 1.25, -0.6328125, 0.5625, 9.75
    body = RigidBody(1.0, across * np.eye(3) + difference / 81 * np.outer(tilt, tilt), tilt / 16)
    omega, attitude = (1.5, -2.0, 6.0), np.array([2.0, -4.0, 1.0, 8.0]) / math.sqrt(85.0)
    rate = math.hypot(*omega)
    times = [2 * math.pi / rate * n for n in (1.0, 10.0, 1e3, 1e6)]
    motion = body.heavy_top(omega, attitude, (0, 0, -gravity)).at(times)
    with mp.workdps(60):
        # The shortest turn from the axis to the third one: about (−4, −1, 0), 1 + 8/9 for the cosine.
        turn = [mpf(-4) / 9, mpf(-1) / 9, mpf(0), mpf(17) / 9]
        turn = [x / mp.norm(turn) for x in turn]
        oracle = Series(
            across + difference,
            across,
            length,
            turned(turn, [mpf(x) for x in omega]),
            composed([mpf(x) for x in attitude], conjugate(turn)),
            gravity,
            about_center=(1.0, length),
        )
        oracle.find_period()
        for k, t in enumerate(times):
            rates, quaternion = oracle.at(t)
            rates, quaternion = turned(conjugate(turn), rates), composed(quaternion, turn)
            chords = [
                mp.norm([mpf(a) - sign * b for a, b in zip(motion.quaternion[k], quaternion, strict=True)])
                for sign in (1, -1)
            ]
            assert 2 * min(chords) < 1e-14
            wrong = mp.norm([mpf(a) - b for a, b in zip(motion.omega[k], rates, strict=True)])
            assert wrong < 1e-14 * rate


def random_tops(rng: np.random.Generator, count: int) -> tuple[Any, ...]:
    """Bodies of unit size on the third axis, states, gravities."""
    across = rng.uniform(0.5, 1.0, count)
    along = across * np.where(rng.random(count) < 0.2, 0.0, rng.uniform(0.1, 2.0, count))
    length = np.where(rng.random(count) < 0.1, 0.0, 10.0 ** rng.uniform(-3, 0.3, count))
    moments = np.stack([across, across, along], -1)
    centers = np.stack([0 * length, 0 * length, length], -1)
    omega = rng.normal(size=(count, 3)) * 10.0 ** rng.uniform(-6, 2, (count, 3))
    omega[rng.random((count, 3)) < 0.1] = 0.0
    quaternion = rng.normal(size=(count, 4)) * 10.0 ** rng.uniform(-9, 0, (count, 4))
    quaternion[rng.random((count, 4)) < 0.1] = 0.0
    quaternion[~quaternion.any(-1)] = (0.0, 0.0, 0.0, 1.0)
    quaternion /= np.linalg.norm(quaternion, axis=-1, keepdims=True)
    gravity = np.zeros((count, 3))
    gravity[:, 2] = -np.where(rng.random(count) < 0.1, 0.0, 10.0 ** rng.uniform(-3, 3, count))
    return moments, centers, omega, quaternion, gravity


def invariants(
    moments: Any, centers: Any, gravity: Any, quaternion: Any, omega: Any
) -> tuple[np.ndarray, np.ndarray]:
    """Energy and the two angular momenta in units of I_t, and the sizes that their errors are told by."""
    transverse = moments[:, 0] + centers[:, 2] ** 2
    kappa = centers[:, 2] * -gravity[:, 2] / transverse
    ratio = moments[:, 2] / transverse
    up = rotate(quaternion, np.broadcast_to((0.0, 0.0, 1.0), omega.shape), inverse=True)
    across2 = omega[:, 0] ** 2 + omega[:, 1] ** 2
    values = np.stack(
        [
            0.5 * across2 + kappa * up[:, 2],
            omega[:, 0] * up[:, 0] + omega[:, 1] * up[:, 1] + ratio * omega[:, 2] * up[:, 2],
            omega[:, 2],
        ],
        -1,
    )
    speed = np.sqrt((omega**2).sum(-1) + kappa)
    return values, np.stack([speed**2, speed, speed], -1)


class TestLaws:
    def test_energy_and_momenta_of_random_tops(self, rng: np.random.Generator) -> None:
        moments, centers, omega, quaternion, gravity = random_tops(rng, 20_000)
        stack = RigidBody.from_principal(1.0, moments, center_of_mass=centers)
        motion = stack.heavy_top(omega, quaternion, gravity)
        start, size = invariants(moments, centers, gravity, quaternion, omega)
        for turns in (0.0, 1.0, -37.0, 1e6, 1e15):
            states = motion.at(turns)
            assert np.isfinite(states.omega).all()
            norm = np.linalg.norm(states.quaternion, axis=-1)
            assert np.abs(norm - 1).max() < 1e-15
            then, _ = invariants(moments, centers, gravity, states.quaternion, states.omega)
            assert np.nanmax(np.abs(then - start) / np.where(size > 0, size, 1)) < 1e-14

    def test_units_change_nothing(self, rng: np.random.Generator) -> None:
        """Powers of two between 1e-150 and 1e150 leave the bits as they are."""
        moments, centers, omega, quaternion, gravity = random_tops(rng, 300)
        times = np.array([0.0, 0.3, 11.0, 1e5])
        plain = RigidBody.from_principal(1.0, moments, center_of_mass=centers)
        want = plain.heavy_top(omega, quaternion, gravity).at(times)
        for mass, length, rate in [
            (0, 249, 100),
            (300, -249, 249),
            (-300, 100, -400),
            (5, 3, 498),
            (0, 0, -498),
        ]:
            m, s, r = (2.0**k for k in (mass, length, rate))
            body = RigidBody.from_principal(m, moments * s * m * s, center_of_mass=centers * s)
            motion = body.heavy_top(omega * r, quaternion, gravity * s * r * r).at(times / r)
            assert np.array_equal(motion.quaternion, want.quaternion)
            assert np.array_equal(motion.omega, want.omega * r)

    def test_time_runs_back(self, rng: np.random.Generator) -> None:
        moments, centers, omega, quaternion, gravity = random_tops(rng, 200)
        body = RigidBody.from_principal(1.0, moments, center_of_mass=centers)
        size = np.linalg.norm(omega, axis=-1, keepdims=True) + np.sqrt(np.abs(gravity[:, 2:])) + 1e-300
        there = body.heavy_top(omega, quaternion, gravity).at(0.7)
        back = body.heavy_top(there.omega, there.quaternion, gravity).at(-0.7)
        # Unstable ones lose what the state in between was rounded by.
        assert np.median(np.abs(back.omega - omega) / size) < 1e-14
        assert np.abs((back.quaternion * quaternion).sum(-1)).min() > 1 - 1e-6

    def test_any_direction_of_gravity_and_of_the_axis(self, rng: np.random.Generator) -> None:
        case = CASES["loop"]
        times = np.linspace(0, 3, 17)
        want = case.body.heavy_top(case.omega, case.attitude, G).at(times)
        for _ in range(20):
            turns = rng.normal(size=(2, 4))
            space, frame = turns / np.linalg.norm(turns, axis=-1, keepdims=True)
            body = case.body.rotated(frame)
            attitude = product(product(space, case.attitude), frame * [-1, -1, -1, 1])
            got = body.heavy_top(rotate(frame, np.array(case.omega)), attitude, rotate(space, np.array(G)))
            states = got.at(times)
            assert np.abs(states.omega - rotate(frame, want.omega)).max() < 1e-12
            expected = product(product(space, want.quaternion), frame * [-1, -1, -1, 1])
            assert np.abs((states.quaternion * expected).sum(-1)).min() > 1 - 1e-14

    def test_euler_equations_hold(self) -> None:
        """ω̇ by differences is the acceleration under the torque of the weight."""
        case = CASES["loop"]
        step = 1e-4
        motion = case.body.heavy_top(case.omega, case.attitude, G)
        before, now, after = (motion.at(0.4 + k * step) for k in (-1, 0, 1))
        down = rotate(now.quaternion, np.array(G), inverse=True)
        torque = np.cross(case.body.center_of_mass, down)
        want = case.body.angular_acceleration(now.omega, torque, about="origin")
        assert np.abs((after.omega - before.omega) / (2 * step) - want).max() < 1e-4 * np.abs(want).max()


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The quaternion product p∘q, (x, y, z, w)."""
    (a, d), (x, w) = (p[..., :3], p[..., 3:]), (q[..., :3], q[..., 3:])
    vector = d * x + w * a + np.cross(a, x)
    return np.concatenate([vector, d * w - (a * x).sum(-1, keepdims=True)], -1)


class TestWhatItTells:
    def test_paths(self) -> None:
        def path(name: str) -> str:
            case = CASES[name]
            return str(case.body.heavy_top(case.omega, case.attitude, (0, 0, -case.gravity)).mode)

        assert [path(name) for name in ("cusp", "loop", "wave")] == ["cusp", "loop", "wave"]
        assert path("through the upper vertical") == path("through the lower vertical") == "crossing"
        assert path("plane pendulum") == path("plane pendulum, turning over") == "planar"
        assert path("separatrix, pendulum") == "asymptotic"
        upright = CASES["cusp"].body.heavy_top((0, 0, 5.0), None, G)
        assert (upright.mode, math.isnan(upright.nutation_period)) == ("steady", True)
        assert upright.mean_spin == 5.0
        assert np.array_equal(upright.at(1e9).omega, [0.0, 0.0, 5.0])

    @pytest.mark.parametrize(("rate", "path"), [(0.0, "cusp"), (1.0, "wave"), (2.0, "loop")])
    def test_small_paths_do_not_depend_on_their_size(self, rate: float, path: str) -> None:
        """Beside the upper vertical the equations are linear."""
        for theta in (1e-2, 1e-6, 1e-12):
            omega = euler_angles.angular_velocity((0, theta, 0), (rate, 0.0, 25.0 - rate))
            top = CASES["cusp"].body.heavy_top(omega, euler_angles.to_quaternion((0, theta, 0)), G)
            assert top.mode == path

    def test_steady_precession_is_regular(self) -> None:
        body = CASES["cusp"].body
        for theta in (0.3, 1.2, 2.8):
            for rate in tops.steady_precession(body, 25.0, theta, G):
                rates = (rate, 0.0, 25.0 - rate * math.cos(theta))
                omega = euler_angles.angular_velocity((0, theta, 0), rates)
                top = body.heavy_top(omega, euler_angles.to_quaternion((0, theta, 0)), G)
                assert np.ptp(top.nutation_limits) < 1e-7
                # On either side of what is judged to be regular.
                assert np.isnan(top.nutation_period) == (top.mode == "regular")
                assert top.mean_precession == pytest.approx(rate, rel=1e-9)
                assert top.mean_spin == pytest.approx(rates[2], rel=1e-9)

    def test_limits_period_and_means_are_those_of_the_states(self) -> None:
        for name in ("cusp", "loop", "wave"):
            case = CASES[name]
            top = case.body.heavy_top(case.omega, case.attitude, G)
            times = np.linspace(0, top.nutation_period, 4001)
            angles = np.unwrap(top.at(times).euler_angles(), axis=0)
            seen = [angles[:, 1].min(), angles[:, 1].max()]
            assert seen == pytest.approx(top.nutation_limits, abs=1e-5)
            assert angles[-1, 1] == pytest.approx(angles[0, 1], abs=1e-12)
            gained = (angles[-1] - angles[0]) / top.nutation_period
            assert gained[0] == pytest.approx(top.mean_precession, rel=1e-11)
            assert gained[2] == pytest.approx(top.mean_spin, rel=1e-11)

    def test_the_pendulum_of_the_textbooks(self) -> None:
        """T = 4 √(l/g) K(sin(θ/2)): two of the times from one least inclination to the next."""
        bob = solids.sphere(0.0, mass=1.0).translated((0.0, 0.0, -1.0))
        swing = bob.heavy_top((0, 0, 0), euler_angles.to_quaternion((0, 1.0, 0)), G)
        with mp.workdps(30):
            period = 4 * mp.sqrt(1 / mpf(9.81)) * mp.ellipk(mp.sin(mpf(1.0) / 2) ** 2)
        assert swing.nutation_period == pytest.approx(float(period) / 2, rel=1e-14)
        assert swing.nutation_limits == pytest.approx([math.pi - 1, math.pi], abs=1e-14)

    def test_the_effective_potential_bounds_the_nutation(self) -> None:
        case = CASES["loop"]
        top = case.body.heavy_top(case.omega, case.attitude, G)
        low, high = top.effective_potential(top.nutation_limits)
        assert low == pytest.approx(high, rel=1e-13)
        assert top.effective_potential(0.8) < low < top.effective_potential(0.2)
        assert np.isinf(top.effective_potential([0.0])).all()
        assert top.sleeping_limit == tops.least_spin(case.body, G)
        assert top.axial_spin == 20.0


# Stacks, copies, errors.


class TestInterface:
    def test_stacks_broadcast_and_rows_have_their_own_bits(self) -> None:
        stack = solids.cone([0.5, 1.0, 1.5], 3.0, mass=1.0).translated((0.0, 0.0, 2.25))
        omega = np.array([[[0.1, 0.2, 30.0]], [[1.0, 0.0, 3.0]]])
        times = np.linspace(-2, 5, 40).reshape(4, 10)
        top = stack.heavy_top(omega, euler_angles.to_quaternion((0, 0.4, 0)), G)
        assert top.shape == (2, 3)
        motion = top.at(times)
        assert motion.omega.shape == (2, 3, 4, 10, 3)
        assert motion.quaternion.shape == (2, 3, 4, 10, 4)
        alone = stack[1].heavy_top(omega[1, 0], euler_angles.to_quaternion((0, 0.4, 0)), G).at(times[2, 3])
        assert np.array_equal(motion.quaternion[1, 1, 2, 3], alone.quaternion)
        assert np.array_equal(motion.omega[1, 1, 2, 3], alone.omega)
        assert top.mode.shape == (2, 3)
        assert top.nutation_limits.shape == (2, 3, 2)
        assert top.at(0.0).quaternion.shape == (2, 3, 4)
        assert top.at([]).omega.shape == (2, 3, 0, 3)

    def test_a_trajectory_about_the_pivot(self) -> None:
        case = CASES["loop"]
        motion = case.body.heavy_top(case.omega, case.attitude, G).at([0.0, 1.0, 2.0])
        assert not motion.position.any()
        assert not motion.about.any()
        energy = motion.kinetic_energy().total + 9.81 * motion.point("center_of_mass")[:, 2]
        assert np.ptp(energy) < 1e-13 * np.abs(energy).max()
        assert motion.pivoted
        downward = motion.pivot_reaction()[..., 2]
        assert (np.abs(downward - 9.81) < 0.7 * 50).all()
        load = loads.torque_callback(
            lambda _t, _omega, q: np.cross(case.body.center_of_mass, rotate(q, np.array(G), inverse=True))
        )
        run = case.body.simulate(
            [0.0, 1.0, 2.0], case.omega, case.attitude, load=load, about="origin", rtol=1e-13
        )
        assert np.abs(run.omega - motion.omega).max() < 1e-8

    def test_values_copy_pickle_and_print(self) -> None:
        case = CASES["loop"]
        top = case.body.heavy_top(case.omega, case.attitude, G)
        assert copy.copy(top) is top
        assert copy.deepcopy(top) is top
        again = pickle.loads(pickle.dumps(top))
        assert np.array_equal(again.at(3.0).quaternion, top.at(3.0).quaternion)
        assert again.body == case.body
        assert repr(top) == "<HeavyTop: loop, omega=[1.5, -2.0, 20.0]>"
        assert isinstance(top, polhode.HeavyTop)
        many = case.body.heavy_top([case.omega] * 2, case.attitude, G)
        assert repr(many) == "<HeavyTop stack of shape (2,): 2 motions>"

    def test_times_that_are_not_finite(self) -> None:
        for case in CASES.values():
            top = case.body.heavy_top(case.omega, case.attitude, (0, 0, -case.gravity))
            motion = top.at([0.0, np.nan, np.inf, 1.0])
            assert np.isfinite(motion.quaternion[[0, 3]]).all()
            assert np.isnan(motion.quaternion[1]).all()
            assert np.isnan(motion.omega[1, :2]).all()

    def test_what_is_refused(self) -> None:
        with pytest.raises(PolhodeError, match=r"no symmetric top.*simulate"):
            solids.box((1.0, 2.0, 3.0), mass=1.0).heavy_top((0, 0, 1), None, G)
        cone = solids.cone(1.0, 3.0, mass=1.0)
        with pytest.raises(PolhodeError, match=r"pivot.*symmetry axis.*0\.01.*translated"):
            cone.translated((0.01, 0.0, 1.0)).heavy_top((0, 0, 1), None, G)
        with pytest.raises(PolhodeError, match=r"row 1.*omega.*NaN"):
            cone.heavy_top([(0, 0, 1), (0, np.nan, 1)], None, G)
        with pytest.raises(PolhodeError, match=r"gravity.*inf"):
            cone.heavy_top((0, 0, 1), None, (0, 0, np.inf))
        with pytest.raises(ValueError, match="gravity: expected shape"):
            cone.heavy_top((0, 0, 1), None, 9.81)
        with pytest.raises(ValueError, match="do not broadcast"):
            cone.heavy_top(np.zeros((2, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (3, 1)), G)


# Every class of motion against forty digits, up to 1e6 rotations.

BAR = 1e-14


@pytest.mark.parametrize("case", load_table("heavy_top"), ids=lambda case: case.name)
def test_every_class(case: MotionCase) -> None:
    body = RigidBody.from_principal(**case.body)
    motion = body.heavy_top(case.omega, case.attitude, case.gravity).at(np.array(case.times))
    # A pendulum stands still for a moment: its rates are small beside those of the case.
    rate = 2 * np.pi / case.times[0]
    for t, omega, quaternion, want in zip(
        case.times, motion.omega, motion.quaternion, case.expected, strict=True
    ):
        assert angle(quaternion, want.quaternion) <= BAR, f"attitude at t = {t:g}"
        assert relative_error(omega, want.omega, at_least=rate) <= BAR, f"rates at t = {t:g}"


# A hundred thousand tops, their moments from 1e-150 to 1e150: what is conserved stays.

SEED = 20261121
CHUNKS, ROWS = 20, 5000
RADIANS = (0.3, 1e3, 1e9, 1e15)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_heavy_tops_keep_energy_and_momenta() -> None:
    rng = np.random.default_rng(SEED)
    for _ in range(CHUNKS):
        moments, centers, omega, quaternion, gravity = random_tops(rng, ROWS)
        # Powers of two, so that the states come back to unit size without rounding.
        length, rate = 2.0 ** rng.integers(-249, 250), 2.0 ** rng.integers(-240, 241)
        body = RigidBody.from_principal(1.0, moments * length**2, center_of_mass=centers * length)
        motion = body.heavy_top(omega * rate, quaternion, gravity * length * rate * rate)
        start, size = invariants(moments, centers, gravity, quaternion, omega)
        fastest = np.linalg.norm(omega, axis=-1).max()
        for radians in RADIANS:
            states = motion.at(radians / fastest / rate)
            assert np.isfinite(states.omega).all()
            assert np.abs(np.linalg.norm(states.quaternion, axis=-1) - 1).max() < 1e-15
            then, _ = invariants(moments, centers, gravity, states.quaternion, states.omega / rate)
            assert (np.abs(then - start) / np.where(size > 0, size, 1)).max() < 1e-14
