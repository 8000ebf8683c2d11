"""The ellipsoid of inertia that is drawn: its semi-axes and its sections by the principal planes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["inertia_semi_axes", "principal_circles"]

_LONGEST: Final = 3.0
"""A semi-axis without end, that of a zero moment, is cut at so many times the longest other one."""


def inertia_semi_axes(moments: Floats) -> Floats:
    """Semi-axes of r·I r = 1, shape (3,); those of zero moments are cut.

    Parameters
    ----------
    moments : numpy.ndarray, shape (3,)
        Principal moments, not all zero.
    """
    if not moments.any():
        raise ValueError("body: all its moments are zero; a point has no ellipsoid of inertia")
    with np.errstate(divide="ignore"):
        semi_axes: Floats = 1.0 / np.sqrt(moments)
    longest = semi_axes[np.isfinite(semi_axes)].max()
    cut: Floats = np.minimum(semi_axes, _LONGEST * longest)
    return cut


def principal_circles() -> Floats:
    """Circles of the unit sphere in the planes normal to its axes, shape (3, 181, 3)."""
    around = np.linspace(0.0, 2.0 * np.pi, 181)
    circles = np.zeros((3, 181, 3))
    for k, circle in enumerate(circles):
        circle[:, (k + 1) % 3], circle[:, (k + 2) % 3] = np.cos(around), np.sin(around)
    return circles
