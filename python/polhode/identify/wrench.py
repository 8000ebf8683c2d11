"""From the wrench of a sensor and the motion of a payload to its ten inertial parameters."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from polhode._core import RigidBody, Uncertain
from polhode._hints import check_kind
from polhode.errors import IdentificationError
from polhode.identify.cone import along_the_edge, fit_possible, pseudo_inertia_maps
from polhode.identify.results import (
    ELEMENTS,
    NUMBERS,
    Direction,
    Identified,
    find_directions,
    p_value_of,
    tensor_of,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = ["from_wrench"]

_ONE: Final = np.eye(3)
_BASIS: Final = np.array(tensor_of(np.eye(6)))
_MAPS: Final = pseudo_inertia_maps(_BASIS)
_FEATURES: Final = 13
"""Of the motion: specific force, angular acceleration, six products of angular velocities, and 1."""
_CYCLES: Final = 10.0
"""Cycles of the fastest motion in a window."""
_MOST: Final = 100.0
"""Cycles in a window that a caller may ask for: the work grows with them."""
_COARSE: Final = 0.125
"""Cycles of the fastest motion in a sample, beyond which samples do not tell its acceleration."""
_DEGREE: Final = 5
"""Of splines."""
_PIECES: Final = 5.0
"""Pieces of a spline in a cycle of the fastest motion."""
_FINER: Final = 3
"""The wrench is projected on splines with so many times as many pieces."""
_EVEN: Final = 1e-3
"""Share of a step by which times may differ from even ones in what follows from them."""
_RAGGED: Final = 2.0
"""A window is left out if gaps make the noise of its acceleration larger than so many usual ones."""
_SOME: Final = 16
"""Windows from which the share of noise is found that products have."""
_LEAST: Final = 32
"""Samples of the shortest window."""
_SMOOTH: Final = 7
"""Lines of a spectrum over which it is smoothed."""
_PIECE: Final = 128
"""Rows of a piece of which a triangle is made."""
_NU: Final = 4.0
"""Degrees of freedom of Student's distribution."""
_GAP: Final = 3.0
"""A step of time is a gap if it is longer than so many usual ones,"""
_BRIDGE: Final = 0.125
"""and than this share of the cycle of the fastest motion."""
_PASSES: Final = 50


class _Sums(NamedTuple):
    """Triangles of the features of groups of rows, and what their noise is made of."""

    features: Floats
    """Shape (groups, rows, 19)."""
    triangles: Floats
    shares: Floats
    """Of each group: how much of the noise of ω is in its products, and in its acceleration."""
    spins: Floats
    """Three vectors u with Σ u uᵀ the mean of ω ωᵀ."""


def from_wrench(
    t: ArrayLike,
    force: ArrayLike,
    torque: ArrayLike,
    omega: ArrayLike,
    specific_force: ArrayLike,
    *,
    angular_acceleration: ArrayLike | None = None,
    force_sigma: ArrayLike | None = None,
    torque_sigma: ArrayLike | None = None,
    omega_sigma: float | None = None,
    bias: bool = False,
    at: ArrayLike = (0.0, 0.0, 0.0),
    prior: RigidBody | None = None,
    window: int | None = None,
    loss: Literal["gaussian", "student"] = "gaussian",
) -> Identified:
    """Find the most likely payload from a log of its wrench and its motion.

    All vectors are in the axes of the sensor frame S. The equations, about its origin O, are
    ``f = m a + ω̇ × mc + ω × (ω × mc)`` and ``τ = mc × a + I_O ω̇ + ω × I_O ω``. They are linear in the ten
    parameters m, mc and I_O, and these are those of a body where the pseudo-inertia is positive semidefinite.
    The fit among these is a convex problem and is solved with a certificate.

    Parameters
    ----------
    t : array_like, shape (n,)
        Ascending times.
    force, torque : array_like, shape (n, 3)
        Of the sensor on the payload, about O. Many sensors report those of the payload on them: negate these.
    omega : array_like, shape (n, 3)
        Angular velocity of S.
    specific_force : array_like, shape (n, 3)
        Acceleration of O minus gravity, as an accelerometer at O reads: −g at rest.
    angular_acceleration : array_like, shape (n, 3), optional
        Without it the angular velocity is a spline in each window, whose derivative is the acceleration;
        what noise of ω does to both is in the weights.
    force_sigma, torque_sigma : float or array_like, shape (3,), optional
        Standard deviations of white noise; without one it is estimated from the residuals.
    omega_sigma : float, optional
        Of the angular velocity. For windows the high end of its spectrum tells it where it is not given;
        beside an angular acceleration it is zero then.
    bias : bool
        Whether constant offsets of force and torque are estimated too.
    at : array_like, shape (3,)
        Origin of the body frame, in S.
    prior : RigidBody, optional
        What is known of the payload beforehand, in the body frame: a body with a covariance.
    window : int, optional
        Number of samples of a window; by default some ten cycles of the fastest motion, from the spectra of
        `omega` and `specific_force`.
    loss : {"gaussian", "student"}
        The second bears outliers: noise by Student's distribution with 4 degrees of freedom.

    Returns
    -------
    Identified
        The axes of its body are those of S.

    Raises
    ------
    IdentificationError
        ``"undetermined"`` with the directions that the motion tells nothing of; ``"clock"`` for times that do
        not ascend; ``"no fit"`` where given sigmas cannot explain the residuals, with a probability below
        1e-6.
    ValueError
        For arrays whose shapes do not agree.

    Notes
    -----
    A row with a number that is not finite is left out, and so are rows that fill no window before a gap of
    time; ``dropped`` counts them. Noise of `specific_force` is not modelled.

    Examples
    --------
    A payload of 2 kg that a wrist turns about all axes:

    >>> import numpy as np
    >>> from polhode import identify, solids
    >>> box = solids.box((0.1, 0.2, 0.3), mass=2.0).translated((0.0, 0.02, 0.1))
    >>> t = np.linspace(0.0, 10.0, 500)
    >>> phases = np.outer(t, (1.0, 1.3, 1.7))
    >>> omega, turn = np.sin(phases), np.cos(phases) * (1.0, 1.3, 1.7)
    >>> down = 9.81 * np.stack([np.sin(t), np.cos(t) * np.sin(2 * t), np.cos(t) * np.cos(2 * t)], axis=1)
    >>> mc, about = 2.0 * box.center_of_mass, box.inertia_about("origin")
    >>> force = 2.0 * down + np.cross(turn, mc) + np.cross(omega, np.cross(omega, mc))
    >>> torque = np.cross(mc, down) + turn @ about + np.cross(omega, omega @ about)
    >>> noisy = np.random.default_rng(1).normal(0.0, (0.1, 0.01), (500, 3, 2))
    >>> found = identify.from_wrench(
    ...     t, force + noisy[..., 0], torque + noisy[..., 1], omega, down, angular_acceleration=turn
    ... )
    >>> round(found.body.mass, 2), found.body.center_of_mass.round(3)
    (2.0, array([-0.  ,  0.02,  0.1 ]))
    >>> found.at_edge, [one.words for one in found.observability]
    (False, [])
    """
    times, rows = (
        _times(t),
        {"force": force, "torque": torque, "omega": omega, "specific_force": specific_force},
    )
    if angular_acceleration is not None:
        rows["angular_acceleration"] = angular_acceleration
    data = {name: _columns(name, one, len(times)) for name, one in rows.items()}
    sigmas = np.concatenate([_sigma("force_sigma", force_sigma), _sigma("torque_sigma", torque_sigma)])
    spin_sigma = None if omega_sigma is None else float(_sigma("omega_sigma", omega_sigma)[0])
    origin = np.asarray(at, dtype=float)
    if origin.shape != (3,) or not np.isfinite(origin).all():
        raise ValueError(f"at: expected a point of shape (3,), got {at!r}")
    if loss not in ("gaussian", "student"):
        raise ValueError(f"loss: expected 'gaussian' or 'student', got {loss!r}")
    if prior is not None:
        check_kind(prior, "prior", "RigidBody")
        if prior.shape != () or prior.covariance is None:
            raise ValueError("prior: expected one body with a covariance; give it one by with_covariance")
        prior = prior.translated(origin)
    good = np.isfinite(times)
    for one in data.values():
        good = good & np.isfinite(one).all(axis=1)
    dropped = {"not finite": int((~good).sum())} if not good.all() else {}
    least = 4 + 2 * bias
    if angular_acceleration is not None:
        if window is not None:
            raise ValueError(
                "window: with angular_acceleration each row is an equation; give only one of them"
            )
        whole = {name: one[good] for name, one in data.items()}
        features = _features(whole, whole["angular_acceleration"])[None]
        shares, spin_sigma = np.array([[1.0, 0.0]]), spin_sigma or 0.0
    else:
        if window is not None and (int(window) != window or not _LEAST <= window <= len(times)):
            raise ValueError(
                f"window: expected a whole number from {_LEAST} to {len(times)} rows, got {window}"
            )
        window = None if window is None else int(window)
        whole = {name: one[good] for name, one in data.items()}
        count = int(good.sum())
        _check_rows(count, least)
        highest = max(_highest(times[good], whole[name]) for name in ("omega", "specific_force"))
        spin_sigma = _level(whole["omega"]) if spin_sigma is None else spin_sigma
        if highest > _COARSE:
            raise IdentificationError(
                f"omega, specific_force: the fastest motion has {1.0 / highest:.3g} samples a cycle, ",
                f"and {1.0 / _COARSE:g} tell its acceleration",
                "; record at a higher rate, or give angular_acceleration",
                kind="undetermined",
            )
        runs = _runs(times[good], highest)
        if window is None:
            window = _best_window([len(one) for one in runs], highest)
        elif highest * window > _MOST:
            raise ValueError(
                f"window: {window} rows hold {highest * window:.4g} cycles of the fastest motion, expected "
                f"at most {_MOST:g}: {int(_MOST / highest)} rows; or leave window out"
            )
        features, shares, lost = _windows(times[good], whole, runs, window, highest)
        if lost:
            dropped["outside windows"] = lost
    _check_rows(features.shape[0] * features.shape[1], least)
    mean = whole["omega"].T @ whole["omega"] / len(whole["omega"])
    values, vectors = np.linalg.eigh(mean)
    spins = (vectors * np.sqrt(np.maximum(values, 0.0))).T
    sums = _Sums(features, _triangles(features), shares, spins)
    fit = _Fit(sums, sigmas, spin_sigma, bias, prior, loss == "student")
    return fit.solve(origin, dropped, window)


def _times(t: ArrayLike) -> Floats:
    times = np.asarray(t, dtype=float)
    if times.ndim != 1 or len(times) < 2:
        raise ValueError(f"t: expected shape (n,) of at least two times, got {times.shape}")
    finite = times[np.isfinite(times)]
    back = np.flatnonzero(np.diff(finite) <= 0.0)
    if len(back):
        k = int(back[0])
        raise IdentificationError(
            f"t: time does not ascend from row {k} to the next: {finite[k]}, {finite[k + 1]}",
            "; sort the rows, and keep each once",
            kind="clock",
        )
    return times


def _check_rows(count: int, least: int) -> None:
    if count < least:
        raise IdentificationError(
            f"t: {count} rows without a gap are too few: at least {least} equations are needed",
            "; record longer, or choose a smaller window",
            kind="undetermined",
        )


def _columns(name: str, given: ArrayLike, n: int) -> Floats:
    found = np.asarray(given, dtype=float)
    if found.shape != (n, 3):
        raise ValueError(f"{name}: expected shape ({n}, 3), a row for each time, got {found.shape}")
    if np.abs(found[np.isfinite(found)]).max(initial=0.0) > 1e100:
        raise ValueError(f"{name}: numbers beyond 1e100 are none of a sensor; check the file")
    return found


def _sigma(name: str, given: ArrayLike | None) -> Floats:
    """Return three sigmas; NaN where none is given."""
    if given is None:
        return np.full(3, np.nan)
    found = np.asarray(given, dtype=float)
    if found.shape not in ((), (3,)) or not ((found > 1e-100) & (found < 1e100)).all():
        raise ValueError(f"{name}: expected a positive number or three, got {given!r}")
    return np.broadcast_to(found, 3).astype(float)


def _features(data: dict[str, Floats], turn: Floats) -> Floats:
    """Return what the equations are linear in, shape (n, 19): 13 numbers of the motion, then the wrench."""
    omega = data["omega"]
    products = np.stack([omega[:, i] * omega[:, j] for i, j in ELEMENTS], axis=1)
    one = np.ones((len(omega), 1))
    return np.hstack([data["specific_force"], turn, products, one, data["force"], data["torque"]])


def _triangles(features: Floats) -> Floats:
    """Return the triangles of the QR of groups: all that least squares need of any number of rows.

    Of short pieces first, then of the triangles of these: for a long matrix a library takes two threads,
    which wait for one another at each column.
    """
    groups, n, columns = features.shape
    while n > _PIECE:
        whole = n // _PIECE * _PIECE
        pieces = features[:, :whole].reshape(-1, _PIECE, columns)
        reduced = np.asarray(np.linalg.qr(pieces, mode="r")).reshape(groups, -1, columns)
        features = np.concatenate([reduced, features[:, whole:]], axis=1)
        n = features.shape[1]
    return np.asarray(np.linalg.qr(features, mode="r"))


def _products(matrices: Floats, rows: Floats) -> Floats:
    """Return a product for each window; where all have one matrix, by one product."""
    if len(matrices) > 1:
        return np.asarray(matrices @ rows)
    return np.moveaxis(np.tensordot(matrices[0], rows, (1, 1)), 0, 1)


def _highest(t: Floats, omega: Floats) -> float:
    """Return the highest frequency of a motion, in cycles a sample, from rows between which it is even."""
    n = len(t)
    if n < _LEAST:
        return 0.0
    even = np.linspace(t[0], t[-1], n)
    power = _power(np.stack([np.interp(even, t, one) for one in omega.T], axis=1))
    floor = float(power[-len(power) // 4 :].mean())
    power = np.convolve(power, np.full(_SMOOTH, 1.0 / _SMOOTH), mode="same")  # else noise passes for motion
    frequency = np.arange(1, len(power) + 1) / n
    moving = np.cumsum(np.maximum(power - 4.0 * floor, 0.0) * frequency**2)
    return float(frequency[np.searchsorted(moving, 0.99 * moving[-1])]) if moving[-1] > 0.0 else 0.0


def _level(omega: Floats) -> float:
    """Return the level of the white noise of ω: that of the last quarter of its spectrum."""
    if len(omega) < _LEAST:
        return 0.0
    power = _power(omega)
    return math.sqrt(float(power[-len(power) // 4 :].mean()) / (3.0 * 0.375 * len(omega)))


def _power(rows: Floats) -> Floats:
    """Return the power of a tapered record in each line of its spectrum but the first."""
    taper = np.sin(np.pi * (np.arange(len(rows)) + 0.5) / len(rows)) ** 2
    line = (rows - rows.mean(axis=0)) * taper[:, None]
    return np.asarray(np.sum(np.abs(np.fft.rfft(line, axis=0)) ** 2, axis=1)[1:])


def _runs(t: Floats, highest: float) -> list[NDArray[np.int64]]:
    """Return the indices of rows between gaps that a spline does not bridge."""
    steps = np.diff(t)
    longest = max(_GAP, _BRIDGE / highest if highest > 0.0 else 0.0) * float(np.median(steps))
    return np.split(np.arange(len(t)), np.flatnonzero(steps > longest) + 1)


def _best_window(runs: list[int], highest: float) -> int:
    """Return the window, of five to ten cycles where there are so many, that leaves the fewest rows out."""
    longest = max(runs)
    most = min(longest, max(_LEAST, int(_CYCLES / highest) if highest > 0.0 else longest))
    tried = range(most, max(most // 2, min(_LEAST, most)) - 1, -1)
    return max(tried, key=lambda window: sum(one // window for one in runs) * window)


def _windows(
    t: Floats, data: dict[str, Floats], runs: list[NDArray[np.int64]], window: int, highest: float
) -> tuple[Floats, Floats, int]:
    """Return features of windows, projected on orthonormal splines of time.

    In a window the angular velocity is the spline that fits it best, and its acceleration is the derivative
    of that. Finer splines keep what products of the motion tell. They are combined so that white noise of
    the wrench is independent in all of them, and noise of ω in its acceleration too. The last result is the
    number of rows in no window.
    """
    tiles = [one[: len(one) // window * window].reshape(-1, window) for one in runs]
    index = np.concatenate(tiles)
    if not len(index):
        return np.zeros((1, 0, 19)), np.zeros((1, 2)), len(t)
    local = t[index]
    span = local[:, -1:] - local[:, :1]
    place = (local - local[:, :1]) / span
    if np.abs(place - place[0]).max() < _EVEN / window:
        place = place[:1]  # evenly spaced rows have the same functions in all windows
    pieces = max(min(math.ceil(_PIECES * highest * window), window - _DEGREE), 1)
    splines, slopes = _splines(place, pieces)
    smooth, change = np.linalg.qr(splines)
    # A window in which rows are too far apart for its splines has no acceleration: its noise is as good as
    # infinite, and the tiny number keeps it from being so.
    slope = slopes @ np.linalg.inv(change + 1e-14 * np.eye(splines.shape[2]))
    if len(place) > 1:
        noise = np.sum(slope**2, axis=(1, 2)) / span[:, 0] ** 2
        kept = noise <= _RAGGED * np.median(noise)
        index, span, place, smooth, slope = (one[kept] for one in (index, span, place, smooth, slope))
    fine = np.linalg.qr(_splines(place, min(_FINER * pieces, window - _DEGREE))[0])[0]
    base = fine @ np.linalg.svd(fine.swapaxes(1, 2) @ slope)[0]
    spin = ((base.swapaxes(1, 2) @ slope) ** 2).sum(axis=2).mean(axis=0) * float((span**-2).mean())
    weights = _products(smooth.swapaxes(1, 2), data["omega"][index])
    motion = {name: one[index].reshape(-1, 3) for name, one in data.items()}
    motion["omega"] = _products(smooth, weights).reshape(-1, 3)
    turn = (_products(slope, weights) / span[..., None]).reshape(-1, 3)
    rows = _features(motion, turn).reshape(*index.shape, -1)
    found = np.ascontiguousarray(_products(base.swapaxes(1, 2), rows).swapaxes(0, 1))
    some = motion["omega"].reshape(*index.shape, 3)[:: len(index) // _SOME + 1]
    turned = base[:: len(index) // _SOME + 1, :, None] * some[..., None]
    within = np.einsum("wjcm,wjk->wckm", turned, smooth[:: len(index) // _SOME + 1], optimize=True)
    product = (within**2).sum(axis=(0, 1, 2)) / np.maximum((turned**2).sum(axis=(0, 1, 2)), 1e-300)
    spin[smooth.shape[2] :] = 0.0  # but for rounding
    return found, np.stack([product, spin], axis=1), len(t) - int(index.size)


def _splines(place: Floats, pieces: int) -> tuple[Floats, Floats]:
    """Return B-splines on equal pieces of [0, 1] and their derivatives, shape (..., pieces + degree).

    By the recursion of Cox and de Boor.
    """
    u = place[..., None] * pieces - np.arange(-_DEGREE, pieces + _DEGREE)
    found = ((u >= 0.0) & (u < 1.0)).astype(float)
    found[..., pieces + _DEGREE - 1] += place == 1.0  # the end belongs to the last piece
    found[..., pieces + _DEGREE] = 0.0
    lower = found
    for p in range(1, _DEGREE + 1):
        lower, u = found, u[..., : found.shape[-1]]
        found = (u[..., :-1] * lower[..., :-1] + (p - u[..., 1:]) * lower[..., 1:]) / p
    return found, pieces * (lower[..., :-1] - lower[..., 1:])


def _regressor() -> Floats:
    """Return the derivatives of the six equations by features and parameters, shape (6, 13, 16)."""
    found = np.zeros((6, _FEATURES, 16))
    one = np.eye(3)
    for k in range(3):
        found[k, k, 0] = 1.0  # m a
        found[:3, 3 + k, 1:4] = np.cross(one[k], one).T  # ω̇ × mc
        found[3:, k, 1:4] = np.cross(one, one[k]).T  # mc × a
        found[3:, 3 + k, 4:10] = _BASIS[:, :, k].T  # I ω̇
        found[k, 12, 10 + k] = found[3 + k, 12, 13 + k] = 1.0
    for p, (i, j) in enumerate(ELEMENTS):
        products = np.zeros((3, 3))
        products[i, j] = products[j, i] = 1.0
        found[:3, 6 + p, 1:4] = products - np.trace(products) * one  # ω × (ω × mc)
        for q, tensor in enumerate(_BASIS):
            mixed = products @ tensor
            found[3:, 6 + p, 4 + q] = [
                mixed[1, 2] - mixed[2, 1],
                mixed[2, 0] - mixed[0, 2],
                mixed[0, 1] - mixed[1, 0],
            ]
    return found


_REGRESSOR: Final = _regressor()


def _to_numbers(theta: Floats) -> tuple[Floats, Floats]:
    """Return mass, centre and tensor about it for m, mc and I_O, and their derivatives, shape (10, 10)."""
    mass, center = theta[0], theta[1:4] / theta[0]
    slopes = np.zeros((10, 10))
    slopes[0, 0] = 1.0
    slopes[1:4, 0], slopes[1:4, 1:4] = -center / mass, np.eye(3) / mass
    square = float(center @ center)
    shift = np.array([mass * ((i == j) * square - center[i] * center[j]) for i, j in ELEMENTS])
    numbers = np.concatenate([[mass], center, theta[4:10] - shift])
    for row, (i, j) in enumerate(ELEMENTS):
        slopes[4 + row, 4 + row] = 1.0
        # I_C = I_O − (|mc|² 1 − mc mcᵀ)/m
        slopes[4 + row, 0] = (i == j) * square - center[i] * center[j]
        for k in range(3):
            slopes[4 + row, 1 + k] = -2.0 * (i == j) * center[k] + (i == k) * center[j] + (j == k) * center[i]
    return numbers, slopes


class _Fit:
    """Weights, the convex problem in their units, and the result."""

    def __init__(
        self,
        sums: _Sums,
        sigmas: Floats,
        spin_sigma: float,
        bias: bool,
        prior: RigidBody | None,
        student: bool,
    ) -> None:
        self.sums, self.given, self.spin_sigma = sums, sigmas, spin_sigma
        self.columns = np.arange(16 if bias else 10)
        self.prior, self.student = prior, student
        self.weights = np.ones(sums.features.shape[:2])
        self.rows = self.weights.size
        push, force, torque = (
            math.sqrt(float(np.sum(sums.triangles[..., part] ** 2)) / self.rows)
            for part in (slice(3), slice(13, 16), slice(16, 19))
        )
        if not min(force, torque, push) > 0.0:
            raise IdentificationError(
                "force, torque, specific_force: one of them is zero in all rows; no payload is there, ",
                "or the columns are not those of the sensor",
                kind="undetermined",
            )
        mass, radius = force / push, torque / force
        # Units of m, mc, I_O and of the offsets.
        self.mass, self.radius = mass, radius
        self.unit = np.repeat([mass, mass * radius, mass * radius**2, force, torque], [1, 3, 6, 3, 3])

    def solve(self, origin: Floats, dropped: dict[str, int], window: int | None) -> Identified:
        x = np.zeros(len(self.columns))
        sigmas = np.where(np.isnan(self.given), np.repeat([self.unit[10], self.unit[13]], 3), self.given)
        jacobian: Floats = np.zeros((0, 0))
        for trial in range(_PASSES):
            whiten = np.linalg.inv(np.linalg.cholesky(self.covariances(x, sigmas)))
            jacobian, target, rest = self.least_squares(whiten)
            self._check_rank(jacobian, target)
            before, x, gap, edge = x, *self.possible(jacobian, target, rest)
            old, sigmas = sigmas, self.levels(x, sigmas)
            if self.student:
                self.reweigh(x, whiten)
            change = np.abs(x - before).max(initial=0.0) + np.abs(sigmas / old - 1.0).max()
            settled = not np.isnan(self.given).any() and self.spin_sigma == 0.0 and not self.student
            if settled or (trial and change < 1e-9):
                break
        white = self.residuals(x, self.sums.features) @ whiten.swapaxes(1, 2)
        if self.student:
            self.weights = np.ones_like(self.weights)
            jacobian = self.least_squares(whiten)[0]
            jacobian = jacobian * math.sqrt((_NU + 6.0) / (_NU + 8.0))
        inverse: Floats = np.asarray(np.linalg.inv(jacobian), dtype=np.float64)
        return self._result(
            x, jacobian, inverse, white.reshape(-1, 6), gap, edge, sigmas, origin, dropped, window
        )

    def covariances(self, x: Floats, sigmas: Floats) -> Floats:
        """Return the covariances of the six equations of each group, (g, 6, 6): noise of wrench and ω."""
        by_features = np.einsum("efp,p->ef", _REGRESSOR[:, :, :10], x[:10] * self.unit[:10])
        turn, products = by_features[:, 3:6], np.zeros((6, 6))
        for u in self.sums.spins:
            slopes = np.array([u[i] * _ONE[j] + (i != j) * u[j] * _ONE[i] for i, j in ELEMENTS])
            slopes[:3] *= 2.0  # of squares
            by_spin = by_features[:, 6:12] @ slopes
            products += by_spin @ by_spin.T
        noise = self.spin_sigma**2
        product, spin = self.sums.shares.T[:, :, None, None]
        found: Floats = np.diag(sigmas**2) + noise * (product * products + spin * (turn @ turn.T))
        return found

    def least_squares(self, whiten: Floats) -> tuple[Floats, Floats, float]:
        """Return triangle, target and rest of the weighted problem, in scaled parameters, offsets first."""
        columns = len(self.columns)
        slopes = _REGRESSOR[:, :, self.columns] * self.unit[self.columns]
        slopes = np.tensordot(whiten, slopes, 1)  # of group, equation, feature and parameter
        triangles = self._triangles()
        lines = triangles[:, None, :, :_FEATURES] @ slopes
        sides = whiten @ triangles[:, :, _FEATURES:].swapaxes(1, 2)
        rows = np.concatenate([lines, sides[..., None]], axis=3)
        blocks = [_triangles(rows.reshape(1, -1, columns + 1))[0]]
        if self.prior is not None:
            blocks.append(self._prior_rows())
        stacked = np.vstack(blocks)
        order = np.roll(self.columns, len(self.columns) - 10)  # offsets first
        both: Floats = np.asarray(np.linalg.qr(stacked[:, np.append(order, len(order))], mode="r"))
        count = len(order)
        if len(both) < count + 1:
            both = np.pad(both, ((0, count + 1 - len(both)), (0, 0)))
        return both[:count, :count], both[:count, count], float(both[count, count] ** 2)

    def _triangles(self) -> Floats:
        if not self.student:
            return self.sums.triangles
        return _triangles(self.sums.features * np.sqrt(self.weights)[..., None])

    def _prior_rows(self) -> Floats:
        """Return the rows of what is known beforehand, to first order about it."""
        assert self.prior is not None
        body, unit = self.prior, self.unit[:10]
        mass, center = float(body.mass), body.center_of_mass
        about = body.inertia_about("origin")
        theta = np.concatenate([[mass], mass * center, [about[i, j] for i, j in ELEMENTS]])
        back = np.linalg.inv(_to_numbers(theta)[1]) / unit[:, None]
        covariance = back @ np.asarray(body.covariance) @ back.T
        # A number without a sigma is known to nine digits of its size.
        values, vectors = np.linalg.eigh(covariance + 1e-18 * np.eye(10))
        white = (vectors / np.sqrt(values)).T
        rows = np.zeros((10, len(self.columns) + 1))
        rows[:, :10], rows[:, -1] = white, white @ (theta / unit)
        return rows

    def possible(self, jacobian: Floats, target: Floats, rest: float) -> tuple[Floats, float, bool]:
        """Return the best possible parameters in the order m, mc, I_O, offsets."""
        extra = len(self.columns) - 10
        start = np.concatenate([[1.0], np.zeros(3), [2.0, 2.0, 2.0], np.zeros(3)])
        body, gap, edge = fit_possible(jacobian[extra:, extra:], target[extra:], _MAPS, start, rest)
        if not extra:
            return body, gap, edge
        upper = target[:extra] - jacobian[:extra, extra:] @ body
        return np.concatenate([body, np.linalg.solve(jacobian[:extra, :extra], upper)]), gap, edge

    def residuals(self, x: Floats, features: Floats) -> Floats:
        """Return measured minus predicted wrenches of groups, of rows or triangles, shape (g, n, 6)."""
        slopes = np.einsum("efp,p->fe", _REGRESSOR[:, :, self.columns], x * self.unit[self.columns])
        return np.asarray(features[..., _FEATURES:] - features[..., :_FEATURES] @ slopes)

    def levels(self, x: Floats, sigmas: Floats) -> Floats:
        """Return the sigmas, those that are unknown from the residuals."""
        unknown = np.isnan(self.given)
        if not unknown.any():
            return sigmas
        noise = np.diagonal(self.covariances(x, np.zeros(6)), axis1=1, axis2=2)
        # Where an acceleration has no noise the level is told best.
        quiet = self.sums.shares[:, 1] == 0.0
        squares = np.sum(self.residuals(x, self._triangles())[quiet] ** 2, axis=1)
        each = len(self.weights[0])
        total = np.maximum(squares - each * noise[quiet], 0.0).sum(axis=0)
        rows = int(quiet.sum()) * each
        total = total / max(rows * (1.0 - len(self.columns) / (6.0 * self.rows)), 1.0)
        # One level for the three components of a kind, and never below rounding.
        total = np.repeat([total[:3].mean(), total[3:].mean()], 3)
        least = (1e-13 * np.repeat([self.unit[10], self.unit[13]], 3)) ** 2
        return np.where(unknown, np.sqrt(np.maximum(total, least)), sigmas)

    def reweigh(self, x: Floats, whiten: Floats) -> None:
        """Set the weights of Student's distribution with six components."""
        white = self.residuals(x, self.sums.features) @ whiten.swapaxes(1, 2)
        self.weights = (_NU + 6.0) / (_NU + np.sum(white**2, axis=2))

    def _check_rank(self, jacobian: Floats, target: Floats) -> None:
        extra = len(self.columns) - 10
        remedy = "turn the payload about all axes, faster, and in several attitudes; or give a prior"
        inner = jacobian[extra:, extra:]
        found, lost = find_directions(inner, np.ones(10), NUMBERS, remedy)
        # An offset that is not determined lies in the part before.
        if lost or (extra and np.abs(np.diagonal(jacobian)[:extra]).min() <= 1e-11 * np.abs(jacobian).max()):
            some = np.asarray(np.linalg.lstsq(inner, target[extra:], rcond=1e-11)[0], dtype=np.float64)
            lost_ones = tuple(self._of_body(one, some) for one in found if not math.isfinite(one.relative))
            raise IdentificationError(
                "omega, specific_force: the motion leaves undetermined: ",
                "; ".join(one.words for one in lost_ones) or "offsets of the sensor",
                f"; {remedy}",
                kind="undetermined",
                observability=lost_ones,
            )

    def _of_body(self, direction: Direction, x: Floats) -> Direction:
        """Return a direction of m, mc and I_O as one of mass, centre and the tensor about it, at a body."""
        if not x[0] > 0.0:
            x = np.eye(10)[0]
        slopes = _to_numbers(x * self.unit[:10])[1]
        mass, radius = x[0] * self.mass, self.radius
        sizes = np.repeat([mass, radius, mass * radius**2], [1, 3, 6])
        changes = slopes @ (direction.parameters * self.unit[:10])
        return replace(direction, parameters=changes / np.linalg.norm(changes / sizes))

    def _result(
        self,
        x: Floats,
        jacobian: Floats,
        inverse: Floats,
        white: Floats,
        gap: float,
        edge: bool,
        sigmas: Floats,
        origin: Floats,
        dropped: dict[str, int],
        window: int | None,
    ) -> Identified:
        extra = len(self.columns) - 10
        spread = inverse[extra:]
        inner = spread @ spread.T
        numbers, slopes = _to_numbers(x[:10] * self.unit[:10])
        slopes = slopes * self.unit[:10]
        bound = slopes @ inner @ slopes.T
        if edge:
            kept = along_the_edge(inner, _MAPS, x[:10])
            spread = kept @ spread
        spread = slopes @ spread
        covariance = spread @ spread.T
        moment = float(np.sum(numbers[4:7])) / 3.0
        sizes = np.repeat([numbers[0], math.sqrt(moment / numbers[0]), moment], [1, 3, 6])
        remedy = "turn the payload about all axes, faster, and in several attitudes"
        by_numbers = jacobian[extra:, extra:] @ np.linalg.inv(slopes)
        observability, _ = find_directions(by_numbers, sizes, NUMBERS, remedy)
        estimated = np.isnan(self.given).any()
        chi2 = float(np.sum(white**2))
        freedom = white.size - len(self.columns) + (10 if self.prior is not None else 0)
        p_value = math.nan if estimated or self.student else p_value_of(chi2, freedom)
        if p_value < 1e-6:
            raise IdentificationError(
                f"force_sigma, torque_sigma: chi2 is {chi2:.6g} with {freedom} degrees of freedom; ",
                "noise of these sigmas does not explain the residuals; ",
                "leave the sigmas out to estimate them, or look for offsets (bias=True), the sign of the ",
                "wrench (of the sensor on the payload) and the frame of the accelerometer",
                kind="no fit",
            )
        numbers[1:4] -= origin
        body = RigidBody(mass=numbers[0], inertia=tensor_of(numbers[4:]), center_of_mass=numbers[1:4])
        body = body.with_covariance(covariance)
        offsets = None
        if extra:
            unit = self.unit[10:]
            own = (inverse @ inverse.T)[:extra, :extra] * np.outer(unit, unit)
            offsets = Uncertain(x[10:] * unit, covariance=0.5 * (own + own.T))
        noise = None
        if estimated:
            noise = Uncertain(sigmas, sigmas / math.sqrt(2.0 * 3.0 * self.rows))
        return Identified(
            body=body, parameters=NUMBERS, estimate=numbers, covariance=covariance, crlb=bound,
            residuals=white, chi2=chi2, degrees_of_freedom=freedom, p_value=p_value, noise=noise,
            bias=offsets, at_edge=edge, linear=not edge, gap=gap, observability=observability,
            scale_known=True, dropped=dropped, window=window,
            columns=tuple(f"{name} {axis}" for name in ("force", "torque") for axis in "xyz"),
        )  # fmt: skip
