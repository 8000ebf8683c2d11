"""One picture of a film: the body, its axes and arrows, and what is written about them."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._extras import require
from polhode._scene.shape import longest
from polhode._scene.style import AXIS_COLORS, INSIDE_COLOR, MOMENTUM_COLOR, OMEGA_COLOR
from polhode._scene.triangles import unit_normals
from polhode.animation._discs import draw_disc
from polhode.animation._names import Name, placed
from polhode.plot._style import show_around
from polhode.plot._surfaces import toward_viewer

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode._scene.scene import Scene

    Floats = NDArray[np.float64]

__all__ = ["Picture"]

_DPI: Final = (64, 80, 96, 128, 160, 192, 256, 320, 384, 512, 640, 768)
"""Pixels an inch: sums of two powers of two at most, by which a size in inches has its whole pixels again."""
_AT: Final = 480
"""The size, in pixels, at which there are 96: lines and letters grow with the picture."""
_BODY: Final = 0.8
_ZOOM: Final = 1.15
_AXIS_DASHES: Final = ("--", "-", ":")
_PATH_COLOR: Final = "#555555"
"""Of the path of a top's axis."""
_RING: Final = np.linspace(0.0, 2.0 * np.pi, 49)
_TITLE: Final[dict[str, Any]] = {"fontsize": 11, "weight": "bold"}
_TEXT: Final[dict[str, Any]] = {"fontsize": 10}
_NAME: Final[dict[str, Any]] = {"fontsize": 11}
_TITLE_PART: Final = 0.25
"""Of the height, that a title takes at most."""
_FOOT_PART: Final = 0.35
"""That the speeds of wheels take at most."""
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
        """Draw and give red, green, blue and opacity, shape (height, width, 4)."""
        self._canvas.draw()
        return np.array(self._canvas.buffer_rgba())

    def show(self, frame: int) -> None:
        """Put everything where it is in a frame."""
        self._ax.clear()
        view = toward_viewer(self._ax)
        show_around(self._ax, np.zeros(3), 0.95)
        self._ax.set_box_aspect((1.0, 1.0, 1.0), zoom=_ZOOM)
        self._ax.set_axis_off()
        to_space = _core.rotate(self._scene.quaternion[frame], np.eye(3)).T
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

    def _draw_paths(self, frame: int) -> None:
        scene, until = self._scene, self._scene.sample[frame] + 1
        if scene.axis_path is not None:
            self._ax.plot(*scene.axis_path[:until].T, color=_PATH_COLOR, linewidth=1.4, zorder=3)
        tips = scene.path[:until] / longest(scene.path)
        self._ax.plot(*tips.T, color=OMEGA_COLOR, alpha=0.5, linewidth=1.0, zorder=3)

    def _draw_arrows(self, frame: int, to_space: Floats) -> list[tuple[Floats, str, str]]:
        """Draw h, L and ω; give their tips, colours and names."""
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
        names = [self._named(text, color, "bold", tip, middle) for tip, color, text in tips]
        for k, (axis, color) in enumerate(zip(scene.axes.T, AXIS_COLORS, strict=True)):
            names.append(self._named(f"e{'₁₂₃'[k]}", color, "normal", 1.05 * to_space @ axis, middle))
        scale = _BODY / longest(scene.shape.vertices)
        for disc in scene.discs:
            if view @ to_space @ disc.axis > 0.0:  # else it is behind the body
                rim = scale * disc.circle(_RING, disc.radius, disc.half) @ to_space.T
                edge = rim[np.linalg.norm(self._on_screen(rim) - middle, axis=1).argmax()]
                own = self._on_screen(rim.mean(axis=0, keepdims=True))[0]
                names.append(self._named(disc.name, INSIDE_COLOR, "normal", edge, own))
        for text, direction in zip("xyz", np.eye(3), strict=True):
            names.append(self._named(text, "0.5", "normal", 1.3 * direction, middle))
        self._names = [
            self.figure.text(
                *(there / self._size), name.text, color=name.color, weight=name.weight, ha="center",
                va="center_baseline", path_effects=self._outline, parse_math=False, **_NAME,
            )
            for name, there in placed(names, self._low, self._high)
        ]  # fmt: skip

    def _named(self, text: str, color: str, weight: str, point: Floats, middle: Floats) -> Name:
        """Give the name of a point in space, which stands away from a point of the picture."""
        at = self._on_screen(point[np.newaxis])[0]
        far = float(np.linalg.norm(at - middle))
        away = (at - middle) / far if far > 0.0 else np.array([0.0, 1.0])
        size = np.array([self._width(text, **_NAME, weight=weight), self._line(_NAME)])
        return Name(text, color, weight, at, away, size)

    def _on_screen(self, points: Floats) -> Floats:
        """Give the pixels, from the lower left corner, at which points are seen."""
        x, y, _ = self._proj.proj_transform(*points.T, self._ax.get_proj())
        seen: Floats = self._ax.transData.transform(np.stack([x, y], axis=-1))
        return seen

    def _write_title(self) -> float:
        """Write the title, in as many lines as it needs; give the height that it takes."""
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
        """Make room for the time and the speeds of wheels, in columns; give the height that they take."""
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
        """Give the time of a frame, to a thousandth of the length of the motion."""
        t = self._scene.t
        most, length = float(np.abs(t).max()), float(np.ptp(t))
        digits = 4 if length == 0.0 else int(np.clip(np.ceil(np.log10(most / length)) + 4, 4, 16))
        return f"t = {t[frame]:.{digits}g} {self._scene.time_unit}"

    def _width(self, text: str, **style: Any) -> float:
        """Give the width of a text in pixels."""
        key = text, *style.values()
        if key not in self._widths:
            one = self.figure.text(0.0, 0.0, text, parse_math=False, **style)
            self._widths[key] = float(one.get_window_extent(self._canvas.get_renderer()).width)
            one.remove()
        return self._widths[key]

    def _line(self, style: dict[str, Any]) -> float:
        """Give the height of a line in pixels."""
        return 1.3 * float(style["fontsize"]) * self.dpi / 72.0
