"""The picture of an identification: what the fit leaves of the measurements."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from polhode.draw.plot.axes import axes_2d, tidy
from polhode.draw.style import AXIS_COLORS, OMEGA_COLOR

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from polhode.identify.results import Identified

__all__ = ["residuals"]

_MARKS: Final = "os^osvDPX"
_NORMAL: Final = 2.0
"""Sigmas between which 95 of 100 residuals are."""


def residuals(found: Identified, t: ArrayLike | None, ax: Axes | None) -> Axes:
    """Draw the residuals in units of their standard deviations, over time or row by row."""
    rows = np.asarray(found.residuals, dtype=float)
    rows = rows[:, None] if rows.ndim == 1 else rows
    place = np.arange(len(rows)) if t is None else np.asarray(t, dtype=float)
    if place.shape != (len(rows),):
        raise ValueError(
            f"t: expected shape ({len(rows)},), a time for each row of residuals, got {place.shape}; leave "
            "it out to draw them row by row"
        )
    ax = axes_2d(ax)
    ax.axhspan(-_NORMAL, _NORMAL, color="0.93", zorder=0)
    ax.axhline(0.0, color="0.6", linewidth=0.8, zorder=1)
    count = rows.shape[1]
    sensors = max(count // 3, 1)
    names = [one.rsplit(" ", 1)[-1] if sensors == 1 else one.replace("_", " ") for one in found.columns]
    # The legend is filled column by column.
    order = [3 * sensor + axis for axis in range(3) for sensor in range(sensors)] if names else range(count)
    size = float(np.clip(300.0 / max(len(rows), 1), 1.5, 5.0))
    for k in order:
        color = AXIS_COLORS[k % 3] if count != 1 else OMEGA_COLOR
        ax.plot(
            place,
            rows[:, k],
            linestyle="none",
            marker=_MARKS[k % len(_MARKS)],
            markersize=size,
            markerfacecolor=color if k < 3 else "none",
            color=color,
            label=names[k] if names else None,
            rasterized=len(rows) > 10_000,
        )
    ax.set_xlabel("row" if t is None else "t")
    ax.set_ylabel("residual / σ")
    fit = f"χ² / freedom = {found.chi2:.5g} / {found.degrees_of_freedom}"
    ax.set_title(fit if np.isnan(found.p_value) else f"{fit}, p = {found.p_value:.2g}", fontsize="medium")
    tidy(ax)
    ax.margins(x=0.02)
    most = max(1.1 * float(np.nanmax(np.abs(rows), initial=0.0)), 1.6 * _NORMAL)
    ax.set_ylim(-most, most)
    if names and len(rows):
        ax.set_ylim(-most, most * (1.0 + 0.25 * sensors))  # room for the legend
        ax.legend(loc="upper right", ncols=min(count, 3), fontsize="small", markerscale=2.0)
    return ax
