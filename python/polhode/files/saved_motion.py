"""Motions as files: what ``Trajectory.save`` writes and ``Trajectory.from_file`` reads, to the last bit."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._hints import check_kind
from polhode.errors import FileFormatError
from polhode.files.fields import counts, numbers, write_json
from polhode.files.record import WORDS, array_schema, check_names, in_json, read_record, required, write_npz
from polhode.files.saved_body import (
    BODY_ARRAYS,
    BODY_FIELDS,
    BODY_SCHEMA,
    body_fields,
    body_of,
    check_has_bodies,
)
from polhode.files.writing import writing

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from polhode.trajectory import Trajectory

__all__ = [
    "TRAJECTORY_SCHEMA",
    "TRAJECTORY_SUFFIXES",
    "read_motion",
    "save_trajectory",
    "save_trajectory_json",
    "save_trajectory_npz",
    "table_of",
]

TRAJECTORY_SUFFIXES: Final = (".csv", ".json", ".npz")

_FORMAT: Final = "polhode.Trajectory/1"
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
        "format": {"const": _FORMAT},
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
    elif trajectory.uncertain_start != (None, None):
        raise ValueError(
            f"path: {file}: such a file does not hold what is uncertain of the state at the first time; "
            "pickle keeps it, and .csv holds the states alone"
        )
    elif suffix == ".json":
        save_trajectory_json(trajectory, file)
    elif suffix == ".npz":
        save_trajectory_npz(trajectory, file)
    else:
        raise ValueError(f"path: {file} does not end in .csv, .json or .npz; name it so")


def save_trajectory_json(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as JSON.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    check_has_bodies(trajectory.body, path)
    fields: dict[str, Any] = {"format": _FORMAT}
    fields["body"] = in_json(body_fields(trajectory.body), path)
    fields |= {name: getattr(trajectory, name) for name in _FIELDS}
    fields[_LOADED] = trajectory._is_loaded()
    fields |= _carried_of(trajectory) | _began_of(trajectory)
    if trajectory.states:
        fields[_STATES_OF_LOAD] = in_json(trajectory.states, path)
    write_json(path, in_json(fields, path))


def save_trajectory_npz(trajectory: Trajectory, path: Path) -> None:
    """Write a motion as arrays of NumPy, together with those of its body.

    Parameters
    ----------
    trajectory : Trajectory
    path : pathlib.Path
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    arrays = {name: getattr(trajectory, name) for name in _FIELDS}
    arrays[_LOADED] = np.array(trajectory._is_loaded())
    arrays |= _carried_of(trajectory) | _began_of(trajectory)
    arrays |= {f"{_STATES_OF_LOAD}_{name}": values for name, values in trajectory.states.items()}
    arrays |= {name: getattr(trajectory.body, name) for name in BODY_ARRAYS}
    arrays |= {f"body_{name}": value for name, value in body_fields(trajectory.body).items()}
    write_npz(path, _FORMAT, arrays)


def _carried_of(trajectory: Trajectory) -> dict[str, Any]:
    return {} if trajectory.carried is None else dict(zip(_CARRIED, trajectory.carried, strict=True))


def _began_of(trajectory: Trajectory) -> dict[str, Any]:
    held = trajectory.__dict__.get("_began")
    return {} if held is None else {_BEGAN: np.array(held)}


def read_motion(path: str | PathLike[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Read the attributes of a :class:`polhode.Trajectory` by name, and what it knows besides.

    Parameters
    ----------
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    file = Path(path)
    fields = read_record(
        file,
        _FORMAT,
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
    t = numbers(required(fields, "t", file), "t", file)
    states = {"t": t, "about": numbers(required(fields, "about", file), "about", file)}
    expected: dict[str, tuple[int, ...]] = {"about": (*body.shape, 3)}
    stack: tuple[int, ...] = body.shape
    for name, width in _STATES.items():
        if width:
            states[name] = numbers(required(fields, name, file), name, file, with_holes=True)
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
        "carried": _carried(fields, file, leading),
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
    known: dict[str, Any] = {"_was_loaded": True} if was_loaded else {}
    if _BEGAN in fields:
        began = numbers(fields[_BEGAN], _BEGAN, file)
        if began.ndim:
            raise FileFormatError(f"{file}: {_BEGAN} has shape {began.shape}, expected one number")
        known["_began"] = float(began)
    return {"body": body, **states, **given, **ended}, known


def _stack(shape: tuple[int, ...], bodies: tuple[int, ...], axes_of_time: int) -> tuple[int, ...]:
    """Give the shape of the stack of motions, to which that of the bodies broadcasts."""
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


def _carried(
    fields: dict[str, Any], file: Path, leading: tuple[int, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    held = [name for name in _CARRIED if name in fields]
    if not held:
        return None
    found = []
    for name, shape in zip(_CARRIED, ((*leading, 3), leading), strict=True):
        values = numbers(required(fields, name, file), name, file, with_holes=True)
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
    """Give a motion as columns by name: what names a row (body, time), and what stands in it.

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
    is_known = trajectory.load is not None or is_free or "_within" in trajectory.__dict__
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
