"""Rows that are a file or a shape: their bodies, made by the package's own readers and solids."""

from __future__ import annotations

import inspect
import math
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from polhode import laminae, rods, solids
from polhode._core import RigidBody
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.uncertainty._table import Table

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

__all__ = ["shape_rows"]

_SHAPES: Final = {name: getattr(room, name) for room in (solids, laminae, rods) for name in room.__all__}


def shape_rows(
    table: Table, values: Floats, sigma: Floats, leaves: Integers, where: Callable[[int], str]
) -> set[int]:
    """Fill in the values of rows that are a file or a shape.

    Parameters
    ----------
    table : Table
    values, sigma : numpy.ndarray
        The ten numbers and their standard deviations, shape (10, n); filled in place.
    leaves : numpy.ndarray
        Rows without children.
    where : callable
        Names a row in errors.

    Returns
    -------
    set of int
        These rows.
    """
    if not any(name in table for name in ("file", "solid", "arguments", "density", "sigma_density")):
        return set()
    words = {name: table.words(name) for name in ("file", "solid", "arguments")}
    densities = table.numbers("density"), table.numbers("sigma_density")
    made: dict[Any, RigidBody] = {}
    rows = set()
    for row in leaves.tolist():
        density, of_density = (float(cells[row]) for cells in densities)
        kinds = [name for name in ("file", "solid") if words[name][row]]
        is_by_mass, is_by_density = (not math.isnan(value) for value in (values[0, row], density))
        try:
            if not kinds:
                if words["arguments"][row] or is_by_density or not math.isnan(of_density):
                    raise PolhodeError("density and arguments are of a file or a solid; name one")
                continue
            if len(kinds) == 2 or is_by_mass == is_by_density:
                raise PolhodeError("give a file or a solid, and its mass or its density: one of each")
            if not np.isnan(values[4:, row]).all():
                raise PolhodeError(
                    f"a tensor is stated beside the {kinds[0]} that it follows from; leave one out"
                )
            if is_by_mass and not math.isnan(of_density):
                raise PolhodeError("sigma_density is stated, but no density; state sigma_mass")
            if is_by_density and sigma[0, row] != 0.0:
                raise PolhodeError("sigma_mass is stated beside a density; state sigma_density")
            weight = {"density": density} if is_by_density else {"mass": float(values[0, row])}
            what, arguments = words[kinds[0]][row], words["arguments"][row]
            key = (kinds[0], what, arguments, *weight.items())
            if key not in made:  # a file that is there often is read once
                options = _arguments(arguments)
                make = _of_file(table.folder / what) if kinds[0] == "file" else _shape(what)
                made[key] = _called(make, what, options, weight)
        except (ValueError, OSError) as error:
            kind = type(error) if isinstance(error, PolhodeError) else PolhodeError
            raise kind(f"{where(row)}: {error}") from error
        body = made[key]
        tensor = body.inertia
        center = np.where(np.isnan(values[1:4, row]), body.center_of_mass, values[1:4, row])
        values[:, row] = [body.mass, *center, *np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2]]
        if is_by_density and not math.isnan(of_density):
            sigma[0, row] = body.mass * of_density / density
        rows.add(row)
    return rows


def _of_file(path: Path) -> Callable[..., RigidBody]:
    def make(
        *,
        length_unit: str | None = None,
        weld: float = 0.0,
        closure: Literal["caps", "hull"] | None = None,
        orient: bool = False,
        index_base: Literal[0, 1] = 1,
        mass: float | None = None,
        density: float | None = None,
    ) -> RigidBody:
        return RigidBody.from_file(
            path,
            mass=mass,
            density=density,
            length_unit=length_unit,
            weld=weld,
            closure=closure,
            orient=orient,
            index_base=index_base,
        )

    return make


def _shape(name: str) -> Callable[..., RigidBody]:
    if name not in _SHAPES:
        raise PolhodeError(f"solid: there is no {name!r}; there are {', '.join(sorted(_SHAPES))}")
    shape: Callable[..., RigidBody] = _SHAPES[name]
    return shape


def _called(
    make: Callable[..., RigidBody], what: str, options: dict[str, Any], weight: dict[str, float]
) -> RigidBody:
    """Make a body; arguments that it does not take are refused by name."""
    signature = inspect.signature(make)
    try:
        signature.bind(**options, **weight)
    except TypeError as error:
        taken = ", ".join(name for name in signature.parameters if name not in ("mass", "density"))
        raise PolhodeError(f"arguments: {what}: {error}; it takes {taken}") from None
    try:
        return make(**options, **weight)
    except TypeError as error:  # a word where a number should be
        raise PolhodeError(f"arguments: {what}: {error}") from None


def _arguments(text: str) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for word in text.replace(";", " ").split():
        name, equals, value = word.partition("=")
        if not (name.isidentifier() and equals and value):
            raise PolhodeError(f"arguments: {word!r} is not name=value; write, say, radius=0.1 size=1,2,3")
        if name in options:
            raise PolhodeError(f"arguments: {name!r} is there twice")
        options[name] = _value(value)
    return options


def _value(text: str) -> Any:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    try:
        numbers = tuple(int(word) if word.isdecimal() else float(word) for word in text.split(","))
    except ValueError:
        return text
    return numbers if len(numbers) > 1 else numbers[0]
