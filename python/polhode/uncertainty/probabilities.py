"""Probabilities that an axis keeps its rank, and that a free body keeps its mode."""

from __future__ import annotations

import math
from itertools import permutations
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._format import short
from polhode._hints import check_kind
from polhode.uncertainty.motion import each_motion
from polhode.uncertainty.variables import changes_in_principal_axes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, RigidBody

    Floats = NDArray[np.float64]

__all__ = ["AxisProbabilities", "ModeProbabilities", "axis_probabilities", "mode_probabilities"]

NODES: Final = np.polynomial.legendre.leggauss(16)
FAR: Final = 39.0
"""Deviations beyond which a normal density is zero in numbers of this precision."""
AROUND: Final = np.array([-9.0, -6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 9.0])
"""Nodes that divide a step of width one for the quadrature."""


class AxisProbabilities(NamedTuple):
    """Probabilities that an axis is that of the least, intermediate or greatest moment.

    Attributes
    ----------
    least, intermediate, greatest : numpy.ndarray, shape (..., 3)
        Probabilities for each axis of ``body.principal``; the three probabilities of one axis add up to one.
    stable : numpy.ndarray, shape (..., 3)
        Probability that a steady spin about the axis is stable, that is, that its moment is not the
        intermediate one.
    """

    least: Floats
    intermediate: Floats
    greatest: Floats
    stable: Floats

    def __repr__(self) -> str:
        return short(self)


class ModeProbabilities(NamedTuple):
    """Probabilities of the two modes of a free motion.

    Attributes
    ----------
    long_axis, short_axis : float or numpy.ndarray, shape (...)
        Probability that the angular velocity circles axis 1, of the least moment, and that it circles axis 3.
        They add up to one.
    linear : bool or numpy.ndarray, shape (...)
        Whether the first order, by which the probabilities are computed, is accurate enough.
    """

    long_axis: Any
    short_axis: Any
    linear: Any

    def __repr__(self) -> str:
        return short(self)


def axis_probabilities(body: RigidBody) -> AxisProbabilities:
    """Compute the probabilities that an axis is that of the least, intermediate or greatest moment.

    The moments about the body's principal axes are taken as jointly normal, to first order.

    Parameters
    ----------
    body : RigidBody
        A body with a covariance; or a stack.

    Returns
    -------
    AxisProbabilities

    Raises
    ------
    ValueError
        For a body without a covariance.

    Examples
    --------
    >>> from polhode import RigidBody
    >>> from polhode.uncertainty import axis_probabilities
    >>> wheel = RigidBody.from_principal(5.0, (1.0, 1.04, 1.9))
    >>> weighed = wheel.with_sigma(inertia=[[0.02, 0, 0], [0, 0.02, 0], [0, 0, 0.02]])
    >>> axis_probabilities(weighed).intermediate.round(3)
    array([0.079, 0.921, 0.   ])
    """
    check_kind(body, "body", "RigidBody")
    changes = changes_in_principal_axes(body)
    if changes is None:
        message = "body: it carries no covariance; give it one by with_sigma, with_covariance or Uncertain"
        raise ValueError(message)
    moments = body.principal_moments.reshape(-1, 3)
    ranks = np.zeros((len(moments), 3, 3))  # row, axis, rank
    for row, (means, of_row) in enumerate(zip(moments, changes, strict=True)):
        slopes = np.diagonal(of_row, axis1=-2, axis2=-1)
        for order in permutations(range(3)):
            low, middle, high = order
            found = both_positive(
                (means[middle] - means[low], means[high] - means[middle]),
                (slopes[:, middle] - slopes[:, low], slopes[:, high] - slopes[:, middle]),
            )
            for rank, axis in enumerate(order):
                ranks[row, axis, rank] += found
    # Equal moments that stay equal have no order: each order of theirs was counted.
    ranks /= ranks.sum(axis=2, keepdims=True)
    least, intermediate, greatest = np.moveaxis(ranks.reshape(*body.shape, 3, 3), -1, 0)
    return AxisProbabilities(least, intermediate, greatest, 1.0 - intermediate)


def mode_probabilities(motion: FreeMotion) -> ModeProbabilities:
    """Compute the probabilities of long-axis mode and short-axis mode of a free motion.

    The mode follows from the sign of ``1 − 2T I₂/L²``, which is taken as normally distributed. The mode of a
    motion from given periods was given, and is certain.

    Parameters
    ----------
    motion : FreeMotion
        Motion of a body with a covariance, or from an `Uncertain` angular velocity; or a stack.

    Returns
    -------
    ModeProbabilities

    Raises
    ------
    ValueError
        Where nothing is uncertain.

    Examples
    --------
    >>> from polhode import RigidBody, Uncertain
    >>> from polhode.uncertainty import mode_probabilities
    >>> brick = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    >>> omega = Uncertain((0.5, 1.0, 0.6), sigma=0.05)
    >>> round(float(mode_probabilities(brick.free_motion(omega)).short_axis), 3)
    0.992
    """
    check_kind(motion, "motion", "FreeMotion")

    def excess(body: RigidBody, omega: Any) -> Any:
        momentum = body.inertia @ omega
        return 1.0 - body.principal_moments[1] * (omega @ momentum) / (momentum @ momentum)

    if motion._from_periods is not None:
        is_short = np.full(motion.shape, float(motion._from_periods.mode == "short-axis"))[()]
        return ModeProbabilities(1.0 - is_short, is_short, np.full(motion.shape, True)[()])
    found = each_motion(motion, excess, ())
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.asarray(found.value) / np.asarray(found.sigma)
    short_axis = np.vectorize(_below, otypes=[float])(ratio)[()]
    return ModeProbabilities(1.0 - short_axis, short_axis, found.linear & ~np.isnan(short_axis))


def both_positive(means: tuple[float, float], slopes: tuple[Floats, Floats]) -> float:
    """Return the probability that two numbers are positive, jointly normal with these means.

    Parameters
    ----------
    means : tuple of float
    slopes : tuple of numpy.ndarray, shape (k,)
        By one standard deviation of each of k independent variables.
    """
    sizes = [float(np.linalg.norm(slope)) for slope in slopes]
    if sizes[0] == 0.0 or sizes[1] == 0.0:  # a number that is known; zero counts as either
        return math.prod(
            _below(mean / size) if size > 0.0 else float(mean >= 0.0)
            for mean, size in zip(means, sizes, strict=True)
        )
    one, other = (slope / size for slope, size in zip(slopes, sizes, strict=True))
    a, b = (mean / size for mean, size in zip(means, sizes, strict=True))
    cosine = float(one @ other)
    sine = 0.5 * float(np.linalg.norm(one - other)) * float(np.linalg.norm(one + other))
    if sine < 1e-14:
        return _below(min(a, b)) if cosine > 0.0 else max(0.0, _below(a) - _below(-b))
    # The first is a + x with a normal x; given that, the other is b + x cos + y sin with a y of its own.
    step = np.clip(-b / cosine if cosine != 0.0 else 0.0, -FAR, FAR)
    around = step + AROUND * sine / max(abs(cosine), sine)
    start = min(max(-a, -FAR), FAR)
    edges = np.unique(np.clip([start, *np.arange(-FAR, FAR + 1), *around], start, FAR))
    nodes, weights = NODES
    half = 0.5 * np.diff(edges)
    x = 0.5 * (edges[:-1] + edges[1:])[:, None] + half[:, None] * nodes
    given = np.vectorize(_below, otypes=[float])((b + x * cosine) / sine) if x.size else x
    density = np.exp(-0.5 * x**2) / math.sqrt(2.0 * math.pi)
    return min(1.0, float((density * given) @ weights @ half))


def _below(x: float) -> float:
    """Return the probability that a standard normal variable is below x."""
    return 0.5 * math.erfc(-x / math.sqrt(2.0))
