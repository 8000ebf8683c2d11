"""Uncertain numbers: several as one object, and conversion from and to the package `uncertainties`."""

from __future__ import annotations

import math
import sys
from numbers import Real
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import short
from polhode._hints import check_kind, check_no_tensor
from polhode._optional import require
from polhode.errors import PolhodeError
from polhode.uncertainty.variables import of_forms

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode import RigidBody

__all__ = [
    "InertialParameters",
    "join",
    "to_ufloats",
    "ufloat_kinds",
    "ufloat_terms",
]


def join(values: Any) -> Any:
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
    >>> from polhode.uncertainty import join
    >>> edge = Uncertain(1.0, 0.01)
    >>> join([edge, 2.0, edge]).covariance.round(6)
    array([[0.0001, 0.    , 0.0001],
           [0.    , 0.    , 0.    ],
           [0.0001, 0.    , 0.0001]])
    >>> round(solids.box([edge, edge, 3.0], density=1.0).sigma.mass, 6)
    0.06
    """
    check_no_tensor(values)
    kinds = (_core.Uncertain, *ufloat_kinds())
    if not _holds(values, kinds):
        return None
    cells = np.array(_cells(values, kinds, ()), dtype=object)
    flat = cells.ravel().tolist()
    if not all(isinstance(cell, _Number) for cell in flat):
        raise ValueError("numbers with a sigma: rows of different lengths; give each as many numbers")
    value = np.array([cell.value for cell in flat]).reshape(cells.shape)
    return of_forms(value, [sorted(cell.terms.items()) for cell in flat])


class _Number:
    """A number with its change by one standard deviation of each variable; NumPy treats it as one object."""

    def __init__(self, value: Any, terms: dict[tuple[int, int], float]) -> None:
        self.value = float(value)
        self.terms = terms


def _holds(values: Any, kinds: tuple[type, ...]) -> bool:
    """Return whether an uncertain number is among the values; other objects are not touched."""
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
    """Return the same nest of lists with a `_Number` in place of each."""
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
        return _Number(theirs.nominal_value, ufloat_terms(theirs))
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


_WORDS: Final[dict[Any, tuple[int, int]]] = {}
"""The variable of this package for each variable of `uncertainties` that was met. These cannot be referred to
weakly, and one may come back in any later number, so they are kept."""
_MET: Final[dict[tuple[int, int], Any]] = {}
"""The inverse map: variables of `uncertainties` for those of this package."""


class InertialParameters(NamedTuple):
    """Inertial parameters of a body, as numbers of the package *uncertainties*.

    Attributes
    ----------
    mass : uncertainties.UFloat
    center_of_mass : numpy.ndarray of object, shape (3,)
    inertia : numpy.ndarray of object, shape (3, 3)
    """

    mass: Any
    center_of_mass: Any
    inertia: Any

    def __repr__(self) -> str:
        return short(self)


def ufloat_kinds() -> tuple[type, ...]:
    """Return the class of numbers of `uncertainties`, if the package is loaded."""
    module = sys.modules.get("uncertainties")
    return () if module is None else (module.UFloat,)


def ufloat_terms(number: Any) -> dict[tuple[int, int], float]:
    """Return the change of a number of `uncertainties` by one standard deviation of each variable of polhode.

    What depends on one variable there depends on one variable here, in all calls.
    """
    changes = {
        variable: float(slope * variable.std_dev)
        for variable, slope in number.derivatives.items()
        if slope * variable.std_dev != 0.0
    }
    for variable, change in changes.items():
        if not math.isfinite(change):
            raise PolhodeError(
                f"the standard deviations of a ufloat must be finite, got {variable.std_dev} in {number}"
            )
    return {_words(variable): change for variable, change in changes.items()}


def _words(variable: Any) -> tuple[int, int]:
    """Return the variable of polhode for a variable of `uncertainties`."""
    if variable not in _WORDS:
        high, low = _core.Uncertain(0.0, 1.0)._forms()[0][0][0]
        _WORDS[variable] = (high, low)
        _MET[high, low] = variable
    return _WORDS[variable]


def to_ufloats(body: RigidBody) -> InertialParameters:
    """Return the numbers of one body as numbers of the package *uncertainties*, with all their correlations.

    Parameters
    ----------
    body : RigidBody

    Returns
    -------
    InertialParameters
        Mass, centre of mass and tensor about the centre of mass. They are correlated with those numbers of
        *uncertainties* that the body was made of.

    Raises
    ------
    ModuleNotFoundError
        If the package is not installed; the message names the extra that installs it.
    ValueError
        For a stack.

    Examples
    --------
    >>> from uncertainties import ufloat  # doctest: +SKIP
    >>> from polhode import solids
    >>> from polhode.uncertainty import to_ufloats
    >>> mass = ufloat(5.0, 0.1)  # doctest: +SKIP
    >>> to_ufloats(solids.sphere(1.0, mass=mass)).mass - mass  # doctest: +SKIP
    0.0+/-0
    """
    check_kind(body, "body", "RigidBody")
    if body.shape != ():
        message = f"body: expected one body, got a stack of shape {body.shape}"
        raise ValueError(message)
    library = require("uncertainties", extra="uncertainty", purpose="to_ufloats")
    state = body._doubts()
    tangents = np.zeros((0, 10)) if state is None else state["tangents"]
    words = [] if state is None else [(high, low) for high, low in state["variables"].tolist()]
    variables = [_variable(pair, library.ufloat) for pair in words]

    def number(value: float, column: int) -> Any:
        terms = zip(variables, tangents[:, column].tolist(), strict=True)
        sum_of_terms = sum(
            (step / v.std_dev * (v - v.nominal_value) for v, step in terms if step != 0.0), 0.0
        )
        if isinstance(sum_of_terms, float):  # known exactly: of no variable
            return library.core.AffineScalarFunc(value, library.core.LinearCombination({}))
        return value + sum_of_terms

    center, tensor = body.center_of_mass.tolist(), body.inertia
    element = {(0, 0): 4, (1, 1): 5, (2, 2): 6, (0, 1): 7, (0, 2): 8, (1, 2): 9}
    rows = [[number(float(tensor[i, j]), element[min(i, j), max(i, j)]) for j in range(3)] for i in range(3)]
    return InertialParameters(
        number(body.mass, 0),
        np.array([number(c, 1 + k) for k, c in enumerate(center)], dtype=object),
        np.array(rows, dtype=object),
    )


def _variable(words: tuple[int, int], ufloat: Callable[[float, float], Any]) -> Any:
    """Return the variable of `uncertainties` for a variable of polhode."""
    if words not in _MET:
        variable = ufloat(0.0, 1.0)
        _MET[words] = variable
        _WORDS[variable] = words
    return _MET[words]
