"""What reductions give."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from polhode._repr import short

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Counts = NDArray[np.int64]

__all__ = ["HistogramCounts", "Means", "MeansAndCovariance", "ModeTable", "QuantileLevels"]


class Means(NamedTuple):
    """The mean over members, see :func:`mean`.

    Attributes
    ----------
    mean : numpy.ndarray
        Not a number where no member is left, where a value is none, and where values are infinite with both
        signs; infinite where they are so with one.
    members, left_out : int
        Members that are in it, and those that failed.
    """

    mean: Floats
    members: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)


class MeansAndCovariance(NamedTuple):
    """Mean and covariance over members, see :func:`covariance`.

    Attributes
    ----------
    mean : numpy.ndarray, shape (k,)
    covariance : numpy.ndarray, shape (k, k)
        Divided by one less than the count. Not a number where a value is none or infinite.
    members, left_out : int
        Members that are in it, and those that failed.
    """

    mean: Floats
    covariance: Floats
    members: int
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
    members, left_out : int
        Members that are counted, and those that failed.
    """

    counts: Counts
    edges: Floats
    below: Counts
    above: Counts
    not_a_number: Counts
    members: int
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
        Largest part of all members by which the rank of a value may be wrong, at most; 0 where they are
        exact.
    members, left_out : int
        Members that are in it, and those that failed.
    """

    q: Floats
    values: Floats
    rank_error: float
    members: int
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
    members, left_out : int
        Members that are counted, and those that failed.
    """

    modes: tuple[str, ...]
    table: Counts
    members: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)
