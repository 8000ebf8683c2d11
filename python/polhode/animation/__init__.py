"""Motions as moving pictures: an interactive page, a GIF or a film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from polhode._files.writing import write_bytes
from polhode.animation.page import page
from polhode.animation.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    from numpy.typing import ArrayLike

    from polhode import Trajectory

__all__ = ["ANIMATION_SUFFIXES", "animate"]

ANIMATION_SUFFIXES = (".html", ".gif", ".mp4")


def animate(
    trajectory: Trajectory,
    path: str | PathLike[str],
    *,
    shape: tuple[ArrayLike, ArrayLike] | None = None,
    frames: int | None = None,
    duration: float = 10.0,
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
        ``.html`` is an interactive page that needs no network: the body, its principal axes, ω, L and their
        paths in space, and the path of ω on the ellipsoid of inertia in the body; with a slider for time, and
        views that turn with the pointer. ``.gif`` and ``.mp4`` need matplotlib, the latter also ffmpeg, which
        the extra ``film`` brings.
    shape : (vertices, faces), optional
        A mesh of the body in its frame, (n, 3) and (m, 3). By default the uniform box that has its inertia.
    frames : int, optional
        Number of samples shown, evenly chosen; all of them by default.
    duration : float, optional
        Seconds that the motion takes on the screen.
    title, time_unit : str, optional
        As the viewer reads them.
    progress : callable, optional
        Is told the fraction of a film that is drawn; an exception it raises ends the drawing.

    Returns
    -------
    pathlib.Path
        Where it was written.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in ANIMATION_SUFFIXES:
        raise ValueError(
            f"path: {file} does not end in {', '.join(ANIMATION_SUFFIXES[:-1])} or {ANIMATION_SUFFIXES[-1]}"
        )
    scene = Scene.of(
        trajectory, frames=frames, duration=duration, shape=shape, title=title, time_unit=time_unit
    )
    if suffix == ".html":
        write_bytes(file, page(scene).encode())
    else:
        from polhode.animation.film import film

        film(scene, file, progress)
    return file
