"""A coin that rolls: it goes round a circle, and its rim and the table both show where they touched."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import Trajectory, loads, plot, rolling, solids

GRAVITY = (0.0, 0.0, -9.81)  # m/s²
RADIUS = 0.012  # m
COIN, EDGE = solids.cylinder(RADIUS, 0.0, mass=0.006), rolling.disk(RADIUS)


def motion(end: float, n: int) -> Trajectory:
    """Simulate a coin that leans more than the circle of its rate asks for, so that it nods."""
    (circle,) = rolling.steady(COIN, EDGE, inclination=1.2, turn=9.0, gravity=GRAVITY)
    return COIN.simulate(
        np.linspace(0.0, end, n),
        omega=np.add(circle.omega, (1.5, 0.0, 0.0)),
        attitude=circle.quaternion,
        load=loads.uniform_gravity(GRAVITY),
        contact=rolling.plane(EDGE),
        rtol=1e-12,
    )


def draw() -> Figure:
    """Draw the coin on its table, the trace of the contact, and how much friction rolling needs."""
    (circle,) = rolling.steady(COIN, EDGE, inclination=1.2, turn=9.0, gravity=GRAVITY)
    print(
        f"steady circle of {1000 * circle.radius:.1f} mm, rim at {RADIUS * abs(circle.spin):.3f} m/s, "
        f"friction {circle.friction_needed:.3f}"
    )
    print(f"straight on it rolls stably from {rolling.critical_rate(COIN, EDGE):.2f} rad/s on")
    run = motion(1.5, 1501)
    assert run.contact is not None
    most = run.contact.largest_friction_needed
    print(f"nodding it needs a coefficient of friction of {most.value:.3f}, at {most.t:.3f} s")

    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    plot.rolling(run, figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False), index=700)
    plot.contact(run, figure.add_subplot(1, 3, 2))
    ax = figure.add_subplot(1, 3, 3)
    ax.plot(run.t, run.contact.friction_needed, color="#0072B2")
    ax.axhline(circle.friction_needed, color="0.4", linestyle="--")
    ax.set(xlabel="time (s)", ylabel="friction needed", ylim=(0.0, None))
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion(1.5, 1501).animate(file, title="A coin that rolls", duration=30)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "coin.png", dpi=130)
    animate("coin.html")
