"""The light of a tumbling asteroid: its brightness over time has two periods at once."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody

# (4179) Toutatis: ratios of the moments fitted to its rotation, and periods (Ostro et al., Icarus 137 (1999)
# 122). Its radar shape with a uniform density gives 1 : 3.013 : 3.190.
TOUTATIS = RigidBody.from_principal(1.0, (1.0, 3.09, 3.22))
SHAPE = np.array([2.3, 1.2, 0.95])
"""Half-axes in km of an ellipsoid that reflects the light."""


def draw() -> Figure:
    """Draw the area that an observer sees of the ellipsoid, over three weeks, and its spectrum."""
    motion = TOUTATIS.free_motion_from_periods(5.41, 7.35, mode="long-axis")
    t = np.linspace(0.0, 400.0, 8001)
    toward = motion.at(t).rotation.inv().apply((1.0, 0.3, 0.2) / np.linalg.norm((1.0, 0.3, 0.2)))
    area = np.pi * SHAPE.prod() * np.linalg.norm(toward / SHAPE, axis=1)
    light = -2.5 * np.log10(area / area.mean())
    power = np.abs(np.fft.rfft((light - light.mean()) * np.hanning(len(t)))) ** 2
    frequency = np.fft.rfftfreq(len(t), t[1])
    strongest = 1 / frequency[np.argmax(power)]
    print(f"strongest period {strongest:.2f} d; half of the precession, {7.35 / 2:.3f} d")
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(t[t < 21], light[t < 21], color="#0072B2")
    left.set(xlabel="time (d)", ylabel="magnitude, relative")
    left.invert_yaxis()
    right.plot(frequency, power / power.max(), color="#D55E00")
    right.set(xlabel="frequency (1/d)", ylabel="power", xlim=(0, 1))
    for ax in (left, right):
        ax.grid(color="0.9")
    return figure


def animate(file: str) -> None:
    """Write the moving page of three weeks."""
    motion = TOUTATIS.free_motion_from_periods(5.41, 7.35, mode="long-axis")
    motion.at([0.0, 21.0]).animate(file, title="Toutatis over three weeks", time_label="d")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "light_curve.png", dpi=130)
    animate("light_curve.html")
