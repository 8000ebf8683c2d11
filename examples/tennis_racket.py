"""The tennis racket: spun about its intermediate axis it flips again and again, as theory predicts."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import Event, RigidBody, plot

GRAMS = 1e-3


def draw() -> Figure:
    """Draw the angular velocity of a racket over three flips, and its polhodes."""
    racket = RigidBody.from_principal(330 * GRAMS, (0.00121, 0.01638, 0.01748))
    spin = np.array([0.02, 12.0, 0.02])  # rad/s, nearly about the intermediate axis
    motion = racket.free_motion(spin)
    print(f"mode {motion.mode}; the racket flips every {motion.periods.flip:.6f} s")

    flip = Event(lambda _t, omega, *_: omega[1])
    t = np.linspace(0.0, 3.5 * motion.periods.flip, 1401)
    simulated = racket.simulate(t, spin, events=flip, rtol=1e-12)
    between = np.diff(simulated.events.t)
    print(f"simulated: {between.mean():.6f} s")

    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    left = figure.add_subplot(1, 2, 1)
    plot.angular_velocity(motion.at(t), left, frame="principal")
    for time in simulated.events.t:
        left.axvline(time, color="0.6", linewidth=0.8)
    right = figure.add_subplot(1, 2, 2, projection="3d", computed_zorder=False)
    plot.polhodes(racket, right, energy=float(motion.kinetic_energy().total))
    return figure


def animate(file: str) -> None:
    """Write the moving page."""
    racket = RigidBody.from_principal(330 * GRAMS, (0.00121, 0.01638, 0.01748))
    racket.simulate(np.linspace(0.0, 4.0, 801), (0.02, 12.0, 0.02)).animate(file, title="Tennis racket")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "tennis_racket.png", dpi=130)
    animate("tennis_racket.html")
