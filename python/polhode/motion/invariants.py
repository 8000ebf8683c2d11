"""Changes of conserved quantities along a motion, relative to their size; norms without overflow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "changes",
    "drift",
    "lengths",
]


def lengths(vectors: Any) -> NDArray[np.float64]:
    """Return the Euclidean norms along the last axis, without overflow or underflow."""
    vectors = np.asarray(vectors, dtype=float)
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    power = np.frexp(np.where(np.isfinite(largest), largest, 1.0))[1]
    near = np.linalg.norm(np.ldexp(vectors, -power), axis=-1)
    return np.asarray(np.ldexp(near, power[..., 0]))


def changes(values: Floats, size: Floats) -> tuple[Floats, Floats]:
    """Return the sizes of the changes since the start, and the largest size during the motion.

    Parameters
    ----------
    values : numpy.ndarray, shape (..., T) or (..., T, 3)
        Numbers or vectors.
    size : numpy.ndarray, shape (..., T)
        What their changes are compared with.

    Returns
    -------
    change : numpy.ndarray, shape (..., T)
    largest : numpy.ndarray, shape (...)
    """
    are_vectors = values.ndim > size.ndim
    change = values - (values[..., :1, :] if are_vectors else values[..., :1])
    return lengths(change) if are_vectors else np.abs(change), np.nanmax(size, axis=-1)


def drift(values: Floats, size: Floats) -> Any:
    """Return the largest change since the start, relative to the largest size; see :func:`changes`."""
    change, largest = changes(values, size)
    found = np.divide(
        np.nanmax(change, axis=-1), largest, out=np.zeros_like(largest), where=np.asarray(largest > 0)
    )
    return found if found.ndim else float(found)
