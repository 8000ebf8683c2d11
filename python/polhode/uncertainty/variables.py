"""Numbers as functions of the variables (source, place) of their uncertainty."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from numpy.typing import NDArray

    from polhode import RigidBody

    Form = list[tuple[tuple[int, int], float]]
    Floats = NDArray[np.float64]

__all__ = [
    "angles_of",
    "changes_in_principal_axes",
    "of_forms",
    "row_of",
    "rows_of",
]


def rows_of(shape: tuple[int, ...], stack: tuple[int, ...]) -> list[int]:
    """For each row of a broadcast stack: return the index of its source row."""
    rows = np.arange(np.prod(shape, dtype=int)).reshape(shape)
    taken: list[int] = np.broadcast_to(rows, stack).ravel().tolist()
    return taken


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


def changes_in_principal_axes(body: RigidBody) -> list[Floats] | None:
    """Return W = Vᵀ δI V for one standard deviation of each variable, V the principal axes.

    Returns
    -------
    list of numpy.ndarray, shape (k, 3, 3), or None
        One for each body of a stack in C order, of as many variables as it depends on; None where nothing is
        uncertain.
    """
    state = body._doubts()
    if state is None:
        return None
    xx, yy, zz, xy, xz, yz = state["tangents"][:, 4:].T
    changes = np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), -1, 0)
    ends = np.cumsum(state["counts"])
    parts = np.split(changes, ends[:-1]) if ends.size else []
    axes = body.principal.axes.reshape(-1, 3, 3)
    return [own.T @ part @ own for own, part in zip(axes, parts, strict=True)]
