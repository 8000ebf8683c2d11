"""Roots of polynomials with many digits."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from typing import Any

import mpmath

__all__ = ["roots"]


def roots(falling: Sequence[Any], **options: Any) -> list[Any]:
    """Compute all roots of a polynomial from its coefficients, that of the highest power first.

    mpmath 1.4 takes them in the other order, and warns where it is not told so.
    """
    if "asc" in inspect.signature(mpmath.polyroots).parameters:
        options["asc"], falling = True, list(falling)[::-1]
    found: list[Any] = mpmath.polyroots(list(falling), **options)
    return found
