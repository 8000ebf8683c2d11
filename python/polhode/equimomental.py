"""Equimomental systems: other bodies with the mass, centre of mass and moments of a body.

For the smallest set of particles that any body has see `RigidBody.equimomental_particles`.
"""

from polhode._core import stick
from polhode._ellipsoid import EquivalentEllipsoid, ellipsoid

__all__ = ["EquivalentEllipsoid", "ellipsoid", "stick"]
