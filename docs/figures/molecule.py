"""The four-atomic molecule of mex255: a triangle of equal atoms and one above it."""

import numpy as np
from _scene import BLUE, GRAY, INK, RED, Scene, Z, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the pyramid with its symmetry axis, edge a and height h."""
    scene = Scene(4.4, 3.4, azimuth=-73.0, elevation=20.0)
    side, height = 1.6, 1.35
    angle = np.deg2rad([90.0, 210.0, 330.0])
    base = side / np.sqrt(3.0) * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    top = height * Z
    scene.fill(base)
    for k in range(3):
        dashed = {"linestyle": (0, (4, 3))}
        scene.line(base[k], base[(k + 1) % 3], color=GRAY, **(dashed if k != 1 else {}))
        scene.line(base[k], top, color=GRAY, **(dashed if k == 0 else {}))
    scene.axes(np.zeros(3), (Z,), ("$z$",), height + 0.6, [INK], linewidth=1.0)
    for k, offset in enumerate([(21.0, 6.0), (-20.0, -4.0), (20.0, -4.0)]):
        scene.ax.plot(*scene.flat(base[k]), "o", color=BLUE, markersize=15, zorder=5)
        scene.label(base[k], "$m_1$", BLUE, offset=offset)
    scene.ax.plot(*scene.flat(top), "o", color=RED, markersize=15, zorder=5)
    scene.label(top, "$m_2$", RED, offset=(20.0, 3.0))
    scene.label((base[1] + base[2]) / 2, "$a$", offset=(0.0, -11.0))
    scene.label(0.45 * top, "$h$", offset=(8.0, 0.0))
    center = 0.3 * top
    scene.point(center, "C", offset=(-10.0, 0.0))
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
