"""Motions as moving pictures: an interactive page, a GIF or a film."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from polhode._scene.scene import Scene
from polhode.animation._page import page
from polhode.files.writing import write_bytes

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory
    from polhode._scene.shape import GivenShape

__all__ = ["ANIMATION_SUFFIXES", "animate"]

ANIMATION_SUFFIXES = (".html", ".gif", ".mp4")


def animate(
    trajectory: Trajectory,
    path: str | PathLike[str],
    *,
    shape: GivenShape | None = None,
    frames: int | None = None,
    duration: float | None = None,
    title: str = "Motion of a rigid body",
    time_unit: str = "s",
    progress: Callable[[float], object] | None = None,
) -> Path:
    """Write the motion of one body as a moving picture: what ``Trajectory.animate`` does.

    Parameters
    ----------
    trajectory : Trajectory
        The motion of one body.
    path : str or os.PathLike
        ``.html`` is an interactive page that needs no network: the body, its principal axes, ω, L (with that
        of wheels, and theirs as h) and their paths in space, and the path of ω on the ellipsoid of inertia in
        the body; with a slider for time, and views that turn with the pointer. ``.gif`` and ``.mp4`` need
        matplotlib, the latter also ffmpeg, which the extra ``film`` brings.
    shape : (vertices, faces), optional
        A mesh of the body in its frame, (n, 3) and (m, 3). By default the uniform box that has its inertia.
    frames : int, optional
        Number of samples shown, evenly chosen. By default as many as the motion needs: where nothing acts on
        the body, the states between its samples are those of its exact motion, and from one frame to the next
        the body turns by 20 degrees at most and ω keeps to its ellipsoid to 0.2 %. Otherwise all samples.
    duration : float, optional
        Seconds that the motion takes on the screen; by default 10, and more where at 30 pictures a second the
        body would turn by more than 20 degrees from one to the next.
    title, time_unit : str, optional
        As the viewer reads them.
    progress : callable, optional
        Is told the fraction of a film that is drawn; an exception it raises ends the drawing.

    Returns
    -------
    pathlib.Path
        Where it was written.

    Raises
    ------
    ValueError
        If the body turns by half a turn or more from one frame to the next: it would seem to turn backward.

    Warns
    -----
    UserWarning
        If it turns by more than 30 degrees, or the end of the motion is not shown.
    """
    file = _checked(path)
    scene = Scene.of(
        trajectory,
        frames=frames,
        duration=duration,
        shape=shape,
        title=title,
        time_unit=time_unit,
        is_film=file.suffix.lower() != ".html",
        is_page=file.suffix.lower() == ".html",
    )
    for note in scene.notes:
        warnings.warn(note, stacklevel=3)  # where Trajectory.animate is called
    _write(scene, file, progress)
    return file


def animate_motion(
    motion: FreeMotion | HeavyTop | GyrostatMotion,
    end: float,
    path: str | PathLike[str],
    *,
    shape: GivenShape | None = None,
    title: str = "Motion of a rigid body",
    progress: Callable[[float], object] | None = None,
) -> tuple[str, ...]:
    """Write the motion of one body in closed form as a moving picture, with the frames that it needs.

    Parameters
    ----------
    motion : FreeMotion, HeavyTop or GyrostatMotion
        Of one body.
    end : float
        What is shown is from 0 s to this time.
    path, shape, title, progress
        As of `animate`.

    Returns
    -------
    tuple of str
        What the viewer does not see of the motion.
    """
    file = _checked(path)
    scene = Scene.of_motion(
        motion,
        end,
        shape=shape,
        title=title,
        is_film=file.suffix.lower() != ".html",
        is_page=file.suffix.lower() == ".html",
    )
    _write(scene, file, progress)
    return scene.notes


def _checked(path: str | PathLike[str]) -> Path:
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in ANIMATION_SUFFIXES:
        raise ValueError(
            f"path: {file} does not end in {', '.join(ANIMATION_SUFFIXES[:-1])} or {ANIMATION_SUFFIXES[-1]}"
        )
    return file


def _write(scene: Scene, file: Path, progress: Callable[[float], object] | None) -> None:
    if file.suffix.lower() == ".html":
        write_bytes(file, page(scene).encode())
    else:
        from polhode.animation.film import film

        film(scene, file, progress)
