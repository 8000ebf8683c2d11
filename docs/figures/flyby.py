"""What a flyby of the Earth makes of the spin of Apophis."""

import matplotlib as mpl
from _scene import STYLE, save
from matplotlib.figure import Figure
from polhode import RigidBody, flybys, orbits, plot

HOUR, DAY = 3600.0, 86400.0


def draw() -> Figure:
    """Draw spin rate and pole shift of clones."""
    mpl.rcParams.update(STYLE | {"font.size": 11.0})
    orbit = orbits.from_elements(
        398600.4418, eccentricity=4.253901873, periapsis=38011.486, since_periapsis=-3 * DAY
    )
    found = flybys.flyby(
        RigidBody.from_principal(1.0, (0.64, 0.97, 1.0)),
        orbit,
        6 * DAY,
        rotation_period=264.178 * HOUR,
        precession_period=27.38547 * HOUR,
        mode="short-axis",
        n=20_000,
    )
    figure = Figure(figsize=(9.6, 3.6), facecolor="white", layout="constrained")
    left, right = figure.subplots(1, 2)
    plot.flyby(found, "spin_ratio", left)
    plot.flyby(found, "pole_shift", right)
    return figure


if __name__ == "__main__":
    save(draw(), __file__)
