"""Principal axes along a series of frames: those that were put in, whatever order and signs a frame has."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import principal_axes
from scipy.spatial.transform import Rotation

T = np.linspace(0.0, 1.0, 201)


def turned(seed: int) -> Any:
    """Axes that turn smoothly, by some turns in all."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(2, 3))
    return (
        Rotation.from_rotvec(np.outer(2 * T, a)) * Rotation.from_rotvec(np.outer(np.sin(3 * T), b))
    ).as_matrix()


def tensors(axes: Any, moments: Any) -> Any:
    found = np.einsum("tia,ta,tja->tij", axes, moments, axes)
    return 0.5 * (found + np.swapaxes(found, 1, 2))


def signed_order(first: Any, axes: Any) -> tuple[Any, Any]:
    """Which of the true axes each followed axis is in the first frame, and its sign."""
    cosines = axes[0].T @ first
    which = np.argmax(np.abs(cosines), axis=0)
    return which, np.sign(cosines[which, np.arange(3)])


@pytest.mark.parametrize("seed", range(12))
def test_moments_that_change_places(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    axes = turned(seed)
    moments = 2.0 + 0.8 * np.sin(rng.uniform(1, 7, 3) * T[:, None] + rng.uniform(0, 6, 3))
    found = principal_axes(tensors(axes, moments)).continuous()
    which, signs = signed_order(found.axes[0], axes)
    assert np.array_equal(found.order, np.argsort(np.argsort(moments[:, which], axis=1), axis=1))
    assert np.allclose(found.moments, moments[:, which], atol=1e-12)
    assert np.allclose(found.axes, axes[:, :, which] * signs, atol=1e-9)
    assert np.allclose(np.linalg.det(found.axes), 1.0)
    assert found.overlap.min() > 0.99
    assert found.determined.all()


def test_a_crossing_in_a_frame_goes_straight_on() -> None:
    """In the middle frame two moments are equal, and their axes free: the nearest ones are taken."""
    axes = turned(3)
    moments = np.stack([1.0 + T, np.full_like(T, 1.5), np.full_like(T, 2.2)], axis=1)
    assert moments[100, 0] == moments[100, 1]
    found = principal_axes(tensors(axes, moments)).continuous()
    which, signs = signed_order(found.axes[0], axes)
    assert np.allclose(found.moments, moments[:, which], atol=1e-9)
    step = np.abs(np.diff(axes, axis=0)).max()
    assert np.abs(found.axes - axes[:, :, which] * signs)[100].max() < 2 * step
    assert np.allclose(np.delete(found.axes, 100, 0), np.delete(axes[:, :, which] * signs, 100, 0), atol=1e-6)
    free = np.flatnonzero(~found.determined.all(axis=1))
    assert free.tolist() == [100]
    assert found.determined[100].sum() == 1


def test_a_spherical_frame_keeps_the_axes_before() -> None:
    frames = [np.diag((1.0, 2.0, 2.5)), 2.0 * np.eye(3), np.diag((2.5, 2.0, 1.0))]
    found = principal_axes(frames).continuous()
    assert np.array_equal(np.abs(found.axes), np.tile(np.abs(found.axes[0]), (3, 1, 1)))
    assert found.moments.tolist() == [[1.0, 2.0, 2.5], [2.0, 2.0, 2.0], [2.5, 2.0, 1.0]]
    assert not found.determined[1].any()
    assert np.array_equal(found.overlap, [1, 1, 1])


@pytest.mark.parametrize(("gap", "is_determined"), [(0.9e-6, False), (1.1e-6, True)])
def test_both_sides_of_the_tolerance(gap: float, is_determined: bool) -> None:
    c, s = np.cos(0.7), np.sin(0.7)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    middle = R @ np.diag((1.0, 1.0 + 2 * gap, 2.0)) @ R.T
    found = principal_axes([np.diag((1.0, 1.1, 2.0)), 0.5 * (middle + middle.T)]).continuous()
    assert found.determined[1].tolist() == [is_determined, is_determined, True]
    assert found.overlap[1] == pytest.approx(c if is_determined else 1.0, abs=1e-6)
    wide = principal_axes([np.diag((1.0, 1.1, 2.0)), 0.5 * (middle + middle.T)]).continuous(rtol=1e-4)
    assert not wide.determined[1, :2].any()


def test_stacks_and_axes_of_a_stack() -> None:
    pair = np.stack([tensors(turned(k), np.tile((1.0, 1.7, 2.1), (len(T), 1))) for k in (1, 2)])
    found = principal_axes(pair).continuous(axis=1)
    for k in range(2):
        alone = principal_axes(pair[k]).continuous()
        for one, other in zip(found, alone, strict=True):
            assert np.array_equal(one[k], other)
    first = principal_axes(np.swapaxes(pair, 0, 1)).continuous(axis=0)
    assert np.array_equal(np.moveaxis(first.axes, 0, 1), found.axes)
    assert np.array_equal(principal_axes(pair).continuous(-1).axes, found.axes)
    empty = principal_axes(np.zeros((0, 3, 3))).continuous()
    assert empty.axes.shape == (0, 3, 3)


def test_coarse_frames_are_told() -> None:
    found = principal_axes(
        [
            np.diag((1.0, 2.0, 3.0)),
            Rotation.from_euler("z", 40, degrees=True).as_matrix()
            @ np.diag((1.0, 2.0, 3.0))
            @ Rotation.from_euler("z", -40, degrees=True).as_matrix(),
        ]
    ).continuous()
    assert found.overlap[1] == pytest.approx(np.cos(np.deg2rad(40)))


def test_refused() -> None:
    one = principal_axes(np.eye(3))
    with pytest.raises(ValueError, match=r"axis: 0 is no axis of a stack of shape \(\)"):
        one.continuous()
    with pytest.raises(ValueError, match=r"axis: -2 is no axis"):
        principal_axes([np.eye(3)]).continuous(-2)
    with pytest.raises(ValueError, match="is not a tolerance"):
        principal_axes([np.eye(3)]).continuous(rtol=-1.0)


@pytest.mark.parametrize("rtol", [10**400, [1e-6, 1e-6], -1.0, np.nan, np.inf])
def test_what_is_no_tolerance(rtol: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="rtol: "):
        principal_axes([np.eye(3), np.eye(3)]).continuous(rtol=rtol)


def test_a_tolerance_at_which_all_moments_are_equal() -> None:
    frames = principal_axes([np.diag((1.0, 2.0, 3.0)), np.diag((2.0, 1.0, 3.0))])
    assert not frames.continuous(rtol=1e308).determined.any()
