"""Independent oracles of the test suite.

Nothing here imports polhode. Exact rational arithmetic where the answer is rational, arbitrary
precision where it is not: a test that compares with one of these can state an error in units of the
last place without asking whose error it is.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np

__all__ = ["Exact", "dot", "errors", "rational", "ulp_errors", "worst_error"]

Exact: TypeAlias = Any
"""A `Fraction`, or nested lists of them shaped as the array they stand for."""


def rational(values: Any) -> Exact:
    """The exact values of floats: nested lists of `Fraction`, shaped as the input."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list | tuple):
        return [rational(v) for v in values]
    return Fraction(values)


def dot(a: Exact, b: Exact) -> Fraction:
    """Scalar product of two exact vectors."""
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def _flat(values: Exact) -> list[Fraction]:
    if isinstance(values, list):
        return [x for v in values for x in _flat(v)]
    return [values]


def errors(computed: Any, exact: Exact) -> list[Fraction]:
    """Exact absolute errors of floats, flattened."""
    got, want = _flat(rational(np.asarray(computed, dtype=float))), _flat(exact)
    return [abs(g - w) for g, w in zip(got, want, strict=True)]


def worst_error(computed: Any, exact: Exact, scale: Fraction | float | None = None) -> float:
    """Largest error relative to `scale`, by default to the largest exact entry."""
    if scale is None:
        scale = max(abs(w) for w in _flat(exact))
    worst = max(errors(computed, exact))
    return float(worst / Fraction(scale)) if worst else 0.0


def ulp_errors(computed: Any, exact: Exact) -> list[float]:
    """Each component's error in units in the last place of the exact value rounded to float64."""
    units = (Fraction(math.ulp(float(w))) for w in _flat(exact))
    return [float(e / u) for e, u in zip(errors(computed, exact), units, strict=True)]
