"""A run with its bands, and the ellipsoid of inertia with its error ellipses."""

import matplotlib as mpl
import numpy as np
from _scene import STYLE, save
from matplotlib.figure import Figure
from polhode import RigidBody, Uncertain, plot


def draw() -> Figure:
    """Draw both for one body: each element of its tensor is known to about a percent."""
    mpl.rcParams.update(STYLE | {"font.size": 10.0})
    body = RigidBody(1.0, np.diag([1.0, 1.3, 1.8])).with_sigma(
        inertia=np.full((3, 3), 0.012), source="tensor"
    )
    run = body.simulate(
        np.linspace(0.0, 20.0, 201), omega=Uncertain((0.3, 0.1, 0.5), sigma=0.003, source="start")
    )
    figure = Figure(figsize=(9.0, 3.6), facecolor="white", layout="constrained")
    plot.angular_velocity(run, figure.add_subplot(1, 2, 1))
    ax = figure.add_subplot(1, 2, 2, projection="3d", computed_zorder=False)
    plot.ellipsoid(body, ax, enlarged=2.0)
    for name in "xyz":
        getattr(ax, f"set_{name}lim")(-1.1, 1.1)
    ax.set_box_aspect((1.0, 1.0, 1.0), zoom=1.2)
    ax.set_axis_off()
    ax.collections[0].set_rasterized(True)  # the surface: thousands of small pieces
    return figure


if __name__ == "__main__":
    save(draw(), __file__)
