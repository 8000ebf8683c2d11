"""Rates of vectors seen from frames that turn.

Velocities and accelerations of a body's points are methods of the body: `RigidBody.point_velocity`,
`RigidBody.point_acceleration`.
"""

from polhode._core import transport

__all__ = ["transport"]
