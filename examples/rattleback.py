"""A rattleback: spun in one sense it begins to rattle, stops, and turns back."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, Trajectory, loads, plot, rolling

GRAVITY = (0.0, 0.0, -9.81)  # m/s²
# Its principal axes lean by 2 degrees against the axes of its surface.
TENSOR = ((2e-4, 5e-5, 0.0), (5e-5, 1.6e-3, 0.0), (0.0, 0.0, 1.7e-3))  # kg m²
STONE = RigidBody(1.0, inertia=TENSOR, center_of_mass=(0.0, 0.0, -0.002))
BOTTOM = rolling.ellipsoid((0.2, 0.03, 0.02))


def motion(end: float, n: int) -> Trajectory:
    """Simulate the stone, spun against its preferred sense."""
    sense = rolling.preferred_sense(STONE, BOTTOM, GRAVITY, rate=5.0).sense
    return STONE.simulate(
        np.linspace(0.0, end, n),
        omega=(0.2, 0.02, -3.0 * sense),
        load=loads.uniform_gravity(GRAVITY),
        contact=rolling.plane(BOTTOM),
        rtol=1e-12,
    )


def draw() -> Figure:
    """Draw the stone, the trace of its contact, and its rate, which changes its sign."""
    for rate in (5.0, -5.0):
        growth = rolling.preferred_sense(STONE, BOTTOM, GRAVITY, rate=rate).growth_rates
        print(f"{rate:+g} rad/s: the modes grow with {growth[0]:+.4f} and {growth[1]:+.4f} per second")
    run = motion(6.0, 3001)
    signs = np.sign(run.omega[:, 2])
    print(f"the sense of its spin changes {np.count_nonzero(np.diff(signs))} times in 6 s")
    print(f"energy kept to {run.invariants().energy_drift:.0e}")

    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    wide = int(np.argmax(np.linalg.norm(run.omega[:, :2], axis=1)))
    ax = figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False)
    ax.view_init(elev=12.0, azim=-50.0)
    plot.rolling(run, ax, index=wide)
    plot.contact(run, figure.add_subplot(1, 3, 2))
    ax = figure.add_subplot(1, 3, 3)
    ax.plot(run.t, run.omega[:, 2], color="#0072B2")
    ax.axhline(0.0, color="0.4", linewidth=0.8)
    ax.set(xlabel="time (s)", ylabel="rate about the vertical of the stone (rad/s)")
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion(8.0, 3001).animate(file, title="A rattleback")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "rattleback.png", dpi=130)
    animate("rattleback.html")
