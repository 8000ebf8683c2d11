"""Bodies of labelled particles that come in chunks: haloes, fragments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode._core import MassAccumulator, RigidBody, real_numbers
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["LabelledMassAccumulator"]

_NO_BODY: Final = -1
"""The label of particles that belong to no body."""


class LabelledMassAccumulator:
    """Bodies from labelled particles in chunks: for data larger than memory, or on many machines.

    A body consists of the particles with its label in all chunks, in the order in which they were added.
    Particles that fit into memory need one call: :meth:`polhode.RigidBody.from_labelled_particles`.

    Examples
    --------
    >>> from polhode import LabelledMassAccumulator
    >>> particles = LabelledMassAccumulator()
    >>> particles.add([1, 2], [(0, 0, 0), (5, 0, 0)], [4, 1007])
    >>> particles.add([3, 2, 7], [(4, 0, 0), (5, 2, 0), (9, 9, 9)], [4, 1007, -1])
    >>> labels, bodies = particles.finish()
    >>> labels
    array([   4, 1007])
    >>> bodies.principal_moments
    array([[ 0., 12., 12.],
           [ 0.,  4.,  4.]])
    """

    def __init__(self) -> None:
        self._sums: dict[int, MassAccumulator] = {}

    def __len__(self) -> int:
        """Count the labels so far."""
        return len(self._sums)

    def __repr__(self) -> str:
        return f"<LabelledMassAccumulator of {len(self)} labels>"

    def add(self, masses: ArrayLike, positions: ArrayLike, labels: ArrayLike) -> None:
        """Add particles.

        Parameters
        ----------
        masses : array_like, shape (n,)
            Masses of the particles; none negative.
        positions : array_like, shape (n, 3)
        labels : array_like of int, shape (n,)
            Whole numbers; -1 for particles that belong to no body.
        """
        weights, places = real_numbers(masses, "masses"), real_numbers(positions, "positions")
        own = np.asarray(labels) if np.size(labels) else np.empty(np.shape(labels), np.int64)
        if own.dtype.kind not in "iu":
            raise TypeError(f"labels: expected integers, got dtype {own.dtype}")
        if weights.ndim != 1 or places.shape != (*weights.shape, 3) or own.shape != weights.shape:
            raise ValueError(
                "masses, positions, labels: expected shapes (n,), (n, 3) and (n,), got "
                f"{weights.shape}, {places.shape} and {own.shape}"
            )
        order = np.argsort(own, kind="stable")
        names, starts = np.unique(own[order], return_index=True)
        if names.size and names[-1] > np.iinfo(np.int64).max:
            raise ValueError(
                f"labels: {names[-1]} is beyond the whole numbers of 64 bits; "
                "number the bodies by smaller ones"
            )
        for name, part in zip(names.tolist(), np.split(order, starts[1:]), strict=True):
            if name != _NO_BODY:
                self._sums.setdefault(name, MassAccumulator()).add(weights[part], places[part])

    def merge(self, other: LabelledMassAccumulator) -> None:
        """Add the particles of another accumulator, as if they were added after those here.

        Parameters
        ----------
        other : LabelledMassAccumulator
        """
        for name, found in other._sums.items():
            self._sums.setdefault(name, MassAccumulator()).merge(found)

    def finish(self) -> tuple[NDArray[np.int64], RigidBody]:
        """Return the bodies of all labels so far; more particles may be added afterwards.

        Returns
        -------
        labels : numpy.ndarray of int, shape (k,)
            Ascending.
        bodies : RigidBody
            A stack of shape (k,).
        """
        names = sorted(self._sums)
        if not names:
            return np.empty(0, np.int64), RigidBody.from_labelled_particles([], np.empty((0, 3)), [])
        found = []
        for name in names:
            try:
                found.append(self._sums[name].finish())
            except PolhodeError as error:
                error.args = (f"label {name}: ", *error.args)
                raise
        return np.array(names, np.int64), RigidBody.stack(found)
