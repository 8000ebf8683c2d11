"""Homogeneous laminae: sheets without thickness in the x-y plane.

Laminae that are given by lengths have their centre of mass at the origin. Triangles and polygons are where
their corners are. Each function takes exactly one of ``mass=`` and ``density=``, which is mass per area.
Arrays broadcast to a stack of bodies.
"""

from typing import TYPE_CHECKING

from polhode._core import annulus, disk, ellipse, polygon, rectangle, triangle

__all__ = ["annulus", "disk", "ellipse", "polygon", "rectangle", "triangle"]

if not TYPE_CHECKING:
    from polhode._hints import explain_calls, no_name

    explain_calls(globals(), __all__)

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        raise no_name(__name__, name, __all__)
