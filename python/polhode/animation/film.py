"""A motion as a GIF or an MP4 film, drawn by matplotlib."""

from __future__ import annotations

import errno
import shutil
import subprocess
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._extras import require
from polhode._rounding import at_least
from polhode._scene.footage import GIF_RATE
from polhode.animation._picture import Picture
from polhode.files.writing import replacing, writing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from polhode._scene.scene import Scene

__all__ = ["film"]

_SIZE: Final = 480
_SIZES: Final = (64, 4096)


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
        Whether anything is written: names, title, time, speeds of wheels.
    """
    pixels, count = _pixels(size, file), len(scene.t)
    is_gif = file.suffix.lower() == ".gif"
    if is_gif and count > GIF_RATE * scene.duration * (1.0 + 1e-9):
        least = at_least(count / GIF_RATE, 6)
        raise ValueError(
            f"duration: {count} pictures in {scene.duration:g} s are more than the {GIF_RATE:g} a second "
            f"that viewers of GIFs show; give duration={least} or more, or fewer frames"
        )
    program = "" if is_gif else _ffmpeg(file)
    picture = Picture(scene, pixels, has_labels=labels)

    def shown() -> Iterator[Picture]:
        for frame in range(count):
            picture.show(frame)
            yield picture
            if progress is not None:
                progress((frame + 1) / count)

    if is_gif:
        _write_gif(shown(), file, _delays(count, scene.duration))
    else:
        _write_mp4(shown(), file, picture, program, count / scene.duration)


def _delays(count: int, duration: float) -> list[int]:
    """Give how long each picture is shown, in milliseconds: whole hundredths of a second, as a GIF has them.

    Each change is the one that is nearest to its time, so that the whole takes the time that was asked for.
    """
    changes = np.rint(np.linspace(0.0, 100.0 * duration, count + 1)).astype(int)
    return [10 * int(delay) for delay in np.diff(changes)]


def _write_gif(pictures: Iterator[Picture], file: Path, delays: list[int]) -> None:
    image: Any = require("PIL.Image", extra="plot", purpose="a film")
    images = (image.fromarray(one.pixels()[..., :3]) for one in pictures)
    with writing(file) as stream:
        first = next(images)
        first.save(stream, format="GIF", save_all=True, append_images=images, duration=delays, loop=0)


def _write_mp4(pictures: Iterator[Picture], file: Path, picture: Picture, program: str, rate: float) -> None:
    animation: Any = require("matplotlib.animation", extra="plot", purpose="a film")
    settings: Any = require("matplotlib", extra="plot", purpose="a film")
    writer = animation.FFMpegWriter(fps=rate, codec="libx264", extra_args=["-pix_fmt", "yuv420p"])
    with settings.rc_context({"animation.ffmpeg_path": program}), replacing(file) as new:
        writer.setup(picture.figure, str(new), dpi=picture.dpi)
        try:
            for _ in pictures:
                writer.grab_frame()
        except BaseException as error:
            _end(writer, file, error)
            raise
        _end(writer, file)


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
    except ModuleNotFoundError:
        way_out = 'pip install "polhode[film]" brings it'
    except RuntimeError:  # the package is there, without the program
        way_out = "install it"
    raise FileNotFoundError(
        f"path: {file} needs the program ffmpeg; {way_out}, or write a .gif or .html, which need none"
    )


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
