"""Four particles that can replace a solid: they have its mass, its centre of mass and its tensor."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody, solids


def draw() -> Figure:
    """Draw a brick and the four particles that move as it does."""
    brick = solids.box((3.0, 2.0, 1.0), mass=8.0)
    particles = brick.equimomental_particles()
    again = RigidBody.from_particles(*particles)
    error = np.abs(again.inertia - brick.inertia).max() / brick.principal_moments[2]
    print(f"{len(particles.masses)} particles of {particles.masses[0]:g} kg; tensors differ by {error:.0e}")
    figure = Figure(figsize=(6.4, 5.0), layout="constrained")
    ax = figure.add_subplot(projection="3d")
    corners = np.array([(x, y, z) for x in (-1.5, 1.5) for y in (-1, 1) for z in (-0.5, 0.5)])
    for i, a in enumerate(corners):
        for b in corners[i + 1 :]:
            if np.count_nonzero(a - b) == 1:
                ax.plot(*np.stack([a, b], axis=-1), color="0.6", linewidth=1)
    ax.scatter(*particles.positions.T, s=90, color="#D55E00", depthshade=False)
    ax.set(xlabel="x (m)", ylabel="y (m)", zlabel="z (m)")
    ax.set_box_aspect((3, 2, 1.5))
    return figure


def animate(file: str) -> None:
    """Write the moving page of the four particles, which flip as the brick does."""
    brick = solids.box((3.0, 2.0, 1.0), mass=8.0)
    four = RigidBody.from_particles(*brick.equimomental_particles())
    four.simulate([0.0, 20.0], brick.principal.axes @ (0.01, 5.0, 0.0)).animate(file, title="Four particles")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "four_particles.png", dpi=130)
    animate("four_particles.html")
