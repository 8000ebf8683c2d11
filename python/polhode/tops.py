"""Symmetric tops: how a free one precesses and loses its nutation, and what a heavy one may do steadily.

Moments are named after the symmetry axis, I_s along it and I_t across it: for the free top through the
centre of mass (or a fixed point), for the heavy top through the pivot, the origin of the body frame.
"""

from polhode._core import free_precession, least_spin, nutation_damping, steady_precession

__all__ = ["free_precession", "least_spin", "nutation_damping", "steady_precession"]
