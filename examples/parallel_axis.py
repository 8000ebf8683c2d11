"""The parallel-axis theorem: a pendulum swings fastest if its pivot is one radius of gyration from C."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import rods

G = 9.81  # m/s²


def draw() -> Figure:
    """Draw the period of small swings of a rod over the distance of the pivot from its middle."""
    rod = rods.rod(length=1.0, mass=0.5)
    distance = np.linspace(0.02, 0.5, 400)
    pivots = np.stack([0.0 * distance, 0.0 * distance, distance], axis=-1)
    # Moment about the axis x through each pivot: I_C + m d².
    moment = np.array([rod.moment_about((1.0, 0.0, 0.0), about=pivot) for pivot in pivots])
    period = 2 * np.pi * np.sqrt(moment / (rod.mass * G * distance))
    gyration = rod.radii_of_gyration[-1]
    best = distance[period.argmin()]
    print(f"about the end: {moment[-1]:.6f} kg m², by hand {0.5 * 1.0**2 / 3:.6f} kg m²")
    print(f"shortest period {period.min():.4f} s at {best:.3f} m; radius of gyration {gyration:.3f} m")

    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    ax = figure.add_subplot()
    ax.plot(distance, period, color="#0072B2")
    ax.axvline(gyration, color="#D55E00", linestyle="--", label="radius of gyration about C")
    ax.set(
        xlabel="pivot from the middle (m)", ylabel="period (s)", ylim=(1.4, 3.0), title="A rod as a pendulum"
    )
    ax.legend(frameon=False)
    return figure


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "parallel_axis.png", dpi=130)
