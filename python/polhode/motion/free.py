"""Results of a free motion: tuples of numbers that `FreeMotion` computes."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._format import short

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import _core
    from polhode.uncertainty.motion import PeriodsSigma

    Floats = NDArray[np.float64]

__all__ = ["Cones", "ErrorBar", "LightCurve", "Periods", "Poinsot", "Sensitivity"]


_MOST_ORDER: Final = 100


class LightCurve(NamedTuple):
    """Frequencies of the light curve of a free body, ``|j f_φ + m f_ψ|``, in cycles per unit of time.

    Attributes
    ----------
    j, m : numpy.ndarray of int, shape (k,)
        Multiples of ``f_φ = 1/P_φ`` and of ``f_ψ = 1/P_ψ``.
    frequency : numpy.ndarray, shape (..., k)
        NaN for a frequency that the motion does not have.
    """

    j: NDArray[np.int64]
    m: NDArray[np.int64]
    frequency: Floats

    def __repr__(self) -> str:
        return short(self)


class _Periods(NamedTuple):
    turn: Any
    wobble: Any
    spin: Any
    rotation: Any
    precession: Any
    flip: Any
    rates: Floats


class Periods(_Periods):
    """Periods of a free motion: each kind of motion has its own; a period that it does not have is NaN.

    ================================================  =============================================
    motion                                            periods
    ================================================  =============================================
    steady: ω is constant                             `turn`; `wobble` if the spin is stable
    symmetric body, ω not constant                    `spin`, `precession` of the symmetry axis
    long-axis mode, short-axis mode                   `rotation`, `precession` of axis 1; `flip`
                                                      if the intermediate axis turns over
    separatrix                                        `precession`; `rotation`, `flip` are infinite
    gyrostat: ω is constant                           `turn`; `wobble` if the spin is stable
    gyrostat: ω is not constant                       `rotation`, infinite on the separatrix
    ================================================  =============================================

    An infinite period is that of something that happens once at most. In long- and short-axis mode the
    periods are those of the long-axis convention of tumbling asteroids: the Euler angles (ZXZ) refer to axis
    1, of the least moment, with L along z. Periods are in the unit of time of the motion.

    Attributes
    ----------
    turn : float or numpy.ndarray, shape (...)
        Of a steady rotation: the time of one turn, ``2π/|ω|``. The axis rests in the body and in space. A
        spherical body always moves so, a symmetric body if ω is along its axis or perpendicular to it.
    wobble : float or numpy.ndarray, shape (...)
        Of a steady rotation that is stable: the period of small oscillations of ω in the body. NaN about the
        intermediate axis, where the spin is unstable, and where ω stays at any place in the body.
    spin : float or numpy.ndarray, shape (...)
        Of a symmetric body: the time of one turn about its axis, ``2π/|ψ̇|``, relative to the plane of that
        axis and L. After it ω is at the same place in the body.
    rotation : float or numpy.ndarray, shape (...)
        P_ψ, after which the components of ω in the body repeat. In long-axis mode the body turns once about
        its long axis in this time; in short-axis mode the long axis swings once to and fro. Of a gyrostat it
        is the time after which the components of ω and L in the body repeat.
    precession : float or numpy.ndarray, shape (...)
        P_φ: the mean time in which axis 1 goes once round L; in a symmetric body the time of its symmetry
        axis.
    flip : float or numpy.ndarray, shape (...)
        Time from one turning over of the intermediate axis to the next, half of `rotation`. That axis turns
        over if in between it is the principal axis nearest to L, now along L and then against it. This is so
        if it comes within 45° of L; otherwise it swings about the plane perpendicular to L, and `flip` is
        NaN.
    rates : numpy.ndarray, shape (..., 3)
        Mean rate, in radians per unit of time, at which each principal axis goes about L. The two axes that ω
        does not circle have the same rate. In short-axis mode the rate of axis 3 is larger than theirs by
        2π/P_ψ; in long-axis mode the rate of axis 1 is smaller than theirs by 2π/P_ψ. NaN for an axis that
        rests along L, and without angular momentum.
    """

    _motion: _core.FreeMotion | None = None
    """The motion, if it is uncertain."""

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
        """P_φ in the short-axis convention: the mean time of one revolution of axis 3 about L.

        In that convention P_ψ is the period of the rotation about axis 3 in short-axis mode, and of the swing
        of axis 3 to and fro in long-axis mode. Its value is that of `rotation` in both conventions, and
        ``1/P_φ(short) = 1/P_φ(long) + 1/P_ψ``. NaN where the motion has no `rotation`.
        """
        found = 2.0 * np.pi / self.rates[..., 2]
        return np.where(np.isnan(self.rotation), np.nan, found)[()]

    def light_curve(self, order: int = 2) -> LightCurve:
        """Compute the frequencies at which the brightness of the body can vary, seen from a fixed direction.

        Parameters
        ----------
        order : int
            The greatest ``|j|`` and ``|m|``.

        Returns
        -------
        LightCurve
            One frequency for each pair (j, m) up to `order`. Since (j, m) and (−j, −m) have the same
            frequency, only one of them is listed: that with j > 0, or with j = 0 and m > 0. The pair (0, 0)
            is the constant part and is left out. A frequency that the motion does not have is NaN: those with
            m ≠ 0 of a steady rotation, and all on the separatrix, where nothing repeats.

        Notes
        -----
        The brightness depends on the attitude alone, that is, on the three Euler angles. One part of each
        angle has the period P_ψ. The rest of φ grows uniformly, by one turn in P_φ; the rest of ψ is constant
        or grows by one turn in P_ψ. The brightness is therefore a Fourier series with the frequencies ``j f_φ
        + m f_ψ``, where ``f_φ = 1/P_φ`` and ``f_ψ = 1/P_ψ`` (M. Kaasalainen, Astron. Astrophys. 376 (2001)
        302). In the short-axis convention the frequencies are the same, with m − j in place of m. For a
        symmetric body P_φ is `precession` and P_ψ is `spin`; for a steady rotation P_φ is `turn`.

        Examples
        --------
        >>> from polhode import RigidBody
        >>> toutatis = RigidBody.from_principal(1.0, (1.0, 3.01307, 3.18992))
        >>> periods = toutatis.free_motion_from_periods(5.41, 7.35, mode="long-axis").periods
        >>> found = periods.light_curve(order=1)
        >>> dict(zip(zip(found.j.tolist(), found.m.tolist()), found.frequency.round(4).tolist()))
        {(0, 1): 0.1848, (1, -1): 0.0488, (1, 0): 0.1361, (1, 1): 0.3209}
        """
        if isinstance(order, bool) or not isinstance(order, int) or not 1 <= order <= _MOST_ORDER:
            raise ValueError(f"order: {order!r} is not a whole number from 1 to {_MOST_ORDER}")
        pairs = [(0, m) for m in range(1, order + 1)]
        pairs += [(j, m) for j in range(1, order + 1) for m in range(-order, order + 1)]
        j, m = np.array(pairs).T
        turn, spin, rotation, precession = (
            np.asarray(x, dtype=float)[..., np.newaxis]
            for x in (self.turn, self.spin, self.rotation, self.precession)
        )
        around = j / np.where(np.isnan(turn), precession, turn)
        frequency = np.abs(around + m / np.where(np.isnan(spin), rotation, spin))
        frequency = np.where((m == 0) & np.isfinite(turn), np.abs(around), frequency)
        return LightCurve(j, m, np.where(np.isinf(rotation), np.nan, frequency))

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
