"""The body in a file, with what the options say about it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from polhode.cli.components import components_of, has_names, overlaps_beside, weigh
from polhode.cli.files import as_file
from polhode.cli.terminal import reading_progress
from polhode.errors import PolhodeError
from polhode.io.content import is_molecule
from polhode.io.cut import Plane, cut_solid
from polhode.io.formats import check_arguments, load, molecule_isotopes
from polhode.io.mesh import weld_within
from polhode.io.mesh_solid import MeshSolid, solid_of
from polhode.units import METRES, amount, has_unit, metres_per, quantity, split_vector, vector

if TYPE_CHECKING:
    from pathlib import Path

    from polhode import RigidBody, Uncertain
    from polhode.cli.atoms import Atoms
    from polhode.cli.options import BodyOptions, LengthUnit
    from polhode.io.formats import FileContent
    from polhode.io.mesh import Mesh
    from polhode.io.molecules import Molecule
    from polhode.molecules import CellCrossings, Isotope
    from polhode.molecules.nuclides import Masses

__all__ = ["LoadedBody", "bond_sigma", "in_file_unit", "load_body", "loaded_molecule"]

_LEAST, _MOST = 1e-13, 1e4
"""Between these volumes, in m^3, nothing is remarked of a part."""
_CHANGE_FACES = ("closure", "orient", "union", "repair")
"""Options after which the faces are not those of the file."""


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
    length_unit : str or None
        Unit of the coordinates in the file of a mesh, where it is known.
    states_unit : bool
        Whether the file or its format says so.
    kind : str
        What was read where it is neither a mesh nor a molecule: "saved body", "assembly" or "printout".
    crossings : CellCrossings or None
        What crosses the cell of a molecule's file, where it has one.
    regions : tuple of (int, RigidBody)
        Of an image: the body of the voxels of each value that has a density of its own.
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
    length_unit: str | None = None
    states_unit: bool = False
    kind: str = ""
    crossings: CellCrossings | None = None
    regions: tuple[tuple[int, RigidBody], ...] = ()

    @property
    def moment_unit(self) -> str:
        """Unit of a moment of inertia."""
        return f"{self.mass_unit} {self.length}^2"

    @property
    def extent(self) -> float:
        """A length of the body's own: its distance from the origin and its largest radius of gyration."""
        return float(np.linalg.norm(self.body.center_of_mass) + self.body.radii_of_gyration.max())


def load_body(
    file: Path, options: BodyOptions, *, with_shape: bool = False, with_components: bool = False
) -> LoadedBody:
    """Read the body in a file; ``-`` is standard input.

    A shape is kept where it is to be drawn, and components are told apart where they are to be listed.
    """
    with as_file(file) as path:
        if is_molecule(path):
            return _load_molecule(path, options)
        return _load_mesh(path, options, with_shape, with_components)


def _load_mesh(file: Path, options: BodyOptions, with_shape: bool, with_components: bool) -> LoadedBody:
    check_arguments(file, bond_sigma=options.bond_sigma is not None, mass_sigmas=options.mass_sigmas)
    if options.density is not None and options.mass is not None:
        raise PolhodeError(
            "--density and --mass: give one of the two, since the other follows from the volume"
        )
    loaded = load(file, index_base=options.index_base)
    asked, unit = options.length_unit, loaded.length(options.length_unit)
    options = replace(options, length_unit=cast("LengthUnit | None", unit))
    scale = 1.0 if unit is None else metres_per(unit)
    has_densities = loaded.cad is not None and all(part.density is not None for part in loaded.cad.parts)
    assumed = options.density is None and options.mass is None and not has_densities
    density = 1.0 if assumed else _amount(options.density, "kg/m^3", "--density", unit)
    mass = _amount(options.mass, "kg", "--mass", unit)
    weld = _weld(options)
    thickness = None
    if options.thickness is not None:
        thickness = in_file_unit(options.thickness, "--thickness", unit) * scale
    plane = _plane(options, unit, scale)
    solid = _solid(loaded, options, density, mass, scale, weld, thickness)
    if has_names(options.density):
        solid = weigh(loaded, solid, options, scale, weld)
    elif with_components and thickness is None and plane is None:
        solid = solid._replace(components=components_of(loaded, solid, options, scale, weld))
    provenance = solid.body.provenance
    notes = [*_note_units(options, unit), *_of_unit(loaded, asked), *loaded.notes]
    if thickness is not None:
        notes.append(f"the mesh is the middle of a sheet {options.thickness} thick (--thickness)")
    if thickness is None and not (with_components and plane is None):
        notes += overlaps_beside(loaded, solid, options, scale)
    notes += _unusual(solid.volume, unit, loaded)
    if weld != 0.0 and not options.repair:
        notes.append(f"{solid.welded} corners were joined to others within {weld:g} (--weld)")
    if options.repair and not solid.steps:
        notes.append("nothing had to be repaired (--repair)")
    if options.repair and solid.steps:
        total = sum(step.change for step in solid.steps)
        notes.append(f"the mesh was repaired (--repair), which changed its volume by {total:.3g} % in all")
    elif provenance.closure:
        share = 100.0 * float(provenance.volume_change) / solid.volume
        notes.append(
            f"the mesh is open; --closure {provenance.closure} closed it, which changed its volume by "
            f"{share:.3g} %; the area is that of the file's triangles"
        )
    shape = _shape(loaded, weld, scale) if with_shape else None
    if plane is not None:
        mended = {name: getattr(options, name) for name in _CHANGE_FACES}
        solid, cut = cut_solid(
            loaded, solid, plane, density=density, mass=mass, scale=scale, weld=weld, mended=mended
        )
        shape = cut if with_shape else None
        notes.append(
            f"the solid is cut by a plane (--cut {' '.join(options.cut)}); its area is with the section"
        )
    return LoadedBody(
        body=solid.body,
        source=solid,
        mass_unit="kg" if unit is not None else "mass",
        length="m" if unit is not None else "unit",
        density=float(solid.body.mass) / solid.volume
        if density is None or has_names(options.density)
        else _value(density),
        volume=solid.volume,
        assumed=assumed,
        notes=tuple(notes),
        shape=shape,
        length_unit=unit,
        states_unit=loaded.unit is not None and asked in (None, loaded.unit),
    )


def _plane(options: BodyOptions, unit: str | None, scale: float) -> Plane | None:
    """Read the plane that cuts the solid, in the unit of the body."""
    if not options.cut:
        if options.cut_point:
            raise PolhodeError("--cut-point: no plane is given; state its normal, as in --cut 0 0 -1")
        return None
    if options.thickness is not None:
        raise PolhodeError("--cut: --thickness makes a sheet, which has no inside; leave one of the two out")
    point = (0.0, 0.0, 0.0)
    if options.cut_point:
        parts = split_vector(options.cut_point, "m", "--cut-point")
        x, y, z = (in_file_unit(part, "--cut-point", unit) * scale for part in parts)
        point = x, y, z
    return Plane(vector(options.cut, "1", "--cut"), point)


def _unusual(volume: float, unit: str | None, loaded: FileContent) -> list[str]:
    """Remark on a part as large as a house, or too small to see, with the unit that is more likely."""
    if unit not in ("m", "mm", "cm", "in", "ft") or _LEAST < volume < _MOST:
        return []
    stored = volume / metres_per(unit) ** 3
    likely = [
        name for name in ("mm", "m", "in") if name != unit and _LEAST < stored * metres_per(name) ** 3 < 1.0
    ]
    if not likely:
        return [f"a volume of {volume:.4g} m^3 is unusual for a part; check the unit of length"]
    way_out = f"check that the file is in {unit}, as --length-unit says"
    if loaded.states_unit:
        way_out = "check what exported the file, which says its unit itself"
    elif loaded.unit == unit:
        way_out = f"check what exported the file, since {loaded.format} is in {unit} by its standard"
    return [
        f"a volume of {volume:.4g} m^3 is unusual for a part: in {likely[0]} it would be "
        f"{stored * metres_per(likely[0]) ** 3:.4g} m^3; {way_out}"
    ]


def _of_unit(loaded: FileContent, asked: str | None) -> list[str]:
    """Say that a unit was stated that is not the format's own."""
    if loaded.unit is None or asked in (None, loaded.unit):
        return []
    return [f"{loaded.format} is in {loaded.unit} by its standard; --length-unit {asked} was taken instead"]


def _shape(loaded: FileContent, weld: float, scale: float) -> Mesh | None:
    """Return the mesh as it is drawn, in the unit of the body; solids of CAD have none."""
    if loaded.cad is not None:
        return None
    mesh = weld_within(loaded.mesh, weld) if weld != 0.0 else loaded.mesh
    return mesh._replace(vertices=mesh.vertices * scale)


def _solid(
    loaded: FileContent,
    options: BodyOptions,
    density: float | Uncertain | None,
    mass: float | Uncertain | None,
    scale: float,
    weld: float,
    thickness: float | None,
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
            union=options.union,
            repair=options.repair,
            progress=tell,
            thickness=thickness,
        )


def _weld(options: BodyOptions) -> float:
    """Read the length within which corners are joined, in the unit of the file; 0 for equal ones alone."""
    if options.weld is None:
        return 0.0
    weld = in_file_unit(options.weld, "--weld", options.length_unit)
    if not weld > 0.0:
        raise PolhodeError(f"--weld: {weld:g} is not a positive length; leave it out to join equal corners")
    return weld


def _note_units(options: BodyOptions, unit: str | None) -> list[str]:
    """Say in which unit bare numbers were taken."""
    if unit is None:
        return []  # the report says that no unit is known
    texts = [("--mass", options.mass, "kg")]
    if has_names(options.density):
        texts += [("--density", item, "kg/m^3") for item in str(options.density).split(",")]
    else:
        texts.insert(0, ("--density", options.density, "kg/m^3"))
    return [
        f"{option} {text.strip()} has no unit: {si} was taken"
        for option, text, si in texts
        if text is not None and not has_unit(text.partition("=")[2] or text)
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
    if option == "--density" and has_names(text):  # each component has its own, which are put in later
        return 1.0
    if unit is None and has_unit(text):
        raise PolhodeError(
            f"{option}: {text!r} has a unit, but the file's coordinates have none; state --length-unit too"
        )
    return amount(text, si, option)


def _load_molecule(file: Path, options: BodyOptions) -> LoadedBody:
    from polhode.cli.atoms import atoms_of

    check_arguments(
        file,
        density=options.density is not None,
        mass=options.mass is not None,
        thickness=options.thickness is not None,
        cut=bool(options.cut or options.cut_point),
        weld=options.weld is not None,
        closure=options.closure is not None,
        orient=options.orient,
        union=options.union,
        repair=options.repair,
        index_base=options.index_base != 1,
    )
    loaded = load(file)
    molecule = loaded.molecule
    atoms = molecule_isotopes(file, molecule)
    unit = options.length_unit or "angstrom"
    in_angstrom = metres_per(unit) / METRES["angstrom"]
    molecule = molecule.scaled(in_angstrom)
    at = atoms_of(
        file,
        atoms,
        molecule,
        bond_sigma=bond_sigma(options.bond_sigma, unit),
        mass_sigmas=options.mass_sigmas,
    )
    return loaded_molecule(at, atoms, molecule, notes=loaded.notes)


def loaded_molecule(
    at: Atoms,
    atoms: list[Isotope],
    molecule: Molecule,
    masses: Masses = "most_common",
    notes: tuple[str, ...] = (),
) -> LoadedBody:
    """Make the body of a molecule's nuclides at their places, which are in angstrom."""
    crossings, crossed = None, list[str]()
    if molecule.cell is not None:
        from polhode.molecules.bonding import crossings_of

        crossings, crossed = crossings_of(atoms, molecule.positions, molecule.cell)
    return LoadedBody(
        body=at.body(atoms, masses),
        source=atoms,
        mass_unit="u",
        length="angstrom",
        comment=molecule.comment,
        notes=(*at.notes, *crossed, *molecule.notes, *notes),
        has_mass_sigmas=at.with_mass_sigmas,
        crossings=crossings,
    )


def bond_sigma(text: str | None, unit: str) -> float | None:
    """Read the sigma of bond lengths, in angstrom; a bare number is in the unit of the file."""
    if text is None:
        return None
    sigma = in_file_unit(text, "--bond-sigma", unit) * (metres_per(unit) / METRES["angstrom"])
    if sigma < 0.0:
        raise PolhodeError(f"--bond-sigma: expected a sigma of 0 or more, got {text.strip()!r}")
    return sigma
