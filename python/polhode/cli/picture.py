"""The demo's picture: the body with its axes, its flips in space, and its rates over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core, plot
from polhode._extras import require
from polhode.files.picture import save_picture
from polhode.plot._style import show_around

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["draw_flip"]

_SNAPSHOTS = 9
_VIEW = {"elev": 16.0, "azim": -62.0}


def draw_flip(
    path: Path, vertices: Floats, faces: NDArray[np.int64], trajectory: Trajectory, flips: Floats
) -> None:
    """Draw a body that flips over and save the picture.

    Parameters
    ----------
    path : pathlib.Path
        A file that matplotlib can write.
    vertices, faces : numpy.ndarray
        The body's mesh, in the unit of length of the trajectory.
    trajectory : Trajectory
        One body's motion, with its angular momentum along +z or nearly so.
    flips : numpy.ndarray
        Times of the flips, marked in the picture.
    """
    figure_module: Any = require("matplotlib.figure", extra="plot", purpose="drawing")
    figure = figure_module.Figure(figsize=(11.0, 5.4), facecolor="white")
    placed = vertices - trajectory.body.center_of_mass
    _draw_body(figure, placed, faces, trajectory)
    rates = _draw_rates(figure, trajectory, flips)
    _draw_snapshots(figure, rates, placed, faces, trajectory)
    save_picture(figure, path)


def _draw_body(figure: Any, vertices: Floats, faces: NDArray[np.int64], trajectory: Trajectory) -> None:
    ax = figure.add_axes((-0.01, 0.06, 0.35, 0.86), projection="3d", computed_zorder=False)
    ax.view_init(**_VIEW)
    reach = np.linalg.norm(vertices, axis=1).max()
    plot.body(vertices, faces, ax)
    plot.principal_axes(trajectory.body, ax, length=1.06 * reach, center=np.zeros(3))
    show_around(ax, np.zeros(3), 0.74 * reach)
    moments = trajectory.body.principal_moments
    ratios = " : ".join(f"{moment / moments[0]:.2f}" for moment in moments)
    figure.text(0.165, 0.075, f"$I_1 : I_2 : I_3$ = {ratios}", ha="center", va="center", fontsize=11)
    figure.text(0.165, 0.945, "Spin it about $e_2$ ...", ha="center", va="center", fontsize=14)


def _draw_rates(figure: Any, trajectory: Trajectory, flips: Floats) -> Any:
    ax = figure.add_axes((0.395, 0.115, 0.58, 0.45))
    plot.angular_velocity(trajectory, ax, frame="principal")
    curves = ax.get_lines()[:3]
    for curve in curves:
        curve.set_linewidth(1.8)
    for time in flips:
        ax.axvline(time, color="0.7", linewidth=0.8, linestyle=":", zorder=0)
    names = [r"$\omega_1$, least moment", r"$\omega_2$, intermediate", r"$\omega_3$, greatest"]
    place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
    ax.legend(curves, names, ncols=3, frameon=False, **place)
    return ax


def _draw_snapshots(
    figure: Any, rates: Any, vertices: Floats, faces: NDArray[np.int64], trajectory: Trajectory
) -> None:
    """Draw the body as seen from space, each view above the time it shows."""
    box = rates.get_position()
    width = box.width / _SNAPSHOTS
    reach = np.linalg.norm(vertices, axis=1).max()
    times = trajectory.t[0] + (np.arange(_SNAPSHOTS) + 0.5) * np.ptp(trajectory.t) / _SNAPSHOTS
    for number, row in enumerate(np.searchsorted(trajectory.t, times)):
        middle = box.x0 + (number + 0.5) * width
        place = (middle - 0.75 * width, 0.625, 1.5 * width, 0.30)
        ax = figure.add_axes(place, projection="3d", computed_zorder=False)
        ax.patch.set_alpha(0.0)
        ax.view_init(**_VIEW)
        plot.body(_core.rotate(trajectory.quaternion[row], vertices), faces, ax)
        show_around(ax, np.zeros(3), 0.93 * reach)
    middle = box.x0 + box.width / 2
    figure.text(
        middle, 0.945, "... and it flips over, again and again.", ha="center", va="center", fontsize=14
    )
