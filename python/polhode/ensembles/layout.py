"""The arrays of an ensemble: their names, axes and sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from polhode.ensembles.plan import Plan

__all__ = ["Variable", "bytes_of_member", "coordinates", "layout"]

_VECTOR: Final = ("axis", "xyz")
_AXES: Final = {
    "omega": (_VECTOR, {"frame": "body"}),
    "quaternion": (("quaternion_component", "xyzw"), {"long_name": "R_NB, scalar last"}),
    "position": (_VECTOR, {"frame": "space"}),
    "velocity": (_VECTOR, {"frame": "space"}),
}


class Variable(NamedTuple):
    """An array with an axis for the members in front."""

    dims: tuple[str, ...]
    tail: tuple[int, ...]
    dtype: str
    attributes: dict[str, str]


def layout(plan: Plan) -> dict[str, Variable]:
    """Give the arrays that a chunk has, by name; the status comes last.

    Parameters
    ----------
    plan : Plan

    Returns
    -------
    dict of str to Variable
    """
    found = {}
    for name, size in plan.outputs.items():
        (axis, _), told = _AXES.get(
            name, ((f"{short_name(name)}_component", ""), {"long_name": "of the load"})
        )
        found[short_name(name)] = Variable(("member", "time", axis), (len(plan.t), size), "<f8", told)
    for place, array in plan.inputs(0, 1).arrays().items():
        tail = array.shape[1:]
        dims = ("member", *(f"{short_name(place)}_{axis}" for axis in range(len(tail))))
        found[short_name(place)] = Variable(dims, tail, "<f8", {"long_name": f"drawn for {place}"})
    told = {"long_name": "how the member ended; empty: not yet run"}
    return found | {"status": Variable(("member",), (), "<U8", told)}


def coordinates(plan: Plan) -> dict[str, tuple[str, Any]]:
    """Give the coordinates of the axes."""
    found: dict[str, tuple[str, Any]] = {"time": ("time", plan.t)}
    for name in plan.outputs:
        if name in _AXES:
            (axis, letters), _ = _AXES[name]
            found[axis] = (axis, np.array(list(letters)))
    return found


def short_name(name: str) -> str:
    """Give the name of a state of the load without its place."""
    return name.removeprefix("states.")


def bytes_of_member(plan: Plan) -> int:
    """Give the size of all that is kept of a member."""
    return sum(
        np.dtype(variable.dtype).itemsize * int(np.prod(variable.tail)) for variable in layout(plan).values()
    )
