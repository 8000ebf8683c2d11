"""Which row of what has one shape each row of a stack takes."""

from __future__ import annotations

import numpy as np

__all__ = ["rows_of"]


def rows_of(shape: tuple[int, ...], stack: tuple[int, ...]) -> list[int]:
    """Which row of what has one shape each row of a stack takes."""
    rows = np.arange(np.prod(shape, dtype=int)).reshape(shape)
    taken: list[int] = np.broadcast_to(rows, stack).ravel().tolist()
    return taken
