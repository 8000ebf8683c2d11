"""A wheel makes the spin about the intermediate axis stable, if its momentum is large enough.

The momentum has to be larger than (I3 - I2) ω, along the spin ω. Without a wheel the spin is unstable.
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, animation, plot, wheel

SATELLITE = RigidBody.from_principal(150.0, (20.0, 25.0, 30.0))
SPIN = (0.002, 0.1, 0.002)  # rad/s, nearly about the middle axis: (I3 - I2) ω = 0.5 N m s


def draw() -> Figure:
    """Draw the angular velocity without the wheel and with it, and the paths of L with it."""
    figure = Figure(figsize=(12.0, 3.8), layout="constrained")
    t = np.linspace(0.0, 600.0, 1201)
    for k, momentum in enumerate((0.0, 1.0), 1):
        motion = SATELLITE.gyrostat((0.0, momentum, 0.0)).free_motion(SPIN)
        states = motion.at(t)
        print(f"h = {momentum:g} N m s: off the axis by up to {off(states.omega):.1f}°")
        ax = plot.angular_velocity(states, figure.add_subplot(1, 3, k))
        ax.set_title(f"wheel with {momentum:g} N m s", pad=22)
    sphere = figure.add_subplot(1, 3, 3, projection="3d", computed_zorder=False)
    sphere.view_init(elev=20.0, azim=50.0)
    plot.portrait(motion, ax=sphere)
    return figure


def off(omega: np.ndarray) -> float:
    """Give the greatest angle of ω from the middle axis, in degrees."""
    return float(np.degrees(np.arccos(omega[:, 1] / np.linalg.norm(omega, axis=1))).max())


def animate(file: str) -> None:
    """Write the moving page."""
    inside = wheel(axis=(0, 1, 0), inertia=0.01, momentum=1.0, mode="held")  # at 955 turns a minute
    motion = SATELLITE.gyrostat(wheels=[inside]).free_motion((0.05, 0.1, 0.03))
    animation.animate(motion, file, end=300.0, title="A satellite with a wheel")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "dual_spin.png", dpi=130)
    animate("dual_spin.html")
