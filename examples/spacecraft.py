"""A spacecraft of several parts. While propellant is used, its centre of mass moves and its axes turn.

The moving picture shows its two solar panels. The one toward +y is longer by a metre.
"""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, rods, solids


def spacecraft(propellant: float) -> RigidBody:
    """Give bus, two solar panels, antenna, boom of a magnetometer, and propellant of this mass."""
    bus = solids.box((1.2, 1.2, 1.8), mass=420.0)
    panels = [solids.box((0.9, 3.0, 0.02), mass=24.0).translated((0.0, y, 0.2)) for y in (2.3, -2.3)]
    extra = solids.box((0.9, 1.0, 0.02), mass=8.0).translated((0.0, 4.3, 0.2))
    antenna = solids.hemisphere(radius=0.6, mass=15.0).translated((0.0, 0.0, 1.2))
    boom = (
        rods.rod(length=4.0, mass=6.0)
        .rotated((0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)))
        .translated((2.6, 0.0, -0.7))
    )
    parts = [bus, *panels, extra, antenna, boom]
    if propellant > 0.0:
        parts.append(solids.sphere(radius=0.45, mass=propellant).translated((0.25, 0.1, -0.4)))
    return sum(parts)


def draw() -> Figure:
    """Draw moments, centre of mass and the tilt of the axis of greatest moment while the tank empties."""
    masses = np.linspace(180.0, 0.0, 91)
    craft = RigidBody.stack([spacecraft(mass) for mass in masses])
    empty = craft[-1]
    print(f"empty: {empty.mass:.1f} kg, centre of mass {empty.center_of_mass.round(4)} m")
    print(f"principal moments {empty.principal_moments.round(2)} kg m², {empty.principal.top} top")
    tilt = np.rad2deg(np.arccos(np.clip(np.abs(craft.principal.axes[:, 2, 2]), 0.0, 1.0)))

    figure = Figure(figsize=(11.0, 3.8), layout="constrained")
    panels = figure.subplots(1, 3)
    for k, (color, dash) in enumerate(zip(("#0072B2", "#D55E00", "#009E73"), ("--", "-", "-."), strict=True)):
        panels[0].plot(
            masses, craft.principal_moments[:, k], color=color, linestyle=dash, label=f"$I_{k + 1}$"
        )
        panels[1].plot(masses, 1e3 * craft.center_of_mass[:, k], color=color, linestyle=dash, label="xyz"[k])
    panels[2].plot(masses, tilt, color="#B0479A")
    names = ("principal moments (kg m²)", "centre of mass (mm)", "axis 3 from z (degrees)")
    for ax, name in zip(panels, names, strict=True):
        ax.set(xlabel="propellant (kg)", ylabel=name)
        ax.invert_xaxis()
        ax.grid(color="0.9")
    for ax in panels[:2]:
        ax.legend(frameon=False)
    return figure


def animate(file: str) -> None:
    """Write the moving page of the empty spacecraft, spun about the axis of its intermediate moment."""
    craft = spacecraft(0.0)
    spin = craft.principal.axes @ (0.001, 0.1, 0.0)  # rad/s
    craft.simulate([0.0, 600.0], spin).animate(file, title="The spacecraft, its tank empty")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "spacecraft.png", dpi=130)
    animate("spacecraft.html")
