"""Gyrostats in closed form: against integration, mpmath, free motion, and the laws that they keep."""

from __future__ import annotations

import copy
import pickle
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
import polhode
import pytest
from mpmath import mp, mpf
from oracles.gyrostat_cases import cases, proven
from oracles.motion_cases import MotionCase, State, angle, apart, load_table, relative_error
from oracles.polynomials import roots
from polhode import RigidBody, loads
from polhode.errors import InvalidInertiaError, PolhodeError

if TYPE_CHECKING:
    from polhode import GyrostatMotion
if TYPE_CHECKING:
    from numpy.typing import NDArray

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))


OMEGA = (0.3, 0.2, 1.1)


def skew(h: np.ndarray) -> np.ndarray:
    x, y, z = h
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def quaternions_apart(a: np.ndarray, b: np.ndarray) -> float:
    """Tell how far quaternions are from each other, whatever their signs."""
    return float(np.minimum(np.abs(a - b).max(-1), np.abs(a + b).max(-1)).max())


def test_without_momentum_the_bits_are_those_of_free_motion() -> None:
    omega = [(0.3, 0.2, 1.1), (1.3, 0.2, 0.1), (0, 1, 0), (1e-9, 1, 0)]
    times = [0.0, 1.0, 1e6, 1e12]
    exact, free = BODY.gyrostat().free_motion(omega).at(times), BODY.free_motion(omega).at(times)
    assert np.array_equal(exact.omega, free.omega)
    assert np.array_equal(exact.quaternion, free.quaternion)


@pytest.mark.parametrize(
    ("moments", "h", "omega", "mode"),
    [
        ((1, 2, 2.5), (0.1, 0.2, 0.3), (1, 0.2, 0.3), "single"),
        ((1, 2, 2.5), (0.01, 0.02, 0.03), (0.02, 1, 0.03), "paired"),
        ((1, 2, 2.5), (0.01, 0.02, 0.03), (1, 0.2, 0.3), "paired"),
        ((1, 2, 2.5), (0.001, 0.002, 0.003), (0.1, 1, 0.2), "paired"),
        ((1, 2, 2), (0.3, 0, 0), (1, 0.2, 0.3), "circular"),
        ((1, 1, 1.5), (0.3, 0.1, 0), (1, 0.2, 0.3), "paired"),
        ((1.2, 1.2, 1.2), (0.3, 0.1, 0.2), (1, 0.2, 0.3), "circular"),
        ((1, 2, 2.5), (0, 8, 0), (0.1, 0.2, 0.3), "single"),
        ((1, 2, 2.5), (0, 0.3, 0), (0, 1, 0), "steady"),
        ((1, 2, 2.5), (0.3, 0.2, 0.1), (0, 0, 0), "steady"),
    ],
)
def test_integration_finds_the_same(
    moments: tuple[float, ...], h: tuple[float, ...], omega: tuple[float, ...], mode: str
) -> None:
    body = RigidBody.from_principal(1.0, moments)
    motion = body.gyrostat(h).free_motion(omega)
    assert motion.mode == mode
    times = np.linspace(0.0, 20.0, 41)
    load = loads.damping(-skew(np.array(h, float)))
    run = body.simulate(times, omega, load=load, method="taylor", rtol=1e-14)
    exact = motion.at(times)
    largest = np.abs(run.omega).max() or 1.0
    assert np.abs(exact.omega - run.omega).max() <= 3e-13 * max(largest, 1.0)
    assert quaternions_apart(exact.quaternion, run.quaternion) <= 3e-12


@pytest.mark.parametrize("n", [300, pytest.param(1000, marks=pytest.mark.long)])
def test_random_gyrostats_keep_their_laws_and_agree_with_integration(n: int) -> None:
    rng = np.random.default_rng(16)
    moments = np.sort(rng.uniform(1.0, 2.0, (n, 3)), axis=1)
    bodies = RigidBody.from_principal(1.0, moments)
    h = rng.normal(size=(n, 3)) * 10 ** rng.uniform(-3, 1, (n, 1))
    omega = rng.normal(size=(n, 3))
    motions = bodies.gyrostat(h).free_motion(omega)
    assert motions.shape == (n,)
    late = motions.at([0.0, 5.0, 50.0, 1e6, 1e12])
    assert np.isfinite(late.omega).all()
    assert np.isfinite(late.quaternion).all()
    size = np.linalg.norm(motions.angular_momentum().spin, axis=-1)
    spin = late.angular_momentum().spin
    drift = np.linalg.norm(spin - motions.angular_momentum().spin[:, None], axis=-1) / size[:, None]
    assert drift.max() <= 1e-14
    energy = late.kinetic_energy().total
    scale = np.abs(energy).max(1) + (h**2).sum(1)
    assert (np.abs(energy - motions.kinetic_energy().total[:, None]).max(1) / scale).max() <= 1e-14
    run = bodies.simulate([0.0, 5.0, 50.0], omega, load=loads.rotor(h), method="taylor", rtol=1e-22)
    largest = np.linalg.norm(run.omega, axis=-1).max(1)
    assert (np.abs(late.omega[:, :3] - run.omega).max((1, 2)) / largest).max() <= 3e-15
    assert quaternions_apart(late.quaternion[:, :3], run.quaternion) <= 3e-15


@pytest.mark.long
def test_random_gyrostats_over_hundreds_of_rotations() -> None:
    rng = np.random.default_rng(17)
    bodies = RigidBody.from_principal(1.0, np.sort(rng.uniform(1.0, 2.0, (1000, 3)), axis=1))
    h, omega = rng.normal(size=(1000, 3)) * 10 ** rng.uniform(-3, 1, (1000, 1)), rng.normal(size=(1000, 3))
    times = [0.0, 100.0, 1000.0, 3000.0]
    exact = bodies.gyrostat(h).free_motion(omega).at(times)
    run = bodies.simulate(times, omega, load=loads.rotor(h), method="taylor", rtol=1e-24)
    largest = np.linalg.norm(run.omega, axis=-1).max(1)
    assert (np.abs(exact.omega - run.omega).max((1, 2)) / largest).max() <= 3e-15
    assert quaternions_apart(exact.quaternion, run.quaternion) <= 3e-15


def test_after_its_period_omega_is_back() -> None:
    for h, omega in [((0.1, 0.2, 0.3), (1, 0.2, 0.3)), ((0.01, 0.02, 0.03), (0.02, 1, 0.03))]:
        motion = BODY.gyrostat(h).free_motion(omega)
        assert np.abs(motion.at(motion.periods.rotation).omega - motion.at(0.0).omega).max() < 1e-13


def test_rotating_the_axes_and_scaling_change_nothing() -> None:
    rng = np.random.default_rng(3)
    h, omega = rng.normal(size=3), rng.normal(size=3)
    times = np.array([0.0, 3.0, 30.0])
    plain = BODY.gyrostat(h).free_motion(omega).at(times)
    q = np.array([0.1, 0.5, -0.3, 0.8]) / np.linalg.norm([0.1, 0.5, -0.3, 0.8])
    turned = BODY.rotated(q).gyrostat(polhode._core.rotate(q, h)).free_motion(polhode._core.rotate(q, omega))
    assert np.abs(polhode._core.rotate(q, plain.omega) - turned.at(times).omega).max() < 1e-13
    for inertia, rate in [(2.0**-150, 2.0**100), (2.0**120, 2.0**-90)]:
        body = RigidBody.from_principal(1.0, np.array([1.0, 2.0, 2.5]) * inertia)
        scaled = body.gyrostat(h * inertia * rate).free_motion(omega * rate).at(times / rate)
        assert np.abs(scaled.omega / rate - plain.omega).max() < 1e-14
        assert quaternions_apart(scaled.quaternion, plain.quaternion) < 1e-14


@pytest.mark.parametrize("power", [-4, -10, -20, -100, -300])
def test_little_momentum(power: int) -> None:
    h, times = np.array([0.3, -0.5, 0.7]) * 10.0**power, [0.0, 1.0, 10.0]
    for moments in [(1, 2, 2.5), (1, 1, 1.5), (1.3, 1.3, 1.3)]:
        body = RigidBody.from_principal(1.0, moments)
        exact = body.gyrostat(h).free_motion((0.3, 0.2, 1.1)).at(times)
        run = body.simulate(times, (0.3, 0.2, 1.1), load=loads.rotor(h), method="taylor", rtol=1e-25)
        assert np.abs(exact.omega - run.omega).max() <= 2e-15
        assert quaternions_apart(exact.quaternion, run.quaternion) <= 2e-15
        free = body.free_motion((0.3, 0.2, 1.1)).at(times)
        assert np.abs(exact.omega - free.omega).max() <= 2e-15 + 20 * 10.0**power


def test_from_one_equilibrium_to_another() -> None:
    """With h along the first axis the separatrix leads from one saddle to its mirror image: to stay there."""
    body, h = RigidBody.from_principal(1.0, (3.0, 4.0, 6.0)), (3.0, 0.0, 0.0)
    omega, times = (-1.0, -0.5, 2.0), np.linspace(0, 30, 301)
    motion = body.gyrostat(h).free_motion(omega)
    run = body.simulate(times, omega, load=loads.rotor(h), method="taylor", rtol=1e-26)
    exact = motion.at(times)
    assert motion.mode == "separatrix"
    assert quaternions_apart(exact.quaternion, run.quaternion) <= 4e-15
    assert np.abs(exact.omega - run.omega).max() <= 4e-14
    for t in (150.0, 1e3, 1e6):
        ends = motion.at([-t, t]).omega
        assert np.abs(ends - [[3, 0.5, 0], [3, -0.5, 0]]).max() <= 1e-9 * (t < 1e3) + 1e-13


@pytest.mark.parametrize("is_turned", [False, True])
@pytest.mark.parametrize(
    ("off", "mode"),
    [
        (-(2.0**-40), "single"),
        (-(2.0**-50), "single"),
        (0.0, "separatrix"),
        (2.0**-50, "paired"),
        (2.0**-40, "paired"),
    ],
)
def test_a_start_on_the_separatrix_and_next_to_it(off: float, mode: str, *, is_turned: bool) -> None:
    """Numbers are whole, so that the start is on it exactly; a third of the matrix is a rotation."""
    turn = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]])
    omega = np.array([-2.5 * (1.0 + off), 1.0, -2.5])
    if is_turned:
        gyrostat = RigidBody(1.0, turn @ np.diag([18.0, 27.0, 36.0]) @ turn.T / 9).gyrostat(
            turn @ [9.0, 9.0, 18.0]
        )
        motion = gyrostat.free_motion(turn @ omega)
    else:
        motion = (
            RigidBody.from_principal(1.0, (2.0, 3.0, 4.0)).gyrostat((3.0, 3.0, 6.0)).free_motion(3.0 * omega)
        )
    assert motion.mode == mode
    assert np.isinf(motion.periods.rotation) == (mode == "separatrix")
    assert not np.isnan(motion.periods.rotation)


def test_a_steady_rotation_has_no_period() -> None:
    """ω is constant: with momentum inside, without, and along the axis of a symmetric body."""
    for gyrostat, omega in (
        (BODY.gyrostat((0.0, 0.3, 0.0)), (0.0, 1.0, 0.0)),
        (BODY.gyrostat((0.0, 0.0, 0.0)), (0.0, 1.0, 0.0)),
        (RigidBody.from_principal(1.0, (1.0, 1.0, 2.0)).gyrostat((0.0, 0.0, 0.0)), (0.0, 0.0, 1.0)),
    ):
        motion = gyrostat.free_motion(omega)
        assert motion.mode == "steady"
        assert np.isnan(motion.periods.rotation)
        assert motion.periods.turn == pytest.approx(2 * np.pi, rel=1e-15)


def test_the_wobble_of_a_steady_rotation_is_that_of_its_neighbours() -> None:
    gyrostat = BODY.gyrostat((0.0, 3.0, 0.0))
    steady = gyrostat.free_motion((0.0, 1.0, 0.0))
    assert gyrostat.free_motion((1e-4, 1.0, 0.0)).periods.rotation == pytest.approx(
        steady.periods.wobble, rel=1e-7
    )
    unstable = BODY.gyrostat((0.0, 0.3, 0.0)).free_motion((0.0, 1.0, 0.0))
    assert np.isnan(unstable.periods.wobble)
    moving = gyrostat.free_motion([(0.3, 1.0, 0.2), (0.0, 1.0, 0.0)]).periods
    assert np.isnan(moving.turn).tolist() == [True, False]
    assert np.isnan(moving.precession).all()
    assert moving.sigma is None


def test_momentum_in_the_body_is_that_at_the_start() -> None:
    turned = np.array([0.5, -0.1, 0.7, 0.5])
    for motion in (
        BODY.free_motion(OMEGA, turned),
        BODY.gyrostat((0.3, -0.1, 0.2)).free_motion(OMEGA, turned),
    ):
        start = motion.at([0.0])
        for frame in ("space", "body"):
            found, want = motion.angular_momentum(frame), start.angular_momentum(frame)
            assert not np.any([found.orbital, found.mixed])
            np.testing.assert_allclose(found.total, want.total[0], rtol=1e-14)
        with pytest.raises(ValueError, match='frame: "earth" is not "space" or "body"'):
            motion.angular_momentum("earth")  # type: ignore[arg-type]


def test_a_start_next_to_the_middle_axis_turns_over_when_it_should() -> None:
    # The time to turn over grows by ln(10)/rate with each decade.
    gyrostat = BODY.gyrostat((0.0, 0.3, 0.0))
    periods = [gyrostat.free_motion((10.0**-k, 1.0, 0.0)).periods.rotation for k in (20, 21, 60, 61)]
    assert abs((periods[1] - periods[0]) - (periods[3] - periods[2])) < 1e-10
    late = gyrostat.free_motion((1e-60, 1.0, 0.0)).at(np.linspace(0, 3 * periods[2], 1000))
    assert np.isfinite(late.omega).all()
    assert late.omega[:, 1].min() < 0.9


@pytest.mark.parametrize("thin", [0.3, 0.05, 1e-2, 1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize("h", ["across", "along"])
def test_a_slender_body_keeps_the_digits_of_its_fast_rate(thin: float, h: str) -> None:
    """Its rate is a small difference of large terms, over the smallest moment."""
    rotor, omega = {
        "across": ((0, 0.02, 0.3), (2, 0.7, -0.9)),
        "along": ((0.5 * thin, 0, 0), (0.1, 0.05, 1.0)),
    }[h]
    body = RigidBody.from_principal(1.0, (thin, 1.0, 1.0 + 0.5 * thin))
    times = np.array([0.0, *np.linspace(0.1, 3, 12)])
    inside = loads.damping(-skew(np.array(rotor)))
    run = body.simulate(times, omega, load=inside, method="taylor", rtol=1e-26)
    off = body.gyrostat(rotor).free_motion(omega).at(times).omega - run.omega
    assert np.linalg.norm(off, axis=1).max() < 5e-15 * np.linalg.norm(run.omega, axis=1).max()


def test_free_and_held_wheels_are_two_systems() -> None:
    axis, inertia, rate, omega = np.array([1.0, 2.0, 2.0]) / 3, 0.2, 30.0, np.array([0.1, 0.2, 0.3])
    times = np.linspace(0, 5, 11)
    held = polhode.wheel(axis=axis, inertia=inertia, rate=rate, mode="held")
    motion = BODY.gyrostat(wheels=[held]).free_motion(omega)
    plain = BODY.gyrostat(inertia * rate * axis).free_motion(omega)
    assert np.abs(motion.at(times).omega - plain.at(times).omega).max() < 1e-13
    free = polhode.wheel(axis=axis, inertia=inertia, rate=rate)
    motion = BODY.gyrostat(wheels=[free]).free_motion(omega)
    h = inertia * (rate + axis @ omega) * axis
    assert np.abs(motion.rotor - h).max() < 1e-14
    rest = RigidBody(1.0, np.diag([1.0, 2.0, 2.5]) - inertia * np.outer(axis, axis), rtol=0.9)
    run = rest.simulate(times, omega, load=loads.damping(-skew(h)), method="taylor", rtol=1e-14)
    exact = motion.at(times)
    assert np.abs(exact.omega - run.omega).max() < 1e-12
    assert quaternions_apart(exact.quaternion, run.quaternion) < 1e-12
    start = np.diag([1.0, 2.0, 2.5]) @ omega + inertia * rate * axis
    assert np.abs(exact.angular_momentum().spin - start).max() < 1e-13
    assert exact.invariants().energy_drift < 1e-13


def test_values_do_not_change_and_survive_pickle() -> None:
    wheel = polhode.wheel(axis=(0, 0, 1), inertia=0.1, momentum=2.0)
    assert wheel == polhode.wheel(axis=(0, 0, 1), inertia=0.1, rate=20.0)
    gyrostat = BODY.gyrostat((0.1, 0, 0), wheels=[wheel])
    motion = gyrostat.free_motion([(0.1, 0.2, 0.3), (1, 0, 0)])
    again = pickle.loads(pickle.dumps(motion))
    assert again.gyrostat == gyrostat
    assert copy.copy(motion) is motion
    assert np.array_equal(again.at(3.0).omega, motion.at(3.0).omega)
    assert repr(gyrostat) == "<Gyrostat: momentum=[0.1, 0.0, 2.0], 1 wheel>"
    assert repr(motion) == "<GyrostatMotion stack of shape (2,): 2 motions>"
    assert gyrostat != BODY.gyrostat((0.1, 0, 0))


def test_what_is_refused() -> None:
    with pytest.raises(PolhodeError, match="omega"):
        BODY.gyrostat((1, 0, 0)).free_motion((np.nan, 0, 0))
    with pytest.raises(PolhodeError, match="momentum"):
        BODY.gyrostat((np.inf, 0, 0))
    with pytest.raises(InvalidInertiaError, match="free wheels"):
        BODY.gyrostat(wheels=[polhode.wheel(axis=(1, 0, 0), inertia=1.5, rate=1.0)])
    with pytest.raises(InvalidInertiaError, match="thickness"):
        RigidBody.from_principal(1.0, (0, 1, 1)).gyrostat((1, 0, 0)).free_motion((1, 0, 0))
    with pytest.raises(ValueError, match="other than zero"):
        BODY.gyrostat(wheels=[polhode.wheel(axis=(0, 0, 0), inertia=0.1, rate=1.0)])
    with pytest.raises(ValueError, match="exactly one"):
        polhode.wheel(axis=(1, 0, 0), inertia=0.1)
    with pytest.raises(ValueError, match="'free' or 'held'"):
        polhode.wheel(axis=(1, 0, 0), inertia=0.1, rate=1.0, mode="loose")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"polhode\.wheel"):
        BODY.gyrostat(wheels=[3])  # type: ignore[list-item]


# Every regime against forty digits, up to 1e12 rotations.

CASES = load_table("gyrostat")
SHORT = 15.0
"""Rotations that a general integrator is followed for."""


def _body(case: MotionCase) -> RigidBody:
    return RigidBody(**case.body) if "inertia" in case.body else RigidBody.from_principal(**case.body)


def _error(
    case: MotionCase, omega: NDArray[np.float64], quaternion: NDArray[np.float64], want: State
) -> float:
    return max(angle(quaternion, want.quaternion), relative_error(omega, want.omega, at_least=case.fastest))


def test_every_regime_has_its_cases() -> None:
    assert [case.name for case in CASES] == [case.name for case in cases()]
    assert len(CASES) >= 60
    assert all(len(case.kappa) == len(case.expected) == len(case.times) for case in CASES)


@pytest.mark.parametrize(
    "name",
    [
        "symmetric: oblate, h along its axis",
        "spherical: h along none",
        pytest.param("generic: two lobes, one", marks=pytest.mark.long),
    ],
)
def test_the_generator_makes_the_table(name: str) -> None:
    made = next(proven(case) for case in cases() if case.name == name)
    kept = next(case for case in CASES if case.name == name)
    assert (made.kappa, made.fastest, made.periods) == (kept.kappa, kept.fastest, kept.periods)
    assert max(apart(a, b) for a, b in zip(made.expected, kept.expected, strict=True)) < 1e-38


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_table_against_integration(case: MotionCase) -> None:
    x, y, z = case.rotor
    inside = loads.damping([[0, z, -y], [-z, 0, x], [y, -x, 0]])
    turn = max(case.times[0] * 4, 1e-300)
    short = [i for i, t in enumerate(case.times) if t <= SHORT * turn]
    times = np.array([0.0, *(case.times[i] for i in short)])
    run = _body(case).simulate(times, case.omega, case.attitude, load=inside, method="taylor", rtol=1e-26)
    for k, i in enumerate(short, start=1):
        bar = 1e-15 + 1e-16 * case.kappa[i]
        assert _error(case, run.omega[k], run.quaternion[k], case.expected[i]) <= bar, (
            f"t = {case.times[i]:g}"
        )


STATES = [pytest.param(case, i, id=f"{case.name}: {i}") for case in CASES for i in range(len(case.times))]


@pytest.mark.parametrize(("case", "i"), STATES)
def test_the_closed_form(case: MotionCase, i: int) -> None:
    motion = _body(case).gyrostat(case.rotor).free_motion(case.omega, case.attitude)
    state, want = motion.at(case.times[i]), case.expected[i]
    bar = 1e-14 + 1e-16 * case.kappa[i]
    assert _error(case, state.omega, state.quaternion, want) <= bar, f"t = {case.times[i]:g}"


# The period next to a separatrix, against 80 digits: by the pencil of energy and momentum.

TURN = np.array([[2, -1, 2], [2, 2, -1], [-1, 2, 2]])
"""Three times a rotation: what it makes of whole numbers is exact."""


def period(moments: Any, momentum: Any, omega: Any) -> Any:
    """Give det I · 2∫dx/y over a positive lobe of y² = det(Q_T − x Q_L), by the arithmetic-geometric mean."""
    inertia, h, w = mpmath.diag(moments), mpmath.matrix(momentum), mpmath.matrix(omega)
    twice = (w.T * inertia * w)[0]
    whole = inertia * w + h
    rest = (h.T * h)[0] - (whole.T * whole)[0]
    inside = inertia * h

    def determinant(x: Any) -> Any:
        matrix = mpmath.matrix(4, 4)
        matrix[:3, :3] = inertia - x * inertia * inertia
        for i in range(3):
            matrix[i, 3] = matrix[3, i] = -x * inside[i]
        matrix[3, 3] = -twice - x * rest
        return mpmath.det(matrix)

    places = [mpf(k) / 4 for k in range(5)]
    powers = mpmath.matrix([[x**k for k in range(4, -1, -1)] for x in places])
    a, b, c, d, e = mpmath.lu_solve(powers, mpmath.matrix([determinant(x) for x in places]))
    b, c, d = b / 4, c / 6, d / 4
    second = a * e - 4 * b * d + 3 * c * c
    third = a * c * e + 2 * b * c * d - a * d * d - b * b * e - c**3
    cubic = roots([4, 0, -second, -third], maxsteps=500, extraprec=800)
    real = sorted(x.real for x in cubic if abs(x.imag) < mpf(10) ** -60 * abs(x))
    root = real[-1]
    height = mpmath.sqrt(3 * root**2 - second / 4)
    mean = mpmath.agm(2 * mpmath.sqrt(height), mpmath.sqrt(3 * root + 2 * height))
    return 2 * mpmath.pi / mean * mpmath.det(inertia)


def turned(moments: Any, momentum: Any, omega: Any) -> GyrostatMotion:
    """Give the motion with other axes, three times as fast; the products of the tensor are whole numbers."""
    tensor = TURN @ np.diag(moments) @ TURN.T
    return RigidBody(1.0, tensor).gyrostat(9 * TURN @ momentum).free_motion(TURN @ omega)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("power", range(10, 53, 3))
@pytest.mark.parametrize(
    ("moments", "momentum", "omega"),
    [
        ((2.0, 3.0, 4.0), (1.0, 1.0, 2.0), (-2.5, 1.0, -2.5)),
        ((3.0, 4.0, 6.0), (2.5, 0.0, -1.0), (-1.5, 1.0, -1.5)),
        ((2.0, 3.0, 4.0), (0.0, 0.0, 2.0), (2.0, 0.0, -0.5)),
    ],
    ids=["h along none", "h in a plane", "h along the third axis"],
)
def test_next_to_a_separatrix_it_has_all_its_digits(
    moments: Any, momentum: Any, omega: Any, power: int, sign: int
) -> None:
    start = np.array(omega) * [1 + sign * 2.0**-power, 1, 1]
    body = RigidBody.from_principal(1.0, moments)
    with mp.workdps(80):
        exact = period(moments, momentum, start)
        for found, want in (
            (body.gyrostat(momentum).free_motion(start).periods.rotation, exact),
            (turned(moments, momentum, start).periods.rotation, exact / 3),
        ):
            assert abs(mpf(float(found)) / want - 1) <= 4e-16
