"""Flat spin: a body that loses energy inside turns from its long axis to its shortest one."""

import numpy as np
from _scene import BLUE, GRAY, GREEN, INK, Scene, X, Y, Z, save
from matplotlib.figure import Figure
from polhode import RigidBody, loads

MOMENTS = np.array([0.6, 1.6, 1.8])
BODY = RigidBody.from_principal(1.0, MOMENTS)
SLUG = 0.1
LOOSE = loads.slug(inertia=SLUG, damping=0.12)
WITH_SLUG = MOMENTS + SLUG
"""Where both turn together."""
END = 140.0


def draw() -> Figure:
    """Draw the path of L in the body on a sphere, and energy and |L| over time."""
    scene = Scene(9.4, 4.4, azimuth=38.0, elevation=24.0, panels=2)
    times = np.linspace(0.0, END, 6001)
    run = BODY.simulate(times, omega=(3.0, 0.1, 0.1), load=LOOSE)
    momentum = run.angular_momentum("body").spin
    size = np.linalg.norm(momentum, axis=1)
    energy = run.kinetic_energy().total
    theta, phi = np.meshgrid(np.linspace(0, np.pi, 60), np.linspace(0, 2 * np.pi, 120))
    sphere = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    scene.panel(0, r"$\mathbf{L}$ in the body")
    scene.hull(sphere.reshape(-1, 3))
    path = momentum / size[:, np.newaxis]
    # Energy above that of the middle axis: it goes round the long axis, else round the short one.
    turn = int(np.argmax(energy < 0.5 * size[0] ** 2 / WITH_SLUG[1]))
    for piece, color in ((path[: turn + 1], BLUE), (path[turn:], GREEN)):
        curve(scene, piece, color)
    for n, color in ((path[0], BLUE), (path[-1], GREEN)):
        scene.point(n, color=color)
    for axis, name in ((X, "$1$"), (Y, "$2$"), (Z, "$3$")):
        scene.line(axis, 1.2 * axis, color=INK)
        scene.label(1.32 * axis, name)
    over_time(scene, times, energy / energy[0], size / size[0], turn)
    return scene.figure


def curve(scene: Scene, path: np.ndarray, color: str) -> None:
    """A curve on the sphere, its part on the far side faint."""
    gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    even = np.linspace(0.0, gone[-1], max(2, int(gone[-1] / 0.06)))
    path = np.stack([np.interp(even, gone, column) for column in path.T], axis=-1)
    near = path @ scene.toward_viewer >= 0.0
    for side, style in ((near, {"linewidth": 1.1}), (~near, {"linewidth": 0.6, "alpha": 0.3})):
        scene.line(np.where(side[:, np.newaxis], path, np.nan), color=color, **style)


def over_time(scene: Scene, times: np.ndarray, energy: np.ndarray, size: np.ndarray, turn: int) -> None:
    """Energy and |L|, relative to the start."""
    scene.panel(1)
    ax = scene.ax
    ax.set_axis_on()
    ax.set_aspect("auto")
    ax.plot(times[::10], size[::10], color=INK, linewidth=2.0)
    for part, color in ((slice(None, turn + 1), BLUE), (slice(turn, None), GREEN)):
        ax.plot(times[part][::10], energy[part][::10], color=color, linewidth=2.0)
    ax.axhline(WITH_SLUG[0] / WITH_SLUG[2], color=GRAY, linewidth=1.0, linestyle="--")
    ax.annotate("$|L|$", (0.62 * END, 1.0), (0, -14), textcoords="offset points", color=INK)
    ax.annotate("energy", (0.4 * END, energy[int(0.4 * len(energy))]), (8, 4), textcoords="offset points")
    ax.annotate(
        r"$\mathbf{L}$ along axis 3",
        (0.04 * END, WITH_SLUG[0] / WITH_SLUG[2]),
        (0, 6),
        textcoords="offset points",
        color=GRAY,
    )
    ax.set_xlabel("time (s)")
    ax.set_ylabel("relative to the start")
    ax.set_ylim(0.0, 1.08)
    ax.spines[["top", "right"]].set_visible(False)


if __name__ == "__main__":
    save(draw(), __file__)
