"""Motions from uncertain periods or of uncertain bodies: against clones, each solved for by itself."""

from __future__ import annotations

import json
import pickle
from typing import Any

import numpy as np
import pytest
from command_line import run
from numpy.typing import NDArray
from polhode import RigidBody, Uncertain, flybys, orbits
from polhode.uncertainty import mode_probabilities, propagate
from scipy.spatial.transform import Rotation

Floats = NDArray[np.float64]

MOMENTS, PERIODS = np.array([0.61, 0.965, 1.0]), np.array([263.0, 27.38])
OF_MOMENTS, OF_PERIODS = np.array([0.006, 0.002, 0.001]), np.array([1.5, 0.05])
BODY: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, OF_MOMENTS))
KNOWN = RigidBody.from_principal(1.0, MOMENTS)


def clones(
    n: int, of_moments: Any = OF_MOMENTS, of_periods: Any = OF_PERIODS, seed: int = 3, **given: Any
) -> Any:
    """Motions of bodies and periods that are drawn by NumPy."""
    rng = np.random.default_rng(seed)
    bodies = RigidBody.from_principal(1.0, MOMENTS + np.asarray(of_moments) * rng.normal(size=(n, 3)))
    rotation, precession = (PERIODS + np.asarray(of_periods) * rng.normal(size=(n, 2))).T
    return bodies.free_motion_from_periods(rotation, precession, "short-axis", **given)


def periods() -> Any:
    return [Uncertain(value, sigma) for value, sigma in zip(PERIODS, OF_PERIODS, strict=True)]


def energy_sigma(motion: Any) -> float:
    """By `propagate`, the periods among its arguments where they are uncertain."""
    given = motion._from_periods

    def ratio(body: Any, *uncertain: Any) -> Any:
        values = iter(uncertain)
        both = [next(values) if isinstance(x, Uncertain) else x for x in given[:2]]
        return body.free_motion_from_periods(*both, mode=given.mode).energy_ratio

    return float(propagate(ratio, motion.body, arguments=given.uncertain).sigma)


class TestSigmas:
    def test_given_periods_have_no_sigma_of_their_own(self) -> None:
        """The moments alone are uncertain; angles, energy and rates are then, and the two periods are not."""
        motion = BODY.free_motion_from_periods(*PERIODS, mode="short-axis")
        sigma, drawn = motion.periods.sigma, clones(8_000, of_periods=0.0)
        assert (sigma.rotation, sigma.precession) == (0.0, 0.0)
        assert sigma.linear.rotation
        assert sigma.linear.precession
        assert energy_sigma(motion) == pytest.approx(np.std(drawn.energy_ratio), rel=0.035)
        assert sigma.rates == pytest.approx(drawn.periods.rates.std(axis=0), rel=0.035, abs=1e-12)
        assert np.isnan([sigma.turn, sigma.wobble, sigma.spin]).all()

    def test_uncertain_periods_keep_their_sigmas(self) -> None:
        rotation, precession = periods()
        motion: Any = BODY.free_motion_from_periods(rotation, precession, mode="short-axis")
        sigma, drawn = motion.periods.sigma, clones(8_000)
        assert (sigma.rotation, sigma.precession) == tuple(OF_PERIODS)
        assert energy_sigma(motion) == pytest.approx(np.std(drawn.energy_ratio), rel=0.035)
        assert sigma.rates == pytest.approx(drawn.periods.rates.std(axis=0), rel=0.035)
        alone: Any = KNOWN.free_motion_from_periods(rotation, PERIODS[1], mode="short-axis")
        assert (alone.periods.sigma.rotation, alone.periods.sigma.precession) == (OF_PERIODS[0], 0.0)

    def test_a_flip_has_half_the_sigma_of_the_rotation(self) -> None:
        toutatis = RigidBody.from_principal(1.0, Uncertain((1.0, 3.09, 3.22), 0.01))
        motion: Any = toutatis.free_motion_from_periods(Uncertain(5.41, 0.03), 7.35, mode="long-axis")
        assert motion.periods.sigma.flip == 0.015
        assert motion.periods.flip == pytest.approx(5.41 / 2)

    @pytest.mark.parametrize(
        ("moments", "mode"), [((0.5, 2.0, 2.0), "long-axis"), ((1.0, 1.0, 1.5), "short-axis")]
    )
    def test_the_spin_of_a_symmetric_body_is_the_given_rotation(self, moments: Any, mode: Any) -> None:
        body = RigidBody.from_principal(1.0, moments)
        motion: Any = body.free_motion_from_periods(Uncertain(10.0, 0.02), Uncertain(4.0, 0.01), mode=mode)
        sigma = motion.periods.sigma
        assert sigma.spin == 0.02
        # That of the symmetry axis: 1/P_φ, and for the third axis 1/P_φ + 1/P_ψ.
        exact = 0.01 if mode == "long-axis" else np.hypot(0.02 / 100.0, 0.01 / 16.0) / (1 / 10 + 1 / 4) ** 2
        assert sigma.precession == pytest.approx(exact, rel=1e-6)

    def test_of_a_stack_row_by_row(self) -> None:
        rotation = Uncertain([263.0, 300.0], [1.0, 2.0])
        stack: Any = BODY.free_motion_from_periods(
            rotation, [[27.38], [27.0]], "short-axis", phase=[0.1, 0.2]
        )
        assert stack.shape == (2, 2)
        assert stack.periods.sigma.rotation.tolist() == [[1.0, 2.0]] * 2
        alone: Any = BODY.free_motion_from_periods(Uncertain(300.0, 2.0), 27.0, "short-axis", phase=0.2)
        assert stack.periods.sigma.rates[1, 1] == pytest.approx(alone.periods.sigma.rates, rel=1e-9)
        run_ = stack.at([0.0, 50.0])
        np.testing.assert_allclose(
            run_.covariance[1, 1], alone.at([0.0, 50.0]).covariance, rtol=1e-6, atol=1e-14
        )

    def test_the_mode_was_given_and_is_certain(self) -> None:
        found = mode_probabilities(BODY.free_motion_from_periods(*periods(), mode="short-axis"))
        assert (found.long_axis, found.short_axis, found.linear) == (0.0, 1.0, True)

    def test_near_the_reach_of_the_mode_steps_are_shorter(self) -> None:
        """One deviation off no motion has this ratio; the derivative is there, but the first order lacks."""
        wide: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, (0.05, 0.0, 0.0)))
        motion: Any = wide.free_motion_from_periods(6.7, 1.0, mode="short-axis")
        assert np.isfinite(motion.periods.sigma.rates).all()
        assert not motion.periods.sigma.linear.rates.any()
        assert motion.periods.sigma.rotation == 0.0

    def test_pickle_keeps_what_was_given(self) -> None:
        motion: Any = BODY.free_motion_from_periods(*periods(), mode="short-axis", phase=0.3)
        again = pickle.loads(pickle.dumps(motion))
        assert again.periods.sigma.rotation == OF_PERIODS[0]
        assert again.periods.sigma.rates.tolist() == motion.periods.sigma.rates.tolist()
        np.testing.assert_array_equal(again.at([0.0, 9.0]).covariance, motion.at([0.0, 9.0]).covariance)


@pytest.mark.parametrize("phase", [0.0, 0.37])
def test_start_and_states_against_clones(phase: float) -> None:
    """Angular velocity and attitude at t = 0 and later, with the correlations between them."""
    small, direction = 0.1, (0.3, -0.2, 1.0)
    body: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, small * OF_MOMENTS))
    both: Any = [Uncertain(value, small * s) for value, s in zip(PERIODS, OF_PERIODS, strict=True)]
    given: Any = {"phase": phase, "angular_momentum_direction": direction}
    motion = body.free_motion_from_periods(*both, mode="short-axis", **given)
    t = np.array([0.0, 20.0, 90.0])
    found = motion.at(t)
    states = clones(8_000, small * OF_MOMENTS, small * OF_PERIODS, **given).at(t)
    for k in range(3):
        back = Rotation.from_quat(found.quaternion[k]).inv()
        turned = (back * Rotation.from_quat(states.quaternion[:, k])).as_rotvec()
        drawn = np.cov(np.hstack([turned, states.omega[:, k]]), rowvar=False)
        size = np.sqrt(np.diagonal(drawn))
        known = size > 1e-10
        scale = np.outer(size, size)[np.ix_(known, known)]
        np.testing.assert_allclose(
            found.covariance[k][np.ix_(known, known)] / scale, drawn[np.ix_(known, known)] / scale, atol=0.04
        )
    assert motion.uncertain_start[0].sigma == pytest.approx(
        states.omega[:, 0].std(axis=0), rel=0.035, abs=1e-9
    )


def test_one_source_of_body_and_period_is_followed() -> None:
    """The same relative error of a moment and of the period: as one variable."""
    body: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, (0.006, 0.0, 0.0), source="lamp"))
    one: Any = body.free_motion_from_periods(Uncertain(263.0, 1.5, source="lamp"), 27.38, mode="short-axis")
    rng = np.random.default_rng(5).normal(size=8_000)
    moments = MOMENTS + np.outer(rng, [0.006, 0.0, 0.0])
    drawn = RigidBody.from_principal(1.0, moments).free_motion_from_periods(
        263.0 + 1.5 * rng, 27.38, "short-axis"
    )
    assert energy_sigma(one) == pytest.approx(np.std(drawn.energy_ratio), rel=0.035)
    assert one.uncertain_start[0].sigma == pytest.approx(drawn.omega.std(axis=0), rel=0.035, abs=1e-9)


def test_the_command_prints_them() -> None:
    words = (
        "spin", "--moments", "0.6100 ± 0.0012, 0.9650 ± 0.0004, 1.0000 ± 0.0002",
        "--periods", "263 h, 27.38 h", "--mode", "short-axis",
    )  # fmt: skip
    code, out, err = run(*words, "--format", "json")
    assert (code, err) == (0, "")
    told = json.loads(out)
    assert told["sigma"]["rotation_period"] == told["sigma"]["precession_period"] == 0.0
    drawn = clones(8_000, 0.2 * OF_MOMENTS, of_periods=0.0)
    assert told["sigma"]["energy_ratio"] == pytest.approx(np.std(drawn.energy_ratio), rel=0.035)
    assert told["sigma"]["modulus"] == pytest.approx(np.std(drawn.modulus), rel=0.035)
    angles = np.degrees(drawn.nutation).std(axis=0)
    for k in range(3):
        assert told["sigma"]["angle_from_L"][f"e{k + 1}"] == pytest.approx(angles[k], rel=0.05, abs=1e-9)
    with_sigmas = (*words[:4], "263.0 ± 1.5 h, 27.38(5) h", *words[5:], "--format", "json")
    told = json.loads(run(*with_sigmas)[1])
    assert told["sigma"]["rotation_period"] == pytest.approx(1.5 * 3600.0, rel=1e-12)
    assert told["sigma"]["precession_period"] == pytest.approx(0.05 * 3600.0, rel=1e-12)


class TestFlybys:
    ORBIT = orbits.from_elements(398600.4418, eccentricity=4.25, periapsis=38011.5, since_periapsis=-2.0e5)

    def flyby(self, body: Any, rotation: Any, precession: Any, **options: Any) -> flybys.Flyby:
        return flybys.flyby(
            body, self.ORBIT, 4.0e5, rotation_period=rotation, precession_period=precession,
            mode="short-axis", **options,
        )  # fmt: skip

    def test_each_clone_has_moments_and_periods_of_its_own(self) -> None:
        hour = 3600.0
        found = self.flyby(
            BODY, Uncertain(263.0 * hour, 1.5 * hour), Uncertain(27.38 * hour, 0.05 * hour), n=4000, seed=2
        )
        assert not found.failed.any()
        assert found.before.rotation_period.std() == pytest.approx(1.5 * hour, rel=0.05)
        assert found.before.rotation_period.mean() == pytest.approx(263.0 * hour, rel=1e-3)
        assert found.before.precession_period.std() == pytest.approx(0.05 * hour, rel=0.05)
        rates = clones(8_000).energy_ratio
        # 2 E/|L| in units of 2π/P_φ: what depends on the moments.
        share = found.before.spin_rate * found.before.precession_period
        drawn = clones(8_000)
        exact = (
            2.0
            * drawn.kinetic_energy().total
            / np.linalg.norm(drawn.angular_momentum().spin, axis=-1)
            * drawn.periods.precession
        )
        assert share.std() == pytest.approx(exact.std(), rel=0.06)
        assert rates.std() > 0.0

    def test_their_chunks_draw_the_same(self) -> None:
        given: Any = (BODY, Uncertain(9.5e5, 5e3), 98568.0)
        one, other = (self.flyby(*given, n=50, seed=4, chunk=chunk) for chunk in (50, 7))
        np.testing.assert_array_equal(one.spin_ratio, other.spin_ratio)
        np.testing.assert_array_equal(one.before.rotation_period, other.before.rotation_period)

    def test_clones_without_a_motion_fail_and_the_others_do_not(self) -> None:
        """A ratio near the least that the mode has: about half of the clones are beyond."""
        wide: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, (0.03, 0.0, 0.0)))
        found = self.flyby(wide, 6.65 * 98568.0, 98568.0, n=200)
        assert 20 < found.failed.sum() < 180
        assert np.isfinite(found.spin_ratio[~found.failed]).all()
        assert np.isnan(found.spin_ratio[found.failed]).all()
