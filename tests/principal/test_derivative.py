"""Derivatives of principal moments and axes, against mpmath's eigenvectors at 60 digits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from oracles.eigen_cases import matrices, symmetric
from polhode import principal_axes
from polhode.errors import InvalidInertiaError

STEP = mpmath.mpf(10) ** -20


def eigensystem(a: mpmath.matrix, like: np.ndarray) -> tuple[mpmath.matrix, mpmath.matrix]:
    """Eigenvalues and eigenvectors, the latter in the directions of `like`."""
    values, vectors = mpmath.eigsy(a)
    for k in range(3):
        if mpmath.fdot(vectors[:, k], mpmath.matrix(like[:, k].tolist())) < 0:
            vectors[:, k] = -vectors[:, k]
    return values, vectors


@pytest.mark.parametrize("name", ["random", "bodies", "indefinite"])
def test_against_central_differences_at_sixty_digits(name: str) -> None:
    tensors = matrices(name)[:40]
    tangents = symmetric(np.random.default_rng(1).normal(size=tensors.shape))
    principal = principal_axes(tensors)
    found = principal.derivative(tangents)
    assert not found.degenerate.any()
    for row, (tensor, tangent) in enumerate(zip(tensors, tangents, strict=True)):
        with mpmath.workdps(60):
            a, t = mpmath.matrix(tensor.tolist()), mpmath.matrix(tangent.tolist()) * STEP
            w1, v1 = eigensystem(a + t, principal.axes[row])
            w0, v0 = eigensystem(a - t, principal.axes[row])
            moments = np.array(((w1 - w0) / (2 * STEP)).tolist(), dtype=float).ravel()
            axes = np.array(((v1 - v0) / (2 * STEP)).tolist(), dtype=float)
        norm = np.abs(tangent).max()
        gap = np.diff(principal.moments[row]).min() / np.abs(principal.moments[row]).max()
        np.testing.assert_allclose(found.moments[row], moments, atol=2e-15 * norm / gap)
        np.testing.assert_allclose(found.axes[row], axes, atol=4e-15 * np.abs(axes).max() / gap)


def test_degenerate_pairs_are_reported() -> None:
    rng = np.random.default_rng(2)
    tangent = symmetric(rng.normal(size=(3, 3)))
    for moments, expected in [
        ([1.0, 1.0, 2.0], [True, False, False]),
        ([1.0, 2.0, 2.0], [False, False, True]),
        ([2.0, 2.0, 2.0], [True, True, True]),
        ([1.0, 2.0, 2.0 + 1e-9], [False, False, False]),
    ]:
        principal = principal_axes(np.diag(moments))
        found = principal.derivative(tangent)
        assert found.degenerate.tolist() == expected
        assert found.moments.sum() == pytest.approx(np.trace(tangent), abs=1e-15)
        assert np.isfinite(found.axes).all()
        for pair, equal in zip([(0, 1), (0, 2), (1, 2)], expected, strict=True):
            i, j = pair
            rate = principal.axes[:, i] @ found.axes[:, j]
            assert (rate == 0.0) == equal
    assert principal_axes(np.diag([1.0, 2.0, 2.0 + 1e-9])).derivative(tangent, rtol=1e-6).degenerate[2]


def test_the_axes_turn_as_a_rotation() -> None:
    tensors = matrices("bodies")
    principal = principal_axes(tensors)
    turning = np.swapaxes(principal.axes, 1, 2) @ principal.derivative(np.diag([1.0, 2.0, 4.0])).axes
    np.testing.assert_allclose(turning, -np.swapaxes(turning, 1, 2), atol=1e-14 * np.abs(turning).max())


def test_shapes_broadcast() -> None:
    principal = principal_axes(matrices("bodies")[:6].reshape(2, 3, 3, 3))
    found = principal.derivative(np.zeros((4, 1, 1, 3, 3)))
    assert found.moments.shape == (4, 2, 3, 3)
    assert found.axes.shape == (4, 2, 3, 3, 3)
    assert found.degenerate.shape == (4, 2, 3, 3)
    assert found.degenerate.dtype == bool


def test_an_asymmetric_tangent_is_an_error() -> None:
    with pytest.raises(InvalidInertiaError, match="tangent"):
        principal_axes(np.eye(3)).derivative([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
