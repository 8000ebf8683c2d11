"""A satellite that hangs in the gradient of gravity: it swings about the vertical with a known period."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, euler_angles, loads

MU, RADIUS = 3.986004418e14, 7.0e6  # m³/s², m
RADIAL, ALONG, NORMAL = (
    60.0,
    200.0,
    220.0,
)  # kg m²: moments about the vertical, the path and the orbit's normal


def draw() -> Figure:
    """Draw the angle from the vertical over four orbits, of a small and of a large swing."""
    rate = np.sqrt(MU / RADIUS**3)
    orbit = 2 * np.pi / rate
    satellite = RigidBody(400.0, np.diag([RADIAL, ALONG, NORMAL]))
    load = loads.gravity_gradient(MU, (RADIUS, 0.0, 0.0), (0.0, np.sqrt(MU / RADIUS), 0.0))
    t = np.linspace(0.0, 4 * orbit, 2001)
    small = orbit / np.sqrt(3 * (ALONG - RADIAL) / NORMAL)
    print(f"orbit {orbit:.1f} s; small swings by theory: {small:.1f} s")

    figure = Figure(figsize=(8.0, 4.2), layout="constrained")
    ax = figure.add_subplot()
    for start, color, dash in ((2.0, "#0072B2", "-"), (60.0, "#D55E00", "--")):
        attitude = euler_angles.to_quaternion((np.deg2rad(start), 0.0, 0.0))
        motion = satellite.simulate(t, (0.0, 0.0, rate), attitude, load=load, method="dop853", rtol=1e-11)
        axis = motion.rotation.apply((1.0, 0.0, 0.0))
        pitch = np.arctan2(axis[:, 1], axis[:, 0]) - rate * t
        pitch = np.rad2deg((pitch + np.pi) % (2 * np.pi) - np.pi)
        falling = np.flatnonzero((pitch[:-1] > 0) & (pitch[1:] <= 0))
        crossings = t[falling] + np.diff(t)[falling] * pitch[falling] / (pitch[falling] - pitch[falling + 1])
        print(f"from {start:.0f}°: {np.diff(crossings).mean():.1f} s")
        ax.plot(t / orbit, pitch, color=color, linestyle=dash, label=f"let go at {start:.0f}°")
    ax.set(xlabel="orbits", ylabel="from the vertical (degrees)")
    ax.grid(color="0.9")
    ax.legend(loc="lower center", ncols=2, bbox_to_anchor=(0.5, 1.0), frameon=False)
    return figure


def animate(file: str) -> None:
    """Write the moving page of the large swing, over two orbits."""
    rate = np.sqrt(MU / RADIUS**3)
    t = np.linspace(0.0, 4 * np.pi / rate, 1001)
    satellite = RigidBody(400.0, np.diag([RADIAL, ALONG, NORMAL]))
    load = loads.gravity_gradient(MU, (RADIUS, 0.0, 0.0), (0.0, np.sqrt(MU / RADIUS), 0.0))
    start = euler_angles.to_quaternion((np.deg2rad(60.0), 0.0, 0.0))
    satellite.simulate(t, (0.0, 0.0, rate), start, load=load).animate(file, title="A large swing")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "gravity_gradient.png", dpi=130)
    animate("gravity_gradient.html")
