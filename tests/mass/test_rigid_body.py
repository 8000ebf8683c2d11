"""RigidBody as a value: construction, validity, stacks, indexing, equality, copies."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import rational, worst_error
from oracles.bodies import Body, bodies, matrix
from oracles.exact_particles import inertia_about
from polhode import RigidBody, solids

DIAGONAL = np.diag([1.0, 2.0, 2.5])


def three_bodies() -> RigidBody:
    """A stack of three bodies that differ in everything."""
    tensors = np.array([np.diag(row) for row in ([1.0, 2, 2.5], [3.0, 3, 3], [5.0, 4, 2])])
    return RigidBody(mass=[1.0, 2.0, 3.0], inertia=tensors, center_of_mass=np.eye(3))


class TestConstruction:
    def test_the_tensor_given_is_the_tensor_kept(self) -> None:
        tensor = np.array([[1.1, 0.1, -0.2], [0.1, 1.3, 0.3], [-0.2, 0.3, 1.7]])
        body = RigidBody(mass=0.1, inertia=tensor, center_of_mass=(0.1, 0.2, 0.3))
        assert body.mass == 0.1
        assert np.array_equal(body.inertia, tensor)
        assert np.array_equal(body.center_of_mass, [0.1, 0.2, 0.3])

    def test_mass_and_inertia_go_by_position(self) -> None:
        assert RigidBody(2.0, DIAGONAL) == RigidBody(mass=2.0, inertia=DIAGONAL, center_of_mass=(0, 0, 0))

    def test_about_the_origin_is_shifted_to_the_center_of_mass(self) -> None:
        mass, center = 1.5, np.array([0.25, -0.5, 0.75])
        about_origin = DIAGONAL + mass * (center @ center * np.eye(3) - np.outer(center, center))
        body = RigidBody(mass=mass, inertia_about_origin=about_origin, center_of_mass=center)
        assert np.abs(body.inertia - DIAGONAL).max() <= 4 * np.spacing(about_origin.max())
        assert np.abs(body.inertia_about("origin") - about_origin).max() <= 2 * np.spacing(about_origin.max())

    @pytest.mark.parametrize("tensors", [{}, {"inertia": DIAGONAL, "inertia_about_origin": DIAGONAL}])
    def test_exactly_one_tensor_is_taken(self, tensors: dict[str, Any]) -> None:
        with pytest.raises((TypeError, ValueError), match="inertia_about_origin"):
            RigidBody(mass=1.0, **tensors)

    @given(body=bodies())
    def test_principal_moments_given_are_the_moments_kept(self, body: Body) -> None:
        made = RigidBody.from_principal(*body)
        assert np.array_equal(made.principal_moments, body.moments)
        # The axes are rounded: their columns are a right-handed orthonormal set to a few ε.
        error = np.abs(made.inertia - body.inertia).max()
        assert error <= 16 * np.finfo(float).eps * body.moments[2]

    def test_principal_axes_default_to_the_body_axes(self) -> None:
        made = RigidBody.from_principal(2.0, [1.0, 2.0, 2.5])
        assert np.array_equal(made.inertia, DIAGONAL)
        assert np.array_equal(made.principal.axes, np.eye(3))

    def test_principal_axes_come_as_a_quaternion_holder_too(self) -> None:
        class Attitude:
            def as_quat(self) -> Any:
                return np.array([0.5, 0.5, 0.5, 0.5])

        turned = RigidBody.from_principal(2.0, [1.0, 2.0, 2.5], axes=Attitude())
        by_matrix = RigidBody.from_principal(2.0, [1.0, 2.0, 2.5], axes=matrix(np.full(4, 0.5)))
        assert np.array_equal(turned.inertia, by_matrix.inertia)

    def test_a_single_body_gives_scalars_and_bare_vectors(self) -> None:
        body = RigidBody(2.0, DIAGONAL)
        assert isinstance(body.mass, float)
        assert body.shape == ()
        assert (body.center_of_mass.shape, body.inertia.shape) == ((3,), (3, 3))
        assert (body.principal_moments.shape, body.radii_of_gyration.shape) == ((3,), (3,))

    def test_radii_of_gyration(self) -> None:
        radii = RigidBody(4.0, np.diag([1.0, 9.0, 9.0])).radii_of_gyration
        assert radii == pytest.approx([0.5, 1.5, 1.5], rel=1e-15)


class TestStack:
    def test_arguments_broadcast(self) -> None:
        body = RigidBody(np.ones((4, 1)), DIAGONAL, center_of_mass=np.zeros((5, 3)))
        assert body.shape == (4, 5)
        assert len(body) == 4
        assert (body.mass.shape, body.center_of_mass.shape, body.inertia.shape) == (
            (4, 5),
            (4, 5, 3),
            (4, 5, 3, 3),
        )

    def test_shapes_that_do_not_broadcast_are_refused(self) -> None:
        with pytest.raises(ValueError, match=r"broadcast|shape"):
            RigidBody(np.ones(4), DIAGONAL, center_of_mass=np.zeros((5, 3)))

    def test_an_empty_stack_is_a_stack(self) -> None:
        body = RigidBody(np.ones(0), DIAGONAL)
        assert (body.shape, len(body), body.inertia.shape) == ((0,), 0, (0, 3, 3))
        assert body.principal.moments.shape == (0, 3)
        assert list(body) == []

    def test_indexing_is_numpys(self) -> None:
        body = three_bodies()
        rows = [0, -1, np.int64(1), [0, 2], [True, False, True], np.array([[0, 1], [2, 0]])]
        keys: list[Any] = [*rows, slice(1, None), slice(None, None, -1), Ellipsis, None, (Ellipsis, None), ()]
        numbered = np.arange(3)
        for key in keys:
            taken, numbers = body[key], numbered[key]
            assert taken.shape == numbers.shape
            assert np.array_equal(taken.mass, body.mass[numbers])
            assert np.array_equal(taken.center_of_mass, body.center_of_mass[numbers])
            assert np.array_equal(taken.inertia, body.inertia[numbers])

    def test_indexing_errors(self) -> None:
        body = three_bodies()
        with pytest.raises(IndexError, match="3"):
            body[3]
        with pytest.raises(IndexError):
            body[0, 0]
        with pytest.raises((IndexError, TypeError)):
            body["a"]

    def test_one_body_has_neither_length_nor_rows(self) -> None:
        body = three_bodies()[0]
        with pytest.raises(TypeError):
            len(body)
        with pytest.raises(TypeError):
            iter(body)
        with pytest.raises(IndexError):
            body[0]

    def test_one_body_is_true(self) -> None:
        assert bool(three_bodies()[0]) is True

    def test_iteration_and_stack_are_inverse(self) -> None:
        body = three_bodies()
        rows = list(body)
        assert [row.shape for row in rows] == [(), (), ()]
        assert RigidBody.stack(rows) == body
        nested = RigidBody.stack([body, body])
        assert nested.shape == (2, 3)
        assert nested[1] == body

    def test_stack_takes_any_iterable_of_equal_shapes_and_nothing_else(self) -> None:
        body = three_bodies()
        assert RigidBody.stack(tuple(body)) == body
        with pytest.raises(ValueError, match=r"(?i)empty|at least one|no bod"):
            RigidBody.stack([])
        with pytest.raises(ValueError, match="shape"):
            RigidBody.stack([body, body[0]])
        with pytest.raises(TypeError):
            RigidBody.stack([body, 3])  # type: ignore[list-item]

    def test_a_row_alone_has_the_bits_of_the_row_in_the_stack(self, rng: np.random.Generator) -> None:
        points = rng.normal(size=(40, 7, 3))
        masses = rng.uniform(0.1, 1, size=(40, 7))
        stack = RigidBody.from_particles(masses, points)
        for i, row in enumerate(stack):
            alone = RigidBody.from_particles(masses[i], points[i])
            assert row == alone
            assert np.array_equal(row.principal.axes, alone.principal.axes)
            assert np.array_equal(stack.principal.axes[i], alone.principal.axes)


class TestAddition:
    @given(data=st.lists(bodies(decades=1), min_size=2, max_size=4))
    def test_the_sum_is_the_union_of_the_masses(self, data: list[Body]) -> None:
        total = sum(RigidBody.from_principal(*body) for body in data)
        assert isinstance(total, RigidBody)
        masses = rational([b.mass for b in data])
        centers = rational([b.center_of_mass for b in data])
        mass = sum(masses)
        center = [sum(m * c[i] for m, c in zip(masses, centers, strict=True)) / mass for i in range(3)]
        parts = [rational(RigidBody.from_principal(*b).inertia) for b in data]
        points = inertia_about(masses, centers, center)
        want = [[points[i][j] + sum(p[i][j] for p in parts) for j in range(3)] for i in range(3)]
        assert worst_error(total.mass, mass) < 1e-15
        span = max(float(np.abs(b.center_of_mass).max()) for b in data)
        assert worst_error(total.center_of_mass, center, scale=span) < 2e-15 or span == 0
        assert worst_error(total.inertia, want) < 4e-15

    def test_addition_broadcasts(self) -> None:
        body, stack = solids.cube(1.0, mass=1.0), three_bodies()
        both = body + stack
        assert both.shape == (3,)
        assert both[1] == body + stack[1]
        assert (stack[:, None] + stack).shape == (3, 3)

    def test_zero_is_the_neutral_start_of_sum_only(self) -> None:
        body = three_bodies()[0]
        assert sum([body]) == body
        with pytest.raises(TypeError):
            body + 1  # type: ignore[operator]
        with pytest.raises(TypeError):
            1 + body
        with pytest.raises(TypeError):
            body + np.ones(3)  # type: ignore[operator]


class TestEquality:
    def test_equal_values_are_equal_and_hash_alike(self) -> None:
        one, two = three_bodies(), three_bodies()
        assert one == two
        assert hash(one) == hash(two)
        assert len({one, two, one[0]}) == 2

    def test_any_difference_is_a_difference(self) -> None:
        body = RigidBody(1.0, DIAGONAL)
        last_bit = DIAGONAL.copy()
        last_bit[2, 2] = np.nextafter(2.5, 3)
        assert body != RigidBody(1.0, last_bit)
        assert body != RigidBody(np.nextafter(1.0, 2), DIAGONAL)
        assert body != RigidBody(1.0, DIAGONAL, center_of_mass=(1e-300, 0, 0))
        assert body != RigidBody([1.0], DIAGONAL)
        assert body != "a body"  # type: ignore[comparison-overlap]
        assert body != None  # noqa: E711
        assert (body == np.ones(3)) is False
        assert (np.ones(3) == body) is False

    def test_signed_zeros_are_equal_and_hash_alike(self) -> None:
        plus, minus = RigidBody(1.0, DIAGONAL), RigidBody(1.0, DIAGONAL, center_of_mass=(-0.0, -0.0, -0.0))
        assert plus == minus
        assert hash(plus) == hash(minus)

    def test_isclose_compares_row_by_row(self) -> None:
        body = three_bodies()
        nearly = body.scaled(mass=[1.0, 1 + 1e-12, 1 + 1e-6])
        assert body.isclose(nearly).tolist() == [True, True, False]
        assert body.isclose(nearly, rtol=1e-5).tolist() == [True, True, True]
        assert bool(body[0].isclose(body[0])) is True
        assert body.isclose(body[0]).tolist() == [True, False, False]

    @pytest.mark.parametrize(("apart", "is_close"), [(0.9, True), (1.1, False)])
    def test_isclose_measures_places_by_the_size_of_the_body(self, apart: float, is_close: bool) -> None:
        """The other's √(tr I/m): √½ of the edge of a cube whose centre is the origin."""
        cube = solids.box((1.0, 1.0, 1.0), mass=2.0)
        size = 2.0 * np.sqrt(np.trace(cube.inertia / 4) / 2.0)
        assert size == pytest.approx(np.sqrt(0.5), rel=1e-14)
        moved = cube.translated((apart * 1e-3 * size, 0.0, 0.0))
        assert moved.isclose(cube, rtol=1e-3) == is_close


class TestCopies:
    @pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
    def test_pickle_keeps_every_bit(self, protocol: int) -> None:
        turned = RigidBody.from_principal(0.1, [0.1, 0.2, 0.25], axes=matrix(np.full(4, 0.5)))
        for body in (three_bodies(), three_bodies()[1], turned, RigidBody(np.ones(0), DIAGONAL)):
            again = pickle.loads(pickle.dumps(body, protocol=protocol))
            assert again == body
            assert again.shape == body.shape
            assert np.array_equal(again.principal.axes, body.principal.axes)
            assert np.array_equal(again.principal_moments, body.principal_moments)

    @pytest.mark.parametrize("protocol", [2, pickle.HIGHEST_PROTOCOL])
    @pytest.mark.parametrize("rows", [30_840, 30_842, 100_000])
    def test_a_large_stack_is_pickled_in_slabs_with_every_bit(self, rows: int, protocol: int) -> None:
        """A slab has 2²⁰ numbers, 34 a body: the first stack is the largest that is not taken apart."""
        rng = np.random.default_rng(rows)
        moments = np.sort(rng.uniform(1.0, 1.5, (2, rows // 2, 3)), axis=-1)
        bodies = RigidBody.from_principal(rng.uniform(1.0, 2.0, (2, rows // 2)), moments)
        numbers = bodies.__reduce__()[1][0]
        assert isinstance(numbers, np.ndarray) == (rows == 30_840)
        assert pickle.loads(pickle.dumps(bodies, protocol=protocol)) == bodies
        if protocol == 2:
            motions = bodies.gyrostat(rng.normal(size=3)).free_motion(rng.normal(size=(2, rows // 2, 3)))
            free = bodies.free_motion(motions.omega, motions.quaternion)
            for motion in (motions, free):
                again = pickle.loads(pickle.dumps(motion))
                assert np.array_equal(again.omega, motion.omega)
                assert np.array_equal(again.quaternion, motion.quaternion)

    def test_copy_and_deepcopy(self) -> None:
        body = three_bodies()
        assert copy.copy(body) == body
        assert copy.deepcopy(body) == body

    def test_a_body_cannot_be_changed(self) -> None:
        body = three_bodies()
        with pytest.raises(AttributeError):
            body.mass = 3.0  # type: ignore[misc]
        with pytest.raises(TypeError):
            body[0] = body[1]  # type: ignore[index]
        before = copy.deepcopy(body)
        for name in ("mass", "center_of_mass", "inertia", "principal_moments", "radii_of_gyration"):
            array = getattr(body, name)
            if array.flags.writeable:
                array[...] = -1.0
        assert body == before
        assert np.array_equal(body.principal_moments, before.principal_moments)

    def test_repr_tells_what_it_is(self) -> None:
        assert repr(three_bodies()[0]).startswith("RigidBody(")
        assert "mass=1" in repr(three_bodies()[0])
        assert "(3,)" in repr(three_bodies()) or "3" in repr(three_bodies())


class TestOperations:
    @given(body=bodies())
    def test_translation_moves_the_center_of_mass_and_nothing_else(self, body: Body) -> None:
        made, shift = RigidBody.from_principal(*body), np.array([1.0, -2.0, 0.5]) * body.gyration
        moved = made.translated(shift)
        assert np.array_equal(moved.inertia, made.inertia)
        assert np.array_equal(moved.center_of_mass, made.center_of_mass + shift)
        assert moved.mass == made.mass

    @given(body=bodies())
    def test_rotation_is_active_about_the_origin(self, body: Body) -> None:
        made = RigidBody.from_principal(*body)
        q = np.array([0.5, -0.5, 0.1, 0.7])
        turn = matrix(q / np.linalg.norm(q))
        turned = made.rotated(turn)
        eps = np.finfo(float).eps
        wanted = turn @ made.inertia @ turn.T
        assert np.abs(turned.inertia - wanted).max() <= 16 * eps * body.moments[2]
        assert (
            np.abs(turned.center_of_mass - turn @ body.center_of_mass).max()
            <= 4 * eps * np.abs(body.center_of_mass).sum()
        )
        assert np.array_equal(turned.principal_moments, made.principal_moments)

    def test_rotation_must_be_a_rotation(self) -> None:
        body = RigidBody(1.0, DIAGONAL)
        for wrong in (np.diag([1.0, 1, -1]), 2 * np.eye(3), np.zeros((3, 3))):
            with pytest.raises(ValueError, match="rotation"):
                body.rotated(wrong)

    def test_scaling(self) -> None:
        body = three_bodies()
        larger = body.scaled(length=2.0, mass=3.0)
        assert np.array_equal(larger.mass, 3 * body.mass)
        assert np.array_equal(larger.center_of_mass, 2 * body.center_of_mass)
        assert np.array_equal(larger.inertia, 12 * body.inertia)
        assert body[0].scaled(length=[1.0, 2.0]).shape == (2,)

    @pytest.mark.parametrize("factors", [{"mass": 0.0}, {"mass": -1.0}, {"length": -1.0}, {"length": np.nan}])
    def test_scales_are_positive_numbers(self, factors: dict[str, float]) -> None:
        with pytest.raises(ValueError, match=next(iter(factors))):
            three_bodies().scaled(**factors)

    def test_operations_broadcast_over_stacks(self) -> None:
        body = three_bodies()
        assert body.translated([1.0, 0, 0]).shape == (3,)
        assert body[0].translated(np.eye(3)).shape == (3,)
        assert body[:, None].translated(np.zeros((4, 3))).shape == (3, 4)
        assert body[0].rotated(np.array([np.eye(3)] * 2)).shape == (2,)
