"""Bodies as files that keep every bit: what ``RigidBody.save`` writes and ``RigidBody.load`` reads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode.errors import FileFormatError, PolhodeError
from polhode.files.fields import numbers, write_json
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
    "save_body",
]

_FORMAT: Final = "polhode.RigidBody/1"

BODY_ARRAYS: Final = ("mass", "center_of_mass", "inertia")
"""The fields that every file of a body has."""

BODY_FIELDS: Final = (*BODY_ARRAYS, "principal_moments", "principal_axes", "numbers")
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


def body_fields(body: RigidBody) -> dict[str, Any]:
    """Give the fields of a body as a file holds them."""
    principal = body.principal
    return {
        **{name: getattr(body, name) for name in BODY_ARRAYS},
        "principal_moments": principal.moments,
        "principal_axes": principal.axes,
        "numbers": body.__reduce__()[1][0],
    }


def body_of(fields: dict[str, Any], file: Path) -> RigidBody:
    """Make the body from the fields of a file."""
    given = {name: numbers(required(fields, name, file), name, file) for name in BODY_ARRAYS}
    try:
        if "numbers" not in fields:
            return _core.RigidBody(given["mass"], given["inertia"], given["center_of_mass"])
        body = _core.RigidBody._from_numbers(numbers(fields["numbers"], "numbers", file))
    except FileFormatError:
        raise
    except PolhodeError as error:
        raise FileFormatError(f"{file}: {error}") from error
    except ValueError as error:
        raise FileFormatError(f"{file}: not the fields of a body: {error}") from error
    for name, value in given.items():
        if not np.array_equal(getattr(body, name), value):
            raise FileFormatError(
                f"{file}: {name} is not that of the body in numbers; leave numbers out after a change by hand"
            )
    return body


def check_has_bodies(body: RigidBody, file: Path) -> None:
    """Refuse an empty stack, whose shape JSON does not tell."""
    if not np.size(body.mass):
        raise ValueError(f"path: {file}: JSON does not tell the shape of an empty stack; .npz does")
