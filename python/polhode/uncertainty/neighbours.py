"""Bodies near a given one, along the principal directions of its covariance."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from polhode import RigidBody, Uncertain

    Floats = NDArray[np.float64]

__all__ = ["Neighbours"]

FLAT: Final = 1e-9
"""A body whose least second moment is below this fraction of the largest is without extent there."""
TRIES: Final = 1000
"""Draws of which none is a body, in a row, before it is told."""
ORDER: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class Neighbours:
    """The bodies and other numbers that a covariance makes likely, by coordinates that are standard normal.

    Parameters
    ----------
    body : RigidBody
        One body.
    arguments : sequence of Uncertain
        Other numbers.
    """

    def __init__(self, body: RigidBody, arguments: Sequence[Uncertain] = ()) -> None:
        if body.shape != ():
            message = f"body: expected one body, got a stack of shape {body.shape}; take one after the other"
            raise ValueError(message)
        if body.covariance is None and not arguments:
            message = (
                "body: it carries no covariance; give it one by with_sigma, with_covariance or Uncertain"
            )
            raise ValueError(message)
        self.body = body
        self._values = [np.asarray(argument.value, dtype=float) for argument in arguments]
        covariance = _joint_covariance(body, arguments)
        # In units of the numbers themselves, so that kilograms and metres stand side by side.
        scale = np.sqrt(np.diagonal(covariance))
        scale[scale == 0.0] = 1.0
        values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
        kept = values > 1e-12 * values[-1]
        factor: Floats = scale[:, None] * vectors[:, kept] * np.sqrt(values[kept])
        self._factor, self._others = factor[:10], factor[10:]
        self.rank: int = int(kept.sum())
        center, tensor = body.center_of_mass, body.inertia
        self._numbers = np.array([body.mass, *center, *(tensor[place] for place in ORDER)])
        second = body.principal_moments.sum() / 2 - body.principal_moments
        self._root: Floats | None = None
        if second.min() <= FLAT * second.max():
            self._root, self._inverse, self._range = _square_root(_pseudo_inertia(self._numbers, center))

    def at(self, coordinates: Floats) -> tuple[Any, ...]:
        """Give the body and the other numbers with these coordinates; their own are zero."""
        moved = self._others @ coordinates
        values: list[Any] = []
        for value in self._values:
            own, moved = moved[: value.size], moved[value.size :]
            values.append(value + own.reshape(value.shape))
        return self._body_at(coordinates), *values

    @property
    def start(self) -> tuple[Any, ...]:
        """The body and the other numbers as they are."""
        return self.body, *self._values

    def _body_at(self, coordinates: Floats) -> RigidBody:
        change = self._factor @ coordinates
        if self._root is None:
            return _body(self._numbers + change)
        center = self._numbers[1:4]
        step = 1e-4
        # The pseudo-inertia's first-order change, about where the centre of mass is.
        moved = (
            _pseudo_inertia(self._numbers + step * change, center)
            - _pseudo_inertia(self._numbers - step * change, center)
        ) / (2 * step)
        # δU with δU Uᵀ + U δUᵀ = δJ: half of it where U has a range, all of it beside.
        half = moved @ self._inverse
        root = self._root + half - 0.5 * self._range @ half
        return _of_pseudo_inertia(root @ root.T, center)

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


def _joint_covariance(body: RigidBody, arguments: Sequence[Uncertain]) -> Floats:
    """Of the ten numbers and all others, by the variables that they depend on."""
    columns: dict[tuple[int, ...], int] = {}
    rows: list[dict[int, float]] = [{} for _ in range(10)]
    state = body._doubts()
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
    return factor @ factor.T


def _body(numbers: Floats) -> RigidBody:
    mass, center, elements = float(numbers[0]), numbers[1:4], numbers[4:]
    return _core.RigidBody(mass, _symmetric(elements), center)


def _symmetric(elements: Floats) -> Floats:
    tensor = np.zeros((3, 3))
    for (i, j), element in zip(ORDER, elements, strict=True):
        tensor[i, j] = tensor[j, i] = element
    return tensor


def _pseudo_inertia(numbers: Floats, point: Floats) -> Floats:
    """∫ (r; 1)(r; 1)ᵀ dm, r from a point."""
    mass, arm, tensor = numbers[0], numbers[1:4] - point, _symmetric(numbers[4:])
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = 0.5 * np.trace(tensor) * np.eye(3) - tensor + mass * np.outer(arm, arm)
    matrix[:3, 3] = matrix[3, :3] = mass * arm
    matrix[3, 3] = mass
    return matrix


def _of_pseudo_inertia(matrix: Floats, point: Floats) -> RigidBody:
    mass = float(matrix[3, 3])
    arm = matrix[:3, 3] / mass
    second = matrix[:3, :3] - mass * np.outer(arm, arm)
    values, vectors = np.linalg.eigh(0.5 * (second + second.T))
    s = np.maximum(values, 0.0)
    moments = s.sum() - s
    if np.linalg.det(vectors) < 0:
        vectors[:, 0] *= -1.0
    return _core.RigidBody.from_principal(mass, moments, vectors, arm + point)


def _square_root(matrix: Floats) -> tuple[Floats, Floats, Floats]:
    """Give a square root, its pseudo-inverse, and the projection on its range."""
    scale = np.sqrt(np.diagonal(matrix))
    scale = np.where(scale > 1e-7 * scale[:3].max(), scale, scale[:3].max())
    scale[3] = np.sqrt(matrix[3, 3])
    values, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    kept = values > 1e-12 * values[-1]
    roots = np.sqrt(np.where(kept, values, 0.0))
    inverse = np.where(kept, 1.0 / np.where(kept, roots, 1.0), 0.0)
    root = scale[:, None] * (vectors * roots)  # J = U Uᵀ
    back = (vectors * inverse) / scale[:, None]  # δU = δJ · back, where U has a range
    projection = scale[:, None] * (vectors[:, kept] @ vectors[:, kept].T) / scale[None, :]
    return root, back, projection
