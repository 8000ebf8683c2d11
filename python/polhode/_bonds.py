"""Bonds of a molecule: which atoms they join, what is beyond each, and what their lengths do to positions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode import _core
from polhode._extras import require
from polhode._nuclides import names_of
from polhode._variables import of_forms
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import ArrayLike, NDArray

    from polhode._nuclides import Isotope
    from polhode._variables import Form

    Floats = NDArray[np.float64]

__all__ = ["bonds", "uncertain_positions"]

_MARGIN: Final = 0.45
"""Angstrom by which bonded atoms may be farther apart than the sum of their radii."""
_BLOCK: Final = 1 << 20
"""Pairs that are looked at together."""


def bonds(labels: Sequence[str | Isotope], positions: ArrayLike) -> list[tuple[int, int]]:
    """Find bonded atoms by their distances.

    Parameters
    ----------
    labels : sequence of str or Isotope
        Labels as for :func:`isotopes`, or the list that it returned.
    positions : array_like, shape (n, 3)
        Positions of the atoms, in angstrom.

    Returns
    -------
    list of tuple of int
        Pairs of indices, in ascending order. Two atoms are bonded if their distance is less than the sum of
        their covalent radii (Cordero et al., Dalton Trans. 2008, 2832) plus 0.45 angstrom, the margin of Open
        Babel.

    Raises
    ------
    PolhodeError
        If a label names no nuclide, or an element whose radius is not tabulated.
    ModuleNotFoundError
        If periodictable is not installed.

    Examples
    --------
    >>> from polhode.molecules import bonds
    >>> bonds(["O", "H", "H"], [(0, 0, 0), (0.757, 0, 0.587), (-0.757, 0, 0.587)])
    [(0, 1), (0, 2)]
    """
    table = require("periodictable", extra="chem", purpose="reading covalent radii").elements
    radii = []
    for name in names_of(labels):
        radius = table.symbol(name.lstrip("0123456789")).covalent_radius
        if radius is None:
            raise PolhodeError(f"labels: no covalent radius of {name} is on record; state the bonds")
        radii.append(float(radius))
    return _bonded(np.array(radii), _places(positions, len(radii)))


def uncertain_positions(
    labels: Sequence[str | Isotope],
    positions: ArrayLike,
    sigma: ArrayLike,
    bonds: ArrayLike | None = None,
) -> _core.Uncertain:
    """Positions of atoms whose bond lengths are uncertain.

    Each bond length has its own independent error. If the length of a bond (i, j) changes, the part of the
    molecule with atom j moves along the bond, and all angles stay the same. If the other part moved instead,
    the moments about the centre of mass would be the same.

    Parameters
    ----------
    labels : sequence of str or Isotope
        Labels as for :func:`isotopes`, or the list that it returned.
    positions : array_like, shape (n, 3)
        Positions of the atoms: in angstrom if `bonds` is not given, else in any unit.
    sigma : array_like, shape () or (bonds,)
        Standard deviation of the length of each bond, in the unit of the positions.
    bonds : array_like of int, shape (bonds, 2), optional
        Pairs of indices; by default those that :func:`bonds` finds. The relative position of parts without a
        bond between them is taken as exact.

    Returns
    -------
    Uncertain, shape (n, 3)
        For :meth:`polhode.RigidBody.from_particles`.

    Raises
    ------
    PolhodeError
        If a bond whose length is uncertain is part of a ring, since it cannot be stretched alone.

    Examples
    --------
    >>> from polhode import RigidBody
    >>> from polhode.molecules import isotopes, uncertain_positions
    >>> atoms = isotopes(["O", "H", "H"])
    >>> water = [(0, 0, 0), (0.757, 0, 0.587), (-0.757, 0, 0.587)]
    >>> body = RigidBody.from_particles([a.mass for a in atoms], uncertain_positions(atoms, water, 0.003))
    >>> body.sigma.principal_moments.round(5)
    array([0.00273, 0.00512, 0.00785])
    """
    names = names_of(labels)
    places = _places(positions, len(names))
    pairs = _found(labels, places) if bonds is None else bonds
    steps = _moved_along(names, places, pairs, np.asarray(_core.real_numbers(sigma, "sigma")))
    forms: list[Form] = [[] for _ in range(places.size)]
    for step in steps:  # what one sigma of one bond does to each coordinate
        ((variable, _),) = _core.Uncertain(0.0, 1.0)._forms()[0]
        for place in np.flatnonzero(step).tolist():
            forms[place].append((variable, float(step.flat[place])))
    return of_forms(places, forms)


_found = bonds  # beside a parameter of that name


def _places(positions: ArrayLike, atoms: int) -> Floats:
    places = np.array(_core.real_numbers(positions, "positions"))
    if places.shape != (atoms, 3):
        message = f"positions: expected shape ({atoms}, 3) for {atoms} labels, got {places.shape}"
        raise ValueError(message)
    if not np.isfinite(places).all():
        raise PolhodeError("positions: expected finite coordinates")
    return places


def _bonded(radii: Floats, positions: Floats) -> list[tuple[int, int]]:
    """Pairs of atoms that are nearer than the sum of their covalent radii and a margin.

    Parameters
    ----------
    radii : numpy.ndarray, shape (n,)
        In angstrom.
    positions : numpy.ndarray, shape (n, 3)
        In angstrom.
    """
    count = len(radii)
    found: list[tuple[int, int]] = []
    rows = max(1, _BLOCK // max(count, 1))
    for first in range(0, count, rows):
        some = np.arange(first, min(first + rows, count))
        distances = np.linalg.norm(positions[some, None] - positions, axis=-1)
        near = distances < radii[some, None] + radii + _MARGIN
        near &= np.arange(count) > some[:, None]
        found += [(int(some[i]), int(j)) for i, j in np.argwhere(near)]
    return found


def _moved_along(
    names: Sequence[str], positions: Floats, bonds: ArrayLike, sigma: Floats
) -> Iterator[Floats]:
    """Tell for each bond whose length is uncertain what one sigma of it does to the positions.

    Parameters
    ----------
    names : sequence of str
        Of the atoms; for errors.
    positions : numpy.ndarray, shape (n, 3)
        Of the atoms.
    bonds : array_like of int, shape (bonds, 2)
        Pairs of indices; the part with the second atom moves.
    sigma : numpy.ndarray, shape () or (bonds,)
        Of the lengths.

    Yields
    ------
    numpy.ndarray, shape (n, 3)
        In the order of the bonds; none for a sigma of zero.
    """
    pairs = _checked(names, bonds)
    if sigma.shape not in ((), (len(pairs),)):
        message = f"sigma: expected one or one for each of {len(pairs)} bonds, got shape {sigma.shape}"
        raise ValueError(message)
    if not (np.isfinite(sigma).all() and (sigma >= 0.0).all()):
        raise PolhodeError("sigma: expected finite standard deviations of 0 or more")
    neighbours: list[list[int]] = [[] for _ in names]
    for i, j in pairs:
        neighbours[i].append(j)
        neighbours[j].append(i)
    for (i, j), deviation in zip(pairs, np.broadcast_to(sigma, len(pairs)).tolist(), strict=True):
        if deviation == 0.0:
            continue
        along = positions[j] - positions[i]
        length = float(np.linalg.norm(along))
        if not 0.0 < length < np.inf:
            raise PolhodeError(
                f"bonds: {_bond(names, i, j)} has the length {length:g} and no direction; check the positions"
            )
        step = np.zeros_like(positions)
        step[_beyond(names, neighbours, i, j)] = deviation * along / length
        yield step


def _checked(names: Sequence[str], bonds: ArrayLike) -> list[tuple[int, int]]:
    array = np.asarray(_core.real_numbers(bonds, "bonds"))
    if array.size == 0:
        return []
    if array.ndim != 2 or array.shape[1] != 2:
        message = f"bonds: expected pairs of indices of atoms, shape (n, 2), got {array.shape}"
        raise ValueError(message)
    if not (np.isfinite(array).all() and (array == np.floor(array)).all()):
        raise PolhodeError("bonds: expected whole numbers as indices of atoms")
    pairs: list[tuple[int, int]] = []
    known: set[frozenset[int]] = set()
    for i, j in ((int(one), int(other)) for one, other in array.tolist()):
        for end in (i, j):
            if not 0 <= end < len(names):
                raise PolhodeError(
                    f"bonds: there is no atom {end} in ({i}, {j}); give atoms from 0 to {len(names) - 1}"
                )
        if i == j:
            raise PolhodeError(f"bonds: ({i}, {j}) joins an atom to itself; leave it out")
        if frozenset((i, j)) in known:
            raise PolhodeError(f"bonds: ({i}, {j}) stands twice; leave one of them out")
        known.add(frozenset((i, j)))
        pairs.append((i, j))
    return pairs


def _beyond(names: Sequence[str], neighbours: list[list[int]], i: int, j: int) -> list[int]:
    """Give the atoms that hang on j when its bond to i is cut."""
    came_from = {j: i}
    rest = [j]
    while rest:
        here = rest.pop()
        for there in neighbours[here]:
            if here == j and there == i:
                continue
            if there == i:
                ring = [i, here]
                while ring[-1] != j:
                    ring.append(came_from[ring[-1]])
                _refuse_ring(names, i, j, ring)
            if there not in came_from:
                came_from[there] = here
                rest.append(there)
    return list(came_from)


def _refuse_ring(names: Sequence[str], i: int, j: int, ring: list[int]) -> None:
    way = " ".join(f"{names[atom]}({atom})" for atom in ring[:8]) + (" ..." if len(ring) > 8 else "")
    raise PolhodeError(
        f"bonds: {_bond(names, i, j)} is in a ring of {len(ring)} atoms, {way}, and cannot be stretched "
        "alone; give it a sigma of 0, or give positions with a covariance of their own: "
        "Uncertain(positions, covariance=...)"
    )


def _bond(names: Sequence[str], i: int, j: int) -> str:
    return f"the bond ({i}, {j}) from {names[i]} to {names[j]}"
