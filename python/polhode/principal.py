"""Principal moments and axes, their derivative by the tensor, and their tracking along a series of frames.

The classes hold what the compiled core computes: axes in ``rust/core/src/principal``, their standard
deviations in ``rust/core/src/uncertainty``.
"""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import one_line, short

if TYPE_CHECKING:
    from collections.abc import Iterator

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

_ORDERS: Final = np.array(list(permutations(range(3))))


class ContinuousAxes(NamedTuple):
    """Principal axes that turn as little as possible from frame to frame.

    Attributes
    ----------
    moments : numpy.ndarray, shape (..., 3)
        Moment of each axis. The moments are no longer ascending after two of them have changed places.
    axes : numpy.ndarray, shape (..., 3, 3)
        As columns, right-handed.
    order : numpy.ndarray of int, shape (..., 3)
        Place of the moment of each axis among the ascending moments: 0, 1 or 2.
    overlap : numpy.ndarray, shape (...)
        Least cosine of the angle between an axis and the same axis in the frame before; 1 in the first frame.
        Below about 0.8 the frames are too far apart to identify the axes.
    determined : numpy.ndarray of bool, shape (..., 3)
        False where another moment is so near that the tensor does not determine the axis. The axis given is
        then the one nearest to that of the frame before.
    """

    moments: Floats
    axes: Floats
    order: NDArray[np.int64]
    overlap: Floats
    determined: NDArray[np.bool_]

    def __repr__(self) -> str:
        return short(self)


def _turned_to(before: Floats, axes: Floats, close: NDArray[np.bool_]) -> Floats:
    """Rotate axes of nearly equal moments within their span, nearest to those of the frame before."""
    turned = axes.copy()
    for pair, together in (((0, 1), close[:, 0] & ~close[:, 1]), ((1, 2), close[:, 1] & ~close[:, 0])):
        rows = np.flatnonzero(together)
        if len(rows):
            plane = axes[rows][:, :, pair]
            shadows = np.einsum("nia,nib->nab", plane, before[rows])
            # The two axes before that lie most in the plane, in their order.
            inside = np.sort(np.argsort((shadows**2).sum(axis=1), axis=-1)[:, 1:], axis=-1)
            u, _, v = np.linalg.svd(np.take_along_axis(shadows, inside[:, np.newaxis, :], axis=2))
            turned[rows[:, None], :, pair] = np.swapaxes(plane @ (u @ v), 1, 2)
    rows = np.flatnonzero(close.all(axis=-1))
    turned[rows] = before[rows]
    return turned


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
        ``v_body = axes @ v_principal``. Where moments of a body are equal, to rounding, the axes nearest to
        the body axes.
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
        """Return moments and axes, in this order."""
        return iter((self.moments, self.axes))

    def continuous(self, axis: int = 0, rtol: float | None = None) -> ContinuousAxes:
        """Follow the axes along one axis of a stack, say the frames of a trajectory.

        From one frame to the next the axes are matched by the largest sum of squared overlaps, their signs
        by the overlap. Where moments are nearly equal, the axes are free within the plane (or the space) that
        they span, and are turned there to be nearest to those of the frame before.

        Parameters
        ----------
        axis : int
            Which axis of the stack is the series.
        rtol : float, optional
            Moments closer than this times the largest count as nearly equal; `top_rtol` by default.

        Returns
        -------
        ContinuousAxes

        Examples
        --------
        >>> import numpy as np
        >>> from polhode import principal_axes
        >>> frames = [np.diag((1.0, m, 3.0)) for m in (0.6, 0.9, 1.1, 1.4)]
        >>> principal_axes(frames).moments[:, 0]
        array([0.6, 0.9, 1. , 1. ])
        >>> followed = principal_axes(frames).continuous()
        >>> followed.moments[:, 0]
        array([0.6, 0.9, 1.1, 1.4])
        >>> followed.overlap
        array([1., 1., 1., 1.])
        """
        shape, axis = self.moments.shape[:-1], operator.index(axis)
        if not -len(shape) <= axis < len(shape):
            raise ValueError(f"axis: {axis} is no axis of a stack of shape {shape}")
        tolerance = None if rtol is None else _core.real_numbers(rtol, "rtol")
        if tolerance is not None and not (tolerance.ndim == 0 and 0.0 <= tolerance < math.inf):
            raise ValueError(f"rtol: {rtol} is not a tolerance; give a number such as 1e-6")
        axis %= len(shape)
        moments, axes = np.moveaxis(self.moments, axis, 0), np.moveaxis(self.axes, axis, 0)
        count, rest = len(moments), moments.shape[1:-1]
        rows = math.prod(rest)
        moments = moments.reshape(count, rows, 3)
        axes = axes.reshape(count, rows, 3, 3).copy()
        near = self.top_rtol if tolerance is None else tolerance
        if np.ndim(near):
            near = np.moveaxis(np.broadcast_to(near, self.moments.shape), axis, 0).reshape(count, rows, 3)[
                ..., 1:
            ]
        with np.errstate(over="ignore"):  # of a tolerance at which all are equal
            close = np.diff(moments, axis=-1) <= near * moments[..., 2:]
        order = np.tile(np.arange(3), (count, rows, 1))
        overlap = np.ones((count, rows))
        for k in range(1, count):
            axes[k] = _turned_to(axes[k - 1], axes[k], close[k])
            found = np.einsum("nia,nib->nab", axes[k - 1], axes[k])
            squares = found[:, np.arange(3), _ORDERS] ** 2  # by row, order, axis
            order[k] = _ORDERS[np.argmax(squares.sum(axis=-1), axis=-1)]
            axes[k] = np.take_along_axis(axes[k], order[k][:, np.newaxis, :], axis=2)
            cosines = np.einsum("nia,nia->na", axes[k - 1], axes[k])
            signs = np.where(cosines < 0.0, -1.0, 1.0)
            is_left = np.linalg.det(axes[k]) * signs.prod(axis=-1) < 0.0
            worst = np.argmin(np.abs(cosines), axis=-1)
            signs[is_left, worst[is_left]] *= -1.0
            axes[k] *= signs[:, np.newaxis, :]
            overlap[k] = np.minimum((cosines * signs).min(axis=-1), 1.0)
        free = np.stack([close[..., 0], close.any(axis=-1), close[..., 1]], axis=-1)

        def back(values: NDArray[Any], *ends: int) -> NDArray[Any]:
            return np.moveaxis(values.reshape(count, *rest, *ends), 0, axis)

        return ContinuousAxes(
            back(np.take_along_axis(moments, order, axis=-1), 3),
            back(axes, 3, 3),
            back(order, 3),
            back(overlap),
            back(~np.take_along_axis(free, order, axis=-1), 3),
        )

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
        """Compute the class of the top, as `top`, with another tolerance.

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
        """Choose the principal axes nearest to the body axes where equal moments leave the choice open.

        If two moments are equal, every pair of perpendicular axes in their plane is a pair of principal axes.
        The pair chosen here has the largest sum of the cosines of the angles between the k-th principal axis
        and the k-th body axis. For a spherical top, where any axes are principal axes, the body axes
        themselves are chosen. The axes of a body are chosen in this way already where rounding alone keeps
        its moments apart; this method does it for moments that differ by more.

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
        """Compute the derivatives of moments and axes for a small change of the tensor.

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
