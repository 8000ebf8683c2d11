"""Bodies and motions as files that keep every bit: JSON after a schema, and NumPy's npz.

``RigidBody.save`` and ``Trajectory.save`` write them; ``RigidBody.load`` and ``Trajectory.from_file`` read
them.
:data:`BODY_SCHEMA` and :data:`TRAJECTORY_SCHEMA` say what the JSON files hold, as JSON Schema.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode._files.fields import counts, numbers, read_json, read_npz, write_json
from polhode._files.writing import writing
from polhode.errors import FileFormatError, PolhodeError

if TYPE_CHECKING:
    from collections.abc import Collection
    from os import PathLike

    from numpy.typing import NDArray

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
_ENDS = ("complete", "stopped", "failed")
_OFF_UNITY = 1e-6
_BODY_FIELDS = (*_BODY_ARRAYS, "principal_moments", "principal_axes", "numbers")
_TRAJECTORY_FIELDS = ("about", *_STATES, *_COUNTS, "status", "pivoted")
_TRAJECTORY_ARRAYS = (*_TRAJECTORY_FIELDS, *_BODY_ARRAYS, *(f"body_{name}" for name in _BODY_FIELDS))
_WORDS = ("format", "comment")


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
    "patternProperties": {"^comment$": {"description": "for the reader of the file"}},
    "additionalProperties": False,
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
        "t": _array("times, shape (T,); of a closed form any shape, which stands for (T,) in those below"),
        "omega": _array("angular velocity in the body, shape (..., T, 3)"),
        "quaternion": _array("attitude R_NB as x, y, z, w, shape (..., T, 4)"),
        "position": _array("of the point of reference in space, shape (..., T, 3)"),
        "velocity": _array("of the point of reference in space, shape (..., T, 3)"),
        "status": {"description": "how each run ended, shape (...)", "type": ["string", "array"]},
        "steps": _array("accepted steps, shape (...)"),
        "evaluations": _array("of the equations of motion, shape (...)"),
    },
    "patternProperties": {"^comment$": {"description": "for the reader of the file"}},
    "additionalProperties": False,
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
        _check_has_bodies(body, file)
        write_json(file, _listed({"format": _BODY_FORMAT} | fields, file))
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
    return _body(_read(file, _BODY_FORMAT, _BODY_FIELDS), file)


def save_trajectory_json(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as JSON.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    _check_has_bodies(trajectory.body, path)
    fields: dict[str, Any] = {"format": _TRAJECTORY_FORMAT}
    fields["body"] = _listed(_body_fields(trajectory.body), path)
    fields |= {name: getattr(trajectory, name) for name in _TRAJECTORY_FIELDS}
    write_json(path, _listed(fields, path))


def save_trajectory_npz(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as NumPy's arrays, those of the body beside the body's own under plain names.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    arrays = {name: getattr(trajectory, name) for name in _TRAJECTORY_FIELDS}
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
    fields = _read(file, _TRAJECTORY_FORMAT, (*_TRAJECTORY_FIELDS, "body"), _TRAJECTORY_ARRAYS)
    if file.suffix.lower() == ".npz":
        fields["body"] = {
            name.removeprefix("body_"): value for name, value in fields.items() if name.startswith("body_")
        }
    elif not isinstance(fields.get("body"), dict):
        raise FileFormatError(f"{file}: body is not an object with the fields of a body")
    else:
        _check_names(fields["body"], (*_BODY_FIELDS, *_WORDS), f"{file}: body")
    body = _body(fields["body"], file)
    t = numbers(_required(fields, "t", file), "t", file)
    states = {"t": t, "about": numbers(_required(fields, "about", file), "about", file)}
    expected: dict[str, tuple[int, ...]] = {"about": (*body.shape, 3)}
    for name, width in _STATES.items():
        if width:
            states[name] = numbers(_required(fields, name, file), name, file, with_holes=True)
            expected[name] = (*body.shape, *t.shape, width)
    for name, shape in expected.items():
        if states[name].shape != shape:
            raise FileFormatError(f"{file}: {name} has shape {states[name].shape}, expected {shape}")
    _check_unit(states["quaternion"], file)
    none = np.zeros(body.shape, dtype=np.int64)
    given = {name: counts(fields.get(name, none), name, file, body.shape) for name in _COUNTS}
    return Trajectory(
        body=body,
        t=t,
        omega=states["omega"],
        quaternion=states["quaternion"],
        position=states["position"],
        velocity=states["velocity"],
        about=states["about"],
        steps=given["steps"],
        evaluations=given["evaluations"],
        status=_status(fields, file, body.shape),
        pivoted=_pivoted(fields, file),
    )


def _status(fields: dict[str, Any], file: Path, shape: tuple[int, ...]) -> Any:
    held = fields.get("status", "complete")
    status = np.array(held, dtype=object)
    others = [word for word in status.reshape(-1).tolist() if word not in _ENDS]
    if others:
        raise FileFormatError(
            f"{file}: status holds {repr(others[0])[:60]}, expected one of {', '.join(_ENDS)}"
        )
    if status.shape not in ((), shape):
        raise FileFormatError(f"{file}: status has shape {status.shape}, expected {shape}")
    return status.astype(str) if status.ndim else str(held)


def _pivoted(fields: dict[str, Any], file: Path) -> bool:
    held = fields.get("pivoted", False)
    if isinstance(held, np.ndarray) and held.dtype == np.bool_ and held.ndim == 0:
        return bool(held)
    if not isinstance(held, bool):
        found = f"{held.dtype} of shape {held.shape}" if isinstance(held, np.ndarray) else repr(held)[:60]
        raise FileFormatError(f"{file}: pivoted is {found}, expected true or false")
    return held


def _check_unit(quaternion: NDArray[np.float64], file: Path) -> None:
    with np.errstate(over="ignore"):
        squares = np.square(quaternion).sum(axis=-1)
    off = squares[np.abs(squares - 1.0) > _OFF_UNITY]
    if off.size:
        raise FileFormatError(f"{file}: a quaternion has the norm {np.sqrt(off[0]):.9g}, expected 1")


def _body_fields(body: RigidBody) -> dict[str, Any]:
    principal = body.principal
    return {
        **{name: getattr(body, name) for name in _BODY_ARRAYS},
        "principal_moments": principal.moments,
        "principal_axes": principal.axes,
        "numbers": body.__reduce__()[1][0],
    }


def _body(fields: dict[str, Any], file: Path) -> RigidBody:
    given = {name: numbers(_required(fields, name, file), name, file) for name in _BODY_ARRAYS}
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


def _required(fields: dict[str, Any], name: str, file: Path) -> Any:
    if name not in fields:
        raise FileFormatError(f"{file}: {name} is missing")
    return fields[name]


def _read(
    file: Path, expected: str, in_json: Collection[str], in_npz: Collection[str] | None = None
) -> dict[str, Any]:
    """Read the fields of a file of the expected format, which may hold these fields alone."""
    fields: dict[str, Any]
    if _suffix(file) == ".json":
        known = {*in_json, *_WORDS}
        fields = read_json(file)
    else:
        known = {*(in_npz or in_json), *_WORDS}
        fields = dict(read_npz(file))
    found = fields.get("format")
    found = str(found) if isinstance(found, np.ndarray) else found
    if found != expected:
        raise FileFormatError(f"{file}: its format is {found!r}, expected {expected!r}")
    _check_names(fields, known, str(file))
    return fields


def _check_names(fields: dict[str, Any], known: Collection[str], where: str) -> None:
    other = next((name for name in fields if name not in known), None)
    if other is not None:
        raise FileFormatError(
            f"{where}: {other[:40]!r} is no field of this format; words for the reader may stand in 'comment'"
        )


def _suffix(file: Path) -> str:
    suffix = file.suffix.lower()
    if suffix not in (".json", ".npz"):
        raise ValueError(f"path: {file} does not end in .json or .npz")
    return suffix


def _check_has_bodies(body: RigidBody, file: Path) -> None:
    if not np.size(body.mass):
        raise ValueError(f"path: {file}: JSON does not tell the shape of an empty stack; .npz does")


def _write_npz(file: Path, name: str, arrays: dict[str, Any]) -> None:
    with writing(file) as stream:  # given a path, numpy would add its suffix to one that ends in .NPZ
        np.savez(stream, format=np.array(name), **arrays)


def _listed(fields: dict[str, Any], file: Path) -> dict[str, Any]:
    """Turn arrays into lists in which what is not a number is null."""
    for name, value in fields.items():
        if isinstance(value, np.ndarray) and value.dtype.kind == "f" and np.isinf(value).any():
            raise ValueError(
                f"path: {file}: {name} is infinite somewhere, which JSON does not have; .npz does"
            )
    return {name: _plain(value) for name, value in fields.items()}


def _plain(value: Any) -> Any:
    if not isinstance(value, np.ndarray | np.generic):
        return value
    if value.dtype.kind != "f" or np.isfinite(value).all():
        return value.tolist()
    return [_plain(part) for part in np.asarray(value)] if value.ndim else None
