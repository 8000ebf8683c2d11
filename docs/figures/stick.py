"""The stick of mex143: three particles on a line in place of a body."""

import numpy as np
from _scene import BLUE, GRAY, INK, RED, Scene, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw a body and, below it, the particles that stand for it."""
    scene = Scene(5.6, 2.9, flat=True)
    a, b = 1.3, 2.1
    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    radius = 1.0 + 0.10 * np.cos(2.0 * turn + 0.4) + 0.06 * np.sin(3.0 * turn)
    blob = radius[:, np.newaxis] * np.stack(
        [2.35 * np.cos(turn) + 0.05, 0.62 * np.sin(turn), 0 * turn], axis=-1
    )
    scene.fill(blob, edge=GRAY)
    scene.line([-a, 0, 0], [b, 0, 0], color=INK, linewidth=2.0)
    for x, size, label, color in ((-a, 13, "$m_1$", BLUE), (0.0, 9, "$m_0$", RED), (b, 10, "$m_2$", BLUE)):
        scene.ax.plot(x, 0.0, "o", color=color, markersize=size, zorder=5)
        scene.label([x, 0, 0], label, color, offset=(0.0, 17.0))
    scene.label([0.0, 0.0, 0.0], "C", offset=(0.0, -15.0), size=12)
    for x in (-a, 0.0, b):
        scene.line([x, -0.30 if x else -0.42, 0], [x, -0.98, 0], color=GRAY, linewidth=0.8)
    scene.arrow([-a, -0.9, 0], [0, -0.9, 0], "$a$", at=0.5, offset=(0.0, -10.0), both=True, linewidth=1.0)
    scene.arrow([0, -0.9, 0], [b, -0.9, 0], "$b$", at=0.5, offset=(0.0, -10.0), both=True, linewidth=1.0)
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
