"""Polhodes of an asymmetric body: the curves that ω draws on the ellipsoid of constant energy."""

import numpy as np
from _scene import BLUE, GREEN, RED, Scene, X, Y, Z, save
from matplotlib.figure import Figure
from polhode import RigidBody

MOMENTS = np.array([1.0, 1.8, 2.6])


def draw() -> Figure:
    """Draw polhodes around the axes of the smallest and largest moment, and the separatrix between them."""
    scene = Scene(4.6, 4.4, azimuth=52.0, elevation=13.0)
    body = RigidBody.from_principal(1.0, MOMENTS)
    semi_axes = 1.0 / np.sqrt(MOMENTS)  # where ω·Iω = 1

    theta, phi = np.meshgrid(np.linspace(0, np.pi, 60), np.linspace(0, 2 * np.pi, 120))
    sphere = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    scene.hull(sphere.reshape(-1, 3) * semi_axes)

    times = np.linspace(0.0, 40.0, 1601)
    for pole, color in ((0, BLUE), (2, GREEN)):
        for angle in np.deg2rad([10.0, 22.0, 34.0] if pole == 0 else [12.0, 25.0, 38.0]):
            for sign in (1.0, -1.0):
                start = np.zeros(3)
                start[pole], start[1] = sign * np.cos(angle), np.sin(angle)
                curve(scene, body.simulate(times, start * semi_axes).omega, color)
    slope = np.sqrt(
        MOMENTS[0] * (MOMENTS[1] - MOMENTS[0]) / (MOMENTS[2] * (MOMENTS[2] - MOMENTS[1]))
    )  # where the energy and the momentum are those of the spin about axis 2
    for sign in (1.0, -1.0):
        across = np.array([1.0, 0.0, sign * slope])
        across /= np.sqrt(across**2 @ MOMENTS)
        curve(scene, scene.circle(np.zeros(3), across, semi_axes * Y), RED)
    for axis, name, color in ((X, "$1$", BLUE), (Y, "$2$", RED), (Z, "$3$", GREEN)):
        reach = semi_axes @ axis
        scene.line(reach * axis, (reach + 0.25) * axis, color=color, linewidth=2.0)
        scene.label((reach + 0.32) * axis, name, color)
    return scene.figure


def curve(scene: Scene, omega: np.ndarray, color: str) -> None:
    """A curve on the ellipsoid, its part on the far side faint."""
    near = (omega * MOMENTS) @ scene.toward_viewer >= 0.0
    for side, style in ((near, {"linewidth": 1.4}), (~near, {"linewidth": 0.7, "alpha": 0.35})):
        visible = np.where(side[:, np.newaxis], omega, np.nan)
        scene.line(visible, color=color, **style)


if __name__ == "__main__":
    save(draw(), __file__)
