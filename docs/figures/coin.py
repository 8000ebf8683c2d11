"""The coin of mex73 and the three principal axes through a point of its rim."""

import numpy as np
from _scene import BLUE, GRAY, GREEN, RED, Scene, X, Y, Z, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the coin lying flat with P on its rim."""
    scene = Scene(4.8, 2.9, azimuth=-50.0, elevation=28.0)
    scene.fill(scene.circle(np.zeros(3), X, Y), edge=GRAY)
    rim = np.array([1.0, 0.0, 0.0])
    scene.line(-X, 1.8 * X, color=BLUE, linewidth=1.0, linestyle=(0, (7, 3, 1, 3)))
    scene.axes(rim, (X, Y, Z), ("", "", ""), 0.85, (BLUE, RED, GREEN), linewidth=2.0)
    scene.label(rim + 0.85 * X, r"$\frac{1}{4}MR^2$", BLUE, offset=(28.0, -4.0))
    scene.label(rim + 0.85 * Y, r"$\frac{5}{4}MR^2$", RED, offset=(28.0, 4.0))
    scene.label(rim + 0.85 * Z, r"$\frac{3}{2}MR^2$", GREEN, offset=(0.0, 13.0))
    scene.point(np.zeros(3), "C", offset=(-2.0, 10.0))
    scene.point(rim, "P", offset=(-3.0, -15.0))
    scene.label([-0.5, 0.0, 0.0], "$R$", GRAY, offset=(-4.0, 9.0))
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
