"""``polhode report --expect``: a report held against an earlier one."""

from __future__ import annotations

import json
import math
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._format import with_sigma
from polhode.cli.layout import Cell, Column, Table
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.reading import read_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from polhode.cli.layout import Report

__all__ = ["held_against"]

# What says how the numbers came about, or follows from them but wavers where two moments are nearly equal.
_NOT_COMPARED: Final = frozenset(
    {"axes", "comment", "error_bound", "expected", "file", "format", "gaps", "notes", "provenance", "units"}
    | {"linear", "sigma"}
)

_ROUNDING: Final = 1e-9
"""Of the largest difference of a field: smaller ones are rounding, and so are their sigmas."""


def held_against(report: Report, expected: Path, rtol: float) -> list[dict[str, Any]]:
    """Compare the numbers of a report with those of a file, and add what was found to the report.

    Parameters
    ----------
    report : Report
        Gets a section on it.
    expected : pathlib.Path
        JSON with the keys of the report, all or some of them.
    rtol : float
        Relative to the largest component; a centre of mass also to the largest radius of gyration.

    Returns
    -------
    list of dict
        What differs, a row each.
    """
    if not (math.isfinite(rtol) and rtol >= 0.0):
        raise PolhodeError(f"--rtol: {rtol:g} is not a tolerance; give a number such as 1e-6")
    known = _read(expected)
    ours = report.as_dict()
    known_units, our_units = dict(_leaves(known.get("units", {}))), dict(_leaves(ours["units"]))
    length = max(ours["radii_of_gyration"])
    found, compared = [], 0
    flat = dict(_leaves(ours))
    our_sigmas, known_sigmas = (dict(_leaves(_object(one, "sigma"))) for one in (ours, known))
    for key, value in _leaves(known):
        if key.partition(".")[0] in _NOT_COMPARED:
            continue
        if key not in flat:
            near = get_close_matches(key, flat, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else "; take fields of --format json"
            raise PolhodeError(f"--expect: {expected}: the report has no field {key[:60]!r}{hint}")
        unit = our_units.get(key, "")
        if known_units.get(key, unit) != unit:
            raise PolhodeError(
                f"--expect: {expected}: {key} is in {known_units[key]!r}, the report's in {unit!r}; "
                "use the same --length-unit"
            )
        compared += 1
        difference = _difference(flat[key], value, length if key == "center_of_mass" else 0.0)
        if not difference <= rtol:
            row = {"field": key, "found": flat[key], "expected": _shown(value), "difference": difference}
            found.append(row | _beside_sigma(flat[key], value, our_sigmas.get(key), known_sigmas.get(key)))
    if not compared:
        raise PolhodeError(f"--expect: {expected} holds no field of the report; save one with --format json")
    columns = [
        Column("field", "field"),
        Column("found", "found"),
        Column("expected", "expected"),
        Column("difference", "relative difference"),
    ]
    if any("in_sigmas" in row for row in found):
        columns.append(Column("in_sigmas", "difference ± its sigma"))
        report.notes.append(
            "the sigma of a difference takes those of the two reports as independent: what comes from one "
            "source in both is not in a saved report; RigidBody.covariance_with tells it in Python"
        )
    if found:
        report.section("differs from what was expected", Table("differences", columns, found))
    verdict = f"{len(found)} of {compared} fields differ" if found else f"{compared} fields agree"
    report.notes.append(f"{verdict} with {expected} within {rtol:g}")
    return found


def _object(document: dict[str, Any], key: str) -> dict[str, Any]:
    value = document.get(key, {})
    return value if isinstance(value, dict) else {}


def _beside_sigma(ours: Any, theirs: Any, sigma: Any, other: Any) -> dict[str, Any]:
    """Give the component that differs by the most of its sigmas, where one of the two reports has sigmas."""
    if sigma is None and other is None:
        return {}
    try:
        difference = np.atleast_1d(np.asarray(ours, float) - np.asarray(theirs, float))
        zero = np.zeros_like(difference)
        deviations = [zero if one is None else np.asarray(one, float) for one in (sigma, other)]
        joint = np.broadcast_to(np.hypot(*deviations), difference.shape)
    except (TypeError, ValueError, OverflowError):
        return {}
    sizes = np.abs(difference)
    sizes[sizes < _ROUNDING * sizes.max(initial=0.0)] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        worst = int(np.argmax(np.nan_to_num(sizes / joint).ravel()))
    d, s = float(difference.flat[worst]), float(joint.flat[worst])
    return {"in_sigmas": Cell(with_sigma(d, s), {"difference": d, "sigma": s})}


def _read(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(read_text(path, "JSON"))
    except FileFormatError as error:
        raise FileFormatError(f"--expect: {error}; save one with --format json") from None
    except (ValueError, RecursionError) as error:
        message = f"--expect: {path} is not JSON ({error}); save one with --format json"
        raise FileFormatError(message) from None
    if not isinstance(document, dict) or not isinstance(document.get("units", {}), dict):
        raise FileFormatError(f"--expect: {path} holds no object of fields; save one with --format json")
    try:
        list(_leaves(document))
    except RecursionError:
        raise FileFormatError(
            f"--expect: {path}: its fields are nested beyond reason; save one with --format json"
        ) from None
    return document


def _leaves(value: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, item in value.items():
        if isinstance(item, dict):
            yield from _leaves(item, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", item


def _shown(value: Any) -> Any:
    """Give what was expected as it is, or as text where it is no array."""
    try:
        np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return value if isinstance(value, str) else json.dumps(value)[:60]
    return value


def _difference(ours: Any, theirs: Any, size: float) -> float:
    """Largest difference, relative to the largest component; infinite between values of different kinds."""
    if isinstance(ours, str) or isinstance(theirs, str) or ours is None or theirs is None:
        return 0.0 if ours == theirs else math.inf
    try:
        a, b = np.asarray(ours, dtype=np.float64), np.asarray(theirs, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return 0.0 if ours == theirs else math.inf
    if a.shape != b.shape:
        return math.inf
    largest = max(float(np.abs(b).max(initial=0.0)), size)
    difference = float(np.abs(a - b).max(initial=0.0))
    return difference / largest if largest > 0.0 else (0.0 if difference == 0.0 else math.inf)
