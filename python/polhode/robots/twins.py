"""Left and right: whether the declared inertia of a link is the mirror image of that of its twin."""

from __future__ import annotations

import itertools
import re
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode import RigidBody
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from polhode.robots.model import Link

__all__ = ["twin_notes"]

_SIDE: Final = re.compile(
    r"(?i:left|right)|(?<![A-Za-z])[lr](?![A-Za-z])|(?<![A-Za-z])[LR](?![A-Za-z])|(?<![A-Za-z])[LRFH]{2}(?![A-Za-z])"
)
"""Words of a name that tell the side: left, R, r, FL, LH."""
_OTHER: Final = {"left": "right", "right": "left", "l": "r", "r": "l"}
_ALIKE: Final = 1e-2
"""Relative difference of twins that is told: tables are printed to few digits."""
_FRAMES: Final = tuple(np.array(signs) for signs in itertools.product((1.0, -1.0), repeat=3))


def twin_notes(links: Sequence[Link]) -> Iterator[tuple[int, str]]:
    """Return the number of each link that is no mirror image of its twin, and what differs.

    Twins are links whose names differ by left and right. What no choice of their frames changes is compared:
    mass, principal moments, the distance of the centre of mass from the origin, and how it lies in the
    ellipsoid of inertia. Where these agree, the second
    one must be the mirror image of the first, in axes that may each run the other way, and not its copy.
    """
    places = {link.name: place for place, link in enumerate(links)}
    for place, link in enumerate(links):
        twin = places.get(_other_side(link.name), place)
        if twin >= place:
            continue  # each pair once, at the later one
        one, other = _body(link), _body(links[twin])
        if one is None or other is None:
            continue
        reason = _difference(one, other)
        if reason:
            yield place, f"line {link.line}: {link.name} is no mirror image of {links[twin].name}: {reason}"


def _other_side(name: str) -> str:
    def turn(found: re.Match[str]) -> str:
        word = found[0]
        other = _OTHER.get(word.lower())
        if other is None:  # two letters, of which one is the side: FL, RL, LH
            at = 0 if word[1].upper() in "FH" else 1
            letter = word[at]
            if letter.upper() not in "LR":
                return word
            turned = _OTHER[letter.lower()]
            turned = turned.upper() if letter.isupper() else turned
            return turned + word[1] if at == 0 else word[0] + turned
        if word.isupper():
            return other.upper()
        return other.capitalize() if word[0].isupper() else other

    return _SIDE.sub(turn, name)


def _body(link: Link) -> RigidBody | None:
    if link.inertial is None or link.problem or link.defaults:
        return None
    try:
        return RigidBody(link.inertial.mass, link.inertial.inertia, link.inertial.center_of_mass, rtol=_ALIKE)
    except PolhodeError:
        return None


def _difference(one: RigidBody, other: RigidBody) -> str:
    if abs(one.mass - other.mass) > _ALIKE * other.mass:
        return f"its mass is {one.mass:.4g} kg, that of the other {other.mass:.4g} kg"
    i, j = one.principal_moments, other.principal_moments
    if np.abs(i - j).max() > _ALIKE * j.max():
        return f"its principal moments are {_list(i)}, those of the other {_list(j)}"
    size = float(other.radii_of_gyration.max()) + float(np.linalg.norm(other.center_of_mass))
    c, d = (float(np.linalg.norm(body.center_of_mass)) for body in (one, other))
    if abs(c - d) > _ALIKE * size:
        return f"its centre of mass is {c:.4g} m from its origin, that of the other {d:.4g} m"
    reason = _relation(one, other, size)
    if reason:
        return reason
    is_copy = _agree(one, other, np.ones(3), size)
    is_mirrored = any(_agree(one, other, signs, size) for signs in _FRAMES if signs.prod() < 0.0)
    if is_copy and not is_mirrored:
        return "it has the same numbers, which are not those of its mirror image"
    return ""


def _relation(one: RigidBody, other: RigidBody, size: float) -> str:
    """Compare how the centre of mass lies in the tensor: numbers that no choice of frames changes."""
    i = float(other.principal_moments.max())
    away = float(np.linalg.norm(other.center_of_mass))
    # By so much such a number may change where the centre and the tensor are known to 1 %.
    change = _ALIKE * away * (2.0 * size + away)
    for power, name in ((1, "c·I c"), (2, "c·I² c")):
        first, second = (_form(body, power) for body in (one, other))
        if abs(first - second) > power * change * i**power:
            return (
                "its products of inertia and its centre of mass have signs of different sides: of the centre "
                f"c and the tensor I, {name} is {first:.4g}, that of the other {second:.4g}"
            )
    return ""


def _form(body: RigidBody, power: int) -> float:
    c = body.center_of_mass
    return float(c @ np.linalg.matrix_power(body.inertia, power) @ c)


def _agree(one: RigidBody, other: RigidBody, signs: np.ndarray, size: float) -> bool:
    """Return whether the first is the second with these axes turned the other way."""
    center = np.abs(one.center_of_mass - signs * other.center_of_mass).max()
    tensor = np.abs(one.inertia - np.outer(signs, signs) * other.inertia).max()
    return bool(center <= _ALIKE * size and tensor <= _ALIKE * other.principal_moments.max())


def _list(numbers: np.ndarray) -> str:
    return ", ".join(f"{x:.4g}" for x in numbers)
