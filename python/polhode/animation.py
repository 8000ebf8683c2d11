"""Motions as moving pictures: an interactive page, a GIF or a film."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._hints import with_hints
from polhode.draw.animation.page import page
from polhode.draw.sampling import GIF_RATE
from polhode.draw.scene import Scene
from polhode.io.writing import write_bytes

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory
    from polhode.draw.shape import GivenShape

__all__ = ["ANIMATION_SUFFIXES", "animate"]

ANIMATION_SUFFIXES = (".html", ".gif", ".mp4")


@with_hints
def animate(
    trajectory: Trajectory | FreeMotion | HeavyTop | GyrostatMotion,
    path: str | PathLike[str],
    *,
    end: float | None = None,
    shape: GivenShape | None = None,
    frames: int | None = None,
    duration: float | None = None,
    title: str = "Motion of a rigid body",
    time_label: str = "s",
    size: int | tuple[int, int] | None = None,
    fps: float | None = None,
    labels: bool = True,
    progress: Callable[[float], object] | None = None,
) -> Path:
    """Write the motion of one body as a moving picture: what ``Trajectory.animate`` does.

    Parameters
    ----------
    trajectory : Trajectory, FreeMotion, HeavyTop or GyrostatMotion
        The motion of one body. Its wheels are drawn as discs outside the body, not to scale, which turn by
        their angle relative to the body. A wheel whose momentum alone is known, as for
        :func:`polhode.loads.rotor`, does not turn.
    path : str or os.PathLike
        Name of the file; its ending tells the format. ``.html`` is an interactive page that needs no network.
        ``.gif`` and ``.mp4`` need matplotlib; ``.mp4`` also needs ffmpeg, which the extra ``film`` brings.

        The page shows the body and its principal axes; ω, L and the path of ω in space; and the angular
        momentum h of wheels, which is part of L. For a top it shows the path of the axis.

        A second view shows the path in the body, on what stays constant. For a free body this is the polhode
        on the ellipsoid of inertia, with the separatrix. The page also shows this ellipsoid rolling on its
        plane, and has sliders for another start, whose motion it computes itself. For a body with a rotor, or
        with wheels that turn freely or at constant rates, it is the path of L on the sphere of constant
        ``|L|``, with the steady spins and their separatrices. If only motors and dampers inside the body act,
        the path of L is shown on this sphere alone. If a torque acts from outside, the path of ω is shown
        without a surface.

        For a body that rolls, pages and films show its surface on its plane, which the view follows, and the
        traces of the contact on the plane and on the body. The second view shows the trace on the body, and
        the page the friction that rolling needs. On a turntable the first trace is that in space.

        The page shows the speeds of wheels, and kinetic energy T, potential energy V and their sum if the
        load has a potential; these are in the units of the input. A wheel that turns by more than 20 degrees
        from picture to picture is drawn 2, 5, 10, … times slower, and the page says so.
    end : float, optional
        For a motion in closed form, which has no times of its own: the motion is shown from 0 to this time.
    shape : (vertices, faces) or list, optional
        A mesh of the body in its frame, (n, 3) and (m, 3); or a list of parts, each a mesh or a body. By
        default the shape is that from which the body was made: solids, sheets, wires, a mesh of up to 20,000
        triangles, up to 256 particles, or up to 256 parts of these kinds. If only the inertia is known, or
        the body was read from a saved file, it is the uniform box with the same inertia. For a body that
        rolls it is the surface that touches the plane. In a given mesh with
        more than 20,000 triangles, nearby corners are joined, and a message says so.
    frames : int, optional
        Number of states shown, evenly chosen. By default there are as many as needed for a free body, or for
        a heavy top under gravity alone. The closed form then gives further states between the samples, so
        that the body turns by at most 20 degrees between two pictures of a film, and by at most 40 degrees
        between two states of a page, which interpolates between them. For any other motion the states are
        the samples themselves.
    duration : float, optional
        Duration on the screen, in seconds. By default a page shows the motion in real time, or slower or
        faster by a round factor, which it names. A film takes 10 seconds by default, or longer so that the
        body turns by at most 20 degrees from picture to picture.
    title, time_label : str, optional
        Title, and word for the unit of the times; it converts no number. Under the words ns, us, ms, s, min,
        h, d and yr a page knows how fast real time is.
    size : int or (int, int), optional
        Size of a film: width and height in pixels; 480 by default.
    fps : float, optional
        Rate of a film: pictures a second, at most 50 of a GIF; 30 by default. A GIF stores times in
        hundredths of a second. At 30 pictures a second they are shown for 3, 3 and 4 hundredths in turn.
    labels : bool, optional
        Whether a film has text: names of arrows, axes and wheels, title, time, speeds of wheels. In a small
        picture, names without room are left out, and a long title has several lines.
    progress : callable, optional
        A function that is called with the fraction of a film that has been drawn. An exception that it raises
        ends the drawing.

    Returns
    -------
    pathlib.Path
        Where it was written.

    Raises
    ------
    ValueError
        If the body turns by half a turn or more from one frame to the next, since it would seem to turn
        backward.

    Warns
    -----
    UserWarning
        If it turns by more than 30 degrees between two samples, or between two pictures of a film for which
        `frames`, `duration` or `fps` is given; or if the end of the motion is not shown. A page for which the
        closed form gives the states needs no warning.
    """
    file = _check_suffix(path)
    if fps is not None and not 1.0 <= fps <= (GIF_RATE if file.suffix.lower() == ".gif" else 240.0):
        raise ValueError(f"fps: {fps} is not from 1 to 240 pictures a second, or 50 of a GIF")
    scene = scene_of(
        trajectory,
        end,
        frames=frames,
        duration=duration,
        shape=shape,
        title=title,
        time_label=time_label,
        fps=fps,
        is_page=file.suffix.lower() == ".html",
    )
    for note in scene.notes:
        warnings.warn(note, stacklevel=3)  # where Trajectory.animate is called
    _write(scene, file, progress, size=size, labels=labels)
    return file


def scene_of(
    motion: Any,
    end: float | None = None,
    *,
    is_page: bool,
    frames: int | None = None,
    time_label: str = "s",
    **options: Any,
) -> Scene:
    """Choose the frames of a trajectory, or of a motion in closed form, for a page or a film."""
    kind: dict[str, Any] = {"is_page": is_page, "is_film": not is_page, "time_unit": time_label}
    if hasattr(motion, "t"):
        if end is not None:
            raise ValueError("end: a trajectory has its own times; leave it out")
        return Scene.of(motion, frames=frames, **kind, **options)
    if end is None:
        raise ValueError(
            "end: a motion in closed form has no end of its own; give the time to which it is shown"
        )
    if frames is not None:
        ends = motion.at(np.linspace(0.0, end, frames))
        return Scene.of(ends, frames=frames, **kind, **options)
    return Scene.of_motion(motion, end, **kind, **options)


def page_of(motion: Any, end: float | None = None, **options: Any) -> tuple[str, tuple[str, ...]]:
    """Return the page of a motion as a text, and notes on what the page does not show."""
    given: dict[str, Any] = {
        "duration": None,
        "shape": None,
        "title": "Motion of a rigid body",
    }
    scene = scene_of(motion, end, is_page=True, **(given | options))
    return page(scene), scene.notes


def animate_motion(
    motion: Trajectory | FreeMotion | HeavyTop | GyrostatMotion,
    end: float | None,
    path: str | PathLike[str],
    *,
    shape: GivenShape | None = None,
    title: str = "Motion of a rigid body",
    progress: Callable[[float], object] | None = None,
) -> tuple[str, ...]:
    """Write the motion of one body as a moving picture, with the frames that it needs.

    Parameters
    ----------
    motion : Trajectory, FreeMotion, HeavyTop or GyrostatMotion
        Of one body.
    end : float or None
        Of a motion in closed form what is shown is from 0 s to this time; None of a trajectory.
    path, shape, title, progress
        As of `animate`.

    Returns
    -------
    tuple of str
        What the viewer does not see of the motion.
    """
    file = _check_suffix(path)
    is_page = file.suffix.lower() == ".html"
    scene = scene_of(motion, end, is_page=is_page, duration=None, shape=shape, title=title)
    _write(scene, file, progress)
    return scene.notes


def _check_suffix(path: str | PathLike[str]) -> Path:
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in ANIMATION_SUFFIXES:
        raise ValueError(
            f"path: {file} does not end in {', '.join(ANIMATION_SUFFIXES[:-1])} or {ANIMATION_SUFFIXES[-1]}"
        )
    return file


def _write(scene: Scene, file: Path, progress: Callable[[float], object] | None, **options: Any) -> None:
    if file.suffix.lower() == ".html":
        write_bytes(file, page(scene).encode())
    else:
        from polhode.draw.animation.film import film

        film(scene, file, progress, **options)
