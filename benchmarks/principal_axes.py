"""Principal axes beside NumPy's symmetric eigensolver."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
from harness import Row

if TYPE_CHECKING:
    from collections.abc import Iterator

COUNT = 1_000_000
# Without fused multiply-add the lanes are two floats wide.
LEAST = 10 if os.environ.get("POLHODE_LEVEL") == "baseline" else 30


def inertia_tensors(count: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Tensors of random bodies: I = tr(S) 1 − S of second moments from twenty particles each."""
    rng = np.random.default_rng(1)
    positions = rng.normal(size=(count, 20, 3)) * rng.uniform(0.3, 1.0, size=(count, 1, 3))
    second = np.swapaxes(positions, 1, 2) @ positions
    return np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    tensors = inertia_tensors(COUNT)
    one = tensors[0].copy()

    def same(ours: Any, theirs: Any) -> None:
        moments, axes = ours
        size = np.abs(theirs.eigenvalues).max(axis=-1, keepdims=True)
        assert np.abs((moments - theirs.eigenvalues) / size).max() < 4e-15
        rebuilt = (axes * moments[..., None, :]) @ np.swapaxes(axes, -1, -2)
        given = tensors if axes.ndim == 3 else one
        assert np.abs((rebuilt - given) / size[..., None]).max() < 4e-15

    def ours(inertia: Any) -> Any:
        found = polhode.principal_axes(inertia)
        return found.moments, found.axes

    def same_moments(ours: Any, theirs: Any) -> None:
        assert np.abs((ours - theirs) / np.abs(theirs).max(axis=-1, keepdims=True)).max() < 4e-15

    yield Row(
        name="moments and axes, 1e6 tensors",
        peer="numpy.linalg.eigh",
        ours=lambda: ours(tensors),
        theirs=lambda: np.linalg.eigh(tensors),
        compare=same,
        items=COUNT,
        at_least=LEAST,
    )
    yield Row(
        name="moments alone, 1e6 tensors",
        peer="numpy.linalg.eigvalsh",
        ours=lambda: polhode.principal_moments(tensors),
        theirs=lambda: np.linalg.eigvalsh(tensors),
        compare=same_moments,
        items=COUNT,
        at_least=LEAST,
    )
    yield Row(
        name="moments and axes, one tensor",
        peer="numpy.linalg.eigh",
        ours=lambda: ours(one),
        theirs=lambda: np.linalg.eigh(one),
        compare=same,
        at_most=0.4,
    )
