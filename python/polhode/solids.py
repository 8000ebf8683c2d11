"""Homogeneous solids, each with its centre of mass at the origin and its symmetry axis along z.

Narrow ends, apexes and domes are toward +z. Each function takes exactly one of ``mass=`` and ``density=``.
Lengths are full lengths, unless the name says radius or semi-axis. Arrays of sizes, masses or densities
broadcast to a stack of bodies. A length of zero gives the limit: a cylinder of zero height is a disk, a
hollow sphere without thickness is a shell.
"""

from typing import TYPE_CHECKING

from polhode._core import (
    box,
    capsule,
    cone,
    cube,
    cylinder,
    ellipsoid,
    frustum,
    hemisphere,
    hollow_sphere,
    prism,
    pyramid,
    sphere,
    tetrahedron,
    torus,
    tube,
    wedge,
)

__all__ = [
    "box",
    "capsule",
    "cone",
    "cube",
    "cylinder",
    "ellipsoid",
    "frustum",
    "hemisphere",
    "hollow_sphere",
    "prism",
    "pyramid",
    "sphere",
    "tetrahedron",
    "torus",
    "tube",
    "wedge",
]

if not TYPE_CHECKING:
    from polhode._hints import explain_calls, no_name

    explain_calls(globals(), __all__)

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        raise no_name(__name__, name, __all__)
