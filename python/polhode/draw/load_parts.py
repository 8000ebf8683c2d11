"""The parts of a load that is a sum."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Recipe = tuple[str, tuple[Any, ...]]

__all__ = ["Part", "parts_of"]


@dataclass(frozen=True, eq=False)
class Part:
    """A part of the load on one body.

    Attributes
    ----------
    made_by : str
        The function of `polhode.loads` that made it.
    load : Load
        The part by itself.
    states : tuple of str
        What its states are called in those of the whole.
    """

    made_by: str
    load: _core.Load
    states: tuple[str, ...]
    _arguments: tuple[Any, ...]
    _picks: tuple[tuple[list[int], Any], ...]

    def number(self, position: int, axes: int = 0) -> NDArray[np.float64]:
        """Return an argument of that function, for this one of a stack.

        Parameters
        ----------
        position : int
            Which of them.
        axes : int
            How many it has for one body.
        """
        values = np.asarray(self._arguments[position], dtype=np.float64)
        own = values.shape[values.ndim - axes :]
        for shape, key in self._picks:
            rows = np.broadcast_to(values, (*shape, *own)).reshape(-1, *own)
            values = rows[np.arange(len(rows)).reshape(shape)[key]]
        return values

    def options(self, position: int) -> dict[str, Any]:
        """Return its keyword arguments, which are one of the arguments that it was made of."""
        return cast("dict[str, Any]", self._arguments[position])


def parts_of(load: _core.Load) -> list[Part]:
    """Return the parts of a load; none for a load with compiled parts, which pickle refuses too.

    Parameters
    ----------
    load : Load
        On one body.
    """
    try:
        _, (recipes,) = cast("tuple[Any, tuple[list[Recipe]]]", _core.Load.__reduce__(load))
    except TypeError:
        return []
    names = iter(load.states)
    parts: list[Part] = []
    for recipe in recipes:
        one = _core.Load._from_parts([recipe])
        made_by, arguments = recipe
        picks: list[tuple[list[int], Any]] = []
        while made_by.startswith("_"):  # what was done to it after it was made
            if made_by == "_picked":
                picks.insert(0, arguments[1:3])
            made_by, arguments = arguments[0]
        # The states of what a motor follows stand behind those of all parts.
        own = 1 if made_by == "wheel" else len(one.states)
        states = tuple(itertools.islice(names, own))
        parts.append(Part(made_by, one, states, arguments, tuple(picks)))
    return parts
