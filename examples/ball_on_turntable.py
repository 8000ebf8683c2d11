"""A ball on a turntable: it does not fly outward, but goes in circles with 2/7 of the rate of the table."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import Trajectory, loads, plot, rolling, solids

GRAVITY = (0.0, 0.0, -9.81)  # m/s²
RADIUS, TABLE = 0.02, 2.0  # m, rad/s
BALL = solids.sphere(RADIUS, mass=0.03)


def motion(tilt: float, end: float, n: int) -> Trajectory:
    """Simulate the ball on a table that leans by this angle."""
    normal = (np.sin(tilt), 0.0, np.cos(tilt))
    return BALL.simulate(
        np.linspace(0.0, end, n),
        omega=(0.0, 3.0, 0.0),
        load=loads.uniform_gravity(GRAVITY),
        contact=rolling.plane(rolling.sphere(RADIUS), normal=normal, turntable=TABLE),
        rtol=1e-12,
    )


def draw() -> Figure:
    """Draw the ball on a level table, the circle of its contact, and the drift on a table that leans."""
    period = 2.0 * np.pi / (2.0 / 7.0 * TABLE)
    level = motion(0.0, period, 1601)
    assert level.contact is not None
    off = np.linalg.norm(level.contact.point[-1] - level.contact.point[0])
    print(f"one circle takes {period:.4f} s; after it the ball is off by {off:.1e} m")
    exact = BALL.rolling_motion(rolling.sphere(RADIUS), (0.0, 3.0, 0.0), turntable=TABLE)
    off = np.abs(exact.at(level.t).position - level.position).max()
    print(f"the closed form and the simulation differ by {off:.0e} m")
    leaning = motion(np.deg2rad(0.2), 4.0 * period, 4001)

    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    first = figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False)
    plot.rolling(level, first, index=1000)
    for k, (run, title) in enumerate(((level, "level"), (leaning, "leaning by 0.2°"))):
        ax = figure.add_subplot(1, 3, 2 + k)
        plot.contact(run, ax)
        ax.text(0.5, 0.04, title, transform=ax.transAxes, ha="center")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion(0.0, 11.0, 1801).animate(file, title="A ball on a turntable")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "ball_on_turntable.png", dpi=130)
    animate("ball_on_turntable.html")
