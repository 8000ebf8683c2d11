"""Numbers that members of an ensemble draw, as they are typed: ``"1.00 ± 0.01, 2.0"``, ``"0 to 1, 2"``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from polhode import Uncertain, distributions
from polhode._quantities import amounts, has_unit, quantities
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from polhode.distributions import Distribution

    Drawn: TypeAlias = NDArray[np.float64] | Distribution

__all__ = ["drawn", "drawn_number", "middle_of"]

_TO: Final = re.compile(r"\s+to\s+")


def drawn(texts: Sequence[str], count: int, unit: str, option: str) -> Drawn:
    """Read numbers that are the same for all members, or their distribution.

    Parameters
    ----------
    texts : sequence of str
        As `amounts` takes them; or with commas between them, some as ``"0.9 to 1.1"``.
    count, unit, option : int, str, str
        As of `amounts`.

    Returns
    -------
    numpy.ndarray or Distribution
        Normal where a number has a sigma, uniform where one has bounds.

    Raises
    ------
    PolhodeError
        For what is neither, or both.
    """
    text = " ".join(texts)
    if _TO.search(text):
        return _uniform(text, count, unit, option)
    given = amounts(texts, count, unit, option)
    means = np.array([one.value if isinstance(one, Uncertain) else one for one in given], dtype=float)
    if not any(isinstance(one, Uncertain) for one in given):
        return means
    sigmas = [one.sigma if isinstance(one, Uncertain) else 0.0 for one in given]
    return distributions.normal(means, sigma=np.array(sigmas, dtype=float))


def drawn_number(text: str, unit: str, option: str) -> Any:
    """Read one number, or its distribution; see `drawn`."""
    found: Any = drawn([text], 1, unit, option)
    if isinstance(found, distributions.Normal):
        return distributions.normal(found.mean.item(), sigma=np.asarray(found.sigma).item())
    if isinstance(found, distributions.Uniform):
        return distributions.uniform(found.low.item(), found.high.item())
    return float(found[0])


def middle_of(numbers: Any) -> Any:
    """Give the numbers themselves, or what their distribution is about."""
    if isinstance(numbers, distributions.Normal):
        return numbers.mean
    if isinstance(numbers, distributions.Uniform):
        return 0.5 * numbers.low + 0.5 * numbers.high
    return numbers


def _uniform(text: str, count: int, unit: str, option: str) -> Distribution:
    if re.search(r"±|\+/-|\+-|\d\(", text):
        raise PolhodeError(
            f"{option}: {text!r} has a sigma and bounds, but all numbers of an option are normal or all are "
            "uniform; write sigmas for all that are drawn, or bounds for all"
        )
    bounds = [_bounds(part) for part in text.strip().strip(",").split(",")]
    if any(len(pair) != 2 for pair in bounds) or len(bounds) != count:
        raise PolhodeError(
            f"{option}: expected {count} number{'s'[: count - 1]} with commas between, each alone or with "
            f"bounds as in '0.9 to 1.1', got {text!r}"
        )
    low, high = (quantities([", ".join(side)], count, unit, option) for side in zip(*bounds, strict=True))
    wrong = next(((a, b) for a, b in zip(low, high, strict=True) if a > b), None)
    if wrong is not None:
        raise PolhodeError(
            f"{option}: the lower bound must not exceed the upper one, got {wrong[0]:g} to {wrong[1]:g} "
            f"{unit}; write the smaller one first"
        )
    try:
        return distributions.uniform(low, high)
    except ValueError as error:
        raise PolhodeError(f"{option}: {error}; write bounds that are closer") from None


def _bounds(part: str) -> list[str]:
    """Split a number's bounds, the lower one with the unit of the upper one where it has none itself."""
    words = [word.strip() for word in _TO.split(part.strip())]
    if len(words) == 1:
        return words * 2
    if len(words) == 2 and has_unit(words[1]) and not has_unit(words[0]):
        number = re.match(r"\S+", words[1])
        behind = words[1][number.end() if number else 0 :]
        words[0] += behind
    return words
