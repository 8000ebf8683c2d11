"""Euler's disk: the flatter a disk wobbles, the faster its contact runs round and the more friction it needs.

A real disk sinks from one of these motions to the next as it loses energy. Here it rolls without any loss, so
that each motion keeps its inclination.
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import Trajectory, loads, plot, rolling, solids

G = 9.81  # m/s²
RADIUS = 0.0375  # m
DISK, EDGE = solids.cylinder(RADIUS, 0.0, mass=0.4), rolling.disk(RADIUS)


def steady(inclination: float) -> rolling.Steady:
    """Find the motion whose centre of mass rests: the contact runs round with Ω² = 4g/(a sin θ)."""
    turn = np.sqrt(4.0 * G / (RADIUS * np.sin(inclination)))
    return rolling.steady(DISK, EDGE, inclination=inclination, turn=turn, gravity=(0, 0, -G))[0]


def motion(degrees: float, end: float, n: int) -> Trajectory:
    """Simulate a disk that wobbles at about this inclination."""
    start = steady(np.deg2rad(degrees))
    return DISK.simulate(
        np.linspace(0.0, end, n),
        omega=np.add(start.omega, (1.0, 0.0, 0.0)),
        attitude=start.quaternion,
        load=loads.uniform_gravity((0, 0, -G)),
        contact=rolling.plane(EDGE),
        rtol=1e-12,
    )


def draw() -> Figure:
    """Draw the disk on its table, the trace of the contact, and rate and friction over the inclination."""
    run = motion(20.0, 0.3, 1201)
    assert run.contact is not None
    print(f"at about 20° it needs a friction of {run.contact.largest_friction_needed.value:.3f}")
    tilt = np.deg2rad(20.0)
    print(
        f"circle of {1000 * steady(tilt).radius:.3f} mm; a cos 20° is {1000 * RADIUS * np.cos(tilt):.3f} mm"
    )
    angles = np.linspace(2.0, 60.0, 59)
    found = [steady(angle) for angle in np.deg2rad(angles)]
    print(f"contact at {found[0].turn:.0f} rad/s at 2°, {found[-1].turn:.0f} rad/s at 60°")
    print(f"the disk itself turns by {found[0].turn * (1 - np.cos(np.deg2rad(2.0))):.3f} rad/s at 2°")

    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    plot.rolling(run, figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False))
    plot.contact(run, figure.add_subplot(1, 3, 2))
    ax = figure.add_subplot(1, 3, 3)
    ax.plot(angles, [one.turn for one in found], color="#0072B2")
    ax.set(xlabel="inclination (degrees)", ylabel="rate of the contact (rad/s)", ylim=(0.0, None))
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion(20.0, 0.6, 1801).animate(file, title="Euler's disk, without any loss", duration=30)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "euler_disk.png", dpi=130)
    animate("euler_disk.html")
