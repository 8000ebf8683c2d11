"""Equimomental systems: particles with the mass, centre of mass and moments of a body.

For the smallest set that any body has see `RigidBody.equimomental_particles`.
"""

from polhode._core import stick

__all__ = ["stick"]
