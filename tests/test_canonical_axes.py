"""Canonical axes: where a body leaves its axes free, those nearest to the body frame."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.eigen_cases import symmetric
from polhode import principal_axes
from scipy.spatial.transform import Rotation

TOPS = {"oblate": [1.0, 1.0, 1.5], "prolate": [1.0, 2.0, 2.0], "linear": [0.0, 2.0, 2.0]}


def turned(moments: list[float], turns: np.ndarray) -> np.ndarray:
    return symmetric(np.einsum("nij,j,nkj->nik", turns, moments, turns))


@pytest.mark.parametrize("scale", [1e-300, 1e-47, 1.0, 1e37, 1e300])
def test_a_sphere_has_the_axes_of_the_body(scale: float) -> None:
    noise = 1e-9 * np.random.default_rng(1).normal(size=(100, 3, 3))
    spheres = scale * (np.eye(3) + noise + np.swapaxes(noise, 1, 2))
    np.testing.assert_array_equal(
        principal_axes(spheres, canonical=True).axes, np.broadcast_to(np.eye(3), spheres.shape)
    )


@pytest.mark.parametrize("moments", TOPS.values(), ids=TOPS)
def test_tops_in_the_body_frame_have_its_axes(moments: list[float]) -> None:
    np.testing.assert_array_equal(principal_axes(np.diag(moments), canonical=True).axes, np.eye(3))


@pytest.mark.parametrize("moments", TOPS.values(), ids=TOPS)
def test_the_pair_takes_the_direction_of_the_nearest_body_axis(moments: list[float]) -> None:
    turns = Rotation.random(300, np.random.default_rng(2)).as_matrix()
    tensors = turned(moments, turns)
    found = principal_axes(tensors, canonical=True)
    symmetry, first = (2, 0) if moments[0] == moments[1] else (0, 1)
    n, p = found.axes[:, :, symmetry], found.axes[:, :, first]
    k = np.abs(n).argmin(axis=1)
    expected = np.eye(3)[k] - n * np.take_along_axis(n, k[:, None], 1)
    expected /= np.linalg.norm(expected, axis=1)[:, None]
    np.testing.assert_allclose(p, expected, atol=4e-16)
    # Still principal axes, a rotation, and under the sign rule.
    back = np.einsum("nij,nj,nkj->nik", found.axes, found.moments, found.axes)
    np.testing.assert_allclose(back, tensors, atol=4e-15)
    np.testing.assert_allclose(
        np.cross(found.axes[:, :, 0], found.axes[:, :, 1]), found.axes[:, :, 2], atol=4e-16
    )
    for column in range(2):
        v = found.axes[:, :, column]
        leading = (np.abs(v) >= (1 - 1e-8) * np.abs(v).max(axis=1, keepdims=True)).argmax(axis=1)
        assert (v[np.arange(len(v)), leading] > 0).all()


def test_the_last_bits_of_a_top_do_not_turn_its_axes() -> None:
    rng = np.random.default_rng(3)
    turns = np.repeat(Rotation.random(1, rng).as_matrix(), 200, axis=0)
    top = turned([1.0, 1.0, 1.5], turns)
    noise = 1e-15 * rng.normal(size=top.shape)
    axes = principal_axes(symmetric(top + noise), canonical=True).axes
    assert np.ptp(axes, axis=0).max() < 1e-13
    assert np.ptp(principal_axes(symmetric(top + noise)).axes, axis=0).max() > 0.1


def test_three_different_moments_leave_nothing_free() -> None:
    tensors = turned([1.0, 2.0, 2.5], Rotation.random(20, np.random.default_rng(4)).as_matrix())
    np.testing.assert_array_equal(principal_axes(tensors, canonical=True).axes, principal_axes(tensors).axes)


def test_rows_and_stacks_agree() -> None:
    turns = Rotation.random(30, np.random.default_rng(5)).as_matrix()
    tensors = np.concatenate([turned(moments, turns) for moments in TOPS.values()])
    stack = principal_axes(tensors, canonical=True)
    for row, tensor in enumerate(tensors):
        np.testing.assert_array_equal(principal_axes(tensor, canonical=True).axes, stack.axes[row])


def test_what_is_not_a_number_stays_so() -> None:
    assert np.isnan(principal_axes(np.full((3, 3), np.nan), canonical=True).axes).all()
