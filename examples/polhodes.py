"""Polhodes: the curves that the angular velocity of a body draws on its ellipsoid of inertia."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, plot, solids

BRICK = solids.box((3.0, 2.0, 1.0), mass=6.0)


def draw() -> Figure:
    """Draw the curves for a brick, and for one that is nearly a rod."""
    rod = RigidBody.from_principal(1.0, (0.2, 1.0, 1.05))
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    for k, (name, body) in enumerate({"brick": BRICK, "nearly a rod": rod}.items(), 1):
        ax = figure.add_subplot(1, 2, k, projection="3d", computed_zorder=False)
        plot.polhodes(body, ax)
        ax.set_title(name)
        print(f"{name}: {body.principal_moments.round(4)}, kappa {body.principal.kappa:+.3f}")
    return figure


def animate(file: str) -> None:
    """Write the moving page of a motion close to the separatrix."""
    spin = np.array([0.0, 2.0, 0.05])
    BRICK.simulate(np.linspace(0.0, 30.0, 901), spin).animate(file, title="Near the separatrix")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "polhodes.png", dpi=130)
    animate("polhodes.html")
