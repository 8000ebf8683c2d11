"""The tumbling asteroid Toutatis: from its two periods to its exact motion, at any time."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, plot

# Ostro et al. 1999 (Icarus 137, 122): periods of rotation about the long axis and of its precession about L,
# and ratios of the moments to the one about the long axis, fitted to the rotation.
ROTATION, PRECESSION = 5.41, 7.35  # days
MOMENTS = (1.0, 3.09, 3.22)


def draw() -> Figure:
    """Draw the Euler angles over a month, Poinsot's construction and the two cones."""
    toutatis = RigidBody.from_principal(1.0, MOMENTS)
    motion = toutatis.free_motion_from_periods(ROTATION, PRECESSION, mode="long-axis")
    periods = motion.periods
    print(f"{motion.mode}: rotation {periods.rotation:.4f} d, precession {periods.precession:.4f} d")
    later = motion.at([0.0, 365.25 * 1e6])
    change = later.kinetic_energy().total[1] / later.kinetic_energy().total[0] - 1
    print(f"energy after a million years: relative change {abs(change):.0e}")

    t = np.linspace(0.0, 30.0, 1501)
    figure = Figure(figsize=(12.0, 4.2), layout="constrained")
    left, middle, right = (
        figure.add_subplot(1, 3, 1),
        figure.add_subplot(1, 3, 2, projection="3d", computed_zorder=False),
        figure.add_subplot(1, 3, 3, projection="3d", computed_zorder=False),
    )
    plot.euler_angles(motion.at(t), left, time_label="d")
    plot.poinsot(motion, t, middle, rate_label="rad/d")
    plot.cones(motion, t, right)
    return figure


def animate(file: str) -> None:
    """Write the moving page of 37 days, about five periods of precession."""
    toutatis = RigidBody.from_principal(1.0, MOMENTS)
    motion = toutatis.free_motion_from_periods(ROTATION, PRECESSION, mode="long-axis")
    motion.at(np.linspace(0.0, 37.0, 601)).animate(file, title="Toutatis", time_label="d", duration=30)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "asteroid.png", dpi=130)
    animate("asteroid.html")
