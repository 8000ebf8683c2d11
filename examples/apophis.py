"""Apophis passes the Earth on 13 April 2029. The possible changes of its spin, computed with many clones."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, flybys, orbits, plot

# Lee et al. 2022 (A&A 661, L3): a short-axis mode with these periods; ratios of the moments.
HOUR, DAY = 3600.0, 86400.0
ROTATION, PRECESSION = 264.178 * HOUR, 27.38547 * HOUR
MOMENTS = (0.64, 0.97, 1.0)
# The orbit about the Earth: km and s.
EARTH, ECCENTRICITY, PERIAPSIS = 398600.4418, 4.253901873, 38011.486


def draw(clones: int = 2000) -> Figure:
    """Draw periods, spin rate and pole shift of clones after the flyby."""
    orbit = orbits.from_elements(
        EARTH, eccentricity=ECCENTRICITY, periapsis=PERIAPSIS, since_periapsis=-3 * DAY
    )
    found = flybys.flyby(
        RigidBody.from_principal(1.0, MOMENTS),
        orbit,
        6 * DAY,
        rotation_period=ROTATION,
        precession_period=PRECESSION,
        mode="short-axis",
        n=clones,
    )
    slow, fast = np.quantile(found.spin_ratio, (0.05, 0.95))
    print(f"spin rate after the flyby, divided by that before: {slow:.2f} to {fast:.2f} (90 % of the clones)")
    print(f"pole shift: {np.degrees(np.median(found.pole_shift)):.0f} degrees (median)")
    for mode, share in found.modes().items():
        print(f"{mode}: {100 * share:.0f} % after")

    figure = Figure(figsize=(11.0, 7.4), layout="constrained")
    axes = figure.subplots(2, 2).ravel()
    plot.flyby(found, "rotation_period", axes[0], time_label="h", time_scale=HOUR)
    plot.flyby(found, "precession_period", axes[1], time_label="h", time_scale=HOUR)
    plot.flyby(found, "spin_ratio", axes[2])
    plot.flyby(found, "pole_shift", axes[3])
    return figure


def animate(file: str) -> None:
    """Write the moving page of the tumbling before the flyby, over a month."""
    motion = RigidBody.from_principal(1.0, MOMENTS).free_motion_from_periods(
        ROTATION / DAY, PRECESSION / DAY, mode="short-axis"
    )
    motion.at([0.0, 30.0]).animate(file, title="Apophis before the flyby", time_label="d")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "apophis.png", dpi=130)
    animate("apophis.html")
