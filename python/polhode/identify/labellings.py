"""Labels of light-curve frequencies: which multiples of which two frequencies of a tumbling body they are."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._format import one_line
from polhode.errors import IdentificationError
from polhode.identify.results import p_value_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Pair = tuple[int, int]

__all__ = ["Labellings", "labellings"]

_LEAST: Final = 1e-3
"""Probability of a larger chi-square below which noise does not explain what is left."""
_REACH: Final = 6.0
"""Frequencies further from a multiple than so many sigmas are never labelled by it."""
_MOST_ORDER: Final = 6
_TOO_MANY: Final = 200_000
_MOST: Final = 12
"""Number of frequencies at most."""


@dataclass(frozen=True, eq=False, repr=False)
class Labellings:
    """All ways to explain measured frequencies as ``j f_φ + m f_ψ``, the likely ones first.

    Rows with a body come first, then those of small integers, then those of small chi-square. Each labelling
    has two rows: one for each mode.

    Attributes
    ----------
    f_phi : numpy.ndarray, shape (n,)
        ``1/P_φ`` in the long-axis convention: the mean frequency at which axis 1, of the least moment, goes
        round L. Kaasalainen (2001) uses it in both modes; it is the L-convention of Samarasinha and Mueller
        (2015).
    f_psi : numpy.ndarray, shape (n,)
        ``1/P_ψ``, the same in both conventions. In long-axis mode the body turns about its long axis with
        this frequency; in short-axis mode the long axis swings to and fro.
    j, m : numpy.ndarray of int, shape (n, k)
        The multiples, for each measured frequency, in the long-axis convention.
    mode : numpy.ndarray of str, shape (n,)
        ``"long-axis"`` or ``"short-axis"``.
    chi2 : numpy.ndarray, shape (n,)
        With k − 2 degrees of freedom.
    admissible : numpy.ndarray of bool, shape (n,)
        Whether the given body has this motion; without one, whether any body has.
    ratio_range : numpy.ndarray, shape (n, 2, 2)
        Least and greatest I₁/I₃, and least and greatest I₂/I₃, of bodies that have this motion. A bound is
        that of each ratio alone: not every pair within is possible. NaN where no body has it.
    """

    f_phi: Floats
    f_psi: Floats
    j: NDArray[np.int64]
    m: NDArray[np.int64]
    mode: NDArray[np.str_]
    chi2: Floats
    admissible: NDArray[np.bool_]
    ratio_range: Floats

    @property
    def f_phi_short(self) -> Floats:
        """f_φ in the short-axis convention: the mean frequency at which axis 3 goes round L, f_φ + f_ψ.

        It is the S-convention of Samarasinha and Mueller (2015).
        """
        return self.f_phi + self.f_psi

    @property
    def m_short(self) -> NDArray[np.int64]:
        """Multiples of f_ψ in the short-axis convention, m − j, shape (n, k); j is the same in both."""
        return self.m - self.j

    def __len__(self) -> int:
        return len(self.f_phi)

    def __repr__(self) -> str:
        told: dict[str, Any] = {"n": len(self), "admissible": int(self.admissible.sum())}
        if len(self):
            told |= {"f_phi": self.f_phi[0], "f_psi": self.f_psi[0], "mode": str(self.mode[0])}
            told["labels"] = [(int(a), int(b)) for a, b in zip(self.j[0], self.m[0], strict=True)]
        return one_line(self, told)


def labellings(
    frequencies: ArrayLike, sigma: ArrayLike, order: int = 2, moments: ArrayLike | None = None
) -> Labellings:
    """Find every pair of frequencies of a tumbling body that explains those of its light curve.

    The brightness of a tumbling body varies with the frequencies ``|j f_φ + m f_ψ|``. A light curve shows
    some of these and no labels. Two frequencies fit any two labels; each further one must fit as well.

    Parameters
    ----------
    frequencies : array_like, shape (k,)
        At least two that differ, in cycles per unit of time.
    sigma : float or array_like, shape (k,)
        Their standard deviations.
    order : int
        The greatest ``|j|`` and ``|m|``.
    moments : array_like, shape (3,), optional
        Principal moments of the body, if they are known, of any scale.

    Returns
    -------
    Labellings
        Those that noise explains: the probability of a larger chi-square is at least 0.001.

    Raises
    ------
    IdentificationError
        ``"no fit"`` if no labels of this order explain the frequencies; ``"undetermined"`` if sigmas are so
        large that any do.
    ValueError
        For numbers that are no frequencies, sigmas or moments.

    Notes
    -----
    A motion with ``r = f_φ/f_ψ`` exists in long-axis mode if ``(1 − x)(1 − x/y) ≥ 1/(1 + r)²`` with x = I₁/I₃
    and y = I₂/I₃, and in short-axis mode if ``(1/x − 1)(1/y − 1) ≥ 1/r²``. Some body has any r in long-axis
    mode, and any r > 1 in short-axis mode: P_ψ is longer than P_φ there.

    References
    ----------
    M. Kaasalainen, Astron. Astrophys. 376 (2001) 302. N. H. Samarasinha, B. E. A. Mueller, Icarus 248 (2015)
    347.

    Examples
    --------
    Apophis: the strongest period of its light curve is half of 30.56 h, and 27.38 h is there too:

    >>> from polhode import identify
    >>> found = identify.labellings((2 / 30.56, 1 / 27.38), sigma=2e-5, moments=(0.61, 0.965, 1.0))
    >>> own = (found.j == (2, 1)).all(axis=1) & (found.m == (-2, 0)).all(axis=1) & found.admissible
    >>> found.mode[own].tolist(), (1 / found.f_psi[own]).round(1).tolist()
    (['long-axis', 'short-axis'], [263.1, 263.1])
    """
    measured = np.asarray(frequencies, dtype=float)
    if measured.ndim != 1 or not 2 <= len(measured) <= _MOST:
        raise ValueError(f"frequencies: expected shape (k,) with k from 2 to {_MOST}, got {measured.shape}")
    if not ((measured > 1e-100) & (measured < 1e100)).all():
        raise ValueError(f"frequencies: expected positive finite numbers, got {frequencies!r}")
    spread = np.asarray(sigma, dtype=float)
    if spread.shape not in ((), measured.shape):
        raise ValueError(f"sigma: expected a number or shape {measured.shape}, got {spread.shape}")
    spread = np.broadcast_to(spread, measured.shape)
    if not ((spread > 1e-13 * measured) & (spread < measured)).all():
        raise ValueError(
            f"sigma: expected numbers from 1e-13 to 1 of the frequencies, got {sigma!r}; a period P with the "
            "sigma s has the frequency 1/P with the sigma s/P**2"
        )
    if isinstance(order, bool) or not isinstance(order, int | np.integer) or not 1 <= order <= _MOST_ORDER:
        raise ValueError(f"order: {order!r} is not a whole number from 1 to {_MOST_ORDER}")
    body = None if moments is None else _ratios(moments)
    rows = [
        (found, chi2, labels, mode)
        for labels, found, chi2 in _explain(measured, spread, int(order))
        for mode in ("long-axis", "short-axis")
    ]
    if not rows:
        raise IdentificationError(
            f"frequencies: no j f_phi + m f_psi with |j| and |m| up to {order} explain them within sigma",
            "; try a higher order, larger sigmas, or leave out the weakest frequency",
            kind="no fit",
        )
    able = np.array([_exists(found[0] / found[1], mode, body) for found, _, _, mode in rows])
    sizes = [sum(abs(j) + abs(m) for j, m in labels) for _, _, labels, _ in rows]
    best = sorted(range(len(rows)), key=lambda k: (not able[k], sizes[k], rows[k][1], rows[k][2], rows[k][3]))
    f_phi, f_psi = np.array([rows[k][0] for k in best]).T
    labels = np.array([rows[k][2] for k in best])
    modes = np.array([rows[k][3] for k in best])
    return Labellings(
        f_phi,
        f_psi,
        labels[..., 0],
        labels[..., 1],
        modes,
        np.array([rows[k][1] for k in best]),
        able[best],
        np.array([_range(a / b, str(mode)) for a, b, mode in zip(f_phi, f_psi, modes, strict=True)]),
    )


def _ratios(moments: ArrayLike) -> tuple[float, float]:
    """Return I₁/I₃ and I₂/I₃ of a body."""
    given = np.asarray(moments, dtype=float)
    if given.shape != (3,) or not (np.isfinite(given).all() and given.min() > 0.0):
        raise ValueError(f"moments: expected three positive numbers, got {moments!r}")
    least, middle, greatest = np.sort(given)
    if greatest > (least + middle) * (1.0 + 1e-12):
        raise ValueError(
            f"moments: {greatest} exceeds the sum of the others, {least + middle}: no body has these moments"
        )
    return float(least / greatest), float(middle / greatest)


def _exists(ratio: float, mode: str, body: tuple[float, float] | None) -> bool:
    """Tell whether a motion with f_φ/f_ψ exists: of a body with these ratios, or of any."""
    if body is None:
        return mode == "long-axis" or ratio > 1.0
    x, y = body
    if mode == "long-axis":
        return (1.0 - x) * (1.0 - x / y) >= (1.0 + ratio) ** -2
    return (1.0 / x - 1.0) * (1.0 / y - 1.0) >= ratio**-2


def _range(ratio: float, mode: str) -> Floats:
    """Return the extremes of x = I₁/I₃ and y = I₂/I₃ on x ≤ y ≤ 1 ≤ x + y where a motion exists.

    Both conditions hold more easily the smaller x is. The greatest x is on y = 1 (long axis) and on x = y
    (short axis). The least y is on the edge x + y = 1 of flat bodies, where the conditions are 2y − 1 ≥
    1/(1 + r)² and r ≥ 1.
    """
    if not _exists(ratio, mode, None):
        return np.full((2, 2), np.nan)
    least = 0.5 * (1.0 + (1.0 + ratio) ** -2) if mode == "long-axis" else 0.5
    return np.array([[0.0, ratio / (1.0 + ratio)], [least, 1.0]])


def _explain(
    measured: Floats, sigma: Floats, order: int
) -> list[tuple[tuple[Pair, ...], tuple[float, float], float]]:
    """Return labels of all frequencies, f_φ and f_ψ, and chi-square."""
    multiples = range(-order, order + 1)
    pairs = [pair for pair in itertools.product(multiples, multiples) if pair != (0, 0)]
    table = np.array(pairs, dtype=float)
    found: dict[tuple[Pair, ...], tuple[tuple[float, float], float] | None] = {}
    # Labels that determine both frequencies are independent: those of the first and of some other one.
    for other, a in itertools.product(range(1, len(measured)), range(len(pairs))):
        det = table[a, 0] * table[:, 1] - table[a, 1] * table[:, 0]
        seconds = np.flatnonzero(det)
        first, second = table[a], table[seconds]
        swapped = np.stack([second[:, 1], -second[:, 0], np.full(len(second), -first[1])], axis=1)
        inverse = np.empty((len(second), 2, 2))
        inverse[:, 0, 0], inverse[:, 1, 0], inverse[:, 0, 1] = swapped.T
        inverse[:, 1, 1] = first[0]
        inverse /= det[seconds, None, None]
        rates = inverse @ measured[[0, other]]
        spread = inverse * sigma[[0, other]]
        near = (rates > -_REACH * np.sqrt(np.sum(spread**2, axis=2))).all(axis=1)
        away = measured[:, None] - rates[near, None, :] @ table.T
        size = np.sqrt(sigma[:, None] ** 2 + np.sum((table @ spread[near]) ** 2, axis=2)[:, None, :])
        fits = np.abs(away) <= _REACH * size
        fits[:, [0, other]] = True
        for b, row in zip(seconds[near], fits, strict=True):
            if not row.any(axis=1).all():
                continue
            choices = [[pairs[k] for k in np.flatnonzero(one)] for one in row]
            choices[0], choices[other] = [pairs[a]], [pairs[b]]
            if len(found) + math.prod(map(len, choices)) > _TOO_MANY:
                raise IdentificationError(
                    f"sigma: so large that more than {_TOO_MANY} combinations of labels are to be tried",
                    "; give a smaller order, or the frequencies that are known best alone",
                    kind="undetermined",
                )
            for labels in itertools.product(*choices):
                if labels not in found:
                    found[labels] = _fit(np.array(labels), measured, sigma)
    return [(labels, *fit) for labels, fit in found.items() if fit is not None]


def _fit(
    labels: NDArray[np.int64], measured: Floats, sigma: Floats
) -> tuple[tuple[float, float], float] | None:
    """Return the best f_φ and f_ψ with their chi-square, or None where they explain nothing."""
    white = labels / sigma[:, None]
    rates = np.linalg.lstsq(white, measured / sigma, rcond=None)[0]
    if not (rates > 0.0).all():
        return None
    if len(measured) == 2:
        return (float(rates[0]), float(rates[1])), 0.0
    chi2 = float(np.sum((white @ rates - measured / sigma) ** 2))
    if p_value_of(chi2, len(measured) - 2) < _LEAST:
        return None
    return (float(rates[0]), float(rates[1])), chi2
