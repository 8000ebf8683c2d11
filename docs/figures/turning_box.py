"""The box of mex174, spinning about an axle that turns about the vertical."""

import numpy as np
from _scene import BLUE, GRAY, GREEN, INK, RED, Scene, X, Y, Z, save
from matplotlib.figure import Figure

ALPHA = np.deg2rad(35.0)


def draw() -> Figure:
    """Draw the box on its axle, at the angle α to the vertical."""
    scene = Scene(4.8, 4.2, azimuth=28.0, elevation=16.0)
    c, s = np.cos(ALPHA), np.sin(ALPHA)
    body = np.array([[c, 0.0, -s], Y, [s, 0.0, c]])
    half = np.array([0.35, 0.75, 0.85])
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    corners = (signs * half) @ body
    origin = np.zeros(3)
    scene.line(-1.7 * Y, -half[1] * Y, color=INK, linewidth=2.2)
    scene.hull(corners)
    hidden = np.argmin(corners @ scene.toward_viewer)
    for i, a in enumerate(corners):
        for j, b in enumerate(corners[:i]):
            if np.abs(signs[i] - signs[j]).sum() == 2:
                style = {"linestyle": (0, (4, 3)), "linewidth": 0.8} if hidden in (i, j) else {}
                scene.line(a, b, color=GRAY, **style)
    scene.line(-1.5 * Z, 1.9 * Z, color=GRAY, linestyle=(0, (7, 3, 1, 3)))
    scene.label(1.9 * Z, "$Z$", GRAY, offset=(0.0, 9.0))
    scene.axes(origin, body, ("$x$", "$y$", "$z$"), 1.75, (BLUE, RED, GREEN))
    scene.angle(origin, Z, body[2], 1.35, r"$\alpha$")
    scene.turn(1.7 * Z, 0.3 * X, 0.3 * Y, -100.0, 200.0, None, INK)
    scene.label(1.7 * Z, r"$\dot\beta$", offset=(36.0, 0.0))
    scene.turn(1.35 * Y, 0.3 * Z, 0.3 * X, -80.0, 220.0, None, RED)
    scene.label(1.35 * Y, r"$\dot\alpha$", RED, offset=(12.0, -33.0))
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
