"""Flat spin, as of Explorer 1: friction inside moves the spin from the long axis to an axis across it."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, Trajectory, loads

ROCKET = RigidBody.from_principal(14.0, (0.6, 1.6, 1.8))


def run(count: int) -> Trajectory:
    """Spin it about its long axis, with a slug inside that turns in a viscous fluid."""
    inside = loads.slug(inertia=0.1, damping=0.12)
    return ROCKET.simulate(np.linspace(0.0, 140.0, count), (3.0, 0.1, 0.1), load=inside)


def draw() -> Figure:
    """Draw the angle of the long axis from L, and the energy."""
    motion = run(3001)
    momentum = motion.angular_momentum("body").spin
    size = np.linalg.norm(momentum, axis=1)
    angle = np.degrees(np.arccos(np.abs(momentum[:, 0]) / size))
    energy = motion.kinetic_energy().total
    print(
        f"long axis from L: {angle[0]:.1f}° to {angle[-1]:.1f}°, |L| changed by {np.ptp(size) / size[0]:.0e}"
    )
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(motion.t, angle, color="#0072B2", linewidth=0.8)
    left.set(xlabel="time (s)", ylabel="long axis from L (degrees)")
    right.plot(motion.t, energy, color="#D55E00")
    right.set(xlabel="time (s)", ylabel="kinetic energy (J)", ylim=(0, None))
    for ax in (left, right):
        ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    run(2801).animate(file, title="Flat spin", duration=45)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "flat_spin.png", dpi=130)
    animate("flat_spin.html")
