"""Reading and writing: bodies from meshes, molecules and CAD, and bodies and motions that keep every bit.

:meth:`polhode.RigidBody.from_file` reads every file that holds a body. :func:`load` opens one that holds a
mesh, a molecule or solids of CAD, without making a body of it.

:meth:`polhode.RigidBody.save` and :meth:`polhode.Trajectory.save` write JSON and NumPy's npz;
:meth:`polhode.RigidBody.from_file` and :meth:`polhode.Trajectory.from_file` read them. :data:`BODY_SCHEMA`
and :data:`TRAJECTORY_SCHEMA` describe the JSON files, as JSON Schema.

A *v/f text* is a text file whose lines ``v x y z`` give the vertices and whose lines ``f i j k`` give the
triangles by the numbers of their vertices. OBJ files have this form, and so have the plate models of
asteroids.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from polhode.io.cut import cut_mesh
    from polhode.io.formats import FileContent, load, read_mesh, solid_from_file
    from polhode.io.mesh import Mesh
    from polhode.io.mesh_solid import MeshSolid
    from polhode.io.molecules import Molecule, read_xyz
    from polhode.io.saved import BODY_SCHEMA, TRAJECTORY_SCHEMA
else:

    def __getattr__(name):
        """Import a name when it is first used: the command line writes files without NumPy."""
        from importlib import import_module

        home = _HOMES.get(name)
        if home is None:
            from polhode._hints import no_name

            raise no_name(__name__, name, __all__)
        value = globals()[name] = getattr(import_module(f"{__name__}.{home}"), name)
        return value

    def __dir__():
        return __all__


_HOMES = {
    "BODY_SCHEMA": "saved",
    "FileContent": "formats",
    "Mesh": "mesh",
    "MeshSolid": "mesh_solid",
    "Molecule": "molecules",
    "TRAJECTORY_SCHEMA": "saved",
    "cut_mesh": "cut",
    "load": "formats",
    "read_mesh": "formats",
    "read_xyz": "molecules",
    "solid_from_file": "formats",
}
"""In which file of this room each public name stands."""

__all__ = [
    "BODY_SCHEMA",
    "TRAJECTORY_SCHEMA",
    "FileContent",
    "Mesh",
    "MeshSolid",
    "Molecule",
    "cut_mesh",
    "load",
    "read_mesh",
    "read_xyz",
    "solid_from_file",
]
