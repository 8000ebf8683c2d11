"""Cylinder, ball and ellipsoid with their axes (mex252, mex253, mex254)."""

import numpy as np
from _scene import BLUE, GRAY, GREEN, RED, Scene, X, Y, Z, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the three solids side by side."""
    scene = Scene(8.4, 3.1, azimuth=30.0, elevation=20.0, panels=3)
    names = ("$x$", "$y$", "$z$")
    scene.panel(0, "cylinder")
    radius, half = 0.75, 0.85
    ends = [scene.circle(s * half * Z, radius * X, radius * Y) for s in (-1, 1)]
    scene.hull(np.vstack(ends))
    scene.ring(-half * Z, radius * X, radius * Y)
    scene.line(ends[1], color=GRAY)
    scene.axes(np.zeros(3), (X, Y, Z), names, 1.5, (BLUE, RED, GREEN))
    scene.arrow(half * Z, half * Z + radius * scene.right, "$R$", at=0.6, offset=(0.0, 8.0), linewidth=1.0)
    side = -1.02 * scene.right
    scene.arrow(side - half * Z, side + half * Z, "$h$", at=0.5, offset=(-9.0, 0.0), both=True, linewidth=1.0)

    for number, (title, axes) in enumerate([("ball", (1.0, 1.0, 1.0)), ("ellipsoid", (1.35, 1.0, 0.65))], 1):
        scene.panel(number, title)
        theta, phi = np.meshgrid(np.linspace(0, np.pi, 60), np.linspace(0, 2 * np.pi, 120))
        sphere = [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]
        scene.hull(np.stack(sphere, axis=-1).reshape(-1, 3) * axes)
        a, b, c = np.diag(axes)
        for u, v in ((a, b), (a, c), (b, c)):
            scene.ring(np.zeros(3), u, v, "#B5B9C0")
        scene.axes(np.zeros(3), (X, Y, Z), names, 1.75, (BLUE, RED, GREEN))
        labels = ("$R$", "", "") if number == 1 else ("$a$", "$b$", "$c$")
        for vector, label, offset in zip(
            (a, b, c), labels, ((-7.0, 7.0), (3.0, 9.0), (9.0, 2.0)), strict=True
        ):
            if label:
                scene.label(0.6 * vector, label, offset=offset)
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
