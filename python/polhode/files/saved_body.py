"""Bodies as files that keep every bit: what ``RigidBody.save`` writes and ``RigidBody.load`` reads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._hints import check_kind
from polhode.errors import FileFormatError, PolhodeError
from polhode.files.fields import numbers, read_json, write_json
from polhode.files.record import array_schema, in_json, read_record, record_suffix, required, write_npz

if TYPE_CHECKING:
    from os import PathLike

    from polhode import RigidBody

__all__ = [
    "BODY_ARRAYS",
    "BODY_FIELDS",
    "BODY_SCHEMA",
    "body_fields",
    "body_of",
    "check_has_bodies",
    "load_body",
    "read_report",
    "save_body",
]

_FORMAT: Final = "polhode.RigidBody/1"

BODY_ARRAYS: Final = ("mass", "center_of_mass", "inertia")
"""The fields that every file of a body has."""

_REPORTED: Final = ("mass", "center_of_mass", "inertia_about_center_of_mass")
"""Of a report, in kg and m."""

_DOUBTS: Final = ("variable_counts", "variables", "tangents", "second_order")

BODY_FIELDS: Final = (*BODY_ARRAYS, "principal_moments", "principal_axes", "numbers", *_DOUBTS)
"""All fields of a body."""

BODY_SCHEMA: dict[str, object] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "A rigid body, or a stack of bodies",
    "type": "object",
    "required": ["format", "mass", "center_of_mass", "inertia"],
    "properties": {
        "format": {"const": _FORMAT},
        "mass": array_schema("shape (...)"),
        "center_of_mass": array_schema("C from the origin, in the axes of the body, shape (..., 3)"),
        "inertia": array_schema(
            "tensor about C; off-diagonals are minus the products of inertia, shape (..., 3, 3)"
        ),
        "principal_moments": array_schema("ascending, shape (..., 3); for the reader of the file"),
        "principal_axes": array_schema("as columns, shape (..., 3, 3); for the reader of the file"),
        "numbers": array_schema(
            "all that polhode keeps of the body, shape (..., 33); where it stands the body is made of it, to "
            "the last bit, and must agree with mass, center_of_mass and inertia"
        ),
        "variable_counts": array_schema("of an uncertain body: how many variables each body depends on"),
        "variables": array_schema("their identities, in eight parts of 16 bits, shape (n, 8)"),
        "tangents": array_schema(
            "what one standard deviation of each does to m, C and the elements xx, yy, zz, xy, xz, yz of the "
            "tensor about C, shape (n, 10)"
        ),
        "second_order": array_schema("second-order terms along the probes, shape (bodies, 16, 10)"),
    },
    "patternProperties": {"^comment$": {"description": "for the reader of the file"}},
    "additionalProperties": False,
}
"""What a body's JSON file holds, as JSON Schema."""


def save_body(body: RigidBody, path: str | PathLike[str]) -> None:
    """Write a body: what ``RigidBody.save`` does.

    Parameters
    ----------
    body : RigidBody
        One body or a stack.
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    check_kind(body, "body", "RigidBody")
    file = Path(path)
    fields = body_fields(body)
    if record_suffix(file) == ".json":
        check_has_bodies(body, file)
        write_json(file, in_json({"format": _FORMAT} | fields, file))
    else:
        write_npz(file, _FORMAT, fields)


def load_body(path: str | PathLike[str]) -> RigidBody:
    """Read a body: what ``RigidBody.load`` does.

    Parameters
    ----------
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    file = Path(path)
    return body_of(read_record(file, _FORMAT, BODY_FIELDS), file)


def read_report(path: str | PathLike[str]) -> RigidBody | None:
    """Read the body of a report in kg and m, as ``polhode report --output`` writes it; None for another file.

    Parameters
    ----------
    path : str or os.PathLike
    """
    file = Path(path)
    fields = read_json(file) if file.suffix.lower() == ".json" else {}
    units = fields.get("units")
    if not isinstance(units, dict) or not all(name in fields for name in _REPORTED):
        return None
    mass_unit, length = units.get("mass"), units.get("center_of_mass")
    if (mass_unit, length) != ("kg", "m"):
        raise FileFormatError(
            f"{file}: a report in {mass_unit} and {length}; state --length-unit when it is made, for kg and m"
        )
    if "sigma" in fields:
        raise FileFormatError(
            f'{file}: a report does not tell which of its sigmas go together; take "sigma" out to leave '
            "them out, or save the body, which keeps them"
        )
    mass, center, tensor = (numbers(fields[name], name, file) for name in _REPORTED)
    try:
        return _core.RigidBody(mass, tensor, center)
    except PolhodeError as error:
        raise FileFormatError(f"{file}: {error}") from error
    except ValueError as error:
        raise FileFormatError(f"{file}: not the numbers of a body: {error}; save it again") from error


def body_fields(body: RigidBody) -> dict[str, Any]:
    """Give the fields of a body as a file holds them."""
    principal = body.principal
    return {
        **{name: getattr(body, name) for name in BODY_ARRAYS},
        "principal_moments": principal.moments,
        "principal_axes": principal.axes,
        "numbers": body.__reduce__()[1][0],
        **_doubts_fields(body),
    }


def _doubts_fields(body: RigidBody) -> dict[str, Any]:
    """Give what a body is uncertain by, in numbers that every file holds."""
    doubts = body._doubts()
    if doubts is None:
        return {}
    words = doubts["variables"].astype("<u8").view("<u2").astype(float)
    return {
        "variable_counts": doubts["counts"].astype(float),
        "variables": words.reshape(-1, 8),
        "tangents": doubts["tangents"],
        "second_order": doubts["bends"],
    }


def _doubts_of(fields: dict[str, Any], file: Path) -> dict[str, Any] | None:
    """Read it."""
    if not any(name in fields for name in _DOUBTS):
        return None
    counts, words, tangents, bends = (numbers(required(fields, name, file), name, file) for name in _DOUBTS)
    is_whole = (counts == np.floor(counts)).all() and (counts >= 0).all() and (words == np.floor(words)).all()
    if not is_whole or (words.size and not 0 <= words.min() <= words.max() < 2**16):
        raise FileFormatError(
            f"{file}: variables and variable_counts must be whole numbers, below 65536 and from 0; save "
            "it again"
        )
    return {
        "counts": counts.astype(np.int64).ravel(),
        "variables": words.astype("<u2").reshape(-1).view("<u8").astype(np.uint64).reshape(-1, 2),
        "tangents": tangents.reshape(-1, 10),
        "bends": bends,
    }


def body_of(fields: dict[str, Any], file: Path) -> RigidBody:
    """Make the body from the fields of a file."""
    given = {name: numbers(required(fields, name, file), name, file) for name in BODY_ARRAYS}
    try:
        if "numbers" not in fields:
            if any(name in fields for name in _DOUBTS):
                raise FileFormatError(
                    f"{file}: the uncertainty is of the body in numbers, which are left out; save it "
                    "again, or leave the uncertainty out"
                )
            return _core.RigidBody(given["mass"], given["inertia"], given["center_of_mass"])
        body = _core.RigidBody._from_numbers(
            numbers(fields["numbers"], "numbers", file), _doubts_of(fields, file)
        )
    except FileFormatError:
        raise
    except PolhodeError as error:
        raise FileFormatError(f"{file}: {error}") from error
    except ValueError as error:
        raise FileFormatError(f"{file}: not the fields of a body: {error}; save it again") from error
    for name, value in given.items():
        if not np.array_equal(getattr(body, name), value):
            raise FileFormatError(
                f"{file}: {name} is not that of the body in numbers; leave numbers out after a change by hand"
            )
    return body


def check_has_bodies(body: RigidBody, file: Path) -> None:
    """Refuse an empty stack, whose shape JSON does not tell."""
    if not np.size(body.mass):
        raise ValueError(f"path: {file}: JSON does not tell the shape of an empty stack; save it as .npz")
