"""What the moment of inertia says about the interior of a planet: I/(M R²) of a core and a mantle."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody


def factor(core: float, ratio: float) -> float:
    """Give I/(M R²) of a ball of radius 1 with a core of this radius; ratio: density of core to mantle."""
    planet = RigidBody.from_radial_density(lambda r: np.where(r < core, ratio, 1.0), (0.0, core, 1.0))
    return float(planet.principal_moments[0] / planet.mass)


def by_hand(core: float, ratio: float) -> float:
    """Give the same by the sum of two balls."""
    return 0.4 * (1 + (ratio - 1) * core**5) / (1 + (ratio - 1) * core**3)


def draw() -> Figure:
    """Draw I/(M R²) against the radius of the core, for three densities of the core."""
    radii = np.linspace(0.02, 0.98, 49)
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    ax = figure.add_subplot()
    worst = 0.0
    for ratio, color in ((2.0, "#0072B2"), (3.0, "#D55E00"), (6.0, "#009E73")):
        found = [factor(core, ratio) for core in radii]
        worst = max(worst, *(abs(a - by_hand(core, ratio)) for a, core in zip(found, radii, strict=True)))
        ax.plot(radii, found, color=color, label=f"core {ratio:g} times as dense")
    print(f"differs from the sum of two balls by at most {worst:.0e}")
    for name, value in (("uniform", 0.4), ("Moon", 0.393), ("Mars", 0.364), ("Earth", 0.331)):
        ax.axhline(value, color="0.7", linewidth=0.8, linestyle="--")
        ax.annotate(name, (1.0, value), (4, -4), textcoords="offset points", annotation_clip=False)
    ax.set(xlabel="radius of the core / radius of the planet", ylabel="$I/(MR^2)$", xlim=(0, 1))
    ax.legend(frameon=False)
    return figure


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "planet_interior.png", dpi=130)
