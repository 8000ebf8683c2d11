"""Bonds of a molecule: the atoms that they join, also in a cell, and positions with uncertain lengths."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._optional import require
from polhode.errors import PolhodeError
from polhode.molecules.nuclides import names_of
from polhode.uncertainty.variables import of_forms

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import ArrayLike, NDArray

    from polhode.molecules.nuclides import Isotope
    from polhode.uncertainty.variables import Form

    Floats = NDArray[np.float64]

__all__ = ["CellBond", "CellCrossings", "bonds", "cell_crossings", "crossings_of", "uncertain_positions"]

_MARGIN: Final = 0.45
"""Angstrom by which bonded atoms may be farther apart than the sum of their radii."""
_BLOCK: Final = 1 << 20
"""Pairs that are looked at together."""
_LEAST_HEIGHT: Final = 1.0
"""Angstrom between opposite sides of a cell; atoms are larger, so that no crystal has less."""
_MOST_DENSE: Final = 1.0
"""Atoms in a cubic angstrom about an atom, on average. Diamond, the densest of solids by number, has 0.18."""
_SPREAD: Final = 0.5
"""Atoms cross a side if through it they extend over less than this share of their extent as they stand."""
_NAMED: Final = 8
"""Most bonds that a note names."""


class CellBond(NamedTuple):
    """A bond through a side of a cell.

    Attributes
    ----------
    first, second : int
        Indices of the atoms.
    shift : tuple of int
        How often each vector of the cell has to be added to the position of the second atom: it then stands
        beside the first.
    """

    first: int
    second: int
    shift: tuple[int, ...]


class CellCrossings(NamedTuple):
    """Bonds and fragments that cross the sides of a cell; see :func:`cell_crossings`.

    Attributes
    ----------
    bonds : tuple of CellBond
        Bonds between an atom and an image of another, or of itself, by a vector of the cell.
    fragments : int
        Number of molecules, joined by bonds, as the atoms stand.
    fragments_joined : int
        The same, if bonds through the sides join them too.
    is_endless : bool
        Whether a fragment is bonded to its own image, as a crystal or a polymer: it cannot be made whole.
    extents : tuple of float
        How far the atoms extend along each vector of the cell, as they stand, in units of the vector.
    least_extents : tuple of float
        The same where each atom is at that of its images that makes this the least.
    """

    bonds: tuple[CellBond, ...]
    fragments: int
    fragments_joined: int
    is_endless: bool
    extents: tuple[float, ...]
    least_extents: tuple[float, ...]

    @property
    def crossed(self) -> tuple[bool, ...]:
        """Whether the atoms are two groups along each vector of the cell that are one group through its side.

        They do if they extend over less than half as much there.
        """
        return tuple(
            extent > _SPREAD and least < _SPREAD * extent  # the former but for rounding follows
            for extent, least in zip(self.extents, self.least_extents, strict=True)
        )

    @property
    def is_whole(self) -> bool:
        """Whether neither bonds nor fragments cross a side."""
        return not self.bonds and not any(self.crossed)


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
    radii = _radii(labels)
    first, second = _near_pairs(radii, _places(positions, len(radii)))
    return sorted(zip(first.tolist(), second.tolist(), strict=True))


def cell_crossings(labels: Sequence[str | Isotope], positions: ArrayLike, cell: ArrayLike) -> CellCrossings:
    """Find bonds that cross the sides of a cell, and fragments that a side cuts.

    A program that keeps atoms within a cell cuts a molecule at its sides. The mass stays right, but the
    centre of mass and the moments are then those of the pieces.

    Parameters
    ----------
    labels : sequence of str or Isotope
        Labels as for :func:`isotopes`, or the list that it returned.
    positions : array_like, shape (n, 3)
        Positions of the atoms, in angstrom.
    cell : array_like, shape (k, 3)
        One to three vectors by which the structure repeats, in angstrom: `cell` of a
        :class:`polhode.io.Molecule`, or ``atoms.cell[atoms.pbc]`` in ASE.

    Returns
    -------
    CellCrossings

    Raises
    ------
    PolhodeError
        If the vectors are no cell or the atoms are nearer to each other than atoms can be; or as
        :func:`bonds`.
    ModuleNotFoundError
        If periodictable is not installed.

    Examples
    --------
    >>> from polhode.molecules import cell_crossings
    >>> found = cell_crossings(["H", "H"], [(9.63, 5, 5), (0.37, 5, 5)], [(10, 0, 0), (0, 10, 0), (0, 0, 10)])
    >>> found.bonds
    (CellBond(first=0, second=1, shift=(1, 0, 0)),)
    >>> found.fragments, found.fragments_joined
    (2, 1)
    """
    radii = _radii(labels)
    places = _places(positions, len(radii))
    vectors, fractions = _in_cell(places, cell)
    inside = fractions - np.floor(fractions)
    turns = np.floor(fractions).astype(np.int64)
    # An atom's images near the cell, as far as the longest bond reaches.
    reach = (2.0 * float(radii.max(initial=0.0)) + _MARGIN) / _heights(vectors)
    homes, shifts = [np.arange(len(places))], [np.zeros_like(turns)]
    for shift in product(*(range(-int(np.ceil(r)), int(np.ceil(r)) + 1) for r in reach)):
        if any(shift):
            moved = inside + shift
            near = np.flatnonzero(((moved > -reach) & (moved < 1.0 + reach)).all(axis=-1))
            homes.append(near)
            shifts.append(np.broadcast_to(np.array(shift), (len(near), len(vectors))))
    home, shift_of = np.concatenate(homes), np.concatenate(shifts)
    moved = places[home] + (shift_of - turns[home]) @ vectors
    first, second = _near_pairs(radii[home], moved, of_first=len(places))
    # The image of `second` by the whole vectors `by` is bonded to `first` as it stands. Each bond is written
    # from the smaller index, and that of an atom with its own image with a positive vector first.
    by = (shift_of - turns[home])[second] - (shift_of - turns[home])[first]
    first, second = home[first], home[second]
    leading: NDArray[np.int64] = np.take_along_axis(by, np.argmax(by != 0, axis=-1)[:, None], axis=-1)[:, 0]
    swapped = (first > second) | ((first == second) & (leading < 0))
    by = np.where(swapped[:, None], -by, by)
    lower, upper = np.minimum(first, second).tolist(), np.maximum(first, second).tolist()
    found = sorted({(i, j, tuple(row)) for i, j, row in zip(lower, upper, by.tolist(), strict=True)})
    across = tuple(CellBond(i, j, by) for i, j, by in found if any(by))
    inner = [CellBond(i, j, by) for i, j, by in found if not any(by)]
    joined, is_endless = _fragments(len(places), [*inner, *across])
    extents = np.ptp(fractions, axis=0) if len(places) else np.zeros(len(vectors))
    ring = np.sort(inside, axis=0)
    gaps = np.diff(ring, axis=0, append=ring[:1] + 1.0)
    least = np.minimum(1.0 - gaps.max(axis=0), extents) if len(places) else extents
    return CellCrossings(
        across,
        _fragments(len(places), inner)[0],
        joined,
        is_endless,
        tuple(extents.tolist()),
        tuple(least.tolist()),
    )


def crossings_of(
    labels: Sequence[str | Isotope], positions: ArrayLike, cell: ArrayLike
) -> tuple[CellCrossings | None, list[str]]:
    """Find what crosses a cell, None where that cannot be found, with words for whoever reads the moments."""
    try:
        found = cell_crossings(labels, positions, cell)
    except PolhodeError as error:
        return None, [f"what crosses the sides of the cell was not looked for: {error}"]
    notes = []
    if found.bonds:
        names = names_of(labels)
        said = ", ".join(f"{names[i]}({i + 1})-{names[j]}({j + 1})" for i, j, _ in found.bonds[:_NAMED])
        said += f" and {len(found.bonds) - _NAMED} more" if len(found.bonds) > _NAMED else ""
        count = f"{len(found.bonds)} bonds cross" if len(found.bonds) > 1 else "1 bond crosses"
        if found.is_endless:
            effect = "the structure goes on without end, as a crystal, and has no moments as a whole"
        else:
            effect = (
                f"as they stand the atoms are {found.fragments} pieces instead of {found.fragments_joined}, "
                "which makes centre and moments wrong; move atoms by whole vectors of the cell first"
            )
        notes.append(f"{count} a side of the cell, {said}: {effect}")
    elif any(found.crossed):
        along = ", ".join(
            f"{least:.3g} instead of {extent:.3g} of vector {number}"
            for number, (extent, least, is_crossed) in enumerate(
                zip(found.extents, found.least_extents, found.crossed, strict=True), start=1
            )
            if is_crossed
        )
        notes.append(
            f"the atoms stand together only through a side of the cell, over {along}: centre and moments are "
            "those of the pieces as they stand; move atoms by whole vectors of the cell first"
        )
    return found, notes


def _in_cell(places: Floats, cell: ArrayLike) -> tuple[Floats, Floats]:
    """Check the vectors of a cell; return them and the atoms' coordinates along them."""
    vectors = np.array(_core.real_numbers(cell, "cell"))
    if vectors.ndim != 2 or vectors.shape[-1] != 3 or not 1 <= len(vectors) <= 3:
        message = f"cell: expected one to three vectors, shape (k, 3), got {vectors.shape}"
        raise ValueError(message)
    with np.errstate(all="ignore"):  # what overflows is no cell, or too far away
        lengths = np.linalg.norm(vectors, axis=-1)
        scaled = vectors / np.maximum(lengths, 1e-300)[:, None]
        if not np.isfinite(lengths).all() or np.linalg.matrix_rank(scaled) < len(vectors):
            raise PolhodeError(
                "cell: its vectors do not span a cell; correct them, or leave out those that are none"
            )
        least = lengths.min()
        least = least if least < _LEAST_HEIGHT else _heights(vectors).min()
        if not least >= _LEAST_HEIGHT:
            raise PolhodeError(
                f"cell: opposite sides are {least:.3g} angstrom apart, less than an atom; check the unit"
            )
        fractions = places @ _inverse(vectors)
    if not (np.abs(fractions) < 1e9).all():
        raise PolhodeError("positions: an atom is more than 1e9 cells away; check the unit")
    return vectors, fractions


def _heights(vectors: Floats) -> Floats:
    """Return the distances between opposite sides of a cell."""
    heights: Floats = 1.0 / np.linalg.norm(_inverse(vectors), axis=0)
    return heights


def _inverse(vectors: Floats) -> Floats:
    """Return the pseudo-inverse of independent vectors, however different their lengths are."""
    lengths = np.linalg.norm(vectors, axis=-1)
    inverse: Floats = np.linalg.pinv(vectors / lengths[:, None]) / lengths
    return inverse


def _fragments(count: int, pairs: Sequence[CellBond]) -> tuple[int, bool]:
    """Count the fragments of bonded atoms; also return whether one is bonded to its own image."""
    neighbours: list[list[tuple[int, tuple[int, ...]]]] = [[] for _ in range(count)]
    for i, j, shift in pairs:
        neighbours[i].append((j, shift))
        neighbours[j].append((i, tuple(-s for s in shift)))
    shift_of: dict[int, tuple[int, ...]] = {}
    parts, is_endless = 0, False
    for start in range(count):
        if start in shift_of:
            continue
        parts += 1
        shift_of[start] = ()
        rest = [start]
        while rest:
            here = rest.pop()
            for there, step in neighbours[here]:
                shift = tuple(a + b for a, b in zip(shift_of[here] or (0,) * len(step), step, strict=True))
                if there not in shift_of:
                    shift_of[there] = shift
                    rest.append(there)
                elif shift != (shift_of[there] or (0,) * len(step)):
                    is_endless = True
    return parts, is_endless


def _radii(labels: Sequence[str | Isotope]) -> Floats:
    """Look up covalent radii, in angstrom."""
    table = require("periodictable", extra="chem", purpose="reading covalent radii").elements
    radii: dict[str, float] = {}
    names = names_of(labels)
    for name in dict.fromkeys(names):
        radius = table.symbol(name.lstrip("0123456789")).covalent_radius
        if radius is None:
            raise PolhodeError(f"labels: no covalent radius of {name} is on record; state the bonds")
        radii[name] = float(radius)
    return np.array([radii[name] for name in names])


def uncertain_positions(
    labels: Sequence[str | Isotope],
    positions: ArrayLike,
    sigma: ArrayLike,
    bonds: ArrayLike | None = None,
) -> _core.Uncertain:
    """Return the positions of atoms whose bond lengths are uncertain.

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
    pairs = _bonds_of(labels, places) if bonds is None else bonds
    steps = _moved_along(names, places, pairs, np.asarray(_core.real_numbers(sigma, "sigma")))
    forms: list[Form] = [[] for _ in range(places.size)]
    for step in steps:  # what one sigma of one bond does to each coordinate
        ((variable, _),) = _core.Uncertain(0.0, 1.0)._forms()[0]
        for place in np.flatnonzero(step).tolist():
            forms[place].append((variable, float(step.flat[place])))
    return of_forms(places, forms)


_bonds_of = bonds  # beside a parameter of that name


def _places(positions: ArrayLike, atoms: int) -> Floats:
    places = np.array(_core.real_numbers(positions, "positions"))
    if places.shape != (atoms, 3):
        message = f"positions: expected shape ({atoms}, 3) for {atoms} labels, got {places.shape}"
        raise ValueError(message)
    if not np.isfinite(places).all():
        raise PolhodeError("positions: expected finite coordinates")
    return places


def _near_pairs(
    radii: Floats, positions: Floats, of_first: int | None = None
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find pairs of atoms that are nearer than the sum of their covalent radii and a margin.

    The atoms are sorted into boxes as wide as the longest bond, so that each meets those of 27 boxes alone.

    Parameters
    ----------
    radii : numpy.ndarray, shape (n,)
        In angstrom.
    positions : numpy.ndarray, shape (n, 3)
        In angstrom.
    of_first : int, optional
        Only pairs with one of so many first atoms, which stand in a cell; the others are their images. Atoms
        that are too near to be any are then refused.

    Returns
    -------
    first, second : numpy.ndarray of int
        Each pair once, the smaller index first.
    """
    count = len(radii)
    found: list[NDArray[np.int64]] = [np.empty((0, 2), np.int64)]
    if count == 0:
        return found[0][:, 0], found[0][:, 1]
    width = 2.0 * float(radii.max()) + _MARGIN
    boxes = np.floor(positions / width)
    # Numbers of boxes without the empty ones, of which two stand for any number between others.
    codes = np.zeros(count, np.int64)
    base = 2 * count + 4
    for axis in range(3):
        used, place = np.unique(boxes[:, axis], return_inverse=True)
        with np.errstate(over="ignore"):
            steps = np.minimum(np.diff(used), 2.0)
        numbers = 1 + np.concatenate([[0], np.cumsum(steps)]).astype(np.int64)
        codes = codes * base + numbers[place]
    order = np.argsort(codes, kind="stable")
    ordered = codes[order]
    asking = np.arange(count if of_first is None else of_first)
    neighbours = 0
    for x, y, z in product((-1, 0, 1), repeat=3):
        target = codes[asking] + (x * base + y) * base + z
        begins = np.searchsorted(ordered, target, "left")
        counts = np.searchsorted(ordered, target, "right") - begins
        neighbours += int(counts.sum())
        if of_first is not None and neighbours > _MOST_DENSE * 27.0 * width**3 * len(asking):
            raise PolhodeError("positions: atoms are nearer to each other than atoms can be; check the unit")
        ends = np.cumsum(counts)
        at = 0
        while at < len(asking):  # as many atoms as have a block of neighbours, one at least
            done = int(ends[at - 1]) if at else 0
            to = max(at + 1, int(np.searchsorted(ends, done + _BLOCK, "right")))
            number = counts[at:to]
            i = np.repeat(asking[at:to], number)
            offsets = np.arange(len(i)) - np.repeat(np.cumsum(number) - number, number)
            j = order[np.repeat(begins[at:to], number) + offsets]
            with np.errstate(over="ignore"):
                distances = np.linalg.norm(positions[i] - positions[j], axis=-1)
            near = (i < j) & (distances < radii[i] + radii[j] + _MARGIN)
            found.append(np.stack([i[near], j[near]], axis=-1))
            at = to
    pairs = np.concatenate(found)
    return pairs[:, 0], pairs[:, 1]


def _moved_along(
    names: Sequence[str], positions: Floats, bonds: ArrayLike, sigma: Floats
) -> Iterator[Floats]:
    """For each bond of uncertain length: compute the change of all positions by one sigma of the length.

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
    pairs = _check_bonds(names, bonds)
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


def _check_bonds(names: Sequence[str], bonds: ArrayLike) -> list[tuple[int, int]]:
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
    """Return the atoms connected to j after the bond from i to j is cut."""
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
