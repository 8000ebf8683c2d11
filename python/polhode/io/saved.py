"""Bodies and motions as files that keep every bit: what ``save`` writes and ``from_file`` reads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._hints import check_kind
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.records import (
    WORDS,
    array_schema,
    check_names,
    counts,
    in_json,
    numbers,
    read_json,
    read_record,
    record_suffix,
    require_field,
    write_json,
    write_npz,
)
from polhode.io.writing import writing

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from polhode import RigidBody
    from polhode.motion.trajectory import Trajectory

__all__ = [
    "BODY_ARRAYS",
    "BODY_FIELDS",
    "BODY_SCHEMA",
    "TRAJECTORY_SCHEMA",
    "TRAJECTORY_SUFFIXES",
    "body_fields",
    "body_of",
    "check_has_bodies",
    "read_body",
    "read_motion",
    "read_report",
    "save_body",
    "save_trajectory",
    "table_of",
]

_BODY_FORMAT: Final = "polhode.RigidBody/1"
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
        "format": {"const": _BODY_FORMAT},
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
        write_json(file, in_json({"format": _BODY_FORMAT} | fields, file))
    else:
        write_npz(file, _BODY_FORMAT, fields)


def read_body(path: str | PathLike[str]) -> RigidBody:
    """Read a body or a stack that ``RigidBody.save`` wrote.

    Parameters
    ----------
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    file = Path(path)
    return body_of(read_record(file, _BODY_FORMAT, BODY_FIELDS), file)


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
    """Return the fields of a body as a file holds them."""
    principal = body.principal
    return {
        **{name: getattr(body, name) for name in BODY_ARRAYS},
        "principal_moments": principal.moments,
        "principal_axes": principal.axes,
        "numbers": body.__reduce__()[1][0],
        **_doubts_fields(body),
    }


def _doubts_fields(body: RigidBody) -> dict[str, Any]:
    """Return what a body is uncertain by, in numbers that every file holds."""
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
    counts, words, tangents, bends = (
        numbers(require_field(fields, name, file), name, file) for name in _DOUBTS
    )
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
    given = {name: numbers(require_field(fields, name, file), name, file) for name in BODY_ARRAYS}
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


TRAJECTORY_SUFFIXES: Final = (".csv", ".json", ".npz")
_MOTION_FORMAT: Final = "polhode.Trajectory/1"
_STATES: Final = {"t": 0, "omega": 3, "quaternion": 4, "position": 3, "velocity": 3}
_COLUMNS: Final[dict[str, str | tuple[str, ...]]] = {
    "omega": "xyz",
    "quaternion": "xyzw",
    "position": "xyz",
    "velocity": "xyz",
}
_EULER: Final = ("phi", "theta", "psi")
_COUNTS: Final = ("steps", "evaluations")
_ENDS: Final = ("complete", "event", "stopped", "failed", "not run")
_OFF_UNITY: Final = 1e-6
_FIELDS: Final = ("about", *_STATES, *_COUNTS, "status", "pivoted")
_LOADED: Final = "loaded"
_BEGAN: Final = "began"
_STATES_OF_LOAD: Final = "states"
_CARRIED: Final = ("carried_momentum", "carried_energy")
_ARRAYS: Final = (
    *_FIELDS,
    _LOADED,
    _BEGAN,
    *_CARRIED,
    *BODY_ARRAYS,
    *(f"body_{name}" for name in BODY_FIELDS),
)
TRAJECTORY_SCHEMA: dict[str, object] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "The motion of a rigid body, or of a stack of bodies",
    "type": "object",
    "required": ["format", "body", "about", *_STATES],
    "properties": {
        "format": {"const": _MOTION_FORMAT},
        "body": BODY_SCHEMA,
        "about": array_schema("the point of reference in the body, shape (..., 3)"),
        "pivoted": {"description": "whether that point is fixed in space", "type": "boolean"},
        "loaded": {"description": "whether a load acted, which the file does not hold", "type": "boolean"},
        "began": {"description": "when a motion that goes on from another one began", "type": "number"},
        "t": array_schema(
            "times, shape (T,); of a closed form any shape, which stands for (T,) in those below"
        ),
        "omega": array_schema("angular velocity in the body, shape (..., T, 3)"),
        "quaternion": array_schema("attitude R_NB as x, y, z, w, shape (..., T, 4)"),
        "position": array_schema("of the point of reference in space, shape (..., T, 3)"),
        "velocity": array_schema("of the point of reference in space, shape (..., T, 3)"),
        "states": {
            "description": "of the load, by name, each of shape (..., T, k)",
            "type": "object",
            "additionalProperties": {"type": "array"},
        },
        "carried_momentum": array_schema(
            "in the body, of what the body carries along under the load, beside I ω, shape (..., T, 3)"
        ),
        "carried_energy": array_schema("of the same, beside ½ ω·I ω, shape (..., T)"),
        "status": {"description": "how each run ended, shape (...)", "type": ["string", "array"]},
        "steps": array_schema("accepted steps, shape (...)"),
        "evaluations": array_schema("of the equations of motion, shape (...)"),
    },
    "patternProperties": {"^comment$": {"description": "for the reader of the file"}},
    "additionalProperties": False,
}
"""What a motion's JSON file holds, as JSON Schema; a state that is not a number is null."""


def save_trajectory(trajectory: Trajectory, path: str | PathLike[str]) -> None:
    """Write a trajectory to ``.csv``, ``.json`` or ``.npz``: what ``Trajectory.save`` does.

    Parameters
    ----------
    trajectory : Trajectory
        The motion.
    path : str or os.PathLike
        Its suffix chooses the format.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix == ".csv":
        _save_csv(trajectory, file)
        return
    trajectory._check_constant(
        f"path: {file}", "such a file holds one body; pickle keeps it, and .csv holds the states"
    )
    if trajectory.uncertain_start != (None, None):
        raise ValueError(
            f"path: {file}: such a file does not hold what is uncertain of the state at the first time; "
            "pickle keeps it, and .csv holds the states alone"
        )
    if suffix == ".json":
        _save_json(trajectory, file)
    elif suffix == ".npz":
        _save_npz(trajectory, file)
    else:
        raise ValueError(f"path: {file} does not end in .csv, .json or .npz; name it so")


def _save_json(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as JSON.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    check_has_bodies(trajectory.body, path)
    fields: dict[str, Any] = {"format": _MOTION_FORMAT}
    fields["body"] = in_json(body_fields(trajectory.body), path)
    fields |= {name: getattr(trajectory, name) for name in _FIELDS}
    fields[_LOADED] = trajectory._is_driven()
    fields |= _carried_of(trajectory) | _began_of(trajectory)
    if trajectory.states:
        fields[_STATES_OF_LOAD] = in_json(trajectory.states, path)
    write_json(path, in_json(fields, path))


def _save_npz(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as arrays of NumPy, together with those of its body.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    arrays = {name: getattr(trajectory, name) for name in _FIELDS}
    arrays[_LOADED] = np.array(trajectory._is_driven())
    arrays |= _carried_of(trajectory) | _began_of(trajectory)
    arrays |= {f"{_STATES_OF_LOAD}_{name}": values for name, values in trajectory.states.items()}
    arrays |= {name: getattr(trajectory.body, name) for name in BODY_ARRAYS}
    arrays |= {f"body_{name}": value for name, value in body_fields(trajectory.body).items()}
    write_npz(path, _MOTION_FORMAT, arrays)


def _carried_of(trajectory: Trajectory) -> dict[str, Any]:
    return {} if trajectory.carried is None else dict(zip(_CARRIED, trajectory.carried, strict=True))


def _began_of(trajectory: Trajectory) -> dict[str, Any]:
    start = trajectory._origin.start
    return {} if start is None else {_BEGAN: np.array(start)}


def read_motion(path: str | PathLike[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Read the attributes of a :class:`polhode.Trajectory` by name, and the fields of its origin.

    Parameters
    ----------
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    file = Path(path)
    fields = read_record(
        file,
        _MOTION_FORMAT,
        (*_FIELDS, _LOADED, _BEGAN, _STATES_OF_LOAD, *_CARRIED, "body"),
        _ARRAYS,
        (f"{_STATES_OF_LOAD}_",),
    )
    if file.suffix.lower() == ".npz":
        fields["body"] = {
            name.removeprefix("body_"): value for name, value in fields.items() if name.startswith("body_")
        }
    elif not isinstance(fields.get("body"), dict):
        raise FileFormatError(f"{file}: body is not an object with the fields of a body; save it again")
    else:
        check_names(fields["body"], (*BODY_FIELDS, *WORDS), f"{file}: body")
    body = body_of(fields["body"], file)
    t = numbers(require_field(fields, "t", file), "t", file)
    states = {"t": t, "about": numbers(require_field(fields, "about", file), "about", file)}
    expected: dict[str, tuple[int, ...]] = {"about": (*body.shape, 3)}
    stack: tuple[int, ...] = body.shape
    for name, width in _STATES.items():
        if width:
            states[name] = numbers(require_field(fields, name, file), name, file, with_holes=True)
            if name == "omega":
                stack = _stack(states[name].shape, body.shape, t.ndim)
            expected[name] = (*stack, *t.shape, width)
    for name, shape in expected.items():
        if states[name].shape != shape:
            raise FileFormatError(f"{file}: {name} has shape {states[name].shape}, expected {shape}")
    none = np.zeros(stack, dtype=np.int64)
    given = {name: counts(fields.get(name, none), name, file, stack) for name in _COUNTS}
    leading = (*stack, *t.shape)
    ended: dict[str, Any] = {
        "states": _states_of_load(fields, file, leading),
        "carried": _read_wheels(fields, file, leading),
        "status": _status(fields, file, stack),
        "pivoted": _flag(fields, "pivoted", file),
    }
    along = {name: states[name] for name, width in _STATES.items() if width}
    along |= {f"{_STATES_OF_LOAD} {name}": values for name, values in ended["states"].items()}
    if ended["carried"] is not None:
        along |= {_CARRIED[0]: ended["carried"][0], _CARRIED[1]: ended["carried"][1][..., np.newaxis]}
    _check_known(along, np.broadcast_to(ended["status"], stack), t, file)
    _check_unit(states["quaternion"], file)
    if given["steps"].any() or np.any(np.asarray(ended["status"]) != "complete"):
        _check_order(t, file)
    was_loaded = _flag(fields, _LOADED, file)
    if was_loaded and body._doubts() is not None:
        ended["uncertain_start"] = None  # what the body's doubts do to the motion the load decides, too
    origin: dict[str, Any] = {"loaded": was_loaded}
    if _BEGAN in fields:
        began = numbers(fields[_BEGAN], _BEGAN, file)
        if began.ndim:
            raise FileFormatError(f"{file}: {_BEGAN} has shape {began.shape}, expected one number")
        origin["start"] = float(began)
    return {"body": body, **states, **given, **ended}, origin


def _stack(shape: tuple[int, ...], bodies: tuple[int, ...], axes_of_time: int) -> tuple[int, ...]:
    """Return the shape of the stack of motions, to which that of the bodies broadcasts."""
    stack = shape[: max(len(shape) - 1 - axes_of_time, 0)]
    fits = len(stack) >= len(bodies) and all(
        own in (1, length) for own, length in zip(bodies[::-1], stack[::-1], strict=False)
    )
    return stack if fits else bodies


def _states_of_load(fields: dict[str, Any], file: Path, leading: tuple[int, ...]) -> dict[str, Any]:
    if file.suffix.lower() == ".npz":
        prefix = f"{_STATES_OF_LOAD}_"
        held = {name.removeprefix(prefix): fields[name] for name in fields if name.startswith(prefix)}
    else:
        held = fields.get(_STATES_OF_LOAD, {})
        if not isinstance(held, dict):
            raise FileFormatError(
                f"{file}: {_STATES_OF_LOAD} is not an object of arrays by name; save it again"
            )
    states = {}
    for name, values in held.items():
        states[name] = numbers(values, f"{_STATES_OF_LOAD} {name}", file, with_holes=True)
        if states[name].shape[:-1] != leading or not states[name].ndim:
            raise FileFormatError(
                f"{file}: {_STATES_OF_LOAD} {name} has shape {states[name].shape}, expected {(*leading, 'k')}"
            )
    return states


def _read_wheels(
    fields: dict[str, Any], file: Path, leading: tuple[int, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    held = [name for name in _CARRIED if name in fields]
    if not held:
        return None
    found = []
    for name, shape in zip(_CARRIED, ((*leading, 3), leading), strict=True):
        values = numbers(require_field(fields, name, file), name, file, with_holes=True)
        if values.shape != shape:
            raise FileFormatError(f"{file}: {name} has shape {values.shape}, expected {shape}")
        found.append(values)
    return found[0], found[1]


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


def _flag(fields: dict[str, Any], name: str, file: Path) -> bool:
    held = fields.get(name, False)
    if isinstance(held, np.ndarray) and held.dtype == np.bool_ and held.ndim == 0:
        return bool(held)
    if not isinstance(held, bool):
        found = f"{held.dtype} of shape {held.shape}" if isinstance(held, np.ndarray) else repr(held)[:60]
        raise FileFormatError(f"{file}: {name} is {found}, expected true or false")
    return held


def _check_known(along: dict[str, NDArray[Any]], status: NDArray[Any], t: NDArray[Any], file: Path) -> None:
    """Refuse states that are not numbers, but for those after the end of a run that came to no last time."""
    all_known = np.ones((*status.shape, t.size), dtype=bool)
    for name, values in along.items():
        flat = values.reshape(*status.shape, t.size, values.shape[-1])
        known = np.isfinite(flat).all(axis=-1)
        # Of a run that ended early: numbers at its first times, and not one after them, of any kind.
        is_bad = np.where((status == "complete")[..., np.newaxis], ~known, np.isinf(flat).any(axis=-1))
        is_bad |= ~known & np.isfinite(flat).any(axis=-1)
        is_bad[..., 1:] |= known[..., 1:] & ~known[..., :-1]
        if name != next(iter(along)):
            is_bad |= known != all_known
        all_known = known
        if is_bad.any():
            *row, index = (int(place[0]) for place in np.nonzero(is_bad))
            body = f" of body {tuple(row)}" if row else ""
            found, when = flat[(*row, index)].tolist(), float(t.reshape(-1)[index])
            raise FileFormatError(
                f"{file}: {name}{body} is {found} at t = {when!r}, where the status "
                f"{str(status[tuple(row)])!r} says otherwise: states must be numbers until the run ended; "
                "the file was altered or cut after it was written, so save the motion again"
            )


def _check_order(t: NDArray[Any], file: Path) -> None:
    """Refuse times that no integration went through."""
    gaps = np.diff(t) if t.ndim == 1 else np.zeros(1)
    is_bad = ~((gaps > 0.0) if t.size and t[-1] > t[0] else (gaps < 0.0))
    if is_bad.any():
        where = (
            f"t[{np.flatnonzero(is_bad)[0] + 1}] does not follow the time before it"
            if t.ndim == 1
            else (f"t has the shape {t.shape}")
        )
        raise FileFormatError(
            f"{file}: {where}: the times of a run in steps ascend, or descend, strictly, and the file was "
            "altered after it was written; save the motion again"
        )


def _check_unit(quaternion: NDArray[np.float64], file: Path) -> None:
    with np.errstate(over="ignore"):
        squares = np.square(quaternion).sum(axis=-1)
    off = squares[np.abs(squares - 1.0) > _OFF_UNITY]
    if off.size:
        raise FileFormatError(f"{file}: a quaternion has the norm {np.sqrt(off[0]):.9g}, expected 1")


def table_of(trajectory: Trajectory) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Return a motion as columns by name: what names a row (body, time), and what stands in it.

    Parameters
    ----------
    trajectory : Trajectory
        At times of shape (T,).

    Returns
    -------
    index, columns : dict of str and numpy.ndarray, shape (..., T)
        Torques are there where the load is known and all states are numbers.
    """
    shape = trajectory.omega.shape[:-2]
    times = (*shape, len(trajectory))
    places = list(np.indices(times)[:-1])
    names = ["body"] if len(shape) == 1 else [f"body_{axis}" for axis in range(len(shape))]
    index: dict[str, NDArray[Any]] = dict(zip(names, places, strict=True))
    index["t"] = np.broadcast_to(trajectory.t, times)
    vectors = {name: (getattr(trajectory, name), parts) for name, parts in _COLUMNS.items()}
    vectors["euler"] = trajectory.euler_angles("ZXZ", singular="nan"), _EULER
    is_free = not trajectory._is_loaded() and trajectory.carried is None
    is_known = trajectory.load is not None or is_free or trajectory._origin.motion is not None
    if is_known and all(np.isfinite(values).all() for values, _ in list(vectors.values())[:-1]):
        vectors["torque"] = trajectory.torque(), "xyz"
    columns = {
        f"{name}_{part}": values[..., k]
        for name, (values, parts) in vectors.items()
        for k, part in enumerate(parts)
    }
    for name, values in trajectory.states.items():
        columns |= {f"states_{name}_{k}": values[..., k] for k in range(values.shape[-1])}
    return index, columns


def _save_csv(trajectory: Trajectory, file: Path) -> None:
    if trajectory.t.ndim != 1:
        raise ValueError(
            f"path: {file}: a table has one row for each time, and these are of shape {trajectory.t.shape}; "
            "give times in one row, or save as .npz"
        )
    index, columns = table_of(trajectory)
    every = index | columns
    rows = np.stack([np.asarray(column, dtype=np.float64).reshape(-1) for column in every.values()], axis=-1)
    # 17 significant digits give the same float64 back.
    formats = ["%d"] * (len(index) - 1) + ["%.17g"] * (len(columns) + 1)
    with writing(file) as stream:
        np.savetxt(stream, rows, fmt=formats, delimiter=",", header=",".join(every), comments="")
