"""Principal axes followed along a series of frames, without jumps of sign or order."""

from __future__ import annotations

import math
import operator
from itertools import permutations
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._repr import short

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode._principal import PrincipalAxes

    Floats = NDArray[np.float64]

__all__ = ["ContinuousAxes", "continuous"]

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


def continuous(self: PrincipalAxes, axis: int = 0, rtol: float | None = None) -> ContinuousAxes:
    """Follow the axes along one axis of a stack, say the frames of a trajectory.

    From one frame to the next the axes are matched by the largest sum of squared overlaps, and their signs
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
    if rtol is not None and not 0.0 <= float(rtol) < math.inf:
        raise ValueError(f"rtol: {rtol} is not a tolerance; give a number such as 1e-6")
    axis %= len(shape)
    moments, axes = np.moveaxis(self.moments, axis, 0), np.moveaxis(self.axes, axis, 0)
    count, rest = len(moments), moments.shape[1:-1]
    rows = math.prod(rest)
    moments = moments.reshape(count, rows, 3)
    axes = axes.reshape(count, rows, 3, 3).copy()
    near = self.top_rtol if rtol is None else rtol
    if np.ndim(near):
        near = np.moveaxis(np.broadcast_to(near, self.moments.shape), axis, 0).reshape(count, rows, 3)[
            ..., 1:
        ]
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


def _turned_to(before: Floats, axes: Floats, close: NDArray[np.bool_]) -> Floats:
    """Turn axes of nearly equal moments within what they span, to be nearest to the frame before."""
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
