"""A slew by a reaction wheel: the wheel turns one way, the satellite the other, and both stop."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, Trajectory, loads

SATELLITE = RigidBody.from_principal(150.0, (20.0, 25.0, 30.0))  # kg, kg m²


def run(count: int) -> Trajectory:
    """Push for thirty seconds, and brake for as long."""
    wheel = loads.wheel(axis=(0, 0, 1), inertia=0.05, torque=[0.1, -0.1, 0.0], times=[0.0, 30.0, 60.0])
    return SATELLITE.simulate(np.linspace(0.0, 75.0, count), (0, 0, 0), load=wheel)


def draw() -> Figure:
    """Draw the angle of the satellite and the momentum of the wheel."""
    motion = run(301)
    angle = np.degrees(np.unwrap(2 * np.arctan2(motion.quaternion[:, 2], motion.quaternion[:, 3])))
    by_hand = -np.degrees(0.1 * 30.0**2 / (30.0 - 0.05))
    print(f"turned by {angle[-1]:.4f}°, by hand {by_hand:.4f}°")
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(motion.t, angle, color="#0072B2")
    left.set(xlabel="time (s)", ylabel="angle of the satellite (degrees)")
    right.plot(motion.t, motion.states["wheel"][:, 0], color="#D55E00")
    right.set(xlabel="time (s)", ylabel="momentum of the wheel (N m s)")
    for ax in (left, right):
        ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    run(301).animate(file, title="A slew by a reaction wheel")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "slew.png", dpi=130)
    animate("slew.html")
