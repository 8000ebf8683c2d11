"""Bodies from objects of other libraries, recognised by their attributes and not by their class."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core
from polhode.molecules import body_of_atoms, isotopes

if TYPE_CHECKING:
    from polhode._nuclides import Masses

__all__ = ["body_from_atoms", "body_from_mesh"]


def body_from_mesh(mesh: Any, **options: Any) -> _core.RigidBody:
    """Take vertices and faces: what ``RigidBody.from_mesh_object`` does.

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
    """Take symbols and positions: what ``RigidBody.from_atoms`` does.

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
        was_set = hasattr(atoms, "has") and atoms.has("masses")  # by ASE's set_masses
        if was_set or not hasattr(atoms, "get_chemical_symbols"):
            return body_of_atoms(atoms.get_masses(), positions, source="own")
        labels = atoms.get_chemical_symbols()
    elif hasattr(atoms, "GetAtoms") and hasattr(atoms, "GetConformer"):
        if not atoms.GetNumConformers():
            raise ValueError(
                "atoms: the molecule has no conformer, and so no positions; "
                "rdkit.Chem.AllChem.EmbedMolecule makes one"
            )
        labels = [f"{atom.GetIsotope() or ''}{atom.GetSymbol()}" for atom in atoms.GetAtoms()]
        positions = atoms.GetConformer(-1 if conformer is None else conformer).GetPositions()
    else:
        raise TypeError(
            f"atoms: expected ASE's Atoms or RDKit's Mol, got {type(atoms).__name__}; "
            "RigidBody.from_particles takes masses and positions"
        )
    found = [isotope.mass for isotope in isotopes(labels, masses)]
    return body_of_atoms(found, positions, source=masses)
