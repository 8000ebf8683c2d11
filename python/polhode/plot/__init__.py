"""Pictures with matplotlib (extra ``plot``). Every function takes ``ax=`` and returns it.

Colours are those of Okabe and Ito, which readers with any colour vision can tell apart; lines differ in
their dashes too.
"""

from __future__ import annotations

from polhode.plot._bodies import body, principal_axes
from polhode.plot._motion import angular_velocity
from polhode.plot._style import AXIS_COLORS, MOMENTUM_COLOR, OMEGA_COLOR, OUTLINE_COLOR

__all__ = [
    "AXIS_COLORS",
    "MOMENTUM_COLOR",
    "OMEGA_COLOR",
    "OUTLINE_COLOR",
    "angular_velocity",
    "body",
    "principal_axes",
]
