"""When does it flip? Ten thousand throws of a racket, each a little different."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody

RACKET = RigidBody.from_principal(0.33, (0.00121, 0.01638, 0.01748))


def draw() -> Figure:
    """Draw how often each time from flip to flip occurs, for hands that are more and less sure.

    ω is (0, 12, 0) rad/s but for errors; `sigma` is that of its two components across the axis.
    """
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    ax = figure.add_subplot()
    rng = np.random.default_rng(7)
    for sigma, color in ((0.3, "#0072B2"), (0.003, "#D55E00")):
        spins = rng.normal((0.0, 12.0, 0.0), (sigma, 0.2, sigma), size=(10_000, 3))
        flips = RACKET.free_motion(spins).periods.flip
        flips = flips[np.isfinite(flips)]
        low, middle, high = np.quantile(flips, (0.05, 0.5, 0.95))
        print(f"across ± {sigma} rad/s: a flip every {middle:.2f} s, {low:.2f} to {high:.2f} for 90 %")
        ax.hist(flips, 60, range=(0.5, 3.5), color=color, alpha=0.75, label=f"{sigma} rad/s across")
    ax.set(xlabel="time from flip to flip (s)", ylabel="throws")
    ax.legend(frameon=False)
    return figure


def animate(file: str) -> None:
    """Write the moving page of a throw by a hand that is less sure."""
    RACKET.simulate([0.0, 6.0], (0.3, 12.0, 0.3)).animate(file, title="A throw by an unsure hand")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "uncertain_flip.png", dpi=130)
    animate("uncertain_flip.html")
