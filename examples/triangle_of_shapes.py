"""Every body is a point in a triangle: its two smaller moments relative to the largest."""

import sys

from matplotlib.figure import Figure
from polhode import RigidBody, laminae, rods, solids

BODIES = {
    "sphere": solids.sphere(radius=1.0, mass=1.0),
    "disk": laminae.disk(radius=1.0, mass=1.0),
    "rod": rods.rod(length=1.0, mass=1.0),
    "brick": solids.box((3.0, 2.0, 1.0), mass=1.0),
    "racket": RigidBody.from_principal(0.33, (0.00121, 0.01638, 0.01748)),
    "Toutatis": RigidBody.from_principal(1.0, (1.0, 3.09, 3.22)),
    "plate 2 × 1": laminae.rectangle((2.0, 1.0), mass=1.0),
    "cone": solids.cone(radius=1.0, height=3.0, mass=1.0),
    "torus": solids.torus(major_radius=1.0, minor_radius=0.3, mass=1.0),
}


def draw() -> Figure:
    """Draw the triangle with its sides named, and the bodies in it."""
    figure = Figure(figsize=(6.4, 5.4), layout="constrained")
    ax = figure.add_subplot()
    ax.fill([0, 0.5, 1], [1, 0.5, 1], color="#E8EEF6")
    ax.plot([0, 0.5, 1, 0], [1, 0.5, 1, 1], color="0.4")
    ax.text(0.22, 0.68, "flat: I₁ + I₂ = I₃", rotation=-45, ha="center", va="center")
    ax.text(0.78, 0.72, "disk-like: I₁ = I₂", rotation=45, ha="center", va="center")
    ax.text(0.5, 1.02, "rod-like: I₂ = I₃", ha="center")
    for name, body in BODIES.items():
        small, middle, large = body.principal_moments
        assert small + middle >= large * (1 - 1e-12)
        print(f"{name}: {small / large:.3f}, {middle / large:.3f}")
        ax.plot(small / large, middle / large, "o", color="#D55E00", markersize=5)
        ax.annotate(name, (small / large, middle / large), (6, -10), textcoords="offset points")
    ax.set(xlabel="$I_1/I_3$", ylabel="$I_2/I_3$", xlim=(-0.03, 1.14), ylim=(0.46, 1.08))
    return figure


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "triangle_of_shapes.png", dpi=130)
