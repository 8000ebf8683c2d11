"""Bodies of voxels beside separable sums in NumPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from harness import Row
from polhode import RigidBody

if TYPE_CHECKING:
    from collections.abc import Iterator


def separable(density: Any) -> Any:
    """Inertia of unit cells about the centre of mass, from three plane sums and each cell's own extent."""
    x, y, z = (np.arange(n) - (n - 1) / 2 for n in density.shape)
    xy, xz, yz = (density.sum(axis, dtype=np.float64) for axis in (2, 1, 0))
    mass = xy.sum()
    first = np.array([xy.sum(1) @ x, xy.sum(0) @ y, xz.sum(0) @ z])
    squares = np.array([xy.sum(1) @ x**2, xy.sum(0) @ y**2, xz.sum(0) @ z**2])
    second = np.diag(squares + mass / 12)
    second[0, 1], second[0, 2], second[1, 2] = x @ xy @ y, x @ xz @ z, y @ yz @ z
    second = second + np.triu(second, 1).T - np.outer(first, first) / mass
    return np.trace(second) * np.eye(3) - second


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""
    density = np.random.default_rng(1).uniform(0, 1, (256, 256, 256)).astype(np.float32)

    def same_inertia(ours: RigidBody, theirs: Any) -> None:
        assert np.abs(ours.inertia - theirs).max() < 1e-12 * np.abs(theirs).max()

    yield Row(
        name="256^3 voxels, float32",
        peer="numpy: separable sums",
        ours=lambda: RigidBody.from_voxels(density, 1.0),
        theirs=lambda: separable(density),
        compare=same_inertia,
        items=density.size,
        at_least=2,
    )
    double = density[:128].astype(np.float64)
    yield Row(
        name="128 x 256^2 voxels, float64",
        peer="numpy: separable sums",
        ours=lambda: RigidBody.from_voxels(double, 1.0),
        theirs=lambda: separable(double),
        compare=same_inertia,
        items=double.size,
    )
