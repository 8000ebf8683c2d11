"""The body in a file, with what the options say about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from polhode._quantities import amount, has_unit, quantity
from polhode.cli.progress import reading_progress
from polhode.cli.source import as_file
from polhode.errors import PolhodeError
from polhode.files.content import MOLECULE_SUFFIX
from polhode.files.loaded import load
from polhode.files.mesh import weld_within
from polhode.files.mesh_solid import MeshSolid, solid_of
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from pathlib import Path

    from polhode import RigidBody, Uncertain
    from polhode._nuclides import Masses
    from polhode.cli.atoms import Atoms
    from polhode.cli.options import BodyOptions
    from polhode.files.loaded import Loaded
    from polhode.files.mesh import Mesh
    from polhode.molecules import Isotope

__all__ = ["LoadedBody", "bond_sigma", "in_file_unit", "load_body", "loaded_molecule"]


@dataclass(frozen=True)
class LoadedBody:
    """A body with what its file and the options say about it.

    Attributes
    ----------
    body : RigidBody
        In kg and m, in u and angstrom (molecules), or in the file's own units.
    source : MeshSolid or list of Isotope
        What was read: a mesh or the nuclides of a molecule.
    comment : str
        A molecule's comment.
    mass_unit, length : str
        Names of the units of `body`.
    density : float
        Of a mesh; not a number for a molecule.
    volume : float
        Of a mesh; not a number for a molecule.
    assumed : bool
        Whether neither density nor mass was given, and density 1 was taken.
    notes : tuple of str
        How what was asked for was understood, and what was done to the mesh.
    shape : Mesh or None
        The mesh in the unit of `body`, where it was asked for.
    has_mass_sigmas : bool
        Whether the masses of a molecule's isotopes have sigmas.
    kind : str
        What was read where it is neither a mesh nor a molecule: "saved body", "assembly" or "printout".
    """

    body: RigidBody
    source: MeshSolid | list[Isotope]
    mass_unit: str
    length: str
    comment: str = ""
    density: float = float("nan")
    volume: float = float("nan")
    assumed: bool = False
    notes: tuple[str, ...] = ()
    shape: Mesh | None = None
    has_mass_sigmas: bool = False
    kind: str = ""

    @property
    def moment_unit(self) -> str:
        """Unit of a moment of inertia."""
        return f"{self.mass_unit} {self.length}^2"

    @property
    def extent(self) -> float:
        """A length of the body's own: its distance from the origin and its largest radius of gyration."""
        return float(np.linalg.norm(self.body.center_of_mass) + self.body.radii_of_gyration.max())


def load_body(file: Path, options: BodyOptions, *, with_shape: bool = False) -> LoadedBody:
    """Read the body in a file; ``-`` is standard input. A shape is kept where it is to be drawn."""
    with as_file(file) as path:
        if path.suffix.lower() == MOLECULE_SUFFIX:
            return _load_molecule(path, options)
        return _load_mesh(path, options, with_shape)


def _load_mesh(file: Path, options: BodyOptions, with_shape: bool) -> LoadedBody:
    for option, is_given in (("--bond-sigma", options.bond_sigma), ("--mass-sigmas", options.mass_sigmas)):
        if is_given:
            raise PolhodeError(f"{option}: {file} is a mesh, not a molecule; leave it out")
    if options.density is not None and options.mass is not None:
        raise PolhodeError(
            "--density and --mass: give one of the two, since the other follows from the volume"
        )
    unit = options.length_unit
    scale = 1.0 if unit is None else metres_per(unit)
    assumed = options.density is None and options.mass is None
    density = 1.0 if assumed else _amount(options.density, "kg/m^3", "--density", unit)
    mass = _amount(options.mass, "kg", "--mass", unit)
    weld = _weld(options)
    loaded = load(file, index_base=options.index_base)
    solid = _solid(loaded, options, density, mass, scale, weld)
    provenance = solid.body.provenance
    notes = _taken(options, unit)
    if weld != 0.0:
        notes.append(f"{solid.welded} corners were joined to others within {weld:g} (--weld)")
    if provenance.closure:
        share = 100.0 * float(provenance.volume_change) / solid.volume
        notes.append(
            f"the mesh is open; --closure {provenance.closure} closed it, which changed its volume by "
            f"{share:.3g} %; the area is that of the file's triangles"
        )
    return LoadedBody(
        body=solid.body,
        source=solid,
        mass_unit="kg" if unit is not None else "mass",
        length="m" if unit is not None else "unit",
        density=float(solid.body.mass) / solid.volume if density is None else _value(density),
        volume=solid.volume,
        assumed=assumed,
        notes=tuple(notes),
        shape=_shape(loaded, weld, scale) if with_shape else None,
    )


def _shape(loaded: Loaded, weld: float, scale: float) -> Mesh:
    """Give the mesh as it is drawn, in the unit of the body."""
    mesh = weld_within(loaded.mesh, weld) if weld != 0.0 else loaded.mesh
    return mesh._replace(vertices=mesh.vertices * scale)


def _solid(
    loaded: Loaded,
    options: BodyOptions,
    density: float | Uncertain | None,
    mass: float | Uncertain | None,
    scale: float,
    weld: float,
) -> MeshSolid:
    with reading_progress(loaded.path) as tell:
        return solid_of(
            loaded,
            density=density,
            mass=mass,
            scale=scale,
            weld=weld,
            closure=options.closure,
            orient=options.orient,
            progress=tell,
        )


def _weld(options: BodyOptions) -> float:
    """Read the length within which corners are joined, in the unit of the file; 0 for equal ones alone."""
    if options.weld is None:
        return 0.0
    weld = in_file_unit(options.weld, "--weld", options.length_unit)
    if not weld > 0.0:
        raise PolhodeError(f"--weld: {weld:g} is not a positive length; leave it out to join equal corners")
    return weld


def _taken(options: BodyOptions, unit: str | None) -> list[str]:
    """Say in which unit bare numbers were taken."""
    if unit is None:
        return []  # the report says that no unit is known
    return [
        f"{option} {text.strip()} has no unit: {si} was taken"
        for option, text, si in (("--density", options.density, "kg/m^3"), ("--mass", options.mass, "kg"))
        if text is not None and not has_unit(text)
    ]


def in_file_unit(text: str, option: str, unit: str | None) -> float:
    """Read a length that is compared with the file's coordinates: bare numbers are in their unit."""
    if not has_unit(text):
        return quantity(text, "m", option)
    if unit is None:
        raise PolhodeError(
            f"{option}: {text!r} has a unit, but the file's coordinates have none; state --length-unit too"
        )
    return quantity(text, "m", option) / metres_per(unit)


def _value(number: float | Uncertain) -> float:
    return number if isinstance(number, float) else float(number.value)


def _amount(text: str | None, si: str, option: str, unit: str | None) -> float | Uncertain | None:
    if text is None:
        return None
    if unit is None and has_unit(text):
        raise PolhodeError(
            f"{option}: {text!r} has a unit, but the file's coordinates have none; state --length-unit too"
        )
    return amount(text, si, option)


def _load_molecule(file: Path, options: BodyOptions) -> LoadedBody:
    from polhode.cli.atoms import atoms_of
    from polhode.files.body import check_molecule_options, molecule_isotopes

    check_molecule_options(
        file,
        prefix="--",
        density=options.density is not None,
        mass=options.mass is not None,
        weld=options.weld is not None,
        closure=options.closure is not None,
        orient=options.orient,
        index_base=options.index_base != 1,
    )
    molecule = load(file).molecule
    atoms = molecule_isotopes(file, molecule)
    unit = options.length_unit or "angstrom"
    in_angstrom = metres_per(unit) / METRES["angstrom"]
    molecule = molecule._replace(
        positions=molecule.positions * in_angstrom, rounding=molecule.rounding * in_angstrom
    )
    at = atoms_of(
        file,
        atoms,
        molecule,
        bond_sigma=bond_sigma(options.bond_sigma, unit),
        mass_sigmas=options.mass_sigmas,
    )
    return loaded_molecule(at, atoms, molecule.comment)


def loaded_molecule(
    at: Atoms, atoms: list[Isotope], comment: str, masses: Masses = "most_common"
) -> LoadedBody:
    """Make the body of a molecule's nuclides at their places."""
    return LoadedBody(
        body=at.body(atoms, masses),
        source=atoms,
        mass_unit="u",
        length="angstrom",
        comment=comment,
        notes=at.notes,
        has_mass_sigmas=at.with_mass_sigmas,
    )


def bond_sigma(text: str | None, unit: str) -> float | None:
    """Read the sigma of bond lengths, in angstrom; a bare number is in the unit of the file."""
    if text is None:
        return None
    sigma = in_file_unit(text, "--bond-sigma", unit) * (metres_per(unit) / METRES["angstrom"])
    if sigma < 0.0:
        raise PolhodeError(f"--bond-sigma: {text!r} is negative; a standard deviation is not")
    return sigma
