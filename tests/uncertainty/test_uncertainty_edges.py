"""Both sides of the limits of uncertainty, bodies of any size, and runs that go on from uncertain ones."""

from __future__ import annotations

import pickle
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from polhode import Trajectory, Uncertain
from polhode.uncertainty import propagate
from scipy.spatial.transform import Rotation
from uncertain_bodies import RigidBody, laminae, solids

if TYPE_CHECKING:
    from pathlib import Path

START = Rotation.from_rotvec([0.4, -0.2, 0.9])
TENSOR = np.array([[3.0, 0.2, -0.1], [0.2, 4.0, 0.3], [-0.1, 0.3, 5.0]])
SPIN = np.array([0.2, -0.5, 1.1])


def uncertain_body() -> Any:
    return RigidBody(2.0, TENSOR, (0.1, 0.2, -0.3)).with_sigma(
        mass=0.01, center_of_mass=(0.01,) * 3, inertia=0.01 * (1 + np.eye(3)), source="scale"
    )


class TestLimits:
    @pytest.mark.parametrize(("sigma", "known"), [(0.99, True), (1.01, False)])
    def test_an_axis_that_may_point_anywhere_has_no_sigma(self, sigma: float, known: bool) -> None:
        body = RigidBody(1.0, np.diag([3.0, 4.0, 5.5]))
        elements = np.zeros((3, 3))
        elements[0, 1] = elements[1, 0] = sigma  # the gap is 1: so many radians
        found = body.with_sigma(inertia=elements).sigma
        assert np.isfinite(found.axes).tolist() == [True, True, known]
        assert not found.linear.axes[2]

    @pytest.mark.parametrize(("apart", "fits"), [(0.9e-12, True), (1.1e-12, False)])
    def test_covariances_are_symmetric_to_rounding(self, apart: float, fits: bool) -> None:
        P = 1e-20 * np.array([[4.0, 1.0], [1.0, 9.0]])
        P[0, 1] += apart * 6e-20
        if fits:
            assert Uncertain((1.0, 2.0), covariance=P).covariance == pytest.approx(P, rel=1e-11)
        else:
            with pytest.raises(ValueError, match="symmetric"):
                Uncertain((1.0, 2.0), covariance=P)

    @pytest.mark.parametrize(("share", "fits"), [(0.9e-9, True), (1.1e-9, False)])
    def test_a_lamina_has_no_thickness_beyond_rounding(self, share: float, fits: bool) -> None:
        disk = laminae.disk(1.0, mass=4.0)  # moments 1, 1, 2
        sigma = np.zeros((3, 3))
        sigma[0, 1] = sigma[1, 0] = 1e-3
        # Of the second moment along z, (I_xx + I_yy − I_zz)/2, relative to the deviation of the tensor.
        sigma[2, 2] = 2 * share * 1e-3
        if fits:
            assert disk.with_sigma(inertia=sigma).sigma.inertia[2, 2] == pytest.approx(2 * share * 1e-3)
        else:
            with pytest.raises(ValueError, match="no body"):
                disk.with_sigma(inertia=sigma)

    @pytest.mark.parametrize("exponent", [-156, -60, 60, 122])
    def test_sigmas_know_no_unit(self, exponent: int) -> None:
        """Masses from 1e-47 to 1e37 in powers of two: the same bits but for the power."""
        unit = 2.0**exponent

        def sigmas(mass: float) -> Any:
            body = RigidBody(2.0 * mass, mass * TENSOR, (0.1, 0.2, -0.3))
            return body.with_sigma(
                mass=0.1 * mass,
                center_of_mass=(0.01,) * 3,
                inertia=0.15 * mass * (1 + np.eye(3)),
                source="scale",
            ).sigma

        one, other = sigmas(1.0), sigmas(unit)
        assert not one.linear.principal_moments.all()
        for name, power in [
            ("mass", 1),
            ("center_of_mass", 0),
            ("inertia", 1),
            ("principal_moments", 1),
            ("axes", 0),
            ("radii_of_gyration", 0),
        ]:
            found, expected = np.asarray(getattr(other, name)) / unit**power, np.asarray(getattr(one, name))
            assert found == pytest.approx(expected, rel=4e-15), name
            assert np.array_equal(getattr(other.linear, name), getattr(one.linear, name)), name

    def test_no_direction_at_all(self) -> None:
        """Sigmas of zero: a covariance of zeros, of any function."""
        body = solids.sphere(Uncertain(1.0, 0.0), mass=2.0)
        for method in ("linear", "second-order"):
            found = propagate(
                lambda b: b.principal_moments, body, arguments=[Uncertain(1.0, 0.0)][:0], method=method
            )
            assert np.array_equal(found.covariance, np.zeros((3, 3)))


class TestWithoutExtent:
    """Where a moment is zero its radius of gyration is zero for ever; thin is not zero."""

    def test_of_a_dumbbell(self) -> None:
        body = RigidBody.from_particles(
            [Uncertain(1.0, 0.1), 2.0], [(0, 0, 0), Uncertain((1.0, 2.0, 3.0), 0.1)]
        )
        sigma = body.sigma
        assert sigma.radii_of_gyration[0] == 0.0
        assert sigma.principal_moments[0] < 1e-15
        assert sigma.linear.principal_moments[0]
        assert sigma.linear.radii_of_gyration[0]

    def test_of_particles_on_a_line_that_may_leave_it(self) -> None:
        """The least moment leaves zero by the second order of a length, and its radius by the first."""
        body = RigidBody.from_particles(
            (1.0, 2.0, 1.5), Uncertain(np.diag([0.0, 1.0, 2.0]) @ np.ones((3, 3)), 0.01)
        )
        sigma = body.sigma
        assert sigma.principal_moments[0] < 1e-15
        assert np.isnan(sigma.radii_of_gyration[0])
        assert not sigma.linear.principal_moments[0]
        assert not sigma.linear.radii_of_gyration[0]
        assert np.isfinite(sigma.radii_of_gyration[1:]).all()

    @pytest.mark.parametrize("radius", [1e-3, 1e-6, 1e-9, 1e-12])
    def test_of_a_wire(self, radius: float) -> None:
        wire = solids.cylinder(radius=Uncertain(radius, 0.01 * radius), height=1.0, mass=2.0)
        assert wire.sigma.radii_of_gyration[0] == pytest.approx(0.01 * wire.radii_of_gyration[0], rel=1e-6)
        assert wire.sigma.principal_moments[0] == pytest.approx(0.02 * wire.principal_moments[0], rel=1e-6)


class TestStarts:
    def test_a_run_that_goes_on_has_no_covariance_of_its_own(self) -> None:
        body = uncertain_body()
        run = body.simulate([0.0, 2.0], SPIN, START)
        assert run.covariance is not None
        for later in (
            run.resume([2.0, 4.0]),
            polhode.RigidBody(2.0, TENSOR).simulate([0.0, 2.0], Uncertain(SPIN, 0.01)).resume([2.0, 4.0]),
        ):
            assert later.uncertain_start is None
            for name in ("covariance", "sigma"):
                with pytest.raises(ValueError, match="the motion was resumed"):
                    getattr(later, name)
        certain = polhode.RigidBody(2.0, TENSOR).simulate([0.0, 2.0], SPIN).resume([2.0, 4.0])
        assert certain.covariance is None

    def test_closed_forms_that_do_not_start_at_zero(self) -> None:
        body = uncertain_body()
        motion = body.free_motion(SPIN)
        run = body.simulate([0.0, 5.0], SPIN)
        assert motion.at([0.0, 5.0]).covariance == pytest.approx(run.covariance, rel=1e-6, abs=1e-12)
        top = solids.cone(0.5, 1.0, mass=Uncertain(2.0, 0.01)).translated((0.0, 0.0, -0.75))
        spun = top.heavy_top((0.0, 0.1, 30.0), Rotation.from_rotvec([0.3, 0.0, 0.0]), (0.0, 0.0, -9.81))
        for closed in (motion, spun):
            times = np.array([0.0, 0.5, 1.0, 2.0])
            forth, back = closed.at(times), closed.at(-times)
            asked = closed.at(np.array([[2.0, -1.0], [0.5, 0.5], [-2.0, 0.0]]))
            expected = np.array(
                [
                    [forth.covariance[3], back.covariance[2]],
                    [forth.covariance[1], forth.covariance[1]],
                    [back.covariance[3], forth.covariance[0]],
                ]
            )
            assert asked.covariance == pytest.approx(expected, rel=1e-9, abs=1e-14)
            assert asked.sigma.attitude.shape == asked.sigma.linear.omega.shape == (3, 2, 3)
            assert closed.at(1.0).covariance == pytest.approx(forth.covariance[2], rel=1e-9, abs=1e-14)
            assert pickle.loads(pickle.dumps(closed.at(1.0))).sigma.omega.shape == (3,)
        assert polhode.RigidBody(2.0, TENSOR).free_motion(SPIN).at(5.0).covariance is None

    def test_files_tell_what_they_do_not_hold(self, tmp_path: Path) -> None:
        body = uncertain_body()
        run = body.simulate([0.0, 2.0], SPIN, START)
        for name in ("run.json", "run.npz"):
            run.save(tmp_path / name)
            again = Trajectory.from_file(tmp_path / name)
            assert again.covariance == pytest.approx(run.covariance, rel=1e-15)
            with pytest.raises(ValueError, match="pickle"):
                run.resume([2.0, 3.0]).save(tmp_path / name)
        run.resume([2.0, 3.0]).save(tmp_path / "run.csv")

    @pytest.mark.parametrize(
        "attitude",
        [
            Uncertain((0.0, 0.0, 0.0, 1.0), 0.1),
            Uncertain(np.eye(3), 0.1),
            Uncertain((0.1, 0.2, 0.3), 0.1),
        ],
    )
    def test_an_attitude_has_three_angles(self, attitude: Any) -> None:
        with pytest.raises((ValueError, TypeError), match="attitude"):
            polhode.RigidBody(2.0, TENSOR).simulate([0.0, 1.0], SPIN, attitude)


def by_differences(run_of: Any, numbers: Any, sigma: Any) -> Any:
    """Covariance of (δ, ω) at the last time, δ about the body's axes, of runs with each number moved."""
    middle = run_of(numbers)
    back = Rotation.from_quat(middle.quaternion[-1]).inv()
    slopes = []
    for k, s in enumerate(sigma):
        ends = []
        for sign in (1.0, -1.0):
            moved = numbers.copy()
            moved[k] += sign * 1e-4 * s
            run = run_of(moved)
            turn = (back * Rotation.from_quat(run.quaternion[-1])).as_rotvec()
            ends.append(np.concatenate([turn, run.omega[-1]]))
        slopes.append((ends[0] - ends[1]) / 2e-4)
    return np.array(slopes).T @ np.array(slopes)


def compared(found: Any, expected: Any) -> None:
    norm = np.sqrt(np.diagonal(expected))
    assert found == pytest.approx(expected, abs=1e-6 * float(np.outer(norm, norm).max()))


class TestCovariancesOfRuns:
    TIMES = np.array([0.0, 1.5])

    def test_about_a_pivot(self) -> None:
        weight = polhode.loads.uniform_gravity((0.0, 0.0, -9.81))

        def run_of(n: Any) -> Any:
            body = RigidBody(n[0], TENSOR, (n[1], 0.2, -0.3))
            return body.simulate(self.TIMES, n[2:], START, load=weight, about="origin")

        numbers, sigma = np.concatenate([[2.0, 0.1], SPIN]), np.array([0.02, 0.01, 0.01, 0.02, 0.03])
        uncertain = RigidBody(Uncertain(2.0, 0.02), TENSOR, Uncertain((0.1, 0.2, -0.3), (0.01, 0.0, 0.0)))
        run = uncertain.simulate(self.TIMES, Uncertain(SPIN, sigma[2:]), START, load=weight, about="origin")
        compared(run.covariance[-1], by_differences(run_of, numbers, sigma))

    def test_of_a_stack_and_of_the_attitude_at_the_start(self) -> None:
        tensors = np.array([TENSOR, TENSOR + np.diag([0.5, 0.0, 0.2])])
        stack = RigidBody(2.0, Uncertain(tensors, 0.02 * np.eye(3)))
        drag = polhode.loads.damping(0.3)
        run = stack.simulate(
            self.TIMES, Uncertain(SPIN, 0.02), Uncertain(START, (0.01, 0.02, 0.03)), load=drag
        )
        assert run.covariance.shape == (2, 2, 6, 6)
        for row, tensor in enumerate(tensors):

            def run_of(n: Any, tensor: Any = tensor) -> Any:
                attitude = Rotation.from_rotvec(n[6:]) * START
                return RigidBody(2.0, tensor + np.diag(n[:3])).simulate(
                    self.TIMES, n[3:6], attitude, load=drag
                )

            numbers = np.concatenate([np.zeros(3), SPIN, np.zeros(3)])
            sigma = np.array([0.02] * 6 + [0.01, 0.02, 0.03])
            compared(run.covariance[row, -1], by_differences(run_of, numbers, sigma))


class TestFlags:
    def test_do_not_depend_on_how_many_sources_there_were(self) -> None:
        """The angle about the first axis has no first order, whatever the sources of a body are."""
        batch = Uncertain(2700.0, sigma=20.0)
        for _ in range(100):
            bus = solids.box(Uncertain((1.0, 1.2, 1.5), sigma=0.002), mass=Uncertain(180.0, sigma=0.5))
            panel = solids.box((2.0, 0.02, 1.0), density=batch)
            moved = Uncertain((1.5, 0, 0), sigma=0.01)
            satellite = bus + panel.translated(moved) + panel.translated((-1.5, 0, 0))
            assert satellite.sigma.linear.axes.tolist() == [False, True, True]

    def test_what_is_zero_but_for_rounding_is_no_nonlinear_number(self) -> None:
        body = RigidBody.from_principal(2.0, (3.0, 4.0, 5.0)).with_sigma(mass=0.01)
        about = propagate(lambda b: b.inertia_about((0.1, 0.2, 0.3)), body)
        assert about.linear.all()
        turned = propagate(
            lambda b: b.rotated(START).rotated(START.inv()).inertia_about((0.0, 0.0, 0.5)), body
        )
        assert turned.linear.all()
