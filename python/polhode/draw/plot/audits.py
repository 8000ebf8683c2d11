"""The picture of an audit: drifts, and the distance from the exact motion, over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode.draw.plot.axes import axes_2d, tidy
from polhode.draw.style import AXIS_COLORS, AXIS_DASHES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from polhode.motion.auditing import Audit

__all__ = ["drifts"]

_LEAST = 1e-16
"""What is less is drawn there."""


def drifts(audit: Audit, ax: Axes | None = None) -> Axes:
    """Draw the relative drifts and the angle from the exact motion, on a logarithmic scale."""
    ax = axes_2d(ax)
    curves = (
        ("energy drift", np.abs(audit.energy_drift)),
        ("angular momentum drift", audit.angular_momentum_drift),
        ("angle from exact, rad", audit.angle_from_exact),
    )
    for (name, values), color, dashes in zip(curves, AXIS_COLORS, AXIS_DASHES, strict=True):
        ax.plot(audit.t, np.maximum(values, _LEAST), color=color, linestyle=dashes, label=name)
    ax.set_yscale("log")
    ax.set_xlabel("t")
    ax.legend(loc="best")
    tidy(ax)
    return ax
