"""Output of a motion: files, tables of another library, pictures and windows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

    from matplotlib.axes import Axes
    from pandas import DataFrame
    from pyvista import Plotter
    from xarray import Dataset

    from polhode.motion.trajectory import Trajectory

__all__ = ["animate", "plot", "save", "to_pandas", "to_xarray", "view"]


def save(self: Trajectory, path: str | PathLike[str]) -> None:
    """Write the motion to a file, with every bit of it.

    Parameters
    ----------
    path : str or os.PathLike
        The ending of the name tells the format. The load and the events are not written.

        ``.csv`` has one line for each time. The columns are ``t``; ``omega_*``, components in the body frame;
        ``quaternion_*``; ``position_*`` and ``velocity_*``, components in space; the angles ``euler_phi``,
        ``euler_theta``, ``euler_psi`` (ZXZ, in radians, nan where they are not defined); ``torque_*`` of the
        load about the point `about`, components in the body frame; and the states of the load. The torque is
        left out if the load is not known or a state is nan. For a stack, each line begins with the indices of
        the body.

        ``.npz`` has the arrays under the names of the attributes, and ``mass``, ``inertia`` and
        ``center_of_mass`` of the body. ``.json`` is text after the schema
        :data:`polhode.io.TRAJECTORY_SCHEMA`.
    """
    from polhode.io.saved import save_trajectory

    save_trajectory(self, path)


def to_xarray(self: Trajectory) -> Dataset:
    """Give the motion as an :class:`xarray.Dataset`; needs xarray.

    Returns
    -------
    xarray.Dataset
        Its dimensions are ``time``, for a stack after ``body`` (or ``body_0``, ``body_1``, …). Components are
        named ``x y z`` and ``x y z w``; an attribute of each variable names its frame.
    """
    from polhode._optional import require

    xarray = require("xarray", extra=None, purpose="Trajectory.to_xarray")
    self._check_series("to_xarray")
    shape = self.omega.shape[:-2]
    stack = ["body"] if len(shape) == 1 else [f"body_{axis}" for axis in range(len(shape))]
    vector, frames = (
        [*stack, "time", "component"],
        {"omega": "body", "position": "space", "velocity": "space"},
    )
    variables: dict[str, Any] = {
        name: (vector, getattr(self, name), {"frame": frame}) for name, frame in frames.items()
    }
    variables["quaternion"] = (
        [*stack, "time", "quaternion_component"],
        self.quaternion,
        {"long_name": "R_NB, scalar last"},
    )
    for name, values in self.states.items():
        variables[name] = ([*stack, "time", f"{name}_component"], values, {"long_name": "of the load"})
    coordinates = {"time": self.t, "component": list("xyz"), "quaternion_component": list("xyzw")}
    dataset: Dataset = xarray.Dataset(variables, coordinates, {"title": repr(self)})
    return dataset


def to_pandas(self: Trajectory) -> DataFrame:
    """Give the motion as a :class:`pandas.DataFrame`; needs pandas.

    Returns
    -------
    pandas.DataFrame
        A row for each time, indexed by ``t``, after ``body`` (or ``body_0``, ``body_1``, …) of a stack; its
        columns are those of the ``.csv`` that `save` writes.
    """
    from polhode._optional import require
    from polhode.io.saved import table_of

    pandas = require("pandas", extra=None, purpose="Trajectory.to_pandas")
    self._check_series("to_pandas")
    index, columns = table_of(self)
    rows = pandas.MultiIndex.from_arrays([values.ravel() for values in index.values()], names=list(index))
    if len(index) == 1:
        rows = pandas.Index(index["t"], name="t")
    table: DataFrame = pandas.DataFrame(
        {name: values.ravel() for name, values in columns.items()}, index=rows
    )
    return table


def plot(self: Trajectory, ax: Axes | None = None) -> Axes:
    """Draw the components of the angular velocity in the body over time; needs matplotlib.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    matplotlib.axes.Axes
    """
    from polhode.plot import angular_velocity

    return angular_velocity(self, ax)


def view(self: Trajectory, plotter: Plotter | None = None, **options: Any) -> Plotter:
    """Show the motion of one body in a window; needs pyvista.

    Parameters
    ----------
    plotter : pyvista.Plotter, optional
        Where to show it; a new one by default.
    **options
        `at`, `shape`, `duration`, `title` and `time_label`, see :func:`polhode.view.motion`.

    Returns
    -------
    pyvista.Plotter
        Its ``show()`` opens the window.
    """
    from polhode.view import motion

    return motion(self, plotter, **options)


def animate(self: Trajectory, path: str | PathLike[str], **options: Any) -> Path:
    """Write the motion of one body as a moving picture.

    Parameters
    ----------
    path : str or os.PathLike
        ``.html``: an interactive page that needs nothing else; ``.gif``: needs matplotlib;
        ``.mp4``: needs also the program ffmpeg, which the extra ``film`` brings.
    **options
        `shape`, `frames`, `duration`, `title`, `time_label`, `size`, `fps`, `labels` and `progress`, see
        :func:`polhode.animation.animate`.

    Returns
    -------
    pathlib.Path
        Where it was written.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import numpy as np
    >>> from polhode import solids
    >>> motion = solids.box((3, 2, 1), mass=1.0).simulate(np.linspace(0, 10, 201), omega=(0.01, 1, 0))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     page = motion.animate(Path(folder) / "racket.html", title="The tennis racket")
    ...     page.read_text(encoding="utf-8")[:15]
    '<!DOCTYPE html>'
    """
    from polhode.animation import animate

    return animate(self, path, **options)
