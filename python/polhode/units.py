"""Units of length, for files that do not state one."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from polhode.errors import PolhodeError

__all__ = ["METRES", "metres_per"]

METRES: Final = MappingProxyType(
    {
        "m": 1.0,
        "mm": 1e-3,
        "cm": 1e-2,
        "um": 1e-6,
        "nm": 1e-9,
        "km": 1e3,
        "in": 0.0254,
        "ft": 0.3048,
        "angstrom": 1e-10,
    }
)
"""Metres in one of each unit; all exact by definition (inch and foot: international, 1959)."""


def metres_per(unit: str) -> float:
    """Give the number of metres in one `unit`.

    Parameters
    ----------
    unit : str
        One of ``m mm cm um nm km in ft angstrom``.

    Returns
    -------
    float

    Raises
    ------
    PolhodeError
        If the unit is not known.

    Examples
    --------
    >>> from polhode.units import metres_per
    >>> metres_per("in")
    0.0254
    """
    try:
        return METRES[unit]
    except KeyError:
        message = f"length_unit: {unit!r} is not a known unit; use one of {', '.join(METRES)}"
        raise PolhodeError(message) from None
