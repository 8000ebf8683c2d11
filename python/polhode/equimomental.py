"""Equimomental systems: bodies with the same mass, centre of mass and moments of inertia as a given one.

`polhode.RigidBody.equimomental_particles` gives the smallest set of equal particles for any body.
"""

from polhode._core import stick
from polhode._ellipsoid import EquivalentEllipsoid, ellipsoid

__all__ = ["EquivalentEllipsoid", "ellipsoid", "stick"]
