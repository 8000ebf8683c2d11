"""Feynman's plate: thrown with a small wobble, it wobbles twice for each turn."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import plot, solids

PLATE = solids.cylinder(radius=0.12, height=0.002, mass=0.3)
SPIN = np.array([1.2, 0.0, 12.0])  # rad/s, six degrees off the axis


def draw() -> Figure:
    """Draw the two cones, and the angular velocity in the plate."""
    motion = PLATE.free_motion(SPIN)
    momentum = np.linalg.norm(PLATE.inertia @ SPIN)
    wobble = momentum / PLATE.inertia[0, 0]  # of the axis about L
    print(f"the axis goes round {wobble / SPIN[2]:.4f} times while the plate turns once")
    t = np.linspace(0.0, 2.0, 401)
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    plot.cones(motion, t, figure.add_subplot(1, 2, 1, projection="3d", computed_zorder=False))
    plot.angular_velocity(motion.at(t), figure.add_subplot(1, 2, 2))
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    PLATE.simulate(np.linspace(0.0, 3.0, 601), SPIN).animate(file, title="Feynman's plate")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "wobbling_plate.png", dpi=130)
    animate("wobbling_plate.html")
