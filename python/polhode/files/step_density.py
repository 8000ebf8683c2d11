"""Densities that a STEP file states, with their units, as numbers in kg/m^3.

OCCT reads the number of a density and passes over parts of its unit; here the unit is followed through the
entities of the text. Where that does not succeed there is no density, rather than a wrong one.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["densities_of"]

_ENTITY: Final = re.compile(r"\s*#(\d+)\s*=(.*)", re.DOTALL)
_MEASURE: Final = re.compile(
    r"MEASURE_REPRESENTATION_ITEM\s*\(\s*'([^']*)'\s*,\s*\w+\s*\(\s*([-+.\dEe]+)\s*\)\s*,\s*#(\d+)",
    re.IGNORECASE,
)
_ELEMENT: Final = re.compile(r"DERIVED_UNIT_ELEMENT\s*\(\s*#(\d+)\s*,\s*([-+.\dEe]+)\s*\)", re.IGNORECASE)
_SI: Final = re.compile(r"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.(\w+)\.\s*\)", re.IGNORECASE)
_PREFIXES: Final = {"": 1.0, "KILO": 1e3, "DECI": 1e-1, "CENTI": 1e-2, "MILLI": 1e-3, "MICRO": 1e-6}
_BASES: Final = {"GRAM": 1e-3, "METRE": 1.0}
_OF_OCCT: Final = {("GRAM", 1e-3, 3.0), ("METRE", 1e-2, 2.0)}
"""OCCT itself writes g/cm^3 with these powers."""


def densities_of(text: str) -> list[float] | None:
    """Give the densities of a file, each once and ascending; None where a unit is not understood.

    Parameters
    ----------
    text : str
        The whole file.
    """
    measures = [found[1:] for found in _MEASURE.findall(text) if "density" in found[0].lower()]
    if not measures:
        return []
    entities = dict(_entities(text))
    found = set()
    for value, unit in measures:
        scale = _unit(unit, entities)
        if scale is None:
            return None
        found.add(float(value) * scale)
    return sorted(found)


def _entities(text: str) -> Iterator[tuple[str, str]]:
    """Return the number of each entity and what it is; a semicolon within quotes ends none."""
    pieces: list[str] = []
    for place, piece in enumerate(text.split("'")):
        first, *others = piece.split(";") if place % 2 == 0 else (piece,)
        pieces.append(first)
        for other in others:
            if (found := _ENTITY.fullmatch("'".join(pieces))) is not None:
                yield found[1], found[2]
            pieces = [other]


def _unit(number: str, entities: dict[str, str]) -> float | None:
    """Kilograms per cubic metre in one of a unit."""
    parts = set()
    for reference in re.findall(r"#(\d+)", entities.get(number, "")):
        element = _ELEMENT.search(entities.get(reference, ""))
        si = _SI.search(entities.get(element[1], "")) if element else None
        if element is None or si is None or si[2].upper() not in _BASES:
            return None
        prefix, base = (si[1] or "").upper(), si[2].upper()
        if prefix not in _PREFIXES:
            return None
        parts.add((base, _PREFIXES[prefix] * _BASES[base], float(element[2])))
    if parts == _OF_OCCT:
        return 1000.0
    powers = {base: power for base, _, power in parts}
    if len(parts) != 2 or powers != {"GRAM": 1.0, "METRE": -3.0}:
        return None
    scale = 1.0
    for _, size, power in parts:
        scale *= size**power
    return scale
