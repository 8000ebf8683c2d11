"""Detumbling a small satellite: coils oppose each change of the magnetic field, and the tumbling dies out."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, loads, orbits

EARTH = 3.986004418e14  # m³/s²
CUBESAT = RigidBody.from_principal(4.0, (0.03, 0.035, 0.01))  # kg, kg m²


def draw() -> Figure:
    """Draw the rate of rotation over four revolutions."""
    orbit = orbits.from_elements(EARTH, eccentricity=0.02, periapsis=6.878e6, inclination=np.radians(97.4))
    coils = loads.magnetic(dipole=(0, 0, 0), field=orbit.dipole_field((0, 0, -7.8e15)), gain=3e4)
    t = np.linspace(0.0, 4 * orbit.period, 801)
    run = CUBESAT.simulate(t, (0.3, -0.2, 0.25), load=coils)
    rate = np.degrees(np.linalg.norm(run.omega, axis=1))
    print(f"{rate[0]:.1f}°/s at first, {rate[-1]:.3f}°/s after four revolutions")
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    ax = figure.add_subplot()
    ax.semilogy(t / orbit.period, rate, color="#0072B2")
    ax.axhline(2 * 360 / orbit.period, color="0.5", linestyle="--", linewidth=1)
    ax.annotate(
        "as fast as the field turns", (0.1, 2 * 360 / orbit.period), (0, 5), textcoords="offset points"
    )
    ax.set(xlabel="revolutions", ylabel="rotation (degrees/s)")
    ax.grid(color="0.9")
    return figure


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "detumbling.png", dpi=130)
