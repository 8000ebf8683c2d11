"""The frames N, primed and B and the points O, C and P of one body."""

import numpy as np
from _scene import GRAY, INK, Scene, X, Y, Z, save, unit
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw a body away from the origin of space, with the three vectors that place its points."""
    scene = Scene(6.4, 4.3, azimuth=-62.0, elevation=20.0)
    origin = np.array([0.0, 0.0, 0.0])
    place = np.array([3.1, 0.0, 1.15])
    tilt = np.array([unit([0.86, 0.10, 0.50]), unit([-0.2, 1.0, 0.1]), [0.0, 0.0, 0.0]])
    tilt[1] = unit(tilt[1] - (tilt[1] @ tilt[0]) * tilt[0])
    tilt[2] = np.cross(tilt[0], tilt[1])

    turn = np.linspace(0.0, 2.0 * np.pi, 200)
    radius = 1.25 + 0.17 * np.cos(2.0 * turn + 0.5) + 0.10 * np.sin(3.0 * turn)
    middle = scene.flat(place) + np.array([0.42, 0.12])
    outline = middle + radius[:, np.newaxis] * np.stack([1.1 * np.cos(turn), 0.86 * np.sin(turn)], axis=-1)
    paper = np.stack([scene.right, scene.up])
    scene.fill(outline @ paper, edge=GRAY)

    scene.axes(origin, (X, Y, Z), ("$X$", "$Y$", "$Z$"), 1.0, [INK] * 3)
    scene.label(origin, "N", INK, offset=(-13.0, -9.0))
    scene.axes(place, (X, Y, Z), ("$x'$", "$y'$", "$z'$"), 0.85, [GRAY] * 3, linewidth=1.0, linestyle="-")
    scene.axes(place, tilt, ("$x$", "$y$", "$z$"), 1.35)
    scene.point(place, "O", offset=(-12.0, 5.0))
    scene.label(place + 1.35 * tilt[2], "B", INK, offset=(14.0, 4.0))

    scene.arrow(origin, place, r"$\mathbf{R}$", INK, at=0.5, offset=(0.0, 11.0))
    center = place + np.array([0.92, -0.52]) @ paper
    scene.arrow(place, center, r"$\mathbf{c}$", INK, at=0.6, offset=(-4.0, -11.0))
    scene.point(center, "C", offset=(10.0, 0.0))
    mass = place + np.array([-0.36, -0.52]) @ paper
    scene.arrow(place, mass, r"$\mathbf{r}$", INK, at=0.6, offset=(-9.0, 3.0))
    scene.point(mass, r"$\mathrm{d}m$", offset=(15.0, -4.0))
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
