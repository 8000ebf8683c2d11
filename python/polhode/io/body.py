"""The body that a file of matter describes, a solid or a molecule."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from polhode.errors import FileFormatError, PolhodeError
from polhode.io.content import is_molecule
from polhode.io.read import load
from polhode.io.mesh_solid import naming_file, solid_of, warn_of_overlaps
from polhode.molecules import ATOMIC_MASS_CONSTANT, Isotope, body_of_atoms, isotopes
from polhode.molecules.bonding import crossings_of
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode import _core
    from polhode._core import RigidBody
    from polhode._typing import SupportsSigma
    from polhode.io.molecules import Molecule
    from polhode.molecules.nuclides import Masses

    Number = float | _core.Uncertain | SupportsSigma

__all__ = ["body_from_file", "body_of_molecule", "check_molecule_options", "molecule_isotopes"]


def body_from_file(
    path: str | os.PathLike[str],
    *,
    density: Number | Mapping[str, Number] | None = None,
    mass: float | _core.Uncertain | SupportsSigma | None = None,
    length_unit: str | None = None,
    weld: float = 0.0,
    closure: Literal["caps", "hull"] | None = None,
    orient: bool = False,
    union: bool = False,
    repair: bool = False,
    index_base: int = 1,
    masses: Masses = "most_common",
    progress: Callable[[float], object] | None = None,
) -> RigidBody:
    """Read the body a file describes: what ``RigidBody.from_file`` does.

    Parameters
    ----------
    path : str or os.PathLike
        A mesh, a molecule or solids of CAD; :func:`load` lists the formats.
    density, mass : float or Uncertain, optional
        Exactly one of them for a mesh, neither for a molecule. CAD solids whose materials have densities need
        neither. A mapping of names to densities gives each component of a mesh its own: by the
        names of its parts in the file, or by numbers from 1, as ``polhode report`` lists them.
    length_unit : str, optional
        Unit of the coordinates (see :mod:`polhode.units`). They are converted to metres, and the masses of a
        molecule to kilograms. Without it, coordinates are converted to metres if the file or its format
        states their unit (STEP, IGES, DAE, 3MF, glTF, GLB). All others stay as they are, and a molecule is in
        u and angstrom. A unit that differs from the one in the file is an error.
    weld, closure, orient, repair, index_base
        Of a mesh; see :func:`solid_from_file`.
    union : bool
        Whether to join overlapping components of a mesh, so that the common volume counts once; by manifold3d
        (extra ``union``). The join moves corners by about 1e-12 of the size of the mesh. No error bound
        includes this.
    masses : {"most_common", "average"}
        Masses of the atoms of a molecule; see :func:`polhode.molecules.isotopes`.
    progress : callable, optional
        A function that is called now and then with the fraction of a large mesh file that has been read. An
        exception that it raises ends the reading.

    Returns
    -------
    RigidBody

    Warns
    -----
    UserWarning
        If solids in a CAD file overlap: the message tells the mass that counts twice. Components of a mesh
        are not searched for overlaps; ``polhode report`` does that. If bonds or fragments of a molecule cross
        a side of the cell in its file: the moments are then those of the pieces.

    Raises
    ------
    FileFormatError
        If the file is not what its name says, damaged or empty.
    MeshError
        If the mesh does not bound a solid.
    OSError
        If the file cannot be read.
    """
    for name, value in (("density", density), ("mass", mass)):
        _check_amount(name, value, path)
    if length_unit is not None:
        metres_per(length_unit)
    if not is_molecule(Path(path)):
        if masses != "most_common":
            raise PolhodeError(f"masses: {os.fspath(path)} is a mesh, not a molecule; leave masses out")
        loaded = load(path, index_base=index_base)
        warn_of_overlaps(loaded)
        unit = loaded.length(length_unit)
        if isinstance(density, Mapping):
            from polhode.io.named_densities import body_by_names

            return body_by_names(
                loaded,
                density,
                scale=1.0 if unit is None else metres_per(unit),
                weld=weld,
                orient=orient,
                progress=progress,
                mass=mass is not None,
                closure=closure,
                union=union,
                repair=repair,
            )
        return solid_of(
            loaded,
            density=density,
            mass=mass,
            scale=1.0 if unit is None else metres_per(unit),
            weld=weld,
            closure=closure,
            orient=orient,
            union=union,
            repair=repair,
            progress=progress,
        ).body
    check_molecule_options(
        path,
        density=density is not None,
        mass=mass is not None,
        weld=weld != 0.0,
        closure=closure is not None,
        orient=orient,
        union=union,
        repair=repair,
        index_base=index_base != 1,
    )
    body, _, crossed = body_of_molecule(path, length_unit, masses)
    for note in crossed:
        warnings.warn(f"{os.fspath(path)}: {note}", stacklevel=2)
    return body


def body_of_molecule(
    path: str | os.PathLike[str], length_unit: str | None = None, masses: Masses = "most_common"
) -> tuple[RigidBody, tuple[str, ...], list[str]]:
    """Read the body of a molecule, with the notes of its file and words for what crosses its cell.

    Parameters
    ----------
    path : str or os.PathLike
    length_unit : str, optional
        As in :func:`body_from_file`.
    masses : {"most_common", "average"}
    """
    molecule = load(path).molecule
    atoms = molecule_isotopes(path, molecule, masses)
    metres, one = (1.0, 1.0) if length_unit is None else (metres_per(length_unit), ATOMIC_MASS_CONSTANT)
    found = [isotope.mass * one for isotope in atoms]
    with naming_file(path), np.errstate(over="ignore"):
        at = molecule.scaled(metres)
        body = body_of_atoms(found, at.positions, source=masses, rounding=at.rounding)
    crossed: list[str] = []
    if at.cell is not None:
        in_angstrom = 1.0 if length_unit is None else 1.0 / METRES["angstrom"]
        _, crossed = crossings_of(atoms, at.positions * in_angstrom, at.cell * in_angstrom)
    return body, molecule.notes, crossed


def check_molecule_options(path: str | os.PathLike[str], *, prefix: str = "", **given: bool) -> None:
    """Refuse options that only a mesh has, where the file is a molecule.

    Parameters
    ----------
    path : str or os.PathLike
        The molecule.
    prefix : str
        What stands before the name of an option where it is typed; its words are then joined by hyphens.
    **given : bool
        For each option of a mesh, whether it is given.
    """
    name = next((name for name, is_given in given.items() if is_given), None)
    if name is None:
        return
    reason = "whose atoms have their own masses" if name in ("density", "mass") else "not a mesh"
    shown = f"{prefix}{name.replace('_', '-')}" if prefix else name
    raise PolhodeError(f"{shown}: {os.fspath(path)} is a molecule, {reason}; leave it out")


def molecule_isotopes(
    path: str | os.PathLike[str], molecule: Molecule, masses: Masses = "most_common"
) -> list[Isotope]:
    """Find the nuclides of a molecule's atoms; an error names the file.

    Parameters
    ----------
    path : str or os.PathLike
        Where the molecule comes from.
    molecule : Molecule
        What was read.
    masses : {"most_common", "average"}
        See :func:`polhode.molecules.isotopes`.

    Returns
    -------
    list of Isotope
        In the order of the atoms.
    """
    try:
        return isotopes(molecule.labels, masses)
    except PolhodeError as error:
        raise FileFormatError(f"{os.fspath(path)}: {error}") from None


def _check_amount(name: str, value: object, path: str | os.PathLike[str]) -> None:
    if isinstance(value, str):
        raise TypeError(
            f"{name}: expected a number, got {value!r}; units are read on the command line: "
            f'polhode report {os.fspath(path)} --{name} "{value}"'
        )
