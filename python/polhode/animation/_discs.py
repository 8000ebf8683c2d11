"""The wheels in the pictures of a film: discs that turn by their angle relative to the body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._extras import require
from polhode._scene.style import DISC_COLOR, INSIDE_COLOR, RIM_COLOR
from polhode._scene.wheels import RINGS, SPOKE, SPOKES

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode._scene.wheels import Disc

    Floats = NDArray[np.float64]

__all__ = ["draw_disc"]

_RING: Final = np.linspace(0.0, 2.0 * np.pi, 49)


def draw_disc(
    ax: Any, disc: Disc, to_space: Floats, scale: float, turned: float | None, view: Floats
) -> bool:
    """Draw a wheel at an attitude; tell whether it is on the near side of the body.

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
    faces = [points(_RING, r, -side), rim, points(_RING, r, side)]
    for polygon, color in zip(faces, (RIM_COLOR, RIM_COLOR, DISC_COLOR), strict=True):
        ax.add_collection3d(
            art3d.Poly3DCollection([polygon], facecolors=color, edgecolors=INSIDE_COLOR, lw=0.8, zorder=order)
        )
        order += 0.01
    style: dict[str, Any] = {"color": INSIDE_COLOR, "lw": 1.2, "zorder": order + 0.01}
    if turned is None:
        for part in RINGS:
            ax.plot(*points(_RING, part * r, side).T, **style)
        return is_near
    step, middle = 2.0 * np.pi / SPOKES, points(np.zeros(1), 0.0, side)
    mark = np.concatenate([middle, points(np.linspace(turned, turned + step, 9), SPOKE * r, side)])
    ax.add_collection3d(art3d.Poly3DCollection([mark], facecolors=INSIDE_COLOR, zorder=order))
    for k in range(2, SPOKES):
        tip = points(np.array([turned + k * step]), SPOKE * r, side)
        ax.plot(*np.concatenate([middle, tip]).T, **style)
    return is_near
