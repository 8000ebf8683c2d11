"""Regions of space, over which :meth:`polhode.RigidBody.from_density` integrates a density.

A density may jump at the boundary of its region. For a jump inside, take one region on each side of it and
add the two bodies.
"""

from polhode._core import Region
from polhode._core import region_ball as ball
from polhode._core import region_box as box
from polhode._core import region_cylinder as cylinder
from polhode._core import region_ellipsoid as ellipsoid
from polhode._core import region_mesh as mesh

__all__ = ["Region", "ball", "box", "cylinder", "ellipsoid", "mesh"]
