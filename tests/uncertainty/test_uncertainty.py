"""Laws of uncertainty: what comes from one source stays one source, whatever is done with it."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import Uncertain
from scipy.spatial.transform import Rotation
from uncertain_bodies import RigidBody, rods, solids

QUARTER = Rotation.from_rotvec([0.3, -1.1, 0.6])


def block() -> Any:
    """Sizes, density and place, each with a sigma."""
    box = solids.box(Uncertain((1.0, 2.0, 3.0), 0.01), density=Uncertain(2.7, 0.02))
    return box.rotated(Uncertain(QUARTER, 0.002)).translated(Uncertain((0.4, -0.8, 1.3), (0.01, 0.02, 0.005)))


def cloud() -> Any:
    """Particles with sigmas of masses and positions."""
    rng = np.random.default_rng(5)
    positions = rng.uniform(-1, 1, (6, 3))
    return RigidBody.from_particles(Uncertain(rng.uniform(1, 3, 6), 0.02), Uncertain(positions, 0.01))


def measured() -> Any:
    """Ten numbers with sigmas of all."""
    tensor = np.array([[3.0, 0.2, -0.1], [0.2, 4.0, 0.3], [-0.1, 0.3, 5.0]])
    body = RigidBody(2.0, tensor, (0.5, 0.6, -0.7))
    return body.with_sigma(mass=0.01, center_of_mass=(0.01, 0.02, 0.03), inertia=np.full((3, 3), 0.02))


MAKERS: dict[str, Callable[[], Any]] = {"block": block, "cloud": cloud, "measured": measured}
makers = pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)


def assert_same(found: Any, expected: Any, rtol: float = 1e-12) -> None:
    """Covariances, element by element against the product of the sigmas (the largest of its block)."""
    found, expected = np.asarray(found), np.asarray(expected)
    sigma = np.sqrt(np.diagonal(expected, axis1=-2, axis2=-1))
    for rows in (slice(0, 1), slice(1, 4), slice(4, 10)):
        sigma[..., rows] = sigma[..., rows].max(axis=-1, keepdims=True)
    departure = np.abs(found - expected)
    assert (departure <= rtol * sigma[..., :, None] * sigma[..., None, :]).all(), departure.max()


def same_source(a: Any, b: Any) -> None:
    """Both are the same draw: their difference is certain."""
    assert_same(a.covariance_with(b), a.covariance)
    assert_same(b.covariance_with(a), b.covariance)


class TestOneSource:
    @makers
    def test_a_part_put_on_and_taken_off_again(self, make: Callable[[], Any]) -> None:
        for other in MAKERS.values():
            a, b = other().translated((3.0, 0.0, 1.0)), make()
            for rest in ((a + b) - a, (b + a) - a):
                assert_same(rest.covariance, b.covariance)
                same_source(rest, b)
                assert np.abs(rest.covariance_with(a)).max() < 1e-12 * np.abs(a.covariance).max()

    @makers
    def test_a_part_used_twice_is_one_draw(self, make: Callable[[], Any]) -> None:
        part = make()
        same = part + part.translated((0.0, 2.0, 0.0))
        other = part + make().translated((0.0, 2.0, 0.0))
        assert same.sigma.mass == pytest.approx(2 * part.sigma.mass, rel=1e-14)
        assert other.sigma.mass == pytest.approx(np.sqrt(2) * part.sigma.mass, rel=1e-14)
        assert same.sigma.center_of_mass == pytest.approx(part.sigma.center_of_mass, rel=1e-12)

    def test_one_number_in_two_bodies(self) -> None:
        density = Uncertain(2.7, 0.1)
        a, b = solids.cube(1.0, density=density), solids.sphere(2.0, density=density)
        assert a.covariance_with(b)[0, 0] == pytest.approx(a.sigma.mass * b.sigma.mass, rel=1e-14)
        assert (a + b).sigma.mass == pytest.approx(a.sigma.mass + b.sigma.mass, rel=1e-14)

    def test_a_name_is_one_draw_wherever_it_stands(self) -> None:
        """Whatever the values and the sigmas."""
        a = solids.cube(Uncertain(1.0, 0.01, source="caliper"), density=3.0)
        b = rods.rod(Uncertain(4.0, 0.03, source="caliper"), density=2.0)
        c = rods.rod(Uncertain(4.0, 0.03, source="ruler"), density=2.0)
        assert a.covariance_with(b)[0, 0] == pytest.approx(a.sigma.mass * b.sigma.mass, rel=1e-14)
        assert not a.covariance_with(c).any()

    def test_equal_numbers_of_two_objects_are_two_draws(self) -> None:
        a, b = (solids.cube(1.0, density=Uncertain(2.7, 0.1)) for _ in range(2))
        assert not a.covariance_with(b).any()
        assert (a + b).sigma.mass == pytest.approx(np.hypot(a.sigma.mass, b.sigma.mass), rel=1e-14)

    def test_named_sigmas_of_bodies(self) -> None:
        body = RigidBody(2.0, np.diag([3.0, 4.0, 5.0]))
        a, b, c = (body.with_sigma(mass=0.1, inertia=np.full((3, 3), 0.2), source=s) for s in ("x", "x", "y"))
        same_source(a, b)
        assert not a.covariance_with(c).any()
        P = np.diag(np.arange(1.0, 11.0)) * 1e-4
        a, b, c = (body.with_covariance(P, source=s) for s in ("x", "x", None))
        same_source(a, b)
        assert not a.covariance_with(c).any()

    def test_covariance_of_two_bodies_is_transposed_of_the_other_way(self) -> None:
        a, b = block(), cloud()
        whole = a + b
        assert_same(whole.covariance_with(whole), whole.covariance)
        cross = whole.covariance_with(a)
        assert cross.shape == (10, 10)
        assert np.allclose(cross, a.covariance_with(whole).T, rtol=1e-13, atol=0)

    @makers
    def test_covariances_are_covariances(self, make: Callable[[], Any]) -> None:
        P = make().covariance
        assert P.shape == (10, 10)
        assert np.array_equal(P, P.T)
        sigma = np.sqrt(np.diag(P))
        assert np.linalg.eigvalsh(P / np.outer(sigma, sigma)).min() > -1e-12


class TestGivenCovariances:
    """What is given comes back: no rank is lost, and none made."""

    @staticmethod
    def relative(found: Any, given: Any) -> float:
        sigma = np.sqrt(np.diag(given))
        return float(np.abs((found - given) / np.outer(sigma, sigma)).max())

    @pytest.mark.parametrize("rank", [1, 2, 3, 6, 9, 10])
    def test_of_any_rank(self, rank: int) -> None:
        rng = np.random.default_rng(rank)
        body = RigidBody(2.0, np.diag([3.0, 4.0, 5.0]))
        for _ in range(20):
            factor = 10 ** rng.uniform(-6, -2, 10)[:, None] * rng.standard_normal((10, rank))
            P = factor @ factor.T
            P = (P + P.T) / 2
            assert self.relative(body.with_covariance(P).covariance, P) < 1e-12
            assert self.relative(Uncertain(np.zeros(10), covariance=P).covariance, P) < 1e-12

    @pytest.mark.parametrize("rest", [1e-2, 1e-5, 1e-8, 1e-11, 1e-14])
    def test_of_strong_correlation(self, rest: float) -> None:
        """Three gauges that all but read the same, and the differences of which matter."""
        rng = np.random.default_rng(3)
        factor = np.hstack([np.ones((3, 1)), rest**0.5 * rng.standard_normal((3, 3))])
        P = factor @ factor.T
        P = (P + P.T) / 2
        assert self.relative(Uncertain(np.zeros(3), covariance=P).covariance, P) < 1e-12


class TestThereAndBack:
    @makers
    def test_translated(self, make: Callable[[], Any]) -> None:
        body = make()
        back = body.translated((1.5, -2.5, 3.5)).translated((-1.5, 2.5, -3.5))
        assert_same(back.covariance, body.covariance)
        same_source(back, body)

    @makers
    def test_rotated(self, make: Callable[[], Any]) -> None:
        body = make()
        back = body.rotated(QUARTER).rotated(QUARTER.inv())
        assert_same(back.covariance, body.covariance)
        same_source(back, body)

    @makers
    def test_scaled(self, make: Callable[[], Any]) -> None:
        body = make()
        back = body.scaled(length=2.5, mass=0.3).scaled(length=0.4, mass=1 / 0.3)
        assert_same(back.covariance, body.covariance)
        same_source(back, body)

    @makers
    def test_the_whole_moves_as_its_parts_do(self, make: Callable[[], Any]) -> None:
        """One uncertain shift, turn or scale of both parts is that of their sum."""
        a, b = make(), block().translated((2.0, 0.0, 0.0))
        shift, turn = Uncertain((1.0, 2.0, 3.0), 0.05), Uncertain(QUARTER, (0.01, 0.02, 0.03))
        length, mass = Uncertain(2.0, 0.01), Uncertain(3.0, 0.02)
        changes: list[Callable[[Any], Any]] = [
            lambda body: body.translated(shift),
            lambda body: body.rotated(turn),
            lambda body: body.scaled(length=length, mass=mass),
        ]
        for change in changes:
            parts, whole = change(a) + change(b), change(a + b)
            assert_same(parts.covariance, whole.covariance)
            same_source(parts, whole)

    def test_a_turn_is_about_the_axes_in_which_the_body_then_stands(self) -> None:
        """A rod along z, turned to lie along x: about x nothing happens, about z it sweeps I_xy."""
        rod = rods.rod(2.0, mass=3.0).rotated(
            Uncertain(Rotation.from_rotvec([0, np.pi / 2, 0]), (0.1, 0.0, 0.0))
        )
        assert rod.sigma.inertia == pytest.approx(np.zeros((3, 3)), abs=1e-15)
        rod = rods.rod(2.0, mass=3.0).rotated(
            Uncertain(Rotation.from_rotvec([0, np.pi / 2, 0]), (0.0, 0.0, 0.1))
        )
        assert rod.sigma.inertia[0, 1] == pytest.approx(0.1, rel=1e-12)
        assert rod.sigma.inertia[1, 0] == rod.sigma.inertia[0, 1]


class TestManyParts:
    def test_any_order_and_any_tree(self) -> None:
        rng = np.random.default_rng(11)
        density = Uncertain(2.0, 0.05)
        makers: list[Callable[[], Any]] = [
            *MAKERS.values(),
            lambda: solids.cylinder(0.3, Uncertain(1.0, 0.01), density=density),
        ]
        parts = [makers[k % 4]().translated(Uncertain(rng.uniform(-3, 3, 3), 0.01)) for k in range(24)]
        reference: Any = sum(parts)
        for _ in range(4):
            order = rng.permutation(24)
            shuffled: Any = sum(parts[k] for k in order)
            halves = sum(parts[k] for k in order[:9]) + sum(parts[k] for k in order[9:])
            stacked = RigidBody.stack([parts[k] for k in order]).combined()
            for other in (shuffled, halves, stacked):
                assert_same(other.covariance, reference.covariance)
                same_source(other, reference)

    def test_stack_and_index(self) -> None:
        bodies = [block(), cloud(), measured(), RigidBody(1.0, np.eye(3))]
        stack = RigidBody.stack(bodies)
        assert stack.covariance.shape == (4, 10, 10)
        for k, body in enumerate(bodies[:3]):
            assert np.array_equal(stack.covariance[k], body.covariance)
            assert np.array_equal(stack[k].covariance, body.covariance)
            assert np.array_equal(stack[k].covariance_with(body), body.covariance)
            assert np.array_equal(stack.covariance_with(body)[k], body.covariance)
            assert np.array_equal(stack[k].sigma.principal_moments, body.sigma.principal_moments)
        assert not stack.covariance[3].any()
        assert np.array_equal(stack[::-1].covariance, stack.covariance[::-1])
        mask = np.array([True, False, True, False])
        assert np.array_equal(stack[mask].covariance, stack.covariance[mask])
        for k, body in enumerate(stack):
            assert not k < 3 or np.array_equal(body.covariance, stack.covariance[k])
        assert stack.sigma.mass.shape == (4,)
        assert stack.sigma.inertia.shape == (4, 3, 3)
        assert stack.sigma.axes.shape == stack.sigma.linear.axes.shape == (4, 3)

    def test_rows_have_the_bits_of_bodies_alone(self) -> None:
        a = RigidBody.stack([block(), cloud()])
        b = RigidBody.stack([measured(), block()])
        both = a + b.translated([(1.0, 2.0, 3.0), (-1.0, 0.0, 0.5)])
        for k, d in enumerate([(1.0, 2.0, 3.0), (-1.0, 0.0, 0.5)]):
            assert np.array_equal(both[k].covariance, (a[k] + b[k].translated(d)).covariance)

    def test_one_density_for_a_stack_and_one_for_each(self) -> None:
        sides = np.array([1.0, 2.0, 3.0])
        common = solids.cube(sides, density=Uncertain(2.0, 0.1))
        assert common.combined().sigma.mass == pytest.approx(0.1 * (sides**3).sum(), rel=1e-13)
        each = solids.cube(sides, density=Uncertain([2.0] * 3, 0.1))
        assert each.combined().sigma.mass == pytest.approx(0.1 * np.linalg.norm(sides**3), rel=1e-13)

    def test_combined_along_axes(self) -> None:
        grid = solids.cube(Uncertain(np.full((2, 3), 1.5), 0.01), density=Uncertain(2.0, 0.1))
        grid = grid.translated(np.random.default_rng(1).uniform(-2, 2, (2, 3, 3)))
        for axis, rows in ((0, [grid[:, k] for k in range(3)]), (1, [grid[k] for k in range(2)])):
            combined = grid.combined(axis)
            for k, row in enumerate(rows):
                assert_same(combined[k].covariance, sum(row[1:], row[0]).covariance, 1e-13)
        assert_same(grid.combined((0, 1)).covariance, grid.combined(0).combined().covariance)


ELSEWHERE = """
import pickle, sys
from polhode import Uncertain, solids
numbers = Uncertain(2.0, 0.1), Uncertain(2.0, 0.1, source="n")
sys.stdout.buffer.write(pickle.dumps([solids.cube(1.0, density=number) for number in numbers]))
"""


class TestKept:
    @makers
    def test_pickle_and_copy(self, make: Callable[[], Any]) -> None:
        body, other = make(), block()
        whole = body + other
        for same in (pickle.loads(pickle.dumps(whole)), copy.copy(whole), copy.deepcopy(whole)):
            assert np.array_equal(same.covariance, whole.covariance)
            assert np.array_equal(same.covariance_with(body), whole.covariance_with(body))
            assert np.array_equal(same.covariance_with(other), whole.covariance_with(other))
            assert same.sigma.linear.mass == whole.sigma.linear.mass
            assert np.array_equal(same.sigma.linear.axes, whole.sigma.linear.axes)

    def test_uncertain_numbers_are_kept_too(self) -> None:
        number = Uncertain(2.0, 0.1)
        a = solids.cube(1.0, density=number)
        for same in (pickle.loads(pickle.dumps(number)), copy.copy(number), copy.deepcopy(number)):
            same_source(solids.cube(1.0, density=same), a)

    def test_a_file(self, tmp_path: Path) -> None:
        whole, part = block() + cloud(), block()
        both = RigidBody.stack([whole + part, part])
        both.save(tmp_path / "both.json")
        loaded = RigidBody.from_file(tmp_path / "both.json")
        assert np.array_equal(loaded.covariance, both.covariance)
        assert np.array_equal(loaded[0].covariance_with(part), both[0].covariance_with(part))

    def test_other_processes_have_other_sources(self) -> None:
        """Numbers made alike in three processes are three draws; what has a name is one."""
        here = [solids.cube(1.0, density=Uncertain(2.0, 0.1, source=s)) for s in (None, "n")]
        runs = [
            subprocess.run([sys.executable, "-c", ELSEWHERE], check=True, capture_output=True).stdout
            for _ in range(2)
        ]
        a, b = (pickle.loads(run) for run in runs)
        for one, other in ((a, b), (a, here), (b, here)):
            assert not one[0].covariance_with(other[0]).any()
            same_source(one[1], other[1])

    def test_arrays_given_are_not_shared(self) -> None:
        value, sigma = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3])
        number = Uncertain(value, sigma)
        value[0] = sigma[0] = 9.0
        assert number.value[0] == 1.0
        assert number.sigma[0] == 0.1
        with pytest.raises(ValueError, match="read-only"):
            number.value[0] = 5.0


class TestWithout:
    def test_nothing_is_uncertain(self) -> None:
        body = solids.box((1, 2, 3), mass=2.0)
        assert body.covariance is None
        assert (body + body.translated((1, 2, 3))).covariance is None
        assert RigidBody.stack([body, body]).covariance is None

    def test_a_certain_part_adds_nothing(self) -> None:
        a, certain = block(), solids.box((1, 2, 3), mass=2.0)
        assert (a + certain).sigma.mass == pytest.approx(a.sigma.mass, rel=1e-15)
        assert not np.any(certain.covariance_with(a))


class TestNotDetermined:
    def test_axes_of_a_ball(self) -> None:
        ball = solids.sphere(1.0, mass=2.0).with_sigma(inertia=np.full((3, 3), 1e-4))
        assert np.isnan(ball.sigma.axes).all()
        assert not ball.sigma.linear.axes.any()
        assert not ball.sigma.linear.principal_moments.any()  # sorted moments repel each other
        assert ball.sigma.linear.inertia.all()

    def test_axes_of_a_spindle(self) -> None:
        """About its own axis nothing is determined, across it everything."""
        rod = solids.cylinder(0.5, 4.0, mass=2.0).with_sigma(inertia=np.full((3, 3), 1e-4))
        assert np.isnan(rod.sigma.axes).tolist() == [True, False, False]
        gap = np.diff(rod.principal_moments)[0]
        assert rod.sigma.axes[1:] == pytest.approx([1e-4 / gap] * 2, rel=1e-10)
        assert rod.sigma.linear.principal_moments.tolist() == [True, False, False]

    def test_about_its_own_axis_in_any_attitude(self) -> None:
        """Certain moments or not, turned or not: equal moments have no axes."""
        straight = solids.cylinder(Uncertain(0.5, 0.01), Uncertain(4.0, 0.01), mass=2.0)
        for rod in (straight, straight.rotated(QUARTER), straight.rotated(Uncertain(QUARTER, 0.01))):
            assert np.isnan(rod.sigma.axes).tolist() == [True, False, False]
            assert rod.sigma.principal_moments == pytest.approx(straight.sigma.principal_moments, rel=1e-12)
            assert rod.sigma.linear.principal_moments.all()  # two moments that are always equal do not repel

    def test_moments_that_may_change_places_are_told(self) -> None:
        """Each edge by itself turns no axis, but which of the moments is the least is not known."""
        body = solids.ellipsoid(Uncertain((1.0, 1.0005, 2.0), 0.003), mass=1.0)
        assert body.sigma.linear.principal_moments.tolist() == [True, False, False]
        assert body.sigma.linear.axes.tolist() == [False, False, False]
        apart = solids.ellipsoid(Uncertain((1.0, 1.5, 2.0), 0.003), mass=1.0)
        assert apart.sigma.linear.principal_moments.all()
        assert apart.sigma.linear.axes.all()

    def test_near_equal_moments_are_told(self) -> None:
        for gap, is_linear in ((1.0, True), (1e-4, False)):
            body = RigidBody(1.0, np.diag([3.0, 4.0, 4.0 + gap])).with_sigma(inertia=np.full((3, 3), 1e-4))
            assert body.sigma.linear.principal_moments.tolist() == [True, is_linear, is_linear]
            assert bool(body.sigma.linear.axes[0]) is is_linear
