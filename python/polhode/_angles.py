"""Euler angles along a motion, and their rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["euler_angles", "euler_rates"]


def euler_angles(
    self: Trajectory,
    sequence: str = "ZXZ",
    singular: Literal["raise", "nan"] = "raise",
    *,
    unwrap: bool = False,
    degrees: bool = False,
) -> Floats:
    """Euler angles of the attitude at every time.

    Parameters
    ----------
    sequence : str
        As in :mod:`polhode.euler_angles`; the default is the (phi, theta, psi) of Goldstein and Landau.
    singular : {"raise", "nan"}
        What to do at an attitude at which two of the angles are not defined; ``np.isnan`` of the result
        is the mask of those.
    unwrap : bool
        Whether the first and the third angle are counted on over many turns. Each then changes by less than
        half a turn from one time to the next at which it is defined. By default each is within its range.
    degrees : bool
        Give degrees.

    Returns
    -------
    numpy.ndarray, shape (..., T, 3)
        In radians unless `degrees`.
    """
    if unwrap:
        self._check_series("euler_angles, unwrap")
    angles = _core.euler_angles_from_quaternion(self.quaternion, sequence, singular)
    angles = _unwrapped(angles) if unwrap else angles
    return np.rad2deg(angles) if degrees else angles


def euler_rates(
    self: Trajectory,
    sequence: str = "ZXZ",
    singular: Literal["raise", "nan"] = "raise",
    *,
    degrees: bool = False,
) -> Floats:
    """Rates of the Euler angles at every time.

    Parameters
    ----------
    sequence : str
        As in :mod:`polhode.euler_angles`; the default is the (phi, theta, psi) of Goldstein and Landau.
    singular : {"raise", "nan"}
        What to do at an attitude at which the angles or their rates are not defined.
    degrees : bool
        Give degrees per time.

    Returns
    -------
    numpy.ndarray, shape (..., T, 3)
        In radians per time unless `degrees`.
    """
    angles = self.euler_angles(sequence, singular)
    rates = _core.euler_rates(angles, self.omega, sequence, "body", singular)
    return np.rad2deg(rates) if degrees else rates


def _unwrapped(angles: Floats) -> Floats:
    """Unwrap angles (..., T, 3) along the times, over gaps that are not numbers."""
    columns = np.moveaxis(angles, -2, -1)
    series = columns.reshape(-1, columns.shape[-1]).copy()
    for one in series:
        known = ~np.isnan(one)
        one[known] = np.unwrap(one[known])
    return np.moveaxis(series.reshape(columns.shape), -1, -2)
