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
        Mean over the members. NaN if no member is left, if a value is NaN, or if values are infinite with
        both signs; infinite if values are infinite with one sign.
    members, left_out : int
        Number of members that are counted, and of those that failed.
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
        Covariance over the members, with the number of members minus one as the divisor. NaN if a value is
        NaN or infinite.
    members, left_out : int
        Number of members that are counted, and of those that failed.
    """

    mean: Floats
    covariance: Floats
    members: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)


class HistogramCounts(NamedTuple):
    """Number of members in each bin, see :func:`histogram`.

    Attributes
    ----------
    counts : numpy.ndarray of int, shape (..., bins)
    edges : numpy.ndarray, shape (bins + 1,)
    below, above, not_a_number : numpy.ndarray of int, shape (...)
        Number of members below the lowest edge, above the highest, and with NaN.
    members, left_out : int
        Number of members that are counted, and of those that failed.
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
    """Quantiles over the members, see :func:`quantiles`.

    Attributes
    ----------
    q : numpy.ndarray, shape (parts,)
    values : numpy.ndarray, shape (parts, ...)
        The quantiles. NaN if the value of a member is NaN.
    rank_error : float
        Bound on the error of the rank of a value, as a fraction of all members; 0 if the values are exact.
    members, left_out : int
        Number of members that are counted, and of those that failed.
    """

    q: Floats
    values: Floats
    rank_error: float
    members: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)


class ModeTable(NamedTuple):
    """Modes of the members at the start and at the end, see :func:`mode_changes`.

    Attributes
    ----------
    modes : tuple of str
    table : numpy.ndarray of int, shape (modes, modes)
        Members by their mode at the start (row) and at the end (column).
    members, left_out : int
        Number of members that are counted, and of those that failed.
    """

    modes: tuple[str, ...]
    table: Counts
    members: int
    left_out: int

    def __repr__(self) -> str:
        return short(self)
