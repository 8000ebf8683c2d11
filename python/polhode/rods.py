"""Homogeneous thin rods, straight and bent, with their centre of mass at the origin.

Each takes exactly one of ``mass=`` and ``density=``, which is mass per length. Arrays broadcast to a stack of
bodies.
"""

from polhode._core import arc, ring, rod

__all__ = ["arc", "ring", "rod"]
