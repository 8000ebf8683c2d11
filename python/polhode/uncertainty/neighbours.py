"""Bodies near a given one, along the principal directions of its covariance."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError
from polhode.uncertainty.joined import joined

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from polhode import RigidBody, Uncertain

    Floats = NDArray[np.float64]

__all__ = ["HALVINGS", "Neighbours"]

CLOSE: Final = 4.0
"""Moments within so many deviations of their gap may change places: the tensor tells them better than
angles do."""
TRIES: Final = 1000
"""Draws of which none is a body, in a row, before it is told."""
HALVINGS: Final = 40
"""How often a step is halved before there is no body beside."""
ORDER: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class Neighbours:
    """The bodies and other numbers that a covariance makes likely, by coordinates that are standard normal.

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
            self._way = _Way(body, self._factor)

    def at(self, coordinates: Floats) -> tuple[Any, ...]:
        """Give the body and the other numbers with these coordinates; their own are zero."""
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
        """The body and the other numbers as they are."""
        return tuple(self._values) if self.body is None else (self.body, *self._values)

    def step(self, direction: Floats) -> float:
        """Give the longest step, up to one deviation, that leads to bodies both ways."""
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
        """Give the bodies a step each way along each probe: as moved here, and as the body knows."""
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
        """Draw bodies and other numbers, and warn of draws that no body has."""
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


class _Way:
    """The way from a body to its neighbours, by changes of its ten numbers that are right to first order."""

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
            self._turned, slopes, bends
        )

    def to(self, change: Floats) -> RigidBody:
        """Give the body after a change."""
        return _body(self._straight(change) if self._is_straight else self._turned(change))

    def straight_to(self, change: Floats) -> RigidBody:
        """Give the body after a change that is right to second order."""
        return _body(self._straight(change))

    def _straight(self, change: Floats) -> Floats:
        return self._numbers + change

    def _turned(self, change: Floats) -> Floats:
        """Give the ten numbers after a change of principal moments and angles."""
        turned = self._axes.T @ _symmetric(change[4:]) @ self._axes
        gaps = np.where(self._apart, self._moments[None, :] - self._moments[:, None], 1.0)
        angles = np.where(self._apart, turned / gaps, 0.0)
        kept = np.diag(self._moments) + np.where(self._apart, 0.0, turned)
        axes = self._axes @ _rotation(angles)
        tensor = axes @ kept @ axes.T
        return np.array([*(self._numbers[:4] + change[:4]), *(tensor[place] for place in ORDER)])

    def _misses(self, way: Callable[[Floats], Floats], slopes: Floats, bends: Floats) -> float:
        """Tell how far from the body's own second order a way along its probes leads."""
        missed = 0.0
        for slope, bend in zip(slopes, bends, strict=True):
            even = 0.5 * (way(slope) + way(-slope)) - self._numbers
            missed += float(((even - bend)[4:] ** 2).sum())
        return missed

    def _pairs_apart(self, changes: Floats) -> NDArray[np.bool_]:
        """Tell which pairs of moments are far enough apart for the angle between their axes."""
        apart = np.zeros((3, 3), dtype=bool)
        for i in range(3):
            for j in range(3):
                spread = (changes[:, j, j] - changes[:, i, i]) ** 2 + 4 * changes[:, i, j] ** 2
                gap = abs(self._moments[j] - self._moments[i])
                apart[i, j] = i != j and gap > CLOSE * np.sqrt(spread.sum()) and gap > 1e-9 * self._moments[2]
        return apart


def _number(argument: Any, place: int) -> Uncertain:
    """Take an argument as `Uncertain`."""
    number = argument if isinstance(argument, _core.Uncertain) else joined(argument)
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
    """Make a body; what a lamina or rod lacks by rounding is none."""
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
    """Give the exponential of an antisymmetric matrix (Rodrigues)."""
    squared = angles @ angles
    angle = float(np.sqrt(max(0.0, -0.5 * np.trace(squared))))
    if angle < 1e-4:  # the next terms are below rounding
        first, second = 1 - angle**2 / 6, 0.5 - angle**2 / 24
    else:
        first, second = np.sin(angle) / angle, (1 - np.cos(angle)) / angle**2
    return np.asarray(np.eye(3) + first * angles + second * squared)
