"""A sleeping top: it stands upright while it is fast, and begins to nod below a limit of its spin."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import HeavyTop, euler_angles, solids

CONE = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0)).translated((0, 0, 0.045))
GRAVITY = (0.0, 0.0, -9.81)  # m/s²


def top(rate: float) -> HeavyTop:
    """Give the top spun at this rate, half a degree off the vertical."""
    attitude = euler_angles.to_quaternion((0.0, np.radians(0.5), 0.0))
    return CONE.heavy_top((0.0, 0.0, rate), attitude, GRAVITY)


def limit() -> float:
    """Give the least spin of a top that sleeps."""
    I_1, I_s = CONE.inertia_about("origin")[0, 0], CONE.inertia[2, 2]
    return float(2.0 * np.sqrt(CONE.mass * 9.81 * CONE.center_of_mass[2] * I_1) / I_s)


def draw() -> Figure:
    """Draw the inclination of a top that sleeps and of one that does not."""
    print(f"limit {limit():.2f} rad/s")
    t = np.linspace(0.0, 1.0, 2001)
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    ax = figure.add_subplot()
    for factor, color in ((1.2, "#0072B2"), (0.9, "#D55E00")):
        inclination = np.degrees(top(factor * limit()).at(t).euler_angles()[:, 1])
        print(f"{factor} of it: up to {inclination.max():.1f}°")
        ax.plot(t, inclination, color=color, label=f"{factor} of the limit")
    ax.set(xlabel="time (s)", ylabel="inclination (degrees)")
    ax.legend(frameon=False)
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page of the top that does not sleep."""
    motion = top(0.9 * limit())
    motion.at([0.0, 1.0]).animate(file, title="A top that does not sleep")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "sleeping_top.png", dpi=130)
    animate("sleeping_top.html")
