"""Rows that are a file or a shape: their bodies, made by the package's own readers and solids."""

from __future__ import annotations

import inspect
import math
from typing import TYPE_CHECKING, Any, Final

from polhode import laminae, rods, solids
from polhode._core import RigidBody
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

__all__ = ["shape_body"]

_SHAPES: Final = {name: getattr(room, name) for room in (solids, laminae, rods) for name in room.__all__}
_OF_FILES: Final = ("length_unit", "weld", "closure", "orient", "index_base")


def shape_body(
    kind: str,
    what: str,
    arguments: str,
    folder: Path,
    *,
    mass: float,
    density: float,
    made: dict[Any, RigidBody],
) -> RigidBody:
    """Make the body of a row.

    Parameters
    ----------
    kind : str
        ``"file"`` or ``"solid"``.
    what : str
        The name of the file or of the shape.
    arguments : str
        ``"radius=0.1 height=0.3"``: names and values; the numbers of an array are separated by commas.
    folder : pathlib.Path
        Where the name of a file starts from.
    mass, density : float
        One of them; the other is NaN.
    made : dict
        Bodies that have been made, so that a file is read once.

    Raises
    ------
    PolhodeError
        If there is no such shape, or it does not take these arguments.
    """
    options = _arguments(arguments)
    weight = {"mass": mass} if math.isnan(density) else {"density": density}
    key = (kind, what, arguments, *weight.items())
    if key not in made:
        if kind == "file":
            unknown = next((name for name in options if name not in _OF_FILES), None)
            if unknown is not None:
                raise PolhodeError(f"arguments: a file takes {', '.join(_OF_FILES)}, not {unknown!r}")
            made[key] = RigidBody.from_file(folder / what, **options, **weight)
        else:
            made[key] = _shape(what)(**_checked(what, options, weight))
    return made[key]


def _shape(name: str) -> Callable[..., RigidBody]:
    if name not in _SHAPES:
        raise PolhodeError(f"solid: there is no {name!r}; there are {', '.join(sorted(_SHAPES))}")
    shape: Callable[..., RigidBody] = _SHAPES[name]
    return shape


def _checked(name: str, options: dict[str, Any], weight: dict[str, float]) -> dict[str, Any]:
    """Refuse arguments that the shape does not take, by name."""
    try:
        inspect.signature(_shape(name)).bind(**options, **weight)
    except TypeError as error:
        raise PolhodeError(f"arguments: {name}: {error}; it takes {_taken(name)}") from None
    return options | weight


def _taken(name: str) -> str:
    return ", ".join(str(word) for word in inspect.signature(_shape(name)).parameters)


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
