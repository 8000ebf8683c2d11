"""Trajectories as files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._files.writing import writing
from polhode.files import save_trajectory_json, save_trajectory_npz

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

    from polhode.trajectory import Trajectory

__all__ = ["TRAJECTORY_SUFFIXES", "save_trajectory"]

_COLUMNS = {"omega": "xyz", "quaternion": "xyzw", "position": "xyz", "velocity": "xyz"}

TRAJECTORY_SUFFIXES = (".csv", ".json", ".npz")


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
    elif suffix == ".json":
        save_trajectory_json(trajectory, file)
    elif suffix == ".npz":
        save_trajectory_npz(trajectory, file)
    else:
        raise ValueError(f"path: {file} does not end in .csv, .json or .npz")


def _save_csv(trajectory: Trajectory, file: Path) -> None:
    if trajectory.t.ndim != 1:
        raise ValueError(
            f"path: {file}: a table has one row for each time, and these are of shape {trajectory.t.shape}; "
            "give times in one row, or save as .npz"
        )
    shape = trajectory.omega.shape[:-2]
    names = ["body"] if len(shape) == 1 else [f"body_{axis}" for axis in range(len(shape))]
    names.append("t")
    times = (*shape, len(trajectory))
    columns: list[NDArray[Any]] = list(np.indices(times)[:-1])
    columns.append(np.broadcast_to(trajectory.t, times))
    for array, components in _COLUMNS.items():
        names += [f"{array}_{component}" for component in components]
        columns += list(np.moveaxis(getattr(trajectory, array), -1, 0))
    rows = np.stack([np.asarray(column, dtype=np.float64).reshape(-1) for column in columns], axis=-1)
    # 17 significant digits give the same float64 back.
    formats = ["%d"] * len(shape) + ["%.17g"] * (len(names) - len(shape))
    with writing(file) as stream:
        np.savetxt(stream, rows, fmt=formats, delimiter=",", header=",".join(names), comments="")
