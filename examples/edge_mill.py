"""The edge mill: a stone that rolls around a shaft presses on its plate with more than its weight."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import euler_angles, kinematics, solids

MASS, RADIUS, AXLE, WIDTH, G = 800.0, 0.6, 0.9, 0.3, 9.81


def draw() -> Figure:
    """Draw the force on the plate over the rate of the shaft, from Euler's equations and by hand."""
    z_to_x = euler_angles.to_quaternion((np.pi / 2, 0.0, 0.0), "YXZ")
    stone = solids.cylinder(RADIUS, WIDTH, mass=MASS).rotated(z_to_x).translated((AXLE, 0.0, 0.0))
    rate = np.linspace(0.0, 8.0, 81)
    shaft = rate[:, np.newaxis] * np.array([0.0, 0.0, 1.0])
    omega = shaft - (rate * AXLE / RADIUS)[:, np.newaxis] * np.array([1.0, 0.0, 0.0])  # it rolls
    acceleration = kinematics.transport(np.zeros(3), omega, frame_omega=shaft)
    torque = stone.torque(omega, acceleration, about="origin")
    force = MASS * G - torque[:, 1] / AXLE
    by_hand = MASS * G + 0.5 * MASS * RADIUS * rate**2
    print(f"at 4 rad/s: {force[40]:.3f} N, by hand {by_hand[40]:.3f} N")

    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    ax = figure.add_subplot()
    ax.plot(rate, 1e-3 * force, color="#0072B2", label="Euler's equations")
    ax.plot(rate[::8], 1e-3 * by_hand[::8], "o", color="#D55E00", label="$mg + mR\\omega^2/2$")
    ax.axhline(1e-3 * MASS * G, color="0.5", linestyle=":", label="weight")
    ax.set(xlabel="rate of the shaft (rad/s)", ylabel="force on the plate (kN)", title="Edge mill")
    ax.legend(frameon=False)
    return figure


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "edge_mill.png", dpi=130)
