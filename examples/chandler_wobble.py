"""Euler's ten months: the free wobble of a rigid Earth, and what the real Earth does instead."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, tops

FLATTENING = 0.0032738  # (C - A)/C, from precession of the equinoxes
EARTH = RigidBody.from_principal(1.0, (1.0 - FLATTENING, 1.0 - FLATTENING, 1.0))
DAY = 2 * np.pi / 0.99726957  # radians a day, by the stars


def draw() -> Figure:
    """Draw the path of the pole of a rigid Earth, started six metres off."""
    off = 6.0 / 6.37e6
    spin = DAY * np.array([off, 0.0, 1.0])
    motion = EARTH.free_motion(spin)
    period = 2 * np.pi / abs(tops.free_precession(EARTH, spin).body_rate)
    print(f"a rigid Earth wobbles in {period:.1f} days of 24 hours; Chandler found 433")
    print(f"A/(C - A) = {1.0 / FLATTENING - 1.0:.1f} turns of the Earth relative to the stars")
    t = np.linspace(0.0, 0.9 * period, 300)
    pole = 6.37e6 * motion.at(t).omega[:, :2] / DAY
    figure = Figure(figsize=(5.4, 5.0), layout="constrained")
    ax = figure.add_subplot()
    ax.plot(*pole.T, color="#0072B2")
    ax.plot(*pole[0], "o", color="#D55E00")
    ax.set(xlabel="x of the pole (m)", ylabel="y of the pole (m)", aspect="equal")
    ax.grid(color="0.9")
    return figure


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "chandler_wobble.png", dpi=130)
