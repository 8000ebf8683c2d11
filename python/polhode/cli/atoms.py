"""The body of a molecule's atoms, with the sigmas that the options give them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from polhode.cli.files import label
from polhode.errors import PolhodeError
from polhode.molecules import Isotope, body_of_atoms, bonds, uncertain_masses, uncertain_positions

if TYPE_CHECKING:
    from pathlib import Path

    from polhode import RigidBody
    from polhode.io.molecules import Molecule
    from polhode.molecules.nuclides import Masses

__all__ = ["Atoms", "atoms_of"]

_NAMED = 8
"""Most bonds that a note names."""


class Atoms(NamedTuple):
    """What the body of a molecule and of its isotopologues is made of.

    Attributes
    ----------
    positions : numpy.ndarray or Uncertain, shape (n, 3)
        In angstrom.
    rounding : float
        See `Molecule`, in angstrom.
    with_mass_sigmas : bool
        Whether the sigmas of the masses count.
    notes : tuple of str
        What the sigmas are of.
    """

    positions: Any
    rounding: float
    with_mass_sigmas: bool
    notes: tuple[str, ...]

    def body(self, atoms: list[Isotope], source: Masses = "most_common") -> RigidBody:
        """Make the body of these nuclides at the positions."""
        masses: Any = [atom.mass for atom in atoms]
        if self.with_mass_sigmas:
            try:
                masses = uncertain_masses(atoms)
            except PolhodeError as error:
                raise PolhodeError(f"--mass-sigmas: {error}") from None
        return body_of_atoms(masses, self.positions, source=source, rounding=self.rounding)


def atoms_of(
    file: Path, atoms: list[Isotope], molecule: Molecule, *, bond_sigma: float | None, mass_sigmas: bool
) -> Atoms:
    """Put the atoms of a molecule at their places.

    Parameters
    ----------
    file : pathlib.Path
        Where it comes from.
    atoms : list of Isotope
        Its nuclides, by which bonds are found.
    molecule : Molecule
        In angstrom.
    bond_sigma : float, optional
        Of the length of each bond, in angstrom.
    mass_sigmas : bool
        Whether the sigmas of the masses count.
    """
    notes = ["sigmas of the masses are the published ones; atoms of the same isotope share one error"]
    if not mass_sigmas:
        notes = []
    if bond_sigma is None:
        return Atoms(molecule.positions, molecule.rounding, mass_sigmas, tuple(notes))
    try:
        pairs = bonds(atoms, molecule.positions)
        positions = uncertain_positions(atoms, molecule.positions, bond_sigma, pairs)
    except PolhodeError as error:
        raise PolhodeError(f"--bond-sigma: {label(file)}, atoms counted from 0: {error}") from None
    if not pairs:
        raise PolhodeError(
            f"--bond-sigma: no two atoms of {label(file)} are near enough for a bond; check --length-unit"
        )
    told = ", ".join(f"{atoms[i].name}({i + 1})-{atoms[j].name}({j + 1})" for i, j in pairs[:_NAMED])
    more = f" and {len(pairs) - _NAMED} more" if len(pairs) > _NAMED else ""
    notes.append(
        f"the sigma of each bond length is {bond_sigma:.3g} angstrom, one source each, angles exact; "
        f"bonds by covalent radii: {told}{more}"
    )
    parts = len(atoms) - len(pairs)  # each bond is in no ring, so that it joins two parts
    if parts > 1 and bond_sigma > 0.0:
        notes.append(f"no bonds join {parts} parts of the molecule: their positions count as exact")
    return Atoms(positions, molecule.rounding, mass_sigmas, tuple(notes))
