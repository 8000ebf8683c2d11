"""Bodies from objects of other libraries, recognised by their attributes and not by their class."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode.errors import PolhodeError
from polhode.molecules import body_of_atoms, isotopes
from polhode.molecules.bonding import crossings_of

if TYPE_CHECKING:
    from polhode.molecules.nuclides import Masses

__all__ = ["body_from_atoms", "body_from_mesh"]


def body_from_mesh(mesh: Any, **options: Any) -> _core.RigidBody:
    """Make a body of vertices and faces: what ``RigidBody.from_mesh_object`` does.

    Parameters
    ----------
    mesh : object
        With ``vertices`` and ``faces``, or a scene that ``to_mesh()`` turns into one.
    **options
        Of ``RigidBody.from_mesh``.
    """
    found = mesh.to_mesh() if hasattr(mesh, "to_mesh") and not hasattr(mesh, "faces") else mesh
    if not (hasattr(found, "vertices") and hasattr(found, "faces")):
        raise TypeError(
            "mesh: expected an object with vertices and faces, as trimesh has them, "
            f"got {type(mesh).__name__}; RigidBody.from_mesh takes arrays"
        )
    # Formats that store the corners of each triangle anew give equal vertices, which are one.
    vertices, index = np.unique(_core.real_numbers(found.vertices, "vertices"), axis=0, return_inverse=True)
    return _core.RigidBody.from_mesh(vertices, index.reshape(-1)[np.asarray(found.faces)], **options)


def body_from_atoms(
    atoms: Any, conformer: int | None = None, masses: Masses = "most_common"
) -> _core.RigidBody:
    """Make a body of symbols and positions: what ``RigidBody.from_atoms`` does.

    Parameters
    ----------
    atoms : object
        ASE's ``Atoms`` or RDKit's ``Mol``.
    conformer : int, optional
        Which of an RDKit molecule's.
    masses : {"most_common", "average"}
        Of each element, where the object was not given masses (ASE) or isotopes (RDKit) of its own.
    """
    if hasattr(atoms, "get_masses") and hasattr(atoms, "get_positions"):
        if conformer is not None:
            raise ValueError("conformer: only an RDKit molecule has some")
        positions = atoms.get_positions()
        cell = _cell_of(atoms)
        was_set = hasattr(atoms, "has") and atoms.has("masses")  # by ASE's set_masses
        if was_set or not hasattr(atoms, "get_chemical_symbols"):
            body = body_of_atoms(atoms.get_masses(), positions, source="own")
            if hasattr(atoms, "get_chemical_symbols"):
                _warn_of_crossings(atoms.get_chemical_symbols(), positions, cell)
            return body
        labels = atoms.get_chemical_symbols()
    elif hasattr(atoms, "GetAtoms") and hasattr(atoms, "GetConformer"):
        if not atoms.GetNumConformers():
            raise ValueError(
                "atoms: the molecule has no conformer, and so no positions; "
                "rdkit.Chem.AllChem.EmbedMolecule makes one"
            )
        cell = None
        labels = [f"{atom.GetIsotope() or ''}{atom.GetSymbol()}" for atom in atoms.GetAtoms()]
        shape = atoms.GetConformer(-1 if conformer is None else conformer)
        positions = shape.GetPositions()
        _check_rdkit(atoms, shape)
    else:
        raise TypeError(
            f"atoms: expected ASE's Atoms or RDKit's Mol, got {type(atoms).__name__}; "
            "RigidBody.from_particles takes masses and positions"
        )
    found = isotopes(labels, masses)
    body = body_of_atoms([isotope.mass for isotope in found], positions, source=masses)
    _warn_of_crossings(found, positions, cell)
    return body


def _check_rdkit(molecule: Any, conformer: Any) -> None:
    """Refuse a molecule in two dimensions; warn of hydrogens that have no positions."""
    if hasattr(conformer, "Is3D") and not conformer.Is3D() and not np.any(conformer.GetPositions()[:, 2]):
        raise PolhodeError(
            "atoms: the conformer is a drawing in the plane, not a geometry; make one with "
            "rdkit.Chem.AddHs and rdkit.Chem.AllChem.EmbedMolecule. If it is one: conformer.Set3D(True)"
        )
    if not hasattr(molecule, "NeedsUpdatePropertyCache") or molecule.NeedsUpdatePropertyCache():
        return  # no valences are known yet
    if molecule.GetNumBonds() == 0 and molecule.GetNumAtoms() > 1:
        return  # as of a molecule from XYZ, whose bonds nobody stated
    if implicit := sum(atom.GetTotalNumHs() for atom in molecule.GetAtoms()):
        warnings.warn(
            f"atoms: {implicit} hydrogens have no positions, so mass and moments are without them; "
            "rdkit.Chem.AddHs(molecule, addCoords=True) adds them",
            stacklevel=3,
        )


def _cell_of(atoms: Any) -> Any:
    """Return the vectors along which ASE's atoms repeat; None where they do not."""
    if not (hasattr(atoms, "get_pbc") and hasattr(atoms, "get_cell") and np.any(atoms.get_pbc())):
        return None
    return np.asarray(atoms.get_cell())[np.asarray(atoms.get_pbc(), dtype=bool)]


def _warn_of_crossings(labels: Any, positions: Any, cell: Any) -> None:
    if cell is not None:
        for note in crossings_of(labels, positions, cell)[1]:
            warnings.warn(f"atoms: {note}", stacklevel=3)
