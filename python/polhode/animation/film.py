"""A motion as a GIF or an MP4 film, drawn by matplotlib."""

from __future__ import annotations

import errno
import shutil
import subprocess
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._extras import require
from polhode._scene.shape import longest
from polhode._scene.style import AXIS_COLORS, INSIDE_COLOR, MOMENTUM_COLOR, OMEGA_COLOR
from polhode._scene.triangles import unit_normals
from polhode.files.writing import replacing
from polhode.plot._style import show_around
from polhode.plot._surfaces import arrow, toward_viewer

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from polhode._scene.scene import Scene

__all__ = ["film"]

_SIZE: Final = 480
_SIZES: Final = (64, 4096)
_DPI: Final = 100
_BODY: Final = 0.8
_AXIS_DASHES: Final = ("--", "-", ":")
_PATH_COLOR: Final = "#555555"
"""Of the path of a top's axis."""


def film(
    scene: Scene,
    file: Path,
    progress: Callable[[float], object] | None = None,
    *,
    size: int | tuple[int, int] | None = None,
    labels: bool = True,
) -> None:
    """Draw every frame and write them as a film.

    Parameters
    ----------
    scene : Scene
        What is shown.
    file : pathlib.Path
        Ends in ``.gif`` or ``.mp4``; the latter needs the program ffmpeg, which the extra ``film`` brings.
    progress : callable, optional
        Is told the fraction of the frames that are drawn.
    size : int or (int, int), optional
        Width and height in pixels.
    labels : bool
        Whether the axes are named, and title and time written.
    """
    width, height = _pixels(size, file)
    animation: Any = require("matplotlib.animation", extra="plot", purpose="a film")
    figures: Any = require("matplotlib.figure", extra="plot", purpose="a film")
    rate = max(1.0, len(scene.t) / scene.duration)
    if file.suffix.lower() == ".gif":
        writer = animation.PillowWriter(fps=rate)
        program = ""
    else:
        program = _ffmpeg(file)
        writer = animation.FFMpegWriter(fps=rate, codec="libx264", extra_args=["-pix_fmt", "yuv420p"])
    figure = figures.Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d", computed_zorder=False)
    settings: Any = require("matplotlib", extra="plot", purpose="a film")
    with settings.rc_context({"animation.ffmpeg_path": program or "ffmpeg"}), replacing(file) as new:
        writer.setup(figure, str(new), dpi=_DPI)
        try:
            for frame in range(len(scene.t)):
                ax.clear()
                _draw(ax, scene, frame, labels)
                writer.grab_frame()
                if progress is not None:
                    progress((frame + 1) / len(scene.t))
        except BaseException as error:
            if program:
                _end(writer, file, error)
            raise
        if program:
            _end(writer, file)
        else:
            writer.finish()


def _end(writer: Any, file: Path, error: BaseException | None = None) -> None:
    """Wait for ffmpeg to end; an error with its own words where it failed."""
    try:
        writer.finish()
    except subprocess.CalledProcessError as failed:
        if error is None or isinstance(error, BrokenPipeError):
            said = failed.stderr.strip().splitlines() or ["it ended without a word"]
            raise OSError(errno.EIO, f"ffmpeg could not write it: {said[-1]}", str(file)) from None


def _ffmpeg(file: Path) -> str:
    """Find the program ffmpeg: that of the system, or the one that the extra brings."""
    found = shutil.which("ffmpeg")
    if found is not None:
        return found
    try:
        carrier: Any = require("imageio_ffmpeg", extra="film", purpose=f"path: {file}")
        return str(carrier.get_ffmpeg_exe())
    except (ModuleNotFoundError, RuntimeError):
        raise FileNotFoundError(
            f'path: {file} needs the program ffmpeg: pip install "polhode[film]" brings it; '
            "a .gif or .html needs none"
        ) from None


def _pixels(size: int | tuple[int, int] | None, file: Path) -> tuple[int, int]:
    """Check the size of a film."""
    given: Any = _SIZE if size is None else size
    both = given if isinstance(given, tuple | list) else (given, given)
    least, most = _SIZES
    whole = len(both) == 2 and all(isinstance(x, int) and not isinstance(x, bool) for x in both)
    if not (whole and all(least <= x <= most for x in both)):
        raise ValueError(
            f"size: {size!r} is not a number of pixels from {least} to {most}, or two: (width, height)"
        )
    if file.suffix.lower() == ".mp4" and any(x % 2 for x in both):
        even = tuple(x + x % 2 for x in both)
        raise ValueError(f"size: {size!r}: an MP4 has even numbers of pixels, such as {even}")
    return both[0], both[1]


def _draw(ax: Any, scene: Scene, frame: int, labels: bool) -> None:
    art3d: Any = require("mpl_toolkits.mplot3d.art3d", extra="plot", purpose="a film")
    to_space = _core.rotate(scene.quaternion[frame], np.eye(3)).T
    for name, direction in zip("xyz", np.eye(3), strict=True):
        ax.plot(*np.stack([np.zeros(3), 1.3 * direction], axis=-1), color="0.75", linewidth=0.8, zorder=1)
        ax.text(*(1.4 * direction), name, color="0.5", ha="center", va="center")
    size = longest(scene.shape.vertices)
    triangles = (scene.shape.vertices * (_BODY / size) @ to_space.T)[scene.shape.faces]
    facing = unit_normals(triangles) @ toward_viewer(ax)
    near = facing > 0.0
    colors = (scene.shape.colors / 255.0)[near] * (0.62 + 0.38 * facing[near, np.newaxis])
    ax.add_collection3d(
        art3d.Poly3DCollection(triangles[near], facecolors=colors, edgecolors=colors, zorder=2)
    )
    for k, (axis, color, dash) in enumerate(zip(scene.axes.T, AXIS_COLORS, _AXIS_DASHES, strict=True)):
        ends = np.stack([-1.05 * axis, 1.05 * axis], axis=-1)
        ax.plot(*(to_space @ ends), color=color, linestyle=dash, linewidth=1.2, zorder=3)
        if labels:
            ax.text(
                *(1.13 * to_space @ axis), f"e{'₁₂₃'[k]}", color=color, ha="center", va="center", zorder=5
            )
    if scene.axis_path is not None:
        ax.plot(*scene.axis_path[: scene.sample[frame] + 1].T, color=_PATH_COLOR, linewidth=1.4, zorder=3)
    tips = scene.path[: scene.sample[frame] + 1] / longest(scene.path)
    ax.plot(*tips.T, color=OMEGA_COLOR, alpha=0.5, linewidth=1.0, zorder=3)
    arrows = [(scene.momentum[frame], MOMENTUM_COLOR, "L")]
    strongest = longest(scene.momentum)
    if scene.inside is not None:
        strongest = longest(np.concatenate([scene.momentum, scene.inside]))
        if scene.inside[frame].any():
            arrows.insert(0, (to_space @ scene.inside[frame], INSIDE_COLOR, "h"))
    arrows = [(1.25 * vector / strongest, color, name) for vector, color, name in arrows]
    for tip, color, name in (*arrows, (tips[-1], OMEGA_COLOR, "ω")):
        arrow(ax, tip, color, name, order=4, ha="left", va="baseline", weight="bold", zorder=5)
    if labels:
        ax.text2D(0.03, 0.95, scene.title, transform=ax.transAxes, fontsize=11, weight="bold")
        ax.text2D(0.03, 0.03, f"t = {scene.t[frame]:.4g} {scene.time_unit}", transform=ax.transAxes)
    show_around(ax, np.zeros(3), 0.95)
    ax.set_box_aspect((1.0, 1.0, 1.0))
    ax.set_axis_off()
