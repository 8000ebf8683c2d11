"""Numbers that depend on variables, several on one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Form = list[tuple[tuple[int, int], float]]

__all__ = ["of_forms"]


def of_forms(values: NDArray[np.float64], forms: Sequence[Form]) -> _core.Uncertain:
    """Make one array of numbers that depend on variables, each by what one sigma of a variable does to it."""
    sigmas = np.array([np.sqrt(sum(step * step for _, step in form)) for form in forms])
    return _core.Uncertain._restored(values, sigmas.reshape(values.shape), None, None, list(forms), False)
