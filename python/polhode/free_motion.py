"""What a free motion tells: tuples of numbers that `FreeMotion` computes."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._repr import short

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import _core
    from polhode.uncertainty.motions import PeriodsSigma

    Floats = NDArray[np.float64]

__all__ = ["Cones", "ErrorBar", "LightCurve", "Periods", "Poinsot", "Sensitivity"]


_MOST_ORDER: Final = 100


class LightCurve(NamedTuple):
    """Frequencies of the light curve of a tumbling body, ``|j f_φ + m f_ψ|``, in turns a unit of time.

    Attributes
    ----------
    j, m : numpy.ndarray of int, shape (k,)
        Multiples of ``f_φ = 1/P_φ`` and of ``f_ψ = 1/P_ψ``.
    frequency : numpy.ndarray, shape (..., k)
    """

    j: NDArray[np.int64]
    m: NDArray[np.int64]
    frequency: Floats

    def __repr__(self) -> str:
        return short(self)


class _Periods(NamedTuple):
    rotation: Any
    precession: Any
    flip: Any
    rates: Floats


class Periods(_Periods):
    """The periods of a free motion, in the long-axis convention of tumbling asteroids.

    The Euler angles (ZXZ) refer to axis 1, of the least moment, with L along z. Periods are in
    the unit of time of the motion.

    Attributes
    ----------
    rotation : float or numpy.ndarray, shape (...)
        Period P_ψ after which ω in the body repeats: that of the rotation about the long axis in long-axis
        mode, that of the swing of the long axis to and fro in short-axis mode. Infinite on the separatrix
        and where ω is constant in the body for any start; for a steady spin about axis 1 or 3 the period of
        small oscillations about it.
    precession : float or numpy.ndarray, shape (...)
        Period P_φ, the mean one in which axis 1 goes round L.
    flip : float or numpy.ndarray, shape (...)
        Time from one turning over of the intermediate axis to the next, half of `rotation`.
    rates : numpy.ndarray, shape (..., 3)
        Mean rate, in radians a unit of time, at which each principal axis goes about L. The two axes that are
        not circled share theirs; axis 3, where it is circled, is ahead of them by 2π/P_ψ, axis 1 behind. NaN
        without angular momentum.
    """

    _motion: _core.FreeMotion | None = None
    """Of an uncertain motion, that motion."""

    @cached_property
    def sigma(self) -> PeriodsSigma | None:
        """Standard deviations, from those of the body and of the angular velocity; None where there are none.

        Examples
        --------
        >>> from polhode import RigidBody, Uncertain
        >>> brick = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> periods = brick.free_motion(Uncertain((0.3, 0.2, 1.1), sigma=0.001)).periods
        >>> round(periods.rotation, 3), round(periods.sigma.rotation, 3)
        (10.884, 0.012)
        """
        return None if self._motion is None else self._motion._periods_sigma()

    @property
    def precession_short_axis(self) -> Any:
        """P_φ in the short-axis convention: the mean period of axis 3, of the greatest moment, about L.

        In that convention P_ψ is of the rotation about axis 3 in short-axis mode and of its swinging to and
        fro in long-axis mode, and has the same value; ``1/P_φ(short) = 1/P_φ(long) + 1/P_ψ``.
        """
        return (2.0 * np.pi / self.rates[..., 2])[()]

    def light_curve(self, order: int = 2) -> LightCurve:
        """Tell at which frequencies the brightness of the body can vary, seen from a direction that stays.

        Parameters
        ----------
        order : int
            The greatest ``|j|`` and ``|m|``.

        Returns
        -------
        LightCurve
            All pairs but (0, 0), of two opposite ones the one with j > 0, or j = 0 and m > 0.

        Notes
        -----
        The brightness is a function of the attitude, so periodic in φ and in ψ, but for what swings with
        P_ψ: a Fourier series in ``j f_φ + m f_ψ`` (M. Kaasalainen, Astron. Astrophys. 376 (2001) 302).
        The other convention has the same frequencies, with m - j in place of m.

        Examples
        --------
        >>> from polhode import RigidBody
        >>> toutatis = RigidBody.from_principal(1.0, (1.0, 3.01307, 3.18992))
        >>> periods = toutatis.free_motion_from_periods(5.41, 7.35).periods
        >>> found = periods.light_curve(order=1)
        >>> dict(zip(zip(found.j.tolist(), found.m.tolist()), found.frequency.round(4).tolist()))
        {(0, 1): 0.1848, (1, -1): 0.0488, (1, 0): 0.1361, (1, 1): 0.3209}
        """
        if isinstance(order, bool) or not isinstance(order, int) or not 1 <= order <= _MOST_ORDER:
            raise ValueError(f"order: {order!r} is not a whole number from 1 to {_MOST_ORDER}")
        pairs = [(0, m) for m in range(1, order + 1)]
        pairs += [(j, m) for j in range(1, order + 1) for m in range(-order, order + 1)]
        j, m = np.array(pairs).T
        precession, rotation = (np.asarray(x)[..., np.newaxis] for x in (self.precession, self.rotation))
        return LightCurve(j, m, np.abs(j / precession + m / rotation))

    def __repr__(self) -> str:
        return short(self)


class Cones(NamedTuple):
    """Body cone and space cone, half their openings in radians; round for a symmetric body.

    Attributes
    ----------
    axis : int or numpy.ndarray, shape (...)
        The principal axis that ω circles in the body, 0 or 2, on the side of ω.
    body : numpy.ndarray, shape (..., 2)
        Least and greatest angle between ω and that axis.
    space : numpy.ndarray, shape (..., 2)
        Least and greatest angle between ω and L.
    """

    axis: Any
    body: Floats
    space: Floats

    def __repr__(self) -> str:
        return short(self)


class Poinsot(NamedTuple):
    """The ellipsoid ``ω·I ω = 2T``, fixed in the body about C, and the plane in space on which it rolls.

    Attributes
    ----------
    semi_axes : numpy.ndarray, shape (..., 3)
        ``√(2T/I_k)`` along the principal axes; infinite for a zero moment.
    normal : numpy.ndarray, shape (..., 3)
        Normal of the plane, in space: the direction of L.
    distance : float or numpy.ndarray, shape (...)
        ``2T/L``, of the plane from C.
    radii : numpy.ndarray, shape (..., 2)
        Least and greatest distance of the herpolhode from the foot of the perpendicular from C.
    contact : numpy.ndarray, shape (..., 3)
        Where they touch at each time, in space: the tip of ω. The shape of the stack, then that of the times.
    """

    semi_axes: Floats
    normal: Floats
    distance: Any
    radii: Floats
    contact: Floats

    def __repr__(self) -> str:
        return short(self)


class Sensitivity(NamedTuple):
    """Derivatives of the state of a free body.

    δ is a small rotation, ``R → R exp(δ×)``, components in the body frame.

    Attributes
    ----------
    state : numpy.ndarray, shape (..., 6, 6)
        Derivatives of (δ, ω) at the time by (δ, ω) at t = 0.
    moments : numpy.ndarray, shape (..., 6, 3)
        Derivatives of (δ, ω) at the time by the principal moments, ascending, with axes and initial state
        held. NaN for a body with a zero moment.
    """

    state: Floats
    moments: Floats

    def __repr__(self) -> str:
        return short(self)


class ErrorBar(NamedTuple):
    """Bounds on the error of a state, to first order, from errors of what it is computed from.

    Attributes
    ----------
    attitude : float or numpy.ndarray, shape (...)
        Angle in radians.
    omega : float or numpy.ndarray, shape (...)
        Length of the error of the angular velocity.
    """

    attitude: Any
    omega: Any

    def __repr__(self) -> str:
        return short(self)
