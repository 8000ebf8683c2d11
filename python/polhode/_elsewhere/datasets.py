"""Axes of stacks by name, and datasets of arrays that are computed later."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._core import real_numbers
from polhode._elsewhere.kinds import check_real, dask_array, labelled
from polhode._extras import require

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

__all__ = ["Labels", "check_coordinates", "dataset", "one_chunk", "require_xarray"]

_OWN: Final = ("time", "component", "quaternion_component")
_FRAMES: Final = {"omega": "body", "position": "space", "velocity": "space"}


def require_xarray() -> Any:
    """Give the library whose datasets are the results."""
    return require("xarray", extra="cluster", purpose="a motion of dask arrays")


def one_chunk(array: Any, name: str, size: int) -> None:
    """Refuse an array whose last axis has other components, or has them in several chunks."""
    shape = np.shape(array)
    if shape[-1:] != (size,):
        dims = (
            f", axes {array.dims}; the components are to be the last" if labelled(array) is not None else ""
        )
        raise ValueError(f"{name}: expected shape (..., {size}), got {shape}{dims}")
    lazy = dask_array(array)
    if lazy is None:
        return
    check_real(lazy, name)
    count = len(lazy.chunks[-1])
    if count > 1:
        way = f"chunk({{{array.dims[-1]!r}: -1}})" if labelled(array) is not None else "rechunk({-1: -1})"
        raise ValueError(
            f"{name}: its {size} components lie in {count} chunks; put them in one: {name}.{way}"
        )


def check_coordinates(array: Any, tail: int, results: Collection[str]) -> None:
    """Refuse an array of which a coordinate would go along under a name of the result."""
    last = set(array.dims[array.ndim - tail :])
    own = {str(name) for name, one in array.coords.items() if not last & set(one.dims)}
    for name in sorted((own - {str(dim) for dim in array.dims}) & set(results)):
        raise ValueError(
            f"a coordinate is named {name!r}, as one of the result; leave it out with "
            f".drop_vars({name!r}), or rename it"
        )


class Labels:
    """Names for the axes of stacks: those of labelled arrays, or those of ``Trajectory.to_xarray``.

    Parameters
    ----------
    arrays : sequence of array_like
    tails : sequence of int
        How many axes of each are not of the stack.
    shapes : sequence of tuple of int
        Of what else is a stack.
    results : sequence of str
        What will be computed.
    """

    def __init__(
        self,
        arrays: Sequence[Any],
        tails: Sequence[int],
        shapes: Sequence[tuple[int, ...]],
        results: Sequence[str],
    ) -> None:
        named: list[str] = []
        for array, tail in zip(arrays, tails, strict=True):
            if labelled(array) is not None:
                own = [str(dim) for dim in array.dims[: array.ndim - tail]]
                named += [dim for dim in own if dim not in named]
                check_coordinates(array, tail, {*_OWN, *results})
        taken = sorted(set(named) & {*_OWN, *results})
        if taken:
            raise ValueError(f"an axis of the stack is named {taken[0]!r}, as one of the result; rename it")
        depth = max(
            [
                np.ndim(array) - tail
                for array, tail in zip(arrays, tails, strict=True)
                if labelled(array) is None
            ]
            + [len(shape) for shape in shapes]
        )
        if not named:
            named = ["body"] if depth == 1 else [f"body_{axis}" for axis in range(depth)]
        elif depth > len(named):
            raise ValueError(
                f"a stack of {depth} axes beside axes named {', '.join(named)}: give it names for its axes "
                "too, as an xarray.DataArray"
            )
        self.stack = named
        # Those along which everything has one row stay with whatever has them.
        self.ones = set(named)
        for array, tail in zip(arrays, tails, strict=True):
            stack = np.shape(array)[: np.ndim(array) - tail]
            own = (
                array.dims[: len(stack)] if labelled(array) is not None else named[len(named) - len(stack) :]
            )
            self.ones -= {str(dim) for dim, size in zip(own, stack, strict=True) if size != 1}
        for shape in shapes:
            own = named[len(named) - len(shape) :]
            self.ones -= {dim for dim, size in zip(own, shape, strict=True) if size != 1}
        self.cuts: dict[str, tuple[int, ...]] = {}
        self.sizes: dict[str, tuple[int, str]] = {}
        self.indexes: dict[str, tuple[Any, str]] = {}

    def named(self, array: Any, name: str) -> Any:
        """Give an array with names; that of its last axis is the argument's own."""
        xarray = require_xarray()
        if labelled(array) is not None:
            found = array.rename({array.dims[-1]: f"{name} in"}).drop_vars([f"{name} in"], errors="ignore")
        else:
            if dask_array(array) is None:
                array = real_numbers(array, name)
            dims = self.stack[len(self.stack) + 1 - array.ndim :]
            # An axis of one goes along with all.
            kept = [
                axis for axis, size in enumerate(array.shape[:-1]) if size != 1 or dims[axis] in self.ones
            ]
            picked = array[tuple(slice(None) if axis in kept else 0 for axis in range(len(dims)))]
            found = xarray.DataArray(picked, dims=[*(dims[axis] for axis in kept), f"{name} in"])
        for dim, size in zip(found.dims[:-1], found.shape[:-1], strict=True):
            known = self.sizes.setdefault(str(dim), (size, name))
            if known[0] != size:
                raise ValueError(
                    f"{known[1]} and {name}: their axis {dim!r} has {known[0]} and {size} rows; give "
                    "both the same, or one"
                )
        for dim, index in found.indexes.items():
            first = self.indexes.setdefault(str(dim), (index, name))
            if not first[0].equals(index):
                raise ValueError(
                    f"{first[1]} and {name}: their coordinates of the axis {dim!r} are not the same; make "
                    f"them so, such as with xarray.align, or leave one out: {name}.drop_vars({dim!r})"
                )
        self.cuts |= {str(dim): cuts for dim, cuts in found.chunksizes.items()}
        return found

    def chunked(self, numbers: Any, shape: tuple[int, ...], name: str) -> Any:
        """Give the numbers of a stack, an array of dask where it is more than one."""
        da = require("dask.array", extra="cluster", purpose="a motion of dask arrays")
        found = self.named(numbers, name)
        if not shape:
            return found
        chunks = tuple(self.cuts.get(str(dim), -1) for dim in found.dims)
        return found.copy(data=da.from_array(found.data, chunks=chunks))

    def rows(self) -> Any:
        """Count the rows along the first axis of the stack."""
        da = require("dask.array", extra="cluster", purpose="a motion of dask arrays")
        if not self.stack:
            return self.named(np.zeros(1), "row")
        first, xarray = self.stack[0], require_xarray()
        numbers = da.arange(self.sizes.get(first, (1, ""))[0], chunks=self.cuts.get(first, -1))
        return xarray.DataArray(numbers[:, None], dims=[first, "row in"])


def dataset(found: Mapping[str, Any], stack: Sequence[str], coordinates: Mapping[str, Any]) -> Any:
    """Gather the arrays of a run as ``Trajectory.to_xarray`` does."""
    xarray = require_xarray()
    variables = {}
    for place, array in found.items():
        name = place.removeprefix("states.")
        if name == "quaternion":
            axis, told = "quaternion_component", {"long_name": "R_NB, scalar last"}
        elif name in _FRAMES:
            axis, told = "component", {"frame": _FRAMES[name]}
        else:
            axis, told = f"{name}_component", {"long_name": "of the load"}
        if name == "status":
            told = {"long_name": "how the run ended"}
        core = [dim for dim in array.dims if dim not in stack and not str(dim).endswith(" ")]
        last = [dim for dim in array.dims if str(dim).endswith(" ")]
        variables[name] = (
            array.transpose(*(dim for dim in stack if dim in array.dims), *core, *last)
            .rename(dict.fromkeys(last, axis))
            .assign_attrs(told)
        )
    letters = {"component": list("xyz"), "quaternion_component": list("xyzw")}
    return xarray.Dataset(variables).assign_coords({**coordinates, **letters})
