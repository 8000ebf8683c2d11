"""Principal moments and axes, and how they change with the tensor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from polhode import _core
from polhode._continuous import ContinuousAxes, continuous
from polhode._repr import one_line, short

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "TOP_RTOL",
    "ContinuousAxes",
    "PrincipalAxes",
    "PrincipalDerivative",
    "PrincipalLinear",
    "PrincipalSigma",
]

TOP_RTOL: Final = 1e-6
"""Moments closer than this, relative to the largest, count as equal unless more is known of them."""


class PrincipalLinear(NamedTuple):
    """Whether standard deviations to first order are enough, as in :class:`polhode.Linear`.

    Attributes
    ----------
    moments, axes : numpy.ndarray of bool, shape (..., 3)
    """

    moments: Any
    axes: Any

    def __repr__(self) -> str:
        return short(self)


class PrincipalSigma(NamedTuple):
    """Standard deviations of principal moments and axes, to first order.

    Attributes
    ----------
    moments : numpy.ndarray, shape (..., 3)
    axes : numpy.ndarray, shape (..., 3)
        Standard deviations, in radians, of a small rotation of the axes about each axis. NaN where the two
        other moments are equal, or nearly so.
    linear : PrincipalLinear
        Whether the first order is enough for each of them.
    """

    moments: Any
    axes: Any
    linear: PrincipalLinear

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False, repr=False)
class PrincipalAxes:
    """Principal moments and axes of one tensor or of a stack: ``moments, axes = body.principal``.

    Attributes
    ----------
    moments : numpy.ndarray, shape (..., 3)
        Principal moments, ascending.
    axes : numpy.ndarray, shape (..., 3, 3)
        The axes are the **columns**, right-handed: ``inertia = axes @ diag(moments) @ axes.T`` and
        ``v_body = axes @ v_principal``. Where moments are equal, to rounding, the axes nearest to the body axes.
    top_rtol : float or numpy.ndarray, shape (..., 3)
        Tolerance of `top`: differences of moments below `top_rtol` times the largest moment count as zero. It
        is 1e-6 for most bodies. For a molecule from a file with few digits it is three numbers, one for each
        of the tests I1 = 0, I1 = I2 and I2 = I3. Each is then the largest value that the rounding of the
        coordinates can cause, but at least 1e-6.
    sigma : PrincipalSigma or None
        Standard deviations of moments and axes, for a body with uncertain numbers; else None.
    """

    moments: Floats
    axes: Floats
    top_rtol: Any = TOP_RTOL
    sigma: PrincipalSigma | None = None

    def __repr__(self) -> str:
        shape = self.moments.shape[:-1]
        if shape:
            return f"<PrincipalAxes stack of shape {shape}>"
        return one_line(self, {"moments": self.moments, "axes": self.axes, "top": self.top})

    def __iter__(self) -> Iterator[Floats]:
        """Give moments and axes, in this order."""
        return iter((self.moments, self.axes))

    # A method that stands in a file of its own.
    continuous = continuous

    @cached_property
    def quaternion(self) -> Floats:
        """The rotation `axes` as unit quaternions (x, y, z, w), shape (..., 4)."""
        return _core.quaternion_from_matrix(self.axes)

    @cached_property
    def gaps(self) -> Floats:
        """Relative gaps (I2 - I1)/I3 and (I3 - I2)/I3, shape (..., 2); zero for a point."""
        return _core.principal_gaps(self.moments)

    @cached_property
    def top(self) -> Any:
        """Class of the top, decided on `gaps` at the relative tolerance `top_rtol`.

        ``"spherical"`` (I1 = I2 = I3), ``"oblate"`` (I1 = I2 < I3), ``"prolate"`` (I1 < I2 = I3),
        ``"asymmetric"``, ``"linear"`` (0 = I1 < I2 = I3), ``"point"`` (all zero), ``"none"`` where the
        moments belong to no body. One string, or an array of them for a stack. Another tolerance:
        :meth:`classify`.
        """
        return self.classify()

    def classify(self, rtol: ArrayLike | None = None) -> Any:
        """Class of the top, as `top`, with another tolerance.

        Moments that differ by less than `rtol` times the largest are taken as equal.

        Parameters
        ----------
        rtol : float or array_like, shape (..., 3), optional
            One number, or three numbers for the tests I1 = 0, I1 = I2 and I2 = I3; `top_rtol` by default.

        Returns
        -------
        str or numpy.ndarray of str, shape (...)
            As `top`.
        """
        return _core.classify_tops(self.moments, self.top_rtol if rtol is None else rtol)

    @cached_property
    def kappa(self) -> Any:
        """Ray's asymmetry parameter κ = (2B − A − C)/(A − C) of the rotational constants A ≥ B ≥ C.

        −1 for a prolate top, +1 for an oblate one, NaN for a spherical one. A float, or an array for a stack.
        """
        return _core.ray_kappa(self.moments)

    def canonical(self, rtol: float = 1e-6) -> PrincipalAxes:
        """Choose the principal axes nearest to the body axes where nearly equal moments leave the choice open.

        If two moments are equal, every pair of perpendicular axes in their plane is a pair of principal axes.
        The pair chosen here has the largest sum of the cosines of the angles between the k-th principal axis
        and the k-th body axis. For a spherical top, where any axes are principal axes, the body axes themselves
        are chosen. `axes` are chosen in this way already where rounding alone keeps moments apart; this
        method does it for moments that differ by more.

        Parameters
        ----------
        rtol : float, optional
            Moments that differ by less than `rtol` times the largest count as equal.

        Returns
        -------
        PrincipalAxes
            The same moments with these axes.

        Examples
        --------
        >>> from polhode import principal_axes
        >>> principal_axes([(2.0, 0, 0), (0, 1.0, 0), (0, 0, 2.0 + 1e-9)]).canonical().axes
        array([[ 0.,  1.,  0.],
               [ 1.,  0.,  0.],
               [ 0.,  0., -1.]])
        """
        axes = _core.canonical_axes(self.moments, self.axes, rtol)
        return PrincipalAxes(self.moments, axes, self.top_rtol, self.sigma)

    def derivative(self, tangent: ArrayLike, rtol: float = 1e-12) -> PrincipalDerivative:
        """Give the derivatives of moments and axes for a small change of the tensor.

        Parameters
        ----------
        tangent : array_like, shape (..., 3, 3)
            The change dI of the tensor; symmetric.
        rtol : float, optional
            Moments that differ by less than `rtol` times the largest count as equal.

        Returns
        -------
        PrincipalDerivative

        Examples
        --------
        >>> from polhode import principal_axes
        >>> found = principal_axes([(1.0, 0, 0), (0, 2.0, 0), (0, 0, 4.0)])
        >>> change = found.derivative([(0.5, 1, 0), (1, 0, 0), (0, 0, 0)])
        >>> change.moments
        array([0.5, 0. , 0. ])
        >>> change.axes
        array([[ 0.,  1.,  0.],
               [-1.,  0.,  0.],
               [ 0.,  0.,  0.]])
        """
        found = _core.principal_derivative(self.moments, self.axes, tangent, rtol)
        return PrincipalDerivative(*found)


class PrincipalDerivative(NamedTuple):
    """Derivatives of principal moments and axes for a small change dI of the tensor.

    Attributes
    ----------
    moments : numpy.ndarray, shape (..., 3)
        dI_k = (Vᵀ dI V)_kk.
    axes : numpy.ndarray, shape (..., 3, 3)
        dV = V Ω with Ω_ij = (Vᵀ dI V)_ij / (I_j − I_i), a small rotation of the axes.
    degenerate : numpy.ndarray of bool, shape (..., 3)
        Which of the pairs (1, 2), (1, 3), (2, 3) have equal moments. For such a pair neither the axes nor the
        single moments have a derivative. `axes` then leaves out the rotation in the plane of the pair, and
        only the sum of the two `moments` does not depend on the choice of axes.
    """

    moments: Floats
    axes: Floats
    degenerate: NDArray[np.bool_]

    def __repr__(self) -> str:
        return short(self)
