"""Bodies from particles with labels, where the labels are any whole numbers: haloes, fragments.

:meth:`polhode.RigidBody.from_labelled_particles` takes the labels 0, 1, 2, … without gaps and gives a stack
whose row is the label. The functions here allow labels with gaps and particles in chunks; their result
contains the labels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._core import MassAccumulator, RigidBody, real_numbers
from polhode._format import short
from polhode.errors import PolhodeError
from polhode.units import metres_per

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray

    Integers = NDArray[np.int64]

__all__ = ["Accumulator", "Labelled", "bodies"]

_NO_BODY: Final = -1
"""The label of particles that belong to none."""


class Labelled(NamedTuple):
    """Bodies and their labels.

    Attributes
    ----------
    labels : numpy.ndarray of int, shape (n,)
        Ascending.
    bodies : RigidBody
        A stack of shape (n,).
    """

    labels: Integers
    bodies: RigidBody

    def __repr__(self) -> str:
        return short(self)

    @staticmethod
    def from_file(path: str | PathLike[str], *, density: Any, length_unit: str | None = None) -> Labelled:
        """Read a segmented image: a body for each label, all in one pass.

        Parameters
        ----------
        path : str or os.PathLike
            NIfTI, NRRD (extra ``image``) or NumPy's ``.npy``; see :func:`polhode.images.read_image`.
        density : float or mapping
            As of :meth:`polhode.RigidBody.from_labelled_voxels`: one number for all labels but 0, or
            ``{label: number}``, where ``"*"`` stands for all others.
        length_unit : str, optional
            Unit of lengths where the file states none. They are converted to metres.

        Returns
        -------
        Labelled
        """
        from polhode.io.images import bodies_of_labels, read_image, unit_of
        from polhode.io.mesh_solid import naming_file

        image = read_image(path)
        unit = unit_of(image, path, length_unit)
        affine = image.affine.copy()
        affine[:3] *= 1.0 if unit is None else metres_per(unit)
        with naming_file(path):
            return Labelled(*bodies_of_labels(image.values, density, None, None, affine))


def bodies(masses: ArrayLike, positions: ArrayLike, labels: ArrayLike) -> Labelled:
    """Make a body of the particles of each label; labels may have gaps.

    Parameters
    ----------
    masses : array_like, shape (n,)
        Masses of the particles; none negative, the sum positive for each label.
    positions : array_like, shape (n, 3)
    labels : array_like of int, shape (n,)
        Whole numbers; -1 for particles that belong to no body.

    Returns
    -------
    Labelled

    Examples
    --------
    >>> from polhode import labelled
    >>> positions = [(0, 0, 0), (5, 0, 0), (4, 0, 0), (5, 2, 0), (9, 9, 9)]
    >>> found = labelled.bodies([1, 2, 3, 2, 7], positions, [4, 1007, 4, 1007, -1])
    >>> found.labels
    array([   4, 1007])
    >>> found.bodies.mass
    array([4., 4.])
    """
    weights, places, own = _check_particles(masses, positions, labels)
    names, rows = _ranks(own)
    try:
        return Labelled(names, RigidBody.from_labelled_particles(weights, places, rows))
    except PolhodeError as error:
        if error.label is not None:  # it is the rank that is told
            error.label = int(names[error.label])
            error.args = (error.args[0], error.label, *error.args[2:])
        raise


class Accumulator:
    """Bodies from labelled particles in chunks: for data larger than memory, or on many machines.

    A body consists of the particles with its label in all chunks, in the order in which they were added.

    Examples
    --------
    >>> from polhode import labelled
    >>> chunks = labelled.Accumulator()
    >>> chunks.add([1, 2], [(0, 0, 0), (5, 0, 0)], [4, 1007])
    >>> chunks.add([3, 2, 7], [(4, 0, 0), (5, 2, 0), (9, 9, 9)], [4, 1007, -1])
    >>> chunks.finish().bodies.principal_moments
    array([[ 0., 12., 12.],
           [ 0.,  4.,  4.]])
    """

    def __init__(self) -> None:
        self._sums: dict[int, MassAccumulator] = {}

    def __len__(self) -> int:
        """Count the labels so far."""
        return len(self._sums)

    def add(self, masses: ArrayLike, positions: ArrayLike, labels: ArrayLike) -> None:
        """Add particles.

        Parameters
        ----------
        masses, positions, labels : array_like
            As of :func:`bodies`.
        """
        weights, places, own = _check_particles(masses, positions, labels)
        order = np.argsort(own, kind="stable")
        names, starts = np.unique(own[order], return_index=True)
        for name, part in zip(names.tolist(), np.split(order, starts[1:]), strict=True):
            if name != _NO_BODY:
                self._sums.setdefault(name, MassAccumulator()).add(weights[part], places[part])

    def merge(self, other: Accumulator) -> None:
        """Add the particles of another accumulator, as if they were added after those here.

        Parameters
        ----------
        other : Accumulator
        """
        for name, found in other._sums.items():
            self._sums.setdefault(name, MassAccumulator()).merge(found)

    def finish(self) -> Labelled:
        """Return the bodies of all labels so far; more particles may be added afterwards.

        Returns
        -------
        Labelled
        """
        names = sorted(self._sums)
        if not names:
            empty = np.zeros((0, 3))
            return Labelled(np.empty(0, np.int64), RigidBody.from_labelled_particles([], empty, []))
        found = []
        for name in names:
            try:
                found.append(self._sums[name].finish())
            except PolhodeError as error:
                error.args = (f"label {name}: ", *error.args)
                raise
        return Labelled(np.array(names, np.int64), RigidBody.stack(found))


def _check_particles(
    masses: ArrayLike, positions: ArrayLike, labels: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], Integers]:
    weights, places = real_numbers(masses, "masses"), real_numbers(positions, "positions")
    own = np.asarray(labels)
    if own.size == 0:
        own = own.astype(np.int64)
    if own.dtype.kind not in "iu":
        raise TypeError(f"labels: expected whole numbers, got {own.dtype}")
    if weights.ndim != 1 or places.shape != (*weights.shape, 3) or own.shape != weights.shape:
        raise ValueError(
            "masses, positions, labels: expected shapes (n,), (n, 3) and (n,), got "
            f"{weights.shape}, {places.shape} and {own.shape}"
        )
    if own.dtype.kind == "u" and own.size and int(own.max()) > np.iinfo(np.int64).max:
        raise ValueError(f"labels: {own.max()} is beyond the whole numbers of 64 bits")
    return weights, places, own.astype(np.int64)


def _ranks(labels: Integers) -> tuple[Integers, Integers]:
    """Return the labels that name a body, ascending, and for each particle the rank of its own."""
    names, ranks = np.unique(labels, return_inverse=True)
    ranks = ranks.reshape(labels.shape).astype(np.int64)
    none = np.searchsorted(names, _NO_BODY)
    if none < len(names) and names[none] == _NO_BODY:
        ranks = np.where(ranks == none, _NO_BODY, ranks - (ranks > none))
        names = np.delete(names, none)
    return names, ranks
