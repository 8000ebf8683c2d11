"""A tippe top: friction keeps Jellett's constant and takes energy, until the top stands on its head.

The curves are the energy that this constant leaves to each inclination. The picture shows the same top as it
rolls without slip and without loss: there it nods for ever and does not turn over.
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, Trajectory, loads, plot, rolling

G = 9.81  # m/s²
MASS, RADIUS, BELOW = 0.006, 0.015, 0.002  # kg, m, m: C is below the centre
MOMENT = 8e-7  # kg m², across the axis and along it
TOP = RigidBody.from_principal(MASS, (MOMENT, MOMENT, MOMENT), center_of_mass=(0, 0, -BELOW))
BALL = rolling.sphere(RADIUS)


def energy(inclination: np.ndarray, spin: float) -> np.ndarray:
    """Compute λ²/(2 d·I d) + m g h, with d from the contact to C, whose height is h."""
    height = RADIUS - BELOW * np.cos(inclination)
    square = RADIUS**2 - 2.0 * RADIUS * BELOW * np.cos(inclination) + BELOW**2
    jellett = MOMENT * spin * (RADIUS - BELOW)
    return jellett**2 / (2.0 * MOMENT * square) + MASS * G * height


def motion(end: float, n: int) -> Trajectory:
    """Simulate the top as it rolls, started a little off upright."""
    return TOP.simulate(
        np.linspace(0.0, end, n),
        omega=(4.0, 0.0, 60.0),
        attitude=(np.sin(0.2), 0.0, 0.0, np.cos(0.2)),
        load=loads.uniform_gravity((0, 0, -G)),
        contact=rolling.plane(BALL),
        rtol=1e-12,
    )


def draw() -> Figure:
    """Draw the top that rolls, the trace of its contact, and the energy over the inclination."""
    run = motion(1.0, 1201)
    kept = run.invariants()
    print(
        f"rolling keeps Jellett's constant to {kept.jellett_drift:.1e} and Routh's to {kept.routh_drift:.1e}"
    )

    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    plot.rolling(run, figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False))
    plot.contact(run, figure.add_subplot(1, 3, 2))
    ax = figure.add_subplot(1, 3, 3)
    inclination = np.linspace(0.0, np.pi, 361)
    for spin, color, dash in ((40.0, "#009E73", ":"), (90.0, "#D55E00", "--"), (200.0, "#0072B2", "-")):
        found = rolling.tippe_top(TOP, BALL, spin, gravity=(0, 0, -G))
        values = 1e6 * (energy(inclination, spin) - energy(np.zeros(1), spin))
        least = np.rad2deg(inclination[values.argmin()])
        end = np.rad2deg(np.arccos(found.cos_theta))
        print(f"{spin:g} rad/s: {found.verdict}, at {end:.0f}°; least energy at {least:.0f}°")
        ax.plot(np.rad2deg(inclination), values, color=color, linestyle=dash, label=f"{spin:g} rad/s")
    ax.set(xlabel="inclination (degrees)", ylabel="energy − energy upright (µJ)", ylim=(-300.0, 60.0))
    ax.grid(color="0.9")
    ax.legend(frameon=False)
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion(2.0, 1801).animate(file, title="A tippe top that rolls without loss", duration=30)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "tippe_top.png", dpi=130)
    animate("tippe_top.html")
