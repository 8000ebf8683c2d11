"""The numbers among the arguments of a load, and the load with others in their place."""

from __future__ import annotations

import inspect
from dataclasses import fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Recipe = tuple[str, tuple[Any, ...]]
    Changed = Callable[[Floats], Recipe]

__all__ = ["known_states", "numbers", "recipes"]

HELD: Final = ("times", "t", "epoch", "target")
"""Arguments of loads that are not varied."""

AROUND: Final = ("_scheduled", "_with_epoch")
"""What is done to a part that was made."""


def recipes(load: _core.Load | None) -> list[Recipe]:
    """Give the functions that made the parts of a load with their arguments; of compiled ones nothing."""
    if load is None:
        return []
    try:
        _, (parts,) = cast("tuple[Any, tuple[list[Recipe]]]", load.__reduce__())
    except TypeError:
        return []
    return list(parts)


def known_states(load: _core.Load | None, made: list[Recipe]) -> set[str]:
    """Name the states that can be nothing else: the wheels whose speed is given."""
    names = iter(load.states if load is not None else ())
    plain = (_unwrapped(recipe)[1] for recipe in made)
    own = [(recipe, next(names, "")) for recipe in plain if recipe[0] in ("wheel", "slug")]
    return {name for (kind, given), name in own if kind == "wheel" and given[-1]["speed"] is not None}


def numbers(recipe: Recipe) -> Iterator[tuple[str, Floats, Changed]]:
    """Give the numbers among the arguments of a part by name, and the recipe with others in their place."""
    around, recipe = _unwrapped(recipe)
    if around:
        for name, values, changed in numbers(recipe):
            yield name, values, _wrapped(around, changed)
        return
    made_by, arguments = recipe
    function = getattr(_core, made_by, None)
    if function is None or made_by in ("callback", "torque_callback", "with_states"):
        return
    keywords = dict(arguments[-1]) if arguments and isinstance(arguments[-1], dict) else {}
    plain = arguments[:-1] if keywords else arguments
    named = dict(zip(inspect.signature(function).parameters, plain, strict=False)) | keywords
    for name, value in named.items():
        if isinstance(value, _core.Load):
            (inner,) = recipes(value)
            for deeper, values, changed in numbers(inner):
                yield deeper, values, _with_load(made_by, named, name, changed)
        elif is_dataclass(value):
            for deeper, values, placed in _fields_of(value):
                yield deeper, values, _with(made_by, named, name, placed)
        elif name not in HELD and isinstance(value, float | np.ndarray):
            yield name, np.array(value, dtype=float), _with(made_by, named, name, _plain)


def _unwrapped(recipe: Recipe) -> tuple[list[Recipe], Recipe]:
    """Give what was done to a part, the last first and without the part, and the part."""
    around: list[Recipe] = []
    while recipe[0] in AROUND:
        around.append((recipe[0], recipe[1][1:]))
        recipe = recipe[1][0]
    return around, recipe


def _wrapped(around: list[Recipe], changed: Changed) -> Changed:
    def placed(values: Floats) -> Recipe:
        recipe = changed(values)
        for name, arguments in reversed(around):
            recipe = name, (recipe, *arguments)
        return recipe

    return placed


def _fields_of(path: Any) -> Iterator[tuple[str, Floats, Callable[[Floats], Any]]]:
    """Give the numbers of an orbit or of a field along one by name, and how to put others in their place."""
    for field in fields(path):
        value = getattr(path, field.name)
        if is_dataclass(value):
            for deeper, values, placed in _fields_of(value):
                yield deeper, values, _within(path, field.name, placed)
        elif field.name not in HELD and value is not None:
            yield field.name, np.array(value, dtype=float), _within(path, field.name, _plain)


def _plain(values: Floats) -> Any:
    return values if values.ndim else float(values)


def _within(path: Any, name: str, placed: Callable[[Floats], Any]) -> Callable[[Floats], Any]:
    return lambda values: replace(path, **{name: placed(values)})


def _with(made_by: str, named: dict[str, Any], name: str, placed: Callable[[Floats], Any]) -> Changed:
    return lambda values: (made_by, (named | {name: placed(values)},))


def _with_load(made_by: str, named: dict[str, Any], name: str, changed: Changed) -> Changed:
    return lambda values: (made_by, (named | {name: _core.Load._from_parts([changed(values)])},))
