"""A tippe top: friction keeps Jellett's constant and takes energy, until the top stands on its head.

The picture shows a top that slips on its table with friction, as it turns over. The curves on the right are
the energy that Jellett's constant leaves to each inclination: friction leads the top downhill.
"""

import sys
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, Trajectory, loads, plot, rolling

G = 9.81  # m/s²
MASS, RADIUS, BELOW = 0.006, 0.015, 0.002  # kg, m, m: C is below the centre
MOMENT = 8e-7  # kg m², across the axis and along it
TOP = RigidBody.from_principal(MASS, (MOMENT, MOMENT, MOMENT), center_of_mass=(0, 0, -BELOW))
BALL = rolling.sphere(RADIUS)
SPIN, TILT = 120.0, 0.25  # rad/s, rad
FRICTION = 1.2  # s/m: the force is 1.2 N v, with the normal force N and the slip v


def energy(inclination: np.ndarray, spin: float) -> np.ndarray:
    """Compute λ²/(2 d·I d) + m g h, with d from the contact to C, whose height is h."""
    height = RADIUS - BELOW * np.cos(inclination)
    square = RADIUS**2 - 2.0 * RADIUS * BELOW * np.cos(inclination) + BELOW**2
    jellett = MOMENT * spin * (RADIUS - BELOW)
    return jellett**2 / (2.0 * MOMENT * square) + MASS * G * height


def simulate(t: Any, **start: Any) -> Trajectory:
    """Simulate the top as it slips."""
    contact = rolling.plane(BALL, law="sliding", viscous=("normal", FRICTION))
    return TOP.simulate(t, **start, load=loads.uniform_gravity((0, 0, -G)), contact=contact, rtol=1e-12)


def motion(end: float, n: int) -> Trajectory:
    """Simulate the top from a start a little off upright."""
    attitude = (np.sin(TILT / 2), 0.0, 0.0, np.cos(TILT / 2))
    return simulate(np.linspace(0.0, end, n), omega=(0.0, 0.0, SPIN), attitude=attitude)


def inclinations(run: Trajectory) -> np.ndarray:
    """Compute the angle between the axis of the top and the vertical."""
    x, y = run.quaternion[:, 0], run.quaternion[:, 1]
    return np.arccos(1.0 - 2.0 * (x * x + y * y))


def draw() -> Figure:
    """Draw the top as it turns over, its inclination over time, and the energy over the inclination."""
    run = motion(5.0, 3001)
    kept, angles = run.invariants(), np.rad2deg(inclinations(run))
    print(f"Jellett's constant is kept to {kept.jellett_drift:.0e}")
    print(f"energy less the work of friction is kept to {kept.energy_drift:.0e}")
    print(f"at {SPIN:g} rad/s from {angles[0]:.0f}° to {angles[-1]:.0f}° in {run.t[-1]:g} s")

    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    state = run.state(np.flatnonzero(angles > 60.0)[0])
    over = simulate(np.linspace(0.0, 0.1, 601), **state._asdict())
    plot.rolling(over, figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False))
    ax = figure.add_subplot(1, 3, 2)
    ax.plot(run.t, angles, color="#0072B2")
    ax.set(xlabel="time (s)", ylabel="inclination (degrees)", ylim=(0.0, 180.0), yticks=range(0, 181, 30))
    ax.grid(color="0.9")
    ax = figure.add_subplot(1, 3, 3)
    inclination = np.linspace(0.0, np.pi, 361)
    for spin, color, dash in ((40.0, "#009E73", ":"), (80.0, "#D55E00", "--"), (SPIN, "#0072B2", "-")):
        found = rolling.tippe_top(TOP, BALL, spin, gravity=(0, 0, -G))
        values = 1e6 * (energy(inclination, spin) - energy(np.zeros(1), spin))
        least = np.rad2deg(inclination[values.argmin()])
        end = np.rad2deg(np.arccos(found.cos_theta))
        print(f"{spin:g} rad/s: {found.verdict}, at {end:.0f}°; least energy at {least:.0f}°")
        ax.plot(np.rad2deg(inclination), values, color=color, linestyle=dash, label=f"{spin:g} rad/s")
    ax.set(xlabel="inclination (degrees)", ylabel="energy − energy upright (µJ)", xticks=range(0, 181, 30))
    ax.grid(color="0.9")
    ax.legend(frameon=False)
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion(5.0, 12001).animate(file, title="A tippe top turns over", duration=50)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "tippe_top.png", dpi=130)
    animate("tippe_top.html")
