"""What the sources of an uncertain body do to its tensor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import RigidBody

    Floats = NDArray[np.float64]

__all__ = ["changes_in_principal_axes"]


def changes_in_principal_axes(body: RigidBody) -> list[Floats] | None:
    """Give W = Vᵀ δI V for one standard deviation of each variable, V the principal axes.

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
