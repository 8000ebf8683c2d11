"""The colours and dashes that pictures, moving pictures and windows share."""

from __future__ import annotations

from typing import Final

__all__ = [
    "AXIS_COLORS",
    "AXIS_DASHES",
    "CONTACT_COLOR",
    "DISC_COLOR",
    "INSIDE_COLOR",
    "MOMENTUM_COLOR",
    "OMEGA_COLOR",
    "OUTLINE_COLOR",
    "RIM_COLOR",
]

AXIS_COLORS: Final = ("#0072B2", "#D55E00", "#009E73")
"""Blue, vermilion and bluish green: first, second and third axis."""
AXIS_DASHES: Final = ("--", "-", "-.")
"""Dashes of lines in those colours."""
OMEGA_COLOR: Final = "#B0479A"
"""Reddish purple: the angular velocity."""
MOMENTUM_COLOR: Final = "#111111"
"""Nearly black: the angular momentum."""
CONTACT_COLOR: Final = "#C27400"
"""Dark orange: where a body that rolls touches its plane."""
INSIDE_COLOR: Final = "#7A4A00"
"""Colour of the momentum inside the body."""
DISC_COLOR: Final = "#F6EAD2"
"""Colour of a wheel's face; its spokes have the colour of the momentum inside the body."""
RIM_COLOR: Final = "#D9BF8F"
"""Colour of a wheel's rim."""
OUTLINE_COLOR: Final = (0.17, 0.18, 0.22)
"""Red, green and blue of a body's edges."""
