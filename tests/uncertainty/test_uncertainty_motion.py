"""Sigmas of motions, periods, modes and ranks of axes against draws of bodies and starts."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import polhode
import pytest
from oracles.drawn_motion import attitude_changes, moved
from oracles.matter_models import Node, Quantity, ten_numbers
from oracles.textbook_shapes import FLOATS
from oracles.uncertain_cases import case
from oracles.uncertainty import Drawn, Sources, drawn, values
from polhode import Uncertain, loads, solids
from polhode.uncertainty import axis_probabilities, mode_probabilities
from polhode.uncertainty.probabilities import both_positive
from scipy.spatial.transform import Rotation
from scipy.special import ellipk
from scipy.stats import multivariate_normal
from uncertain_bodies import Bodies, RigidBody, symmetric

START = Rotation.from_rotvec([0.4, -0.2, 0.9])


def by_draws(
    node: Node, omega: Quantity, turn: Quantity, time: float, torque: Any, drag: float, n: int
) -> Drawn:
    """Sigmas of (δ, ω) at a time."""
    sources = Sources(node, omega, turn)

    def states(z: Any) -> tuple[Any, Any]:
        of, count = sources.draws(z), z.shape[1]
        numbers = [np.broadcast_to(np.asarray(x, float), count) for x in ten_numbers(node.matter(of, FLOATS))]
        tensors = np.array([symmetric(six) for six in np.array(numbers[4:]).T])
        w = np.array([np.broadcast_to(x, count) for x in of(omega)])
        angles = np.array([np.broadcast_to(x, count) for x in of(turn)])
        q = (Rotation.from_rotvec(angles.T) * START).as_quat().T
        return moved(tensors, w, q, time, torque, drag, int(50 * time) + 1)

    _, nominal = states(np.zeros((sources.count, 1)))

    def outputs(z: Any) -> Any:
        w, q = states(z)
        return np.vstack([attitude_changes(nominal[:, 0], q), w]).T

    return drawn(outputs, sources.count, n, 3)


def spun(seed: int, share: float) -> tuple[Node, Quantity, Quantity]:
    """A body, rates about its principal axes that are far from the separatrix, and a start with sigmas."""
    node = case("given", seed)
    rng = np.random.default_rng(seed)
    rates = values(node)[1] @ (np.array([0.2, 0.3, 1.5]) * rng.uniform(0.8, 1.2, 3))
    omega = Quantity(rates, share * np.diag(rng.uniform(0.5, 1, 3)), (3,))
    return node, omega, Quantity(np.zeros(3), share * np.diag(rng.uniform(0.5, 1, 3)), (3,))


def started(omega: Quantity, turn: Quantity) -> dict[str, Any]:
    assert omega.factor is not None
    assert turn.factor is not None
    return {
        "omega": Uncertain(omega.value, np.diag(omega.factor)),
        "attitude": Uncertain(START, np.diag(turn.factor)),
    }


def compared(body: Any, drawn_: Drawn, run: Any) -> None:
    sigma = np.sqrt(np.diagonal(run.covariance[-1]))
    assert sigma == pytest.approx(np.concatenate([run.sigma.attitude[-1], run.sigma.omega[-1]]), rel=1e-12)
    linear = drawn_.departure < 0.01
    assert linear.sum() >= 4  # what is compared is nearly all
    assert (np.abs(sigma / drawn_.sigma - 1) <= 0.01 + 3 * drawn_.error / drawn_.sigma)[linear].all()
    assert sigma == pytest.approx(drawn_.first_order, rel=0.01), body


class TestRuns:
    @pytest.mark.parametrize("seed", [1, 2, 4])
    def test_free(self, seed: int) -> None:
        node, omega, turn = spun(seed, 0.002)
        body = Bodies().body(node)
        run = body.simulate([0.0, 6.0], **started(omega, turn))
        compared(body, by_draws(node, omega, turn, 6.0, np.zeros(3), 0.0, 1000), run)

    @pytest.mark.parametrize("seed", [1, 2, 4])
    def test_driven_and_damped(self, seed: int) -> None:
        node, omega, turn = spun(seed, 0.002)
        body = Bodies().body(node)
        size = float(np.trace(body.inertia))
        torque, drag = 0.05 * size * np.array([1.0, -0.5, 0.2]), 0.01 * size
        load = loads.constant_torque(torque) + loads.damping(drag * np.eye(3))
        run = body.simulate([0.0, 4.0], **started(omega, turn), load=load)
        compared(body, by_draws(node, omega, turn, 4.0, torque, drag, 1000), run)

    def test_the_start_alone(self) -> None:
        """Without a sigma of the body, and with one number for both."""
        body = RigidBody(2.0, np.diag([3.0, 4.0, 5.0]))
        assert body.simulate([0.0, 1.0], (0.1, 0.2, 1.0)).covariance is None
        run = body.simulate([0.0, 1.0], Uncertain((0.1, 0.2, 1.0), 0.01))
        assert run.sigma.omega[0] == pytest.approx([0.01] * 3, rel=1e-14)
        assert run.sigma.attitude[0] == pytest.approx([0.0] * 3, abs=1e-16)
        assert run.sigma.attitude[1].min() > 0.005

    def test_mass_turns_no_free_body(self) -> None:
        body = RigidBody(Uncertain(2.0, 0.1), np.diag([3.0, 4.0, 5.0]), Uncertain((1.0, 0.0, 0.0), 0.1))
        run = body.simulate([0.0, 3.0], (0.1, 0.2, 1.0))
        assert run.covariance is not None
        assert np.abs(run.covariance).max() < 1e-28


class TestLinear:
    """What is not flagged is right within a percent; of what is flagged at least half is not."""

    @pytest.mark.parametrize("seeds", [(1, 2), pytest.param((1, 2, 4), marks=pytest.mark.long)])
    def test_against_draws(self, seeds: tuple[int, ...]) -> None:
        outputs = flagged = rightly = 0
        for seed in seeds:
            for share, time in ((0.002, 6.0), (0.01, 6.0), (0.03, 4.0), (0.06, 4.0)):
                node, omega, turn = spun(seed, share)
                body = Bodies(label=f"linear {seed}").body(node)
                run = body.simulate([0.0, time], **started(omega, turn))
                by_draw = by_draws(node, omega, turn, time, np.zeros(3), 0.0, 1000)
                sigma = np.concatenate([run.sigma.attitude[-1], run.sigma.omega[-1]])
                linear = np.concatenate([run.sigma.linear.attitude[-1], run.sigma.linear.omega[-1]])
                off = np.abs(sigma / by_draw.sigma - 1)
                assert (off <= 0.01 + 3 * by_draw.error / by_draw.sigma)[linear].all(), (seed, share, off)
                outputs, flagged = outputs + 6, flagged + int((~linear).sum())
                rightly += int((off > 0.01)[~linear].sum())
        print(outputs, flagged, rightly)
        assert 0 < flagged < outputs
        assert 2 * rightly >= flagged

    def test_of_a_stack_with_a_load_of_each(self) -> None:
        stack = RigidBody.from_principal(1.0, [(1.0, 2.0, 2.5), (1.0, 1.9, 2.6)]).with_sigma(
            inertia=1e-4 * np.eye(3), source="scale"
        )
        push = loads.constant_torque([(0.0, 0.0, 1e-3), (0.0, 1e-3, 0.0)])
        times, omega = [0.0, 3.0, 1000.0], Uncertain((0.3, 0.2, 1.1), 1e-3, source="gyro")
        found = stack.simulate(times, omega, load=push).sigma.linear
        assert found.attitude.shape == found.omega.shape == (2, 3, 3)
        alone = stack[1].simulate(times, omega, load=loads.constant_torque((0.0, 1e-3, 0.0))).sigma.linear
        assert np.array_equal(found.attitude[1], alone.attitude)
        assert found.attitude[:, :2].all()
        assert not found.attitude[1, 2].any()

    def test_sigmas_by_themselves_do_not_know(self) -> None:
        run = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5)).simulate(
            [0.0, 1.0], Uncertain((0.1, 0.2, 1.0), 0.01)
        )
        alone = run.sigma._replace(omega=run.sigma.omega)
        with pytest.raises(ValueError, match="not of a motion"):
            _ = alone.linear


# Free motions and tops: periods, modes and ranks of axes, against draws by SciPy and NumPy.

BRICK: Any = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
SPIN = np.array([0.3, 0.2, 1.1])
WEIGHT = (0.0, 0.0, -9.81)


def rotation_period(moments: Any, omega: Any) -> Any:
    """4 K/Ω of the short-axis mode (Landau and Lifshitz, Mechanics, §37)."""
    one, two, three = moments.T
    L2, T2 = ((moments * omega) ** 2).sum(axis=1), (moments * omega**2).sum(axis=1)
    rate = np.sqrt((three - two) * (L2 - T2 * one) / (one * two * three))
    return 4 * ellipk((two - one) * (T2 * three - L2) / ((three - two) * (L2 - T2 * one))) / rate


def drawn_motions(n: int, sigma_moments: float, sigma_omega: float, seed: int) -> tuple[Any, Any]:
    rng = np.random.default_rng(seed)
    moments = np.array([1.0, 2.0, 2.5]) + sigma_moments * rng.normal(size=(n, 3))
    return moments, SPIN + sigma_omega * rng.normal(size=(n, 3))


class TestPeriods:
    def test_against_draws(self) -> None:
        body = BRICK.with_sigma(inertia=0.004 * np.eye(3))
        periods = body.free_motion(Uncertain(SPIN, 0.003)).periods
        found: Any = periods.sigma
        by_draws = rotation_period(*drawn_motions(40_000, 0.004, 0.003, 1))
        assert periods.rotation == pytest.approx(
            float(rotation_period(*drawn_motions(1, 0.0, 0.0, 1))[0]), rel=1e-12
        )
        assert found.rotation == pytest.approx(by_draws.std(), rel=0.015)
        assert np.isnan(found.flip)  # its intermediate axis does not turn over
        assert not found.linear.flip
        flips: Any = body.free_motion(Uncertain((0.1, 1.0, 0.3), 0.003)).periods
        assert flips.sigma.flip == flips.sigma.rotation / 2 > 0.0
        assert found.linear.rotation
        assert found.linear.rates.all()

    def test_of_a_stack_row_by_row(self) -> None:
        bodies = RigidBody.from_principal(1.0, [(1.0, 2.0, 2.5), (1.0, 1.5, 2.2)]).with_sigma(
            inertia=0.002 * np.eye(3), source="scale"
        )
        omega = Uncertain([[SPIN], [1.1 * SPIN], [1.2 * SPIN]], 0.002, source="gyro")
        motions = bodies.free_motion(omega)
        found: Any = motions.periods.sigma
        assert found.rotation.shape == found.linear.flip.shape == (3, 2)
        assert found.rates.shape == (3, 2, 3)
        alone: Any = bodies[1].free_motion(Uncertain(1.1 * SPIN, 0.002, source="gyro")).periods.sigma
        assert found.rotation[1, 1] == pytest.approx(alone.rotation, rel=1e-6)

    def test_near_the_separatrix_the_first_order_is_not_enough(self) -> None:
        periods = BRICK.free_motion(Uncertain((0.01, 1.0, 0.01), 0.005)).periods
        assert not periods.sigma.linear.rotation
        still = BRICK.free_motion(Uncertain((0.0, 1.0, 0.0), 0.005)).periods
        assert np.isnan(still.sigma.rotation)
        assert not still.sigma.linear.rotation

    def test_of_a_steady_spin_and_of_a_symmetric_body(self) -> None:
        """What is beside them has another mode, and the periods are continuous: against their formulas."""
        rng = np.random.default_rng(2).normal(size=(40_000, 3))
        a, b, c = (BRICK.principal_moments + 0.004 * rng).T
        body = BRICK.with_sigma(inertia=0.004 * np.eye(3))
        steady = body.free_motion(Uncertain((0.0, 0.0, 1.1), (0.0, 0.0, 0.003))).periods
        speed = 1.1 + 0.003 * np.random.default_rng(3).normal(size=40_000)
        assert steady.sigma.turn == pytest.approx(np.std(2 * np.pi / speed), rel=0.015)
        wobble = 2 * np.pi / speed / np.sqrt((c - a) * (c - b) / (a * b))
        assert steady.sigma.wobble == pytest.approx(np.std(wobble), rel=0.02)
        assert steady.sigma.linear.turn
        assert np.isnan([steady.sigma.rotation, steady.sigma.precession, steady.sigma.flip]).all()
        coin = RigidBody.from_principal(1.0, (1.0, 1.0, 1.5))
        top = coin.free_motion(Uncertain((0.3, 0.0, 1.0), (0.002, 0.0, 0.003))).periods
        x, z = (mean + sigma * n for mean, sigma, n in ((0.3, 0.002, rng[:, 0]), (1.0, 0.003, rng[:, 1])))
        assert top.sigma.spin == pytest.approx(np.std(4 * np.pi / z), rel=0.015)
        assert top.sigma.precession == pytest.approx(np.std(2 * np.pi / np.hypot(x, 1.5 * z)), rel=0.015)
        assert np.isnan(top.sigma.rotation)

    def test_nothing_uncertain_has_no_sigma(self) -> None:
        periods = BRICK.free_motion(SPIN).periods
        assert periods.sigma is None
        *_, rotation, precession, flip, rates = periods
        assert rotation == periods.rotation
        assert np.isnan(flip)
        uncertain = BRICK.free_motion(Uncertain(SPIN, 0.01)).periods
        assert np.array_equal(rates, uncertain.rates)
        again = pickle.loads(pickle.dumps(uncertain))
        assert again.sigma.precession == uncertain.sigma.precession
        assert precession == again.precession


class TestStarts:
    """A closed form is as uncertain as the run that integrates the same motion."""

    TIMES = np.array([0.0, 0.7, 2.0])

    def test_free(self) -> None:
        body = BRICK.with_sigma(inertia=0.01 * np.eye(3), source="scale")
        start: Any = (
            Uncertain(SPIN, 0.01, source="gyro"),
            Uncertain(START, (0.01, 0.02, 0.03), source="camera"),
        )
        motion = body.free_motion(*start)
        assert motion.uncertain_start == start
        run = body.simulate(self.TIMES, *start, method="dop853", rtol=1e-12)
        assert motion.at(self.TIMES).covariance == pytest.approx(run.covariance, rel=1e-6, abs=1e-11)
        assert pickle.loads(pickle.dumps(motion)).uncertain_start[0].source == "gyro"
        assert BRICK.free_motion(SPIN).uncertain_start == (None, None)

    def test_heavy(self) -> None:
        top = solids.cone(0.5, 1.0, mass=Uncertain(2.0, 0.01)).translated((0.0, 0.0, 0.75))
        spin = Uncertain((0.1, 0.2, 20.0), 0.05)
        motion: Any = top.heavy_top(spin, START, WEIGHT)
        run = top.simulate(
            self.TIMES,
            spin,
            START,
            load=polhode.loads.uniform_gravity(WEIGHT),
            about="origin",
            rtol=1e-12,
        )
        assert motion.at(self.TIMES).covariance == pytest.approx(run.covariance, rel=1e-5, abs=1e-9)
        assert pickle.loads(pickle.dumps(motion)).uncertain_start[0].value.tolist() == [0.1, 0.2, 20.0]

    def test_numbers_in_a_list(self) -> None:
        rate = Uncertain(1.1, 0.01)
        run: Any = BRICK.simulate([0.0, 1.0], [0.3, 0.2, rate])
        assert run.sigma.omega[0] == pytest.approx([0.0, 0.0, 0.01], abs=1e-17)
        assert BRICK.free_motion([0.3, 0.2, rate]).at([0.0, 1.0]).sigma.omega[1] == pytest.approx(
            run.sigma.omega[1], rel=1e-7
        )


class TestProbabilities:
    def test_modes_against_draws(self) -> None:
        omega = np.array([0.9, 0.6, 0.78])
        body = BRICK.with_sigma(inertia=0.03 * np.eye(3))
        found = mode_probabilities(body.free_motion(Uncertain(omega, 0.02)))
        rng = np.random.default_rng(5)
        moments = np.array([1.0, 2.0, 2.5]) + 0.03 * rng.normal(size=(200_000, 3))
        rates = omega + 0.02 * rng.normal(size=(200_000, 3))
        L2, T2 = ((moments * rates) ** 2).sum(axis=1), (moments * rates**2).sum(axis=1)
        short_axis = float((T2 * moments[:, 1] < L2).mean())
        assert 0.05 < short_axis < 0.95
        assert found.short_axis == pytest.approx(short_axis, abs=0.01)
        assert found.short_axis + found.long_axis == pytest.approx(1.0, abs=1e-15)
        stack = mode_probabilities(BRICK.free_motion(Uncertain([omega, SPIN], 0.01)))
        assert stack.short_axis.shape == stack.linear.shape == (2,)

    def test_ranks_against_draws(self) -> None:
        body = RigidBody.from_principal(5.0, (1.0, 1.03, 1.05)).rotated(START)
        sigma = 0.02 * np.eye(3) + 0.004
        found = axis_probabilities(body.with_sigma(inertia=sigma))
        rng = np.random.default_rng(6)
        changes = rng.normal(size=(200_000, 3, 3)) * sigma
        changes = np.triu(changes) + np.swapaxes(np.triu(changes, 1), 1, 2)
        own = body.principal.axes
        moments = body.principal.moments + np.einsum("ik,nij,jk->nk", own, changes, own)
        ranks = np.argsort(np.argsort(moments, axis=1), axis=1)
        for rank, name in enumerate(("least", "intermediate", "greatest")):
            assert getattr(found, name) == pytest.approx((ranks == rank).mean(axis=0), abs=0.004)
        total = np.array(found.least) + found.intermediate + found.greatest
        assert total == pytest.approx(np.ones(3), abs=1e-13)
        assert found.stable == pytest.approx(1 - found.intermediate, abs=0)

    def test_equal_moments_and_known_ones(self) -> None:
        top = RigidBody.from_principal(1.0, (1.0, 2.0, 2.0))
        known = axis_probabilities(top.with_sigma(mass=0.1))
        assert known.least.tolist() == [1.0, 0.0, 0.0]
        assert known.intermediate.tolist() == known.greatest.tolist() == [0.0, 0.5, 0.5]
        noisy = axis_probabilities(top.with_sigma(inertia=0.01 * np.eye(3)))
        assert noisy.greatest == pytest.approx([0.0, 0.5, 0.5], abs=1e-12)
        stack = axis_probabilities(RigidBody.stack([top, BRICK]).with_sigma(inertia=0.01 * np.eye(3)))
        assert stack.stable.shape == (2, 3)
        with pytest.raises(ValueError, match="covariance"):
            axis_probabilities(BRICK)

    def test_two_numbers_positive_against_scipy(self) -> None:
        rng = np.random.default_rng(7)
        for _ in range(60):
            k = int(rng.integers(1, 4))
            slopes = rng.normal(size=(2, k)) * 10 ** rng.uniform(-3, 3, size=(2, 1))
            means = np.linalg.norm(slopes, axis=1) * rng.normal(size=2) * 2
            covariance = slopes @ slopes.T
            scale = np.sqrt(np.diag(covariance))
            correlation = covariance / np.outer(scale, scale)
            expected = multivariate_normal.cdf(means / scale, np.zeros(2), correlation, allow_singular=True)
            found = both_positive((means[0], means[1]), (slopes[0], slopes[1]))
            assert found == pytest.approx(float(expected), abs=2e-5 if k == 1 else 1e-7)

    @pytest.mark.parametrize("apart", [0.0, 0.9e-14, 1.1e-14, 1e-9, 1e-6, 1e-3])
    def test_nearly_one_number_twice(self, apart: float) -> None:
        one, other = np.array([1.0, 0.0]), np.array([np.cos(apart), np.sin(apart)])
        assert both_positive((0.3, 0.5), (one, other)) == pytest.approx(
            0.6179114221889526, abs=1e-3 * apart + 1e-12
        )
        opposite = both_positive((0.3, 0.5), (one, -other))
        assert opposite == pytest.approx(0.6179114221889526 - 0.3085375387259869, abs=apart + 1e-12)

    def test_far_away(self) -> None:
        one, other = np.array([1.0, 0.0]), np.array([0.6, 0.8])
        assert both_positive((40.0, 50.0), (one, other)) == pytest.approx(1.0, abs=1e-13)
        assert both_positive((-40.0, 50.0), (one, other)) == 0.0


class TestTwins:
    def test_of_principal_axes(self) -> None:
        body = BRICK.with_sigma(mass=0.01, center_of_mass=(0.01,) * 3, inertia=0.01 * np.eye(3) + 0.001)
        twin, whole = body.principal.sigma, body.sigma
        assert twin is not None
        assert whole is not None
        assert np.array_equal(twin.moments, whole.principal_moments)
        assert np.array_equal(twin.axes, whole.axes)
        assert np.array_equal(twin.linear.moments, whole.linear.principal_moments)
        assert BRICK.principal.sigma is None
        assert body.principal.canonical().sigma is twin or body.principal.canonical().sigma is not None
        assert np.array_equal(body.sigma_about("center_of_mass").inertia, whole.inertia)

    def test_about_a_point_against_draws(self) -> None:
        centre, sigma = np.array([0.2, -0.1, 0.4]), np.array([0.01, 0.02, 0.015])
        elements = 0.01 * np.eye(3) + 0.002
        plain = RigidBody(1.5, np.diag([1.0, 2.0, 2.5]), centre)
        body = plain.with_sigma(mass=0.02, center_of_mass=sigma, inertia=elements)
        point = np.array([1.0, 0.5, -0.3])
        rng = np.random.default_rng(8)
        n = 40_000
        changes = np.triu(rng.normal(size=(n, 3, 3)) * elements)
        changes += np.swapaxes(np.triu(changes, 1), 1, 2)
        d = centre + sigma * rng.normal(size=(n, 3)) - point
        m = 1.5 + 0.02 * rng.normal(size=n)
        steiner = (d**2).sum(axis=1)[:, None, None] * np.eye(3) - d[:, :, None] * d[:, None, :]
        tensors = np.diag([1.0, 2.0, 2.5]) + changes + m[:, None, None] * steiner
        found = body.sigma_about(point)
        assert found.inertia == pytest.approx(tensors.std(axis=0), rel=0.015)
        moments = np.linalg.eigvalsh(tensors)
        assert found.principal_moments == pytest.approx(moments.std(axis=0), rel=0.015)
        assert found.radii_of_gyration == pytest.approx(np.sqrt(moments / m[:, None]).std(axis=0), rel=0.015)
        assert body.principal_about(point).sigma.moments == pytest.approx(found.principal_moments, rel=1e-15)
        assert plain.sigma_about(point) is None
        stack = RigidBody.stack([body, body]).sigma_about([[point], [0 * point]])
        assert stack.principal_moments.shape == (2, 2, 3)
