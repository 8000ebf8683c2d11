"""Numbers as they are told: beside their standard deviations with two digits of sigma, and as limits."""

from __future__ import annotations

import math

__all__ = ["at_least", "at_most", "with_sigma"]

_DIGITS = 7
_ROUNDING = 1e-15
"""Of the value: a sigma below it is what rounding left of zero."""
_LARGE = 1e7
_SMALL = 1e-4


def with_sigma(value: float, sigma: float | None) -> str:
    """Write a number and its standard deviation: ``57.8 ± 1.2``.

    Parameters
    ----------
    value : float
    sigma : float or None
        Without one, or where it is zero, the number stands alone with seven digits.

    Examples
    --------
    >>> with_sigma(57.834, 1.2416)
    '57.8 ± 1.2'
    >>> with_sigma(42673.7, 2789.3)
    '42700 ± 2800'
    >>> with_sigma(-3.2e-9, 4.56e-11)
    '(-3.200 ± 0.046)e-09'
    """
    if not sigma or not math.isfinite(sigma) or not math.isfinite(value) or sigma < _ROUNDING * abs(value):
        return f"{value + 0.0:.{_DIGITS}g}"
    # The place of the last digit, after rounding: 0.0996 has the digits 10 of 0.100.
    last = int(f"{sigma:.1e}".partition("e")[2]) - 1
    largest = max(abs(value), sigma)
    if _SMALL <= largest < _LARGE:
        return f"{_rounded(value, last)} ± {_rounded(sigma, last)}"
    exponent = math.floor(math.log10(largest))
    scale = 10.0**exponent if abs(exponent) < 300 else 1.0
    if scale == 1.0:
        return f"{value:.3g} ± {sigma:.1e}"
    one, other = (_rounded(number / scale, last - exponent) for number in (value, sigma))
    return f"({one} ± {other})e{exponent:+03d}"


def _rounded(value: float, last: int) -> str:
    return f"{round(value, -last) + 0.0:.{max(-last, 0)}f}"


def at_least(number: float, digits: int = 3) -> str:
    """Write a positive number with so many digits, rounded up: what is told as enough is enough.

    Examples
    --------
    >>> at_least(0.12345)
    '0.124'
    """
    text = f"{number:.{digits}g}"
    if float(text) < number:
        unit = 10.0 ** (math.floor(math.log10(number)) - digits + 1)
        text = f"{number + unit:.{digits}g}"
    return text


def at_most(number: float, digits: int = 3) -> str:
    """Write a positive number with so many digits, rounded down: what is told as allowed is allowed.

    Examples
    --------
    >>> at_most(0.12367)
    '0.123'
    """
    text = f"{number:.{digits}g}"
    if float(text) > number:
        unit = 10.0 ** (math.floor(math.log10(number)) - digits + 1)
        text = f"{number - unit:.{digits}g}"
    return text
