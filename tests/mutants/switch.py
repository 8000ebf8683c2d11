"""Which mutant lives, asked of the switch in the extension. This file is no part of the package."""

from __future__ import annotations

import ctypes

from polhode import _core

SWITCH = ctypes.CDLL(_core.__file__)


def lives(number: int) -> bool:
    """Whether this mutant lives; it is noted that somebody asked."""
    return bool(SWITCH.polhode_mutant_asked(number) & 1)
