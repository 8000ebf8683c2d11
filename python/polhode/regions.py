"""Regions of space that :meth:`polhode.RigidBody.from_density` integrates a density over.

The boundary of a region is where a density may end with a jump. For a jump inside, take a region on each
side of it and add the bodies.
"""

from polhode._core import Region
from polhode._core import region_ball as ball
from polhode._core import region_box as box
from polhode._core import region_cylinder as cylinder
from polhode._core import region_ellipsoid as ellipsoid
from polhode._core import region_mesh as mesh

__all__ = ["Region", "ball", "box", "cylinder", "ellipsoid", "mesh"]
