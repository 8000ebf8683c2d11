"""Detumbling a small satellite: coils oppose each change of the magnetic field, and the tumbling dies out."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, Trajectory, loads, orbits

EARTH = 3.986004418e14  # m³/s²
CUBESAT = RigidBody.from_principal(4.0, (0.03, 0.035, 0.01))  # kg, kg m²


ORBIT = orbits.from_elements(EARTH, eccentricity=0.02, periapsis=6.878e6, inclination=np.radians(97.4))


def simulated(t: np.ndarray) -> Trajectory:
    """Let the coils brake a satellite that tumbles."""
    coils = loads.magnetic(dipole=(0, 0, 0), field=ORBIT.dipole_field((0, 0, -7.8e15)), gain=3e4)
    return CUBESAT.simulate(t, (0.3, -0.2, 0.25), load=coils)


def draw() -> Figure:
    """Draw the rate of rotation over four revolutions."""
    t = np.linspace(0.0, 4 * ORBIT.period, 801)
    run = simulated(t)
    rate = np.degrees(np.linalg.norm(run.omega, axis=1))
    print(f"{rate[0]:.1f}°/s at first, {rate[-1]:.3f}°/s after four revolutions")
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    ax = figure.add_subplot()
    ax.semilogy(t / ORBIT.period, rate, color="#0072B2")
    ax.axhline(2 * 360 / ORBIT.period, color="0.5", linestyle="--", linewidth=1)
    ax.annotate(
        "as fast as the field turns", (0.1, 2 * 360 / ORBIT.period), (0, 5), textcoords="offset points"
    )
    ax.set(xlabel="revolutions", ylabel="rotation (degrees/s)")
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page of the first quarter of an hour."""
    simulated(np.linspace(0.0, 900.0, 1801)).animate(file, title="The first quarter of an hour")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "detumbling.png", dpi=130)
    animate("detumbling.html")
