"""The T-handle of the space station: it flips, stays, and flips again."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, plot, solids


def t_handle() -> RigidBody:
    """Steel, in metres: a bar with a stem below its middle."""
    bar = solids.box((0.100, 0.016, 0.016), density=7850).translated((0, 0, 0.008))
    return bar + solids.box((0.016, 0.016, 0.050), density=7850).translated((0, 0, -0.025))


SPIN = (0.01, 0.0, 6.28)  # rad/s, about the stem


def draw() -> Figure:
    """Draw the angular velocity in the body, and what stays: energy and angular momentum."""
    handle = t_handle()
    motion = handle.free_motion(SPIN)
    print(f"{motion.mode}; a flip every {motion.periods.flip:.4f} s")
    run = motion.at(np.linspace(0.0, 3 * motion.periods.flip, 901))
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    plot.angular_velocity(run, figure.add_subplot(1, 2, 1))
    plot.angular_momentum(run, figure.add_subplot(1, 2, 2), frame="body")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    t_handle().simulate(np.linspace(0.0, 20.0, 801), SPIN).animate(file, title="T-handle")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "t_handle.png", dpi=130)
    animate("t_handle.html")
