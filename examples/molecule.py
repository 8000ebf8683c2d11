"""Water as a rigid body: rotational constants of its isotopologues, and how its axes turn."""

import sys

import numpy as np
from matplotlib.figure import Figure
from polhode import RigidBody
from polhode.molecules import inertial_defect, rotational_constants

BOND, ANGLE = 0.9578, np.deg2rad(104.48)  # ångström: the equilibrium structure
MASSES = {"H2O": (15.9949146, 1.0078250, 1.0078250), "HDO": (15.9949146, 2.0141018, 1.0078250),
          "D2O": (15.9949146, 2.0141018, 2.0141018)}  # fmt: skip


def positions() -> np.ndarray:
    """O at the origin, the two hydrogens in the plane x-y."""
    half = ANGLE / 2
    return np.array(
        [
            (0, 0, 0),
            (BOND * np.sin(half), -BOND * np.cos(half), 0),
            (-BOND * np.sin(half), -BOND * np.cos(half), 0),
        ]
    )


def draw() -> Figure:
    """Draw each molecule with its centre of mass and the two principal axes of its plane."""
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    for ax, (name, masses) in zip(figure.subplots(1, 3), MASSES.items(), strict=True):
        molecule = RigidBody.from_particles(masses, positions())
        constants = rotational_constants(molecule.principal_moments)
        a, b, c = 1e-3 * np.asarray(constants)
        kappa = molecule.principal.kappa
        print(f"{name}: A {a:.2f}, B {b:.2f}, C {c:.2f} GHz, kappa {kappa:+.4f}, {molecule.principal.top}")
        assert abs(inertial_defect(molecule.principal_moments)) < 1e-12  # planar: I3 = I1 + I2
        atoms = positions()[:, :2]
        for end in atoms[1:]:
            ax.plot(*np.stack([atoms[0], end], axis=-1), color="0.5", linewidth=3, zorder=1)
        ax.scatter(
            *atoms.T,
            s=60 * np.asarray(masses) ** 0.8,
            color=["#D55E00", *2 * ["#C9D6E8"]],
            edgecolor="0.3",
            zorder=2,
        )
        center = molecule.center_of_mass[:2]
        for k, (color, dash) in enumerate((("#0072B2", "--"), ("#009E73", "-."))):
            ends = center + 1.1 * np.outer((-1, 1), molecule.principal.axes[:2, k])
            ax.plot(*ends.T, color=color, linestyle=dash, label="ab"[k])
        ax.plot(*center, "k.", zorder=3)
        ax.set(
            title=f"{name}: {a:.0f}, {b:.0f}, {c:.0f} GHz",
            xlabel="x (Å)",
            ylabel="y (Å)",
            aspect="equal",
        )
        ax.legend(frameon=False, loc="upper right")
    return figure


def animate(file: str) -> None:
    """Write the moving page of HDO, spun about its intermediate axis."""
    molecule = RigidBody.from_particles(MASSES["HDO"], positions())
    spin = molecule.principal.axes @ (1e11, 1e13, 0.0)  # rad/s
    molecule.simulate([0.0, 5e-12], spin).animate(file, title="HDO")


if __name__ == "__main__":
    draw().savefig(sys.argv[1] if len(sys.argv) > 1 else "molecule.png", dpi=130)
    animate("molecule.html")
