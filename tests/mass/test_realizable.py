"""The nearest possible tensor, and bodies that would have to be larger than they are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import attitudes, matrix
from polhode import RigidBody, solids, validity
from polhode.errors import InvalidInertiaError
from scipy.optimize import linprog, nnls
from scipy.spatial.transform import Rotation

EDGES = np.array([[0.0, 1, 1], [1, 0, 1], [1, 1, 0]])
"""Possible moments are sums of these with second moments, none negative, as factors."""


class TestNearestValid:
    @given(
        moments=st.lists(st.floats(-1, 1), min_size=3, max_size=3),
        attitude=attitudes(),
        power=st.integers(-40, 40),
    )
    def test_it_is_the_nearest_point_of_the_cone(
        self, moments: list[float], attitude: Any, power: int
    ) -> None:
        """By SciPy's least squares over factors that are not negative, and with the axes left as they are."""
        axes, scale = matrix(attitude), 10.0**power
        tensor = scale * (axes * moments) @ axes.T
        tensor = (tensor + tensor.T) / 2
        found = validity.nearest_valid(tensor)
        _, distance = nnls(EDGES, np.array(moments))
        assert found.distance == pytest.approx(scale * distance, rel=1e-12, abs=1e-14 * scale)
        assert np.linalg.norm(found.inertia - tensor) == pytest.approx(found.distance, abs=1e-14 * scale)
        if np.abs(found.inertia).max() > 0:
            RigidBody(1.0, found.inertia)

    def test_a_possible_tensor_comes_back_as_it_is(self) -> None:
        tensor = solids.box((1.0, 2.0, 3.0), mass=1.0).rotated(matrix(np.full(4, 0.5))).inertia
        for possible in (tensor, np.zeros((3, 3)), np.diag([0.0, 1.0, 1.0]), np.diag([1e-17, 1.0, 1.0])):
            found = validity.nearest_valid(possible)
            assert np.array_equal(found.inertia, possible)
            assert found.distance == 0.0

    def test_textbook_cases(self) -> None:
        """A robot hand's finger whose largest moment is too large: a third of the excess goes to each."""
        tensor, distance = validity.nearest_valid(np.diag([1.486e-6, 2e-7, 8.31e-7]))
        excess = 1.486e-6 - 2e-7 - 8.31e-7
        assert np.diag(tensor) == pytest.approx(
            [1.486e-6 - excess / 3, 2e-7 + excess / 3, 8.31e-7 + excess / 3]
        )
        assert distance == pytest.approx(excess / 3**0.5)

    @pytest.mark.parametrize("scale", [1e-47, 1e-15, 1.0, 1e37])
    def test_every_program_finds_it_possible(self, scale: float) -> None:
        """A + B >= C of the moments that NumPy and MuJoCo compute: beyond the edge, on it, and near it."""
        mju_eig3 = pytest.importorskip("mujoco").mju_eig3
        rng = np.random.default_rng(17)
        second = rng.uniform(0, 1, (1000, 3))
        thickness = rng.choice([0.0, 1e-17, 1e-16, 3e-16, 1e-15, 1e-12, -1e-16, -1e-9, -0.1, -1.0], 1000)
        second[:, 0] = thickness
        second[::5, 1] = thickness[::5]  # rods
        moments = second.sum(axis=1, keepdims=True) - second
        turns = Rotation.random(1000, rng).as_matrix()
        turns[::7] = np.roll(np.eye(3), 1, axis=0)
        tensors = scale * np.einsum("nij,nj,nkj->nik", turns, moments, turns)
        found = validity.nearest_valid((tensors + np.swapaxes(tensors, 1, 2)) / 2)
        for tensor, thick, distance in zip(found.inertia, thickness, found.distance, strict=True):
            first, middle, last = np.linalg.eigvalsh(tensor)
            assert first >= 0.0
            assert first + middle >= last
            values, axes, quaternion = np.zeros(3), np.zeros(9), np.zeros(4)
            mju_eig3(values, axes, quaternion, tensor.ravel())
            assert values[1] + values[2] >= values[0]
            if abs(thick) < 1e-14:
                assert distance <= 1e-14 * np.trace(tensor)
        again = validity.nearest_valid(found.inertia)
        np.testing.assert_array_equal(again.inertia, found.inertia)
        assert not again.distance.any()

    def test_rows(self) -> None:
        stack = np.array([np.diag([1.0, 1, 5]), np.full((3, 3), np.nan), np.eye(3)])
        found = validity.nearest_valid(stack)
        assert np.isnan(found.inertia[1]).all()
        assert np.isnan(found.distance[1])
        assert np.array_equal(found.inertia[2], np.eye(3))
        assert found.distance[0] == pytest.approx(3**0.5)

    def test_asymmetry_is_not_repaired(self) -> None:
        tensor = np.eye(3)
        tensor[0, 1] = 0.5
        with pytest.raises(InvalidInertiaError, match="symmetric"):
            validity.nearest_valid(tensor)


LOW, HIGH = np.array([-1.0, -2.0, 0.5]), np.array([1.0, 0.5, 3.0])


class TestFitInBox:
    @given(
        shares=st.lists(st.floats(0.01, 1), min_size=8, max_size=8),
        points=st.lists(st.floats(0, 1), min_size=24, max_size=24),
    )
    def test_matter_in_the_box_fits(self, shares: list[float], points: list[float]) -> None:
        positions = LOW + np.array(points).reshape(8, 3) * (HIGH - LOW)
        fit = validity.fit_in_box(RigidBody.from_particles(shares, positions), LOW, HIGH)
        assert fit.margin >= -1e-14
        assert fit.possible or fit.margin < 0

    def test_matter_in_the_corners_just_fits(self) -> None:
        corners = np.stack(np.meshgrid(*zip(LOW, HIGH, strict=True)), axis=-1).reshape(-1, 3)
        body = RigidBody.from_particles(np.arange(1.0, 9.0), corners)
        fit = validity.fit_in_box(body, LOW, HIGH)
        assert fit.possible
        assert fit.margin == pytest.approx(0.0, abs=1e-14)
        smaller = validity.fit_in_box(body, LOW + 1e-6, HIGH - 1e-6)
        assert not smaller.possible
        assert -1e-5 < smaller.margin < 0

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_the_axis_that_is_too_short_is_named(self, axis: int) -> None:
        body = solids.box((1.0, 1.0, 1.0), mass=2.0)
        half = np.full(3, 0.5)
        half[axis] = 0.28  # uniform matter spreads as much as corners 1/√12 = 0.289 away
        fit = validity.fit_in_box(body, -half, half)
        assert not fit.possible
        assert fit.axes == ("xyz"[axis],) * 2

    def test_a_center_outside_is_impossible(self) -> None:
        body = solids.cube(0.1, mass=1.0).translated((5.0, 5.0, 5.0))
        assert not validity.fit_in_box(body, (-1, -1, -1), (1, 1, 1)).possible

    def test_a_unit_mistaken_is_found(self) -> None:
        """A tensor in g mm² taken for kg m²: possible in itself, a million times too large for its mesh."""
        finger = solids.box((0.02, 0.02, 0.06), mass=0.05)
        wrong = RigidBody(finger.mass, finger.inertia * 1e9)
        half = np.array([0.01, 0.01, 0.03])
        assert validity.fit_in_box(finger, -half, half).possible
        assert not validity.fit_in_box(wrong, -half, half).possible

    def test_pairs_of_axes_are_decided_exactly(self, rng: np.random.Generator) -> None:
        """In the plane, against a linear program: masses on a grid of points with the same moments."""
        side = np.linspace(-1, 1, 33)
        grid = np.array([(x, y) for x in side for y in side])
        columns = np.stack([np.ones(len(grid)), *grid.T, grid[:, 0] ** 2, grid[:, 1] ** 2, grid.prod(axis=1)])
        verdicts = []
        for _ in range(150):
            center = rng.uniform(-0.9, 0.9, 2)
            spread = rng.uniform(0, 1.1, 2) * (1 - center**2)
            product = rng.uniform(-1, 1) * np.sqrt(spread.prod())
            second = np.diag([*spread, 0.0])
            second[0, 1] = second[1, 0] = product
            body = RigidBody(1.0, np.trace(second) * np.eye(3) - second, (*center, 0.0))
            margin = validity.fit_in_box(body, (-1, -1, 0), (1, 1, 0)).margin
            raw = second[:2, :2] + np.outer(center, center)
            target = [1.0, *center, raw[0, 0], raw[1, 1], raw[0, 1]]
            feasible = linprog(np.zeros(len(grid)), A_eq=columns, b_eq=target).status == 0
            inside = np.linalg.eigvalsh(second[:2, :2])[0]
            if margin < 0:
                assert not feasible
            elif margin > 2e-3 and inside > 4e-3:  # the grid is a little poorer than the square
                assert feasible
            verdicts.append(margin >= 0)
        assert 20 < sum(verdicts) < 130

    def test_stacks(self) -> None:
        bodies = solids.cube([0.5, 1.0, 3.0], mass=1.0)
        fit = validity.fit_in_box(bodies, (-0.5,) * 3, (0.5,) * 3)
        assert fit.possible.tolist() == [True, True, False]
        assert fit.axes.shape == (3, 2)
        assert fit.margin.shape == (3,)

    def test_corners_the_wrong_way_round(self) -> None:
        with pytest.raises(ValueError, match=r"low must not exceed high"):
            validity.fit_in_box(solids.cube(1.0, mass=1.0), (1, 1, 1), (-1, -1, -1))
        with pytest.raises(ValueError, match="high"):
            validity.fit_in_box(solids.cube(1.0, mass=1.0), (1, 1, 1), (2, 2, np.nan))
