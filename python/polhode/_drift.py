"""Drift of conserved quantities: how far they have changed since the start, relative to their size."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._lengths import lengths

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["changes", "drift"]


def changes(values: Floats, size: Floats) -> tuple[Floats, Floats]:
    """Give the sizes of the changes since the start, and the largest size on the way.

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
    """Give the largest change since the start, relative to the largest size; see :func:`changes`."""
    change, largest = changes(values, size)
    found = np.divide(
        np.nanmax(change, axis=-1), largest, out=np.zeros_like(largest), where=np.asarray(largest > 0)
    )
    return found if found.ndim else float(found)
