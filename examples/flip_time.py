"""How long until it flips? The time grows like the logarithm of the inverse angle between spin and axis."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody

RACKET = RigidBody.from_principal(0.33, (0.00121, 0.01638, 0.01748))
RATE = 12.0  # rad/s about the intermediate axis


def draw() -> Figure:
    """Draw the time from flip to flip against the angle by which the spin is off the axis."""
    degrees = np.logspace(-9.0, 1.0, 60)
    off = np.radians(degrees)
    spins = RATE * np.stack([0 * off, np.cos(off), np.sin(off)], axis=-1)
    flips = np.array([float(RACKET.free_motion(spin).periods.flip) for spin in spins])
    I1, I2, I3 = RACKET.principal_moments
    growth = RATE * np.sqrt((I2 - I1) * (I3 - I2) / (I1 * I3))
    slope = np.polyfit(np.log(1.0 / off[:20]), flips[:20], 1)[0]
    print(f"per factor e: {slope:.6f} s; theory 2/growth = {2.0 / growth:.6f} s")

    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    ax = figure.add_subplot()
    ax.semilogx(degrees, flips, color="#0072B2")
    ax.set(xlabel="angle of the spin from the axis (degrees)", ylabel="time from flip to flip (s)")
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page of a spin that is a millionth of a degree off."""
    off = np.radians(1e-6)
    spin = RATE * np.array([0.0, np.cos(off), np.sin(off)])
    RACKET.simulate([0.0, 15.0], spin).animate(file, title="A millionth of a degree off the axis")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "flip_time.png", dpi=130)
    animate("flip_time.html")
