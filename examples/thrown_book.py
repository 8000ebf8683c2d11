"""A book thrown about each of its three axes: about the middle axis the rotation is unstable."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, plot, solids


def book() -> RigidBody:
    """Give a closed book: width, height and thickness in metres."""
    return solids.box((0.16, 0.23, 0.03), mass=0.8)


def draw() -> Figure:
    """Draw the angular velocity of three throws, each a little off its axis."""
    body = book()
    figure = Figure(figsize=(12.0, 3.6), layout="constrained")
    for k, ax in enumerate(figure.subplots(1, 3, sharey=True)):
        spin = np.full(3, 0.1) + 10.0 * np.eye(3)[k] @ body.principal.axes.T
        stability = body.stability(10.0)[k]
        verdict = "stable" if stability > 0.0 else "flips"
        print(f"axis {k + 1}: moment {body.principal_moments[k]:.5f} kg m², {verdict}")
        plot.angular_velocity(body.simulate(np.linspace(0.0, 6.0, 601), spin), ax, frame="principal")
        ax.set_title(f"about axis {k + 1}", pad=22)
    return figure


def animate(file: str) -> None:
    """Write the moving page of the throw that is not stable."""
    body = book()
    spin = np.full(3, 0.1) + 10.0 * body.principal.axes[:, 1]
    body.simulate(np.linspace(0.0, 4.0, 801), spin).animate(file, title="A book about its middle axis")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "thrown_book.png", dpi=130)
    animate("thrown_book.html")
