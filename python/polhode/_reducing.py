"""Sums, counts and order statistics of blocks of members, and how those of neighbours become one.

Every sum is taken by halving: by additions of arrays, element by element, so that the bits depend neither on
the library nor on the machine.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Moments", "Order", "compacted", "halved", "level_of", "moments", "ordered"]


def halved(rows: Floats) -> Floats:
    """Sum over the first axis, by halves."""
    while len(rows) > 1:
        half = len(rows) // 2
        rows = np.concatenate([rows[:half] + rows[half : 2 * half], rows[2 * half :]])
    total: Floats = rows[0] if len(rows) else np.zeros(rows.shape[1:])
    return total


class Moments(NamedTuple):
    """Of some members: how many, their mean, and, where asked for, the products of deviations summed."""

    members: int
    mean: Floats
    products: Floats | None

    def merged(self, other: Moments) -> Moments:
        """Those of both, after Chan, Golub and LeVeque."""
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
    """Give the moments of rows, shape (n, k).

    Infinite values have an infinite mean, those of both signs none; no products with them are numbers.
    """
    count = len(values)
    with np.errstate(invalid="ignore"):
        mean = halved(values) / count
        if not products:
            return Moments(count, mean, None)
        off = values - mean
        rows = [halved(off[:, [k]] * off) for k in range(off.shape[1])]
        return Moments(count, mean, np.stack(rows))


class Order(NamedTuple):
    """Numbers of some members in order, each standing for as many as its weight says.

    Attributes
    ----------
    buffers : dict
        By weight: sorted along the first axis, shape (m, k).
    error : int
        By how much a rank may be wrong, at most.
    """

    buffers: dict[int, Floats]
    error: int = 0

    def merged(self, other: Order, most: int | None) -> Order:
        """Those of both; beyond `most` numbers of a weight every other one is left out."""
        buffers = dict(self.buffers)
        for weight, values in other.buffers.items():
            held = buffers.get(weight)
            # A stable sort of two sorted runs merges them.
            buffers[weight] = (
                values if held is None else np.sort(np.concatenate([held, values]), axis=0, kind="stable")
            )
        both = Order(buffers, self.error + other.error)
        return both if most is None else compacted(both, most)


def ordered(values: Floats) -> Order:
    """Sort rows, shape (n, k), each column by itself."""
    return Order({1: np.sort(values, axis=0, kind="stable")})


def compacted(order: Order, most: int) -> Order:
    """Leave out every other number where there are more than `most` of one weight.

    Of 2m numbers in order either those in odd or those in even places stay, with twice the weight: a rank is
    wrong by one weight at most. Which of them is a coin that the number in the middle tosses, the same
    everywhere: so the errors of many blocks do not add up.
    """
    buffers, error = dict(order.buffers), order.error
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
    return Order(buffers, error)


def _coin(row: Floats, weight: int) -> int:
    """Toss a coin, 0 or 1, by the bits of some numbers (multiplicative hashing).

    Another one for each weight: a number that its own coin has left in is often the one that is asked again.
    """
    word = int(np.bitwise_xor.reduce(np.ascontiguousarray(row).view(np.uint64)))
    word ^= weight * 0xBF58476D1CE4E5B9
    return (word * 0x9E3779B97F4A7C15 >> 63) & 1


def level_of(order: Order, parts: Floats) -> Floats:
    """Give the numbers below which these parts of all lie, shape (q, k).

    Between the two nearest, where every number is there; else one of them.
    """
    weights = np.concatenate([np.full(len(values), weight) for weight, values in order.buffers.items()])
    values = np.concatenate(list(order.buffers.values()))
    total = int(weights.sum())
    place = np.argsort(values, axis=0, kind="stable")
    values = np.take_along_axis(values, place, axis=0)
    rank = parts * (total - 1)
    if order.error == 0:
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
