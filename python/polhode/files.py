"""Bodies and motions as files that keep every bit: JSON after a schema, and NumPy's npz.

``RigidBody.save`` and ``Trajectory.save`` write them; ``RigidBody.load`` and ``Trajectory.from_file`` read
them.
:data:`BODY_SCHEMA` and :data:`TRAJECTORY_SCHEMA` say what the JSON files hold, as JSON Schema.
"""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode._files.writing import write_bytes, writing
from polhode.errors import FileFormatError, PolhodeError

if TYPE_CHECKING:
    from os import PathLike

    from polhode import RigidBody, Trajectory

__all__ = [
    "BODY_SCHEMA",
    "TRAJECTORY_SCHEMA",
    "load_body",
    "load_trajectory",
    "save_body",
    "save_trajectory_json",
    "save_trajectory_npz",
]

_BODY_FORMAT, _TRAJECTORY_FORMAT = "polhode.RigidBody/1", "polhode.Trajectory/1"
_BODY_ARRAYS = ("mass", "center_of_mass", "inertia")
_STATES = {"t": 0, "omega": 3, "quaternion": 4, "position": 3, "velocity": 3}
_COUNTS = ("steps", "evaluations")


def _array(text: str) -> dict[str, object]:
    return {"description": text, "type": ["number", "array"]}


BODY_SCHEMA: dict[str, object] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "A rigid body, or a stack of bodies",
    "type": "object",
    "required": ["format", "mass", "center_of_mass", "inertia"],
    "properties": {
        "format": {"const": _BODY_FORMAT},
        "mass": _array("shape (...)"),
        "center_of_mass": _array("C from the origin, in the axes of the body, shape (..., 3)"),
        "inertia": _array(
            "tensor about C; off-diagonals are minus the products of inertia, shape (..., 3, 3)"
        ),
        "principal_moments": _array("ascending, shape (..., 3); for the reader of the file"),
        "principal_axes": _array("as columns, shape (..., 3, 3); for the reader of the file"),
        "numbers": _array(
            "all that polhode keeps of the body, shape (..., 33); where it stands the body is made of it, to "
            "the last bit, and must agree with mass, center_of_mass and inertia"
        ),
    },
}
"""What a body's JSON file holds, as JSON Schema."""

TRAJECTORY_SCHEMA: dict[str, object] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "The motion of a rigid body, or of a stack of bodies",
    "type": "object",
    "required": ["format", "body", "about", *_STATES],
    "properties": {
        "format": {"const": _TRAJECTORY_FORMAT},
        "body": BODY_SCHEMA,
        "about": _array("the point of reference in the body, shape (..., 3)"),
        "pivoted": {"description": "whether that point is fixed in space", "type": "boolean"},
        "t": _array("times, shape (T,)"),
        "omega": _array("angular velocity in the body, shape (..., T, 3)"),
        "quaternion": _array("attitude R_NB as x, y, z, w, shape (..., T, 4)"),
        "position": _array("of the point of reference in space, shape (..., T, 3)"),
        "velocity": _array("of the point of reference in space, shape (..., T, 3)"),
        "status": {"description": "how each run ended, shape (...)", "type": ["string", "array"]},
        "steps": _array("accepted steps, shape (...)"),
        "evaluations": _array("of the equations of motion, shape (...)"),
    },
}
"""What a motion's JSON file holds, as JSON Schema; a state that is not a number is null."""


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
    fields = _body_fields(body)
    if _suffix(file) == ".json":
        _write_json(file, {"format": _BODY_FORMAT} | fields)
    else:
        _write_npz(file, _BODY_FORMAT, fields)


def load_body(path: str | PathLike[str]) -> RigidBody:
    """Read a body: what ``RigidBody.load`` does.

    Parameters
    ----------
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    file = Path(path)
    return _body(_read(file, _BODY_FORMAT), file)


def save_trajectory_json(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as JSON.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    fields: dict[str, Any] = {"format": _TRAJECTORY_FORMAT, "body": _listed(_body_fields(trajectory.body))}
    fields |= {name: getattr(trajectory, name) for name in ("about", *_STATES, *_COUNTS, "status")}
    _write_json(path, fields | {"pivoted": trajectory.pivoted})


def save_trajectory_npz(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as NumPy's arrays, those of the body beside the body's own under plain names.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    arrays = {name: getattr(trajectory, name) for name in ("about", *_STATES, *_COUNTS, "status", "pivoted")}
    arrays |= {name: getattr(trajectory.body, name) for name in _BODY_ARRAYS}
    arrays |= {f"body_{name}": value for name, value in _body_fields(trajectory.body).items()}
    _write_npz(path, _TRAJECTORY_FORMAT, arrays)


def load_trajectory(path: str | PathLike[str]) -> Trajectory:
    """Read a motion: what ``Trajectory.from_file`` does.

    Parameters
    ----------
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    from polhode.trajectory import Trajectory

    file = Path(path)
    fields = _read(file, _TRAJECTORY_FORMAT)
    body = fields.get("body")
    if file.suffix.lower() == ".npz":
        body = {
            name.removeprefix("body_"): value for name, value in fields.items() if name.startswith("body_")
        }
    elif not isinstance(body, dict):
        raise FileFormatError(f"{file}: body is not an object with the fields of a body")
    loaded = _body(body, file)
    arrays = {name: _numbers(fields, name, file) for name in ("about", *_STATES)}
    times = (*loaded.shape, len(arrays["t"]) if arrays["t"].ndim == 1 else -1)
    for name, width in _STATES.items():
        expected = (*times, width) if width else times[-1:]
        if arrays[name].shape != expected:
            raise FileFormatError(f"{file}: {name} has shape {arrays[name].shape}, expected {expected}")
    if arrays["about"].shape != (*loaded.shape, 3):
        raise FileFormatError(
            f"{file}: about has shape {arrays['about'].shape}, expected {(*loaded.shape, 3)}"
        )
    none = np.zeros(loaded.shape, dtype=np.int64)
    counts = {name: np.asarray(fields.get(name, none), dtype=np.int64) for name in _COUNTS}
    status = np.asarray(fields.get("status", "complete"))
    return Trajectory(
        body=loaded,
        t=arrays["t"],
        omega=arrays["omega"],
        quaternion=arrays["quaternion"],
        position=arrays["position"],
        velocity=arrays["velocity"],
        about=arrays["about"],
        steps=counts["steps"],
        evaluations=counts["evaluations"],
        status=status if status.ndim else str(status),
        pivoted=bool(fields.get("pivoted", False)),
    )


def _body_fields(body: RigidBody) -> dict[str, Any]:
    principal = body.principal
    return {
        **{name: getattr(body, name) for name in _BODY_ARRAYS},
        "principal_moments": principal.moments,
        "principal_axes": principal.axes,
        "numbers": body.__reduce__()[1][0],
    }


def _body(fields: dict[str, Any], file: Path) -> RigidBody:
    given = {name: _numbers(fields, name, file) for name in _BODY_ARRAYS}
    try:
        if "numbers" not in fields:
            return _core.RigidBody(given["mass"], given["inertia"], given["center_of_mass"])
        numbers = _numbers(fields, "numbers", file)
        body = _core.RigidBody._from_numbers(numbers)
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


def _numbers(fields: dict[str, Any], name: str, file: Path) -> np.ndarray[Any, np.dtype[np.float64]]:
    if name not in fields:
        raise FileFormatError(f"{file}: {name} is missing")
    try:
        return np.asarray(fields[name], dtype=np.float64)
    except (TypeError, ValueError):
        raise FileFormatError(f"{file}: {name} is not an array of numbers") from None


def _read(file: Path, expected: str) -> dict[str, Any]:
    """Read the fields of a file of the expected format."""
    if _suffix(file) == ".json":
        try:
            fields = json.loads(file.read_text(encoding="utf-8"))
        except (UnicodeDecodeError, json.JSONDecodeError) as error:
            raise FileFormatError(f"{file}: not JSON: {error}") from None
    else:
        try:
            with np.load(file, allow_pickle=False) as archive:
                fields = {name: archive[name] for name in archive}
        except (ValueError, EOFError, zipfile.BadZipFile) as error:
            raise FileFormatError(f"{file}: not an npz file: {error}") from None
        if "format" in fields:
            fields["format"] = str(fields["format"])
    found = fields.get("format") if isinstance(fields, dict) else None
    if found != expected:
        raise FileFormatError(f"{file}: its format is {found!r}, expected {expected!r}")
    return dict(fields)


def _suffix(file: Path) -> str:
    suffix = file.suffix.lower()
    if suffix not in (".json", ".npz"):
        raise ValueError(f"path: {file} does not end in .json or .npz")
    return suffix


def _write_json(file: Path, fields: dict[str, Any]) -> None:
    if fields.get("mass") is not None and not np.size(fields["mass"]):
        raise ValueError(f"path: {file}: JSON does not tell the shape of an empty stack; .npz does")
    # Python writes the shortest decimal that gives the same float64 back.
    write_bytes(file, (json.dumps(_listed(fields), indent=1, allow_nan=False) + "\n").encode())


def _write_npz(file: Path, name: str, arrays: dict[str, Any]) -> None:
    with writing(file) as stream:  # given a path, numpy would add its suffix to one that ends in .NPZ
        np.savez(stream, format=np.array(name), **arrays)


def _listed(fields: dict[str, Any]) -> dict[str, Any]:
    """Turn arrays into lists in which what is not a number is null."""
    return {name: _plain(value) for name, value in fields.items()}


def _plain(value: Any) -> Any:
    if not isinstance(value, np.ndarray | np.generic):
        return value
    if value.dtype.kind != "f" or np.isfinite(value).all():
        return value.tolist()
    return [_plain(part) for part in np.asarray(value)] if value.ndim else None
