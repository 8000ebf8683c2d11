"""The parts of a ledger: rows of a table as bodies, with the errors of their ten numbers."""

from __future__ import annotations

from itertools import repeat
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from polhode._core import RigidBody
from polhode.errors import InvalidInertiaError, PolhodeError
from polhode.uncertainty._rollup import NUMBERS, own_moment, shift
from polhode.uncertainty._shapes import shape_rows

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode.uncertainty._table import Table

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

__all__ = ["COLUMNS", "SIGMAS", "Parts", "bodies_of", "read_parts"]

SIGMAS: Final = tuple(f"sigma_{name}" for name in NUMBERS)
_OWN: Final = (*NUMBERS, *SIGMAS, "growth", "density", "sigma_density")
"""What the row of a part states in numbers; that of a node with children must not."""
COLUMNS: Final = (
    "id", "parent", "name", "comment", *_OWN,
    "POIconv", "Ipoint", "about", "source", "file", "solid", "arguments", "predicted_mass",
)  # fmt: skip
"""The columns of a ledger's table. `predicted_mass` is what `Ledger.to_csv` adds; it is computed anew."""

_PLUS: Final = 1
_SIGNS: Final = {"": 0, "+": _PLUS, "-": 2}
_CHUNK: Final = 4096
"""Bodies that are made at once."""
_ABOUT: Final = ("", "center_of_mass", "com", "origin")


class Parts(NamedTuple):
    """What the table says of its leaves, by row; rows with children hold nothing of use.

    Attributes
    ----------
    mass, center, inertia : numpy.ndarray
        Shapes (n,), (3, n), (6, n); tensors about the own centre, as elements.
    growth : numpy.ndarray
        Mass growth allowance as a fraction, shape (n,).
    sigma : numpy.ndarray
        Standard deviations as they are stated, shape (10, n); zero where none is.
    correlated : (numpy.ndarray, numpy.ndarray)
        Leaves whose ten errors are not independent, and the effect of each of their ten draws (second index)
        on z, shape (10, 10, number of them).
    source : list of str
        "" for a part whose draws are its own; empty where there is no other.
    unstated : int
        How many leaves state no sigma at all.
    opposite_signs : dict of str to tuple of str
        Sources with products of inertia of both signs, and these numbers; see `Ledger`.
    """

    mass: Floats
    center: Floats
    inertia: Floats
    growth: Floats
    sigma: Floats
    correlated: tuple[Integers, Floats]
    source: list[str]
    unstated: int
    opposite_signs: dict[str, tuple[str, ...]]


def read_parts(
    table: Table,
    is_leaf: NDArray[np.bool_],
    where: Callable[[int], str],
    *,
    overwrite: bool,
    rtol: float | None,
) -> Parts:
    """Read the numbers of the parts and check that each is of a body.

    Parameters
    ----------
    table : Table
    is_leaf : numpy.ndarray of bool
        By row.
    where : callable
        Names a row in errors.
    overwrite : bool
        Whether what the row of a node with children states is passed over.
    rtol : float, optional
        See `RigidBody`.
    """
    leaves = np.flatnonzero(is_leaf)
    if not overwrite:
        _refuse_own(table, ~is_leaf, where)
    values, sigma = (_stacked(table, names) for names in (NUMBERS, SIGMAS))
    of_density = table.numbers("sigma_density")
    is_silent = is_leaf & np.isnan(of_density)
    for cells in sigma:
        is_silent &= np.isnan(cells)
    for name, cells in zip((*SIGMAS, "sigma_density"), (*sigma, of_density), strict=True):
        _refuse(leaves[cells[leaves] < 0.0], cells, where, f"{name} must not be negative")
    sigma[np.isnan(sigma)] = 0.0
    growth = np.nan_to_num(table.numbers("growth", percent=True))
    beyond = leaves[(growth[leaves] < 0.0) | (growth[leaves] > 1.0)]
    law = "growth must be a fraction of the basic mass from 0 to 1 (write 15 % as 0.15 or 15%)"
    _refuse(beyond, growth, where, law)
    shapes = shape_rows(table, values, sigma, leaves, where)
    is_point = table.truths("Ipoint")
    values[4:, is_point] = sigma[4:, is_point] = 0.0
    _refuse_missing(values, leaves, where)
    is_stated = is_leaf.copy()
    is_stated[list(shapes)] = False
    signs = _turn_signs(table, values, is_stated, where)
    origin = _about_origin(table, leaves, where) if "about" in table else []
    origin = [row for row in origin if row not in shapes and not is_point[row]]
    if origin:
        values[4:, origin] -= values[0, origin] * own_moment(values[1:4, origin])
    shaped = sorted(shapes)
    draws = [_of_shapes(values[:, shaped], sigma[:, shaped]), _of_origin(values[:, origin], sigma[:, origin])]
    correlated = np.array([*shaped, *origin], np.intp), np.concatenate(draws, axis=2)
    _check_bodies(values, leaves, where, rtol)
    source = table.words("source") if "source" in table else []
    opposite = _opposite_signs(source, signs, sigma, np.flatnonzero(is_stated & ~is_point))
    unstated = int(is_silent.sum())
    return Parts(values[0], values[1:4], values[4:], growth, sigma, correlated, source, unstated, opposite)


def _stacked(table: Table, names: tuple[str, ...]) -> Floats:
    stacked = np.empty((len(names), table.count))
    for row, name in zip(stacked, names, strict=True):
        row[:] = table.numbers(name)
    return stacked


def _refuse(rows: Integers, cells: Floats, where: Callable[[int], str], law: str) -> None:
    """Name the first of the rows that break a law."""
    if len(rows):
        row = int(rows[0])
        raise PolhodeError(f"{where(row)}: {law}, got {cells[row]:g}")


def _refuse_own(table: Table, has_children: NDArray[np.bool_], where: Callable[[int], str]) -> None:
    for name in _OWN:
        if name not in table or name in table.uniform:
            continue
        cells = table.numbers(name, percent=name == "growth")
        rows = np.flatnonzero(has_children & ~np.isnan(cells))
        if len(rows):
            row = int(rows[0])
            raise PolhodeError(
                f"{where(row)}: has children, and {name} = {cells[row]:g} of its own; leave it empty, give "
                "it to a part below, or pass overwrite=True to roll up over it"
            )
    for name in ("file", "solid"):
        words = table.words(name) if name in table else ()
        row = next((row for row, word in enumerate(words) if word and has_children[row]), -1)
        if row >= 0:
            raise PolhodeError(
                f"{where(row)}: has children, and a {name} of its own; give it to a part below"
            )


def _refuse_missing(values: Floats, leaves: Integers, where: Callable[[int], str]) -> None:
    for name, cells in zip(NUMBERS, values, strict=True):
        missing = leaves[np.isnan(cells[leaves])]
        if len(missing):
            way_out = "; Ipoint TRUE takes the part as a point" if name[0] == "I" else ""
            raise PolhodeError(f"{where(int(missing[0]))}: has no children, and no {name}; state it{way_out}")


def _turn_signs(
    table: Table, values: Floats, is_stated: NDArray[np.bool_], where: Callable[[int], str]
) -> NDArray[np.int8]:
    """Turn positive products into elements of the tensor; return the sign that each row states."""
    conventions = table.words("POIconv")
    signs = np.fromiter(map(_SIGNS.get, conventions, repeat(-1)), np.int8, len(conventions))
    for row in np.flatnonzero(is_stated & (signs < 1)).tolist():
        if conventions[row]:
            raise PolhodeError(f"{where(row)}: POIconv is {conventions[row][:40]!r}; write + or -")
        k = next((k for k in (7, 8, 9) if values[k, row] != 0.0), None)
        if k is not None:
            x, y = NUMBERS[k][1], NUMBERS[k][2]
            raise PolhodeError(
                f"{where(row)}: nothing says which sign {NUMBERS[k]} = {values[k, row]:g} has; give a column "
                f"POIconv: + for the integral of {x} {y} dm, - for minus that, the element of the tensor"
            )
    for cells in values[7:]:
        np.subtract(0.0, cells, out=cells, where=is_stated & (signs == _PLUS))
    return signs


def _opposite_signs(
    source: list[str], signs: NDArray[np.int8], sigma: Floats, rows: Integers
) -> dict[str, tuple[str, ...]]:
    """Find the sources of uncertain products that some rows state with one sign and some with the other."""
    found: dict[str, set[tuple[int, bool]]] = {}
    for row in rows.tolist() if source else ():
        if source[row]:
            uncertain = np.flatnonzero(sigma[7:, row]) + 7
            found.setdefault(source[row], set()).update((k, signs[row] == _PLUS) for k in uncertain.tolist())
    both = {
        name: tuple(NUMBERS[k] for k in (7, 8, 9) if {(k, True), (k, False)} <= stated)
        for name, stated in found.items()
    }
    return {name: numbers for name, numbers in both.items() if numbers}


def _about_origin(table: Table, leaves: Integers, where: Callable[[int], str]) -> list[int]:
    """Give the parts whose tensor is stated about the origin."""
    about = table.words("about")
    other = next((row for row in leaves.tolist() if about[row] not in _ABOUT), None)
    if other is not None:
        raise PolhodeError(f"{where(other)}: about is {about[other][:40]!r}; write center_of_mass or origin")
    return [row for row in leaves.tolist() if about[row] == "origin"]


def _of_shapes(values: Floats, sigma: Floats) -> Floats:
    """Give the draws of files or shapes: the tensor grows with the mass."""
    draws = _independent(values, sigma)
    draws[4:, 0] = values[4:] / values[0] * sigma[0]
    return draws


def _of_origin(values: Floats, sigma: Floats) -> Floats:
    """Give the draws of parts whose tensor about the origin is stated: z there, shifted by −c.

    With z about the origin, δs = c δm + m δc and δI_O its own; S(−c) takes both to the centre.
    """
    draws = _independent(values, sigma)
    draws[1:4, 0] = values[1:4] * sigma[0]
    return shift(draws, -values[1:4])


def _independent(values: Floats, sigma: Floats) -> Floats:
    """Give the effect on z of ten independent errors, shape (10, 10, n)."""
    draws = np.zeros((10, 10, sigma.shape[1]))
    draws[np.arange(10), np.arange(10)] = sigma
    draws[(1, 2, 3), (1, 2, 3)] *= values[0]
    return draws


def _check_bodies(values: Floats, leaves: Integers, where: Callable[[int], str], rtol: float | None) -> None:
    """Let the constructor of bodies judge every part; name the first that it refuses."""
    for start in range(0, len(leaves), _CHUNK):
        some = leaves[start : start + _CHUNK]
        try:
            bodies_of(values[:, some], rtol)
        except InvalidInertiaError:
            for row in some.tolist():
                try:
                    bodies_of(values[:, row], rtol)
                except InvalidInertiaError as error:
                    raise InvalidInertiaError(f"{where(row)}: {error}") from None
            raise


def bodies_of(values: Floats, rtol: float | None = None) -> RigidBody:
    """Make bodies of the ten numbers, shape (10, ...)."""
    xx, yy, zz, xy, xz, yz = values[4:]
    tensor = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(*xx.shape, 3, 3)
    return RigidBody(values[0], tensor, np.moveaxis(values[1:4], 0, -1), rtol=rtol)
