"""Uncertainty of any function of a body: to first order, to second order, or by draws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode._repr import short
from polhode.uncertainty.neighbours import Neighbours

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from polhode import RigidBody, Uncertain

    Floats = NDArray[np.float64]
    Function = Callable[..., Any]

__all__ = ["Propagated", "propagate"]

LINEAR: Final = 0.1
"""Second-order terms below this fraction of the first-order ones leave a deviation right: squares add."""
CUBIC: Final = 0.03
"""Third-order terms below this fraction do: they are correlated with the first-order ones."""
PROBES: Final = 12
"""Directions in which second- and third-order terms are looked for."""
ROUNDING: Final = 1e-9


class Propagated(NamedTuple):
    """What a function of an uncertain body is worth.

    Attributes
    ----------
    value : float or numpy.ndarray
        Of the body itself for ``"linear"``; the mean for ``"second-order"`` and ``"monte-carlo"``.
    sigma : float or numpy.ndarray
        Standard deviations, of the same shape.
    covariance : numpy.ndarray, shape (k, k)
        Of the k numbers of the value in C order.
    linear : bool or numpy.ndarray of bool
        Whether the first order is enough for each number, within about a percent of its sigma. Draws do not
        need it: True.
    """

    value: Any
    sigma: Any
    covariance: Any
    linear: Any

    def __repr__(self) -> str:
        return short(self)


def propagate(
    f: Function,
    body: RigidBody,
    method: Literal["linear", "second-order", "monte-carlo"] = "linear",
    *,
    arguments: Sequence[Uncertain] = (),
    n: int = 10_000,
    seed: int | None = None,
) -> Propagated:
    """Uncertainty of any function of a body.

    Parameters
    ----------
    f : callable
        Takes one `RigidBody`, and the values of `arguments` after it; gives a number or an array of numbers,
        always of the same shape.
    body : RigidBody
        One body. Without `arguments` it must carry a covariance.
    method : {"linear", "second-order", "monte-carlo"}
        First order, by differences along the principal directions of the covariance; mean and covariance to
        second order; or draws of bodies.
    arguments : sequence of Uncertain, optional
        Other numbers that the function takes, such as an angular velocity. What comes from one source with
        them or with the body stays one source.
    n : int, optional
        How many draws.
    seed : int, optional
        Of the draws; the same seed gives the same draws. Required for ``"monte-carlo"``.

    Returns
    -------
    Propagated

    Raises
    ------
    ValueError
        For a stack, a body without covariance, draws without a seed.

    Notes
    -----
    The function is asked 4 k + 25 times to first order, k the rank of the covariance, at most 10 for a body alone;
    2 k² + 6 k + 25 times to second order; n + 1 times by draws. Draws are normal in the ten numbers, and drawn
    again where no body has them; of a body without extent along some axis they are normal in a square root of its
    pseudo-inertia, so that all are possible.

    Examples
    --------
    The period of a compound pendulum that hangs from the origin:

    >>> import numpy as np
    >>> from polhode import Uncertain, rods
    >>> from polhode.uncertainty import propagate
    >>> rod = rods.rod(Uncertain(1.0, 0.001), mass=0.2).translated((0, 0, -0.5))
    >>> def period(body):
    ...     moment = body.inertia_about("origin")[0, 0]
    ...     return 2 * np.pi * np.sqrt(moment / (body.mass * 9.81 * -body.center_of_mass[2]))
    >>> found = propagate(period, rod)
    >>> bool(found.linear), round(float(found.value), 4), round(float(found.sigma), 6)
    (True, 1.638, 0.00041)
    """
    around = Neighbours(body, arguments)
    if method == "linear":
        return _linear(f, around)
    if method == "second-order":
        return _second_order(f, around)
    if method == "monte-carlo":
        if seed is None:
            raise ValueError("seed: draws need one, so that they can be had again")
        if n < 2:
            message = f"n: a deviation needs at least 2 draws, got {n}"
            raise ValueError(message)
        return _monte_carlo(f, around, n, seed)
    message = f'method: expected "linear", "second-order" or "monte-carlo", got {method!r}'
    raise ValueError(message)


def _numbers(f: Function, given: tuple[Any, ...], shape: tuple[int, ...] | None = None) -> Floats:
    """Give the value of a function, which keeps its shape."""
    value = np.asarray(f(*given), dtype=float)
    if shape is not None and value.shape != shape:
        message = f"f: its value has the shape {value.shape} here and {shape} for the body itself"
        raise ValueError(message)
    return value


def _slopes(f: Function, around: Neighbours, shape: tuple[int, ...]) -> Floats:
    """Give the derivatives by one standard deviation of each direction, shape (k, numbers)."""
    slopes = []
    for direction in np.eye(around.rank):
        far = _numbers(f, around.at(direction), shape) - _numbers(f, around.at(-direction), shape)
        near = _numbers(f, around.at(0.5 * direction), shape) - _numbers(
            f, around.at(-0.5 * direction), shape
        )
        slopes.append(((8.0 * near - far) / 6.0).ravel())
    return np.array(slopes).reshape(around.rank, -1)


def _is_linear(f: Function, around: Neighbours, value: Floats, slopes: Floats) -> NDArray[np.bool_]:
    """Whether terms of higher order stay small along some directions."""
    directions = np.random.default_rng(20).normal(size=(PROBES, around.rank))
    second, third = np.zeros(value.size), np.zeros(value.size)
    for direction in directions:
        above, below = (_numbers(f, around.at(s * direction), value.shape).ravel() for s in (1.0, -1.0))
        second += (0.5 * (above + below) - value.ravel()) ** 2
        third += (0.5 * (above - below) - direction @ slopes) ** 2
    sigma = np.sqrt((slopes**2).sum(axis=0))
    noise = ROUNDING * np.abs(value.ravel())
    fits = (np.sqrt(second / PROBES) <= LINEAR * sigma + noise) & (
        np.sqrt(third / PROBES) <= CUBIC * sigma + noise
    )
    return np.asarray(fits)


def _linear(f: Function, around: Neighbours) -> Propagated:
    value = _numbers(f, around.start)
    slopes = _slopes(f, around, value.shape)
    return _told(value, slopes.T @ slopes, _is_linear(f, around, value, slopes))


def _second_order(f: Function, around: Neighbours) -> Propagated:
    value = _numbers(f, around.start)
    slopes, rank = _slopes(f, around, value.shape), around.rank
    bends = np.zeros((rank, rank, value.size))
    for i in range(rank):
        for j in range(i + 1):
            both = np.zeros(rank)
            both[i] += 1.0
            both[j] += 1.0
            other = both.copy()
            other[j] -= 2.0
            mixed = sum(
                sign * _numbers(f, around.at(0.5 * s * step), value.shape).ravel()
                for step, sign in ((both, 1.0), (other, -1.0))
                for s in (1.0, -1.0)
            )
            bends[i, j] = bends[j, i] = mixed
    mean = value + 0.5 * np.einsum("iin->n", bends).reshape(value.shape)
    covariance = slopes.T @ slopes + 0.5 * np.einsum("ijm,ijn->mn", bends, bends)
    return _told(mean, covariance, _is_linear(f, around, value, slopes))


def _monte_carlo(f: Function, around: Neighbours, n: int, seed: int) -> Propagated:
    shape = _numbers(f, around.start).shape
    draws = np.array([_numbers(f, given, shape).ravel() for given in around.draws(n, seed)])
    mean = draws.mean(axis=0)
    covariance = np.atleast_2d(np.cov(draws, rowvar=False))
    return _told(mean.reshape(shape), covariance, np.ones(mean.size, dtype=bool))


def _told(value: Floats, covariance: Floats, linear: NDArray[np.bool_]) -> Propagated:
    sigma = np.sqrt(np.diagonal(covariance)).reshape(value.shape)
    if value.shape == ():
        return Propagated(float(value), float(sigma), covariance, bool(linear[0]))
    return Propagated(value, sigma, covariance, linear.reshape(value.shape))
