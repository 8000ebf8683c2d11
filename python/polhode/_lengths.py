"""Lengths of vectors of any size: squares of 1e200 would overflow, so a power of two is taken out first."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["lengths"]


def lengths(vectors: Any) -> NDArray[np.float64]:
    """Give the Euclidean norms along the last axis, without overflow or underflow."""
    vectors = np.asarray(vectors, dtype=float)
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    power = np.frexp(np.where(np.isfinite(largest), largest, 1.0))[1]
    near = np.linalg.norm(np.ldexp(vectors, -power), axis=-1)
    return np.asarray(np.ldexp(near, power[..., 0]))
