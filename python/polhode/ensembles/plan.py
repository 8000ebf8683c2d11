"""The plan of an ensemble: its arguments as recipes, its chunks, and the layout of its results."""

from __future__ import annotations

from contextlib import contextmanager
from copy import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias

import numpy as np

from polhode import _core
from polhode.distributions import (
    Distribution,
    FunctionOfDraws,
    PerMember,
    Refusal,
    Source,
    given_name,
    source,
)
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray

    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]
    Rows = NDArray[np.intp]

__all__ = [
    "VECTORS",
    "Draw",
    "Inputs",
    "Make",
    "Node",
    "Plan",
    "Variable",
    "bytes_of_member",
    "coordinates",
    "draws",
    "layout",
    "resolve_draws",
    "value",
]

VECTORS: Final = {"omega": 3, "attitude": 4, "position": 3, "velocity": 3}
"""Arguments that are one vector for each member, and their components."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Members 0 to n - 1 and the times at which their states are asked for."""

    recipe: dict[str, Node]
    """Body, load and the state at the start; of states of the load its names as ``states.NAME``."""
    t: Floats
    options: dict[str, Any]
    """Options of `simulate`."""
    n: int
    seed: int
    chunk: int
    outputs: dict[str, int]
    """Arrays of the trajectory in the results, with the number of their components."""
    raises: bool
    """Whether a member that fails ends the ensemble."""

    @property
    def chunks(self) -> int:
        """The number of chunks."""
        return -(-self.n // self.chunk)

    def bounds(self, index: int) -> tuple[int, int]:
        """Return the first member of a chunk and how many it has."""
        first = index * self.chunk
        return first, min(self.chunk, self.n - first)

    def draws(self) -> dict[str, Draw]:
        """Return the distributions by the name of their argument; a shared one under the first name."""
        return {draw.place: draw for node in self.recipe.values() for draw in draws(node)}

    def inputs(self, first: int, count: int) -> Inputs:
        """Draw the numbers of members."""
        drawn = {}
        for place, draw in self.draws().items():
            with _told_place(place):
                drawn[place] = draw.distribution.rows(draw.source, first, count)
        return Inputs(self, first, count, drawn)


@dataclass(frozen=True, eq=False)
class Inputs:
    """The random numbers of some members."""

    plan: Plan
    first: int
    count: int
    drawn: dict[str, Any]

    def arrays(self) -> dict[str, Floats]:
        """Return the numbers by their places, without those that are kept as the states at the start."""
        kept = self.plan.outputs
        return {
            place: array
            for place, array in self.drawn.items()
            if isinstance(array, np.ndarray)
            and place not in kept
            and not (place == "attitude" and "quaternion" in kept)
        }

    def starts(self, place: str) -> Iterator[tuple[int, Floats]]:
        """Iterate over the drawn states at the start."""
        for row, one in enumerate(self.drawn.get(place, ())):
            one = one.as_quat() if hasattr(one, "as_quat") else one
            if not isinstance(one, Refusal) and np.shape(one) == (
                self.plan.outputs.get(place, VECTORS.get(place)),
            ):
                yield row, np.asarray(one, dtype=float)

    def make_arguments(self, rows: Rows) -> dict[str, Any]:
        """Return the arguments of `simulate` for members, the body among them.

        Parameters
        ----------
        rows : numpy.ndarray of int
            Which of these members.

        Returns
        -------
        dict
            A load that is made for each member by itself is a list.
        """
        found: dict[str, Any] = {"states": {}}
        for place, node in self.plan.recipe.items():
            with _told_place(place):
                one = value(node, self.drawn, rows)
            if place in VECTORS and one is not None:
                one = _vectors(one, place, VECTORS[place], len(rows))
            elif place == "body":
                one = _bodies(one, len(rows))
            elif place == "load":
                one = _loads(one, len(rows))
            if place.startswith("states."):
                found["states"][place.removeprefix("states.")] = _states(one, place)
            else:
                found[place] = one
        found["states"] = found["states"] or None
        return found

    def run(self, rows: Rows, t: Floats, progress: Any = None) -> Trajectory:
        """Run members; a failure of one does not stop the others."""
        arguments = (
            self.make_arguments(rows) | self.plan.options | {"on_failure": "keep", "progress": progress}
        )
        if isinstance(arguments["load"], list):
            (arguments["load"],) = arguments["load"]
        body: _core.RigidBody = arguments.pop("body")
        return body.simulate(t, **arguments)


def is_each_alone(plan: Plan) -> bool:
    """Return whether the loads of the members cannot be put into one stack."""
    return any(
        isinstance(draw.distribution, PerMember) and draw.place == "load" for draw in plan.draws().values()
    )


@contextmanager
def _told_place(place: str) -> Iterator[None]:
    """Say of errors that a function of the user's raises which argument it stands for."""
    try:
        yield
    except PolhodeError:
        raise
    except Exception as error:
        error.add_note(f"in the argument {place!r} of the ensemble")
        raise


def _vectors(given: Any, place: str, size: int, count: int) -> Floats:
    if isinstance(given, list):  # of a function that is called for each member
        given = [one.as_quat() if hasattr(one, "as_quat") else one for one in given]
        for one in given:
            if np.shape(one) != (size,):
                raise ValueError(
                    f"{place}: expected {size} numbers for each member, and the function gave {one!r} for one"
                )
    elif hasattr(given, "as_quat"):
        given = given.as_quat()
    array = _core.real_numbers(given, place)
    if array.shape not in ((size,), (count, size)):
        raise ValueError(
            f"{place}: expected {size} numbers for each member, got an array of shape {array.shape} "
            f"for {count} of them"
        )
    return np.ascontiguousarray(np.broadcast_to(array, (count, size)))


def _bodies(given: Any, count: int) -> _core.RigidBody:
    if isinstance(given, list):
        for one in given:
            _check_kind(one, _core.RigidBody, "body")
        given = _core.RigidBody.stack(given)
    _check_kind(given, _core.RigidBody, "body")
    _check_shape(given.shape, count, "body")
    found: _core.RigidBody = given
    return found


def _loads(given: Any, count: int) -> Any:
    if given is None:
        return None
    if isinstance(given, list):
        for one in given:
            _check_kind(one, _core.Load, "load")
            _check_shape(one.shape, 1, "load")
        return given
    _check_kind(given, _core.Load, "load")
    _check_shape(given.shape, count, "load")
    return given


def _states(given: Any, place: str) -> Floats:
    array = np.asarray(given, dtype=float)
    if not np.isfinite(array).all():
        raise PolhodeError(f"{place}: must be finite, got {array[~np.isfinite(array)][0]}")
    return array


def _check_kind(given: Any, kind: type, place: str) -> None:
    if not isinstance(given, kind):
        raise TypeError(f"{place}: expected a {kind.__name__} for each member, got {type(given).__name__}")


def _check_shape(shape: tuple[int, ...], count: int, place: str) -> None:
    if shape not in ((), (count,)):
        raise ValueError(
            f"{place}: expected one for each of {count} members or one for all, got a stack of shape {shape}"
        )


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
"""A value without distributions is the same for all members."""


def resolve_draws(arguments: Mapping[str, Any], seed: int) -> dict[str, Node]:
    """Assign every distribution among the arguments its source of random numbers.

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
    return {place: _resolve(argument, place, seed, seen) for place, argument in arguments.items()}


def _resolve(argument: Any, place: str, seed: int, seen: dict[int, Node]) -> Node:
    """Resolve one argument; a distribution that occurs twice keeps the source of its first place."""
    if not isinstance(argument, Distribution | FunctionOfDraws):
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
        parts = {key: _resolve(part, f"{place}.{key}", seed, seen) for key, part in argument.parts().items()}
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
    """Return an argument of members.

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
                raise copy(one.error)
        return values
    if isinstance(node, Make):
        args = [value(part, drawn, rows) for part in node.args]
        kwargs = {name: value(part, drawn, rows) for name, part in node.kwargs}
        return node.function(*args, **kwargs)
    return node


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
    """Return the arrays that a chunk has, by name; the status comes last.

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
    """Return the coordinates of the axes."""
    found: dict[str, tuple[str, Any]] = {"time": ("time", plan.t)}
    for name in plan.outputs:
        if name in _AXES:
            (axis, letters), _ = _AXES[name]
            found[axis] = (axis, np.array(list(letters)))
    return found


def short_name(name: str) -> str:
    """Return the name of a state of the load without its place."""
    return name.removeprefix("states.")


def bytes_of_member(plan: Plan) -> int:
    """Return the number of bytes of the results of a member."""
    return sum(
        np.dtype(variable.dtype).itemsize * int(np.prod(variable.tail)) for variable in layout(plan).values()
    )
