"""The edge mill of mex175: a wheel that rolls around a vertical shaft."""

import numpy as np
from _scene import BLUE, GRAY, GREEN, INK, RED, Scene, X, Y, Z, save
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the wheel on its axle, with weight, normal force and angular velocities."""
    scene = Scene(5.4, 3.6, azimuth=-52.0, elevation=16.0)
    radius, arm, half = 1.0, 2.2, 0.12
    hub = arm * X
    track = scene.circle(-radius * Z, arm * X, arm * Y)
    scene.fill(scene.circle(-radius * Z, 1.25 * arm * X, 1.25 * arm * Y), "#F2F2F2", zorder=0.4)
    scene.line(track, color=GRAY, linewidth=0.8, linestyle=(0, (4, 3)), zorder=0.5)
    scene.line(-radius * Z, 1.3 * Z, color=INK, linewidth=3.0)
    scene.line(np.zeros(3), hub - half * X, color=INK, linewidth=2.2)
    faces = [scene.circle(hub + s * half * X, radius * Y, radius * Z) for s in (-1, 1)]
    scene.hull(np.vstack(faces), alpha=0.92)
    scene.line(faces[1], color=GRAY)
    near = hub + half * X
    scene.point(hub, "C", offset=(-9.0, -9.0))
    scene.point(np.zeros(3), "O", offset=(-11.0, 2.0))
    scene.arrow(hub, hub - 0.75 * Z, r"$m\mathbf{g}$", GREEN, at=0.8, offset=(17.0, 2.0))
    foot = hub - radius * Z
    scene.arrow(foot - 0.9 * Z, foot, r"$F_N$", BLUE, at=0.3, offset=(14.0, 0.0))
    scene.turn(1.15 * Z, 0.28 * X, 0.28 * Y, -150.0, 130.0, None, RED)
    scene.label(1.15 * Z, r"$\omega$", RED, offset=(26.0, 5.0))
    scene.arrow(near, near + radius * (np.sin(0.8) * Y + np.cos(0.8) * Z), linewidth=1.0)
    scene.label(near + 0.5 * np.sin(0.8) * Y + 0.5 * np.cos(0.8) * Z, "$R$", offset=(-7.0, 7.0))
    scene.label(0.5 * hub, "$b$", offset=(0.0, 9.0))
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
