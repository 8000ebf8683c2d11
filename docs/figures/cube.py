"""The cube of mex68 with the principal axes through its corner."""

import numpy as np
from _scene import BLUE, GRAY, GREEN, INK, PALE, RED, Scene, X, Y, Z, save, unit
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the cube, its edges as axes and the diagonal through the corner."""
    scene = Scene(4.4, 3.8, azimuth=25.0, elevation=22.0)
    corners = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=float)
    scene.hull(corners, PALE)
    for a in corners:
        for b in corners:
            if np.abs(a - b).sum() == 1.0 and (a < b).any():
                hidden = min(a.sum(), b.sum()) == 0.0
                style = {"linestyle": (0, (4, 3)), "linewidth": 0.8} if hidden else {}
                scene.line(a, b, color=GRAY, **style)
    origin = np.zeros(3)
    diagonal = np.ones(3)
    scene.axes(origin, (X, Y, Z), ("$x$", "$y$", "$z$"), 1.4, [INK] * 3, linewidth=1.0)
    scene.arrow(origin, 1.28 * diagonal, r"$e_1$", BLUE, offset=(13.0, 8.0), linewidth=2.0)
    second = unit([1.0, -1.0, 0.0])
    third = np.cross(unit(diagonal), second)
    scene.arrow(origin, 0.75 * second, r"$e_2$", RED, offset=(-10.0, -4.0), linewidth=2.0)
    scene.arrow(origin, 0.75 * third, r"$e_3$", GREEN, offset=(-6.0, -10.0), linewidth=2.0)
    scene.point(0.5 * diagonal, "C", offset=(-9.0, 7.0))
    scene.point(origin, "P", offset=(-11.0, 8.0))
    scene.label([0.5, 1.0, 0.0], "$L$", GRAY, offset=(9.0, -7.0))
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
