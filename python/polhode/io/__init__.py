"""Reading and writing: bodies from meshes, molecules and CAD, and bodies and motions that keep every bit.

:func:`load` opens a file that holds a mesh, a molecule or solids of CAD; :meth:`polhode.RigidBody.from_file`
makes a body of it.

:meth:`polhode.RigidBody.save` and :meth:`polhode.Trajectory.save` write JSON and NumPy's npz;
:meth:`polhode.RigidBody.load` and :meth:`polhode.Trajectory.from_file` read them. :data:`BODY_SCHEMA` and
:data:`TRAJECTORY_SCHEMA` describe the JSON files, as JSON Schema.

A *v/f text* is a text file whose lines ``v x y z`` give the vertices and whose lines ``f i j k`` give the
triangles by the numbers of their vertices. OBJ files have this form, and so have the plate models of
asteroids.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from os import PathLike

    from polhode.io.read import body_from_file
    from polhode.io.read import Loaded, load, read_mesh
    from polhode.io.mesh import Mesh
    from polhode.io.mesh_solid import MeshSolid, solid_from_file
    from polhode.io.molecules import Molecule, read_xyz
    from polhode.io.saved import (
        BODY_SCHEMA,
        TRAJECTORY_SCHEMA,
        load_body,
        save_body,
        save_trajectory_json,
        save_trajectory_npz,
    )
    from polhode.motion.trajectory import Trajectory
else:

    def __getattr__(name):
        """Import a name when it is first used: the command line writes files without NumPy."""
        from importlib import import_module

        home = _HOMES.get(name)
        if home is None:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = globals()[name] = getattr(import_module(f"{__name__}.{home}"), name)
        return value

    def __dir__():
        return __all__


_HOMES = {
    "BODY_SCHEMA": "saved",
    "Loaded": "read",
    "Mesh": "mesh",
    "MeshSolid": "mesh_solid",
    "Molecule": "molecules",
    "TRAJECTORY_SCHEMA": "saved",
    "body_from_file": "read",
    "load": "read",
    "load_body": "saved",
    "read_mesh": "read",
    "read_xyz": "molecules",
    "save_body": "saved",
    "save_trajectory_json": "saved",
    "save_trajectory_npz": "saved",
    "solid_from_file": "mesh_solid",
}
"""In which file of this room each public name stands."""

__all__ = [
    "BODY_SCHEMA",
    "TRAJECTORY_SCHEMA",
    "Loaded",
    "Mesh",
    "MeshSolid",
    "Molecule",
    "body_from_file",
    "load",
    "load_body",
    "load_trajectory",
    "read_mesh",
    "read_xyz",
    "save_body",
    "save_trajectory_json",
    "save_trajectory_npz",
    "solid_from_file",
]


def load_trajectory(path: str | PathLike[str]) -> Trajectory:
    """Read a motion: what ``Trajectory.from_file`` does.

    Parameters
    ----------
    path : str or os.PathLike
        Ends in ``.json`` or ``.npz``.
    """
    from polhode.motion.trajectory import Trajectory

    return Trajectory.from_file(path)
