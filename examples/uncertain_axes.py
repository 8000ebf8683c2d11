"""How certain are the axes? The closer two moments are, the less certain are their axes."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, plot


def body(middle: float) -> RigidBody:
    """Give a body of which each element of the tensor is known to 0.012."""
    return RigidBody(1.0, np.diag([1.0, middle, 1.8])).with_sigma(inertia=np.full((3, 3), 0.012))


def draw() -> Figure:
    """Draw the ellipsoids of two bodies, each with the error ellipses of its axes."""
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    for k, middle in enumerate((1.4, 1.15), 1):
        ax = figure.add_subplot(1, 2, k, projection="3d", computed_zorder=False)
        uncertain = body(middle)
        angles = np.degrees(uncertain.sigma.axes)
        print(f"middle moment {middle}: axes known to {np.max(angles):.2f}°")
        plot.ellipsoid(uncertain, ax, enlarged=2.0)
        ax.set_axis_off()
        ax.set_title(f"middle moment {middle}")
    return figure


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "uncertain_axes.png", dpi=130)
