"""Check whether a link's shapes, or the whole robot, have room for matter as its tensor spreads it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from polhode.validity import fit_in_box

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode import RigidBody
    from polhode.robots.geometry import Geometry

    Floats = NDArray[np.float64]

__all__ = [
    "FAR",
    "LEAST",
    "MARKER",
    "MOST",
    "Finding",
    "beyond_room",
    "beyond_size",
    "density_needed",
    "times",
    "too_dense",
]

MOST: Final = 3.0
"""Matter on the surface of a box has at most 3 times the moments of the box filled."""
LEAST: Final = 0.1
"""A moment ten times smaller than the shape's own means a heavy core, or another unit."""
FAR: Final = 1000.0
"""Largest factor that an unread shape can explain: it would be 30 times larger than the others."""
MARKER: Final = 25_000.0
"""Density in kg/m^3 beyond which the shapes of a link are markers, such as dots of contact."""
# The densest matter, osmium, in kg/m^3.
_DENSEST: Final = 22_590.0
# No shape is taken to be farther off than this, of the diagonal of all.
_COARSEST: Final = 0.02
_STEPS: Final = 40


class Finding(NamedTuple):
    """Result of one law: the verdict's word, the quantity that exceeds the law, the reason, and the law."""

    word: Literal["suspect", "coarse", "impossible"]
    reason: str
    why: str = ""
    law: Literal["room", "center-of-mass", "density"] = "room"


def beyond_room(body: RigidBody, geometry: Geometry, coarseness: Callable[[], float]) -> Finding | None:
    """Return why no matter within the link's shapes can have the tensor; None if some can.

    Parameters
    ----------
    body : RigidBody
    geometry : Geometry
        All of whose shapes were read.
    coarseness : callable
        Gives how far the shapes may be off, in metres; more than 2 % of their diagonal is not counted.
    """
    low, high = geometry.low, geometry.high
    if low is None or high is None or fit_in_box(body, low, high).possible:
        return None
    found = _beyond_box(body, low, high, coarseness)
    is_outside = bool(((body.center_of_mass < low) | (body.center_of_mass > high)).any())
    return found._replace(law="center-of-mass") if is_outside else found


def _beyond_box(body: RigidBody, low: Floats, high: Floats, coarseness: Callable[[], float]) -> Finding:
    reason = _excess(body, low, high)
    most = _COARSEST * float(np.linalg.norm(high - low))
    if not fit_in_box(body, low - 2.0 * most, high + 2.0 * most).possible:
        return _beyond(body, low, high, reason)
    allowed = min(coarseness(), most)
    is_coarse = allowed > 0.0 and fit_in_box(body, low - allowed, high + allowed).possible
    inner, outer = 0.0, allowed if is_coarse else 2.0 * most
    for _ in range(_STEPS):
        middle = (inner + outer) / 2.0
        is_enough = fit_in_box(body, low - middle, high + middle).possible
        inner, outer = (inner, middle) if is_enough else (middle, outer)
    needed, told = _apart(outer * 1e3, allowed * 1e3)
    reason = f"{reason}; walls {needed} mm farther out would do"
    if is_coarse:
        return Finding("coarse", f"{reason}, and its shapes may be off by {told} mm")
    return _beyond(body, low, high, f"{reason}, but its shapes are taken to be off by no more than {told} mm")


def _beyond(body: RigidBody, low: Floats, high: Floats, reason: str) -> Finding:
    """Return how severe the excess is: published tensors often exceed their shapes, and simulators run them.

    More than 1000 times the box filled is beyond any reason. Less than 3 times may have room in the middle of
    the box, so that the centre of mass is at fault, which no reason explains either.
    """
    sides = high - low
    spread = float(np.trace(body.inertia)) / 2.0 / float(body.mass)
    filled = float(sides @ sides) / 12.0
    factor = spread / filled if filled > 0.0 else np.inf  # shapes of no extent have room for nothing
    is_outside = bool(((body.center_of_mass < low) | (body.center_of_mass > high)).any())
    if MOST < factor <= FAR and not is_outside:
        much = f"{times(factor)} the box around it filled"
        return Finding("suspect", reason, f"{much}: identified tensors are so at times, --strict fails them")
    middle = body.translated((low + high) / 2.0 - body.center_of_mass)
    has_room = not is_outside and fit_in_box(middle, low, high).possible
    why = "about its middle the shape has room: look at the centre of mass" if has_room else ""
    return Finding("impossible", reason, why)


def _excess(body: RigidBody, low: Floats, high: Floats) -> str:
    center = body.center_of_mass
    room = (center - low) * (high - center)
    if (room < 0.0).any():
        axis = int(np.argmin(room))
        return (
            f"the centre of mass, {'xyz'[axis]} = {center[axis]:.4g} m, lies outside the shape, "
            f"{low[axis]:.4g} to {high[axis]:.4g} m"
        )
    spread = np.maximum(np.trace(body.inertia) / 2.0 - np.diag(body.inertia), 0.0) / float(body.mass)
    axis = int(np.argmax(spread - room))
    if spread[axis] > room[axis]:
        has, holds = _apart(float(np.sqrt(spread[axis])), float(np.sqrt(room[axis])))
        near = float(min(center[axis] - low[axis], high[axis] - center[axis]))
        is_near = near < 0.1 * (high[axis] - low[axis])
        why = f", as the centre of mass is {near:.2g} m from its wall" if is_near else ""
        return (
            f"spread {has} m along {'xyz'[axis]} (root mean square) where its shape has room for "
            f"{holds} m{why}"
        )
    axes = fit_in_box(body, low, high).axes
    return f"the product of inertia of {' and '.join(axes)} is beyond what its shape has room for"


def _apart(one: float, other: float) -> tuple[str, str]:
    """Write two numbers with as many digits as tell them apart, at least three."""
    for digits in (3, 5, 8, 12):
        texts = f"{one:.{digits}g}", f"{other:.{digits}g}"
        if texts[0] != texts[1]:
            return texts
    return repr(one), repr(other)


def beyond_size(
    body: RigidBody, geometry: Geometry, own: RigidBody | None, reach: float, *, is_all: bool
) -> Finding | None:
    """Compare a tensor with the sizes that are known, if not all shapes could be read.

    What was read is a part of the link: the room of the rest is not known, but a tensor beyond 1000 times
    that of what is known is taken for impossible, and one beyond 3 times for suspect.

    Parameters
    ----------
    body : RigidBody
    geometry : Geometry
    own : RigidBody or None
        Its shapes of one role, filled evenly.
    reach : float
        How far the whole robot reaches at most, as far as it is known, in metres.
    is_all : bool
        Whether every shape of the robot could be read.
    """
    spread = float(np.trace(body.inertia)) / 2.0 / float(body.mass)
    known: list[tuple[float, str]] = []
    least = MOST
    if own is not None:
        known.append((float(np.trace(own.inertia)) / 2.0 / float(own.mass), f"its {geometry.role} shape"))
    if geometry.low is not None and geometry.high is not None:
        sides = geometry.high - geometry.low
        known.append((float(sides @ sides) / 12.0, "the box around those of its shapes that were read"))
    if not known and reach > 0.0:
        # Of a ball filled evenly, 3/5 r². What could not be read makes the robot larger than that.
        known.append((0.15 * reach**2, f"a ball as large as the whole robot, {reach:.3g} m by its joints"))
        least = MOST if is_all else FAR
    if not known:
        return None
    most, what = max(known)
    factor = spread / most if most > 0.0 else np.inf
    if not factor > least:
        return None
    left = f", and {geometry.unread} of its shapes could not be read" if geometry.unread else ""
    if factor > FAR:
        return Finding(
            "impossible",
            f"its moments are {times(factor)} those of {what}{left}; nothing explains more than 1000 times",
        )
    return Finding("suspect", f"its moments are {times(factor)} those of {what}{left}")


def too_dense(body: RigidBody) -> Finding | None:
    """Return a finding if a tensor is smaller than that of a ball of the densest matter; else None."""
    mass = float(body.mass)
    radius = (3.0 * mass / (4.0 * np.pi * _DENSEST)) ** (1.0 / 3.0)
    spread, least = float(np.trace(body.inertia)) / 2.0 / mass, 0.6 * radius**2
    if spread >= least:
        return None
    return Finding(
        "suspect",
        f"spread {np.sqrt(spread):.3g} m (root mean square), less than a ball of osmium of that mass, "
        f"{np.sqrt(least):.3g} m",
        law="density",
    )


def density_needed(mass: float, volume: float, factor: float) -> str:
    """State the density at which the shape would have the declared moments."""
    if not (volume > 0.0 and mass > 0.0 and factor > MOST):
        return ""
    density = mass / volume
    return f"its shape would need {density * factor:.3g} kg/m^3 for that, and has {density:.3g} by its mass"


def times(factor: float) -> str:
    """Write a factor."""
    return f"{factor:.0f} times" if 100.0 <= factor < 1e15 else f"{factor:.3g} times"
