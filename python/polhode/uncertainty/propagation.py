"""Uncertainty of any function of a body: to first order, to second order, or by draws."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode._hints import check_kind
from polhode._progress import watched
from polhode._repr import short
from polhode.errors import PolhodeError
from polhode.uncertainty.neighbours import HALVINGS, Neighbours

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from polhode import RigidBody
    from polhode._progress import Progress

    Floats = NDArray[np.float64]
    Function = Callable[..., Any]

__all__ = ["Propagated", "is_enough", "propagate", "slopes_of"]

LACKING: Final = 0.015
"""Largest part of a variance that the first order may lack: a percent of the deviation, with a margin."""
NEAR: Final = 0.25
"""Steps along a body's own probes, in deviations: so short that the second order is all that is seen."""
PROBES: Final = 32
"""Directions in which second- and third-order terms are looked for."""
ROUNDING: Final = 1e-13
"""Of a number, by which a function may err."""
SMALL: Final = 1e-12
"""Beside the largest of an array: such a number may be what is left of zero."""


class Propagated(NamedTuple):
    """Value of a function of an uncertain body, with its uncertainty.

    Attributes
    ----------
    value : float or numpy.ndarray
        For ``"linear"`` the function of the body itself; for ``"second-order"`` and ``"monte-carlo"`` the
        mean.
    sigma : float or numpy.ndarray
        Standard deviations, of the same shape.
    covariance : numpy.ndarray, shape (k, k)
        Covariance of the k numbers of the value in C order.
    linear : bool or numpy.ndarray of bool
        Whether the first order is enough for each number, to about a percent of its sigma. For
        ``"monte-carlo"``: whether `sigma` is that accurate, apart from the chance of the draws. It is False
        if mass, centre of mass and tensor depend so strongly on squares of the uncertain numbers that the
        body was made of that the random bodies have another distribution. Then draw those numbers
        themselves: see the notes of :func:`propagate`.
    """

    value: Any
    sigma: Any
    covariance: Any
    linear: Any

    def __repr__(self) -> str:
        return short(self)


def propagate(
    f: Function,
    body: RigidBody | None,
    method: Literal["linear", "second-order", "monte-carlo"] = "linear",
    *,
    arguments: Sequence[Any] = (),
    n: int = 10_000,
    seed: int | None = None,
    progress: Progress = None,
) -> Propagated:
    """Uncertainty of any function of a body.

    Parameters
    ----------
    f : callable
        Function of the body and of the values of `arguments`. It returns a number, or an array of numbers of
        constant shape.
    body : RigidBody or None
        One body; without `arguments` it must carry a covariance. None for a function of the arguments alone.
    method : {"linear", "second-order", "monte-carlo"}
        ``"linear"``: to first order, by differences along the principal directions of the covariance.
        ``"second-order"``: mean and covariance to second order. ``"monte-carlo"``: from random bodies.
    arguments : sequence of Uncertain, optional
        Further numbers that the function takes, such as an angular velocity. Sources of error that they share
        with each other or with the body are respected.
    n : int, optional
        How many draws.
    seed : int, optional
        Seed of the draws; the same seed gives the same draws. Required for ``"monte-carlo"``.
    progress : bool or callable, optional
        A function that is called with the fraction done, or whether to show a progress bar. By default a bar
        appears on a terminal after two seconds.

    Returns
    -------
    Propagated

    Raises
    ------
    ValueError
        For a stack, a body without covariance, draws without a seed.

    Notes
    -----
    Let k be the rank of the covariance, at most 10 for a body alone. The function is called about 4 k + 130
    times to first order, 2 k² + 6 k + 130 times to second order, and n + 4 k + 65 times for random bodies.

    Random bodies have a normal distribution of the ten numbers: mass, centre of mass and tensor. Numbers that
    no body can have are drawn again. In two cases principal moments and small rotations of the axes are drawn
    in place of the tensor. The first case is a body without extent along an axis, such as a lamina. The
    second case is a body whose tensor depends on the uncertain numbers it was made of in such a way that
    these draws agree better with it to second order. An example is a body that was rotated by an uncertain
    angle.

    To draw the uncertain numbers that a body was made of, pass them as `arguments` and None as `body`, and
    make the body inside `f`.

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
    (True, 1.6379, 0.000409)
    """
    check_kind(body, "body", "RigidBody", "NoneType")
    if not isinstance(arguments, list | tuple):
        message = f"arguments: expected a list of numbers with a sigma, got {type(arguments).__name__}"
        raise TypeError(message)
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
        return _monte_carlo(f, around, n, seed, progress)
    message = f'method: expected "linear", "second-order" or "monte-carlo", got {method!r}'
    raise ValueError(message)


def _numbers(f: Function, given: tuple[Any, ...], shape: tuple[int, ...] | None = None) -> Floats:
    """Give the value of a function, which keeps its shape."""
    value = np.asarray(f(*given), dtype=float)
    if shape is not None and value.shape != shape:
        message = f"f: its value has the shape {value.shape} here and {shape} for the body itself"
        raise ValueError(message)
    return value


def slopes_of(f: Function, around: Neighbours, shape: tuple[int, ...]) -> Floats:
    """Give the derivatives by one standard deviation of each direction, shape (k, numbers)."""
    found = []
    for direction in np.eye(around.rank):
        step = around.step(direction)
        for halvings in range(HALVINGS + 1):
            try:
                far, near = (
                    (
                        _numbers(f, around.at(part * step * direction), shape)
                        - _numbers(f, around.at(-part * step * direction), shape)
                    )
                    for part in (1.0, 0.5)
                )
                break
            except PolhodeError:  # the function has no value so far away
                if halvings == HALVINGS:
                    raise
                step *= 0.5
        found.append(((8.0 * near - far) / (6.0 * step)).ravel())
    return np.array(found).reshape(around.rank, math.prod(shape))


def _is_linear(f: Function, around: Neighbours, value: Floats, slopes: Floats) -> NDArray[np.bool_]:
    """Whether terms of higher order stay small along some directions, those of the body itself among them."""
    directions = np.random.default_rng(20).normal(size=(PROBES, around.rank))
    even, firsts, changes = [], [], []
    for direction in directions:
        try:
            above, below = (_numbers(f, around.at(s * direction), value.shape).ravel() for s in (1.0, -1.0))
        except PolhodeError:  # beyond what bodies have
            return np.zeros(value.size, dtype=bool)
        even.append(0.5 * (above + below) - value.ravel())
        firsts.append(direction @ slopes)
        changes.append(0.5 * (above - below))
    first, change = np.array(firsts), np.array(changes)
    variance = (slopes**2).sum(axis=0)
    fits = is_enough(first, change, np.array(even), variance, ROUNDING * np.abs(value.ravel()))
    return np.asarray((fits & _follows(f, around, value, variance)) | _is_rounding(value, first, change))


def is_enough(
    first: Floats, change: Floats, even: Floats, variance: Floats, noise: Floats
) -> NDArray[np.bool_]:
    """Tell whether the first order is enough, from random directions with normal coordinates.

    Parameters
    ----------
    first, change, even : numpy.ndarray, shape (directions, ...)
        Of each direction the first-order change; and of the changes for a step forward and one back half the
        difference, and the mean.
    variance : numpy.ndarray, shape (...)
        To first order.
    noise : numpy.ndarray, shape (...)
        What is rounding.
    """
    lacking = even.var(axis=0) + 2 * (first * (change - first)).mean(axis=0)
    return np.asarray(np.abs(lacking) <= LACKING * variance + 2 * noise * np.sqrt(variance) + noise**2)


def _is_rounding(value: Floats, first: Floats, change: Floats) -> NDArray[np.bool_]:
    """Whether a number of an array is zero but for rounding of the others: its changes follow no slopes."""
    size = SMALL * np.abs(value[np.isfinite(value)]).max(initial=0.0)
    products = np.abs((first * change).sum(axis=0))
    follows = products**2 > 0.25 * (first**2).sum(axis=0) * (change**2).sum(axis=0)
    is_small = np.abs(value.ravel()) + np.abs(change).max(axis=0, initial=0.0) <= size
    return np.asarray(is_small & ~follows)


def _follows(f: Function, around: Neighbours, value: Floats, variance: Floats) -> NDArray[np.bool_]:
    """Whether the ways from body to body taken here lead where the body's own second order does."""
    missed, count = np.zeros(value.size), 0
    for probe in around.probes(NEAR):
        here, there = (sum(_numbers(f, given, value.shape).ravel() for given in pair) / 2 for pair in probe)
        missed += ((here - there) / NEAR**2) ** 2
        count += 1
    noise = ROUNDING * np.abs(value.ravel()) / NEAR**2
    return np.asarray(missed / max(count, 1) <= LACKING * variance + noise**2)


def _linear(f: Function, around: Neighbours) -> Propagated:
    value = _numbers(f, around.start)
    slopes = slopes_of(f, around, value.shape)
    return _told(value, slopes.T @ slopes, _is_linear(f, around, value, slopes))


def _second_order(f: Function, around: Neighbours) -> Propagated:
    value = _numbers(f, around.start)
    slopes, rank = slopes_of(f, around, value.shape), around.rank
    bends = np.zeros((rank, rank, value.size))
    for i in range(rank):
        for j in range(i + 1):
            both, other = np.eye(rank)[i] + np.eye(rank)[j], np.eye(rank)[i] - np.eye(rank)[j]
            h = 0.5 * min(around.step(0.5 * both), around.step(0.5 * other))
            mixed = sum(
                sign * _numbers(f, around.at(s * h * step), value.shape).ravel()
                for step, sign in ((both, 1.0), (other, -1.0))
                for s in (1.0, -1.0)
            )
            bends[i, j] = bends[j, i] = mixed / (4 * h * h)
    mean = value + 0.5 * np.einsum("iin->n", bends).reshape(value.shape)
    covariance = slopes.T @ slopes + 0.5 * np.einsum("ijm,ijn->mn", bends, bends)
    return _told(mean, covariance, _is_linear(f, around, value, slopes))


def _monte_carlo(f: Function, around: Neighbours, n: int, seed: int, progress: Progress) -> Propagated:
    value = _numbers(f, around.start)
    found = []
    with watched(f"{n} draws", progress) as tell:
        for given in around.draws(n, seed):
            found.append(_numbers(f, given, value.shape).ravel())
            if tell is not None:
                tell(len(found) / n)
    draws = np.array(found)
    mean = draws.mean(axis=0)
    covariance = np.atleast_2d(np.cov(draws, rowvar=False))
    # By the first order: where the ways lead elsewhere the draws may have any variance. What ways miss in the
    # second order is seen; in the third, of a quotient, it may be twice as much.
    first = (slopes_of(f, around, value.shape) ** 2).sum(axis=0)
    follows = _follows(f, around, value, np.minimum(first, np.diagonal(covariance)) / 3)
    return _told(mean.reshape(value.shape), covariance, follows)


def _told(value: Floats, covariance: Floats, linear: NDArray[np.bool_]) -> Propagated:
    sigma = np.sqrt(np.diagonal(covariance)).reshape(value.shape)
    if value.shape == ():
        return Propagated(float(value), float(sigma), covariance, bool(linear[0]))
    return Propagated(value, sigma, covariance, linear.reshape(value.shape))
