"""What a part of an assembly is made of: its body in its own axes, before it is placed."""

from __future__ import annotations

import inspect
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from polhode import laminae, rods, solids
from polhode._core import RigidBody
from polhode._format import Argument
from polhode.assembly.tables import COMMON, FILE, KINDS, PRINTED, PartError, check_keys, text_of
from polhode.errors import PolhodeError
from polhode.interop.printouts import from_printout
from polhode.io.budget import words_of
from polhode.io.components import MOST_FACES, overlapping
from polhode.io.content import is_molecule
from polhode.io.cut import Plane, cut_solid
from polhode.io.formats import SAVED_SUFFIXES, body_of_molecule, check_arguments, load, read_saved
from polhode.io.images import body_of_image, is_image, read_image, unit_of
from polhode.io.mesh_solid import solid_of
from polhode.io.named_densities import body_by_names
from polhode.units import metres_per

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from polhode.assembly.tables import Scope
    from polhode.io.formats import FileContent

__all__ = ["Matter", "body_of_part", "kind_of"]

_SHAPES: Final = {
    **{name: getattr(room, name) for room in (solids, laminae, rods) for name in room.__all__},
    "balls": RigidBody.from_balls,
}
_PARAMETERS: Final = {
    name: [key for key in inspect.signature(shape).parameters if key != "degrees"]  # numbers have units
    for name, shape in _SHAPES.items()
}
_NO_LENGTHS: Final = {"angle": "rad", "sides": "1"}
"""Arguments of shapes that are no lengths, with their units."""
_SWITCHES: Final = ("orient", "union", "repair")


def kind_of(table: Mapping[str, Any], where: str) -> str:
    """Return what a part is."""
    kinds = [name for name in KINDS if name in table]
    if len(kinds) == 1:
        return kinds[0]
    if not kinds:  # a wrong key may be why
        every = {
            *COMMON,
            *FILE,
            *(name for parameters in _PARAMETERS.values() for name in parameters),
        }
        check_keys(table, sorted(every), where)
    found = f"got {' and '.join(kinds)}" if kinds else "got none"
    raise PartError(f"{where}: expected one of {', '.join(KINDS)}, {found}")


class Matter(NamedTuple):
    """What a part is made of.

    Attributes
    ----------
    body : RigidBody
    metres : float
        In one unit of length.
    arguments : dict
        Of a solid.
    notes : tuple of str
        What is to be told of its file.
    mesh : (vertices, faces) or None
        Its triangles in metres, where they can be compared with other parts.
    """

    body: RigidBody
    metres: float
    arguments: dict[str, Any] = {}  # noqa: RUF012
    notes: tuple[str, ...] = ()
    mesh: tuple[NDArray[np.float64], NDArray[np.int64]] | None = None


def body_of_part(kind: str, table: Mapping[str, Any], scope: Scope, folder: Path) -> Matter:
    """Make the body of a part that is a solid, a file or numbers."""
    try:
        if kind == "solid":
            made = _solid(table, scope)
        elif kind == "inertia":
            made = Matter(_read_inertia(table, scope), scope.metres)
        else:
            made = _file(table, scope, folder)
    except PartError:
        raise
    except PolhodeError as error:
        pieces = [_key(piece) if isinstance(piece, Argument) else piece for piece in error.args]
        error.args = (f"{scope.where}: ", *pieces)
        raise
    except (ValueError, TypeError, OverflowError, OSError) as error:
        what = words_of(error) if isinstance(error, OSError) else error
        raise PartError(f"{scope.where}: {what}") from error
    if made.body.shape:
        raise PartError(
            f"{scope.where}: its numbers are of {made.body.shape[0]} bodies, not of one; give numbers, not "
            "rows of them"
        )
    return made._replace(notes=tuple(f"{scope.where}: {note}" for note in made.notes))


def _key(argument: Argument) -> str:
    """Write an argument of a reader as a key of the file."""
    if isinstance(argument.value, bool):
        return f"{argument.name} = {str(argument.value).lower()}"
    return str(argument).replace("=", " = ", 1)


def _weight(table: Mapping[str, Any], scope: Scope, what: str) -> dict[str, Any]:
    if ("mass" in table) == ("density" in table):
        raise PartError(f"{scope.where}: {what} needs its mass or its density; state one of the two")
    if "mass" in table:
        return {"mass": scope.amount("mass", table["mass"], "kg")}
    density = table["density"]
    if isinstance(density, dict):
        return {
            "density": {
                name: scope.amount(f"density of {name}", each, "kg/m^3") for name, each in density.items()
            }
        }
    return {"density": scope.amount("density", density, "kg/m^3")}


def _solid(table: Mapping[str, Any], scope: Scope) -> Matter:
    name = text_of(table, "solid", scope.where)
    if name not in _SHAPES:
        raise PartError(
            f"{scope.where}: solid: there is no {name!r}; write one of {', '.join(sorted(_SHAPES))}"
        )
    shape: Callable[..., RigidBody] = _SHAPES[name]
    taken = _PARAMETERS[name]
    check_keys(table, (*COMMON, *taken), f"{scope.where} ({name})")
    own = [key for key in taken if key not in ("mass", "density")]
    missing = [key for key in own if key not in table]
    if missing:
        raise PartError(f"{scope.where}: a {name} takes {', '.join(own)}; state {missing[0]}")
    options = {
        key: scope.numbers(key, table[key], _NO_LENGTHS[key])
        if key in _NO_LENGTHS
        else scope.lengths(key, table[key])
        for key in own
    }
    if "sides" in options:
        options["sides"] = table["sides"]
    try:
        return Matter(shape(**options, **_weight(table, scope, f"a {name}")), scope.metres, options)
    except TypeError as error:
        raise PartError(f"{scope.where}: {name}: {error}") from None


def _read_inertia(table: Mapping[str, Any], scope: Scope) -> RigidBody:
    given = table["inertia"]
    where = f"{scope.where}: inertia"
    if not isinstance(given, dict):
        raise PartError(
            f"{where}: write a table, as in inertia = {{ mass = 2, com = [0, 0, 1], tensor = [3, 4, 5] }}"
        )
    check_keys(table, COMMON, scope.where)
    check_keys(given, PRINTED, where)
    for name in ("mass", "tensor"):
        if name not in given:
            raise PartError(f"{where}: it has no {name}; state it")
    inner = type(scope)(where, scope.length_unit)
    rows = given["tensor"]
    flat = (
        [x for row in rows for x in row]
        if isinstance(rows, list) and rows and isinstance(rows[0], list)
        else rows
    )
    tensor = inner.numbers("tensor", flat, "kg m^2", scope.metres**2)
    com = inner.lengths("com", given["com"], 3) if "com" in given else (0.0, 0.0, 0.0)
    rtol = inner.numbers("rtol", given["rtol"], "1") if "rtol" in given else None
    mass = inner.amount("mass", given["mass"], "kg")
    try:
        return from_printout(
            mass,
            com,
            tensor if isinstance(tensor, list) else [tensor],
            products=given.get("products"),
            about=given.get("about", "center_of_mass"),
            rtol=rtol,
        )
    except PolhodeError as error:
        error.args = ("inertia: ", *error.args)
        raise


def _file(table: Mapping[str, Any], scope: Scope, folder: Path) -> Matter:
    check_keys(table, (*COMMON, *FILE), scope.where)
    path = folder / text_of(table, "file", scope.where)
    suffix = path.suffix.lower()
    if suffix == ".toml":
        raise PartError(
            f"{scope.where}: file: {path.name} is an assembly; write assembly = instead of file ="
        )
    if suffix in SAVED_SUFFIXES:
        surplus = next((key for key in (*FILE, "length_unit") if key in table), None)
        if surplus is not None:
            raise PartError(
                f"{scope.where}: {surplus}: {path.name} is a saved body, whole as it is; leave it out"
            )
        body = read_saved(path).body
        if body.shape:
            raise PartError(
                f"{scope.where}: {path.name} holds a stack of bodies, of shape {body.shape}, not one; "
                "save one of them alone"
            )
        return Matter(body, scope.metres)
    with_units = ("mass", "density", "thickness", "cut", "weld")
    options = {key: table[key] for key in FILE if key in table and key not in with_units}
    for key in (key for key in _SWITCHES if key in table):
        if not isinstance(table[key], bool):
            raise PartError(
                f"{scope.where}: {key}: {repr(table[key])[:60]} is neither true nor false; write one of "
                "them, without quotes"
            )
    if is_molecule(path):
        unit = str(table.get("length_unit", "angstrom"))
        options |= {key: table[key] for key in with_units if key in table}
        none = {"weld": 0.0, "index_base": 1}
        check_arguments(path, **{key: value != none.get(key, False) for key, value in options.items()})
        body, notes, crossed = body_of_molecule(path, unit)
        return Matter(body, metres_per(unit), notes=(*crossed, *notes))
    if is_image(path):
        check_arguments(path, **{key: key in table for key in FILE})
        image = read_image(path)
        known = unit_of(image, path, table.get("length_unit")) or scope.length_unit
        if known is None:
            raise PartError(f"{scope.where}: {path.name} does not say its unit of length; state length_unit")
        metres = metres_per(known)
        return Matter(body_of_image(image, **_weight(table, scope, path.name), scale=metres), metres)
    loaded = load(path, index_base=options.pop("index_base", 1))
    metres = metres_per(_unit_of(loaded, table, scope))
    if "thickness" in table:
        options["thickness"] = scope.lengths("thickness", table["thickness"], 1)[0]
    plane = _plane(table, scope) if "cut" in table else None
    if "weld" in table:
        options["weld"] = scope.lengths("weld", table["weld"], 1)[0] / metres
    if not ({"mass", "density"}.isdisjoint(table) and _has_materials(loaded)):
        options |= _weight(table, scope, path.name)
    if isinstance(options.get("density"), dict):
        if plane is not None:
            raise PartError(
                f"{scope.where}: cut: a solid of one density is cut, not parts of several; give one density"
            )
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            body = body_by_names(loaded, options.pop("density"), scale=metres, **options)
        return Matter(body, metres, notes=(*loaded.notes, *(str(each.message) for each in told)))
    solid = solid_of(loaded, scale=metres, **options)
    is_whole = options.keys().isdisjoint(("union", "closure", "repair", "weld", "thickness"))
    if plane is not None:
        weights = {key: options.get(key) for key in ("density", "mass")}
        mended = {key: options.get(key) for key in ("closure", *_SWITCHES)}
        weld = options.get("weld", 0.0)
        solid, left = cut_solid(loaded, solid, plane, **weights, scale=metres, weld=weld, mended=mended)
        found = None if left is None or len(left.faces) > MOST_FACES else (left.vertices, left.faces)
        is_shown = is_whole and solid.faces <= MOST_FACES
        lines = overlapping(loaded.mesh.vertices * metres, loaded.mesh.faces) if is_shown else []
        return Matter(solid.body, metres, notes=(*loaded.notes, *lines), mesh=found)
    if loaded.cad is not None or not is_whole or solid.faces > MOST_FACES:
        return Matter(
            solid.body, metres, notes=loaded.notes
        )  # of solids of CAD their file tells what overlaps
    mesh = loaded.mesh.vertices * metres, loaded.mesh.faces
    lines = overlapping(*mesh)
    lines += ["union = true counts what components share once"] if lines else []
    return Matter(solid.body, metres, notes=(*loaded.notes, *lines), mesh=mesh)


def _plane(table: Mapping[str, Any], scope: Scope) -> Plane:
    """Read the plane that cuts a solid, in its own axes."""
    where, given = f"{scope.where}: cut", table["cut"]
    if not isinstance(given, dict) or "normal" not in given:
        raise PartError(
            f"{where}: write a table with the normal of a plane, as in cut = {{ normal = [0, 0, -1], "
            "point = [0, 0, 0.3] }"
        )
    check_keys(given, Plane._fields, where)
    if "thickness" in table:
        raise PartError(f"{where}: thickness makes a sheet, which has no inside; leave one of the two out")
    inner = type(scope)(where, scope.length_unit)
    normal = inner.numbers("normal", given["normal"], "1", count=3)
    return Plane(normal, inner.lengths("point", given.get("point", [0, 0, 0]), 3))


def _has_materials(loaded: FileContent) -> bool:
    """Return whether a file says the density of every solid in it."""
    return loaded.cad is not None and all(part.density is not None for part in loaded.cad.parts)


def _unit_of(loaded: FileContent, table: Mapping[str, Any], scope: Scope) -> str:
    """Return the unit of a file: its own, else the one that is stated for its part or for the assembly."""
    unit = loaded.length(table.get("length_unit")) or scope.length_unit
    if unit is None:
        name = loaded.path.name
        raise PartError(f"{scope.where}: {name} does not say its unit of length; state length_unit")
    return unit
