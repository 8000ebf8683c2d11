"""Rates of change of vectors in rotating frames.

For velocity and acceleration of a point of a body see `polhode.RigidBody.point_velocity` and
`polhode.RigidBody.point_acceleration`.
"""

from typing import TYPE_CHECKING

from polhode._core import transport

__all__ = ["transport"]

if not TYPE_CHECKING:

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        from polhode._hints import no_name

        raise no_name(__name__, name, __all__)
