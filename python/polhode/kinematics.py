"""Rates of change of vectors in rotating frames.

For velocity and acceleration of a point of a body see `polhode.RigidBody.point_velocity` and
`polhode.RigidBody.point_acceleration`.
"""

from polhode._core import transport

__all__ = ["transport"]
