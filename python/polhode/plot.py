"""Pictures with matplotlib (extra ``plot``).

A function draws into the axes that are given as ``ax=``, by default into those of a new figure, and returns
the axes. There are two exceptions: `portraits` draws a row of pictures, always in a new figure, and returns
an array of axes; `principal_axes` adds to a picture, so its ``ax`` must be given.

The colours are those of Okabe and Ito, which are distinct for any colour vision. Lines also differ in their
dashes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from polhode.draw.plot.bodies import body, principal_axes
from polhode.draw.plot.cones import cones
from polhode.draw.plot.ellipsoid import ellipsoid, poinsot, polhode, polhodes
from polhode.draw.plot.flyby import flyby
from polhode.draw.plot.motion import angular_momentum, angular_velocity, euler_angles, invariants
from polhode.draw.plot.portrait import portrait, portraits
from polhode.draw.plot.rolling import contact, rolling
from polhode.draw.plot.top import effective_potential, nutation
from polhode.draw.style import AXIS_COLORS, MOMENTUM_COLOR, OMEGA_COLOR, OUTLINE_COLOR

__all__ = [
    "AXIS_COLORS",
    "MOMENTUM_COLOR",
    "OMEGA_COLOR",
    "OUTLINE_COLOR",
    "angular_momentum",
    "angular_velocity",
    "body",
    "cones",
    "contact",
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
    "rolling",
]

if not TYPE_CHECKING:

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        from polhode._hints import no_name

        raise no_name(__name__, name, __all__)
