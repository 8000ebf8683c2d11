"""Pictures with matplotlib (extra ``plot``). Every function takes ``ax=`` and returns it.

The colours are those of Okabe and Ito, which are distinct for any colour vision. Lines also differ in their
dashes.
"""

from __future__ import annotations

from polhode._scene.style import AXIS_COLORS, MOMENTUM_COLOR, OMEGA_COLOR, OUTLINE_COLOR
from polhode.plot._bodies import body, principal_axes
from polhode.plot._cones import cones
from polhode.plot._ellipsoid import ellipsoid, poinsot, polhode, polhodes
from polhode.plot._flyby import flyby
from polhode.plot._motion import angular_momentum, angular_velocity, euler_angles, invariants
from polhode.plot._portrait import portrait, portraits
from polhode.plot._top import effective_potential, nutation

__all__ = [
    "AXIS_COLORS",
    "MOMENTUM_COLOR",
    "OMEGA_COLOR",
    "OUTLINE_COLOR",
    "angular_momentum",
    "angular_velocity",
    "body",
    "cones",
    "effective_potential",
    "ellipsoid",
    "euler_angles",
    "flyby",
    "invariants",
    "nutation",
    "poinsot",
    "polhode",
    "polhodes",
    "portrait",
    "portraits",
    "principal_axes",
]
