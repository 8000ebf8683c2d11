"""The parts of a ledger: rows of a table as bodies, with the errors of their ten numbers."""

from __future__ import annotations

from itertools import repeat
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._core import RigidBody
from polhode.errors import InvalidInertiaError, PolhodeError
from polhode.uncertainty._rollup import NUMBERS, own_moment, shift
from polhode.uncertainty._shapes import shape_body

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode.uncertainty._table import Table

    Floats = NDArray[np.float64]

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
_ABOUT: Final = ("", "center_of_mass", "origin")


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
    correlated : dict
        Of leaves whose ten errors are not independent: the effect of each of the ten draws on z, a matrix (10, 10).
    source : list of str
        "" for a part whose draws are its own; empty where there is no other.
    unstated : int
        How many leaves state no sigma at all.
    """

    mass: Floats
    center: Floats
    inertia: Floats
    growth: Floats
    sigma: Floats
    correlated: dict[int, Floats]
    source: list[str]
    unstated: int


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
    numbers = {name: table.numbers(name, percent=name == "growth") for name in _OWN}
    if not overwrite:
        _refuse_own(table, numbers, ~is_leaf, where)
    sigma, unstated = _sigmas(numbers, leaves, where)
    growth = _growth(numbers["growth"], leaves, where)
    shapes = _shapes(table, numbers, sigma, leaves, where)
    is_point = table.truths("Ipoint")
    for name in NUMBERS[4:]:
        numbers[name][is_point] = 0.0
    sigma[4:, is_point] = 0.0
    _refuse_missing(numbers, leaves, where)
    _signs(table.words("POIconv"), numbers, is_leaf, where)
    values = np.stack([numbers[name] for name in NUMBERS])
    origin = _about_origin(table, leaves, where) if "about" in table else []
    origin = [row for row in origin if row not in shapes and not is_point[row]]
    correlated = {row: _of_shape(values[:, row], sigma[:, row]) for row in shapes}
    if origin:
        values[4:, origin] -= values[0, origin] * own_moment(values[1:4, origin])
        for row in origin:
            correlated[row] = _of_origin(values[:, row], sigma[:, row])
    _check_bodies(values, leaves, where, rtol)
    source = table.words("source") if "source" in table else []
    return Parts(values[0], values[1:4], values[4:], growth, sigma, correlated, source, unstated)


def _refuse_own(
    table: Table, numbers: dict[str, Floats], has_children: NDArray[np.bool_], where: Callable[[int], str]
) -> None:
    for name, cells in numbers.items():
        rows = np.flatnonzero(has_children & ~np.isnan(cells)) if name in table else ()
        if len(rows):
            row = int(rows[0])
            raise PolhodeError(
                f"{where(row)}: has children, and {name} = {cells[row]:g} of its own; leave it empty, give it to a part "
                "below, or pass overwrite=True to roll up over it"
            )
    for name in ("file", "solid"):
        words = table.words(name) if name in table else ()
        row = next((row for row, word in enumerate(words) if word and has_children[row]), -1)
        if row >= 0:
            raise PolhodeError(
                f"{where(row)}: has children, and a {name} of its own; give it to a part below"
            )


def _sigmas(
    numbers: dict[str, Floats], leaves: NDArray[np.intp], where: Callable[[int], str]
) -> tuple[Floats, int]:
    """Give the standard deviations, and how many parts state none."""
    sigma = np.stack([numbers[name] for name in SIGMAS])
    is_stated = ~np.isnan(sigma[:, leaves]).all(axis=0) | ~np.isnan(numbers["sigma_density"][leaves])
    for name in (*SIGMAS, "sigma_density"):
        negative = leaves[numbers[name][leaves] < 0.0]
        if len(negative):
            row = int(negative[0])
            raise PolhodeError(f"{where(row)}: {name} must not be negative, got {numbers[name][row]:g}")
    return np.nan_to_num(sigma), int(np.sum(~is_stated))


def _growth(growth: Floats, leaves: NDArray[np.intp], where: Callable[[int], str]) -> Floats:
    growth = np.nan_to_num(growth)
    beyond = leaves[(growth[leaves] < 0.0) | (growth[leaves] > 1.0)]
    if len(beyond):
        row = int(beyond[0])
        raise PolhodeError(
            f"{where(row)}: growth must be a fraction of the basic mass from 0 to 1, got {growth[row]:g}; write 15 % as "
            "0.15 or 15%"
        )
    return growth


def _shapes(
    table: Table,
    numbers: dict[str, Floats],
    sigma: Floats,
    leaves: NDArray[np.intp],
    where: Callable[[int], str],
) -> list[int]:
    """Fill in the values of rows that are a file or a shape; give these rows."""
    if not any(name in table for name in ("file", "solid", "density")):
        return []
    words = {name: table.words(name) for name in ("file", "solid", "arguments")}
    made: dict[Any, RigidBody] = {}
    rows = []
    for row in leaves.tolist():
        density, mass = float(numbers["density"][row]), float(numbers["mass"][row])
        kinds = [name for name in ("file", "solid") if words[name][row]]
        if not kinds:
            if words["arguments"][row] or not np.isnan(density):
                raise PolhodeError(f"{where(row)}: density and arguments are of a file or a solid; name one")
            continue
        if len(kinds) == 2 or np.isnan(density) == np.isnan(mass):
            raise PolhodeError(
                f"{where(row)}: give a file or a solid, and its mass or its density, one of each"
            )
        stated = next((name for name in NUMBERS[4:] if not np.isnan(numbers[name][row])), None)
        if stated is not None:
            raise PolhodeError(
                f"{where(row)}: {stated} is stated beside the {kinds[0]} that it follows from; leave one out"
            )
        _density_sigma(numbers, sigma, row, density, where)
        try:
            body = shape_body(
                kinds[0],
                words[kinds[0]][row],
                words["arguments"][row],
                table.folder,
                mass=mass,
                density=density,
                made=made,
            )
        except (ValueError, OSError) as error:
            raise PolhodeError(f"{where(row)}: {error}") from error
        center = np.array([numbers[name][row] for name in NUMBERS[1:4]])
        tensor = body.inertia
        own = np.concatenate(
            [[body.mass], np.where(np.isnan(center), body.center_of_mass, center), np.diag(tensor)]
        )
        for name, value in zip(NUMBERS, [*own, tensor[0, 1], tensor[0, 2], tensor[1, 2]], strict=True):
            numbers[name][row] = value
        if not np.isnan(density):
            sigma[0, row] *= body.mass
        rows.append(row)
    return rows


def _density_sigma(
    numbers: dict[str, Floats], sigma: Floats, row: int, density: float, where: Callable[[int], str]
) -> None:
    """Put the relative sigma of the density in the place of that of the mass."""
    of_density = float(numbers["sigma_density"][row])
    if np.isnan(density):
        if not np.isnan(of_density):
            raise PolhodeError(f"{where(row)}: sigma_density is stated, but no density; state sigma_mass")
    elif sigma[0, row] != 0.0:
        raise PolhodeError(f"{where(row)}: sigma_mass is stated beside a density; state sigma_density")
    else:
        sigma[0, row] = np.nan_to_num(of_density) / density


def _refuse_missing(
    numbers: dict[str, Floats], leaves: NDArray[np.intp], where: Callable[[int], str]
) -> None:
    for name in NUMBERS:
        missing = leaves[np.isnan(numbers[name][leaves])]
        if len(missing):
            way_out = "; Ipoint TRUE takes the part as a point" if name[0] == "I" else ""
            raise PolhodeError(f"{where(int(missing[0]))}: has no children, and no {name}; state it{way_out}")


def _signs(
    conventions: list[str],
    numbers: dict[str, Floats],
    is_leaf: NDArray[np.bool_],
    where: Callable[[int], str],
) -> None:
    """Turn positive products into elements of the tensor."""
    signs = np.fromiter(map(_SIGNS.get, conventions, repeat(-1)), np.int8, len(conventions))
    for row in np.flatnonzero(is_leaf & (signs < 1)).tolist():
        if conventions[row]:
            raise PolhodeError(f"{where(row)}: POIconv is {conventions[row][:40]!r}; write + or -")
        stated = next((name for name in NUMBERS[7:] if numbers[name][row] != 0.0), None)
        if stated is not None:
            raise PolhodeError(
                f"{where(row)}: nothing says which sign {stated} = {numbers[stated][row]:g} has; give a column "
                f"POIconv: + for the integral of {stated[1]} {stated[2]} dm, - for minus that, the tensor's element"
            )
    for name in NUMBERS[7:]:
        numbers[name] = np.where(signs == _PLUS, 0.0 - numbers[name], numbers[name])


def _about_origin(table: Table, leaves: NDArray[np.intp], where: Callable[[int], str]) -> list[int]:
    """Give the parts whose tensor is stated about the origin."""
    about = table.words("about")
    other = next((row for row in leaves.tolist() if about[row] not in _ABOUT), None)
    if other is not None:
        raise PolhodeError(f"{where(other)}: about is {about[other][:40]!r}; write center_of_mass or origin")
    return [row for row in leaves.tolist() if about[row] == "origin"]


def _of_shape(values: Floats, sigma: Floats) -> Floats:
    """Give the draws of a file or shape: its tensor grows with its mass; nothing else of it is uncertain but its place."""
    draws = np.diag(sigma)
    draws[1:4] *= values[0]
    draws[4:, 0] = values[4:] / values[0] * sigma[0]
    return draws


def _of_origin(values: Floats, sigma: Floats) -> Floats:
    """Give the draws of a part whose tensor about the origin is stated: z of it, shifted by −c.

    With z about the origin, δs = c δm + m δc and δI_O its own; S(−c) takes both to the centre.
    """
    mass, center = values[0], values[1:4]
    draws = np.diag(sigma)
    draws[1:4, 0] = center * sigma[0]
    draws[1:4, 1:4] *= mass
    return shift(draws[:, :, None], -center[:, None])[:, :, 0]


def _check_bodies(
    values: Floats, leaves: NDArray[np.intp], where: Callable[[int], str], rtol: float | None
) -> None:
    """Let the constructor of bodies judge every part; name the first that it refuses."""
    try:
        bodies_of(values[:, leaves], rtol)
    except InvalidInertiaError:
        while len(leaves) > 1:
            half = leaves[: len(leaves) // 2]
            try:
                bodies_of(values[:, half], rtol)
            except InvalidInertiaError:
                leaves = half
            else:
                leaves = leaves[len(leaves) // 2 :]
        row = int(leaves[0])
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
