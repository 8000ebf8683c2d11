"""Body cone and space cone of a torque-free symmetric top."""

import numpy as np
from _scene import BLUE, GREEN, INK, RED, Scene, Z, save, unit
from matplotlib.figure import Figure


def draw() -> Figure:
    """Draw the two cones for a prolate and for an oblate top: they touch along ω and roll on each other."""
    scene = Scene(8.2, 4.0, azimuth=-75.0, elevation=14.0, panels=2)
    tilt = np.deg2rad(24.0)  # between ω and the symmetry axis
    for number, (title, ratio) in enumerate([("prolate: $I_s<I_t$", 0.45), ("oblate: $I_s>I_t$", 1.8)]):
        scene.panel(number, title)
        to_momentum = np.arctan(np.tan(tilt) / ratio)  # between L and the symmetry axis, tan = (I_t/I_s) tan

        def in_plane(angle: float) -> np.ndarray:
            """A direction at this angle from L, in the plane of L, ω and the symmetry axis."""
            return np.sin(angle) * scene.right + np.cos(angle) * Z

        symmetry, omega = in_plane(to_momentum), in_plane(to_momentum - tilt)
        space_cone = abs(to_momentum - tilt)
        cones = [(symmetry, tilt, BLUE), (Z, space_cone, GREEN)]
        for axis, half_angle, color in cones:
            across = unit(np.cross(axis, scene.toward_viewer))
            length = 2.0 * np.cos(half_angle)
            rim = scene.circle(
                length * axis,
                2.0 * np.sin(half_angle) * across,
                2.0 * np.sin(half_angle) * np.cross(axis, across),
            )
            scene.hull(np.vstack([rim, np.zeros(3)]), color, 0.18, color)
            scene.line(rim, color=color, linewidth=1.0)
        scene.arrow(np.zeros(3), 2.65 * Z, r"$\mathbf{L}$", INK, offset=(-10.0, 4.0))
        scene.arrow(np.zeros(3), 2.45 * omega, r"$\mathbf{\omega}$", RED, offset=(4.0, 11.0))
        scene.arrow(np.zeros(3), 2.75 * symmetry, "symmetry axis", BLUE, offset=(30.0, 9.0))
        scene.ax.texts[-1].set_fontsize(11)
        scene.label(np.zeros(3), "C", offset=(0.0, -11.0), size=12)
    return scene.figure


if __name__ == "__main__":
    save(draw(), __file__)
