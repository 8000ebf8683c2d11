"""A loaded die: a little lead in one corner moves the centre of mass and turns the principal axes."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, solids

SIDE = 16.0  # mm
PLASTIC, LEAD = 5.0 / SIDE**3, 0.01134  # g/mm³; the die has 5 g


def die(lead: float) -> RigidBody:
    """Give a die with a ball of so many grams of lead near a corner, in place of as much plastic."""
    plain = solids.cube(SIDE, density=PLASTIC)
    radius = (3.0 * lead / (4.0 * np.pi * LEAD)) ** (1.0 / 3.0)  # 2.76 mm for one gram: it fits
    more = solids.sphere(radius=radius, density=LEAD - PLASTIC).translated((5.0, 4.5, 3.5)) if lead else None
    return plain if more is None else plain + more


def draw() -> Figure:
    """Draw the centre of mass and the principal moments against the mass of the lead."""
    grams = np.linspace(0.0, 1.0, 41)
    loaded = RigidBody.stack([die(lead) for lead in grams])
    last = loaded[-1]
    print(f"one gram: centre of mass {last.center_of_mass.round(3)} mm, {last.principal.top} top")
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    colors = ("#0072B2", "#D55E00", "#009E73")
    widths = (1.5, 4.0, 1.5)  # I₂ and I₃ are equal
    for k, (color, width) in enumerate(zip(colors, widths, strict=True)):
        left.plot(grams, loaded.center_of_mass[:, k], color=color, label="xyz"[k])
        moment = loaded.principal_moments[:, k]
        right.plot(grams, moment, color=color, linewidth=width, label=f"$I_{k + 1}$")
    left.set(xlabel="lead (g)", ylabel="centre of mass (mm)")
    right.set(xlabel="lead (g)", ylabel="principal moments (g mm²)")
    for ax in (left, right):
        ax.legend(frameon=False)
        ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page of a throw of the die with one gram of lead."""
    die(1.0).simulate([0.0, 4.0], (4.0, 9.0, 2.0)).animate(file, title="A loaded die")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "loaded_die.png", dpi=130)
    animate("loaded_die.html")
