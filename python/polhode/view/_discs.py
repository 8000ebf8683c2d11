"""The wheels of a motion in a window: discs that turn by their angle relative to the body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._scene.style import DISC_COLOR, INSIDE_COLOR, RIM_COLOR
from polhode._scene.wheels import RINGS, SPOKE, SPOKES
from polhode.view._style import AXIS_STYLE, add_name, line, pyvista, surface

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from pyvista import Plotter

    from polhode._scene.wheels import Disc

    Floats = NDArray[np.float64]

__all__ = ["WheelActors"]

_RING: Final = np.linspace(0.0, 2.0 * np.pi, 49)
_BESIDE: Final = 1.3
"""How far its name stands from the middle, in radii."""
_ABOVE: Final = 1.03
"""How far the marks stand from the middle, in half thicknesses: outside of the faces."""


class WheelActors:
    """A disc with its marks, put where they are at a sample.

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
        """Put it where it is at a sample, in a body that is placed so."""
        for actor in self._body:
            actor.user_matrix = placed
        angle = 0.0 if self._disc.angle is None else float(self._disc.angle[index]) / self._factor
        for actor in self._marks:
            actor.user_matrix = placed @ _turned(self._disc, angle)
        around = self._disc.circle(_RING, _BESIDE * self._disc.radius, 0.0) @ placed[:3, :3].T
        highest = around[around[:, 2].argmax()]
        add_name(self._plotter, highest, self._disc.name, INSIDE_COLOR, f"{self._name}-label")

    def _add(self, mesh: Any, color: str, part: str) -> Any:
        return self._plotter.add_mesh(mesh, color=color, name=f"{self._name}-{part}", **AXIS_STYLE)


def _marks(disc: Disc) -> list[Any]:
    """Make a broad spoke and the others on both faces; rings in their place where the angle is not known."""
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
    """Make sectors of both faces, so many half thicknesses from the middle."""
    sides = (-above * disc.half, above * disc.half)
    parts = [np.vstack([disc.middle + side * disc.axis, disc.circle(angles, radius, side)]) for side in sides]
    count = len(angles) + 1
    first = np.stack([np.zeros(count - 2, int), np.arange(1, count - 1), np.arange(2, count)], axis=-1)
    return surface(np.vstack(parts), np.vstack([first, first + count]))


def _turned(disc: Disc, angle: float) -> Floats:
    """Give the turn about the axis of a disc, shape (4, 4)."""
    x, y, z = disc.axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn = np.eye(4)
    turn[:3, :3] += np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    turn[:3, 3] = disc.middle - turn[:3, :3] @ disc.middle
    return turn
