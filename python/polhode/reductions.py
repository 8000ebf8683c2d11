"""Reductions: statistics of an ensemble that are kept in place of its states.

A reduction takes a number or an array from each member. Its argument `of` is the name of a state
(``"omega"``, ``"quaternion"``, ``"position"``, ``"velocity"``, at all times), or a function. The function
gets a trajectory of many members and returns an array whose first axis is the members. Members that failed
are left out and counted.

Members are reduced in blocks of 4096, which are merged in a fixed order. The result therefore has the same
bits for any division of the work.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias, final

import numpy as np

from polhode import _core
from polhode._reduced import HistogramCounts, Means, MeansAndCovariance, ModeTable, QuantileLevels
from polhode._reducing import KEPT, MOST_EXACT, Moments, Order, level_of, moments, ordered
from polhode._repr import one_line

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode.trajectory import Trajectory

    Floats = NDArray[np.float64]
    Shape = tuple[int, ...]

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
MOST_CORRELATED: Final = 1000
"""Numbers of a member whose covariance is taken: its matrix has a million elements."""
MODES: Final = ("long-axis", "short-axis", "separatrix", "steady", "symmetric", "spherical")


class Reduction(ABC):
    """Base class of the reductions, which the functions of this module make."""

    def values(self, trajectory: Trajectory) -> Floats:
        """Give the numbers of the members of a trajectory, shape (members, ...)."""
        of: Of = self.__dict__["of"]
        try:
            found = getattr(trajectory, of) if isinstance(of, str) else of(trajectory)
        except ValueError as error:
            if "read-only" in str(error):
                way = "all reductions share the states; change a copy, such as motion.omega.copy()"
                raise ValueError(f"of: {error}: {way}") from error
            error.add_note(_RAISED)
            raise
        except Exception as error:
            error.add_note(_RAISED)
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
    def begun(self, values: Floats, n: int) -> Any:
        """Give the state of a block with these values, of an ensemble with n members."""

    @abstractmethod
    def merged(self, one: Any, other: Any, n: int) -> Any:
        """Merge the states of two neighbouring blocks, and give the state of both together."""

    @abstractmethod
    def finished(self, state: Any, left_out: int) -> Any:
        """Give the result. If there was no member, the state is None."""

    def __repr__(self) -> str:
        parts = {name: value for name, value in self.__dict__.items() if name != "of"}
        of = self.__dict__.get("of")
        if of is not None:
            parts["of"] = of if isinstance(of, str) else getattr(of, "__qualname__", repr(of))
        return one_line(self, parts).removeprefix("_")


class Kept(NamedTuple):
    """A state, and the shape of what is reduced."""

    shape: Shape
    of: Any


def _flat(values: Floats) -> Floats:
    return values.reshape(len(values), -1)


@final
@dataclass(frozen=True, eq=False, repr=False)
class _Mean(Reduction):
    of: Of

    def begun(self, values: Floats, n: int) -> Kept:  # noqa: ARG002
        return Kept(values.shape[1:], moments(_flat(values), products=False))

    def merged(self, one: Kept, other: Kept, n: int) -> Kept:  # noqa: ARG002
        return Kept(one.shape, one.of.merged(other.of))

    def finished(self, state: Kept | None, left_out: int) -> Means:
        if state is None:
            return Means(np.array(np.nan), 0, left_out)
        found: Moments = state.of
        return Means(found.mean.reshape(state.shape), found.members, left_out)


@final
@dataclass(frozen=True, eq=False, repr=False)
class _Covariance(Reduction):
    of: Of

    def begun(self, values: Floats, n: int) -> Kept:  # noqa: ARG002
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
        return Kept(values.shape[1:], moments(rows, products=True))

    def merged(self, one: Kept, other: Kept, n: int) -> Kept:  # noqa: ARG002
        return Kept(one.shape, one.of.merged(other.of))

    def finished(self, state: Kept | None, left_out: int) -> MeansAndCovariance:
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

    def begun(self, values: Floats, n: int) -> Kept:  # noqa: ARG002
        rows, size = _flat(values), len(self.bins) - 1
        place = np.searchsorted(self.bins, rows, side="right")
        place[rows == self.bins[-1]] = size  # the last bin has both of its edges
        place[np.isnan(rows)] = size + 2
        columns = np.arange(rows.shape[1]) * (size + 3)
        counts = np.bincount((place + columns).ravel(), minlength=rows.shape[1] * (size + 3))
        return Kept(values.shape[1:], (len(rows), counts.reshape(rows.shape[1], size + 3)))

    def merged(self, one: Kept, other: Kept, n: int) -> Kept:  # noqa: ARG002
        return Kept(one.shape, (one.of[0] + other.of[0], one.of[1] + other.of[1]))

    def finished(self, state: Kept | None, left_out: int) -> HistogramCounts:
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

    def begun(self, values: Floats, n: int) -> Kept:  # noqa: ARG002
        rows = _flat(values)
        return Kept(values.shape[1:], (len(rows), np.isnan(rows).any(axis=0), ordered(rows)))

    def merged(self, one: Kept, other: Kept, n: int) -> Kept:
        most = None if n <= MOST_EXACT else KEPT
        (count, strange, order), (more, others, beside) = one.of, other.of
        return Kept(one.shape, (count + more, strange | others, order.merged(beside, most)))

    def finished(self, state: Kept | None, left_out: int) -> QuantileLevels:
        if state is None:
            return QuantileLevels(self.q, np.full(len(self.q), np.nan), 0.0, 0, left_out)
        order: Order
        count, strange, order = state.of
        levels = level_of(order, self.q)
        levels[:, strange] = np.nan
        return QuantileLevels(
            self.q, levels.reshape(len(self.q), *state.shape), order.error / count, count, left_out
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

    def begun(self, values: Floats, n: int) -> Kept:  # noqa: ARG002
        size = len(MODES)
        code = values[:, 0].astype(np.int64) * size + values[:, 1].astype(np.int64)
        return Kept((), np.bincount(code, minlength=size * size).reshape(size, size))

    def merged(self, one: Kept, other: Kept, n: int) -> Kept:  # noqa: ARG002
        return Kept((), one.of + other.of)

    def finished(self, state: Kept | None, left_out: int) -> ModeTable:
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
