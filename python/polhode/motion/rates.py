"""Angular velocity and acceleration along attitudes, and attitudes along an angular velocity.

Around each row a piece of the motion is a polynomial: of the rotation vector from a row in its middle, or of
the angular velocity. Rows are columns of arrays here, so that one component of many rows is contiguous.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike, NDArray

    from polhode._typing import SupportsQuaternion

    Floats = NDArray[np.float64]

__all__ = [
    "angular_acceleration",
    "angular_velocity",
    "cross",
    "exponential",
    "integral",
    "noise_of",
    "quaternion",
    "read_quaternions",
    "read_times",
    "read_vectors",
    "rotation_vectors",
]

_ORDERS: Final = (2, 4, 6, 8)
_BLOCK: Final = 4096
"""Rows that are computed together: their numbers stay in the cache."""
_TRIED: Final = 4096
"""Rows on which orders and windows are tried out."""
_FAR: Final = 5.0
"""The largest sum of turns, in radians, that a rotation vector across a window may have."""
_DEGREES: Final = (2, 4, 6)
"""Degrees that smoothing tries."""
_NOISIEST: Final = 10.0
"""Noise of rows, relative to their size, beyond which they say nothing."""
_RANGE: Final = 1e15
"""The largest ratio of steps in time."""
_FASTEST: Final = 1e3
"""The largest angle, in radians, by which a known angular velocity may turn a body from row to row."""
_SMALL: Final = 0.02
"""Turns from row to row, in radians, whose Magnus series needs no check by half the step."""
_MEDIAN: Final = 2.366
"""Median of the square of three numbers of unit variance."""


class _Choice(NamedTuple):
    """A piece of polynomial that was tried: its half window, its degree, its sizes of error."""

    half: int
    degree: int
    bias: float
    noise: float


# What is read ----------------------------------------------------------------------------------------


def read_times(t: ArrayLike) -> Floats:
    """Return the times, or refuse those that do not ascend."""
    times = _core.real_numbers(t, "t")
    if times.ndim != 1:
        raise ValueError(f"t: expected shape (T,), got {times.shape}")
    if not np.isfinite(times).all():
        row = int(np.flatnonzero(~np.isfinite(times))[0])
        raise PolhodeError(f"t: row {row} is {times[row]}; leave out rows without a time")
    if (falls := np.flatnonzero(np.diff(times) <= 0.0)).size:
        row = int(falls[0]) + 1
        raise PolhodeError(
            f"t: row {row} is {float(times[row])!r} after {float(times[row - 1])!r}, and times must ascend; "
            "sort the rows, and leave out those that stand twice"
        )
    return times


def _plain(attitude: ArrayLike | SupportsQuaternion) -> Any:
    """Return the quaternions of a rotation of another library, and anything else as it is."""
    return attitude.as_quat() if hasattr(attitude, "as_quat") else attitude


def read_quaternions(attitude: ArrayLike | SupportsQuaternion, rows: int, sequence: str | None) -> Floats:
    """Return unit quaternions R_NB of one body, shape (T, 4), continuous in time; rows with a NaN are NaN."""
    known: Floats = _core.real_numbers(_plain(attitude), "attitude")
    tail = (3,) if sequence is not None else (3, 3) if known.shape[-2:] == (3, 3) and known.ndim > 2 else (4,)
    if known.shape != (rows, *tail):
        if known.ndim == len(tail) + 2:
            raise ValueError(
                f"attitude: expected one body, got a stack of shape {known.shape}; take one by one"
            )
        raise ValueError(
            f"attitude: expected {rows} rows like t, of shape (T, 4), (T, 3, 3), or (T, 3) with sequence=, "
            f"got {known.shape}"
        )
    found = np.full((rows, 4), np.nan)
    there = np.asarray(np.isfinite(known).reshape(rows, -1).all(1))
    if np.isinf(known).any():
        row = int(np.flatnonzero(np.isinf(known).any(tuple(range(1, known.ndim))))[0])
        raise PolhodeError(f"attitude: row {row} is infinite; leave the row out, or write NaN")
    if sequence is not None:
        found[there] = _core.quaternion_from_euler_angles(known[there], sequence)
    elif tail == (3, 3):
        found[there] = _of_matrices(known, there)
    else:
        norms = np.linalg.norm(known, axis=1)
        _refuse_far(there & ~(np.abs(norms - 1.0) <= _ROUNDED), norms, "the norm of the quaternion")
        found[there] = known[there] / norms[there, None]
    return _continuous(found, there)


_ROUNDED: Final = 1e-3
"""How far from a rotation a row may be: tables have few digits."""


def _of_matrices(known: Floats, there: NDArray[np.bool_]) -> Floats:
    """Return the quaternions of the nearest rotations of matrices that are nearly rotations."""
    matrices = known[there]
    off = np.full(len(known), 0.0)
    off[there] = np.abs(np.swapaxes(matrices, 1, 2) @ matrices - np.eye(3)).max((1, 2))
    _refuse_far(there & ~(off <= 2.0 * _ROUNDED), off, "the largest element of R^T R - 1")
    determinants = np.linalg.det(known)
    _refuse_far(there & ~(determinants > 0.0), determinants, "the determinant")
    left, _, right = np.linalg.svd(matrices)
    return _core.quaternion_from_matrix(left @ right)


def _refuse_far(bad: NDArray[np.bool_], sizes: Floats, what: str) -> None:
    if bad.any():
        row = int(np.flatnonzero(bad)[0])
        raise PolhodeError(
            f"attitude: row {row} is no rotation: {what} is {sizes[row]:.6g}; rows are unit quaternions "
            "(x, y, z, w), rotation matrices R_NB, or Euler angles with sequence="
        )


def _continuous(quaternions: Floats, there: NDArray[np.bool_]) -> Floats:
    """Return the quaternions with signs that do not jump."""
    known = quaternions[there]
    if len(known):
        jumps = np.einsum("ij,ij->i", known[1:], known[:-1]) < 0.0
        known[1:] *= np.where(np.cumsum(jumps) % 2, -1.0, 1.0)[:, None]
    quaternions[there] = known
    return quaternions


def read_vectors(values: ArrayLike, rows: int, name: str) -> Floats:
    """Return vectors of one body at each time; rows with a NaN are NaN."""
    known = _core.real_numbers(values, name)
    if known.shape != (rows, 3):
        raise ValueError(f"{name}: expected shape ({rows}, 3), a row for each time, got {known.shape}")
    if np.isinf(known).any():
        row = int(np.flatnonzero(np.isinf(known).any(1))[0])
        raise PolhodeError(f"{name}: row {row} is infinite; leave the row out, or write NaN")
    return known


def _rows_there(known: Floats, name: str, least: int = 3) -> NDArray[np.bool_]:
    there = np.asarray(~np.isnan(known).any(1))
    if there.sum() < least:
        raise PolhodeError(f"{name}: needs at least {least} rows without NaN, got {int(there.sum())}")
    return there


def _read_order(order: int | None) -> int | None:
    if order is not None and order not in _ORDERS:
        raise ValueError(f"order: {order!r} is none of {', '.join(map(str, _ORDERS))}")
    return order


def _read_sigma(sigma: float | None) -> float | None:
    if sigma is None:
        return None
    known = _core.real_numbers(sigma, "sigma")
    if known.ndim or not 0.0 < float(known) < np.inf:
        raise ValueError(f"sigma: expected a positive number, got {sigma!r}; None stands for unknown noise")
    return float(known)


# Rotations -------------------------------------------------------------------------------------------


def _product(a: Floats, b: Floats) -> Floats:
    """Multiply quaternions, components first."""
    return np.stack(
        (
            a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
            a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
            a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
            a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
        )
    )


def rotation_vectors(a: Floats, b: Floats) -> Floats:
    """Compute the shortest rotation vectors of ``a⁻¹ b``, components first, in the axes of both."""
    x = a[3] * b[0] - a[0] * b[3] - a[1] * b[2] + a[2] * b[1]
    y = a[3] * b[1] + a[0] * b[2] - a[1] * b[3] - a[2] * b[0]
    z = a[3] * b[2] - a[0] * b[1] + a[1] * b[0] - a[2] * b[3]
    w = a[3] * b[3] + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    length = np.sqrt(x * x + y * y + z * z)
    scale = 2.0 * np.arctan2(length, np.abs(w))
    np.divide(scale, length, out=scale, where=length > 0.0)
    scale = np.where(length > 0.0, scale, 2.0) * np.where(w < 0.0, -1.0, 1.0)
    return np.stack((x * scale, y * scale, z * scale))


def exponential(vectors: Floats) -> Floats:
    """Compute the quaternions of rotation vectors, components first."""
    half = 0.5 * np.sqrt((vectors * vectors).sum(0))
    return np.concatenate((0.5 * np.sinc(half / np.pi) * vectors, np.cos(half)[None]))


def cross(a: Floats, b: Floats) -> Floats:
    """Compute cross products, components first."""
    return np.stack((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def _right_jacobian(phi: Floats, rate: Floats) -> Floats:
    """Compute the angular velocity in turned axes from a rotation vector and its rate."""
    square = (phi * phi).sum(0)
    angle = np.sqrt(square)
    near = square < 1e-4
    safe = np.where(near, 1.0, square)
    first = np.where(near, 0.5 - square / 24.0, (1.0 - np.cos(angle)) / safe)
    second = np.where(near, 1.0 / 6.0 - square / 120.0, (angle - np.sin(angle)) / (safe * np.sqrt(safe)))
    once = cross(phi, rate)
    found: Floats = rate - first * once + second * cross(phi, once)
    return found


# Interpolation ---------------------------------------------------------------------------------------


class _Curve:
    """A motion whose rows are known: attitudes, or vectors if `turning` is False."""

    def __init__(self, t: Floats, values: Floats, *, turning: bool) -> None:
        self.t, self.values, self.turning = t, values, turning
        self._farthest: dict[int, float] = {}
        if turning:
            turns = np.linalg.norm(rotation_vectors(values[:, :-1], values[:, 1:]), axis=0)
            self.total = np.concatenate(([0.0], np.cumsum(turns)))

    def __len__(self) -> int:
        return len(self.t)

    def farthest(self, half: int) -> float:
        """Return the largest sum of the turns across half a window."""
        if not self.turning:
            return 0.0
        half = min(half, len(self) - 1)
        if half not in self._farthest:
            self._farthest[half] = float((self.total[half:] - self.total[:-half]).max())
        return self._farthest[half]

    def steps(self, start: int, stop: int, half: int) -> list[Floats]:
        """Compute what leads from each row from `start` to `stop` to those 1, 2, … `half` ahead."""
        here, found = self.values[:, start:stop], []
        unsure = self.turning and self.farthest(half) > 3.0
        for ahead in range(1, half + 1):
            there = self.values[:, start + ahead : stop + ahead]
            count = there.shape[1]
            if not self.turning:
                found.append(there - here[:, :count])
                continue
            step = rotation_vectors(here[:, :count], there)
            if unsure and ahead > 1:  # the longer way round may be that of the motion
                size = np.linalg.norm(step, axis=0)
                other = step * (1.0 - 2.0 * np.pi / np.where(size > 0.0, size, np.inf))
                guess = found[-1][:, :count] * (ahead / (ahead - 1.0))
                nearer = ((other - guess) ** 2).sum(0) < ((step - guess) ** 2).sum(0)
                step = np.where(nearer, other, step)
            found.append(step)
        return found

    def window(self, center: int, first: int, stop: int) -> Floats:
        """Compute what leads from the row `center` to the rows from `first` to `stop`."""
        rows = self.values[:, first:stop]
        middle = self.values[:, center]
        if not self.turning:
            return rows - middle[:, None]
        if first == center:
            return np.concatenate((np.zeros((3, 1)), self._outwards(center, stop, 1)), axis=1)
        back = self._outwards(center, first - 1, -1)[:, ::-1]
        ahead = self._outwards(center, stop, 1)
        return np.concatenate((back, np.zeros((3, 1)), ahead), axis=1)

    def _outwards(self, center: int, stop: int, way: int) -> Floats:
        """Compute rotation vectors from a row to those on one side, continued beyond half a turn."""
        rows = self.values[:, center + way : stop if stop >= 0 else None : way]
        found = rotation_vectors(self.values[:, [center]], rows)
        for k in range(1, found.shape[1]):
            size = float(np.linalg.norm(found[:, k]))
            guess = found[:, k - 1] * (1.0 + 1.0 / k)
            if size > 0.0:
                other = found[:, k] * (1.0 - 2.0 * np.pi / size)
                if ((other - guess) ** 2).sum() < ((found[:, k] - guess) ** 2).sum():
                    found[:, k] = other
        return found


def _weights(t: Floats, start: int, stop: int, half: int) -> Iterator[tuple[Floats, Floats]]:
    """Compute weights at rows, for windows of 3, 5, … rows.

    Yields
    ------
    weights, shape (2 h, rows)
        The derivative is their sum with the steps to the neighbours, in the order −1, 1, −2, 2, …
    missing, shape (2 h, rows)
        The row itself, as the polynomial of its neighbours has it, is their sum with the steps.
    """
    here = t[start:stop]
    offsets = np.empty((0, stop - start))
    ratios = np.empty((0, stop - start))
    for ahead in range(1, half + 1):
        pair = np.stack((t[start - ahead : stop - ahead] - here, t[start + ahead : stop + ahead] - here))
        # For each neighbour j the product of x_k / (x_k - x_j) over the other neighbours k.
        ratios = ratios * (pair[0] * pair[1] / ((pair[0] - offsets) * (pair[1] - offsets)))
        new = pair[::-1] / (pair[::-1] - pair)
        if ahead > 1:
            new *= (offsets[:, None] / (offsets[:, None] - pair)).prod(0)
        offsets, ratios = np.concatenate((offsets, pair)), np.concatenate((ratios, new))
        yield ratios / offsets, ratios


def _derivatives(
    curve: _Curve, start: int, stop: int, wanted: tuple[int, ...], *, lacking: bool = False
) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Compute derivatives at rows for windows of some half widths.

    Yields
    ------
    rates, shape (3, rows)
    weights, shape (2 h, rows)
    lack, shape (rows,)
        Square of what the polynomial of the neighbours misses of the row, divided by what white noise of
        unit size would make of it; nothing unless `lacking`.
    """
    half = max(wanted)
    steps = curve.steps(start - half, stop, half)
    neighbours = np.empty((2 * half, 3, stop - start))
    for ahead, step in enumerate(steps, 1):
        at = half - ahead
        np.negative(step[:, at : at + stop - start], out=neighbours[2 * ahead - 2])
        neighbours[2 * ahead - 1] = step[:, half : half + stop - start]
    for ahead, (weights, missing) in enumerate(_weights(curve.t, start, stop, half), 1):
        if ahead not in wanted:
            continue
        near = neighbours[: 2 * ahead]
        lack = np.zeros(0)
        if lacking:
            lack = (np.einsum("kn,kcn->cn", missing, near) ** 2).sum(0) / (1.0 + (missing**2).sum(0))
        yield np.einsum("kn,kcn->cn", weights, near), weights, lack


def _pieces(count: int, half: int, *, tried: bool) -> list[tuple[int, int]]:
    """Return blocks of rows with a whole window: all of them, or a few for a trial."""
    first, last = half, count - half
    if not tried or last - first <= _TRIED:
        size = _BLOCK
        return [(k, min(k + size, last)) for k in range(first, last, size)]
    starts = np.linspace(first, last - 256, _TRIED // 256).astype(int)
    return [(int(k), int(k) + 256) for k in starts]


def _interpolated(curve: _Curve, order: int | None) -> tuple[Floats, Floats]:
    """Compute derivatives at all rows by polynomials through the rows; and their errors."""
    count = len(curve)
    widest = min((count - 1) // 2, max(_ORDERS) // 2 + 1)
    while widest > 2 and curve.farthest(widest) > _FAR:
        widest -= 1
    widest = min(widest, (count - 1) // 2)
    noise, errors = _tried(curve, widest)
    if order is None:
        half = int(np.argmin(errors[: max(widest - 1, 1)])) + 1
    else:
        half = min(order // 2, max(widest - 1, 1))
    rates, error = np.empty((3, count)), np.empty(count)
    outer = min(half + 1, widest)
    for start, stop in _pieces(count, outer, tried=False):
        found = [*_derivatives(curve, start, stop, (half, outer))]
        ours, weights, _ = found[0]
        other, wider, _ = found[-1]
        rates[:, start:stop] = ours
        change = (wider**2).sum(0) - (weights * (2.0 * wider[: len(weights)] - weights)).sum(0)
        error[start:stop] = _size(((other - ours) ** 2).sum(0), noise, (weights**2).sum(0), change)
    for row in [*range(outer), *range(max(count - outer, outer), count)]:
        rates[:, row], error[row] = _at_the_end(curve, row, half, noise)
    return rates, error


def _size(off: Any, noise: float, gain: Any, change: Any) -> Any:
    """Combine the square of the change by the next order with what noise makes of both."""
    return np.sqrt(np.maximum(off - 3.0 * noise**2 * change, 0.0) + 3.0 * noise**2 * gain)


def _tried(curve: _Curve, widest: int) -> tuple[float, Floats]:
    """Try the orders out: the noise of a component of a row, and the size of the error of each order."""
    halves = tuple(range(1, widest + 1))
    lacks: list[list[Floats]] = [[] for _ in halves]
    offs, gains, changes = np.zeros((3, widest))
    for start, stop in _pieces(len(curve), widest, tried=True):
        found = [*_derivatives(curve, start, stop, halves, lacking=True)]
        for k, (rates, weights, lack) in enumerate(found):
            lacks[k].append(lack)
            gains[k] += (weights**2).sum()
            if k:
                ours, fewer, _ = found[k - 1]
                offs[k - 1] += ((rates - ours) ** 2).sum()
                changes[k - 1] += ((weights[: len(fewer)] - fewer) ** 2).sum() + (
                    weights[len(fewer) :] ** 2
                ).sum()
    noise = float(np.sqrt(min(np.median(np.concatenate(one)) for one in lacks) / _MEDIAN))
    bias = np.maximum(offs - 3.0 * noise**2 * changes, 0.0)
    bias[-1] = np.inf if widest > 1 else 0.0
    return noise, np.sqrt(bias + 3.0 * noise**2 * gains)


def _at_the_end(curve: _Curve, row: int, half: int, noise: float) -> tuple[Floats, float]:
    """Compute the derivative at a row whose window is not whole, from the nearest whole ones."""
    found = []
    count = len(curve)
    for wider in (half, half + 1):
        size = min(2 * wider + 1, count)
        first = min(max(row - size // 2, 0), count - size)
        center = first + size // 2
        x = curve.t[first : first + size] - curve.t[center]
        path = curve.window(center, first, first + size)
        basis = np.vander(x / abs(x).max(), size, increasing=True)
        at = (x[row - first] / abs(x).max()) ** np.arange(size)
        slope = np.arange(size) * np.concatenate(([0.0], at[:-1])) / abs(x).max()
        weights = np.linalg.solve(basis.T, slope)
        phi, rate = path[:, row - first], path @ weights
        here = _right_jacobian(phi[:, None], rate[:, None])[:, 0] if curve.turning else rate
        found.append((here, weights, first))
    ours, weights, start = found[0]
    other, wide, wide_start = found[1]
    change = wide.copy()
    change[start - wide_start : start - wide_start + len(weights)] -= weights
    off = ((other - ours) ** 2).sum()
    if len(wide) == len(weights):  # there are no more rows to compare with
        off = (ours * ours).sum()
    return ours, float(_size(off, noise, (weights**2).sum(), (change**2).sum()))


# Smoothing -------------------------------------------------------------------------------------------


def _smoothed(curve: _Curve, order: int | None, sigma: float) -> tuple[Floats, Floats]:
    """Compute derivatives by polynomials that fit windows of rows, of the degree and width of least error."""
    degrees = _DEGREES if order is None else (order,)
    best: _Choice | None = None
    for degree in degrees:
        half = degree // 2 + 1
        while 2 * half + 1 <= len(curve) and (half <= degree or curve.farthest(half) < _FAR / 2.0):
            bias, noise = _fitted_sizes(curve, half, degree, sigma)
            if best is None or np.hypot(bias, noise) < np.hypot(best.bias, best.noise):
                best = _Choice(half, degree, bias, noise)
            if bias > 4.0 * noise:
                break
            half = max(half + 1, int(half * 1.5))
    if best is None:
        return _interpolated(curve, order)
    rates, error = np.empty((3, len(curve))), np.empty(len(curve))
    for rows, _, found, gains, _ in _fits(curve, best.half, best.degree, tried=False):
        rates[:, rows] = found
        error[rows] = np.sqrt(best.bias**2 + 3.0 * sigma**2 * gains)
    return rates, error


def _fitted_sizes(curve: _Curve, half: int, degree: int, sigma: float) -> tuple[float, float]:
    """Return the sizes of bias and noise of one fit."""
    offs = gains_sum = change_sum = 0.0
    rows = 0
    for near, off, _, gains, changes in _fits(curve, half, degree, tried=True):
        offs += float(off.sum())
        gains_sum += float(gains.sum())
        change_sum += float(changes.sum())
        rows += len(near)
    bias = max(offs - 3.0 * sigma**2 * change_sum, 0.0) / rows
    return float(np.sqrt(bias)), float(np.sqrt(3.0 * sigma**2 * gains_sum / rows))


def _fits(curve: _Curve, half: int, degree: int, *, tried: bool) -> Iterator[tuple[Any, ...]]:
    """Fit windows in steps of half their half, and yield derivatives at the rows that each is nearest to."""
    count, size = len(curve), 2 * half + 1
    hop = max(half // 2, 1)
    centers = np.arange(0, count, hop)
    if tried and len(centers) * size > 8 * _TRIED:
        keep = max(8 * _TRIED // size, 4)
        centers = centers[np.linspace(0, len(centers) - 1, keep).astype(int)]
    many = max(4 * _BLOCK // size, 1)
    for k in range(0, len(centers), many):
        nearest = centers[k : k + many]
        firsts = np.clip(nearest - half, 0, count - size)
        middles = firsts + half
        rows = firsts[:, None] + np.arange(size)
        x = curve.t[rows] - curve.t[middles][:, None]
        scale = np.abs(x).max(1, keepdims=True)
        path, start = curve.values[:, rows.ravel()], curve.values[:, np.repeat(middles, size)]
        path = rotation_vectors(start, path) if curve.turning else path - start
        path = np.ascontiguousarray(path.reshape(3, len(nearest), size).transpose(1, 2, 0))
        basis, slopes = _legendre(x / scale, min(degree + 2, size - 1))
        near = np.minimum(nearest[:, None] + np.arange(hop), count - 1)
        at = (near - firsts[:, None])[..., None]
        here = np.take_along_axis(basis, at, 1)
        slopes = np.take_along_axis(slopes, at, 1) / scale[..., None]
        right = np.concatenate(
            (np.swapaxes(basis, 1, 2) @ path, np.zeros((len(nearest), basis.shape[2], hop))), 2
        )
        right[..., 3:] = np.swapaxes(slopes, 1, 2)
        gram = np.swapaxes(basis, 1, 2) @ basis + 1e-13 * size * np.eye(
            basis.shape[2]
        )  # times may stand in clumps
        results = []
        for terms in (degree + 1, basis.shape[2]):
            solved = np.linalg.solve(gram[:, :terms, :terms], right[:, :terms])
            phi = (here[..., :terms] @ solved[..., :3]).reshape(-1, 3).T
            rate = (slopes[..., :terms] @ solved[..., :3]).reshape(-1, 3).T
            gain = np.einsum("bst,bts->bs", slopes[..., :terms], solved[..., 3:]).ravel()
            results.append((_right_jacobian(phi, rate) if curve.turning else rate, gain))
        (ours, gain), (other, wider) = results
        yield near.ravel(), ((other - ours) ** 2).sum(0), ours, gain, wider - gain


def _legendre(x: Floats, degree: int) -> tuple[Floats, Floats]:
    """Compute Legendre polynomials and their derivatives."""
    values, slopes = np.empty((*x.shape, degree + 1)), np.empty((*x.shape, degree + 1))
    values[..., 0], values[..., 1], slopes[..., 0], slopes[..., 1] = 1.0, x, 0.0, 1.0
    for n in range(1, degree):
        values[..., n + 1] = ((2 * n + 1) * x * values[..., n] - n * values[..., n - 1]) / (n + 1)
        slopes[..., n + 1] = slopes[..., n - 1] + (2 * n + 1) * values[..., n]
    return values, slopes


# What is computed ------------------------------------------------------------------------------------


def _rates(
    t: Floats, known: Floats, order: int | None, sigma: float | None, *, turning: bool
) -> tuple[Floats, Floats]:
    """Compute rates and their errors, in units of a step and of the values."""
    unit = _unit_of_steps(t)
    size = 1.0 if turning else _power_of_two(np.abs(known).max())
    if sigma is not None and not sigma < _NOISIEST * size:
        raise PolhodeError(
            f"sigma: {sigma:g} is more than {_NOISIEST * size:g}, at which nothing is known of the rates; "
            "give the standard deviation of one component of a row"
        )
    curve = _Curve((t - t[0]) / unit, np.ascontiguousarray(known.T) / size, turning=turning)
    if sigma is None:
        rates, error = _interpolated(curve, order)
    else:
        rates, error = _smoothed(curve, order, sigma / size)
    with np.errstate(over="ignore"):
        rates, error = rates.T * size / unit, error * size / unit
    if not (np.isfinite(rates).all() and np.isfinite(error).all()):
        raise PolhodeError("t: the rates are beyond floating-point numbers; take larger units of time")
    return rates, error


def _power_of_two(size: float) -> float:
    """Return the power of two nearest to a size, by which numbers are divided without rounding."""
    return float(np.ldexp(1.0, int(np.clip(np.frexp(size)[1], -1000, 1000)))) if size > 0.0 else 1.0


def _unit_of_steps(t: Floats) -> float:
    """Return a power of two near a usual step, or refuse steps that differ too much."""
    steps = np.diff(t)
    least, most = float(steps.min()), float(steps.max())
    if not most < np.inf or least < most / _RANGE:
        raise PolhodeError(
            f"t: its steps go from {least:g} to {most:g}, and may differ by a factor of {_RANGE:g}; leave "
            "out rows that are too near to others"
        )
    return _power_of_two(float(np.median(steps)))


def _with_gaps(there: NDArray[np.bool_], found: Floats) -> Floats:
    """Return the results with rows of NaN where the input had none."""
    if there.all():
        return np.ascontiguousarray(found)
    whole = np.full((len(there), *found.shape[1:]), np.nan)
    whole[there] = found
    return whole


def angular_velocity(
    t: ArrayLike,
    attitude: ArrayLike | SupportsQuaternion,
    frame: Literal["body", "space"] = "body",
    order: int | None = None,
    *,
    sigma: float | None = None,
    sequence: str | None = None,
) -> tuple[Floats, Floats]:
    """Compute the angular velocity along attitudes that are known at some times.

    Around each row the rotation vector from this row, in the axes of the body, is a polynomial through the
    neighbouring rows. Its derivative at the row is the angular velocity.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times, ascending, in any steps.
    attitude : array_like or rotation, shape (T, 4), (T, 3, 3) or (T, 3)
        R_NB at each time: quaternions (x, y, z, w), rotation matrices, SciPy rotations, or Euler angles in
        radians with `sequence`. A row with a NaN is left out. From one row to the next the body must turn by
        less than half a turn.
    frame : {"body", "space"}
        The frame whose axes the components refer to.
    order : {2, 4, 6, 8}, optional
        Degree of the polynomials: through so many neighbours of each row. By default it is the one with the
        least estimated error. Few rows, or large turns from row to row, allow low orders only.
    sigma : float, optional
        Standard deviation, in radians, of white noise of the attitudes about each axis of the body. With it,
        the polynomials fit more rows than they pass through: degree and number of rows have the least
        estimated error. Without it every row is passed through.
    sequence : str, optional
        Sequence of Euler angles, as in :mod:`polhode.euler_angles`.

    Returns
    -------
    omega : numpy.ndarray, shape (T, 3)
        Angular velocity of the body relative to space, in radians per unit of time. NaN at rows with a NaN.
    error : numpy.ndarray, shape (T,)
        Estimated size of the error of each row: the change by two more orders, and the noise. Without `sigma`
        the noise is estimated from what polynomials through the neighbours of a row miss of this row.

    Raises
    ------
    PolhodeError
        For rows that are no rotations, times that do not ascend, and fewer than three rows.

    Notes
    -----
    From the rotation vector φ(t) with ``R(t) = R(t_k) exp(φ×)`` the angular velocity in the axes of the body
    is ``φ̇`` at the row itself, where φ is zero, and ``φ̇ − (1 − cos φ)/φ² φ×φ̇ + (φ − sin φ)/φ³ φ×(φ×φ̇)`` at
    other rows: at the ends, and where noise is smoothed [1]_.

    References
    ----------
    .. [1] J. E. Bortz, "A New Mathematical Formulation for Strapdown Inertial Navigation", IEEE Transactions
       on Aerospace and Electronic Systems AES-7 (1971) 61.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import kinematics, solids
    >>> t = np.linspace(0.0, 4.0, 81)
    >>> motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.3, 2.0, 0.1)).at(t)
    >>> omega, error = kinematics.angular_velocity(t, motion.quaternion)
    >>> bool(np.abs(omega - motion.omega).max() < 1e-8), bool(error.max() < 1e-8)
    (True, True)
    """
    if frame not in ("body", "space"):
        raise ValueError(f"frame: {frame!r} is not 'body' or 'space'")
    times = read_times(t)
    known = read_quaternions(attitude, len(times), sequence)
    there = _rows_there(known, "attitude")
    rates, error = _rates(times[there], known[there], _read_order(order), _read_sigma(sigma), turning=True)
    if frame == "space":
        rates = _core.rotate(known[there], rates)
    return _with_gaps(there, rates), _with_gaps(there, error)


def angular_acceleration(
    t: ArrayLike, omega: ArrayLike, order: int | None = None, *, sigma: float | None = None
) -> tuple[Floats, Floats]:
    """Compute the angular acceleration along an angular velocity that is known at some times.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times, ascending, in any steps.
    omega : array_like, shape (T, 3)
        Angular velocity at each time. A row with a NaN is left out. Of attitudes,
        :func:`angular_velocity` computes it.
    order : {2, 4, 6, 8}, optional
        Degree of the polynomials; by default the one with the least estimated error.
    sigma : float, optional
        Standard deviation of white noise of each component; as in :func:`angular_velocity`.

    Returns
    -------
    acceleration : numpy.ndarray, shape (T, 3)
        In the axes of `omega`: the rate of ω is the same in the body and in space, since ω×ω is zero.
    error : numpy.ndarray, shape (T,)
        Estimated size of the error of each row.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import kinematics, solids
    >>> t = np.linspace(0.0, 4.0, 81)
    >>> motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.3, 2.0, 0.1)).at(t)
    >>> rate, error = kinematics.angular_acceleration(t, motion.omega)
    >>> bool(np.abs(rate - motion.angular_acceleration()).max() < 1e-6)
    True
    """
    times = read_times(t)
    known = read_vectors(omega, len(times), "omega")
    there = _rows_there(known, "omega")
    rates, error = _rates(times[there], known[there], _read_order(order), _read_sigma(sigma), turning=False)
    return _with_gaps(there, rates), _with_gaps(there, error)


# From angular velocities to attitudes ----------------------------------------------------------------

_NODES: Final = 0.5 + np.sqrt(0.15) * np.array([-1.0, 0.0, 1.0])
"""Gauss's three nodes between 0 and 1."""


def quaternion(
    t: ArrayLike,
    omega: ArrayLike,
    attitude: ArrayLike | SupportsQuaternion = (0.0, 0.0, 0.0, 1.0),
    frame: Literal["body", "space"] = "body",
    order: int = 6,
) -> tuple[Floats, Floats]:
    """Compute attitudes from an angular velocity that is known at some times.

    Between two rows the angular velocity is a polynomial through `order` neighbouring rows. The rotation from
    row to row is the Magnus series of sixth order.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times, ascending, in any steps.
    omega : array_like, shape (T, 3)
        Angular velocity relative to space, in radians per unit of time. A row with a NaN is left out.
    attitude : array_like or rotation, shape (4,)
        R_NB at the first row that is not left out.
    frame : {"body", "space"}
        The frame whose axes the components of `omega` refer to.
    order : {2, 4, 6, 8}
        Through how many rows the polynomials pass; few rows allow low orders only.

    Returns
    -------
    quaternion : numpy.ndarray, shape (T, 4)
        R_NB as (x, y, z, w), continuous in time. NaN at rows with a NaN.
    error : numpy.ndarray, shape (T,)
        Estimated size of the error of each row, in radians: the sum of the changes by two more orders and
        half the steps, the noise of `omega`, and rounding.

    Notes
    -----
    The Magnus series and its formula with three nodes are those of [1]_.

    References
    ----------
    .. [1] S. Blanes, F. Casas, J. A. Oteo, J. Ros, "The Magnus expansion and some of its applications",
       Physics Reports 470 (2009) 151, section 5.4.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import kinematics, solids
    >>> t = np.linspace(0.0, 4.0, 81)
    >>> motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.3, 2.0, 0.1)).at(t)
    >>> found, error = kinematics.quaternion(t, motion.omega)
    >>> bool(np.abs(found - motion.quaternion).max() < 1e-7), bool(error.max() < 1e-7)
    (True, True)
    """
    if frame not in ("body", "space"):
        raise ValueError(f"frame: {frame!r} is not 'body' or 'space'")
    times = read_times(t)
    known = read_vectors(omega, len(times), "omega")
    if _read_order(order) is None:
        raise ValueError(f"order: {order!r} is none of {', '.join(map(str, _ORDERS))}")
    start = _core.real_numbers(_plain(attitude), "attitude")
    if start.shape != (4,):
        raise ValueError(f"attitude: expected shape (4,), at the first row, got {start.shape}")
    first = read_quaternions(start[None], 1, None)[0]
    if np.isnan(first).any():
        raise PolhodeError("attitude: it must be finite, got NaN; give R_NB at the first row")
    there = _rows_there(known, "omega", 2)
    t_there, rows = times[there], known[there].T
    unit = _unit_of_steps(t_there)
    t_there = (t_there - t_there[0]) / unit
    with np.errstate(over="ignore"):
        rows = np.ascontiguousarray(rows) * unit
    turn = float(np.abs(rows).max() * np.diff(t_there).max())
    if not turn < _FASTEST:
        raise PolhodeError(
            f"omega: the body would turn by {turn:.3g} rad from one row to the next, and its attitude would "
            "not be known; give more rows, or check the units"
        )
    if frame == "space":  # R_BN turns with -omega in its own axes, which are those of space
        rows = -rows
    count = len(t_there)
    half = min(order, count - count % 2) // 2
    wider = min(half + 1, count // 2)
    noise = _tried(_Curve(t_there, rows, turning=False), min((count - 1) // 2, 5))[0] if count > 2 else 0.0
    turns, lack = np.empty((3, count - 1)), np.empty((3, count - 1))
    for begin in range(0, count - 1, _BLOCK):
        stop = min(begin + _BLOCK, count - 1)
        coarse = _turns(t_there, rows, begin, stop, half, 1)
        # The Magnus series of small turns is exact to many more digits than the polynomials.
        fine = _turns(t_there, rows, begin, stop, wider, 2 if turn > _SMALL else 1)
        turns[:, begin:stop], lack[:, begin:stop] = coarse, fine - coarse
    found = _chain(exponential(turns), np.asarray(first) if frame == "body" else first * [-1, -1, -1, 1])
    widths = np.diff(t_there)
    off = np.zeros((3, count))
    off[:, 1:] = np.cumsum(
        _core.rotate(np.ascontiguousarray(found[:, 1:].T), np.ascontiguousarray(lack.T)), 0
    ).T
    walk = np.concatenate(([0.0], np.cumsum(3.0 * (noise * widths) ** 2 + (0.25 * np.finfo(float).eps) ** 2)))
    error = np.sqrt((off * off).sum(0) + walk)
    if frame == "space":
        found[:3] *= -1.0
    result = np.full((len(times), 4), np.nan)
    result[there] = found.T
    return _continuous(result, there), _with_gaps(there, error)


def _turns(t: Floats, omega: Floats, begin: int, stop: int, half: int, parts: int) -> Floats:
    """Compute the rotation vectors from row to row, from polynomials through 2 `half` rows."""
    width = t[begin + 1 : stop + 1] - t[begin:stop]
    found: Floats | None = None
    for a in _at_nodes(t, omega, begin, stop, half, parts):
        step = _magnus(a, width / parts)
        found = step if found is None else rotation_vectors(exponential(-found), exponential(step))
    assert found is not None
    return found


def _at_nodes(
    t: Floats, values: Floats, begin: int, stop: int, half: int, parts: int
) -> Iterator[list[Floats]]:
    """Interpolate vectors at the three nodes of each part of the steps from row to row."""
    size = min(2 * half, len(t))
    here = np.arange(begin, stop)
    firsts = np.clip(here - half + 1, 0, len(t) - size)
    rows = firsts + np.arange(size)[:, None]
    x = t[rows] - t[here]
    width = t[here + 1] - t[here]
    apart = x[:, None] - x
    apart[range(size), range(size)] = 1.0
    factors = 1.0 / apart.prod(1)
    near = np.ascontiguousarray(values[:, rows].transpose(1, 0, 2))
    for part in range(parts):
        offs = [(part + node) / parts * width - x for node in _NODES]
        yield [np.einsum("kn,kcn->cn", factors / off * off.prod(0), near) for off in offs]


def integral(t: Floats, values: Floats) -> Floats:
    """Integrate vectors, components first, from the first row to each row."""
    half = min(6, len(t) - len(t) % 2) // 2
    parts = [np.zeros((len(values), 1))]
    for begin in range(0, len(t) - 1, _BLOCK):
        stop = min(begin + _BLOCK, len(t) - 1)
        (a,) = _at_nodes(t, values, begin, stop, half, 1)
        parts.append((5.0 * a[0] + 8.0 * a[1] + 5.0 * a[2]) / 18.0 * np.diff(t)[begin:stop])
    return np.cumsum(np.concatenate(parts, axis=1), axis=1)


def noise_of(t: Floats, values: Floats, *, turning: bool) -> float:
    """Estimate the standard deviation of white noise of each component of rows, components first."""
    curve = _Curve(t, values, turning=turning)
    widest = min((len(t) - 1) // 2, 5)
    while widest > 1 and curve.farthest(widest) > _FAR:
        widest -= 1
    return _tried(curve, widest)[0]


def _magnus(a: list[Floats], width: Floats) -> Floats:
    """Compute the rotation vector, in turned axes, of an angular velocity at three nodes of a step."""
    first = width * a[1]
    second = np.sqrt(15.0) / 3.0 * width * (a[2] - a[0])
    third = 10.0 / 3.0 * width * (a[2] - 2.0 * a[1] + a[0])
    # R' = R [omega x] multiplies from the right: the commutators have the other sign than for Y' = A Y.
    one = -cross(first, second)
    two = cross(first, 2.0 * third + one) / 60.0
    return first + third / 12.0 - cross(-20.0 * first - third + one, second + two) / 240.0


def _chain(steps: Floats, first: Floats) -> Floats:
    """Multiply rotations one after another, in columns that go on together."""
    count = steps.shape[1]
    length = int(np.ceil(np.sqrt(max(count, 1))))
    many = -(-count // length) if count else 0
    padded = np.zeros((4, many * length))
    padded[3] = 1.0
    padded[:, :count] = steps
    columns = np.ascontiguousarray(padded.reshape(4, many, length).transpose(2, 0, 1))
    for k in range(1, length):
        columns[k] = _product(columns[k - 1], columns[k])
    starts, here = np.empty((4, many)), first
    for k in range(many):
        starts[:, k] = here
        here = _product(here, columns[-1][:, k])
        here = here / np.linalg.norm(here)
    chained = _product(starts[:, :, None], columns.transpose(1, 2, 0)).reshape(4, -1)[:, :count]
    found = np.concatenate((first[:, None], chained), axis=1)
    found /= np.sqrt((found * found).sum(0))
    return found
