"""Symmetric tops: precession and nutation damping of a free top, and steady motions of a heavy top.

I_s is the moment about the symmetry axis and I_t that about an axis across it. For a free top both axes pass
through the centre of mass (or a fixed point), for a heavy top through the pivot, which is the origin of the
body frame.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode._core import free_precession, least_spin, nutation_damping, steady_precession
from polhode._format import short

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "NutationDamping",
    "free_precession",
    "least_spin",
    "nutation_damping",
    "steady_precession",
]


class NutationDamping(NamedTuple):
    """Effect of a small slug on the nutation of a free symmetric top: ``tan θ = tan θ0 exp(rate t)``.

    Attributes
    ----------
    rate : float or numpy.ndarray, shape (...)
        Positive: the angle θ between the symmetry axis and L grows to a right angle; negative: it decays.
    """

    rate: Any

    @property
    def time_constant(self) -> Any:
        """``1/|rate|``; infinite for three equal moments."""
        with np.errstate(divide="ignore"):
            return np.true_divide(1.0, np.abs(self.rate))[()]

    @property
    def verdict(self) -> Any:
        """Result as a word: ``"damps"``, ``"flat spin"``, or ``"neutral"`` for three equal moments."""
        words = np.array(["damps", "neutral", "flat spin"])[np.sign(self.rate).astype(int) + 1]
        return words if words.ndim else str(words)

    def angle(self, start_angle: ArrayLike, t: ArrayLike, *, degrees: bool = False) -> Any:
        """Compute θ at a time after it was `start_angle`, both from 0 to a right angle.

        Parameters
        ----------
        start_angle, t : array_like, shape (...)
        degrees : bool
            Both angles are in degrees.

        Returns
        -------
        float or numpy.ndarray, shape (...)
            In radians unless `degrees`.
        """
        start_angle = np.deg2rad(start_angle) if degrees else start_angle
        grown = np.multiply(self.rate, t)
        across = np.sin(start_angle) * np.exp(np.minimum(grown, 0.0))
        found = np.arctan2(across, np.cos(start_angle) * np.exp(-np.maximum(grown, 0.0)))[()]
        return np.rad2deg(found) if degrees else found

    def time(self, start_angle: ArrayLike, end_angle: ArrayLike, *, degrees: bool = False) -> Any:
        """Time from `start_angle` to `end_angle`; negative if θ moves the other way.

        Parameters
        ----------
        start_angle, end_angle : array_like, shape (...)
            Between 0 and a right angle, in radians unless `degrees`.
        degrees : bool
            Both angles are in degrees.

        Returns
        -------
        float or numpy.ndarray, shape (...)
        """
        if degrees:
            start_angle, end_angle = np.deg2rad(start_angle), np.deg2rad(end_angle)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.true_divide(np.log(np.tan(end_angle)) - np.log(np.tan(start_angle)), self.rate)[()]

    def __repr__(self) -> str:
        return short(self)


class FreePrecession(NamedTuple):
    """Precession of a torque-free symmetric top.

    The symmetry axis n, ω and L lie in one plane, which turns about L. I_s is the moment about n, I_t that
    across it. Rates are in radians per unit of time, angles in radians.

    Attributes
    ----------
    axis : numpy.ndarray, shape (..., 3)
        Symmetry axis n in the body frame, on the side of ω.
    body_rate : float or numpy.ndarray, shape (...)
        ``(I_s − I_t) ω_s/I_t``: ω and L circle about n, seen from the body. Negative for a prolate top.
    space_rate : float or numpy.ndarray, shape (...)
        ``L/I_t``: n and ω circle about L, seen from space.
    body_cone, space_cone : float or numpy.ndarray, shape (...)
        Half the opening of the body cone (between n and ω) and of the space cone (between L and ω).
    nutation : float or numpy.ndarray, shape (...)
        Between n and L.
    """

    axis: Floats
    body_rate: Any
    space_rate: Any
    body_cone: Any
    space_cone: Any
    nutation: Any

    def __repr__(self) -> str:
        return short(self)
