"""Derivatives of motions under loads, against differences in many digits, closed forms and laws."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf
from oracles.load_cases import ATTITUDE
from oracles.load_variations import NAMES, Setting, jacobian, setting, table
from polhode import MotionSensitivity, RigidBody, loads
from polhode.errors import IntegrationError, PolhodeError
from scipy.spatial.transform import Rotation

BRICK = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5))
OMEGA = (0.3, 0.2, 1.1)


def load_of(terms: list[dict[str, Any]]) -> Any:
    """The sum of the terms."""
    made = []
    for term in terms:
        arguments = {name: value for name, value in term.items() if name != "kind"}
        gains = [arguments.pop(name) for name in ("K", "D") if name in arguments]
        made.append(getattr(loads, term["kind"])(*gains, **arguments))
    return sum(made[1:], made[0])


def columns(case: Setting) -> np.ndarray:
    """Derivatives at the end in the oracle's order, (6, variables)."""
    body = RigidBody.from_principal(**case.body) if "moments" in case.body else RigidBody(**case.body)
    about: Literal["origin", "center_of_mass"] = "origin" if case.pivoted else "center_of_mass"
    run = body.simulate([0.0, case.time], case.omega, ATTITUDE, load=load_of(case.load), about=about)
    found = run.sensitivity()
    V = body.principal_about(about).axes
    by_tensor = []
    for i, j in ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)):
        change = np.zeros((3, 3))
        change[i, j] = change[j, i] = 1.0
        in_axes = V.T @ change @ V
        off = np.array([in_axes[1, 2], in_axes[2, 0], in_axes[0, 1]])
        by_tensor.append(found.moments[-1] @ np.diag(in_axes) + found.products[-1] @ off)
    by_load = [slopes[-1].reshape(6, -1) for term in found.load for slopes in term.values()]
    own = [found.state[-1], np.array(by_tensor).T, found.center_of_mass[-1], found.mass[-1][:, None]]
    return np.concatenate([*own, *by_load], axis=1)


def assert_as_exact(got: np.ndarray, exact: np.ndarray, tolerance: float) -> None:
    assert got.shape == exact.shape
    for part in (slice(0, 6), slice(6, 12), slice(12, 15), slice(15, 16), slice(16, None)):
        assert np.abs(got[:, part] - exact[:, part]).max() <= tolerance * np.abs(exact[:, part]).max()


@pytest.mark.parametrize("name", NAMES)
def test_every_load_against_differences_in_many_digits(name: str) -> None:
    """After ten rotations, relative to the largest derivative of each kind."""
    assert_as_exact(columns(setting(name)), table()[name], 1e-12)


@pytest.mark.parametrize("name", ["feedback: matrices, a target", "gravity gradient: eccentric"])
def test_differences_computed_here(name: str) -> None:
    """After a tenth of a rotation, so that they are soon done."""
    case = setting(name)
    case = case._replace(time=case.time / 100)
    assert_as_exact(columns(case), jacobian(case), 1e-13)


def test_a_free_body_is_as_exact() -> None:
    t = np.array([0.0, 1.0, 7.0, 60.0])
    bodies = RigidBody.from_principal(1.0, [(1.0, 2.0, 2.5), (2.0, 2.0, 2.5), (0.0, 2.0, 2.0)])
    run = bodies.simulate(t, OMEGA, ATTITUDE)
    found, exact = run.sensitivity(), bodies.free_motion(OMEGA, ATTITUDE).sensitivity(t)
    assert found.state.shape == (3, 4, 6, 6)
    assert found.load == ()
    np.testing.assert_allclose(found.state, exact.state, atol=1e-12)
    np.testing.assert_allclose(found.moments, exact.moments, atol=1e-12)
    assert np.isnan(found.products[2]).all()
    assert not found.mass.any()
    with pytest.raises(ValueError, match="FreeMotion"):
        BRICK.free_motion(OMEGA).at([[1.0, 2.0]]).sensitivity()


def test_backward_in_time() -> None:
    """The derivatives back are the inverse of those forth."""
    load = loads.uniform_gravity((0.0, 0.0, -2.0)) + loads.damping(np.diag((0.02, 0.01, 0.03)))
    top = RigidBody.from_principal(1.0, (0.8, 1.0, 1.3), center_of_mass=(0.1, -0.2, 0.5))
    forth = top.simulate([0.0, 9.0], OMEGA, ATTITUDE, load=load, about="origin", rtol=1e-14)
    end = forth.state()
    back = top.simulate([9.0, 0.0], end.omega, end.attitude, load=load, about="origin")
    product = back.sensitivity().state[-1] @ forth.sensitivity().state[-1]
    np.testing.assert_allclose(product, np.eye(6), atol=1e-11)


@given(seed=st.integers(0, 2**32 - 1))
def test_volumes_shrink_by_the_damping_alone(seed: int) -> None:
    """Liouville: torques keep the volume of attitudes and momenta, but −D ω takes tr(I⁻¹D) of it a time."""
    rng = np.random.default_rng(seed)
    body = RigidBody.from_principal(1.0, (0.8, 1.0, 1.3), center_of_mass=rng.normal(size=3) / 4)
    D = rng.normal(size=(3, 3)) / 20
    about: Literal["origin", "center_of_mass"] = "origin" if seed % 2 else "center_of_mass"
    load = (
        loads.feedback(rng.normal(size=(3, 3)), D, rng.normal(size=4) / 1e9 + (0, 0, 0, 1))
        + loads.uniform_gravity(rng.normal(size=3))
        + loads.constant_torque(rng.normal(size=3), "space")
        + loads.constant_force(rng.normal(size=3), "body", point=rng.normal(size=3))
    )
    if about == "center_of_mass":
        load += loads.gravity_gradient(1.0, (1.0, 0.25, 0.125), (-0.125, 1.125, 0.25), epoch=-0.7)
    t = np.linspace(0.0, 5.0, 6)
    found = body.simulate(t, rng.normal(size=3), load=load, about=about).sensitivity()
    rate = np.trace(np.linalg.solve(body.inertia_about(about), D))
    size = np.linalg.norm(found.state, 2, axis=(1, 2)) ** 2
    assert (np.abs(np.linalg.det(found.state) * np.exp(rate * t) - 1.0) < 1e-12 * size).all()


@given(seed=st.integers(0, 2**32 - 1))
def test_a_larger_world_turns_alike(seed: int) -> None:
    """The gradient knows μ/r³ alone: nothing changes with μ as the cube of lengths, whatever the epoch."""
    rng = np.random.default_rng(seed)
    mu, position, velocity = 1.0, np.array([1.0, 0.25, 0.125]), np.array([-0.125, 1.125, 0.25])
    load = loads.gravity_gradient(mu, position, velocity, epoch=rng.uniform(-20.0, 20.0))
    (slopes,) = BRICK.simulate([0.0, 9.0], OMEGA, ATTITUDE, load=load).sensitivity().load
    parts = [3 * mu * slopes["mu"], slopes["position"] @ position, slopes["velocity"] @ velocity]
    assert np.abs(sum(parts)).max() <= 1e-11 * max(np.abs(part).max() for part in parts)


def about_third(found: MotionSensitivity) -> np.ndarray:
    """(angle, ω₃) by (angle, ω₃)."""
    slopes: np.ndarray = found.state[-1][np.ix_((2, 5), (2, 5))]
    return slopes


def swinging(moment: Any, k: Any, start: Any, speed: Any, t: Any) -> np.ndarray:
    """(angle, rate) at t by those at the start: ω² = ω₀² − 2 (V − V₀), V = 2k/I (1 − |cos α/2|)."""
    k, start, speed = mpmath.mpf(k), mpmath.mpf(start), mpmath.mpf(speed)

    def potential(angle: Any) -> Any:
        return 2 * k / moment * (1 - abs(mpmath.cos(angle / 2)))

    def rate(angle: Any) -> Any:
        return mpmath.sqrt(speed**2 - 2 * (potential(angle) - potential(start)))

    def along(power: int, angle: Any) -> Any:
        ends = [start, mpmath.pi, angle] if angle > mpmath.pi else [start, angle]
        return mpmath.quad(lambda x: rate(x) ** -power, ends)

    angle = mpmath.findroot(lambda x: along(1, x) - t, 7.0)
    assert mpmath.pi < angle < 3 * mpmath.pi
    push = k / moment * mpmath.sin(start / 2)
    pull = -mpmath.sign(mpmath.cos(angle / 2)) * k / moment * mpmath.sin(angle / 2)
    by_start = rate(angle) * (1 / speed + push * along(3, angle))
    by_speed = rate(angle) * speed * along(3, angle)
    # ω dω = ω₀ dω₀ − V' dα + V'₀ dα₀.
    rates = [(push + pull * by_start) / rate(angle), (speed + pull * by_speed) / rate(angle)]
    return np.array([[by_start, by_speed], rates], dtype=float)


def test_a_feedback_beyond_half_a_turn() -> None:
    """Its torque changes its sign there."""
    moment, k, start, speed, t = 2.5, 0.3, 1.0, 1.5, 4.5
    with mpmath.workdps(30):
        exact = swinging(moment, k, start, speed, t)
    attitude = Rotation.from_rotvec((0.0, 0.0, start))
    run = BRICK.simulate([0.0, t], (0.0, 0.0, speed), attitude, load=loads.feedback(k, 0.0))
    np.testing.assert_allclose(about_third(run.sensitivity()), exact, rtol=1e-12)


def test_quadratic_damping_through_rest() -> None:
    """I ω̇ = n − e|ω|ω from a spin against the torque: tan, then tanh; dω by dω₀ is as ω̇ by ω̇₀."""
    moment, n, e, start, t = 2.5, 0.4, 0.7, -1.0, 9.0
    load = loads.constant_torque((0.0, 0.0, n)) + loads.damping(np.zeros((3, 3)), e)
    found = BRICK.simulate([0.0, t], (0.0, 0.0, start), load=load).sensitivity()
    slow = np.sqrt(n * e) / moment
    rest = np.arctan(-start * np.sqrt(e / n)) / slow
    end = np.sqrt(n / e) * np.tanh(slow * (t - rest))
    exact = (n - e * end**2) / (n + e * start**2)
    assert about_third(found)[1, 1] == pytest.approx(exact, rel=1e-9)


def test_samples_and_switches() -> None:
    """About one axis ω₃ is the integral of the torque: of each sample's own cubic, and of a window."""
    knots, moment = np.array([0.0, 1.0, 2.5, 4.0]), 2.5
    torque = np.outer([0.1, -0.2, 0.3, 0.05], (0.0, 0.0, 1.0))
    load = loads.sampled(knots, torque) + loads.schedule(loads.constant_torque((0.0, 0.0, 0.1)), [(1.5, 2.0)])
    t = np.array([0.0, 1.75, 4.0])
    by_samples, by_torque = BRICK.simulate(t, (0.0, 0.0, 0.2), load=load).sensitivity().load
    assert by_samples["torque"].shape == (3, 6, 4, 3)
    for k in range(4):
        own = np.polynomial.Polynomial.fromroots(np.delete(knots, k))
        exact = (own / own(knots[k])).integ()(t) / moment
        np.testing.assert_allclose(by_samples["torque"][:, 5, k, 2], exact, atol=1e-14)
    np.testing.assert_allclose(by_torque["vector"][:, 5, 2], [0.0, 0.1, 0.2], atol=1e-15)
    np.testing.assert_allclose(by_torque["vector"][:, 2, 2], [0.0, 0.0125, 0.45], atol=1e-15)


@pytest.mark.parametrize("frame", ["body", "space"])
def test_samples_that_are_all_the_same(frame: Any) -> None:
    """Together they vary as the constant torque does that they are."""
    vector, knots = np.array([0.05, -0.02, 0.1]), np.linspace(0.0, 9.0, 7)
    sampled = loads.sampled(knots, np.tile(vector, (7, 1)), frame)
    run = BRICK.simulate(knots, OMEGA, ATTITUDE, load=sampled)
    constant = BRICK.simulate(knots, OMEGA, ATTITUDE, load=loads.constant_torque(vector, frame))
    (by_samples,), (exact,) = run.sensitivity().load, constant.sensitivity().load
    together = by_samples["torque"].sum(axis=-2)
    np.testing.assert_allclose(together, exact["vector"], atol=1e-12 * np.abs(exact["vector"]).max())


def test_stacks_and_units() -> None:
    """Rows are those of single runs; other units of mass, length and time change nothing but the units."""
    gravity = np.array([(0.0, 0.0, -2.0), (0.0, 1.0, -1.0)])
    top = RigidBody.from_principal(1.0, (0.8, 1.0, 1.3), center_of_mass=(0.1, -0.2, 0.5))
    t = np.array([0.0, 2.0, 5.0])
    run = top.simulate(t, OMEGA, ATTITUDE, load=loads.uniform_gravity(gravity), about="origin")
    found = run.sensitivity()
    assert found.load[0]["gravity"].shape == (2, 3, 6, 3)
    for row in range(2):
        alone = top.simulate(t, OMEGA, ATTITUDE, load=loads.uniform_gravity(gravity[row]), about="origin")
        one = alone.sensitivity()
        assert np.array_equal(one.state, found.state[row])
        assert np.array_equal(one.load[0]["gravity"], found.load[0]["gravity"][row])
    # Powers of two change no digit.
    m, s, fast = 2.0**-80, 2.0**-33, 2.0**40
    small = top.scaled(length=s, mass=m)
    load = loads.uniform_gravity(gravity * s * fast**2)
    scaled = small.simulate(
        t / fast, np.array(OMEGA) * fast, ATTITUDE, load=load, about="origin"
    ).sensitivity()
    rows = np.array([1, 1, 1, fast, fast, fast])
    assert np.array_equal(scaled.state, found.state * rows[:, None] / rows)
    np.testing.assert_allclose(scaled.moments * (m * s**2), found.moments * rows[:, None], rtol=1e-12)
    np.testing.assert_allclose(
        scaled.load[0]["gravity"] * (s * fast**2), found.load[0]["gravity"] * rows[:, None], rtol=1e-12
    )


def test_what_cannot_be_varied_says_so() -> None:
    def torque(t: float, omega: Any, quaternion: Any) -> Any:  # noqa: ARG001
        return -0.1 * omega

    run = BRICK.simulate([0.0, 1.0], OMEGA, load=loads.torque_callback(torque))
    with pytest.raises(PolhodeError, match=r'call a function.*method="differences"'):
        run.sensitivity()


def test_through_rest_under_quadratic_damping() -> None:
    """Of ω̇ = f(ω), f = τ − E |ω| ω, dω(t)/dω(0) is f(ω(t))/f(ω(0)); ω by tan, then tanh."""
    rng = np.random.default_rng(20261122)
    body = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
    worst = 0.0
    for _ in range(60):
        tau, drag = 10.0 ** rng.uniform(-1, 1, 2)
        start = -float(10.0 ** rng.uniform(-2, 1))
        ratio, rate = np.sqrt(tau / drag), np.sqrt(tau * drag)
        rest = np.arctan(-start / ratio) / rate  # when ω is zero
        t = float(rest + rng.uniform(0.1, 2.0) / rate)
        load = loads.constant_torque((0, 0, tau)) + loads.damping(np.zeros((3, 3)), drag)
        found = body.simulate([0, t], (0, 0, start), load=load).sensitivity().state[-1][5, 5]
        with mp.workdps(40):
            a, e, w = mpf(tau), mpf(drag), mpf(start)
            scale, speed = mpmath.sqrt(a / e), mpmath.sqrt(a * e)
            last = scale * mpmath.tanh(speed * mpf(t) - mpmath.atan(-w / scale))
            exact = (a - e * last**2) / (a + e * w**2)
        worst = max(worst, float(abs(found - exact) / exact))
    assert worst < 1e-12


# Random motions: derivatives do not depend on where the steps end.

MANY = 2_000
CUTS = 60


class Case(NamedTuple):
    """A motion under a sum of terms."""

    body: RigidBody
    omega: np.ndarray
    attitude: Rotation
    load: Any
    time: float
    about: Literal["origin", "center_of_mass"]

    def sensitivity(self, *more: Any) -> MotionSensitivity:
        """Derivatives at a third of the time and at its end, under further loads too."""
        times = [0.0, self.time / 3, self.time]
        load = sum(more, self.load)
        run = self.body.simulate(
            times, self.omega, self.attitude, load=load, about=self.about, method="taylor"
        )
        return run.sensitivity()


def random_case(rng: np.random.Generator) -> Case:
    """A body of any class, free or pivoted, under one to three terms, some of them scaled or switched."""
    pivoted = bool(rng.integers(2))
    unit = 10.0 ** rng.uniform(-8, 8) if rng.random() < 0.3 else 1.0
    moments = [(1.0, 1.3, 1.9), (0.7, 0.7, 1.2), (0.6, 1.1, 1.1), (1.0, 1.0, 1.0), (0.5, 1.5, 1.9)]
    body = RigidBody.from_principal(
        float(rng.uniform(0.5, 3)) * unit,
        np.array(moments[rng.integers(5)]) * unit,
        center_of_mass=rng.normal(size=3) * 0.1 if pivoted else (0, 0, 0),
        axes=Rotation.random(random_state=rng).as_matrix(),
    )
    omega = rng.normal(size=3) * rng.choice([0.1, 1.0, 5.0])
    kinds = rng.integers(0, 7, rng.integers(1, 4)).tolist()
    # Backward in time damping drives a body without end.
    way = 1 if {3, 4} & set(kinds) else rng.choice([1, -1])
    time = float(rng.uniform(1, 15)) / max(float(np.linalg.norm(omega)), 0.5) * way
    ends = min(0.0, time), max(0.0, time)

    def gain(size: float) -> np.ndarray:
        root = rng.normal(size=(3, 3))
        return size * unit * (root @ root.T)

    def term(kind: int) -> Any:
        frame: Literal["body", "space"] = "body" if rng.random() < 0.5 else "space"
        vector = rng.normal(size=3) * 0.5 * unit
        target = Rotation.random(random_state=rng)
        if kind == 0:
            return loads.constant_torque(vector, frame=frame)
        if kind == 1:
            return loads.constant_force(vector, frame=frame, point=rng.normal(size=3))
        if kind == 2:
            return loads.uniform_gravity(rng.normal(size=3))
        if kind == 3:
            return loads.damping(gain(0.05), gain(0.05) if rng.random() < 0.6 else None)
        if kind == 4:
            return loads.feedback(gain(0.5), gain(0.1), target=target)
        if kind == 5 and not pivoted:
            place = target.apply((rng.uniform(0.7, 3), 0, 0))
            velocity = rng.normal(size=3) * rng.uniform(0.2, 1.2)
            epoch = float(rng.choice([0.0, -0.5, -40.0]))
            return loads.gravity_gradient(float(rng.uniform(0.3, 2)), place, velocity, epoch=epoch)
        knots = np.sort([ends[0] - 1e-3, *rng.uniform(*ends, rng.integers(6)), ends[1] + 1e-3])
        return loads.sampled(knots, rng.normal(size=(len(knots), 3)) * 0.3 * unit, frame=frame)

    load: Any = None
    for kind in kinds:
        made = term(kind)
        if rng.random() < 0.3:
            made = made * float(rng.uniform(0.1, 2))
        if rng.random() < 0.3:
            made = loads.schedule(made, [tuple(np.sort(rng.uniform(*ends, 2)))])
        load = made if load is None else load + made
    return Case(
        body, omega, Rotation.random(random_state=rng), load, time, "origin" if pivoted else "center_of_mass"
    )


def parts(found: MotionSensitivity, terms: int) -> list[np.ndarray]:
    """All derivatives, kind by kind; those by the load for its first terms."""
    own = [found.state, found.moments, found.products, found.center_of_mass, found.mass]
    return own + [by for term in found.load[:terms] for by in term.values()]


def excess(case: Case) -> float:
    """How much cutting the steps changes the derivatives, over what rounding may."""
    times = np.linspace(min(0.0, case.time), max(0.0, case.time), 2 * CUTS + 1)[1:]
    windows = list(zip(times[::2].tolist(), times[1::2].tolist(), strict=True))
    nothing = loads.schedule(loads.constant_torque((0, 0, 0)), windows)
    whole = case.sensitivity()
    cut = case.sensitivity(nothing)
    terms = len(whole.load)
    allowed = 2e-12 + 4e-15 * float(np.linalg.norm(whole.state))
    return max(
        float(np.linalg.norm(a - b)) / (allowed * max(float(np.linalg.norm(a)), 1e-300))
        for a, b in zip(parts(whole, terms), parts(cut, terms), strict=True)
    )


def worst(runs: int, seed: int) -> tuple[float, int]:
    """The largest excess, and how many motions could go on to their end."""
    rng = np.random.default_rng(seed)
    largest, done = 0.0, 0
    for _ in range(runs):
        case = random_case(rng)
        try:
            largest = max(largest, excess(case))
        except IntegrationError:  # a feedback that holds the body where its sign changes
            continue
        done += 1
    return largest, done


@pytest.mark.parametrize("runs", [30, pytest.param(60, marks=pytest.mark.long)])
def test_steps_may_end_anywhere(runs: int) -> None:
    largest, done = worst(runs, 20261122)
    assert done > 0.9 * runs
    assert largest <= 1.0


@pytest.mark.long
def test_steps_may_end_anywhere_in_many_motions() -> None:
    largest, done = worst(MANY, 1)
    assert done > 0.9 * MANY
    assert largest <= 1.0
