"""What is kept of an ensemble in place of its states: means, covariances, histograms, quantiles, changes of mode.

A reduction is of a number or an array of each member: of the states by name (``"omega"``, ``"quaternion"``,
``"position"``, ``"velocity"``, at all times), or of what a function gives for a trajectory of many members,
with an axis of these in front. Members that failed are left out and counted.

Members are reduced in blocks of 4096 that are merged in a fixed tree: the result has the same bits however the
work is cut.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias, final

import numpy as np

from polhode import _core
from polhode._reducing import KEPT, MOST_EXACT, level_of, moments, ordered
from polhode._repr import one_line, short

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode.trajectory import Trajectory

    Floats = NDArray[np.float64]
    Counts = NDArray[np.int64]

__all__ = [
    "HistogramCounts",
    "Means",
    "MeansAndCovariance",
    "ModeTable",
    "QuantileLevels",
    "Reduction",
    "covariance",
    "histogram",
    "mean",
    "mode_changes",
    "quantiles",
]

Of: TypeAlias = str | Callable[[Any], Any]

STATES: Final = ("omega", "quaternion", "position", "velocity")
MOST_CORRELATED: Final = 1000
"""Numbers of a member whose covariance is taken: its matrix has a million elements."""
MODES: Final = (
    "long-axis", "short-axis", "separatrix", "steady", "symmetric", "spherical", "at rest"
)  # fmt: skip


class Means(NamedTuple):
    """The mean over members, see :func:`mean`.

    Attributes
    ----------
    mean : numpy.ndarray
        Not a number where no member is left.
    count, left_out : int
        Members that are in it, and those that failed.
    """

    mean: Floats
    count: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)


class MeansAndCovariance(NamedTuple):
    """Mean and covariance over members, see :func:`covariance`.

    Attributes
    ----------
    mean : numpy.ndarray, shape (k,)
    covariance : numpy.ndarray, shape (k, k)
        Divided by one less than the count.
    count, left_out : int
        Members that are in it, and those that failed.
    """

    mean: Floats
    covariance: Floats
    count: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)


class HistogramCounts(NamedTuple):
    """How many members are in each bin, see :func:`histogram`.

    Attributes
    ----------
    counts : numpy.ndarray of int, shape (..., bins)
    edges : numpy.ndarray, shape (bins + 1,)
    below, above, not_a_number : numpy.ndarray of int, shape (...)
        Those in no bin.
    count, left_out : int
        Members that are counted, and those that failed.
    """

    counts: Counts
    edges: Floats
    below: Counts
    above: Counts
    not_a_number: Counts
    count: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)


class QuantileLevels(NamedTuple):
    """Below which numbers parts of the members lie, see :func:`quantiles`.

    Attributes
    ----------
    q : numpy.ndarray, shape (parts,)
    values : numpy.ndarray, shape (parts, ...)
        Not a number where a member's is not.
    rank_error : float
        By which part of all members the rank of a value may be wrong, at most; 0 where they are exact.
    count, left_out : int
        Members that are in it, and those that failed.
    """

    q: Floats
    values: Floats
    rank_error: float
    count: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)


class ModeTable(NamedTuple):
    """How the members rotate at the start and at the end, see :func:`mode_changes`.

    Attributes
    ----------
    modes : tuple of str
    table : numpy.ndarray of int, shape (modes, modes)
        Members by their mode at the start (row) and at the end (column).
    count, left_out : int
        Members that are counted, and those that failed.
    """

    modes: tuple[str, ...]
    table: Counts
    count: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)
