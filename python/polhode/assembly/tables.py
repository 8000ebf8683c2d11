"""The tables of an assembly's file: their keys, numbers with units, and the places of parts."""

from __future__ import annotations

import difflib
import math
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError
from polhode.units import amount, has_unit, metres_per, quantity, split

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "COMMON",
    "FILE",
    "HERE",
    "KINDS",
    "PRINTED",
    "REPEATED",
    "TOP",
    "PartError",
    "Place",
    "Scope",
    "check_keys",
    "copies",
    "place_of",
    "suggest_name",
    "text_of",
    "unknown",
]

TOP: Final = ("name", "comment", "length_unit", "part")
KINDS: Final = ("solid", "file", "assembly", "inertia")
"""Keys that define a part; exactly one is needed."""
REPEATED: Final = ("count", "step", "turn")
COMMON: Final = ("name", "comment", *KINDS, "length_unit", "mirror", "position", "rotation", *REPEATED)
FILE: Final = (
    "mass",
    "density",
    "thickness",
    "cut",
    "weld",
    "closure",
    "orient",
    "union",
    "repair",
    "index_base",
)
_MOST_NAMES: Final = 40
_SYNONYMS: Final = {
    "mesh": "file",
    "path": "file",
    "filename": "file",
    "shape": "solid",
    "unit": "length_unit",
    "units": "length_unit",
    "mirrored": "mirror",
    "translation": "position",
}
"""Words of others for keys."""
PRINTED: Final = ("mass", "com", "tensor", "products", "about", "rtol")
"""Keys of `inertia`, as CAD programs print it."""


class PartError(PolhodeError):
    """An error whose message begins with the part of which it tells."""


@contextmanager
def _as_part_error() -> Iterator[None]:
    """Let errors of quantities be such errors: the name of a quantity begins with its part."""
    try:
        yield
    except PolhodeError as error:
        raise PartError(*error.args) from None


def check_keys(table: Mapping[str, Any], known: Collection[str], where: str) -> None:
    """Refuse an unknown key; the error proposes the nearest known key."""
    for key in table:
        if key not in known:
            raise PartError(f"{where}: {unknown(str(key), known)}")


def unknown(key: str, known: Collection[str]) -> str:
    """Say that a key is not known, and which are."""
    return f"{key[:40]!r} is not a known key; {suggest_name(key, known)}"


def suggest_name(name: str, known: Collection[str]) -> str:
    """Propose the known name that is nearest to a wrong one, or list the known names."""
    synonym = _SYNONYMS.get(name.lower(), "")
    near = [synonym] if synonym in known else difflib.get_close_matches(name, known, n=1)
    names = [*known][:_MOST_NAMES]
    more = f" and {len(known) - len(names)} more" if len(known) > len(names) else ""
    return f"is {near[0]!r} meant?" if near else f"give one of {', '.join(names)}{more}"


def text_of(table: Mapping[str, Any], key: str, where: str) -> str:
    """Return a text; "" where it is absent."""
    value = table.get(key, "")
    if not isinstance(value, str) or not value.isprintable():
        raise PartError(f"{where}: {key}: {repr(value)[:60]} is not a line of text; write one between quotes")
    return value


_SHOWN: Final = 60
_LONGEST: Final = 10_000


@dataclass(frozen=True)
class Scope:
    """One table of the file: what it is called in errors, and the unit of its bare lengths.

    Attributes
    ----------
    where : str
    length_unit : str or None
        None where nothing states it: metres are taken, but for files, which have to state theirs.
    """

    where: str
    length_unit: str | None = None

    @property
    def metres(self) -> float:
        """Metres in one unit of length."""
        return metres_per(self.length_unit or "m")

    def within(self, name: str, length_unit: Any) -> Scope:
        """Return the scope of a table inside this one."""
        where = f"{self.where}: {name}" if self.where else name
        if length_unit is None:
            return Scope(where, self.length_unit)
        if not isinstance(length_unit, str):
            raise PartError(
                f"{where}: length_unit: {_shorten(length_unit)} is not the name of a unit; write one, as 'mm'"
            )
        try:
            metres_per(length_unit)
        except PolhodeError as error:
            raise PartError(f"{where}: {error}") from None
        return Scope(where, length_unit)

    def lengths(self, key: str, value: Any, count: int | None = None) -> Any:
        """Read a length, a row of them (of `count`) or rows of rows, in metres."""
        if count is None and isinstance(value, list | tuple) and value and isinstance(value[0], list | tuple):
            return [self.lengths(key, row) for row in value]
        return self.numbers(key, value, "m", self.metres, count)

    def numbers(self, key: str, value: Any, unit: str, bare: float = 1.0, count: int | None = None) -> Any:
        """Read one number, or a row of them where it is a row or `count` says so.

        Parameters
        ----------
        key : str
            Named in what goes wrong.
        value : object
            A number, a text with a unit, an array of either, or one text of several numbers.
        unit : str
            What is returned.
        bare : float
            A number without a unit, in `unit`.
        count : int, optional
            How many there have to be.
        """
        option = self._option(key, value)
        if isinstance(value, list | tuple):
            found = [self._number(option, item, unit, bare) for item in value]
        elif isinstance(value, str) and (count or "," in value or len(value.split()) > 1):
            with _as_part_error():
                parts = split((value,), count, unit, option)
            found = [self._number(option, part, unit, bare) for part in parts]
            if count is None and len(found) == 1:
                return found[0]
        else:
            found = [self._number(option, value, unit, bare)]
            if count is None:
                return found[0]
        if count is not None and len(found) != count:
            raise PartError(f"{option}: expected {count} numbers, got {len(found)} in {_shorten(value)}")
        return found

    def amount(self, key: str, value: Any, unit: str) -> float | _core.Uncertain:
        """Read a mass or a density, which may have a sigma."""
        option = self._option(key, value)
        if isinstance(value, str):
            with _as_part_error():
                return amount(value, unit, option)
        return self._number(option, value, unit, 1.0)

    def _option(self, key: str, value: Any) -> str:
        option = f"{self.where}: {key}" if self.where else key
        if isinstance(value, str) and len(value) > _LONGEST:
            raise PartError(f"{option}: {_shorten(value)} has more than {_LONGEST} letters; write a number")
        return option

    def _number(self, option: str, value: Any, unit: str, bare: float) -> float:
        if isinstance(value, str):
            with _as_part_error():
                return quantity(value, unit, option) * (1.0 if has_unit(value) else bare)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise PartError(f"{option}: {_shorten(value)} is not a number; write one, as in 2.5")
        try:
            number = float(value) * bare
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise PartError(f"{option}: {_shorten(value)} is not finite; write one that is")
        return number


def _shorten(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."


_FORMS: Final = ("axis", "sequence", "quaternion_xyzw", "matrix")
_ANGLES: Final = ("degrees", "radians")
_EXAMPLE: Final = "rotation = { axis = [0, 0, 1], degrees = 90 }"
_OFF_UNITY: Final = 1e-6
"""Tolerance for a quaternion or a matrix of few digits; it is then normalized."""
MOST_COPIES: Final = 100_000
"""Largest number of copies of one part."""


class Place(NamedTuple):
    """A placement r → R r + d; R may also mirror."""

    rotation: Floats
    displacement: Floats

    def of(self, inner: Place) -> Place:
        """Compose two placements: first `inner`, then this one."""
        return Place(self.rotation @ inner.rotation, self.rotation @ inner.displacement + self.displacement)

    def place(self, body: _core.RigidBody) -> _core.RigidBody:
        """Place a body."""
        rotation = self.rotation
        if np.linalg.det(rotation) < 0.0:  # a mirror through the plane x = 0, then a rotation
            body = body.mirrored((1.0, 0.0, 0.0))
            rotation = rotation * (-1.0, 1.0, 1.0)
        if not np.array_equal(rotation, np.eye(3)):
            body = body.rotated(_core.quaternion_from_matrix(rotation))
        return body.translated(self.displacement) if self.displacement.any() else body


HERE: Final = Place(np.eye(3), np.zeros(3))


def place_of(table: Mapping[str, Any], scope: Scope) -> Place:
    """Read the mirror, rotation and position of a part, in the order in which they act."""
    position = scope.lengths("position", table["position"], 3) if "position" in table else (0.0, 0.0, 0.0)
    rotation = _rotation(table.get("rotation"), "rotation", scope)
    if "mirror" in table:
        normal = np.array(scope.numbers("mirror", table["mirror"], "1", count=3))
        size = float(np.abs(normal).max())
        if size == 0.0:
            raise PartError(
                f"{scope.where}: mirror: a normal of length 0 has no direction; write one, as in "
                "mirror = [0, 1, 0]"
            )
        normal = normal / size
        normal /= np.linalg.norm(normal)
        rotation = rotation @ (np.eye(3) - 2.0 * np.outer(normal, normal))
    return Place(rotation, np.array(position))


def copies(table: Mapping[str, Any], scope: Scope) -> list[Place]:
    """Read the number of copies of a part; return the placement of each, the identity for the first."""
    count = table.get("count", 1)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= MOST_COPIES:
        raise PartError(
            f"{scope.where}: count: {str(count)[:40]!r} is not a whole number from 1 to {MOST_COPIES}; "
            "write one"
        )
    moved = next((key for key in ("step", "turn") if key in table), None)
    if moved is not None and count == 1:
        raise PartError(f"{scope.where}: {moved}: it is from one copy to the next; state count, 2 or more")
    step = Place(
        _rotation(table.get("turn"), "turn", scope),
        np.array(scope.lengths("step", table["step"], 3)) if "step" in table else np.zeros(3),
    )
    places = [HERE]
    while len(places) < count:
        places.append(step.of(places[-1]))
    return places


def _rotation(given: Any, key: str, scope: Scope) -> Floats:
    """Read a rotation R from the axes of the part to those of the assembly: v = R v_part."""
    if given is None:
        return np.eye(3)
    where = f"{scope.where}: {key}"
    if not isinstance(given, dict):
        raise PartError(
            f"{where}: {str(given)[:40]!r} is not a table that says what it means; write {_EXAMPLE}"
        )
    check_keys(given, (*_FORMS, *_ANGLES), where)
    forms = [name for name in _FORMS if name in given]
    if len(forms) != 1:
        raise PartError(f"{where}: give one of {', '.join(_FORMS)}; for example {_EXAMPLE}")
    form = forms[0]
    inner = type(scope)(where)
    if form in ("quaternion_xyzw", "matrix"):
        check_keys(given, (form,), where)
        return _quaternion(given[form], inner) if form == "quaternion_xyzw" else _matrix(given[form], inner)
    units = [name for name in _ANGLES if name in given]
    if len(units) != 1:
        raise PartError(
            f"{where}: state the angle of {form} as degrees or as radians; for example {_EXAMPLE}"
        )
    if form == "axis":
        axis = np.array(inner.numbers("axis", given["axis"], "1", count=3))
        largest = float(np.abs(axis).max())
        if not largest > 0.0:
            raise PartError(f"{where}: axis: a rotation about 0 0 0 has no direction; name an axis")
        axis /= largest
        return _turn(axis / np.linalg.norm(axis), _angles(given, units[0], 1, inner)[0])
    sequence = given["sequence"]
    letters = sequence if isinstance(sequence, str) else ""
    if len(letters) != 3 or letters.upper().strip("XYZ") or letters not in (letters.upper(), letters.lower()):
        raise PartError(
            f"{where}: sequence: expected three letters of XYZ (about the axes of the turning part) or of "
            f"xyz (about those that stand), got {str(sequence)[:40]!r}"
        )
    turns = [
        _turn(np.eye(3)["xyz".index(letter.lower())], angle)
        for letter, angle in zip(letters, _angles(given, units[0], 3, inner), strict=True)
    ]
    first, second, third = turns if letters.isupper() else turns[::-1]
    return first @ second @ third


def _angles(given: Mapping[str, Any], unit: str, count: int, scope: Scope) -> list[tuple[float, float]]:
    """Return cosines and sines; multiples of 90 degrees are exact."""
    angles = scope.numbers(unit, given[unit], "1", count=count)
    if unit == "radians":
        return [(float(np.cos(x)), float(np.sin(x))) for x in angles]
    found = []
    for angle in angles:
        quarters, rest = divmod(angle + 45.0, 90.0)
        c, s = float(np.cos(np.deg2rad(rest - 45.0))), float(np.sin(np.deg2rad(rest - 45.0)))
        for _ in range(int(quarters) % 4):
            c, s = -s, c
        found.append((c + 0.0, s + 0.0))
    return found


def _turn(axis: Floats, angle: tuple[float, float]) -> Floats:
    """Rotate about a unit vector: R = c 1 + s a× + (1 − c) a aᵀ."""
    c, s = angle
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Floats = c * np.eye(3) + s * cross + (1.0 - c) * np.outer(axis, axis)
    return turned


def _quaternion(given: Any, scope: Scope) -> Floats:
    q = np.array(scope.numbers("quaternion_xyzw", given, "1", count=4))
    size = float(np.linalg.norm(q)) if np.abs(q).max() < 2.0 else np.inf
    if not abs(size - 1.0) <= _OFF_UNITY:
        raise PartError(f"{scope.where}: quaternion_xyzw: its length is {size:.9g}, expected 1")
    return _core.rotate(q / size, np.eye(3)).T


def _matrix(given: Any, scope: Scope) -> Floats:
    rows = (
        np.array([scope.numbers("matrix", row, "1", count=3) for row in given])
        if isinstance(given, list)
        else None
    )
    if rows is None or rows.shape != (3, 3):
        raise PartError(f"{scope.where}: matrix: expected three rows of three numbers")
    off = float(np.abs(rows @ rows.T - np.eye(3)).max()) if np.abs(rows).max() < 2.0 else np.inf
    if not off <= _OFF_UNITY or np.linalg.det(rows) < 0.0:
        what = (
            f"its rows are off from unit vectors at right angles by {off:.2g}"
            if off > _OFF_UNITY
            else "it mirrors"
        )
        way_out = "; mirror = [1, 0, 0] makes a mirror image" if off <= _OFF_UNITY else ""
        raise PartError(f"{scope.where}: matrix: {what}; a rotation keeps lengths and hands{way_out}")
    if off == 0.0:
        return rows
    u, _, v = np.linalg.svd(rows)
    nearest: Floats = u @ v
    return nearest
