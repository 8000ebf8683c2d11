"""The Euler angles ZXZ: φ about Z, θ about the line of nodes, ψ about the body's z."""

import numpy as np
from _scene import BLUE, GRAY, INK, RED, Scene, X, Y, Z, save
from matplotlib.figure import Figure

PHI, THETA, PSI = np.deg2rad([42.0, 38.0, 52.0])


def turned(angle: float, axis: int) -> np.ndarray:
    """The rotation matrix about one coordinate axis."""
    c, s = np.cos(angle), np.sin(angle)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[[j, j, k, k], [j, k, j, k]] = c, -s, s, c
    return matrix


def draw() -> Figure:
    """Draw both frames, the line of nodes and the three angles."""
    scene = Scene(5.2, 4.6, azimuth=52.0, elevation=30.0)
    nodes = turned(PHI, 2) @ X
    body = (turned(PHI, 2) @ turned(THETA, 0) @ turned(PSI, 2)).T
    origin = np.zeros(3)

    level = scene.circle(origin, X, Y)
    tilted = scene.circle(origin, nodes, np.cross(body[2], nodes))
    scene.fill(level, "#EFEFEF", 0.9)
    scene.fill(tilted, "#DCE9F3", 0.75)
    scene.line(level, color=GRAY, linewidth=0.8)
    scene.line(tilted, color=BLUE, linewidth=0.8)
    scene.line(-1.0 * nodes, 1.0 * nodes, color=INK, linestyle=(0, (5, 3)))
    scene.arrow(origin, 1.3 * nodes, "line of nodes", INK, linewidth=1.2, offset=(8.0, -9.0))
    scene.ax.texts[-1].set_fontsize(11)
    scene.axes(origin, (X, Y, Z), ("$X$", "$Y$", "$Z$"), 1.3, [GRAY] * 3)
    scene.axes(origin, body, ("$x$", "$y$", "$z$"), 1.3, [BLUE] * 3)
    scene.angle(origin, X, nodes, 0.62, r"$\varphi$", RED)
    scene.angle(origin, Z, body[2], 0.75, r"$\theta$", RED)
    scene.angle(origin, nodes, body[0], 0.62, r"$\psi$", RED, push=13.0)
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
