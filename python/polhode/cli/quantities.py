"""Numbers with units, as they are typed: ``2700``, ``"2.7 g/cm^3"``, ``0 0 1``, ``"10 20 30 deg/s"``.

A bare number is in the unit that the option states. pint converts, in decimal arithmetic so that 2.7 g/cm^3
is 2700 kg/m^3 to the last digit, and is only loaded where a unit was typed.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING, Any, Final

from polhode._extras import require
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["has_unit", "quantities", "quantity", "split_vector", "vector"]

_NUMBER: Final = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
_QUANTITY: Final = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>\S.*?)?\s*")
_FACTOR: Final = r"[A-Za-zµμ°Å_]+(?:(?:\^|\*\*)?-?\d)?"
_BARE_POWER: Final = re.compile(r"(?<=[A-Za-zµμ°Å])(?=-?\d)")
_UNIT: Final = re.compile(rf"(?:1\s*/\s*)?{_FACTOR}(?:\s*[*/· ]\s*{_FACTOR})*")
_FREQUENCIES: Final = re.compile(r"[kMG]?Hz|hertz|1\s*/.*|cps")
_EXAMPLES: Final = {
    "kg": "0.3 lb",
    "kg/m^3": "2.7 g/cm^3",
    "m": "5 mm",
    "s": "5.41 d",
    "rad/s": "30 deg/s",
    "m/s^2": "9.81 m/s^2",
    "kg m^2": "12 g cm^2",
    "rad": "30 deg",
}


def has_unit(text: str) -> bool:
    """Tell whether the number has a unit."""
    match = _QUANTITY.fullmatch(text)
    return match is not None and match["unit"] is not None


def quantity(text: str, unit: str, option: str) -> float:
    """Read a finite number, converted to `unit`.

    Parameters
    ----------
    text : str
        A number, bare or with a unit of the same dimension.
    unit : str
        What it is converted to, and what a bare number is in.
    option : str
        Named in what goes wrong.

    Returns
    -------
    float

    Raises
    ------
    PolhodeError
        If it is no number, not finite, of another dimension or in a unit that pint does not know.
    """
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise PolhodeError(
            f"{option}: {text!r} is not a number with or without a unit; write {_example(unit)}"
        )
    value = float(match["number"])
    if match["unit"] not in (None, unit):
        value = float(Decimal(match["number"]) * _factor(match["unit"], unit, option))
    if not math.isfinite(value):
        raise PolhodeError(f"{option}: {text!r} is beyond the range of numbers; check the exponent")
    return value


def quantities(texts: Sequence[str], count: int, unit: str, option: str) -> tuple[float, ...]:
    """Read several numbers: each with its own unit, separated by commas, or with one unit after the last.

    Parameters
    ----------
    texts : sequence of str
        ``("0", "0", "1")``, ``("0 0 1 deg/s",)``, ``("5.41 d, 7.35 d",)``.
    count : int
        How many there have to be.
    unit, option : str
        See `quantity`.

    Returns
    -------
    tuple of float
    """
    return tuple(quantity(part, unit, option) for part in _split(texts, count, unit, option))


def vector(texts: Sequence[str], unit: str, option: str) -> tuple[float, float, float]:
    """Read three numbers; see `quantities`."""
    x, y, z = quantities(texts, 3, unit, option)
    return x, y, z


def split_vector(texts: Sequence[str], unit: str, option: str) -> list[str]:
    """Split three numbers, each with its unit, without converting them; see `quantities`."""
    return _split(texts, 3, unit, option)


def _split(texts: Sequence[str], count: int, unit: str, option: str) -> list[str]:
    text = " ".join(texts)
    if "," in text:
        parts = [part.strip() for part in text.strip().strip(",").split(",")]
        last = _QUANTITY.fullmatch(parts[-1])
        if last is not None and last["unit"] and not any(has_unit(part) for part in parts[:-1]):
            parts = [f"{part} {last['unit']}" for part in parts[:-1]] + [parts[-1]]
    else:
        words = text.split()
        numbers = [word for word in words if re.fullmatch(_NUMBER, word)]
        behind = " ".join(words[len(numbers) :])
        parts = [f"{number} {behind}" for number in numbers] if numbers else [text]
    if len(parts) != count:
        raise PolhodeError(
            f"{option}: expected {count} numbers, got {len(parts)} in {text!r}; for example "
            f"{', '.join([_example(unit).strip(chr(34))] * count)!r}"
        )
    return parts


def _example(unit: str) -> str:
    return f'"{_EXAMPLES[unit]}"' if unit in _EXAMPLES else f'"1 {unit}"'


def _factor(text: str, unit: str, option: str) -> Decimal:
    """Give the size of the unit that was typed, in `unit`."""
    if unit == "rad/s" and _FREQUENCIES.fullmatch(text):
        raise PolhodeError(
            f"{option}: {text!r} does not say what is counted; write turn/s, rad/s, deg/s or rpm"
        )
    pint = require("pint", extra="units", purpose=f"{option}: a unit ({text})")
    if _UNIT.fullmatch(text) is None:
        raise PolhodeError(f"{option}: {text!r} is not a unit; write {_example(unit)}")
    registry = _registry()
    try:
        given = registry.parse_units(_BARE_POWER.sub("^", text))
        factor = registry.Quantity(Decimal(1), given).to(registry.parse_units(unit))
    except pint.UndefinedUnitError:
        raise PolhodeError(f"{option}: {text!r} is not a known unit; write {_example(unit)}") from None
    except pint.DimensionalityError:
        message = f"{option}: {text!r} cannot be converted to {unit}; write {_example(unit)}"
        raise PolhodeError(message) from None
    return Decimal(factor.magnitude)


@cache
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(non_int_type=Decimal)
    registry.define("rev = turn")
    return registry
