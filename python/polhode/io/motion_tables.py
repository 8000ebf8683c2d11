"""Records of motions as tables: columns of times, attitudes and angular velocities, found by their names."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import read_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from os import PathLike

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["MotionTable", "read_motion_table"]

_TIMES: Final = ("t", "time", "times", "timestamp", "sec", "secs", "seconds", "simtime")
_QUATERNIONS: Final = tuple(
    tuple(f"{stem}{part}" for part in "xyzw")
    for stem in ("q", "quaternion", "quat", "attitude", "orientation", "rotation", "rot", "poseorientation")
)
_OMEGAS: Final = tuple(
    tuple(f"{stem}{part}" for part in "xyz")
    for stem in (
        "w",
        "omega",
        "angularvelocity",
        "angvel",
        "angularvel",
        "gyro",
        "rate",
        "twistangular",
        "ang",
    )
)
_WITHOUT: Final = {5: (0, (1, 2, 3, 4), ()), 8: (0, (1, 2, 3, 4), (5, 6, 7))}
"""Columns of a table without names, by their number: t, x, y, z, w, and ω."""


class MotionTable(NamedTuple):
    """A record as it stands in a file.

    Attributes
    ----------
    t : numpy.ndarray, shape (T,)
    attitude : numpy.ndarray, shape (T, 4), (T, 3, 3) or (T, 3)
    omega : numpy.ndarray, shape (T, 3), or None
    columns : dict of str and list of str
        The names of the columns that were read, by what they were taken for.
    """

    t: Floats
    attitude: Floats
    omega: Floats | None
    columns: dict[str, list[str]]


def read_motion_table(
    path: str | PathLike[str],
    *,
    time: str | None = None,
    attitude: Sequence[str] = (),
    omega: Sequence[str] = (),
    name: str | None = None,
) -> MotionTable:
    """Read a table with a row for each time, separated by commas, semicolons, tabs or blanks.

    Parameters
    ----------
    path : str or os.PathLike
        A line that begins with # is a remark. An empty cell, or ``nan``, is unknown.
    time, attitude, omega : str and sequences of str, optional
        Names of the columns; by default those with the usual names. An attitude has four columns (x, y, z,
        w), nine (a matrix row by row) or three (Euler angles).
    name : str, optional
        Name of the file in errors.
    """
    told = str(path) if name is None else name
    lines = read_text(path, "a table of a motion").splitlines()
    rows = [(k, line) for k, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if not rows:
        raise FileFormatError(f"{told}: it holds no rows; write one for each time")
    first = rows[0][1]
    mark = next((mark for mark in (",", ";", "\t") if mark in first), None)
    names = [part.strip().strip('"') for part in first.split(mark)]
    if all(_is_number(part) for part in names):
        return _without_names(told, rows, mark, len(names), (time, attitude, omega))
    if len(rows) == 1:
        raise FileFormatError(f"{told}: it holds no rows below the names of its columns")
    found = {
        "t": _find_columns(told, names, [time] if time else (), tuple((one,) for one in _TIMES), "--time"),
        "attitude": _find_columns(told, names, attitude, _QUATERNIONS, "--attitude"),
        "omega": _find_columns(told, names, omega, _OMEGAS, "--omega", needed=False),
    }
    if len(found["attitude"]) not in (3, 4, 9):
        raise PolhodeError(
            f"--attitude: expected 4 columns of a quaternion x, y, z, w, 9 of a matrix, or 3 of Euler "
            f"angles, got {len(found['attitude'])}"
        )
    if len(found["omega"]) not in (0, 3):
        raise PolhodeError(f"--omega: expected 3 columns, got {len(found['omega'])}")
    return _table(told, rows[1:], mark, names, found)


def _is_number(text: str) -> bool:
    try:
        float(text or "nan")
    except ValueError:
        return False
    return True


def _plain(name: str) -> str:
    """Return a name without unit, marks and case: ``"omega_x [rad/s]"`` is ``"omegax"``."""
    return re.sub(r"[^a-z0-9]", "", re.sub(r"[\[(].*", "", name.lower()))


def _find_columns(
    told: str,
    names: list[str],
    given: Sequence[str],
    usual: Sequence[Sequence[str]],
    option: str,
    *,
    needed: bool = True,
) -> list[int]:
    """Return the columns with the given or the usual names."""
    if given:
        for one in given:
            if one not in names:
                raise PolhodeError(f"{option}: {told} has no column {one!r}; it has {', '.join(names)}")
        return [names.index(one) for one in given]
    plain = [_plain(one) for one in names]
    for wanted in usual:
        if all(plain.count(one) == 1 for one in wanted):
            return [plain.index(one) for one in wanted]
    if not needed:
        return []
    raise FileFormatError(
        f"{told}: no columns are called as those for {option} mostly are, such as "
        f"{' '.join(usual[0])}; name them with {option}; there are {', '.join(names)}"
    )


def _without_names(
    told: str, rows: list[tuple[int, str]], mark: str | None, count: int, given: tuple[Any, ...]
) -> MotionTable:
    if any(given):
        raise FileFormatError(
            f"{told}: its columns have no names to choose from; put them into the first line"
        )
    if count not in _WITHOUT:
        raise FileFormatError(
            f"{told}: {count} columns without names; put names into the first line, or write t qx qy qz qw, "
            "or these and wx wy wz"
        )
    t, attitude, omega = _WITHOUT[count]
    names = ["t", "qx", "qy", "qz", "qw", "wx", "wy", "wz"][:count]
    return _table(told, rows, mark, names, {"t": [t], "attitude": [*attitude], "omega": [*omega]})


def _table(
    told: str, rows: list[tuple[int, str]], mark: str | None, names: list[str], found: dict[str, list[int]]
) -> MotionTable:
    """Read the columns that were found."""
    used = [column for columns in found.values() for column in columns]
    text = [line for _, line in rows]
    try:
        values = np.loadtxt(text, delimiter=mark, usecols=used, ndmin=2)
    except ValueError:  # empty cells, or what is no number
        values = _cell_by_cell(told, rows, mark, names, used)
    ends = np.cumsum([len(columns) for columns in found.values()])
    t, attitude, omega = values[:, 0], values[:, ends[0] : ends[1]], values[:, ends[1] :]
    if attitude.shape[1] == 9:
        attitude = attitude.reshape(-1, 3, 3)
    columns = {name: [names[k] for k in places] for name, places in found.items() if places}
    return MotionTable(t, attitude, omega if omega.shape[1] else None, columns)


def _cell_by_cell(
    told: str, rows: list[tuple[int, str]], mark: str | None, names: list[str], used: list[int]
) -> Floats:
    values = np.empty((len(rows), len(used)))
    for k, (number, line) in enumerate(rows):
        cells = [part.strip() for part in line.split(mark)]
        for j, column in enumerate(used):
            cell = cells[column] if column < len(cells) else None
            if cell is None or not _is_number(cell):
                what = "is missing" if cell is None else f"{cell[:40]!r} is no number"
                raise FileFormatError(f"{told}: line {number}: {names[column]} {what}; correct the line")
            values[k, j] = float(cell or "nan")
    return values


class Log(NamedTuple):
    """Columns of a log of sensors.

    Attributes
    ----------
    values : dict of str and numpy.ndarray, shape (n, k)
        What was found, by what it was asked for as.
    columns : dict of str and list of str
        The names of the columns, as they stand in the file.
    """

    values: dict[str, Floats]
    columns: dict[str, list[str]]


_SENSORS: Final[dict[str, tuple[tuple[str, ...], ...]]] = {
    "time": tuple((one,) for one in (*_TIMES, "timestampms", "timems", "tms", "secondselapsed", "elapsed")),
    "omega": (
        *_OMEGAS,
        ("gx", "gy", "gz"),
        ("gyroscopex", "gyroscopey", "gyroscopez"),
        ("omx", "omy", "omz"),
        ("xgyro", "ygyro", "zgyro"),
    ),
    "force": (
        ("fx", "fy", "fz"),
        ("forcex", "forcey", "forcez"),
        ("wrenchforcex", "wrenchforcey", "wrenchforcez"),
    ),
    "torque": (
        ("tx", "ty", "tz"),
        ("torquex", "torquey", "torquez"),
        ("mx", "my", "mz"),
        ("wrenchtorquex", "wrenchtorquey", "wrenchtorquez"),
    ),
    # No "linear acceleration": it is with gravity for some and without it for others.
    "specific_force": (
        ("ax", "ay", "az"),
        ("accx", "accy", "accz"),
        ("accelx", "accely", "accelz"),
        ("accelerometerx", "accelerometery", "accelerometerz"),
        ("specificforcex", "specificforcey", "specificforcez"),
    ),
    "angular_acceleration": (
        ("alphax", "alphay", "alphaz"),
        ("angularaccelerationx", "angularaccelerationy", "angularaccelerationz"),
    ),
}
"""Usual names of columns, by what they hold."""


def read_log(
    path: str | PathLike[str], asked: Mapping[str, Sequence[str]], optional: Sequence[str], name: str
) -> Log:
    """Read the columns of a log of sensors, by their usual names or by those that are given.

    Parameters
    ----------
    path : str or os.PathLike
        A table with names in its first line; an empty cell, or ``nan``, is unknown.
    asked : mapping of str and sequence of str
        What is to be read (``time``, ``omega`` ...), with the names of its columns, or none.
    optional : sequence of str
        What may be missing.
    name : str
        Name of the file in errors.
    """
    lines = read_text(path, "a log of sensors").splitlines()
    rows = [(k, line) for k, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if len(rows) < 2:
        raise FileFormatError(f"{name}: it holds no rows below the names of its columns")
    first = rows[0][1]
    mark = next((mark for mark in (",", ";", "\t") if mark in first), None)
    names = [part.strip().strip('"') for part in first.split(mark)]
    if all(_is_number(part) for part in names):
        raise FileFormatError(f"{name}: its columns have no names; write them into the first line")
    found: dict[str, list[int]] = {}
    for what, given in asked.items():
        option = "--" + what.replace("_", "-")
        places = _find_columns(name, names, given, _SENSORS[what], option, needed=what not in optional)
        expected = 1 if what == "time" else 3
        if places and len(places) != expected:
            raise PolhodeError(f"{option}: expected {expected} columns, got {len(places)}")
        if places:
            found[what] = places
    used = [place for places in found.values() for place in places]
    try:
        values = np.loadtxt([line for _, line in rows[1:]], delimiter=mark, usecols=used, ndmin=2)
    except ValueError:
        values = _cell_by_cell(name, rows[1:], mark, names, used)
    ends = np.cumsum([0, *(len(places) for places in found.values())])
    parts = {what: values[:, a:b] for what, a, b in zip(found, ends, ends[1:], strict=False)}
    return Log(parts, {what: [names[k] for k in places] for what, places in found.items()})
