"""A gyroscope held at one end: the faster it spins, the slower it precesses."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import euler_angles, plot, rods, solids

WHEEL = solids.cylinder(radius=0.05, height=0.01, mass=0.2).translated((0.0, 0.0, 0.06))
GYROSCOPE = WHEEL + rods.rod(length=0.08, mass=0.02).translated((0.0, 0.0, 0.04))
GRAVITY = (0.0, 0.0, -9.81)  # m/s²
LEVEL = euler_angles.to_quaternion((0.0, np.radians(80.0), 0.0))


def draw() -> Figure:
    """Draw the precession against the spin, and the path of the axis of one."""
    lever = GYROSCOPE.mass * 9.81 * GYROSCOPE.center_of_mass[2]
    rates = np.linspace(150.0, 600.0, 31)
    slow = np.array([GYROSCOPE.heavy_top((0, 0, w), LEVEL, GRAVITY).mean_precession for w in rates])
    by_hand = lever / (GYROSCOPE.inertia[2, 2] * rates)
    print(f"at 600 rad/s: {slow[-1]:.4f} rad/s, m g l/(I ω) = {by_hand[-1]:.4f} rad/s")

    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    ax = figure.add_subplot(1, 2, 1)
    ax.plot(rates, slow, color="#0072B2", label="exact")
    ax.plot(rates, by_hand, color="#D55E00", linestyle="--", label=r"$mg\ell/(I\omega)$")
    ax.set(xlabel="spin (rad/s)", ylabel="mean precession (rad/s)")
    ax.legend(frameon=False)
    ax.grid(color="0.9")
    top = GYROSCOPE.heavy_top((0.0, 0.0, 200.0), LEVEL, GRAVITY)
    t = np.linspace(0.0, 8 * top.nutation_period, 801)
    plot.nutation(top, t, figure.add_subplot(1, 2, 2, projection="3d", computed_zorder=False))
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    top = GYROSCOPE.heavy_top((0.0, 0.0, 200.0), LEVEL, GRAVITY)
    top.at(np.linspace(0.0, 0.6, 1201)).animate(file, title="A gyroscope held at one end", duration=30)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "gyroscope.png", dpi=130)
    animate("gyroscope.html")
