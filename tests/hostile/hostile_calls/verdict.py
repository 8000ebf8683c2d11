"""What may come of a call: a result that obeys the laws, or an error that the contract names."""

from __future__ import annotations

import dataclasses
import math
import pickle
from typing import Any

import numpy as np
import polhode
from polhode import _core

from .spoilt import Planned

ERRORS = (ValueError, TypeError, MemoryError, IndexError, Planned)
"""Every error of polhode is a ValueError."""

TOLD_BY_NUMPY = ("Casting complex values", "Warning: converting a masked element")
"""How the warnings begin by which NumPy itself tells what a scalar of another kind loses."""


class Wrong(AssertionError):  # noqa: N818
    """A call did what the contract forbids."""


def fingerprint(result: Any) -> Any:
    """All bits of a result."""
    match result:
        case None | bool() | str() | bytes() | int():
            return result
        case float() | np.number():
            return float(result).hex()
        case np.ndarray():
            if result.dtype.kind == "f":
                return (
                    result.shape,
                    np.ascontiguousarray(np.where(np.isnan(result), np.nan, result)).tobytes(),
                )
            return (result.shape, result.tobytes() if result.dtype.kind != "O" else repr(result))
        case polhode.RigidBody():
            return tuple(map(fingerprint, _numbers(result)))
        case polhode.FreeMotion():
            return (
                fingerprint(result.body),
                fingerprint(result.omega),
                fingerprint(result.quaternion),
                fingerprint(result.modulus),
            )
        case polhode.HeavyTop():
            return (
                fingerprint(result.nutation_limits),
                fingerprint(result.mean_spin),
                fingerprint(result.omega),
            )
        case polhode.MassAccumulator():
            return pickle.dumps(result)
        case _core.Load() | _core.Region() | _core.Surface() | _core.RuledSurface() | _core.Contact():
            return repr(result)
        case dict():
            return {key: fingerprint(value) for key, value in result.items()}
        case tuple() | list():
            return tuple(map(fingerprint, result))
    if dataclasses.is_dataclass(result):
        return tuple(fingerprint(getattr(result, f.name)) for f in dataclasses.fields(result) if f.compare)
    return type(result).__name__


def _numbers(body: polhode.RigidBody) -> tuple[Any, ...]:
    bound = body.error_bound
    return (
        body.mass, body.center_of_mass, body.inertia, body.principal_moments, body.principal.axes,
        bound.mass, bound.center_of_mass, bound.inertia,
    )  # fmt: skip


def obeys(result: Any) -> None:
    """Ask a result for all it knows, and check that bodies are bodies.

    Raises
    ------
    Wrong
        When a body breaks a law.
    """
    match result:
        case polhode.RigidBody():
            _is_body(result)
        case polhode.FreeMotion() | polhode.HeavyTop() | polhode.MassAccumulator():
            for name in dir(result):
                if not name.startswith("_") and not callable(getattr(result, name)):
                    getattr(result, name)
        case _core.Load():
            repr(result), result.shape
        case tuple() | list():
            for part in result:
                obeys(part)
    if dataclasses.is_dataclass(result):
        for f in dataclasses.fields(result):
            obeys(getattr(result, f.name))
    repr(result)


def _is_body(body: polhode.RigidBody) -> None:
    mass, center, inertia, moments, axes, *bounds = (np.asarray(x) for x in _numbers(body))
    for what, array in (
        ("mass", mass),
        ("centre", center),
        ("inertia", inertia),
        ("moments", moments),
        ("axes", axes),
    ):
        if not np.isfinite(array).all():
            raise Wrong(f"a body with {what} {array}")
    if not (mass > 0).all() or not (moments >= 0).all():
        raise Wrong(f"a body with mass {mass}, moments {moments}")
    i1, i2, i3 = np.moveaxis(moments, -1, 0)
    if not (i3 - i2 - i1 <= 1e-2 * i3 + 1e-320).all():
        raise Wrong(f"a body with moments {moments}")
    if any(not (bound >= 0).all() for bound in bounds):
        raise Wrong(f"a body with the bounds {bounds}")
    if body.shape == ():
        again = pickle.loads(pickle.dumps(body))
        if fingerprint(again) != fingerprint(body):
            raise Wrong("a body that pickle changes")


def arrays(value: Any) -> list[Any]:
    """The arrays among arguments, whose bytes nobody may change."""
    if isinstance(value, np.ndarray) and value.dtype.kind != "O" and value is not np.ma.masked:
        return [value]
    if isinstance(value, list | tuple):
        return [found for part in value for found in arrays(part)]
    return []


def finite_floats(value: Any) -> bool | None:
    """Whether all numbers of an argument are ordinary; None where it has none."""
    try:
        array = np.asarray(value, dtype=float)
    except (ValueError, TypeError, OverflowError):
        return None
    size = np.abs(array)
    return bool((np.isfinite(array) & ((size == 0) | ((size > 1e-30) & (size < 1e30)))).all())


def unknown(result: Any) -> bool:
    """Whether there is a NaN in arrays or numbers of a result."""
    match result:
        case float() | np.floating():
            return math.isnan(result)
        case np.ndarray():
            return result.dtype.kind == "f" and bool(np.isnan(result).any())
        case tuple() | list():
            return any(map(unknown, result))
    if dataclasses.is_dataclass(result):
        return any(unknown(getattr(result, f.name)) for f in dataclasses.fields(result))
    return False
