"""Arguments with the source of every number that is drawn, and what members make of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from polhode._draws import Distribution, Made, PerMember, Refusal, Source, given_name, source

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    import numpy as np
    from numpy.typing import NDArray

    Rows = NDArray[np.intp]

__all__ = ["Draw", "Make", "Node", "draws", "resolved", "value"]


@dataclass(frozen=True)
class Draw:
    """A distribution, where it stands first in the call, and whose numbers it draws."""

    distribution: Distribution
    place: str
    source: Source


@dataclass(frozen=True)
class Make:
    """A function of arguments, some of which are drawn."""

    function: Callable[..., Any]
    args: tuple[Node, ...]
    kwargs: tuple[tuple[str, Node], ...]


Node: TypeAlias = Draw | Make | Any
"""What is neither drawn nor made is the same for all members."""


def resolved(arguments: Mapping[str, Any], seed: int) -> dict[str, Node]:
    """Give every distribution among the arguments its source.

    Parameters
    ----------
    arguments : mapping of str to object
        By the names of the places, in the order of the signature.
    seed : int

    Returns
    -------
    dict
    """
    seen: dict[int, Node] = {}
    return {place: _resolved(argument, place, seed, seen) for place, argument in arguments.items()}


def _resolved(argument: Any, place: str, seed: int, seen: dict[int, Node]) -> Node:
    """Resolve one; what was met before keeps the sources of its first place."""
    if not isinstance(argument, Distribution | Made):
        return argument
    if id(argument) in seen:
        return seen[id(argument)]
    node: Node
    if isinstance(argument, Distribution):
        name = place if argument.name is None else given_name(argument.name)
        node = Draw(argument, place, source(seed, name))
    else:
        for name in argument.kwargs:
            if not name.isidentifier():
                raise ValueError(f"{place}: {name!r} is no name of an argument")
        parts = {key: _resolved(part, f"{place}.{key}", seed, seen) for key, part in argument.parts().items()}
        args = tuple(parts[str(index)] for index in range(len(argument.args)))
        node = Make(argument.function, args, tuple((name, parts[name]) for name in sorted(argument.kwargs)))
    seen[id(argument)] = node
    return node


def draws(node: Node) -> Iterator[Draw]:
    """Go through the distributions of an argument."""
    if isinstance(node, Draw):
        yield node
    elif isinstance(node, Make):
        for part in (*node.args, *(part for _, part in node.kwargs)):
            yield from draws(part)


def value(node: Node, drawn: Mapping[str, Any], rows: Rows) -> Any:
    """Give an argument of members.

    Parameters
    ----------
    node : Draw, Make or object
    drawn : mapping of str to array or list
        What a chunk of members has drawn, by the places.
    rows : numpy.ndarray of int
        Which members of the chunk.

    Returns
    -------
    object
        With a first axis for the members, or a list of one for each, where anything is drawn.
    """
    if isinstance(node, Draw):
        found = drawn[node.place]
        if not isinstance(node.distribution, PerMember):
            return found[rows]
        values = [found[row] for row in rows]
        for one in values:
            if isinstance(one, Refusal):
                raise type(one.error)(*one.error.args)
        return values
    if isinstance(node, Make):
        args = [value(part, drawn, rows) for part in node.args]
        kwargs = {name: value(part, drawn, rows) for name, part in node.kwargs}
        return node.function(*args, **kwargs)
    return node
