"""Results as JSON: what ``Identified.save`` writes and ``Identified.from_file`` reads."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._core import RigidBody, Uncertain
from polhode.errors import FileFormatError
from polhode.identify.results import Direction, Identified
from polhode.io.records import (
    WORDS,
    check_names,
    in_json,
    numbers,
    read_record,
    require_field,
    write_json,
)
from polhode.io.saved import BODY_FIELDS, body_fields, body_of
from polhode.results import State

if TYPE_CHECKING:
    from os import PathLike

__all__ = ["read_identified", "save_identified"]

_FORMAT: Final = "polhode.Identified/1"
_ARRAYS: Final = ("estimate", "covariance", "crlb", "residuals")
_NUMBERS: Final = ("chi2", "degrees_of_freedom", "p_value", "gap")
_TRUTHS: Final = ("at_edge", "linear", "scale_known")
_OTHERS: Final = (
    "body", "parameters", "noise", "bias", "observability", "dropped", "window", "start", "start_covariance",
    "rotor", "alternatives",
)  # fmt: skip
_FIELDS: Final = (*_ARRAYS, *_NUMBERS, *_TRUTHS, *_OTHERS)
_STATE: Final = ("omega", "attitude")


def save_identified(found: Identified, path: str | PathLike[str]) -> None:
    """Write a result as JSON: what ``Identified.save`` does."""
    file = Path(path)
    if file.suffix.lower() != ".json":
        raise ValueError(f"path: {file} does not end in .json; name it so")
    write_json(file, {"format": _FORMAT} | _fields(found, file))


def read_identified(path: str | PathLike[str]) -> Identified:
    """Read a result that ``Identified.save`` wrote."""
    file = Path(path)
    if file.suffix.lower() != ".json":
        raise ValueError(f"path: {file} does not end in .json; the result of an identification is JSON")
    return _result(read_record(file, _FORMAT, _FIELDS), file)


def _fields(found: Identified, file: Path) -> dict[str, Any]:
    fields: dict[str, Any] = {"body": in_json(body_fields(found.body), file)}
    fields["parameters"] = list(found.parameters)
    fields |= in_json({name: getattr(found, name) for name in _ARRAYS}, file)
    for name in _NUMBERS:
        value = getattr(found, name)
        fields[name] = None if isinstance(value, float) and math.isnan(value) else value
    fields |= {name: bool(getattr(found, name)) for name in _TRUTHS}
    for name in ("noise", "bias"):
        value = getattr(found, name)
        if value is not None:
            both = {"value": np.asarray(value.value), "covariance": np.asarray(value.covariance)}
            fields[name] = in_json(both, file)
    fields["observability"] = [
        {
            "words": one.words,
            "parameters": one.parameters.tolist(),
            "relative": None if math.isinf(one.relative) else one.relative,
            "sigma": None if math.isinf(one.sigma) else one.sigma,
            "remedy": one.remedy,
        }
        for one in found.observability
    ]
    fields["dropped"] = dict(found.dropped)
    if found.window is not None:
        fields["window"] = found.window
    if found.start is not None:
        fields["start"] = {name: getattr(found.start, name).tolist() for name in _STATE}
        rotor = getattr(found.motion, "rotor", None)
        if rotor is not None:
            fields["rotor"] = np.asarray(rotor).tolist()
    if found.start_covariance is not None:
        fields["start_covariance"] = in_json({"_": found.start_covariance}, file)["_"]
    if found.alternatives:
        fields["alternatives"] = [_fields(one, file) for one in found.alternatives]
    return fields


def _result(fields: dict[str, Any], file: Path) -> Identified:
    def need(name: str) -> Any:
        return require_field(fields, name, file)

    def wrong(name: str, expected: str) -> FileFormatError:
        return FileFormatError(f"{file}: {name} is not {expected}; save it again")

    if not isinstance(need("body"), dict):
        raise wrong("body", "an object with the fields of a body")
    check_names(fields["body"], (*BODY_FIELDS, *WORDS), f"{file}: body")
    body = body_of(fields["body"], file)
    names = need("parameters")
    if not isinstance(names, list) or not all(isinstance(one, str) for one in names):
        raise wrong("parameters", "a list of names")
    n = len(names)
    arrays = {name: numbers(need(name), name, file, with_holes=True) for name in _ARRAYS}
    for name, shape in {"estimate": (n,), "covariance": (n, n), "crlb": (n, n)}.items():
        if arrays[name].shape != shape:
            raise FileFormatError(f"{file}: {name} has shape {arrays[name].shape}, expected {shape}")
    told: dict[str, Any] = {}
    for name in _NUMBERS:
        value = need(name)
        told[name] = math.nan if value is None else _number(value, name, file)
    if not told["degrees_of_freedom"].is_integer():
        raise wrong("degrees_of_freedom", "a whole number")
    told["degrees_of_freedom"] = int(told["degrees_of_freedom"])
    for name in _TRUTHS:
        told[name] = need(name)
        if not isinstance(told[name], bool):
            raise wrong(name, "true or false")
    for name in ("noise", "bias"):
        told[name] = _uncertain(fields, name, file)
    dropped = need("dropped")
    if not isinstance(dropped, dict) or not all(isinstance(one, int) for one in dropped.values()):
        raise wrong("dropped", "an object of counts")
    window = fields.get("window")
    if window is not None and (isinstance(window, bool) or not isinstance(window, int)):
        raise wrong("window", "a whole number")
    lists = {"observability": need("observability"), "alternatives": fields.get("alternatives", [])}
    for name, value in lists.items():
        if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
            raise wrong(name, "a list of objects")
    for one in lists["alternatives"]:
        check_names(one, (*_FIELDS, *WORDS), f"{file}: alternatives")
    start, motion = None, None
    if "start" in fields:
        given = fields["start"]
        if not isinstance(given, dict) or set(given) != set(_STATE):
            raise wrong("start", "an object with omega and attitude")
        omega, attitude = (numbers(given[name], name, file) for name in _STATE)
        start = State(omega, attitude, np.zeros(3), np.zeros(3))
        rotor = numbers(fields["rotor"], "rotor", file) if "rotor" in fields else None
        try:
            motion = (
                body.free_motion(omega, attitude)
                if rotor is None
                else _certain(body).gyrostat(rotor).free_motion(omega, attitude)
            )
        except ValueError as error:
            raise FileFormatError(f"{file}: {error}") from error
    spread = fields.get("start_covariance")
    if spread is not None:
        spread = numbers(spread, "start_covariance", file, with_holes=True)
    return Identified(
        body=body, parameters=tuple(names), **arrays, **told, dropped=dropped, window=window,
        observability=tuple(_direction(one, file) for one in lists["observability"]),
        start=start, motion=motion,
        start_covariance=spread,
        alternatives=tuple(_result(one, file) for one in lists["alternatives"]),
    )  # fmt: skip


def _number(value: Any, name: str, file: Path) -> float:
    found = numbers(value, name, file)
    if found.shape != ():
        raise FileFormatError(f"{file}: {name} has shape {found.shape}, expected one number")
    return float(found)


def _certain(body: RigidBody) -> RigidBody:
    """Return the body without sigmas, which are not followed through the motion of a gyrostat."""
    return RigidBody(mass=float(body.mass), inertia=body.inertia, center_of_mass=body.center_of_mass)


def _uncertain(fields: dict[str, Any], name: str, file: Path) -> Uncertain | None:
    given = fields.get(name)
    if given is None:
        return None
    if not isinstance(given, dict) or set(given) != {"value", "covariance"}:
        raise FileFormatError(f"{file}: {name} is not an object with value and covariance; save it again")
    value, covariance = (numbers(given[part], f"{name}.{part}", file) for part in ("value", "covariance"))
    try:
        return Uncertain(value, covariance=covariance)
    except ValueError as error:
        raise FileFormatError(f"{file}: {name}: {error}") from error


def _direction(given: dict[str, Any], file: Path) -> Direction:
    known = ("words", "parameters", "relative", "sigma", "remedy")
    check_names(given, known, f"{file}: observability")
    words, remedy = (require_field(given, name, file) for name in ("words", "remedy"))
    if not isinstance(words, str) or not isinstance(remedy, str):
        raise FileFormatError(f"{file}: observability: words and remedy are not text; save it again")
    change = numbers(require_field(given, "parameters", file), "observability.parameters", file)
    if change.ndim != 1:
        raise FileFormatError(f"{file}: observability.parameters has shape {change.shape}, expected (P,)")
    sizes = (require_field(given, name, file) for name in ("sigma", "relative"))
    sigma, relative = (math.inf if one is None else _number(one, "observability", file) for one in sizes)
    return Direction(words, change, sigma, relative, remedy)
