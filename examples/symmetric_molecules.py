"""Long, flat or neither? Ray's parameter of six molecules, computed from their atoms."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody
from polhode.molecules import ray_kappa, rotational_constants

H, C, N, O = 1.00782503, 12.0, 14.0030740, 15.9949146  # noqa: E741
TURN = 2 * np.pi / 3 * np.arange(3)
SIXTH = np.pi / 3 * np.arange(6)


def ring(radius: float, angles: np.ndarray, height: float = 0.0) -> list[tuple[float, float, float]]:
    """Give places on a circle about z."""
    return [(radius * np.cos(a), radius * np.sin(a), height) for a in angles]


MOLECULES = {
    "chloromethane": ([C, 34.968853, H, H, H], [(0, 0, 0), (0, 0, 1.776), *ring(1.027, TURN, -0.34)]),
    "ethylene": (
        [C, C, H, H, H, H],
        [(0.667, 0, 0), (-0.667, 0, 0), *((s * 1.230, u * 0.925, 0) for s in (1, -1) for u in (1, -1))],
    ),
    "water": ([O, H, H], [(0, 0, 0), (0.757, 0.587, 0), (-0.757, 0.587, 0)]),
    "ozone": ([O, O, O], [(0, 0, 0), (1.089, 0.669, 0), (-1.089, 0.669, 0)]),
    "ammonia": ([N, H, H, H], [(0, 0, 0), *ring(0.9377, TURN, -0.3816)]),
    "benzene": ([C] * 6 + [H] * 6, [*ring(1.391, SIXTH), *ring(2.471, SIXTH)]),
}  # ångström


def draw() -> Figure:
    """Draw each molecule at its κ: −1 is long, +1 is flat."""
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    ax = figure.add_subplot()
    for row, (name, (masses, places)) in enumerate(MOLECULES.items()):
        body = RigidBody.from_particles(masses, places)
        kappa = float(ray_kappa(rotational_constants(body.principal_moments)))
        print(f"{name}: kappa {kappa:+.4f}, {body.principal.top}")
        ax.plot([-1, kappa], [row, row], color="0.8", linewidth=1)
        ax.plot(kappa, row, "o", color="#0072B2")
    ax.set_yticks(range(len(MOLECULES)), list(MOLECULES))
    ax.set(xlabel="Ray's κ:  −1 long (prolate), +1 flat (oblate)", xlim=(-1.1, 1.1))
    ax.grid(color="0.93")
    return figure


def animate(file: str) -> None:
    """Write the moving page of benzene, a flat top."""
    benzene = RigidBody.from_particles(*MOLECULES["benzene"])
    benzene.simulate([0.0, 5e-12], (3e12, 0.0, 4e12)).animate(file, title="Benzene")  # rad/s


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "symmetric_molecules.png", dpi=130)
    animate("symmetric_molecules.html")
