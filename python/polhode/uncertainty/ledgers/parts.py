"""The parts of a ledger: rows, files and shapes as bodies, with the errors of their ten numbers."""

from __future__ import annotations

import inspect
import math
from itertools import repeat
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode import laminae, rods, solids
from polhode._core import RigidBody
from polhode._format import Argument
from polhode.errors import InvalidInertiaError, PolhodeError
from polhode.uncertainty.ledgers.rollup import NUMBERS, own_moment, shift

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.uncertainty.ledgers.table import Table

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

__all__ = [
    "COLUMNS",
    "SIGMAS",
    "Parts",
    "bodies_of",
    "parts_of_bodies",
    "read_parts",
    "shape_rows",
]

SIGMAS: Final = tuple(f"sigma_{name}" for name in NUMBERS)
_OWN: Final = (*NUMBERS, *SIGMAS, "growth", "density", "sigma_density")
"""Columns of numbers in the row of a part; a node with children must not have them."""
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
    """Data of the leaves of the table, by row; rows with children are meaningless.

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
    values, sigma = (_stack_columns(table, names) for names in (NUMBERS, SIGMAS))
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


def _stack_columns(table: Table, names: tuple[str, ...]) -> Floats:
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
                "it to a part below, or pass ",
                Argument("overwrite", True),
                " to roll up over it",
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
    """Return the parts whose tensor is stated about the origin."""
    about = table.words("about")
    other = next((row for row in leaves.tolist() if about[row] not in _ABOUT), None)
    if other is not None:
        raise PolhodeError(f"{where(other)}: about is {about[other][:40]!r}; write center_of_mass or origin")
    return [row for row in leaves.tolist() if about[row] == "origin"]


def _of_shapes(values: Floats, sigma: Floats) -> Floats:
    """Return the draws of files or shapes: the tensor grows with the mass."""
    draws = _independent(values, sigma)
    draws[4:, 0] = values[4:] / values[0] * sigma[0]
    return draws


def _of_origin(values: Floats, sigma: Floats) -> Floats:
    """Return the draws of parts whose tensor about the origin is stated: z there, shifted by −c.

    With z about the origin, δs = c δm + m δc and δI_O its own; S(−c) takes both to the centre.
    """
    draws = _independent(values, sigma)
    draws[1:4, 0] = values[1:4] * sigma[0]
    return shift(draws, -values[1:4])


def _independent(values: Floats, sigma: Floats) -> Floats:
    """Return the effect on z of ten independent errors, shape (10, 10, n)."""
    draws = np.zeros((10, 10, sigma.shape[1]))
    draws[np.arange(10), np.arange(10)] = sigma
    draws[(1, 2, 3), (1, 2, 3)] *= values[0]
    return draws


def _check_bodies(values: Floats, leaves: Integers, where: Callable[[int], str], rtol: float | None) -> None:
    """Check every part with the constructor of bodies; the error names the first that it refuses."""
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


_MOST = 10
"""Draws that a ledger keeps of a part, and of all parts that share some."""


def parts_of_bodies(ids: Sequence[str], bodies: Sequence[RigidBody | None]) -> Parts:
    """Take the ten numbers of bodies and their errors; None stands for a node with children.

    Parameters
    ----------
    ids : sequence of str
        Errors that several bodies share bear the name of the first of them.
    bodies : sequence of (RigidBody or None)
        In one frame.
    """
    count = len(bodies)
    values = np.zeros((10, count))
    found: list[tuple[int, list[tuple[int, ...]], Floats]] = []
    for row, body in enumerate(bodies):
        if body is None:
            continue
        tensor = body.inertia
        values[:, row] = [
            body.mass, *body.center_of_mass, *np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2]
        ]  # fmt: skip
        doubts = body._doubts()
        if doubts is not None and len(doubts["tangents"]):
            effects = doubts["tangents"].copy()  # of m, C and I; the ledger keeps those of m, m C and I
            effects[:, 1:4] *= body.mass
            found.append((row, [tuple(name) for name in doubts["variables"].tolist()], effects))
    draws = np.zeros((10, _MOST, len(found)))
    source = [""] * count
    for group in _sharing([set(names) for _, names, _ in found]):
        every = sorted({name for k in group for name in found[k][1]})
        if len(every) > _MOST and len(group) > 1:
            raise PolhodeError(
                f"{len(group)} parts share {len(every)} independent errors, and a ledger keeps {_MOST} at "
                "most; leave the sigmas of these parts out"
            )
        for k in group:
            row, names, effects = found[k]
            if len(every) > _MOST:  # of a part alone, by as many draws with the same covariance
                effects = np.linalg.svd(effects, full_matrices=False)[1:]
                effects = effects[0][:, None] * effects[1]
                names = every[: len(effects)]
            found[k] = row, names, effects
        place = _numbers([found[k][1:] for k in group])
        for k in group:
            row, names, effects = found[k]
            draws[:, [place[name] for name in names], k] = effects.T
            if len(group) > 1:
                source[row] = f"{ids[found[group[0]][0]]} and {len(group) - 1} like it"
    rows = np.array([row for row, _, _ in found], np.intp)
    return Parts(
        mass=values[0],
        center=values[1:4],
        inertia=values[4:],
        growth=np.zeros(count),
        sigma=np.zeros((10, count)),
        correlated=(rows, draws),
        source=source,
        unstated=sum(body is not None for body in bodies) - len(found),
        opposite_signs={},
    )


def _numbers(members: Sequence[tuple[list[tuple[int, ...]], Floats]]) -> dict[tuple[int, ...], int]:
    """Return, for each error, the index of the number to which it contributes most."""
    variances: dict[tuple[int, ...], Floats] = {}
    for names, effects in members:
        for name, effect in zip(names, effects, strict=True):
            variances[name] = variances.get(name, np.zeros(10)) + effect**2
    left, place = sorted(variances), {}
    for number in range(10):
        of_number = {name: variances[name][number] for name in left}
        first = max(left, key=of_number.__getitem__, default=None)
        if first is not None and of_number[first] > 0.0:
            place[first] = number
            left.remove(first)
    free = (number for number in range(10) if number not in place.values())
    return place | dict(zip(left, free, strict=False))


def _sharing(names: list[set[tuple[int, ...]]]) -> list[list[int]]:
    """Return the numbers of those that share a name, directly or by way of others."""
    groups: list[tuple[set[tuple[int, ...]], list[int]]] = []
    of_name: dict[tuple[int, ...], int] = {}
    for k, own in enumerate(names):
        near = sorted({of_name[name] for name in own if name in of_name})
        at = near[0] if near else len(groups)
        if not near:
            groups.append((set(), []))
        for other in near[1:]:
            groups[at][0].update(groups[other][0])
            groups[at][1].extend(groups[other][1])
            groups[other] = (set(), [])
        groups[at][0].update(own)
        groups[at][1].append(k)
        of_name.update(dict.fromkeys(groups[at][0], at))
    return [sorted(members) for _, members in groups if members]


_SHAPES: Final = {name: getattr(room, name) for room in (solids, laminae, rods) for name in room.__all__}


def shape_rows(
    table: Table, values: Floats, sigma: Floats, leaves: Integers, where: Callable[[int], str]
) -> set[int]:
    """Fill in the values of rows that are a file or a shape.

    Parameters
    ----------
    table : Table
    values, sigma : numpy.ndarray
        The ten numbers and their standard deviations, shape (10, n); filled in place.
    leaves : numpy.ndarray
        Rows without children.
    where : callable
        Names a row in errors.

    Returns
    -------
    set of int
        These rows.
    """
    if not any(name in table for name in ("file", "solid", "arguments", "density", "sigma_density")):
        return set()
    words = {name: table.words(name) for name in ("file", "solid", "arguments")}
    densities = table.numbers("density"), table.numbers("sigma_density")
    made: dict[Any, RigidBody] = {}
    rows = set()
    for row in leaves.tolist():
        density, of_density = (float(cells[row]) for cells in densities)
        kinds = [name for name in ("file", "solid") if words[name][row]]
        is_by_mass, is_by_density = (not math.isnan(value) for value in (values[0, row], density))
        try:
            if not kinds:
                if words["arguments"][row] or is_by_density or not math.isnan(of_density):
                    raise PolhodeError("density and arguments are of a file or a solid; name one")
                continue
            if len(kinds) == 2 or is_by_mass == is_by_density:
                raise PolhodeError("give a file or a solid, and its mass or its density: one of each")
            if not np.isnan(values[4:, row]).all():
                raise PolhodeError(
                    f"a tensor is stated beside the {kinds[0]} that it follows from; leave one out"
                )
            if is_by_mass and not math.isnan(of_density):
                raise PolhodeError("sigma_density is stated, but no density; state sigma_mass")
            if is_by_density and sigma[0, row] != 0.0:
                raise PolhodeError("sigma_mass is stated beside a density; state sigma_density")
            weight = {"density": density} if is_by_density else {"mass": float(values[0, row])}
            what, arguments = words[kinds[0]][row], words["arguments"][row]
            key = (kinds[0], what, arguments, *weight.items())
            if key not in made:  # a file that is there often is read once
                options = _arguments(arguments)
                make = _of_file(table.folder / what) if kinds[0] == "file" else _shape(what)
                made[key] = _call_maker(make, what, options, weight)
        except (ValueError, OSError) as error:
            kind = type(error) if isinstance(error, PolhodeError) else PolhodeError
            raise kind(f"{where(row)}: {error}") from error
        body = made[key]
        tensor = body.inertia
        center = np.where(np.isnan(values[1:4, row]), body.center_of_mass, values[1:4, row])
        values[:, row] = [body.mass, *center, *np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2]]
        if is_by_density and not math.isnan(of_density):
            sigma[0, row] = body.mass * of_density / density
        rows.add(row)
    return rows


def _of_file(path: Path) -> Callable[..., RigidBody]:
    def make(
        *,
        length_unit: str | None = None,
        weld: float = 0.0,
        closure: Literal["caps", "hull"] | None = None,
        orient: bool = False,
        index_base: Literal[0, 1] = 1,
        mass: float | None = None,
        density: float | None = None,
    ) -> RigidBody:
        return RigidBody.from_file(
            path,
            mass=mass,
            density=density,
            length_unit=length_unit,
            weld=weld,
            closure=closure,
            orient=orient,
            index_base=index_base,
        )

    return make


def _shape(name: str) -> Callable[..., RigidBody]:
    if name not in _SHAPES:
        raise PolhodeError(f"solid: there is no {name!r}; there are {', '.join(sorted(_SHAPES))}")
    shape: Callable[..., RigidBody] = _SHAPES[name]
    return shape


def _call_maker(
    make: Callable[..., RigidBody], what: str, options: dict[str, Any], weight: dict[str, float]
) -> RigidBody:
    """Make a body; arguments that it does not take are refused by name."""
    signature = inspect.signature(make)
    try:
        signature.bind(**options, **weight)
    except TypeError as error:
        taken = ", ".join(name for name in signature.parameters if name not in ("mass", "density"))
        raise PolhodeError(f"arguments: {what}: {error}; it takes {taken}") from None
    try:
        return make(**options, **weight)
    except TypeError as error:  # a word where a number should be
        raise PolhodeError(f"arguments: {what}: {error}") from None


def _arguments(text: str) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for word in text.replace(";", " ").split():
        name, equals, value = word.partition("=")
        if not (name.isidentifier() and equals and value):
            raise PolhodeError(f"arguments: {word!r} is not name=value; write, say, radius=0.1 size=1,2,3")
        if name in options:
            raise PolhodeError(f"arguments: {name!r} is there twice")
        options[name] = _value(value)
    return options


def _value(text: str) -> Any:
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    try:
        numbers = tuple(int(word) if word.isdecimal() else float(word) for word in text.split(","))
    except ValueError:
        return text
    return numbers if len(numbers) > 1 else numbers[0]
