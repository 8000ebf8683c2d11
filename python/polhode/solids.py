"""Homogeneous solids, each with its centre of mass at the origin and its symmetry axis along z.

Each takes exactly one of ``mass=`` and ``density=``; lengths are full lengths unless the name says
radius or semi-axis. Arrays of sizes, masses or densities broadcast to a stack of bodies.
"""

from polhode._core import box, cone, cube, cylinder, ellipsoid, sphere

__all__ = ["box", "cone", "cube", "cylinder", "ellipsoid", "sphere"]
