"""Two parallel axes, one through the centre of mass."""

import numpy as np
from _scene import BLUE, GRAY, RED, Scene, Z, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw a body with an axis through C and a parallel one through P at the distance d⊥."""
    scene = Scene(4.4, 3.6, azimuth=-60.0, elevation=22.0)
    paper = np.stack([scene.right, scene.up])
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    radius = 1.0 + 0.12 * np.cos(2.0 * turn + 0.7) + 0.08 * np.sin(3.0 * turn)
    outline = radius[:, np.newaxis] * np.stack([1.5 * np.cos(turn), 0.8 * np.sin(turn)], axis=-1)
    scene.fill((outline + np.array([0.25, 0.0])) @ paper, edge=GRAY)
    center = np.zeros(3)
    point = np.array([1.05, 0.0, 0.20])
    for at, color, name in ((center, BLUE, "C"), (point, RED, "P")):
        scene.line(at - 1.3 * Z, at + 1.3 * Z, color=color, linestyle=(0, (7, 3, 1, 3)))
        scene.point(at, name, offset=(-11.0, -8.0) if name == "C" else (11.0, -8.0), color=color)
    scene.arrow(center, point, r"$\mathbf{d}$", at=0.5, offset=(0.0, 11.0))
    low = point * [1.0, 1.0, 0.0] - 0.95 * Z
    scene.arrow(-0.95 * Z, low, r"$d_\perp$", GRAY, at=0.5, offset=(0.0, -11.0), both=True, linewidth=1.0)
    scene.label(center + 1.3 * Z, r"$\mathbf{n}\cdot\mathsf{I}_C\mathbf{n}$", BLUE, offset=(0.0, 12.0))
    scene.label(point + 1.3 * Z, r"$\mathbf{n}\cdot\mathsf{I}_P\mathbf{n}$", RED, offset=(18.0, 12.0))
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
