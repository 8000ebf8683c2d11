"""The readers of meshes and molecules, by the name that they are also known by: see :mod:`polhode.files`."""

from __future__ import annotations

from polhode.files.body import body_from_file, molecule_isotopes
from polhode.files.content import MOLECULE_SUFFIX
from polhode.files.loaded import read_mesh
from polhode.files.mesh import Mesh
from polhode.files.mesh_solid import MeshSolid, solid_from_file
from polhode.files.xyz import Molecule, read_xyz

__all__ = [
    "MOLECULE_SUFFIX",
    "Mesh",
    "MeshSolid",
    "Molecule",
    "body_from_file",
    "molecule_isotopes",
    "read_mesh",
    "read_xyz",
    "solid_from_file",
]
