"""Distributions for ensembles: random numbers, rotations and samples, and bodies and loads made of them.

The numbers of a member depend only on the seed, on the name of the argument and on the number of the member.
They do not depend on how many members there are, or how these are divided into chunks. The name is the place
of the distribution in the call (``"omega"``, ``"body.1"``, ``"load.position"``), unless `name` gives another.
Distributions at two places draw independent numbers. If one object stands at two places, both places get the
same numbers; the same is true for two distributions with the same `name`.

The random bits come from the generator Philox4x64-10. They are transformed by code of this package, so that
no release of another library changes the numbers. Only those of :func:`per_member` come from NumPy's
generator.
"""

from __future__ import annotations

import hashlib
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple, final

import numpy as np

from polhode import _core
from polhode._format import Argument, one_line
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "Distribution",
    "FunctionOfDraws",
    "Normal",
    "PerMember",
    "Samples",
    "Uniform",
    "UniformRotation",
    "apply",
    "normal",
    "per_member",
    "samples",
    "uniform",
    "uniform_rotation",
]


def normal(
    mean: ArrayLike,
    covariance: ArrayLike | None = None,
    *,
    sigma: ArrayLike | None = None,
    name: str | None = None,
) -> Normal:
    """Draw normally distributed numbers.

    Parameters
    ----------
    mean : array_like
        Means of the k numbers, of any shape.
    covariance : array_like, shape (k, k), optional
        Covariance of the numbers in the order of the flattened mean; it may be singular.
    sigma : array_like, optional
        In place of `covariance`: standard deviations of independent numbers, of a shape that broadcasts to
        that of `mean`.
    name : str, optional
        Name in place of the argument's name; see the top of this page.

    Returns
    -------
    Normal

    Raises
    ------
    PolhodeError
        For a matrix that is no covariance, with its least eigenvalue.

    Notes
    -----
    The inverse of the normal distribution is computed by Wichura's algorithm AS 241 from 64 random bits. The
    largest numbers are 9.1 standard deviations from the mean.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import distributions
    >>> drawn = distributions.normal((1.0, 2.0), [[0.04, 0.03], [0.03, 0.09]]).draw(100_000, seed=5)
    >>> np.cov(drawn.T).round(2)
    array([[0.04, 0.03],
           [0.03, 0.09]])
    """
    middle = _freeze_finite(mean, "mean")
    if (covariance is None) == (sigma is None):
        raise TypeError("normal: give either covariance or sigma")
    _check_name(name)
    if sigma is not None:
        widths = _freeze_finite(sigma, "sigma")
        if (widths < 0.0).any():
            raise ValueError(f"sigma: expected numbers that are zero or more, got {widths.min():.6g}")
        return Normal(middle, _broadcast(widths, middle.shape, "sigma"), _freeze(np.zeros((0, 0))), name)
    matrix = _freeze_finite(covariance, "covariance")
    if matrix.shape != (middle.size, middle.size):
        size = middle.size
        raise ValueError(
            f"covariance: expected shape ({size}, {size}) for a mean of {size} numbers, got {matrix.shape}"
        )
    try:
        factor = _core.covariance_factor(matrix)
    except PolhodeError as error:
        least = np.linalg.eigvalsh(matrix)[0]
        if least >= 0.0:
            raise
        raise PolhodeError(f"{error}; the least eigenvalue of the matrix is {least:.3g}") from None
    if not np.count_nonzero(matrix - np.diag(np.diagonal(matrix))):
        factor = np.zeros((0, 0))
        return Normal(
            middle, _freeze(np.sqrt(np.diagonal(matrix)).reshape(middle.shape)), _freeze(factor), name
        )
    return Normal(middle, None, _freeze(factor), name)


def uniform(low: ArrayLike, high: ArrayLike, *, name: str | None = None) -> Uniform:
    """Draw independent numbers, uniformly distributed between bounds.

    Parameters
    ----------
    low, high : array_like
        Limits, of shapes that broadcast.
    name : str, optional
        Name in place of the argument's name; see the top of this page.

    Returns
    -------
    Uniform

    Examples
    --------
    >>> from polhode import distributions
    >>> distributions.uniform(2.0, 3.0).draw(3, seed=1).round(3)
    array([2.414, 2.323, 2.658])
    """
    _check_name(name)
    below, above = _freeze_finite(low, "low"), _freeze_finite(high, "high")
    try:
        shape = np.broadcast_shapes(below.shape, above.shape)
    except ValueError:
        raise ValueError(f"low, high: shapes {below.shape} and {above.shape} do not broadcast") from None
    below, above = _broadcast(below, shape, "low"), _broadcast(above, shape, "high")
    wrong = below > above
    if wrong.any():
        first = np.argmax(wrong)
        raise ValueError(f"low must not exceed high, got {below.flat[first]:.6g} and {above.flat[first]:.6g}")
    with np.errstate(over="ignore"):
        if not np.isfinite(above - below).all():
            raise ValueError("low, high: their difference leaves the range of float64")
    return Uniform(below, above, name)


def uniform_rotation(*, name: str | None = None) -> UniformRotation:
    """Draw uniformly distributed attitudes, as unit quaternions (x, y, z, w).

    Parameters
    ----------
    name : str, optional
        Name in place of the argument's name; see the top of this page.

    Returns
    -------
    UniformRotation

    Examples
    --------
    >>> from polhode import distributions
    >>> distributions.uniform_rotation().draw(1, seed=1).shape
    (1, 4)
    """
    _check_name(name)
    return UniformRotation(name)


def samples(
    values: ArrayLike,
    order: Literal["as given", "shuffled", "with replacement"] = "as given",
    *,
    name: str | None = None,
) -> Samples:
    """Draw the rows of an array.

    Parameters
    ----------
    values : array_like, shape (rows, ...)
    order : {"as given", "shuffled", "with replacement"}
        ``"as given"``: member k takes row k. ``"shuffled"``: each row is taken once, in random order. ``"with
        replacement"``: each member takes a random row.
    name : str, optional
        Name in place of the argument's name; see the top of this page.

    Returns
    -------
    Samples

    Examples
    --------
    >>> from polhode import distributions
    >>> distributions.samples([1.0, 2.0, 4.0], "shuffled").draw(3, seed=2)
    array([2., 1., 4.])
    """
    _check_name(name)
    rows = _freeze_finite(values, "values")
    if not rows.ndim or not len(rows):
        raise ValueError(f"values: expected shape (rows, ...) with one row at least, got {rows.shape}")
    if order not in ("as given", "shuffled", "with replacement"):
        raise ValueError(f'order: expected "as given", "shuffled" or "with replacement", got {order!r}')
    return Samples(rows, order, name)


def per_member(function: Callable[[np.random.Generator], Any], *, name: str | None = None) -> PerMember:
    """Call a function for each member, with a generator of its own.

    It serves for values that no other distribution gives. It is slow, since Python is called for every
    member. A function in place of an argument of an ensemble is treated as if it stood in a `per_member`.

    Parameters
    ----------
    function : callable
        ``function(rng)`` gives the member's value; `rng` is a :class:`numpy.random.Generator` on
        :class:`numpy.random.Philox`, whose key is the seed and the argument's name and whose counter begins
        with the member.
    name : str, optional
        Name in place of the argument's name; see the top of this page.

    Returns
    -------
    PerMember

    Examples
    --------
    >>> from polhode import distributions
    >>> distributions.per_member(lambda rng: rng.integers(6) + 1).draw(4, seed=3)  # doctest: +SKIP
    [3, 1, 6, 2]
    """
    _check_name(name)
    if not callable(function):
        raise TypeError(f"function: expected a function of a generator, got {type(function).__name__}")
    return PerMember(function, name)


def apply(function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> FunctionOfDraws:
    """Apply a function to distributions: make bodies or loads of drawn numbers.

    The function is called once for all members of a chunk.

    Parameters
    ----------
    function : callable
        Function that takes stacks along a first axis and returns a stack, as the constructors of bodies and
        loads do.
    *args, **kwargs
        Its arguments. Distributions among them are drawn, as arrays of shape (members, ...); all others
        are passed on.

    Returns
    -------
    FunctionOfDraws

    Examples
    --------
    >>> from polhode import RigidBody, distributions
    >>> distributions.apply(RigidBody.from_principal, 1.0, distributions.normal((1, 2, 2.5), sigma=0.01))
    FunctionOfDraws(RigidBody.from_principal, 1.0, Normal(mean=[1.0, 2.0, 2.5], sigma=[0.01, 0.01, 0.01]))
    """
    if not callable(function):
        raise TypeError(f"function: expected a function that makes bodies or loads, got {function!r}")
    return FunctionOfDraws(
        function, tuple(map(_own, args)), {name: _own(part) for name, part in kwargs.items()}
    )


def _own(part: Any) -> Any:
    """Return an argument; an array is copied and made read-only."""
    if not isinstance(part, np.ndarray):
        return part
    copy = part.copy()
    copy.setflags(write=False)
    return copy


def _freeze_finite(value: Any, name: str) -> Floats:
    """Return a read-only array of finite numbers."""
    array = _core.real_numbers(value, name)
    wrong = ~np.isfinite(array)
    if wrong.any():
        raise ValueError(f"{name} must be finite, got {array[wrong][0]}")
    return _freeze(array)


def _freeze(array: Floats) -> Floats:
    array = np.array(array, dtype=np.float64)
    array.setflags(write=False)
    return array


def _broadcast(array: Floats, shape: tuple[int, ...], name: str) -> Floats:
    try:
        return _freeze(np.broadcast_to(array, shape))
    except ValueError:
        raise ValueError(f"{name}: shape {array.shape} does not broadcast to {shape}") from None


def _check_name(name: object) -> None:
    if name is not None and not (isinstance(name, str) and name):
        raise TypeError(f"name: expected a word, got {name!r}")


MOST: Final = 2**64
"""Seeds are below this."""


class Source(NamedTuple):
    """A stream of random numbers: the seed, and a number computed from the name of the argument."""

    seed: int
    stream: int


def source(seed: int, name: str) -> Source:
    """Return the source of an argument's numbers.

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
        raise PolhodeError(Argument("seed"), f": expected an integer from 0 to 2**64 - 1, got {seed}")
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
        """Draw the numbers of the members of an ensemble with this seed.

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
    def rows(self, source: Source, first: int, n: int) -> Any:
        """Draw the numbers of `n` members from `first` on."""

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
    """Describe a name that was given from the place of an argument."""
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

    def rows(self, source: Source, first: int, n: int) -> Floats:
        """Draw numbers of members, shape (n, ...)."""
        width = self.mean.size
        plain = _core.random_numbers("normal", *source, first, n, width)
        if self.sigma is not None:
            scaled = plain * self.sigma.ravel()
        else:
            # Product by product and sum by sum: a matrix product rounds differently on each machine.
            scaled = np.zeros((n, width))
            for step in range(width):
                scaled += plain[:, step, np.newaxis] * self.factor[:, step]
        found: Floats = (self.mean.ravel() + scaled).reshape(n, *self.mean.shape)
        return found

    def __repr__(self) -> str:
        spread = {"factor": self.factor} if self.sigma is None else {"sigma": self.sigma}
        return one_line(self, {"mean": self.mean, **spread} | _name_argument(self))


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

    def rows(self, source: Source, first: int, n: int) -> Floats:
        """Draw numbers of members, shape (n, ...)."""
        parts = _core.random_numbers("uniform", *source, first, n, self.low.size)
        found: Floats = self.low + (self.high - self.low) * parts.reshape(n, *self.low.shape)
        return found

    def __repr__(self) -> str:
        return one_line(self, {"low": self.low, "high": self.high} | _name_argument(self))


@final
@dataclass(frozen=True, eq=False, repr=False)
class UniformRotation(Distribution):
    """Rotations drawn uniformly, see :func:`uniform_rotation`.

    Attributes
    ----------
    name : str or None
    """

    name: str | None = None

    def rows(self, source: Source, first: int, n: int) -> Floats:
        """Draw unit quaternions of members, shape (n, 4)."""
        found: Floats = _core.random_numbers("rotation", *source, first, n, 4)
        return found

    def __repr__(self) -> str:
        return one_line(self, _name_argument(self))


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

    def rows(self, source: Source, first: int, n: int) -> Floats:
        """Draw rows for members, shape (n, ...)."""
        size = len(self.values)
        if self.order == "with replacement":
            parts = _core.random_numbers("uniform", *source, first, n, 1)[:, 0]
            found: Floats = self.values[(parts * size).astype(np.int64)]
            return found
        self.check(first + n, "n")
        if self.order == "shuffled":
            return self.values[_shuffle(source, size)[first : first + n]]
        return self.values[first : first + n]

    @property
    def most(self) -> int | None:
        """The number of rows, where each is drawn once."""
        return None if self.order == "with replacement" else len(self.values)

    def __repr__(self) -> str:
        return one_line(self, {"values": self.values, "order": self.order} | _name_argument(self))


@dataclass(frozen=True)
class Refusal:
    """Placeholder for the value of a member whose numbers are refused."""

    error: PolhodeError


@final
@dataclass(frozen=True, eq=False, repr=False)
class PerMember(Distribution):
    """Values of a function that is called for each member, see :func:`per_member`.

    Attributes
    ----------
    function : callable
    name : str or None
    """

    function: Callable[[np.random.Generator], Any]
    name: str | None = None

    def rows(self, source: Source, first: int, n: int) -> list[Any]:
        """Call the function for members, each with a generator of its own."""
        key = np.array(source, dtype=np.uint64)
        found: list[Any] = []
        for member in range(first, first + n):
            rng = np.random.Generator(np.random.Philox(counter=_counter(member), key=key))
            try:
                found.append(self.function(rng))
            except PolhodeError as error:
                # Of this member alone: whoever asks for its value is told.
                found.append(Refusal(error))
            except Exception as error:
                error.add_note(f"raised by {_function_name(self.function)} for member {member}")
                raise
        return found

    def __repr__(self) -> str:
        return f"PerMember({_function_name(self.function)}{_and_name(self)})"


@final
@dataclass(frozen=True, eq=False, repr=False)
class FunctionOfDraws:
    """A function of random numbers, see :func:`apply`.

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
        """Return the arguments by position or name, names in the order of the alphabet."""
        return {str(place): part for place, part in enumerate(self.args)} | dict(sorted(self.kwargs.items()))

    def __repr__(self) -> str:
        words = [repr(part) for part in self.args]
        words += [f"{name}={part!r}" for name, part in self.kwargs.items()]
        return f"FunctionOfDraws({', '.join([_function_name(self.function), *words])})"


@lru_cache(maxsize=4)
def _shuffle(source: Source, size: int) -> NDArray[np.int64]:
    words = _core.random_numbers("bits", *source, 0, size, 1)[:, 0]
    order: NDArray[np.int64] = np.argsort(words, kind="stable")
    return order


def _counter(member: int) -> NDArray[np.uint64]:
    """Return the start of the counter of a member's own generator; counters of the core end in 0."""
    return np.array([0, 0, member, 1], dtype=np.uint64)


def _function_name(function: Any) -> str:
    return str(getattr(function, "__qualname__", repr(function)))


def _name_argument(distribution: Distribution) -> dict[str, Any]:
    return {} if distribution.name is None else {"name": distribution.name}


def _and_name(distribution: Distribution) -> str:
    return "" if distribution.name is None else f", name={distribution.name!r}"
