"""Units of files that state none, and of numbers as the user types them, such as ``"2.7 g/cm^3"``.

A bare number is in the unit that the option states. pint converts, in decimal arithmetic so that 2.7 g/cm^3
is 2700 kg/m^3 to the last digit, and is only loaded where a unit was typed. An amount may have a sigma:
``"5.0 ± 0.1 kg"``, ``"5.0(1) kg"``, ``"5.0 kg ± 2 %"``.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from polhode import _core
from polhode._optional import require
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "METRES",
    "metres_per",
]

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
    """Return the number of metres in one `unit`.

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


_NUMBER: Final = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?"
_QUANTITY: Final = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>\S.*?)?\s*")
_PLUS_MINUS: Final = re.compile(r"±|\+/-|\+-")
_SIGMA: Final = re.compile(
    r"\s*(?P<sigma>\d+\.?\d*(?:[eE][+-]?\d{1,3})?|\.\d+(?:[eE][+-]?\d{1,3})?)\s*(?P<rest>.*?)\s*"
)
_IN_BRACKETS: Final = re.compile(r"\s*\((?P<inner>.*)\)\s*(?P<unit>\S.*?)?\s*")
_LAST_PLACES: Final = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+))\((?P<last>\d+)\)(?P<power>[eE][+-]?\d{1,3})?\s*(?P<unit>\S.*?)?\s*"
)
_SIGMA_EXAMPLE: Final = "1.00 ± 0.01"
_FACTOR: Final = r"[A-Za-zµμ°Å_]+(?:(?:\^|\*\*)?-?[1-9])?"
_BARE_POWER: Final = re.compile(r"(?<=[A-Za-zµμ°Å])(?=-?\d)")
_UNIT: Final = re.compile(rf"(?:1\s*/\s*)?{_FACTOR}(?:\s*[*/ ]\s*{_FACTOR})*")
_SIGNS: Final = str.maketrans({"·": "*", "²": "^2", "³": "^3"})
_HYPHEN: Final = re.compile(r"(?<=[A-Za-z0-9])-(?=[A-Za-z])")
"""As in ``lbf-in-s^2``: a product."""
_WEIGHTS: Final = re.compile(r"\b(lb|oz)\b")
_OWN_UNITS: Final = (
    "rev = turn",
    "lbm = pound",
    "ozm = ounce",
    "pcf = pound / foot ** 3",
    "pci = pound / inch ** 3",
)
"""Units of drawings and printouts, besides those of pint."""
_COUNTS_ANGLES: Final = ("rad", "rad/s")
"""A unit that counts no angle, as ``min^-1``, is no unit of these: it may mean turns as well as radians."""
_EXAMPLES: Final = {
    "kg": "0.3 lb",
    "kg/m^3": "2.7 g/cm^3",
    "m": "5 mm",
    "s": "5.41 d",
    "rad/s": "30 deg/s",
    "m/s^2": "9.81 m/s^2",
    "kg m^2": "12 g cm^2",
    "kg m^2/s": "2.5 N m s",
    "rad": "30 deg",
}


class _Quantity(NamedTuple):
    """A number as it was typed, its unit, and its sigma with the unit of that; None where there is none."""

    number: str
    unit: str | None
    sigma: Decimal | None = None
    sigma_unit: str | None = None


def has_unit(text: str) -> bool:
    """Return whether the number has a unit."""
    typed = _parse(text)
    return typed is not None and typed.unit is not None


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
        If it is no number, has a sigma, is not finite, of another dimension or in a unit that pint does not
        know.
    """
    typed = _parse(text)
    if typed is None:
        raise PolhodeError(
            f"{option}: {text!r} is not a number with or without a unit; write {_example(unit)}"
        )
    if typed.sigma is not None:
        raise PolhodeError(
            f"{option}: {text!r} has a sigma, which {option} does not take; write the number alone"
        )
    return _convert(text, typed, unit, option)


def amount(text: str, unit: str, option: str) -> float | _core.Uncertain:
    """Read a finite number that may have a sigma, both converted to `unit`.

    Parameters
    ----------
    text : str
        As `quantity` takes it, or with a sigma: ``"5.0 ± 0.1 kg"``, with ``+-`` or ``+/-`` as well,
        ``"5.0 kg ± 2 %"``, or ``"5.0(1) kg"`` with the sigma in units of the last place.
    unit, option : str
        See `quantity`.

    Returns
    -------
    float or Uncertain
        The number alone where no sigma was typed.

    Raises
    ------
    PolhodeError
        See `quantity`; also where a sigma has no unit and its number has one.
    """
    typed = _parse(text)
    if typed is None or typed.sigma is None:
        if typed is None and _has_sigma(text):
            raise PolhodeError(
                f"{option}: {text!r} is not a number with a sigma; write {_sigma_examples(unit)}"
            )
        return quantity(text, unit, option)
    if typed.unit is not None and typed.sigma_unit is None:
        raise PolhodeError(
            f"{option}: {text!r}: the sigma has no unit, but its number has one; "
            f"write {_sigma_examples(unit)}"
        )
    value, sigma = _convert(text, typed, unit, option), typed.sigma
    if typed.sigma_unit not in (None, unit):
        sigma *= _factor(str(typed.sigma_unit), unit, option)
    if not _is_held(sigma):
        raise PolhodeError(
            f"{option}: the sigma of {text!r} is beyond the range of numbers; check the exponent"
        )
    return _core.Uncertain(value, float(sigma))


def amounts(texts: Sequence[str], count: int, unit: str, option: str) -> list[float | _core.Uncertain]:
    """Read several numbers that may have sigmas: then with commas between them, and all or none with a unit.

    Parameters
    ----------
    texts : sequence of str
        As `quantities` takes them, or as ``("0, 6.00 ± 0.05, 0.010(2)",)``.
    count, unit, option : int, str, str
        See `quantities` and `amount`.

    Returns
    -------
    list of float or Uncertain
    """
    text = " ".join(texts)
    if not _has_sigma(text):
        return list(quantities(texts, count, unit, option))
    parts = [part.strip() for part in text.strip().strip(",").split(",")]
    if len(parts) != count or len({has_unit(part) for part in parts}) != 1:
        raise PolhodeError(
            f"{option}: expected {count} numbers, with commas between them since {text!r} has a sigma, and "
            f"all or none of them with a unit; for example {', '.join([_SIGMA_EXAMPLE] * count)!r}"
        )
    return [amount(part, unit, option) for part in parts]


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
    return tuple(quantity(part, unit, option) for part in split(texts, count, unit, option))


def vector(texts: Sequence[str], unit: str, option: str) -> tuple[float, float, float]:
    """Read three numbers; see `quantities`."""
    x, y, z = quantities(texts, 3, unit, option)
    return x, y, z


def split_vector(texts: Sequence[str], unit: str, option: str) -> list[str]:
    """Split three numbers, each with its unit, without converting them; see `quantities`."""
    return split(texts, 3, unit, option)


def split(texts: Sequence[str], count: int | None, unit: str, option: str) -> list[str]:
    """Split several numbers, each with its unit, without converting them; see `quantities`.

    Parameters
    ----------
    texts, unit, option
        See `quantities`.
    count : int, optional
        How many there have to be; any number of them without it.
    """
    text = " ".join(texts)
    if _has_sigma(text):
        raise PolhodeError(
            f"{option}: {text!r} has a sigma, which {option} does not take; write the numbers alone"
        )
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
    if count is not None and len(parts) != count:
        raise PolhodeError(
            f"{option}: expected {count} numbers, got {len(parts)} in {text!r}; for example "
            f"{', '.join(['1' if unit == '1' else _example(unit).strip(chr(34))] * count)!r}"
        )
    return parts


def _parse(text: str) -> _Quantity | None:
    """Split a text into a number, its sigma and their units; None if it is no number."""
    if not _has_sigma(text):
        match = _QUANTITY.fullmatch(text)
        return None if match is None else _Quantity(match["number"], match["unit"])
    last = _LAST_PLACES.fullmatch(text)
    if last is not None:
        number, power = last["number"], last["power"] or ""
        place = Decimal(number + power).as_tuple().exponent
        return _Quantity(number + power, last["unit"], Decimal(last["last"]).scaleb(int(place)), last["unit"])
    around = _IN_BRACKETS.fullmatch(text)
    if around is not None:
        inner = _parse(around["inner"])
        if inner is None or inner.unit is not None:
            return None
        return inner._replace(unit=around["unit"], sigma_unit=around["unit"])
    before, *behind = _PLUS_MINUS.split(text)
    match, sigma = _QUANTITY.fullmatch(before), _SIGMA.fullmatch(behind[0]) if len(behind) == 1 else None
    if match is None or sigma is None:
        return None
    number, size, unit = match["number"], Decimal(sigma["sigma"]), match["unit"]
    if sigma["rest"].startswith("%"):
        after = sigma["rest"][1:].strip() or None
        if unit is not None and after is not None:
            return None
        size *= abs(Decimal(number)) / 100
        return _Quantity(number, unit or after, size, unit or after)
    after = sigma["rest"] or None
    return _Quantity(number, unit or after, size, after)


def _has_sigma(text: str) -> bool:
    return _PLUS_MINUS.search(text) is not None or re.search(r"[\d.]\(", text) is not None


def _convert(text: str, typed: _Quantity, unit: str, option: str) -> float:
    value = Decimal(typed.number)
    if typed.unit not in (None, unit):
        value *= _factor(str(typed.unit), unit, option)
    if not _is_held(value):
        raise PolhodeError(f"{option}: {text!r} is beyond the range of numbers; check the exponent")
    return float(value)


def _is_held(number: Decimal) -> bool:
    """Return whether a float can hold a number: no overflow, and no underflow to zero."""
    held = float(number)
    return math.isfinite(held) and (held != 0.0 or number == 0)


def _example(unit: str) -> str:
    if not unit:
        return "1"
    return f'"{_EXAMPLES[unit]}"' if unit in _EXAMPLES else f'"1 {unit}"'


def _sigma_examples(unit: str) -> str:
    if not unit:
        return '"5.0 ± 0.1" or "5.0 ± 2 %"'
    return f'"5.0 ± 0.1 {unit}" or "5.0 {unit} ± 2 %"'


def _factor(text: str, unit: str, option: str) -> Decimal:
    """Return the size of the unit that was typed, in `unit`."""
    pint = require("pint", extra="units", purpose=f"{option}: a unit ({text})")
    plain = _HYPHEN.sub("*", text.translate(_SIGNS))
    if _UNIT.fullmatch(plain) is None:
        raise PolhodeError(f"{option}: {text!r} is not a unit; write {_example(unit)}")
    registry = _registry()
    try:
        given = registry.parse_units(_BARE_POWER.sub("^", plain))
        wanted = registry.parse_units(unit)
        factor = registry.Quantity(Decimal(1), given).to(wanted)
    except pint.UndefinedUnitError:
        raise PolhodeError(f"{option}: {text!r} is not a known unit; write {_example(unit)}") from None
    except pint.DimensionalityError:
        if not unit:
            raise PolhodeError(
                f"{option}: expected a number without a unit, got the unit {text!r}; write the number alone"
            ) from None
        as_force = _WEIGHTS.sub(r"\1f", plain)
        is_force = as_force != plain and registry.parse_units(as_force).is_compatible_with(unit)
        way_out = "lb and oz are masses here; write lbf or ozf" if is_force else f"write {_example(unit)}"
        raise PolhodeError(f"{option}: {text!r} cannot be converted to {unit}; {way_out}") from None
    if unit in _COUNTS_ANGLES and registry.get_root_units(given)[1] != registry.get_root_units(wanted)[1]:
        way_out = "turn/s, rad/s, deg/s or rpm" if unit == "rad/s" else "turn, rad or deg"
        raise PolhodeError(f"{option}: {text!r} does not say what is counted; write {way_out}")
    return Decimal(factor.magnitude)


@cache
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(non_int_type=Decimal)
    for unit in _OWN_UNITS:
        registry.define(unit)
    return registry
