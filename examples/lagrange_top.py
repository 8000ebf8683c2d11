"""Lagrange's top, spun and then released: its axis falls, precesses, and stops for a moment at each cusp."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import HeavyTop, euler_angles, plot, solids

GRAVITY = (0.0, 0.0, -9.81)  # m/s²


def top() -> HeavyTop:
    """Give the cone on its point, tilted by thirty degrees."""
    # solids.cone has its apex upward, so it is turned over and put with the apex at O.
    cone = (
        solids.cone(radius=0.03, height=0.06, mass=0.1)
        .rotated((1.0, 0.0, 0.0, 0.0))
        .translated((0, 0, 0.045))
    )
    attitude = euler_angles.to_quaternion((0.0, np.deg2rad(30.0), 0.0))
    return cone.heavy_top((0.0, 0.0, 260.0), attitude, GRAVITY)


def draw() -> Figure:
    """Draw the effective potential, the path of the axis and the inclination in time."""
    motion = top()
    cone = motion.body
    low, high = np.rad2deg(motion.nutation_limits)
    print(f"{motion.mode}: nutates between {low:.4f}° and {high:.4f}° every {motion.nutation_period:.6f} s")
    fast = cone.mass * 9.81 * 0.045 / (cone.inertia[2, 2] * 260.0)
    print(f"mean precession {motion.mean_precession:.4f} rad/s; mgl/(I_s ω_s) of a fast top {fast:.4f} rad/s")

    t = np.linspace(0.0, 6 * motion.nutation_period, 1201)
    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    plot.effective_potential(motion, figure.add_subplot(1, 3, 1))
    plot.nutation(motion, t, figure.add_subplot(1, 3, 2, projection="3d", computed_zorder=False))
    ax = figure.add_subplot(1, 3, 3)
    ax.plot(t, np.rad2deg(motion.at(t).euler_angles()[:, 1]), color="#0072B2")
    ax.set(xlabel="time (s)", ylabel="inclination (degrees)")
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion = top()
    t = np.linspace(0.0, 3 * motion.nutation_period, 3001)
    motion.at(t).animate(file, title="Lagrange's top", duration=60)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "lagrange_top.png", dpi=130)
    animate("lagrange_top.html")
