"""A satellite that points down by gravity alone librates; one with unfavourable moments tumbles."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, loads, orbits
from scipy.spatial.transform import Rotation

CIRCLE = orbits.kepler(1.0, (1, 0, 0), (0, 1, 0))  # one revolution takes 2π
SHAPES = {"roll 0.9, pitch 1, yaw 0.3": (0.9, 1.0, 0.3), "roll 0.3, pitch 1, yaw 0.9": (0.3, 1.0, 0.9)}


def begin() -> Rotation:
    """Give the attitude at the start, four degrees off."""
    down = Rotation.from_quat(CIRCLE.frame(0.0).quaternion)
    return down * Rotation.from_rotvec(np.radians([2.0, 3.0, 2.0]))


def draw() -> Figure:
    """Draw the angle from the vertical over ten revolutions, started four degrees off."""
    t = np.linspace(0.0, 20 * np.pi, 1001)
    down = Rotation.from_quat(CIRCLE.frame(t).quaternion)
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    ax = figure.add_subplot()
    for (name, moments), color in zip(SHAPES.items(), ("#0072B2", "#D55E00"), strict=True):
        body = RigidBody(1.0, np.diag(moments))
        run = body.simulate(t, CIRCLE.frame(0.0).omega, begin(), load=loads.gravity_gradient(CIRCLE))
        off = np.degrees((down.inv() * run.rotation).magnitude())
        print(f"{name}: up to {off.max():.0f}° off")
        ax.plot(t / (2 * np.pi), off, color=color, label=name)
    ax.set(xlabel="revolutions", ylabel="angle from pointing down (degrees)")
    ax.legend(loc="lower center", ncols=2, bbox_to_anchor=(0.5, 1.0), frameon=False)
    ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page of the one that tumbles, over ten revolutions."""
    t = np.linspace(0.0, 20 * np.pi, 2001)
    body = RigidBody(1.0, np.diag(SHAPES["roll 0.3, pitch 1, yaw 0.9"]))
    run = body.simulate(t, CIRCLE.frame(0.0).omega, begin(), load=loads.gravity_gradient(CIRCLE))
    run.animate(file, title="It tumbles; t is the angle along the orbit", time_label="rad")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "pointing_down.png", dpi=130)
    animate("pointing_down.html")
