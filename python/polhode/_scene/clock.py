"""How fast a moving picture runs beside the motion itself."""

from __future__ import annotations

from typing import Final

import numpy as np

__all__ = ["SECONDS", "pace"]

SECONDS: Final = {
    "ns": 1e-9, "µs": 1e-6, "us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0,
    "day": 86400.0, "days": 86400.0, "yr": 31557600.0,
}  # fmt: skip
"""In the units of time whose length a page knows."""
_REAL: Final = (2.0, 300.0)
"""Seconds of a motion that is shown in real time."""
_FINEST: Final = np.array([1.0, 2.0, 5.0, 10.0])


def pace(length: float, wished: float, least: float, time_unit: str) -> float:
    """Give the seconds on the screen of a motion: its own, or those of slow or fast motion by a round number.

    Parameters
    ----------
    length : float
        Of the motion, in units of time.
    wished : float
        Seconds on the screen where real time cannot be watched.
    least : float
        Seconds below which pictures would be too far from each other.
    time_unit : str
        One that is not known has no real time: the motion takes the seconds wished.
    """
    unit = SECONDS.get(time_unit)
    if unit is None or not length > 0.0:
        return wished
    real = length * unit
    if least <= real and _REAL[0] <= real <= _REAL[1]:
        return real
    factor = real / wished  # as many times real time
    decade = 10.0 ** np.floor(np.log10(factor))
    if not 0.0 < decade < np.inf:
        return wished
    if factor < 1.0:  # one part in a round number
        parts = 1.0 / factor
        decade = 10.0 ** np.floor(np.log10(parts))
        return real * float(decade * _FINEST[_FINEST * decade >= parts * (1.0 - 1e-9)][0])
    return real / float(decade * _FINEST[_FINEST * decade <= factor * (1.0 + 1e-9)][-1])
