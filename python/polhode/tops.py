"""Symmetric tops: precession and nutation damping of a free top, and steady motions of a heavy top.

I_s is the moment about the symmetry axis and I_t that about an axis across it. For a free top both axes pass
through the centre of mass (or a fixed point), for a heavy top through the pivot, which is the origin of the
body frame.
"""

from polhode._core import free_precession, least_spin, nutation_damping, steady_precession
from polhode._tops import NutationDamping

__all__ = ["NutationDamping", "free_precession", "least_spin", "nutation_damping", "steady_precession"]
