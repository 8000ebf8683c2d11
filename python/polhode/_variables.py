"""Numbers that depend on variables, several on one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import _core
from polhode._rows import rows_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    Form = list[tuple[tuple[int, int], float]]

__all__ = ["angles_of", "of_forms", "row_of"]


def of_forms(values: Any, forms: Sequence[Form]) -> _core.Uncertain:
    """Make one array of numbers, or of rotations with three small angles each, that depend on variables.

    A form says by how much one sigma of a variable changes a number or an angle.
    """
    sigmas = np.array([np.sqrt(sum(step * step for _, step in form)) for form in forms])
    shape = (*values.as_quat().shape[:-1], 3) if hasattr(values, "as_quat") else values.shape
    return _core.Uncertain._restored(values, sigmas.reshape(shape), None, None, list(forms), False)


def angles_of(attitude: _core.Uncertain, stack: tuple[int, ...], row: int) -> list[Form]:
    """Return the forms of the three small angles that a row of a stack has, of one rotation or of a stack."""
    forms, shape = attitude._forms(), np.shape(attitude.value.as_quat())[:-1]
    which = rows_of(shape, stack)[row]
    return forms[3 * which : 3 * which + 3]


def row_of(given: _core.Uncertain, row: int) -> _core.Uncertain:
    """Return one row of vectors with a sigma."""
    value = np.reshape(given.value, (-1, 3))[row]
    return of_forms(value, given._forms()[3 * row : 3 * row + 3])
