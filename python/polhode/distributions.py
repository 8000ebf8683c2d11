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

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from polhode import _core
from polhode._draws import Distribution, Made, Normal, PerMember, Samples, Uniform, UniformRotation
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "Distribution",
    "Made",
    "Normal",
    "PerMember",
    "Samples",
    "Uniform",
    "UniformRotation",
    "made",
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
    middle = _fixed(mean, "mean")
    if (covariance is None) == (sigma is None):
        raise TypeError("normal: give either covariance or sigma")
    _check_name(name)
    if sigma is not None:
        widths = _fixed(sigma, "sigma")
        if (widths < 0.0).any():
            raise ValueError(f"sigma: expected numbers that are zero or more, got {widths.min():.6g}")
        return Normal(middle, _broadcast(widths, middle.shape, "sigma"), _kept(np.zeros((0, 0))), name)
    matrix = _fixed(covariance, "covariance")
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
        return Normal(middle, _kept(np.sqrt(np.diagonal(matrix)).reshape(middle.shape)), _kept(factor), name)
    return Normal(middle, None, _kept(factor), name)


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
    below, above = _fixed(low, "low"), _fixed(high, "high")
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
    rows = _fixed(values, "values")
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


def made(function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Made:
    """Make bodies or loads from drawn numbers, by one call for all members of a chunk.

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
    Made

    Examples
    --------
    >>> from polhode import RigidBody, distributions
    >>> distributions.made(RigidBody.from_principal, 1.0, distributions.normal((1, 2, 2.5), sigma=0.01))
    Made(RigidBody.from_principal, 1.0, Normal(mean=[1.0, 2.0, 2.5], sigma=[0.01, 0.01, 0.01]))
    """
    if not callable(function):
        raise TypeError(f"function: expected a function that makes bodies or loads, got {function!r}")
    return Made(function, tuple(map(_own, args)), {name: _own(part) for name, part in kwargs.items()})


def _own(part: Any) -> Any:
    """Give an argument, an array as one that nobody changes."""
    if not isinstance(part, np.ndarray):
        return part
    copy = part.copy()
    copy.setflags(write=False)
    return copy


def _fixed(value: Any, name: str) -> Floats:
    """Give an array of finite numbers that stays as it is."""
    array = _core.real_numbers(value, name)
    wrong = ~np.isfinite(array)
    if wrong.any():
        raise ValueError(f"{name} must be finite, got {array[wrong][0]}")
    return _kept(array)


def _kept(array: Floats) -> Floats:
    array = np.array(array, dtype=np.float64)
    array.setflags(write=False)
    return array


def _broadcast(array: Floats, shape: tuple[int, ...], name: str) -> Floats:
    try:
        return _kept(np.broadcast_to(array, shape))
    except ValueError:
        raise ValueError(f"{name}: shape {array.shape} does not broadcast to {shape}") from None


def _check_name(name: object) -> None:
    if name is not None and not (isinstance(name, str) and name):
        raise TypeError(f"name: expected a word, got {name!r}")
