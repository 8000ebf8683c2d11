"""A motion in a window: the moving body and its wheels, omega and L, with a slider for time."""

from __future__ import annotations

import warnings
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import _core
from polhode._hints import check_kind, with_hints
from polhode.draw.sampling import RATE
from polhode.draw.scene import Scene
from polhode.draw.shape import longest
from polhode.draw.style import AXIS_COLORS, DISC_COLOR, INSIDE_COLOR, MOMENTUM_COLOR, OMEGA_COLOR, RIM_COLOR
from polhode.draw.view.bodies import (
    AXIS_STYLE,
    add_name,
    add_surface,
    arrow,
    line,
    new_plotter,
    pyvista,
    show_all,
    surface,
)
from polhode.draw.wheels import RINGS, SPOKE, SPOKES

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from pyvista import Plotter

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory
    from polhode.draw.wheels import Disc

    Floats = NDArray[np.float64]

__all__ = [
    "WheelActors",
    "motion",
]

_ARROW: Final = 1.5
"""Length of the longest ω and L, in those of the body."""
_TICK: Final = 30
"""Milliseconds between two pictures."""


@with_hints
def motion(
    trajectory: Trajectory | FreeMotion | HeavyTop | GyrostatMotion,
    plotter: Plotter | None = None,
    *,
    end: float | None = None,
    at: float | None = None,
    shape: tuple[ArrayLike, ArrayLike] | None = None,
    duration: float | None = None,
    title: str = "",
    time_label: str = "s",
    name: str = "motion",
) -> Plotter:
    """Show the motion of one body about its reference point, with ω, the path of ω in space, and L.

    L includes the angular momentum of wheels, which is also shown by itself as h. Wheels are drawn as in
    :func:`polhode.animation.animate`.

    In a window, the slider chooses the time, and the space bar starts and stops the motion.

    Parameters
    ----------
    trajectory : Trajectory, FreeMotion, HeavyTop or GyrostatMotion
        Motion of one body. For a motion in closed form as many states are shown as needed. For any other
        motion its samples are shown; the body should turn by no more than 30 degrees from one to the next.
    plotter : pyvista.Plotter, optional
        Where to show it; a new one by default. If it already shows the motion, `at` sets another time.
    end : float, optional
        For a motion in closed form, which has no times of its own: the motion is shown from 0 to this time.
        Each wheel of a `polhode.GyrostatMotion` is shown to turn. A trajectory of given times does not
        contain the single wheels, only the sum of their momenta.
    at : float, optional
        Time to begin with, rounded to the nearest state that is shown; the start by default.
    shape : (vertices, faces), optional
        A mesh of the body in its frame, (n, 3) and (m, 3). By default the shape from which the body was made,
        see :func:`polhode.animation.animate`.
    duration : float, optional
        Duration of the whole motion on the screen, in seconds. By default 10, or more so that the body turns
        by at most 20 degrees from picture to picture.
    title, time_label : str
        Title, and word for the unit of the times; it converts no number.
    name : str
        Name of the actors; another motion of that name is replaced.

    Returns
    -------
    pyvista.Plotter

    Raises
    ------
    ValueError
        If the body turns by half a turn or more from one sample to the next, since it would seem to turn
        backward.

    Warns
    -----
    UserWarning
        If it turns by more than 30 degrees, or the end of the motion is not shown.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import solids, view
    >>> racket = solids.box((3, 2, 1), mass=1.0).simulate(np.linspace(0, 20, 1001), omega=(0.01, 3, 0))
    >>> view.motion(racket).show()  # doctest: +SKIP
    """
    check_kind(trajectory, "trajectory", "Trajectory", "FreeMotion", "HeavyTop", "GyrostatMotion")
    options: dict[str, Any] = {"shape": shape, "title": title, "duration": duration, "time_unit": time_label}
    if not isinstance(trajectory, _core.FreeMotion | _core.HeavyTop | _core.GyrostatMotion):
        if end is not None:
            raise ValueError("end: a trajectory has its own times; leave it out")
        scene = Scene.of(trajectory, frames=None, **options)
    elif end is None:
        raise ValueError(
            "end: a motion in closed form has no end of its own; give the time to which it is shown"
        )
    else:
        scene = Scene.of_motion(trajectory, end, **options)
    for note in scene.notes:
        warnings.warn(note, stacklevel=2)
    first, last = float(scene.t.min()), float(scene.t.max())
    start = float(scene.t[0]) if at is None else float(at)
    if not first <= start <= last:
        raise ValueError(f"at: {start:g} is not between {first:g} and {last:g}, the times of the motion")
    is_new = plotter is None or f"{name}-body" not in plotter.actors
    plotter = new_plotter() if plotter is None else plotter
    player = _Player(plotter, scene, name)
    player.seek(start)
    if is_new:
        show_all(plotter)
        if not plotter.off_screen and plotter.iren is not None:
            player.take_control()
    return plotter


class _Player:
    """The actors of a motion, placed as at one sample."""

    def __init__(self, plotter: Plotter, scene: Scene, name: str) -> None:
        self._plotter, self._scene, self._name = plotter, scene, name
        self._reach = longest(scene.shape.vertices)
        self._thickness = 0.012 * self._reach
        self._index, self._begun = 0, 0.0
        self._is_running = False
        self._slider: Any = None
        self._tips = self._scale(_core.rotate(scene.quaternion, scene.omega))
        inside = np.zeros((0, 3)) if scene.inside is None else _core.rotate(scene.quaternion, scene.inside)
        momenta = self._scale(np.concatenate([scene.momentum, inside]))
        self._momenta, self._inside = momenta[: len(scene.t)], momenta[len(scene.t) :]
        self._bodies = add_surface(plotter, scene.shape, f"{name}-body", 1.0)
        for k, (color, axis) in enumerate(zip(AXIS_COLORS, scene.axes.T, strict=True)):
            reach = 1.2 * self._reach
            mesh = line(-reach * axis, reach * axis, 0.5 * self._thickness)
            self._bodies.append(plotter.add_mesh(mesh, color=color, name=f"{name}-axis-{k}", **AXIS_STYLE))
        self._factors = [disc.factor(self._rate() / RATE) for disc in scene.discs]
        self._wheels = [
            WheelActors(plotter, disc, factor, f"{name}-wheel-{k}")
            for k, (disc, factor) in enumerate(zip(scene.discs, self._factors, strict=True))
        ]
        self._add_space()

    def seek(self, time: float) -> None:
        """Show the sample nearest to a time."""
        self._show(int(np.abs(self._scene.t - time).argmin()))

    def take_control(self) -> None:
        """Add a slider for time to the window; the space bar starts and stops the motion."""
        t = self._scene.t
        self._slider = self._plotter.add_slider_widget(
            self.seek,
            (float(t.min()), float(t.max())),
            value=float(t[self._index]),
            title=f"time ({self._scene.time_unit}), space bar to run",
            pointa=(0.2, 0.08),
            pointb=(0.8, 0.08),
            color="#333333",
            fmt="{:.4g}",
            interaction_event="always",
        )
        self._plotter.add_key_event("space", self.toggle)
        self._plotter.add_timer_event(max_steps=2**31 - 1, duration=_TICK, callback=self.tick)

    def toggle(self) -> None:
        """Start or stop the motion; at its end it starts again."""
        self._is_running = not self._is_running
        if self._index == len(self._scene.t) - 1:
            self._index = 0
        self._begun = perf_counter() - abs(self._scene.t[self._index] - self._scene.t[0]) / self._rate()

    def tick(self, _step: int = 0) -> None:
        """Show the state that the clock has reached."""
        if not self._is_running:
            return
        gone = (perf_counter() - self._begun) * self._rate()
        last = len(self._scene.t) - 1
        index = min(int(np.searchsorted(np.abs(self._scene.t - self._scene.t[0]), gone)), last)
        self._is_running = index < last
        if self._slider is not None:
            self._slider.GetRepresentation().SetValue(float(self._scene.t[index]))
        self._show(index)
        self._plotter.render()

    def _rate(self) -> float:
        """Return the time of the motion that passes in one second."""
        return float(np.ptp(self._scene.t) or 1.0) / self._scene.duration

    def _scale(self, vectors: Floats) -> Floats:
        return vectors * (_ARROW * self._reach / longest(vectors))

    def _add_space(self) -> None:
        """Add what does not move: the axes of space, and the path of ω."""
        reach = 1.15 * _ARROW * self._reach
        for label, axis in zip("xyz", np.eye(3), strict=True):
            name = f"{self._name}-space-{label}"
            mesh = pyvista().Line((0.0, 0.0, 0.0), reach * axis)
            self._plotter.add_mesh(mesh, color="#AAAAAA", line_width=1.5, name=name, **AXIS_STYLE)
            add_name(self._plotter, 1.05 * reach * axis, label, "#888888", f"{name}-label")
        if len(self._tips) > 1:
            path = pyvista().MultipleLines(self._tips)
            style = {**AXIS_STYLE, "line_width": 1.5, "opacity": 0.5, "name": f"{self._name}-path"}
            self._plotter.add_mesh(path, color=OMEGA_COLOR, **style)

    def _show(self, index: int) -> None:
        self._index = index
        placed = np.eye(4)
        placed[:3, :3] = _core.rotate(self._scene.quaternion[index], np.eye(3)).T
        for actor in self._bodies:
            actor.user_matrix = placed
        for wheel in self._wheels:
            wheel.show(index, placed)
        if len(self._inside):
            self._add_arrow("h  ", self._inside[index], INSIDE_COLOR, "right")
        self._add_arrow("L  ", self._momenta[index], MOMENTUM_COLOR, "right")
        self._add_arrow("  omega", self._tips[index], OMEGA_COLOR, "left")  # VTK's fonts have no ω
        instant = f"t = {self._scene.t[index]:.4g} {self._scene.time_unit}"
        discs = zip(self._scene.discs, self._factors, strict=True)
        speeds = [disc.words(index, factor, self._scene.time_unit) for disc, factor in discs]
        text = "\n".join([*([self._scene.title] if self._scene.title else []), instant, *speeds])
        self._plotter.add_text(
            text, position="upper_left", font_size=11, color="#333333", name=f"{self._name}-time"
        )

    def _add_arrow(self, label: str, tip: Floats, color: str, side: str) -> None:
        name = f"{self._name}-{label.strip()}"
        length = float(np.linalg.norm(tip))
        if length < 4.0 * self._thickness:
            for gone in (name, f"{name}-label"):
                self._plotter.remove_actor(gone, render=False)
            return
        mesh = arrow(tip, self._thickness)
        self._plotter.add_mesh(mesh, color=color, name=name, **AXIS_STYLE)
        add_name(self._plotter, tip, label, color, f"{name}-label", side=side)


_RING: Final = np.linspace(0.0, 2.0 * np.pi, 49)
_BESIDE: Final = 1.3
"""Distance of a wheel's name from its middle, in radii."""
_ABOVE: Final = 1.03
"""Distance of the marks from the middle, in half thicknesses: outside of the faces."""


class WheelActors:
    """A disc with its marks, placed as at one sample.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Where to show it.
    disc : Disc
        The wheel.
    factor : float
        How many times slower it is drawn than it turns.
    name : str
        Of its actors.
    """

    def __init__(self, plotter: Plotter, disc: Disc, factor: float, name: str) -> None:
        self._plotter, self._disc, self._factor, self._name = plotter, disc, factor, name
        rim = pyvista().Cylinder(
            center=disc.middle, direction=disc.axis, radius=disc.radius, height=2.0 * disc.half, resolution=48
        )
        faces = _fan(disc, _RING, disc.radius, 0.5 * (1.0 + _ABOVE))
        self._marks = [self._add(mesh, INSIDE_COLOR, f"mark-{k}") for k, mesh in enumerate(_marks(disc))]
        self._body = [self._add(rim, RIM_COLOR, "rim"), self._add(faces, DISC_COLOR, "faces")]

    def show(self, index: int, placed: Floats) -> None:
        """Place the wheel as at one sample, in a body with this placement."""
        for actor in self._body:
            actor.user_matrix = placed
        angle = 0.0 if self._disc.angle is None else float(self._disc.angle[index]) / self._factor
        for actor in self._marks:
            actor.user_matrix = placed @ _turn_about_axis(self._disc, angle)
        around = self._disc.circle(_RING, _BESIDE * self._disc.radius, 0.0) @ placed[:3, :3].T
        highest = around[around[:, 2].argmax()]
        add_name(self._plotter, highest, self._disc.name, INSIDE_COLOR, f"{self._name}-label")

    def _add(self, mesh: Any, color: str, part: str) -> Any:
        return self._plotter.add_mesh(mesh, color=color, name=f"{self._name}-{part}", **AXIS_STYLE)


def _marks(disc: Disc) -> list[Any]:
    """Make one broad and several narrow spokes on both faces; rings instead if the angle is unknown."""
    thick = 0.02 * disc.radius
    if disc.angle is None:
        rings = [
            pyvista().MultipleLines(disc.circle(_RING, part * disc.radius, side * _ABOVE * disc.half))
            for part in RINGS
            for side in (-1.0, 1.0)
        ]
        return [ring.tube(radius=thick) for ring in rings]
    step = 2.0 * np.pi / SPOKES
    others: Floats = step * np.arange(2.0, SPOKES)
    marks = [_fan(disc, np.linspace(0.0, step, 9), SPOKE * disc.radius, _ABOVE)]
    for side in (-_ABOVE * disc.half, _ABOVE * disc.half):
        tips = disc.circle(others, SPOKE * disc.radius, side)
        marks += [line(disc.middle + side * disc.axis, tip, thick) for tip in tips]
    return marks


def _fan(disc: Disc, angles: Floats, radius: float, above: float) -> Any:
    """Make sectors on both faces, at this many half thicknesses from the middle."""
    sides = (-above * disc.half, above * disc.half)
    parts = [np.vstack([disc.middle + side * disc.axis, disc.circle(angles, radius, side)]) for side in sides]
    count = len(angles) + 1
    first = np.stack([np.zeros(count - 2, int), np.arange(1, count - 1), np.arange(2, count)], axis=-1)
    return surface(np.vstack(parts), np.vstack([first, first + count]))


def _turn_about_axis(disc: Disc, angle: float) -> Floats:
    """Return the turn about the axis of a disc, shape (4, 4)."""
    x, y, z = disc.axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(4)
    turn[:3, :3] += np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    turn[:3, 3] = disc.middle - turn[:3, :3] @ disc.middle
    return turn
