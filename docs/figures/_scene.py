"""What the figures share: a flat drawing of a scene in space, with arrows, angles and labels.

Colours are those of :mod:`polhode.plot`, which readers with any colour vision can tell apart. Each figure
is a script of its own: ``python docs/figures/NAME.py`` writes ``docs/figures/NAME.svg``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Polygon
from polhode.plot import AXIS_COLORS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

BLUE, RED, GREEN = AXIS_COLORS
INK, GRAY, PALE = "#222222", "#767676", "#DDE3EC"
X, Y, Z = np.eye(3)

STYLE = {"font.size": 12.0, "mathtext.fontset": "cm", "svg.fonttype": "path", "svg.hashsalt": "polhode"}


class Scene:
    """Points of space projected along one direction onto the paper.

    `azimuth` and `elevation` (degrees) say where the viewer stands; Z points up. ``flat=True`` looks at the
    x-y plane from above with x to the right.
    """

    def __init__(
        self,
        width: float,
        height: float,
        *,
        azimuth: float = 30.0,
        elevation: float = 20.0,
        flat: bool = False,
        panels: int = 1,
    ) -> None:
        mpl.rcParams.update(STYLE)
        self.figure = Figure(figsize=(width, height), facecolor="white", layout="constrained")
        self.panels = list(self.figure.subplots(1, panels, squeeze=False)[0])
        for ax in self.panels:
            ax.set_aspect("equal")
            ax.set_axis_off()
            ax.margins(0.08)
        self.ax = self.panels[0]
        if flat:
            self.right, self.up = X, Y
        else:
            a, e = np.deg2rad([azimuth, elevation])
            self.right = np.array([-np.sin(a), np.cos(a), 0.0])
            self.up = np.array([-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)])

    def panel(self, number: int, title: str | None = None) -> None:
        """Draw what follows into another panel."""
        self.ax = self.panels[number]
        if title is not None:
            self.ax.set_title(title, fontsize=12, color=INK, pad=20)

    @property
    def toward_viewer(self) -> Floats:
        """The unit vector from the scene to the viewer."""
        return np.cross(self.right, self.up)

    def flat(self, points: ArrayLike) -> Floats:
        """Coordinates on the paper, shape (..., 2)."""
        p = np.asarray(points, dtype=np.float64)
        return np.stack([p @ self.right[: p.shape[-1]], p @ self.up[: p.shape[-1]]], axis=-1)

    def line(self, *points: ArrayLike, color: str = INK, **style: Any) -> None:
        """A line through points; one array of shape (n, 3) will do."""
        path = self.flat(points[0] if len(points) == 1 else np.array(points))
        style = {"linewidth": 1.2, "solid_capstyle": "round"} | style
        self.ax.plot(path[:, 0], path[:, 1], color=color, **style)

    def fill(
        self,
        corners: ArrayLike,
        color: str = PALE,
        alpha: float = 1.0,
        edge: str = "none",
        zorder: float = 1.0,
    ) -> None:
        """A filled polygon."""
        style = {"facecolor": color, "edgecolor": edge, "alpha": alpha, "linewidth": 1.2, "zorder": zorder}
        self.ax.add_patch(Polygon(self.flat(corners), closed=True, **style))
        self.ax.autoscale_view()

    def hull(self, points: ArrayLike, color: str = PALE, alpha: float = 1.0, edge: str = GRAY) -> None:
        """The outline that a convex body with these surface points has on the paper, filled."""
        from scipy.spatial import ConvexHull

        path = self.flat(points)
        corners = path[ConvexHull(path).vertices]
        self.fill(corners @ np.stack([self.right, self.up]), color, alpha, edge)

    def ring(self, center: ArrayLike, u: ArrayLike, v: ArrayLike, color: str = GRAY) -> None:
        """A circle, dashed where it is on the far side of its centre."""
        path = self.circle(center, u, v)
        near = (path - np.asarray(center)) @ self.toward_viewer >= -1e-9
        breaks = np.flatnonzero(near[1:] != near[:-1]) + 1
        for piece in np.split(np.arange(len(path)), breaks):
            piece = np.append(piece, min(piece[-1] + 1, len(path) - 1))
            style = {} if near[piece[0]] else {"linestyle": (0, (4, 3)), "linewidth": 0.8}
            self.line(path[piece], color=color, **style)

    def arrow(
        self,
        start: ArrayLike,
        end: ArrayLike,
        label: str | None = None,
        color: str = INK,
        *,
        at: float = 1.0,
        offset: tuple[float, float] = (0.0, 0.0),
        both: bool = False,
        **style: Any,
    ) -> None:
        """An arrow; the label stands at the fraction `at` of its length, shifted by `offset` points."""
        path = self.flat(np.array([start, end], dtype=np.float64))
        style = {"linewidth": 1.6, "linestyle": "-"} | style
        self.ax.add_patch(
            FancyArrowPatch(
                *path,
                arrowstyle="<|-|>" if both else "-|>",
                mutation_scale=11,
                shrinkA=0,
                shrinkB=0,
                color=color,
                joinstyle="miter",
                **style,
            )
        )
        self.ax.plot(path[:, 0], path[:, 1], alpha=0.0)  # patches of arrows do not widen the view
        if label is not None:
            self.label(np.asarray(start) + at * (np.asarray(end, float) - start), label, color, offset=offset)

    def axes(
        self,
        origin: ArrayLike,
        directions: Iterable[ArrayLike],
        labels: Iterable[str],
        length: float,
        colors: Iterable[str] = AXIS_COLORS,
        push: float = 9.0,
        **style: Any,
    ) -> None:
        """Axes as arrows with their names beyond the tips."""
        for direction, name, color in zip(directions, labels, colors, strict=True):
            tip = np.asarray(origin) + length * np.asarray(direction)
            self.arrow(origin, tip, color=color, **style)
            outward = self.flat(direction)
            size = np.hypot(*outward)
            shift = push * outward / size if size > 0.15 else np.array([-push, -push])
            self.label(tip, name, color, offset=(shift[0], shift[1]))

    def circle(
        self, center: ArrayLike, u: ArrayLike, v: ArrayLike, start: float = 0.0, stop: float = 360.0
    ) -> Floats:
        """Points center + u cos + v sin from `start` to `stop` degrees."""
        angle = np.deg2rad(np.linspace(start, stop, max(int(abs(stop - start)), 2)))[:, np.newaxis]
        return np.asarray(center) + np.cos(angle) * np.asarray(u) + np.sin(angle) * np.asarray(v)

    def angle(
        self,
        center: ArrayLike,
        start: ArrayLike,
        end: ArrayLike,
        radius: float,
        label: str,
        color: str = INK,
        push: float = 10.0,
    ) -> None:
        """An arc with an arrow head from one direction to another, with its name."""
        u = np.asarray(start, float) / np.linalg.norm(start)
        w = np.asarray(end, float) / np.linalg.norm(end)
        v = w - (w @ u) * u
        v /= np.linalg.norm(v)
        span = np.rad2deg(np.arctan2(w @ v, w @ u))
        self.turn(center, radius * u, radius * v, 0.0, span, label, color, push)

    def turn(
        self,
        center: ArrayLike,
        u: ArrayLike,
        v: ArrayLike,
        start: float,
        stop: float,
        label: str | None = None,
        color: str = INK,
        push: float = 10.0,
    ) -> None:
        """An arc center + u cos + v sin with an arrow head at its end."""
        path = self.circle(center, u, v, start, stop)
        self.line(path, color=color)
        head = self.flat(path[[-4, -1]])
        self.ax.annotate(
            "",
            head[1],
            head[0],
            arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0},
        )
        if label is not None:
            middle = path[len(path) // 2]
            outward = self.flat(middle) - self.flat(np.asarray(center, float))
            shift = push * outward / max(float(np.hypot(*outward)), 1e-12)
            self.label(middle, label, color, offset=(shift[0], shift[1]))

    def point(
        self,
        at: ArrayLike,
        label: str | None = None,
        offset: tuple[float, float] = (7.0, 7.0),
        color: str = INK,
    ) -> None:
        """A dot with a name."""
        x, y = self.flat(np.asarray(at, float))
        self.ax.plot(x, y, "o", color=color, markersize=4.5, zorder=6)
        if label is not None:
            self.label(at, label, color, offset=offset)

    def label(
        self,
        at: ArrayLike,
        text: str,
        color: str = INK,
        offset: tuple[float, float] = (0.0, 0.0),
        size: float = 14,
    ) -> None:
        """Text at a point, shifted by `offset` points on the paper."""
        self.ax.annotate(
            text,
            tuple(self.flat(np.asarray(at, float))),
            offset,
            textcoords="offset points",
            ha="center",
            va="center",
            color=color,
            fontsize=size,
            zorder=7,
        )

    def view(self, low: ArrayLike, high: ArrayLike) -> None:
        """Set the limits of the paper."""
        (x0, y0), (x1, y1) = np.asarray(low, float), np.asarray(high, float)
        self.ax.set_xlim(x0, x1)
        self.ax.set_ylim(y0, y1)


def unit(vector: ArrayLike) -> Floats:
    """The vector at unit length."""
    v = np.asarray(vector, dtype=np.float64)
    return v / np.linalg.norm(v)


def save(figure: Figure, script: str) -> None:
    """Write the figure beside its script, or into the folder that the command line names."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(script).parent
    # Without a date the same drawing is the same file.
    figure.savefig(folder / f"{Path(script).stem}.svg", metadata={"Date": None})
