"""Uncertain numbers that stand in a list, beside others or alone, as one object."""

from __future__ import annotations

from numbers import Real
from typing import Any

import numpy as np

from polhode import _core
from polhode._variables import of_forms
from polhode.uncertainty import ufloats

__all__ = ["joined"]


def joined(values: Any) -> Any:
    """Join numbers, some of them uncertain, into one `Uncertain`; None if none is uncertain.

    An argument that may be uncertain also accepts such a list, and joins it in this way.

    Parameters
    ----------
    values : Uncertain, uncertainties.UFloat, or nested sequences of them
        Plain numbers and arrays are allowed too. An `Uncertain` that holds an array counts as the list of the
        rows of this array.

    Returns
    -------
    Uncertain or None
        The numbers with their correlations: each depends on the same sources as before.

    Raises
    ------
    TypeError
        For a rotation, a text or anything else that is not a number.
    ValueError
        For rows of different lengths, or a list that holds itself.

    Examples
    --------
    >>> from polhode import Uncertain, solids
    >>> from polhode.uncertainty import joined
    >>> edge = Uncertain(1.0, 0.01)
    >>> joined([edge, 2.0, edge]).covariance.round(6)
    array([[0.0001, 0.    , 0.0001],
           [0.    , 0.    , 0.    ],
           [0.0001, 0.    , 0.0001]])
    >>> round(solids.box([edge, edge, 3.0], density=1.0).sigma.mass, 6)
    0.06
    """
    kinds = (_core.Uncertain, *ufloats.kinds())
    if not _holds(values, kinds):
        return None
    cells = np.array(_cells(values, kinds, ()), dtype=object)
    flat = cells.ravel().tolist()
    if not all(isinstance(cell, _Number) for cell in flat):
        raise ValueError("numbers with a sigma: rows of different lengths; give each as many numbers")
    value = np.array([cell.value for cell in flat]).reshape(cells.shape)
    return of_forms(value, [sorted(cell.terms.items()) for cell in flat])


class _Number:
    """A number with its change by one standard deviation of each variable; to numpy an object, no list."""

    def __init__(self, value: Any, terms: dict[tuple[int, int], float]) -> None:
        self.value = float(value)
        self.terms = terms


def _holds(values: Any, kinds: tuple[type, ...]) -> bool:
    """Whether there is one: nothing is asked of other objects, which may call the package anew."""
    rest: list[Any] = [values]
    seen: dict[int, Any] = {}  # a list may hold itself
    while rest:
        one = rest.pop()
        if isinstance(one, kinds):
            return True
        if isinstance(one, np.ndarray) and one.dtype == object:
            one = one.ravel().tolist()
        if isinstance(one, list | tuple) and id(one) not in seen:
            seen[id(one)] = one
            rest.extend(one)
    return False


def _cells(values: Any, kinds: tuple[type, ...], above: tuple[int, ...]) -> Any:
    """Give the same nest of lists with a `_Number` in place of each."""
    if isinstance(values, _core.Uncertain):
        if hasattr(values.value, "as_quat"):
            raise TypeError(
                "a rotation with a sigma stands among numbers; give it alone, where a rotation is asked for"
            )
        numbers = np.ravel(values.value).tolist()
        cells = np.empty(len(numbers), dtype=object)
        cells[:] = [
            _Number(x, {(high, low): step for (high, low), step in form})
            for x, form in zip(numbers, values._forms(), strict=True)
        ]
        return cells.reshape(np.shape(values.value)).tolist()
    if isinstance(values, kinds):
        theirs: Any = values
        return _Number(theirs.nominal_value, ufloats.terms(theirs))
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list | tuple):
        if id(values) in above:
            raise ValueError("numbers with a sigma: a list holds itself")
        return [_cells(one, kinds, (*above, id(values))) for one in values]
    if isinstance(values, np.bool_):
        values = bool(values)  # 1 and 0, as where no number has a sigma
    if not isinstance(values, Real):
        message = f"numbers with a sigma: {values!r} among them is no number"
        raise TypeError(message)
    return _Number(values, {})
