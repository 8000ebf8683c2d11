"""Homogeneous thin rods, straight and bent, with their centre of mass at the origin.

Each function takes exactly one of ``mass=`` and ``density=``, which is mass per length. Arrays broadcast to a
stack of bodies.
"""

from typing import TYPE_CHECKING

from polhode._core import arc, ring, rod

__all__ = ["arc", "ring", "rod"]

if not TYPE_CHECKING:
    from polhode._hints import explain_calls, no_name

    explain_calls(globals(), __all__)

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        raise no_name(__name__, name, __all__)
