"""Where the first order fails it is said, and where it holds nothing else is: cases with closed answers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from polhode import Uncertain
from polhode.uncertainty import mode_probabilities, propagate
from scipy.spatial.transform import Rotation
from uncertain_bodies import RigidBody, solids
from uncertainties import ufloat

if TYPE_CHECKING:
    from pathlib import Path

TILT = Rotation.from_euler("xyz", [0.3, 0.4, 0.5])


class TestThirdOrder:
    """Terms of third order, which no probe sees, are reckoned with."""

    @pytest.mark.parametrize("s", [0.01, 0.03, 0.1, 0.15, 0.3, 1.0])
    def test_of_a_body_that_is_turned(self, s: float) -> None:
        """I_xy = −½ sin 2θ and c_y = sin θ, of a normal θ."""
        turned = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5), center_of_mass=(1, 0, 0)).rotated(
            Uncertain(Rotation.identity(), covariance=np.diag([0.0, 0.0, s * s]))
        )
        product = 0.5 * np.sqrt((1 - np.exp(-8 * s * s)) / 2)
        side = np.sqrt((1 - np.exp(-2 * s * s)) / 2)
        sigma = turned.sigma
        for found, right, linear in (
            (sigma.inertia[0, 1], product, sigma.linear.inertia[0, 1]),
            (sigma.center_of_mass[1], side, sigma.linear.center_of_mass[1]),
        ):
            off = abs(found / right - 1)
            assert off <= 0.011 or not linear, (found, right)
            assert linear or off >= 0.004

    @pytest.mark.parametrize("s", [0.02, 0.06, 0.1, 0.12, 0.15, 0.17])
    def test_of_a_quotient(self, s: float) -> None:
        """c_x = M/(1 + M), by Gauss and Hermite."""
        z, w = np.polynomial.hermite_e.hermegauss(60)
        values = (1 + s * z) / (2 + s * z)
        right = np.sqrt((w @ values**2) / w.sum() - ((w @ values) / w.sum()) ** 2)
        pair = RigidBody.from_particles([1.0, Uncertain(1.0, s)], [[0, 0, 0], [1.0, 0, 0]])
        off = abs(pair.sigma.center_of_mass[0] / right - 1)
        assert off <= 0.011 or not pair.sigma.linear.center_of_mass[0]
        assert pair.sigma.linear.center_of_mass[0] or off > 0.004


class TestPlain:
    def test_a_common_factor_turns_no_axes(self) -> None:
        box = solids.box((1, 2, 3.0), mass=5.0).rotated(TILT)
        for body in (
            box.scaled(mass=Uncertain(1.0, 0.01)),
            box.scaled(length=Uncertain(1.0, 0.005)),
            solids.box(Uncertain((1, 2, 3.0), 0.001), mass=1.0).rotated(TILT),
        ):
            assert body.sigma.axes.max() < 1e-15
            assert body.sigma.linear.axes.all()

    def test_a_rotation_changes_no_moments(self) -> None:
        sigma = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5)).rotated(Uncertain(TILT, 0.001)).sigma
        assert sigma.principal_moments.max() < 1e-15
        assert sigma.linear.principal_moments.all()
        assert sigma.linear.radii_of_gyration.all()
        assert sigma.linear.axes.all()


class TestFunctions:
    def test_numbers_of_any_size_side_by_side(self) -> None:
        x, y = Uncertain(1.0, 1.0), Uncertain(1.0, 1.0)
        found = propagate(lambda x, y: np.array([1e12 * x, y**2]), None, arguments=[x, y])
        assert found.linear.tolist() == [True, False]
        modulus, radius = Uncertain(2.1e11, 1e10), Uncertain(1e-3, 3e-4)
        both = propagate(lambda r, e: np.array([e, r**2]), None, arguments=[radius, modulus])
        assert both.linear.tolist() == [True, False]
        offset = propagate(lambda x: 1e3 + x**2, None, arguments=[Uncertain(1e-3, 1e-3)])
        assert not offset.linear

    def test_draws_of_a_ratio_that_the_mass_cancels_in(self) -> None:
        """Straight steps of the ten numbers do not cancel it: the draws are wrong, and it is said."""
        sides = np.array([1.0, 1.5, 2.2])
        for seed in range(6):
            box = solids.box(Uncertain(sides, 0.003 * sides), mass=Uncertain(1.0, 0.2))
            found = propagate(
                lambda b: b.inertia[0, 0] / b.inertia[2, 2], box, "monte-carlo", n=2000, seed=seed
            )
            rng = np.random.default_rng(seed)
            x, y, z = (sides * (1 + 0.003 * rng.normal(size=(100_000, 3)))).T
            right = float(((y * y + z * z) / (x * x + y * y)).std())
            assert abs(found.sigma / right - 1) < 0.05 or not found.linear

    def test_arguments_with_a_sigma_of_any_kind(self) -> None:
        assert propagate(lambda x: 2 * x, None, arguments=[ufloat(2.0, 0.1)]).sigma == pytest.approx(0.2)
        both = propagate(lambda x: x.sum(), None, arguments=[[Uncertain(2.0, 0.1), 3.0]])
        assert (both.value, both.sigma) == (5.0, pytest.approx(0.1))
        wrong: Any
        for wrong in ([2.0], [Uncertain(Rotation.identity(), 0.1)], Uncertain(2.0, 0.1), ["a"]):
            with pytest.raises(TypeError, match="arguments"):
                propagate(lambda x: x, None, arguments=wrong)

    def test_modes_where_nothing_is_at_stake(self) -> None:
        steady = RigidBody.from_principal(Uncertain(1.0, 0.1), (1, 2, 3.0)).free_motion((0, 1.0, 0))
        found = mode_probabilities(steady)
        assert np.isnan(found.short_axis)
        assert not found.linear
        none = RigidBody.stack([solids.cube(Uncertain(1.0, 0.1), mass=1.0)])[:0].free_motion((0, 0.1, 1.0))
        assert none.periods.sigma.rotation.shape == (0,)
        assert none.periods.sigma.rates.shape == (0, 3)
        assert mode_probabilities(none).short_axis.shape == (0,)


class TestRuns:
    @pytest.mark.parametrize("suffix", [".json", ".npz"])
    def test_from_files_that_do_not_hold_the_load(self, suffix: str, tmp_path: Path) -> None:
        weight = polhode.loads.uniform_gravity((0.0, 0.0, -9.81))
        box = solids.box(Uncertain((1.0, 2.0, 3.0), 0.01), mass=1.0).translated((0, 0, 1.0))
        file = tmp_path / f"run{suffix}"
        box.simulate([0.0, 0.5], (0.1, 0.2, 1.0), load=weight, about="origin").save(file)
        again = polhode.Trajectory.from_file(file)
        with pytest.raises(ValueError, match="was not saved"):
            _ = again.covariance
        free = box.simulate([0.0, 0.5], (0.1, 0.2, 1.0))
        free.save(file)
        kept: Any = polhode.Trajectory.from_file(file).covariance
        assert np.array_equal(kept, free.covariance)

    def test_nothing_is_known_after_the_end(self) -> None:
        def ends(t: float, *_: Any) -> float:
            return t - 0.5

        ends.terminal = True  # type: ignore[attr-defined]  # what SciPy's events carry
        box = solids.box(Uncertain((1, 2, 3.0), 0.01), mass=1.0)
        run = box.simulate([0.0, 0.25, 1.0], (0.1, 0.2, 1.0), events=ends)
        assert np.isnan(run.sigma.omega).any(axis=1).tolist() == [False, False, True]
        assert run.sigma.linear.omega.all(axis=1).tolist() == [True, True, False]
