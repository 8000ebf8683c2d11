"""Uncertainty of any function of a body: to first order, to second order, or by draws."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import short
from polhode._hints import check_kind
from polhode._progress import progress_bar
from polhode.errors import PolhodeError
from polhode.uncertainty.uncertain import join

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from polhode import RigidBody, Uncertain
    from polhode._progress import Progress

    Floats = NDArray[np.float64]
    Function = Callable[..., Any]

__all__ = [
    "HALVINGS",
    "Neighbours",
    "PropagationResult",
    "is_enough",
    "propagate",
    "slopes_of",
]

LACKING: Final = 0.015
"""Largest part of a variance that the first order may lack: a percent of the deviation, with a margin."""
NEAR: Final = 0.25
"""Steps along a body's own probes, in deviations: so short that orders above the second are negligible."""
PROBES: Final = 32
"""Directions in which second- and third-order terms are looked for."""
ROUNDING: Final = 1e-13
"""Relative rounding error of a function."""
SMALL: Final = 1e-12
"""A number below this fraction of the largest of an array may be zero with rounding errors."""


class PropagationResult(NamedTuple):
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
) -> PropagationResult:
    """Compute the uncertainty of any function of a body.

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
    PropagationResult

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
    """Call the function and return its value; the shape of all values must be the same."""
    value = np.asarray(f(*given), dtype=float)
    if shape is not None and value.shape != shape:
        message = f"f: its value has the shape {value.shape} here and {shape} for the body itself"
        raise ValueError(message)
    return value


def slopes_of(f: Function, around: Neighbours, shape: tuple[int, ...]) -> Floats:
    """Return the derivatives by one standard deviation of each direction, shape (k, numbers)."""
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
    """Return whether terms of higher order stay small along some directions, those of the body among them."""
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
    """Return whether the first order is enough, from random directions with normal coordinates.

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
    """Return whether a number of an array is zero except for rounding; its changes have no meaning then."""
    size = SMALL * np.abs(value[np.isfinite(value)]).max(initial=0.0)
    products = np.abs((first * change).sum(axis=0))
    follows = products**2 > 0.25 * (first**2).sum(axis=0) * (change**2).sum(axis=0)
    is_small = np.abs(value.ravel()) + np.abs(change).max(axis=0, initial=0.0) <= size
    return np.asarray(is_small & ~follows)


def _follows(f: Function, around: Neighbours, value: Floats, variance: Floats) -> NDArray[np.bool_]:
    """Return whether the steps from body to body agree with the body's own second-order terms."""
    missed, count = np.zeros(value.size), 0
    for probe in around.probes(NEAR):
        here, there = (sum(_numbers(f, given, value.shape).ravel() for given in pair) / 2 for pair in probe)
        missed += ((here - there) / NEAR**2) ** 2
        count += 1
    noise = ROUNDING * np.abs(value.ravel()) / NEAR**2
    return np.asarray(missed / max(count, 1) <= LACKING * variance + noise**2)


def _linear(f: Function, around: Neighbours) -> PropagationResult:
    value = _numbers(f, around.start)
    slopes = slopes_of(f, around, value.shape)
    return _make_result(value, slopes.T @ slopes, _is_linear(f, around, value, slopes))


def _second_order(f: Function, around: Neighbours) -> PropagationResult:
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
    return _make_result(mean, covariance, _is_linear(f, around, value, slopes))


def _monte_carlo(f: Function, around: Neighbours, n: int, seed: int, progress: Progress) -> PropagationResult:
    value = _numbers(f, around.start)
    found = []
    with progress_bar(f"{n} draws", progress) as tell:
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
    return _make_result(mean.reshape(value.shape), covariance, follows)


def _make_result(value: Floats, covariance: Floats, linear: NDArray[np.bool_]) -> PropagationResult:
    sigma = np.sqrt(np.diagonal(covariance)).reshape(value.shape)
    if value.shape == ():
        return PropagationResult(float(value), float(sigma), covariance, bool(linear[0]))
    return PropagationResult(value, sigma, covariance, linear.reshape(value.shape))


CLOSE: Final = 4.0
"""Moments within this many deviations of their gap may change places; then tensor elements are used
instead of angles."""
TRIES: Final = 1000
"""Number of impossible draws after which an error is raised, if few draws are possible."""
HALVINGS: Final = 40
"""Number of halvings of a step after which no neighbouring body exists."""
ORDER: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class Neighbours:
    """Bodies and other numbers as functions of standard normal coordinates, by their covariance.

    To first order all ways from body to body are one. To second order bodies move straight in their ten
    numbers, or straight in principal moments and small angles of their axes: whichever is nearer to what
    the body knows of its second order. The latter is so where a body is turned, and where it has no extent
    along an axis.

    Parameters
    ----------
    body : RigidBody or None
        One body, or none beside the numbers.
    arguments : sequence of Uncertain
        Other numbers.
    """

    def __init__(self, body: RigidBody | None, arguments: Sequence[Any] = ()) -> None:
        if body is not None and body.shape != ():
            message = f"body: expected one body, got a stack of shape {body.shape}; take one after the other"
            raise ValueError(message)
        if (body is None or body.covariance is None) and not arguments:
            message = (
                "body: it carries no covariance; give it one by with_sigma, with_covariance or Uncertain"
            )
            raise ValueError(message)
        arguments = [_number(argument, place) for place, argument in enumerate(arguments)]
        self.body = body
        self._values = [np.asarray(argument.value, dtype=float) for argument in arguments]
        variables, tangents = _joint_tangents(body, arguments)
        covariance = tangents @ tangents.T
        # In units of the numbers themselves, so that kilograms and metres stand side by side.
        scale = np.sqrt(np.diagonal(covariance))
        scale[scale == 0.0] = 1.0
        values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
        kept = values > 1e-12 * values[-1]
        factor: Floats = scale[:, None] * vectors[:, kept] * np.sqrt(values[kept])
        self._factor, self._others = factor[:10], factor[10:]
        self.rank: int = int(kept.sum())
        self.variables = variables
        """What the numbers depend on."""
        self.of_variables: Floats = (vectors[:, kept] / np.sqrt(values[kept])).T @ (tangents / scale[:, None])
        """Coordinates of one standard deviation of each variable, shape (rank, variables)."""
        if body is not None:
            self._way = _BodyMap(body, self._factor)

    def at(self, coordinates: Floats) -> tuple[Any, ...]:
        """Return the body and the other numbers with these coordinates; zero gives the mean values."""
        moved = self._others @ coordinates
        values: list[Any] = []
        for value in self._values:
            own, moved = moved[: value.size], moved[value.size :]
            values.append(value + own.reshape(value.shape))
        if self.body is None:
            return tuple(values)
        return self._way.to(self._factor @ coordinates), *values

    @property
    def start(self) -> tuple[Any, ...]:
        """The body and the other numbers, unchanged."""
        return tuple(self._values) if self.body is None else (self.body, *self._values)

    def step(self, direction: Floats) -> float:
        """Return the longest step, up to one deviation, with possible bodies in both directions."""
        step = 1.0
        for _ in range(HALVINGS):
            try:
                self.at(step * direction)
                self.at(-step * direction)
            except PolhodeError:
                step *= 0.5
            else:
                return step
        message = "body: its covariance leads to no possible body; give the numbers that the body is made of"
        raise PolhodeError(message)

    def probes(self, step: float) -> Iterator[tuple[list[tuple[Any, ...]], list[tuple[Any, ...]]]]:
        """Return the bodies one step both ways along each probe: by this class, and by the body itself."""
        if self.body is None:
            return
        slopes, bends = self.body._probes()
        for slope, bend in zip(slopes, bends, strict=True):
            changes = [sign * step * slope for sign in (1.0, -1.0)]
            try:
                here = [self._way.to(change) for change in changes]
                there = [self._way.straight_to(change + step * step * bend) for change in changes]
            except PolhodeError:
                continue
            yield [(body, *self._values) for body in here], [(body, *self._values) for body in there]

    def draws(self, n: int, seed: int) -> Iterator[tuple[Any, ...]]:
        """Draw bodies and other numbers; warn of draws that no body can have."""
        generator = np.random.default_rng(seed)
        refused = 0
        made = 0
        while made < n:
            try:
                body = self.at(generator.normal(size=self.rank))
            except PolhodeError as error:
                refused += 1
                if refused >= TRIES and refused > 10 * made:
                    message = (
                        f"body: of {refused + made} draws from its covariance {refused} are those of no body "
                        f"({error}); the sigmas are too large for a normal distribution: give those of the "
                        "dimensions and masses that they come from"
                    )
                    raise PolhodeError(message) from None
                continue
            made += 1
            yield body
        if refused:
            message = f"{refused} of {refused + made} draws were those of no body, and were drawn again"
            warnings.warn(message, stacklevel=4)


class _BodyMap:
    """Map from a change of the ten numbers, right to first order, to a neighbouring body."""

    def __init__(self, body: RigidBody, factor: Floats) -> None:
        tensor, principal = body.inertia, body.principal
        self._numbers = np.array([body.mass, *body.center_of_mass, *(tensor[place] for place in ORDER)])
        self._axes, self._moments = principal.axes, principal.moments
        changes = np.array([self._axes.T @ _symmetric(step[4:]) @ self._axes for step in factor.T])
        self._apart = self._pairs_apart(changes.reshape(-1, 3, 3))
        slopes, bends = body._probes()
        second = self._moments.sum() / 2 - self._moments
        # Straight steps leave what has no extent along an axis.
        is_flat = second.min() <= 1e-9 * second.max() and factor.any()
        self._is_straight = not is_flat and self._misses(self._straight, slopes, bends) <= self._misses(
            self._perturb, slopes, bends
        )

    def to(self, change: Floats) -> RigidBody:
        """Return the body after a change."""
        return _body(self._straight(change) if self._is_straight else self._perturb(change))

    def straight_to(self, change: Floats) -> RigidBody:
        """Return the body after a change that is right to second order."""
        return _body(self._straight(change))

    def _straight(self, change: Floats) -> Floats:
        return self._numbers + change

    def _perturb(self, change: Floats) -> Floats:
        """Return the ten numbers after a change of principal moments and angles."""
        turned = self._axes.T @ _symmetric(change[4:]) @ self._axes
        gaps = np.where(self._apart, self._moments[None, :] - self._moments[:, None], 1.0)
        angles = np.where(self._apart, turned / gaps, 0.0)
        kept = np.diag(self._moments) + np.where(self._apart, 0.0, turned)
        axes = self._axes @ _rotation(angles)
        tensor = axes @ kept @ axes.T
        return np.array([*(self._numbers[:4] + change[:4]), *(tensor[place] for place in ORDER)])

    def _misses(self, way: Callable[[Floats], Floats], slopes: Floats, bends: Floats) -> float:
        """Compute the distance of a step along the probes from the body's own second order."""
        missed = 0.0
        for slope, bend in zip(slopes, bends, strict=True):
            even = 0.5 * (way(slope) + way(-slope)) - self._numbers
            missed += float(((even - bend)[4:] ** 2).sum())
        return missed

    def _pairs_apart(self, changes: Floats) -> NDArray[np.bool_]:
        """Return which pairs of moments are far enough apart for the angle between their axes."""
        apart = np.zeros((3, 3), dtype=bool)
        for i in range(3):
            for j in range(3):
                spread = (changes[:, j, j] - changes[:, i, i]) ** 2 + 4 * changes[:, i, j] ** 2
                gap = abs(self._moments[j] - self._moments[i])
                apart[i, j] = i != j and gap > CLOSE * np.sqrt(spread.sum()) and gap > 1e-9 * self._moments[2]
        return apart


def _number(argument: Any, place: int) -> Uncertain:
    """Take an argument as `Uncertain`."""
    number = argument if isinstance(argument, _core.Uncertain) else join(argument)
    if number is None:
        message = (
            f"arguments: number {place} is {type(argument).__name__} without a sigma; let the function know "
            "it, and give those with a sigma alone"
        )
        raise TypeError(message)
    if hasattr(number.value, "as_quat"):
        message = (
            f"arguments: number {place} is a rotation; give its three small angles as Uncertain, and let the "
            "function turn by them"
        )
        raise TypeError(message)
    return number


def _body(numbers: Floats) -> RigidBody:
    """Make a body; a violation of the triangle inequality by rounding (lamina, rod) is ignored."""
    return _core.RigidBody(float(numbers[0]), _symmetric(numbers[4:]), numbers[1:4], rtol=1e-13)


def _joint_tangents(
    body: RigidBody | None, arguments: Sequence[Uncertain]
) -> tuple[list[tuple[int, ...]], Floats]:
    """Return the variables of the ten numbers and all others, and the changes by one sigma of each."""
    columns: dict[tuple[int, ...], int] = {}
    rows: list[dict[int, float]] = [{} for _ in range(10)]
    state = None if body is None else body._doubts()
    if state is not None:
        for words, tangent in zip(state["variables"].tolist(), state["tangents"].tolist(), strict=True):
            column = columns.setdefault(tuple(words), len(columns))
            for row, step in zip(rows, tangent, strict=True):
                row[column] = step
    rows.extend(
        {columns.setdefault(tuple(words), len(columns)): step for words, step in form}
        for argument in arguments
        for form in argument._forms()
    )
    factor = np.zeros((len(rows), len(columns)))
    for k, steps in enumerate(rows):
        for column, step in steps.items():
            factor[k, column] = step
    return list(columns), factor


def _symmetric(elements: Floats) -> Floats:
    tensor = np.zeros((3, 3))
    for (i, j), element in zip(ORDER, elements, strict=True):
        tensor[i, j] = tensor[j, i] = element
    return tensor


def _rotation(angles: Floats) -> Floats:
    """Return the exponential of an antisymmetric matrix (Rodrigues)."""
    squared = angles @ angles
    angle = float(np.sqrt(max(0.0, -0.5 * np.trace(squared))))
    if angle < 1e-4:  # the next terms are below rounding
        first, second = 1 - angle**2 / 6, 0.5 - angle**2 / 24
    else:
        first, second = np.sin(angle) / angle, (1 - np.cos(angle)) / angle**2
    return np.asarray(np.eye(3) + first * angles + second * squared)
