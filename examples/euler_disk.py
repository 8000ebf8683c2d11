"""Euler's disk: as it sinks, its contact runs round faster and faster, and then it lies flat.

The table takes the energy: its pressure acts a little ahead of the contact, by an arm of 0.2 mm. Through each
inclination the disk passes nearly as if it wobbled steadily there, and so theory tells how it sinks.
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import Trajectory, loads, plot, rolling, solids

G = 9.81  # m/s²
RADIUS, ARM = 0.0375, 2e-4  # m
DISK, EDGE = solids.cylinder(RADIUS, 0.0, mass=0.4), rolling.disk(RADIUS)
START, END = np.deg2rad(20.0), 9.5


def steady(inclination: float) -> rolling.Steady:
    """Find the motion whose centre of mass rests: the contact runs round with Ω² = 4g/(a sin θ)."""
    turn = np.sqrt(4.0 * G / (RADIUS * np.sin(inclination)))
    return rolling.steady(DISK, EDGE, inclination=inclination, turn=turn, gravity=(0, 0, -G))[0]


def motion(end: float, n: int) -> Trajectory:
    """Simulate the disk from its steady wobble at 20° on."""
    start = steady(START)
    return DISK.simulate(
        np.linspace(0.0, end, n),
        omega=start.omega,
        attitude=start.quaternion,
        load=loads.uniform_gravity((0, 0, -G)),
        contact=rolling.plane(EDGE, resistance=rolling.resistance(arm=ARM)),
        rtol=1e-12,
    )


def time_to(inclination: np.ndarray) -> np.ndarray:
    """Compute when it has sunk so far: the energy 3/2 m g a sin θ is lost at the rate of the steady wobble.

    With the part ω cos θ of ω = √(4 g sin θ/a) along the table that is θ' = -4/3 (arm/a) √(g sin θ/a).
    """
    places, weights = np.polynomial.legendre.leggauss(40)
    low, high = np.sqrt(inclination)[..., np.newaxis], np.sqrt(START)
    root = (low + high) / 2 + (high - low) / 2 * places  # of θ: the integrand has no pole in it
    integrand = 2.0 * root / np.sqrt(np.sin(root**2))
    integral = np.sum(weights * integrand, axis=-1) * (high - low[..., 0]) / 2
    return 0.75 * RADIUS / ARM * np.sqrt(RADIUS / G) * integral


def draw() -> Figure:
    """Draw the disk and the trace of its contact at first, and how it sinks."""
    run = motion(0.3, 1201)
    tilt = START
    print(
        f"circle of {1000 * steady(tilt).radius:.3f} mm; a cos 20° is {1000 * RADIUS * np.cos(tilt):.3f} mm"
    )
    long = motion(END, 4001)
    assert run.contact is not None
    assert long.contact is not None
    inclination = np.arcsin(long.position[:, 2] / RADIUS)
    rate = np.sqrt(4.0 * G / (RADIUS * np.sin(inclination)))
    print(
        f"contact at {rate[0]:.0f} rad/s at 20°, {rate[-1]:.0f} rad/s at {np.rad2deg(inclination[-1]):.1f}°"
    )
    found = np.rad2deg(np.interp(8.0, long.t, inclination))
    angles = np.linspace(1e-9, START, 401)
    theory = np.rad2deg(np.interp(-8.0, -time_to(angles), angles))
    flat = time_to(angles[:1])[0]
    print(f"after 8 s at {found:.2f}°, by theory {theory:.2f}°; flat by theory after {flat:.2f} s")
    print(f"energy less the work of the table is kept to {long.invariants().energy_drift:.0e}")

    figure = Figure(figsize=(12.0, 4.0), layout="constrained")
    plot.rolling(run, figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False))
    plot.contact(run, figure.add_subplot(1, 3, 2))
    ax = figure.add_subplot(1, 3, 3)
    ax.plot(long.t, np.rad2deg(inclination), color="#0072B2", label="inclination (degrees)")
    ax.plot(time_to(angles), np.rad2deg(angles), color="0.3", linestyle=":", label="inclination, theory")
    ax.plot(long.t, rate / 10.0, color="#D55E00", linestyle="--", label="rate of the contact (10 rad/s)")
    ax.set(xlabel="time (s)", ylim=(0.0, None))
    ax.grid(color="0.9")
    ax.legend(frameon=False)
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    motion(END, 12001).animate(file, title="Euler's disk", duration=30)


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "euler_disk.png", dpi=130)
    animate("euler_disk.html")
