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
    """Frequencies of the light curve of a tumbling body, ``|j f_φ + m f_ψ|``, in cycles per unit of time.

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
        Period P_ψ, after which the components of ω in the body repeat. In long-axis mode the body turns once
        about its long axis in this time; in short-axis mode the long axis swings once to and fro. For a
        steady spin about axis 1 or 3 it is the period of small oscillations about that spin. It is infinite
        on the separatrix, for a steady spin about axis 2, and for a spherical body.
    precession : float or numpy.ndarray, shape (...)
        Period P_φ: the mean time in which axis 1 goes once round L.
    flip : float or numpy.ndarray, shape (...)
        Time from one turning over of the intermediate axis to the next, half of `rotation`.
    rates : numpy.ndarray, shape (..., 3)
        Mean rate, in radians per unit of time, at which each principal axis goes about L. The two axes that ω
        does not circle have the same rate. In short-axis mode the rate of axis 3 is larger than theirs by
        2π/P_ψ; in long-axis mode the rate of axis 1 is smaller than theirs by 2π/P_ψ. NaN without angular
        momentum.
    """

    _motion: _core.FreeMotion | None = None
    """Of an uncertain motion, that motion."""

    @cached_property
    def sigma(self) -> PeriodsSigma | None:
        """Standard deviations of the periods; None if neither body nor initial angular velocity is uncertain.

        Examples
        --------
        >>> from polhode import RigidBody, Uncertain
        >>> brick = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> periods = brick.free_motion(Uncertain((0.3, 0.2, 1.1), sigma=0.001)).periods
        >>> round(periods.rotation, 3), round(float(periods.sigma.rotation), 4)
        (9.43, 0.0088)
        """
        return None if self._motion is None else self._motion._periods_sigma()

    @property
    def precession_short_axis(self) -> Any:
        """P_φ in the short-axis convention: the mean time in which axis 3 goes once round L.

        In that convention P_ψ is the period of the rotation about axis 3 in short-axis mode, and of the swing
        of axis 3 to and fro in long-axis mode. Its value is that of `rotation` in both conventions, and
        ``1/P_φ(short) = 1/P_φ(long) + 1/P_ψ``.
        """
        return (2.0 * np.pi / self.rates[..., 2])[()]

    def light_curve(self, order: int = 2) -> LightCurve:
        """Give the frequencies at which the brightness of the body can vary, seen from a fixed direction.

        Parameters
        ----------
        order : int
            The greatest ``|j|`` and ``|m|``.

        Returns
        -------
        LightCurve
            One frequency for each pair (j, m) up to `order`. Since (j, m) and (−j, −m) have the same
            frequency, only one of them is listed: that with j > 0, or with j = 0 and m > 0. The pair (0, 0)
            is the constant part and is left out.

        Notes
        -----
        The brightness depends on the attitude alone, that is, on the three Euler angles. One part of each
        angle has the period P_ψ. The rest of φ grows uniformly, by one turn in P_φ; the rest of ψ is constant
        or grows by one turn in P_ψ. The brightness is therefore a Fourier series with the frequencies ``j f_φ
        + m f_ψ``, where ``f_φ = 1/P_φ`` and ``f_ψ = 1/P_ψ`` (M. Kaasalainen, Astron. Astrophys. 376 (2001)
        302). In the short-axis convention the frequencies are the same, with m − j in place of m.

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
    """Half opening angles of the body cone and of the space cone, in radians.

    For a symmetric body the cones are circular: least and greatest angle are equal.

    Attributes
    ----------
    axis : int or numpy.ndarray, shape (...)
        The principal axis that ω circles in the body, as an index counted from 0: 0 stands for axis 1, of the
        least moment, and 2 for axis 3, of the greatest. It is the column of ``body.principal.axes``.
    body : numpy.ndarray, shape (..., 2)
        Least and greatest angle between ω and that axis, measured from the end of the axis that is nearer to
        ω.
    space : numpy.ndarray, shape (..., 2)
        Least and greatest angle between ω and L.
    """

    axis: Any
    body: Floats
    space: Floats

    def __repr__(self) -> str:
        return short(self)


class Poinsot(NamedTuple):
    """Poinsot's construction: the ellipsoid ``ω·I ω = 2T`` and the fixed plane on which it rolls.

    Attributes
    ----------
    semi_axes : numpy.ndarray, shape (..., 3)
        ``√(2T/I_k)`` along the principal axes; infinite for a zero moment.
    normal : numpy.ndarray, shape (..., 3)
        Normal of the plane, in space: the direction of L.
    distance : float or numpy.ndarray, shape (...)
        Distance of the plane from C: ``2T/L``.
    radii : numpy.ndarray, shape (..., 2)
        Least and greatest distance of the herpolhode from the foot of the perpendicular from C.
    contact : numpy.ndarray, shape (..., 3)
        Point of contact at each time, components in space: the tip of ω. The axes are those of the stack,
        then those of the times.
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

    δ is a small rotation from the attitude R, ``R → R exp(δ×)``, components in the body frame, in radians.

    Attributes
    ----------
    state : numpy.ndarray, shape (..., 6, 6)
        Derivatives of (δ, ω) at time t by (δ, ω) at t = 0.
    moments : numpy.ndarray, shape (..., 6, 3)
        Derivatives of (δ, ω) at time t by the principal moments in ascending order, with axes and initial
        state fixed. NaN for a body with a zero moment.
    """

    state: Floats
    moments: Floats

    def __repr__(self) -> str:
        return short(self)


class ErrorBar(NamedTuple):
    """Bounds to first order on the errors of a state, caused by errors of its input.

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
