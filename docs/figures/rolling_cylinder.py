"""The rolling cylinder of mex173 and the velocities of three of its points."""

import numpy as np
from _scene import BLUE, GRAY, INK, RED, Scene, X, Y, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the cylinder from its end, rolling to the right."""
    scene = Scene(4.6, 3.0, flat=True)
    rim = scene.circle(np.zeros(3), X, Y)
    scene.fill(rim, edge=GRAY)
    scene.line([-2.0, -1.0, 0.0], [2.6, -1.0, 0.0], color=INK, linewidth=1.6)
    speed = 1.0
    for height, name, offset in (
        (0.0, "axis", (-16.0, 0.0)),
        (1.0, "top", (-14.0, 7.0)),
        (-1.0, "contact", (0.0, -11.0)),
    ):
        at = np.array([0.0, height, 0.0])
        if height >= 0.0:
            label = r"$\mathbf{v}$" if height == 0.0 else r"$2\mathbf{v}$"
            scene.arrow(at, at + (1.0 + height) * speed * X, label, BLUE, offset=(11.0, 0.0), linewidth=2.0)
        scene.point(at, name, offset=offset)
        scene.ax.texts[-1].set_fontsize(11)
    scene.line([0.0, -1.0, 0.0], [0.0, 1.0, 0.0], color=GRAY, linestyle=(0, (4, 3)), linewidth=0.9)
    scene.line([0.0, -1.0, 0.0], [2.0, 1.0, 0.0], color=BLUE, linestyle=(0, (2, 3)), linewidth=0.9)
    scene.turn(np.zeros(3), 0.55 * X, 0.55 * Y, 235.0, 130.0, r"$\omega$", RED)
    scene.label([0.62, -0.47, 0.0], "$R$", GRAY, offset=(-5.0, -7.0))
    scene.line([0.0, 0.0, 0.0], [0.80, -0.60, 0.0], color=GRAY, linewidth=0.9)
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
