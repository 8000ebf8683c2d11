"""Pictures of a motion over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from polhode.plot._style import AXIS_COLORS, AXIS_DASHES, new_axes, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from polhode.results import Trajectory

__all__ = ["angular_velocity"]


def angular_velocity(
    trajectory: Trajectory,
    ax: Axes | None = None,
    *,
    frame: Literal["body", "principal"] = "body",
    degrees: bool = False,
    time_unit: str = "s",
) -> Axes:
    """Draw the components of the angular velocity over time.

    Parameters
    ----------
    trajectory : Trajectory
        The motion; of a stack, every body is drawn.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.
    frame : {"body", "principal"}
        Components along the body's axes or along its principal axes (ascending moments).
    degrees : bool
        Degrees instead of radians.
    time_unit : str
        Name of the unit of time, for the labels.

    Returns
    -------
    matplotlib.axes.Axes
    """
    if ax is None:
        ax = new_axes()
    omega = trajectory.omega
    if frame == "principal":
        omega = np.einsum("...ij,...ti->...tj", trajectory.body.principal.axes, omega)
        labels = [rf"$\omega_{i}$" for i in "123"]
    elif frame == "body":
        labels = [rf"$\omega_{i}$" for i in "xyz"]
    else:
        raise ValueError(f"frame: {frame!r} is not 'body' or 'principal'")
    if degrees:
        omega = np.rad2deg(omega)
    curves = omega.reshape(-1, len(trajectory), 3)
    opacity = 1.0 if len(curves) == 1 else 0.5
    for number, curve in enumerate(curves):
        for i in range(3):
            ax.plot(
                trajectory.t,
                curve[:, i],
                color=AXIS_COLORS[i],
                linestyle=AXIS_DASHES[i],
                alpha=opacity,
                label=labels[i] if number == 0 else None,
            )
    ax.set_xlabel(f"time ({time_unit})")
    ax.set_ylabel(f"angular velocity ({'deg' if degrees else 'rad'}/{time_unit})")
    tidy(ax)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, ncols=3, frameon=False)
    return ax
