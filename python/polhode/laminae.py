"""Homogeneous laminae: sheets without thickness in the x-y plane.

Those known by lengths have their centre of mass at the origin; triangles and polygons stay where their
corners are. Each takes exactly one of ``mass=`` and ``density=``, which is mass per area. Arrays broadcast
to a stack of bodies.
"""

from polhode._core import annulus, disk, ellipse, polygon, rectangle, triangle

__all__ = ["annulus", "disk", "ellipse", "polygon", "rectangle", "triangle"]
