"""Rates of change of vectors in rotating frames, and of attitudes that are known at some times.

For velocity and acceleration of a point of a body see `polhode.RigidBody.point_velocity` and
`polhode.RigidBody.point_acceleration`.
"""

from typing import TYPE_CHECKING

from polhode._core import transport
from polhode.motion.rates import angular_acceleration, angular_velocity, quaternion

__all__ = ["angular_acceleration", "angular_velocity", "quaternion", "transport"]

if not TYPE_CHECKING:

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        from polhode._hints import no_name

        raise no_name(__name__, name, __all__)
