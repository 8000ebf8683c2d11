"""A motion as a GIF or an MP4 film, drawn by matplotlib, picture by picture."""

from __future__ import annotations

import errno
import shutil
import subprocess
import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._format import at_least
from polhode._optional import require
from polhode.draw.plot.axes import show_around, toward_viewer
from polhode.draw.plot.rolling import draw_ground
from polhode.draw.sampling import GIF_RATE
from polhode.draw.shape import longest
from polhode.draw.style import AXIS_COLORS, DISC_COLOR, INSIDE_COLOR, MOMENTUM_COLOR, OMEGA_COLOR, RIM_COLOR
from polhode.draw.triangles import unit_normals
from polhode.draw.wheels import RINGS, SPOKE, SPOKES
from polhode.io.writing import replacing, writing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.draw.ground import Ground
    from polhode.draw.scene import Scene
    from polhode.draw.wheels import Disc

    Floats = NDArray[np.float64]

__all__ = [
    "Name",
    "Picture",
    "draw_disc",
    "film",
    "place_names",
]

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

    def show_frames() -> Iterator[Picture]:
        for frame in range(count):
            picture.show(frame)
            yield picture
            if progress is not None:
                progress((frame + 1) / count)

    if is_gif:
        _write_gif(show_frames(), file, _delays(count, scene.duration))
    else:
        _write_mp4(show_frames(), file, picture, program, count / scene.duration)


def _delays(count: int, duration: float) -> list[int]:
    """Return how long each picture is shown, in milliseconds: whole hundredths of a second, as GIFs have.

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
    """Wait for ffmpeg to end; if it failed, raise an error with its message."""
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


_DPI: Final = (64, 80, 96, 128, 160, 192, 256, 320, 384, 512, 640, 768)
"""Pixels an inch: sums of two powers of two at most, by which a size in inches has its whole pixels again."""
_AT: Final = 480
"""The size, in pixels, at which there are 96: lines and letters grow with the picture."""
_BODY: Final = 0.8
_ROLLER: Final = 0.45
"""The same of a body that rolls, of which the plane around it is seen too."""
_ZOOM: Final = 1.15
_AXIS_DASHES: Final = ("--", "-", ":")
_PATH_COLOR: Final = "#555555"
"""Colour of the path of a top's axis."""
_RING: Final = np.linspace(0.0, 2.0 * np.pi, 49)
_TITLE: Final[dict[str, Any]] = {"fontsize": 11, "weight": "bold"}
_TEXT: Final[dict[str, Any]] = {"fontsize": 10}
_NAME: Final[dict[str, Any]] = {"fontsize": 11}
_TITLE_PART: Final = 0.25
"""Largest fraction of the height for the title."""
_FOOT_PART: Final = 0.35
"""Largest fraction of the height for the speeds of wheels."""
_LEAST: Final = 0.6
"""Letters so many times smaller are still read."""


class Picture:
    """A figure of matplotlib that shows one frame of a scene after the other.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
    dpi : int
        Pixels an inch.
    """

    def __init__(self, scene: Scene, size: tuple[int, int], *, has_labels: bool) -> None:
        figures: Any = require("matplotlib.figure", extra="plot", purpose="a film")
        agg: Any = require("matplotlib.backends.backend_agg", extra="plot", purpose="a film")
        self._art: Any = require("mpl_toolkits.mplot3d.art3d", extra="plot", purpose="a film")
        self._proj: Any = require("mpl_toolkits.mplot3d.proj3d", extra="plot", purpose="a film")
        effects: Any = require("matplotlib.patheffects", extra="plot", purpose="a film")
        self._outline = [effects.withStroke(linewidth=2.5, foreground="white")]
        self._scene, self._has_labels = scene, has_labels
        between = float(np.abs(np.diff(scene.t)).max(initial=0.0))
        self._factors = [disc.factor(between) for disc in scene.discs]
        self._size = np.array(size, dtype=np.float64)
        self.dpi = min(_DPI, key=lambda dpi: abs(dpi / 96 - min(size) / _AT))
        self.figure = figures.Figure(figsize=tuple(self._size / self.dpi), dpi=self.dpi)
        self._canvas = agg.FigureCanvasAgg(self.figure)
        self._names: list[Any] = []
        self._widths: dict[tuple[Any, ...], float] = {}
        low, high = 0.0, float(size[1])
        if has_labels:
            high -= self._write_title()
            low += self._write_foot()
        self._low, self._high = np.array([0.0, low]), np.array([size[0], high])
        side = min(float(size[0]), high - low)
        corner = 0.5 * (self._low + self._high) - 0.5 * side
        self._ax = self.figure.add_axes(
            (*(corner / self._size), *(side / self._size)), projection="3d", computed_zorder=False
        )
        self._ax.patch.set_alpha(0.0)

    def pixels(self) -> NDArray[np.uint8]:
        """Draw, and return red, green, blue and opacity, shape (height, width, 4)."""
        self._canvas.draw()
        return np.array(self._canvas.buffer_rgba())

    def show(self, frame: int) -> None:
        """Move everything to its place in a frame."""
        self._ax.clear()
        view = toward_viewer(self._ax)
        show_around(self._ax, np.zeros(3), 0.95)
        self._ax.set_box_aspect((1.0, 1.0, 1.0), zoom=_ZOOM)
        self._ax.set_axis_off()
        to_space = _core.rotate(self._scene.quaternion[frame], np.eye(3)).T
        if self._scene.ground is not None:
            self._draw_ground(frame, self._scene.ground)
        else:
            self._draw_body(frame, to_space, view)
            self._draw_paths(frame)
        tips = self._draw_arrows(frame, to_space)
        if not self._has_labels:
            return
        for text, disc, factor in zip(self._speeds, self._scene.discs, self._factors, strict=False):
            text.set_text(disc.words(frame, factor, self._scene.time_unit))
        self._clock.set_text(self._time(frame))
        self._name(tips, to_space, view)

    def _draw_body(self, frame: int, to_space: Floats, view: Floats) -> None:
        scene, ax = self._scene, self._ax
        for direction in np.eye(3):
            ends = np.stack([np.zeros(3), 1.3 * direction], axis=-1)
            ax.plot(*ends, color="0.75", linewidth=0.8, zorder=1)
        size = longest(scene.shape.vertices)
        triangles = (scene.shape.vertices * (_BODY / size) @ to_space.T)[scene.shape.faces]
        facing = unit_normals(triangles) @ view
        near = facing > 0.0
        colors = (scene.shape.colors / 255.0)[near] * (0.62 + 0.38 * facing[near, np.newaxis])
        ax.add_collection3d(
            self._art.Poly3DCollection(triangles[near], facecolors=colors, edgecolors=colors, zorder=2)
        )
        discs = zip(scene.discs, self._factors, strict=True)
        for disc, factor in sorted(discs, key=lambda one: float(view @ to_space @ one[0].middle)):
            turned = None if disc.angle is None else float(disc.angle[frame]) / factor
            draw_disc(ax, disc, to_space, _BODY / size, turned, view)
        for axis, color, dash in zip(scene.axes.T, AXIS_COLORS, _AXIS_DASHES, strict=True):
            ends = np.stack([-1.05 * axis, 1.05 * axis], axis=-1)
            ax.plot(*(to_space @ ends), color=color, linestyle=dash, linewidth=1.2, zorder=3)

    def _draw_ground(self, frame: int, ground: Ground) -> None:
        """Draw a body that rolls, its middle where the arrows begin; the view follows it."""
        scene, k = self._scene, int(self._scene.sample[frame])
        scale = _ROLLER / longest(scene.shape.vertices)
        center, n = ground.center[k], ground.normal
        below = center - n * (n @ (center - ground.middle))
        shift = (below - center) * scale
        draw_ground(
            self._ax, ground, scene.shape, scene.quaternion[frame], k, float(scene.t[frame]),
            (below, scale, 1.0), shift,
        )  # fmt: skip
        to_space = _core.rotate(scene.quaternion[frame], np.eye(3)).T
        for axis, color, dash in zip(scene.axes.T, AXIS_COLORS, _AXIS_DASHES, strict=True):
            ends = np.stack([-1.05 * axis, 1.05 * axis], axis=-1)
            self._ax.plot(*(to_space @ ends), color=color, linestyle=dash, linewidth=1.2, zorder=3)

    def _draw_paths(self, frame: int) -> None:
        scene, until = self._scene, self._scene.sample[frame] + 1
        if scene.axis_path is not None:
            self._ax.plot(*scene.axis_path[:until].T, color=_PATH_COLOR, linewidth=1.4, zorder=3)
        tips = scene.path[:until] / longest(scene.path)
        self._ax.plot(*tips.T, color=OMEGA_COLOR, alpha=0.5, linewidth=1.0, zorder=3)

    def _draw_arrows(self, frame: int, to_space: Floats) -> list[tuple[Floats, str, str]]:
        """Draw h, L and ω; return their tips, colours and names."""
        scene = self._scene
        tips = [(scene.path[scene.sample[frame]] / longest(scene.path), OMEGA_COLOR, "ω")]
        strongest = longest(scene.momentum)
        if scene.inside is not None:
            strongest = longest(np.concatenate([scene.momentum, scene.inside]))
        tips.append((1.25 * scene.momentum[frame] / strongest, MOMENTUM_COLOR, "L"))
        if scene.inside is not None and scene.inside[frame].any():
            tips.append((1.25 * to_space @ scene.inside[frame] / strongest, INSIDE_COLOR, "h"))
        for tip, color, _ in reversed(tips):
            style = {"linewidth": 2.0, "arrow_length_ratio": 0.08, "zorder": 4}
            self._ax.quiver(*np.zeros(3), *tip, color=color, **style)
        return tips

    def _name(self, tips: list[tuple[Floats, str, str]], to_space: Floats, view: Floats) -> None:
        """Write the names of arrows, principal axes, wheels and the axes of space, where there is room."""
        for text in self._names:
            text.remove()
        scene = self._scene
        middle = self._on_screen(np.zeros((1, 3)))[0]
        names = [self._make_name(text, color, "bold", tip, middle) for tip, color, text in tips]
        for k, (axis, color) in enumerate(zip(scene.axes.T, AXIS_COLORS, strict=True)):
            names.append(self._make_name(f"e{'₁₂₃'[k]}", color, "normal", 1.05 * to_space @ axis, middle))
        scale = _BODY / longest(scene.shape.vertices)
        for disc in scene.discs:
            if view @ to_space @ disc.axis > 0.0:  # else it is behind the body
                rim = scale * disc.circle(_RING, disc.radius, disc.half) @ to_space.T
                edge = rim[np.linalg.norm(self._on_screen(rim) - middle, axis=1).argmax()]
                own = self._on_screen(rim.mean(axis=0, keepdims=True))[0]
                names.append(self._make_name(disc.name, INSIDE_COLOR, "normal", edge, own))
        for text, direction in zip("xyz", np.eye(3), strict=True):
            names.append(self._make_name(text, "0.5", "normal", 1.3 * direction, middle))
        self._names = [
            self.figure.text(
                *(there / self._size), name.text, color=name.color, weight=name.weight, ha="center",
                va="center_baseline", path_effects=self._outline, parse_math=False, **_NAME,
            )
            for name, there in place_names(names, self._low, self._high)
        ]  # fmt: skip

    def _make_name(self, text: str, color: str, weight: str, point: Floats, middle: Floats) -> Name:
        """Return the name of a point in space, which stands away from a point of the picture."""
        at = self._on_screen(point[np.newaxis])[0]
        far = float(np.linalg.norm(at - middle))
        away = (at - middle) / far if far > 0.0 else np.array([0.0, 1.0])
        size = np.array([self._width(text, **_NAME, weight=weight), self._line(_NAME)])
        return Name(text, color, weight, at, away, size)

    def _on_screen(self, points: Floats) -> Floats:
        """Return the pixels, from the lower left corner, at which points are seen."""
        x, y, _ = self._proj.proj_transform(*points.T, self._ax.get_proj())
        seen: Floats = self._ax.transData.transform(np.stack([x, y], axis=-1))
        return seen

    def _write_title(self) -> float:
        """Write the title, in as many lines as it needs; return its height."""
        margin, line = self._line(_TEXT), self._line(_TITLE)
        room, most = self._size[0] - margin, max(1, int(_TITLE_PART * self._size[1] / line))
        lines: list[str] = []
        for letters in range(len(self._scene.title), 0, -1):
            lines = textwrap.wrap(self._scene.title, letters, max_lines=most, placeholder="…")
            if all(self._width(text, **_TITLE) <= room for text in lines):
                break
        for number, text in enumerate(lines):
            at = np.array([0.5 * margin, self._size[1] - 0.35 * margin - number * line])
            self.figure.text(*(at / self._size), text, va="top", parse_math=False, **_TITLE)
        return 0.35 * margin + len(lines) * line

    def _write_foot(self) -> float:
        """Make room for the time and the speeds of wheels, in columns; return their height."""
        scene, line = self._scene, self._line(_TEXT)
        texts = [
            max((disc.words(k, factor, scene.time_unit) for k in range(len(scene.t))), key=len)
            for disc, factor in zip(scene.discs, self._factors, strict=True)
        ]
        widest = max((self._width(text, **_TEXT) for text in texts), default=1.0) + 2.0 * line
        columns = int(np.clip(self._size[0] / widest, 1, max(len(texts), 1)))
        rows = min(-(-len(texts) // columns), int(_FOOT_PART * self._size[1] / line))
        smaller = min(1.0, (self._size[0] - line) / (widest - 2.0 * line)) if texts else 1.0
        if smaller < _LEAST:
            rows = 0
        style = {"color": INSIDE_COLOR, "parse_math": False, "fontsize": smaller * _TEXT["fontsize"]}
        places = [(column, row) for column in range(columns) for row in range(rows)][: len(texts)]
        self._speeds = []
        for column, row in places:
            at = np.array([0.5 * line + column * widest, (0.4 + rows - row) * line])
            self._speeds.append(self.figure.text(*(at / self._size), "", **style))
        if places and len(places) < len(texts):
            self._speeds.pop().set_text(f"… and {len(texts) - len(places) + 1} more")
        at = np.array([0.5 * line, 0.4 * line])
        self._clock = self.figure.text(*(at / self._size), "", parse_math=False, **_TEXT)
        return (1.4 + rows) * line

    def _time(self, frame: int) -> str:
        """Return the time of a frame, to a thousandth of the length of the motion."""
        t = self._scene.t
        most, length = float(np.abs(t).max()), float(np.ptp(t))
        digits = 4 if length == 0.0 else int(np.clip(np.ceil(np.log10(most / length)) + 4, 4, 16))
        return f"t = {t[frame]:.{digits}g} {self._scene.time_unit}"

    def _width(self, text: str, **style: Any) -> float:
        """Return the width of a text in pixels."""
        key = text, *style.values()
        if key not in self._widths:
            one = self.figure.text(0.0, 0.0, text, parse_math=False, **style)
            self._widths[key] = float(one.get_window_extent(self._canvas.get_renderer()).width)
            one.remove()
        return self._widths[key]

    def _line(self, style: dict[str, Any]) -> float:
        """Return the height of a line in pixels."""
        return 1.3 * float(style["fontsize"]) * self.dpi / 72.0


_DISC_RING: Final = np.linspace(0.0, 2.0 * np.pi, 49)


def draw_disc(
    ax: Any, disc: Disc, to_space: Floats, scale: float, turned: float | None, view: Floats
) -> bool:
    """Draw a wheel at an attitude; return whether it is on the near side of the body.

    Parameters
    ----------
    ax : Axes3D
        Where to draw.
    disc : Disc
        The wheel.
    to_space : numpy.ndarray, shape (3, 3)
        The attitude.
    scale : float
        From lengths of the body to those of the picture.
    turned : float or None
        The angle that is drawn; None where it is not known.
    view : numpy.ndarray, shape (3,)
        Unit vector toward the viewer.
    """
    art3d: Any = require("mpl_toolkits.mplot3d.art3d", extra="plot", purpose="a film")
    axis = to_space @ disc.axis
    is_near = bool(axis @ view >= 0.0)
    side = disc.half if is_near else -disc.half

    def points(angles: Floats, radius: float, height: float) -> Floats:
        placed: Floats = scale * disc.circle(angles, radius, height) @ to_space.T
        return placed

    # The rim is seen between the two points that are farthest across the line of sight.
    edge = np.cross(axis, view)
    quarter = (disc.circle(np.array([0.0, 0.5 * np.pi]), 1.0, 0.0) - disc.middle) @ to_space.T
    ends = np.arctan2(quarter[1] @ edge, quarter[0] @ edge) + np.array([0.0, np.pi])
    r, order = disc.radius, 2.5 if is_near else 1.5
    rim = np.concatenate([points(ends, r, -side), points(ends[::-1], r, side)])
    faces = [points(_DISC_RING, r, -side), rim, points(_DISC_RING, r, side)]
    for polygon, color in zip(faces, (RIM_COLOR, RIM_COLOR, DISC_COLOR), strict=True):
        ax.add_collection3d(
            art3d.Poly3DCollection([polygon], facecolors=color, edgecolors=INSIDE_COLOR, lw=0.8, zorder=order)
        )
        order += 0.01
    style: dict[str, Any] = {"color": INSIDE_COLOR, "lw": 1.2, "zorder": order + 0.01}
    if turned is None:
        for part in RINGS:
            ax.plot(*points(_DISC_RING, part * r, side).T, **style)
        return is_near
    step, middle = 2.0 * np.pi / SPOKES, points(np.zeros(1), 0.0, side)
    mark = np.concatenate([middle, points(np.linspace(turned, turned + step, 9), SPOKE * r, side)])
    ax.add_collection3d(art3d.Poly3DCollection([mark], facecolors=INSIDE_COLOR, zorder=order))
    for k in range(2, SPOKES):
        tip = points(np.array([turned + k * step]), SPOKE * r, side)
        ax.plot(*np.concatenate([middle, tip]).T, **style)
    return is_near


_AROUND: Final = np.deg2rad([0.0, 45.0, -45.0, 90.0, -90.0, 135.0, -135.0, 180.0])
_FAR: Final = (0.75, 1.4, 2.2)
"""Distances from the point to the text, in heights of the text."""
_APART: Final = 0.1
"""Least space between two names, in heights of the text."""


@dataclass(frozen=True)
class Name:
    """A text beside a point of a picture.

    Attributes
    ----------
    text, color, weight : str
        As matplotlib takes them.
    at, away : numpy.ndarray, shape (2,)
        The point, and a direction: the text stands that way from it, where there is room.
    size : numpy.ndarray, shape (2,)
        Width and height of the text, in pixels as the point.
    """

    text: str
    color: str
    weight: str
    at: Floats
    away: Floats
    size: Floats


def place_names(names: Sequence[Name], low: Floats, high: Floats) -> list[tuple[Name, Floats]]:
    """Find a free place for each name between two corners; a name without room is left out.

    Parameters
    ----------
    names : sequence of Name
        The most important first.
    low, high : numpy.ndarray, shape (2,)
        The corners.
    """
    done: list[tuple[Name, Floats]] = []
    for name in names:
        half = 0.5 * name.size
        if (high - low < name.size).any():
            continue
        for far in _FAR:
            found = False
            for turn in _AROUND:
                cosine, sine = np.cos(turn), np.sin(turn)
                way = np.array([[cosine, -sine], [sine, cosine]]) @ name.away
                beyond = far * name.size[1] + abs(way[0]) * max(half[0] - half[1], 0.0)
                middle = np.clip(name.at + beyond * way, low + half, high - half)
                if not any(_overlap(name, middle, *other) for other in done):
                    done.append((name, middle))
                    found = True
                    break
            if found:
                break
    return done


def _overlap(name: Name, middle: Floats, other: Name, there: Floats) -> bool:
    apart = np.abs(middle - there) - 0.5 * (name.size + other.size)
    return bool((apart < _APART * min(name.size[1], other.size[1])).all())
