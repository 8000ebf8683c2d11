"""The cone of mex71 with its apex and its centre of mass."""

import numpy as np
from _scene import BLUE, GRAY, INK, RED, Scene, X, Y, Z, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the cone as `solids.cone` places it: C at the origin, the apex toward +z."""
    scene = Scene(3.8, 4.0, azimuth=-60.0, elevation=18.0)
    radius, height = 1.0, 2.2
    apex, base = 0.75 * height * Z, -0.25 * height * Z
    rim = scene.circle(base, radius * X, radius * Y)
    scene.hull(np.vstack([rim, apex]))
    scene.ring(base, radius * X, radius * Y)
    scene.axes(np.zeros(3), (X, Y), ("$x$", "$y$"), 1.5, [BLUE, RED])
    scene.axes(np.zeros(3), (Z,), ("$z$",), 0.75 * height + 0.55, [INK])
    scene.line(base, np.zeros(3), color=GRAY, linewidth=0.8, linestyle=(0, (4, 3)))
    scene.arrow(base, base + radius * scene.right, "$R$", GRAY, at=0.5, offset=(0.0, -9.0), linewidth=1.0)
    scene.point(np.zeros(3), "C", offset=(-10.0, 8.0))
    scene.point(apex, "P", offset=(13.0, 2.0))
    side = -1.35 * scene.right
    scene.arrow(side + base, side + apex, "$h$", GRAY, at=0.5, offset=(-10.0, 0.0), both=True, linewidth=1.0)
    side = -1.10 * scene.right
    scene.arrow(
        side, side + apex, r"$\frac{3}{4}h$", GRAY, at=0.6, offset=(12.0, 0.0), both=True, linewidth=1.0
    )
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
