"""Distributions as values: what they hold, how members draw from them, and how they print."""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple, final

import numpy as np

from polhode import _core
from polhode._repr import one_line
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "Distribution",
    "Made",
    "Normal",
    "PerMember",
    "Refusal",
    "Samples",
    "Source",
    "Uniform",
    "UniformRotation",
    "given_name",
    "source",
]

MOST: Final = 2**64
"""Seeds are below this."""


class Source(NamedTuple):
    """Whose numbers are drawn: a seed, and a number that stands for an argument's name."""

    seed: int
    stream: int


def source(seed: int, name: str) -> Source:
    """Give the source of an argument's numbers.

    Parameters
    ----------
    seed : int
    name : str

    Returns
    -------
    Source
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer):
        raise TypeError(f"seed: expected an integer from 0 to 2**64 - 1, got {seed!r}")
    if not 0 <= seed < MOST:
        raise ValueError(f"seed: expected an integer from 0 to 2**64 - 1, got {seed}")
    digest = hashlib.blake2b(name.encode(), digest_size=8, person=b"polhode").digest()
    return Source(int(seed), int.from_bytes(digest, "little"))


class Distribution(ABC):
    """A distribution from which members draw; made by the functions of this module.

    Attributes
    ----------
    name : str or None
        Name in place of the argument's name: distributions of one name draw from the same numbers.
    """

    name: str | None

    def draw(self, n: int, *, seed: int, argument: str = "omega", first: int = 0) -> Any:
        """Draw the numbers that members of an ensemble with this seed get.

        Parameters
        ----------
        n : int
            How many members.
        seed : int
            As of the ensemble.
        argument : str
            Place of the distribution in the call of the ensemble; if the distribution has a `name`, that
            counts instead.
        first : int
            The first of the members.

        Returns
        -------
        numpy.ndarray, shape (n, ...)
            For :func:`per_member` a list.

        Examples
        --------
        >>> from polhode import distributions
        >>> spin = distributions.normal((0.0, 0.0, 1.0), sigma=0.1)
        >>> spin.draw(2, seed=1).round(3)
        array([[0.022, 0.162, 0.69 ],
               [0.046, 0.002, 1.024]])
        >>> spin.draw(1, seed=1, first=1).round(3)
        array([[0.046, 0.002, 1.024]])
        """
        for given, what in ((n, "n"), (first, "first")):
            if isinstance(given, bool) or not isinstance(given, int | np.integer) or given < 0:
                raise ValueError(f"{what}: expected a number of members, not negative, got {given!r}")
        name = argument if self.name is None else given_name(self.name)
        found = self.rows(source(seed, name), first, n)
        for one in found if isinstance(found, list) else ():
            if isinstance(one, Refusal):
                raise one.error
        return found

    @abstractmethod
    def rows(self, source: Source, first: int, count: int) -> Any:
        """Draw the numbers of `count` members from `first` on."""

    @property
    def most(self) -> int | None:
        """Largest number of members that can draw from it; None if there is no limit."""
        return None

    def check(self, n: int, place: str) -> None:
        """Raise an error if `n` members cannot be drawn."""
        if self.most is not None and n > self.most:
            raise ValueError(
                f"{place}: {n} members want a row each and the samples have {self.most}; "
                'give as many, or draw them order="with replacement"'
            )


def given_name(name: str) -> str:
    """Tell a name that was given from the place of an argument."""
    return f"name:{name}"


@final
@dataclass(frozen=True, eq=False, repr=False)
class Normal(Distribution):
    """A normal law, see :func:`normal`.

    Attributes
    ----------
    mean : numpy.ndarray
    sigma : numpy.ndarray or None
        Standard deviations of independent numbers.
    factor : numpy.ndarray
        Of the covariance, which is ``factor @ factor.T``; empty where there is `sigma`.
    name : str or None
    """

    mean: Floats
    sigma: Floats | None
    factor: Floats
    name: str | None = None

    def rows(self, source: Source, first: int, count: int) -> Floats:
        """Draw numbers of members, shape (count, ...)."""
        width = self.mean.size
        plain = _core.random_numbers("normal", *source, first, count, width)
        if self.sigma is not None:
            scaled = plain * self.sigma.ravel()
        else:
            # Product by product and sum by sum: a matrix product rounds differently on each machine.
            scaled = np.zeros((count, width))
            for step in range(width):
                scaled += plain[:, step, np.newaxis] * self.factor[:, step]
        found: Floats = (self.mean.ravel() + scaled).reshape(count, *self.mean.shape)
        return found

    def __repr__(self) -> str:
        spread = {"factor": self.factor} if self.sigma is None else {"sigma": self.sigma}
        return one_line(self, {"mean": self.mean, **spread} | _named(self))


@final
@dataclass(frozen=True, eq=False, repr=False)
class Uniform(Distribution):
    """A uniform law between bounds, see :func:`uniform`.

    Attributes
    ----------
    low, high : numpy.ndarray
    name : str or None
    """

    low: Floats
    high: Floats
    name: str | None = None

    def rows(self, source: Source, first: int, count: int) -> Floats:
        """Draw numbers of members, shape (count, ...)."""
        parts = _core.random_numbers("uniform", *source, first, count, self.low.size)
        found: Floats = self.low + (self.high - self.low) * parts.reshape(count, *self.low.shape)
        return found

    def __repr__(self) -> str:
        return one_line(self, {"low": self.low, "high": self.high} | _named(self))


@final
@dataclass(frozen=True, eq=False, repr=False)
class UniformRotation(Distribution):
    """Rotations drawn uniformly, see :func:`uniform_rotation`.

    Attributes
    ----------
    name : str or None
    """

    name: str | None = None

    def rows(self, source: Source, first: int, count: int) -> Floats:
        """Draw unit quaternions of members, shape (count, 4)."""
        found: Floats = _core.random_numbers("rotation", *source, first, count, 4)
        return found

    def __repr__(self) -> str:
        return one_line(self, _named(self))


@final
@dataclass(frozen=True, eq=False, repr=False)
class Samples(Distribution):
    """Rows of an array, see :func:`samples`.

    Attributes
    ----------
    values : numpy.ndarray
    order : str
    name : str or None
    """

    values: Floats
    order: Literal["as given", "shuffled", "with replacement"] = "as given"
    name: str | None = None

    def rows(self, source: Source, first: int, count: int) -> Floats:
        """Draw rows for members, shape (count, ...)."""
        size = len(self.values)
        if self.order == "with replacement":
            parts = _core.random_numbers("uniform", *source, first, count, 1)[:, 0]
            found: Floats = self.values[(parts * size).astype(np.int64)]
            return found
        self.check(first + count, "n")
        if self.order == "shuffled":
            return self.values[_shuffled(source, size)[first : first + count]]
        return self.values[first : first + count]

    @property
    def most(self) -> int | None:
        """The number of rows, where each is drawn once."""
        return None if self.order == "with replacement" else len(self.values)

    def __repr__(self) -> str:
        return one_line(self, {"values": self.values, "order": self.order} | _named(self))


@dataclass(frozen=True)
class Refusal:
    """What stands for the value of a member whose numbers are refused."""

    error: PolhodeError


@final
@dataclass(frozen=True, eq=False, repr=False)
class PerMember(Distribution):
    """What a function gives for each member, see :func:`per_member`.

    Attributes
    ----------
    function : callable
    name : str or None
    """

    function: Callable[[np.random.Generator], Any]
    name: str | None = None

    def rows(self, source: Source, first: int, count: int) -> list[Any]:
        """Call the function for members, each with a generator of its own."""
        key = np.array(source, dtype=np.uint64)
        found: list[Any] = []
        for member in range(first, first + count):
            rng = np.random.Generator(np.random.Philox(counter=_counter(member), key=key))
            try:
                found.append(self.function(rng))
            except PolhodeError as error:
                # Of this member alone: whoever asks for its value is told.
                found.append(Refusal(error))
            except Exception as error:
                error.add_note(f"raised by {_called(self.function)} for member {member}")
                raise
        return found

    def __repr__(self) -> str:
        return f"PerMember({_called(self.function)}{_and_name(self)})"


@final
@dataclass(frozen=True, eq=False, repr=False)
class Made:
    """What a function makes of values that are drawn, see :func:`made`.

    Attributes
    ----------
    function : callable
    args : tuple
    kwargs : dict
    """

    function: Callable[..., Any]
    args: tuple[Any, ...] = ()
    kwargs: dict[str, Any] = field(default_factory=dict)

    def parts(self) -> dict[str, Any]:
        """Give the arguments by position or name, names in the order of the alphabet."""
        return {str(place): part for place, part in enumerate(self.args)} | dict(sorted(self.kwargs.items()))

    def __repr__(self) -> str:
        words = [repr(part) for part in self.args]
        words += [f"{name}={part!r}" for name, part in self.kwargs.items()]
        return f"Made({', '.join([_called(self.function), *words])})"


@lru_cache(maxsize=4)
def _shuffled(source: Source, size: int) -> NDArray[np.int64]:
    words = _core.random_numbers("bits", *source, 0, size, 1)[:, 0]
    order: NDArray[np.int64] = np.argsort(words, kind="stable")
    return order


def _counter(member: int) -> NDArray[np.uint64]:
    """Give where a member's own generator begins; counters of the core end in 0."""
    return np.array([0, 0, member, 1], dtype=np.uint64)


def _called(function: Any) -> str:
    return str(getattr(function, "__qualname__", repr(function)))


def _named(distribution: Distribution) -> dict[str, Any]:
    return {} if distribution.name is None else {"name": distribution.name}


def _and_name(distribution: Distribution) -> str:
    return "" if distribution.name is None else f", name={distribution.name!r}"
