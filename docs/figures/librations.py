"""Shapes of satellites that can point down for ever: the regions of DeBra and Delp."""

import matplotlib as mpl
import numpy as np
from _scene import BLUE, GREEN, INK, STYLE, save
from matplotlib.figure import Figure

SHAPES = {"stick, upright": (1.0, 1.0, 0.02), "plate in the plane of the orbit": (0.4, 1.0, 0.6)}
"""Moments of roll, pitch and yaw."""


def draw() -> Figure:
    """Draw the regions in the plane of k₁ and k₃, each where three conditions hold."""
    mpl.rcParams.update(STYLE | {"font.size": 11.0})
    figure = Figure(figsize=(5.6, 5.2), facecolor="white", layout="constrained")
    ax = figure.add_subplot()
    across = np.linspace(-1.0, 1.0, 1601)
    k1, k3 = np.meshgrid(across, across)
    both = np.maximum(k1 * k3, 0.0)
    coupled = 1.0 + 3.0 * k1 + both - 4.0 * np.sqrt(both)
    for sign, color in ((1.0, GREEN), (-1.0, BLUE)):
        margin = np.min([k1 - k3, sign * k1, sign * k3, coupled], axis=0)
        ax.contourf(k1, k3, margin, levels=[0.0, 9.0], colors=[color], alpha=0.45)
        ax.contour(k1, k3, margin, levels=[0.0], colors=[color], linewidths=1.6)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.axvline(0.0, color=INK, linewidth=0.6)
    for name, (x, y, z) in SHAPES.items():
        place = ((y - z) / x, (y - x) / z)
        ax.plot(*place, "o", color=INK, markersize=5.0, clip_on=False, zorder=3)
        ax.annotate(name, place, (-6, 7), textcoords="offset points", ha="right")
    ax.text(0.62, 0.22, "pitch largest,\nyaw smallest", ha="center", color=INK)
    ax.annotate(
        "roll largest,\npitch smallest",
        (-0.07, -0.6),
        (-0.92, -0.68),
        color=INK,
        arrowprops={"arrowstyle": "-"},
    )
    ax.set(xlim=(-1, 1), ylim=(-1, 1), xlabel="$k_1 = (I_y - I_z)/I_x$", ylabel="$k_3 = (I_y - I_x)/I_z$")
    ax.set_aspect("equal")
    return figure


if __name__ == "__main__":
    save(draw(), __file__)
