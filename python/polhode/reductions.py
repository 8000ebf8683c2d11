"""Reductions: statistics of an ensemble that are kept in place of its states.

A reduction takes a number or an array from each member. Its argument `of` is the name of a state
(``"omega"``, ``"quaternion"``, ``"position"``, ``"velocity"``, at all times), or a function. The function
gets a trajectory of many members and returns an array whose first axis is the members. Members that failed
are left out and counted.

Members are reduced in blocks of 4096, which are merged in a fixed sketch. The result therefore has the same
bits for any division of the work.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias, final

import numpy as np

from polhode import _core
from polhode._format import one_line, short

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]
    Shape = tuple[int, ...]
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
_RAISED: Final = "raised by the function of a reduction, of="
_SHARED: Final = "all reductions share the states, which are read-only; change a copy, as motion.omega.copy()"
MOST_CORRELATED: Final = 1000
"""Numbers of a member whose covariance is taken: its matrix has a million elements."""
MODES: Final = ("long-axis", "short-axis", "separatrix", "steady", "symmetric", "spherical")


class Reduction(ABC):
    """Base class of the reductions, which the functions of this module make."""

    def values(self, trajectory: Trajectory) -> Floats:
        """Return the numbers of the members of a trajectory, shape (members, ...)."""
        of: Of = self.__dict__["of"]
        try:
            found = getattr(trajectory, of) if isinstance(of, str) else of(trajectory)
        except Exception as error:
            error.add_note(_RAISED)
            if type(error) is ValueError:  # as NumPy raises where an array is read-only
                error.add_note(_SHARED)
            raise
        array = _core.real_numbers(found, "of")
        count = len(trajectory.omega)
        if array.shape[:1] != (count,):
            raise ValueError(
                f"of: expected a first axis of {count} members, got an array of shape {array.shape}; "
                "the trajectory it is given has all members of a block"
            )
        return array

    @abstractmethod
    def start(self, values: Floats, n: int) -> Any:
        """Return the state of a block with these values, of an ensemble with n members."""

    @abstractmethod
    def merge(self, one: Any, other: Any, n: int) -> Any:
        """Merge the states of two neighbouring blocks, and return the state of both together."""

    @abstractmethod
    def finish(self, state: Any, left_out: int) -> Any:
        """Return the result. If there was no member, the state is None."""

    def __repr__(self) -> str:
        parts = {name: value for name, value in self.__dict__.items() if name != "of"}
        of = self.__dict__.get("of")
        if of is not None:
            parts["of"] = of if isinstance(of, str) else getattr(of, "__qualname__", repr(of))
        return one_line(self, parts).removeprefix("_")


class BlockState(NamedTuple):
    """The state of a block, and the shape of the quantity that is reduced."""

    shape: Shape
    of: Any


def _flat(values: Floats) -> Floats:
    return values.reshape(len(values), -1)


@final
@dataclass(frozen=True, eq=False, repr=False)
class _Mean(Reduction):
    of: Of

    def start(self, values: Floats, n: int) -> BlockState:  # noqa: ARG002
        return BlockState(values.shape[1:], moments(_flat(values), products=False))

    def merge(self, one: BlockState, other: BlockState, n: int) -> BlockState:  # noqa: ARG002
        return BlockState(one.shape, one.of.merge(other.of))

    def finish(self, state: BlockState | None, left_out: int) -> Means:
        if state is None:
            return Means(np.array(np.nan), 0, left_out)
        found: Moments = state.of
        return Means(found.mean.reshape(state.shape), found.members, left_out)


@final
@dataclass(frozen=True, eq=False, repr=False)
class _Covariance(Reduction):
    of: Of

    def start(self, values: Floats, n: int) -> BlockState:  # noqa: ARG002
        rows = _flat(values)
        if not rows.shape[1]:
            raise ValueError(
                f"of: a covariance of nothing: got an array of shape {values.shape}, which is empty"
            )
        if rows.shape[1] > MOST_CORRELATED:
            raise ValueError(
                f"of: a covariance is of {MOST_CORRELATED} numbers of a member at most, got {rows.shape[1]}; "
                "take those that matter, such as lambda motion: motion.omega[:, -1]"
            )
        return BlockState(values.shape[1:], moments(rows, products=True))

    def merge(self, one: BlockState, other: BlockState, n: int) -> BlockState:  # noqa: ARG002
        return BlockState(one.shape, one.of.merge(other.of))

    def finish(self, state: BlockState | None, left_out: int) -> MeansAndCovariance:
        if state is None:
            return MeansAndCovariance(np.full(0, np.nan), np.full((0, 0), np.nan), 0, left_out)
        found: Moments = state.of
        products = np.asarray(found.products)
        matrix = products / (found.members - 1) if found.members > 1 else np.full_like(products, np.nan)
        return MeansAndCovariance(found.mean, matrix, found.members, left_out)


@final
@dataclass(frozen=True, eq=False, repr=False)
class _Histogram(Reduction):
    bins: Floats
    of: Of

    def start(self, values: Floats, n: int) -> BlockState:  # noqa: ARG002
        rows, size = _flat(values), len(self.bins) - 1
        place = np.searchsorted(self.bins, rows, side="right")
        place[rows == self.bins[-1]] = size  # the last bin has both of its edges
        place[np.isnan(rows)] = size + 2
        columns = np.arange(rows.shape[1]) * (size + 3)
        counts = np.bincount((place + columns).ravel(), minlength=rows.shape[1] * (size + 3))
        return BlockState(values.shape[1:], (len(rows), counts.reshape(rows.shape[1], size + 3)))

    def merge(self, one: BlockState, other: BlockState, n: int) -> BlockState:  # noqa: ARG002
        return BlockState(one.shape, (one.of[0] + other.of[0], one.of[1] + other.of[1]))

    def finish(self, state: BlockState | None, left_out: int) -> HistogramCounts:
        size = len(self.bins) - 1
        shape, (count, counts) = (
            ((), (0, np.zeros((1, size + 3), dtype=np.int64))) if state is None else (state.shape, state.of)
        )
        counts = counts.reshape(*shape, size + 3)
        below, above, strange = counts[..., 0], counts[..., size + 1], counts[..., size + 2]
        return HistogramCounts(counts[..., 1 : size + 1], self.bins, below, above, strange, count, left_out)


@final
@dataclass(frozen=True, eq=False, repr=False)
class _Quantiles(Reduction):
    q: Floats
    of: Of

    def start(self, values: Floats, n: int) -> BlockState:  # noqa: ARG002
        rows = _flat(values)
        return BlockState(values.shape[1:], (len(rows), np.isnan(rows).any(axis=0), sort_columns(rows)))

    def merge(self, one: BlockState, other: BlockState, n: int) -> BlockState:
        most = None if n <= MOST_EXACT else KEPT
        (count, strange, sketch), (more, others, beside) = one.of, other.of
        return BlockState(one.shape, (count + more, strange | others, sketch.merge(beside, most)))

    def finish(self, state: BlockState | None, left_out: int) -> QuantileLevels:
        if state is None:
            return QuantileLevels(self.q, np.full(len(self.q), np.nan), 0.0, 0, left_out)
        sketch: QuantileSketch
        count, strange, sketch = state.of
        levels = quantiles_of(sketch, self.q)
        levels[:, strange] = np.nan
        return QuantileLevels(
            self.q, levels.reshape(len(self.q), *state.shape), sketch.error / count, count, left_out
        )


@final
@dataclass(frozen=True, eq=False, repr=False)
class _ModeChanges(Reduction):
    def values(self, trajectory: Trajectory) -> Floats:
        if trajectory.states:
            raise ValueError(
                "mode_changes: the body carries wheels or dampers, and the modes are those of a rigid body"
            )
        places = {mode: place for place, mode in enumerate(MODES)}
        found = []
        for time in (0, -1):
            omega, attitude = trajectory.omega[:, time], trajectory.quaternion[:, time]
            modes = trajectory.body.free_motion(omega, attitude).mode
            found.append([places[mode] for mode in modes])
        return np.array(found, dtype=float).T

    def start(self, values: Floats, n: int) -> BlockState:  # noqa: ARG002
        size = len(MODES)
        code = values[:, 0].astype(np.int64) * size + values[:, 1].astype(np.int64)
        return BlockState((), np.bincount(code, minlength=size * size).reshape(size, size))

    def merge(self, one: BlockState, other: BlockState, n: int) -> BlockState:  # noqa: ARG002
        return BlockState((), one.of + other.of)

    def finish(self, state: BlockState | None, left_out: int) -> ModeTable:
        size = len(MODES)
        table = np.zeros((size, size), dtype=np.int64) if state is None else state.of
        return ModeTable(MODES, table, int(table.sum()), left_out)


def mean(of: Of) -> Reduction:
    """Compute the mean over the members.

    Parameters
    ----------
    of : str or callable
        See the top of this page.

    Returns
    -------
    Reduction
        Its result is :class:`Means`.

    Examples
    --------
    >>> from polhode import RigidBody, distributions, ensemble, reductions
    >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    >>> spin = distributions.normal((0.0, 0.0, 1.0), sigma=0.1)
    >>> many = ensemble(body, [0, 10], spin, n=4000, seed=1, reduce=reductions.mean("omega"))
    >>> many.compute().mean.round(2)
    array([[0., 0., 1.],
           [0., 0., 1.]])
    """
    return _Mean(_of(of))


def covariance(of: Of) -> Reduction:
    """Compute mean and covariance over the members.

    Parameters
    ----------
    of : str or callable
        See the top of this page; at most 1000 numbers for each member.

    Returns
    -------
    Reduction
        Its result is :class:`MeansAndCovariance`.
    """
    return _Covariance(_of(of))


def histogram(bins: ArrayLike, of: Of) -> Reduction:
    """Count the members in bins. Every number of a member has its own histogram.

    Parameters
    ----------
    bins : array_like, shape (bins + 1,)
        Edges of the bins, increasing. A bin contains its lower edge; the last bin contains both edges.
    of : str or callable
        See the top of this page.

    Returns
    -------
    Reduction
        Its result is :class:`HistogramCounts`.
    """
    edges = _core.real_numbers(bins, "bins")
    if edges.ndim != 1 or len(edges) < 2 or not (np.diff(edges) > 0.0).all():
        raise ValueError("bins: expected two or more increasing edges, shape (bins + 1,)")
    edges = edges.copy()
    edges.setflags(write=False)
    return _Histogram(edges, _of(of))


def quantiles(q: ArrayLike, of: Of) -> Reduction:
    """Compute quantiles over the members.

    Parameters
    ----------
    q : array_like, shape (parts,) or ()
        Ranks from 0 to 1; 0.5 is the median.
    of : str or callable
        See the top of this page.

    Returns
    -------
    Reduction
        Its result is :class:`QuantileLevels`.

    Notes
    -----
    Up to a million members every number is kept, and the quantiles are those of ``numpy.quantile``. Beyond
    that at most 65536 numbers of each weight are kept. If there are more, every second one is dropped and
    the weight of the others is doubled. The result contains a bound of the error of a rank, about 1e-4 of
    all for 1e8 members.
    """
    parts = np.atleast_1d(_core.real_numbers(q, "q"))
    if parts.ndim != 1 or not len(parts) or not ((parts >= 0.0) & (parts <= 1.0)).all():
        raise ValueError("q: expected one or more numbers from 0 to 1, shape (parts,)")
    parts = parts.copy()
    parts.setflags(write=False)
    return _Quantiles(parts, _of(of))


def mode_changes() -> Reduction:
    """Count the members by mode at the start and at the end.

    The mode is that of a free body in the same state, see :attr:`polhode.FreeMotion.mode`.

    Returns
    -------
    Reduction
        Its result is :class:`ModeTable`.
    """
    return _ModeChanges()


def _of(of: Any) -> Of:
    if isinstance(of, str) and of not in STATES:
        raise ValueError(f"of: {of!r} is not one of {', '.join(map(repr, STATES))} or a function")
    if not isinstance(of, str) and not callable(of):
        raise TypeError(f"of: expected the name of a state or a function, got {type(of).__name__}")
    found: Of = of
    return found


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


def sum_by_halves(rows: Floats) -> Floats:
    """Sum over the first axis, by halves."""
    while len(rows) > 1:
        half = len(rows) // 2
        rows = np.concatenate([rows[:half] + rows[half : 2 * half], rows[2 * half :]])
    total: Floats = rows[0] if len(rows) else np.zeros(rows.shape[1:])
    return total


class Moments(NamedTuple):
    """Number of members, their mean and, if asked for, the sums of products of deviations."""

    members: int
    mean: Floats
    products: Floats | None

    def merge(self, other: Moments) -> Moments:
        """Return the moments of both, after Chan, Golub and LeVeque."""
        count = self.members + other.members
        with np.errstate(invalid="ignore"):
            step = other.mean - self.mean
            mean = self.mean + step * (other.members / count)
            # A step from an infinite mean leads nowhere: the mean stays what it is.
            infinite = np.isinf(self.mean)
            mean[infinite] = self.mean[infinite] + other.mean[infinite]
            if self.products is None or other.products is None:
                return Moments(count, mean, None)
            between = step[:, np.newaxis] * step * (self.members * (other.members / count))
            return Moments(count, mean, self.products + other.products + between)


def moments(values: Floats, *, products: bool) -> Moments:
    """Return the moments of rows, shape (n, k).

    Infinite values of one sign give an infinite mean, of both signs NaN; covariances with infinite values are
    NaN.
    """
    count = len(values)
    with np.errstate(invalid="ignore"):
        mean = sum_by_halves(values) / count
        if not products:
            return Moments(count, mean, None)
        off = values - mean
        rows = [sum_by_halves(off[:, [k]] * off) for k in range(off.shape[1])]
        return Moments(count, mean, np.stack(rows))


class QuantileSketch(NamedTuple):
    """Sorted numbers of some members; each has a weight, which says how many numbers it represents.

    Attributes
    ----------
    buffers : dict
        By weight: sorted along the first axis, shape (m, k).
    error : int
        By how much a rank may be wrong, at most.
    """

    buffers: dict[int, Floats]
    error: int = 0

    def merge(self, other: QuantileSketch, most: int | None) -> QuantileSketch:
        """Return the numbers of both; beyond `most` numbers of one weight every other one is dropped."""
        buffers = dict(self.buffers)
        for weight, values in other.buffers.items():
            held = buffers.get(weight)
            # A stable sort of two sorted runs merges them.
            buffers[weight] = (
                values if held is None else np.sort(np.concatenate([held, values]), axis=0, kind="stable")
            )
        both = QuantileSketch(buffers, self.error + other.error)
        return both if most is None else compact(both, most)


def sort_columns(values: Floats) -> QuantileSketch:
    """Sort rows, shape (n, k), each column by itself."""
    return QuantileSketch({1: np.sort(values, axis=0, kind="stable")})


def compact(sketch: QuantileSketch, most: int) -> QuantileSketch:
    """Drop every other number of a weight that has more than `most` numbers.

    Of 2m sorted numbers of one weight, m stay, with twice the weight: those in the odd or those in the even
    places. This changes a rank by one weight at most. A coin chooses between odd and even, so that the errors
    of many blocks do not add up. The bits of the number in the middle toss it: the result is the same on
    every machine.
    """
    buffers, error = dict(sketch.buffers), sketch.error
    weight = 1
    while weight <= max(buffers):
        values = buffers.get(weight)
        if values is not None and len(values) > most:
            even = len(values) // 2 * 2
            kept = values[_coin(values[even // 2], weight) : even : 2]
            rest = values[even:]
            if len(rest):
                buffers[weight] = rest
            else:
                del buffers[weight]
            above = buffers.get(2 * weight)
            buffers[2 * weight] = (
                kept if above is None else np.sort(np.concatenate([above, kept]), axis=0, kind="stable")
            )
            error += weight
        weight *= 2
    return QuantileSketch(buffers, error)


def _coin(row: Floats, weight: int) -> int:
    """Toss a coin, 0 or 1, by the bits of some numbers (multiplicative hashing).

    Each weight has another coin: the number that tossed it for one weight may be in the middle again for the
    next.
    """
    word = int(np.bitwise_xor.reduce(np.ascontiguousarray(row).view(np.uint64)))
    word ^= weight * 0xBF58476D1CE4E5B9
    return (word * 0x9E3779B97F4A7C15 >> 63) & 1


def quantiles_of(sketch: QuantileSketch, parts: Floats) -> Floats:
    """Return the quantiles for these fractions, shape (q, k).

    If the sketch holds every number, a quantile is interpolated between the two nearest; else it is one of
    the numbers.
    """
    weights = np.concatenate([np.full(len(values), weight) for weight, values in sketch.buffers.items()])
    values = np.concatenate(list(sketch.buffers.values()))
    total = int(weights.sum())
    place = np.argsort(values, axis=0, kind="stable")
    values = np.take_along_axis(values, place, axis=0)
    rank = parts * (total - 1)
    if sketch.error == 0:
        low = np.floor(rank).astype(np.int64)
        high = np.minimum(low + 1, total - 1)
        part = (rank - low)[:, np.newaxis]
        below, above = values[low], values[high]
        with np.errstate(invalid="ignore"):
            between = below + part * (above - below)
        return np.where((part == 0.0) | (below == above), below, between)
    reached = np.cumsum(weights[place], axis=0)
    found = np.empty((len(parts), values.shape[1]))
    for column in range(values.shape[1]):
        at = np.searchsorted(reached[:, column], np.floor(rank), side="right")
        found[:, column] = values[np.minimum(at, len(values) - 1), column]
    return found


MOST_EXACT: Final = 1_000_000
"""Members of which every number is kept for quantiles."""
KEPT: Final = 1 << 16
"""Numbers of a weight that are kept of more members."""
