"""What ``polhode spin`` saves: a picture, an animation or the numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, TypeAlias

import numpy as np

from polhode._extras import require
from polhode._scene.sampling import TURN, motion_times, turns
from polhode._scene.triangles import joined
from polhode.animation import ANIMATION_SUFFIXES, animate_motion
from polhode.cli.progress import progress
from polhode.errors import PolhodeError
from polhode.files.picture import save_picture
from polhode.files.saved_motion import TRAJECTORY_SUFFIXES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory
    from polhode.cli.loading import LoadedBody
    from polhode.cli.motion_options import SpinOptions
    from polhode.cli.options import BodyOptions

    Part: TypeAlias = tuple[NDArray[np.float64], NDArray[np.int64]]

__all__ = ["DRAWN", "check_paths", "drawable", "save"]

PICTURE_SUFFIXES: Final = (".png", ".pdf", ".svg")
_SUFFIXES: Final = (*PICTURE_SUFFIXES, *ANIMATION_SUFFIXES, *TRAJECTORY_SUFFIXES)
DRAWN: Final = (*PICTURE_SUFFIXES, *ANIMATION_SUFFIXES)
"""Of files that show the body itself."""
_MOST: Final = 10_000
"""Triangles that are drawn of a mesh."""


def check_paths(paths: Sequence[Path]) -> None:
    """Refuse what cannot be written before anything is computed."""
    for path in paths:
        if path.suffix.lower() not in _SUFFIXES:
            raise PolhodeError(
                f"--save: {path} has a suffix that is not written; use one of {', '.join(_SUFFIXES)}"
            )


def drawable(loaded: LoadedBody, options: BodyOptions) -> tuple[Part | None, str]:
    """Give the mesh as it is drawn, if there is one, and a note where it is coarser."""
    if loaded.shape is None:
        return None, ""
    vertices, faces, side = joined(loaded.shape.vertices, loaded.shape.faces, _MOST)
    note = ""
    if side > 0.0:
        note = (
            f"drawn coarser: {len(faces)} triangles for {len(loaded.shape.faces)}, corners within cells of "
            f"{side:.3g} {loaded.length} joined; the numbers are those of the whole mesh"
        )
    if options.orient or options.closure is not None:  # a triangle is seen from its outside alone
        faces = np.concatenate([faces, faces[:, ::-1]])
    return (vertices, faces), note


def save(
    motion: FreeMotion | HeavyTop | GyrostatMotion,
    samples: Trajectory,
    path: Path,
    spin: SpinOptions,
    *,
    title: str,
    part: Part | None,
) -> tuple[str, ...]:
    """Write a motion in the form that the name asks for, the body drawn as `part` or as a box.

    Numbers are those of the samples; what is drawn follows the motion. Returned is what the file does not
    show of it.
    """
    suffix, end = path.suffix.lower(), float(samples.t[-1])
    if suffix in TRAJECTORY_SUFFIXES:
        samples.save(path)
        return _between(samples)
    if suffix in ANIMATION_SUFFIXES:
        with progress(f"drawing {path.name}", is_long=suffix != ".html") as tell:
            return animate_motion(
                motion, end, path, title=title or "Motion of a rigid body", shape=part, progress=tell
            )
    span = motion_times(motion, np.array([0.0, end]))
    _draw(motion.at(span.t), path, spin, title, part)
    if span.is_whole:
        return ()
    return (
        f"shown is the beginning, to {span.t[-1]:.6g} of {end:.6g} s: {len(span.t)} points follow the motion "
        "no farther; an earlier --until shows all of it",
    )


def _between(samples: Trajectory) -> tuple[str, ...]:
    """Give a note where the body turns so far between two times that the numbers do not show how."""
    widest = float(turns(samples.t, samples.omega).max())
    if widest < np.pi:
        return ()
    needed = np.ceil(len(samples) * widest / TURN)
    return (
        f"from one of its times to the next the body turns by up to {np.rad2deg(widest):.4g} deg, which the "
        f"numbers do not tell from less; --samples {needed:.7g} follows it",
    )


def _draw(trajectory: Trajectory, path: Path, spin: SpinOptions, title: str, part: Part | None) -> None:
    figure_module = require("matplotlib.figure", extra="plot", purpose=f"--save {path}:")
    from polhode.plot import angular_velocity, body, principal_axes
    from polhode.plot._style import show_around

    # A figure of its own, outside pyplot: no window system is asked for.
    figure = figure_module.Figure(figsize=(8.0 if part is None else 12.0, 4.5), layout="constrained")
    place = figure.add_subplot() if part is None else figure.add_subplot(1, 3, (2, 3))
    if part is not None:
        vertices = part[0] - trajectory.body.center_of_mass
        picture = figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False)
        body(vertices, part[1], picture)
        length = 1.06 * float(np.linalg.norm(vertices[part[1]], axis=-1).max())
        principal_axes(trajectory.body, picture, length=length, center=np.zeros(3))
        show_around(picture, np.zeros(3), 0.9 * length)
    frame: Literal["body", "principal"] = "principal" if spin.axes == "principal" else "body"
    ax = angular_velocity(trajectory, place, frame=frame, degrees=spin.degrees)
    ax.set_title(title, loc="left", parse_math=False)
    save_picture(figure, path)
