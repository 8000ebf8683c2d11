"""Whether the inertia that a link declares is that of a body, of a body of its size, and of its shape."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from polhode import RigidBody, principal_moments
from polhode.errors import PolhodeError
from polhode.robots.model import Inertial
from polhode.validity import fit_in_box, nearest_valid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from polhode.robots.geometry import Geometry, GeometryReader
    from polhode.robots.model import Link

    Floats = NDArray[np.float64]

__all__ = ["FAILURES", "Verdict", "judge"]

Word = Literal["good", "suspect", "placeholder", "impossible", "unreadable", "none", "inferred"]
FAILURES: Final = frozenset({"placeholder", "impossible", "unreadable"})

# Matter on the surface of a box has at most 3 times the moments of the box filled; ten times less than the
# shape's own is a heavy core, or another unit.
_MOST: Final = 3.0
_LEAST: Final = 0.1
# A table printed to few digits breaks a law by no more than this, and can be put right without guessing.
_NEAR: Final = 0.1


class Verdict(NamedTuple):
    """What was found about one link.

    Attributes
    ----------
    name : str
    line : int
        Of the link in the file.
    verdict : str
        ``"good"``; ``"suspect"``: possible, but far from what its shape has; ``"placeholder"``: the unit
        tensor, or the same multiple of it in links of different masses; ``"impossible"``: no body has it, or
        no body of that size; ``"unreadable"``: a number is missing or is not a number; ``"none"``: nothing is
        declared; ``"inferred"``: nothing is declared, and a simulator computes it from the geometry.
    reason : str
        Which law fails and by how much.
    mass : float or None
    moments : numpy.ndarray, shape (3,), or None
        Declared principal moments about the centre of mass, ascending.
    shape_moments : numpy.ndarray, shape (3,), or None
        Those of the link's shapes, filled evenly with the declared mass.
    factor : float or None
        The declared moment over the shape's, where it is farthest from 1.
    shapes : str
        The shapes compared with: ``"collision"``, ``"visual"`` or ``""``.
    notes : tuple of str
        What could not be told about the geometry.
    better : Inertial or None
        What to declare instead: that of the shape, or the nearest tensor that a body has.
    file : str
        The file that the link stands in, where that is included by the robot's own.
    """

    name: str
    line: int
    verdict: Word
    reason: str
    mass: float | None = None
    moments: Floats | None = None
    shape_moments: Floats | None = None
    factor: float | None = None
    shapes: str = ""
    notes: tuple[str, ...] = ()
    better: Inertial | None = None
    file: str = ""


def judge(links: Sequence[Link], geometry: GeometryReader) -> list[Verdict]:
    """Judge every link.

    Parameters
    ----------
    links : sequence of Link
    geometry : GeometryReader

    Returns
    -------
    list of Verdict
        In the order of the links.
    """
    copied = _placeholders(links)
    # Ratios of numbers that lie far apart leave their range: infinity and zero are right there.
    with np.errstate(all="ignore"):
        return [_judge(link, geometry.read(link), copied)._replace(file=link.file) for link in links]


def _placeholders(links: Sequence[Link]) -> dict[float, int]:
    """Count the links of each isotropic moment that stands for nothing: 1, or the same at unlike masses."""
    masses = defaultdict(list)
    for link in links:
        if link.inertial is not None and (moment := _isotropic(link.inertial.inertia)) is not None:
            masses[moment].append(link.inertial.mass)
    return {m: len(held) for m, held in masses.items() if m == 1.0 or len(set(held)) > 1}


def _isotropic(tensor: Floats) -> float | None:
    moment = float(tensor[0, 0])
    return moment if np.allclose(tensor, moment * np.eye(3), rtol=0.0, atol=1e-9 * abs(moment)) else None


def _judge(link: Link, geometry: Geometry, placeholders: dict[float, int]) -> Verdict:
    if link.problem:
        return Verdict(link.name, link.line, "unreadable", link.problem)
    declared = link.inertial
    if declared is None:
        word: Word = "inferred" if link.inferred and link.shapes else "none"
        return Verdict(link.name, link.line, word, "", notes=geometry.notes if link.inferred else ())
    own, factor, notes = None, None, geometry.notes
    if geometry.body is not None and declared.mass > 0.0:
        try:
            own = geometry.body.scaled(mass=declared.mass / float(geometry.body.mass))
        except PolhodeError as error:
            notes = (*notes, f"line {link.line}: its shape at the declared mass is no body: {error}")
    moments = np.asarray(principal_moments(declared.inertia))
    if own is not None:
        factor = _farthest(moments, own.principal_moments)
    word, reason = _law(declared, geometry, own, factor, placeholders)
    return Verdict(
        link.name,
        link.line,
        word,
        reason,
        declared.mass,
        moments,
        None if own is None else own.principal_moments,
        factor,
        geometry.role if own is not None else "",
        notes,
        None if word == "good" else _better(declared, own, word),
    )


def _law(
    declared: Inertial,
    geometry: Geometry,
    own: RigidBody | None,
    factor: float | None,
    placeholders: dict[float, int],
) -> tuple[Word, str]:
    """Say which law fails, the plainest first."""
    try:
        body = RigidBody(declared.mass, declared.inertia, declared.center_of_mass)
    except PolhodeError as error:
        return "impossible", str(error)
    size = _beyond_size(body, geometry)
    compared = _compared(factor, geometry) if own is not None else ""
    moment = _isotropic(declared.inertia)
    if moment is not None and moment in placeholders:
        count = placeholders[moment]
        where = f"in {count} links" if count > 1 else "only here"
        reasons = [f"{moment:g} {moment:g} {moment:g} stands {where}", compared, size]
        is_true = own is not None and not size and np.allclose(own.inertia, declared.inertia, rtol=1e-2)
        if not is_true:
            return "placeholder", "; ".join(reason for reason in reasons if reason)
    if size:
        return "impossible", "; ".join(reason for reason in (compared, size) if reason)
    if factor is not None and not _LEAST <= factor <= _MOST:
        return "suspect", compared
    return "good", compared


def _beyond_size(body: RigidBody, geometry: Geometry) -> str:
    """Say how matter within the link's shapes could not be spread as the tensor says; "" if it could."""
    if geometry.low is None or geometry.high is None:
        return ""
    fit = fit_in_box(body, geometry.low, geometry.high)
    if fit.possible:
        return ""
    center = body.center_of_mass
    room = (center - geometry.low) * (geometry.high - center)
    if (room < 0.0).any():
        axis = int(np.argmin(room))
        return (
            f"the centre of mass, {'xyz'[axis]} = {center[axis]:.4g} m, lies outside the shape, "
            f"{geometry.low[axis]:.4g} to {geometry.high[axis]:.4g} m"
        )
    spread = np.maximum(np.trace(body.inertia) / 2.0 - np.diag(body.inertia), 0.0) / float(body.mass)
    axis = int(np.argmax(spread - room))
    if spread[axis] > room[axis]:
        return (
            f"spread {np.sqrt(spread[axis]):.3g} m along {'xyz'[axis]} (root mean square) where its shape "
            f"has room for {np.sqrt(room[axis]):.3g} m"
        )
    return f"the product of inertia of {' and '.join(fit.axes)} is beyond what its shape has room for"


def _farthest(declared: Floats, own: Floats) -> float | None:
    """Give the ratio of moments that is farthest from 1, either way."""
    ratios = np.where(own > 0.0, declared / own, np.nan)
    distance = np.abs(np.log(np.where(ratios > 0.0, ratios, np.nan)))
    return None if np.isnan(distance).all() else float(ratios[np.nanargmax(distance)])


def _compared(factor: float | None, geometry: Geometry) -> str:
    if factor is None or 0.99 <= factor <= 1.01:
        return "" if factor is None else f"as its {geometry.role} shape"
    times = f"{factor:.0f}" if 100.0 <= factor < 1e15 else f"{factor:.3g}"
    return f"{times} times its {geometry.role} shape's"


def _better(declared: Inertial, own: RigidBody | None, word: Word) -> Inertial | None:
    """Give what to declare instead, in nine digits where those are still a body's."""
    if own is not None:
        found = Inertial(declared.mass, own.center_of_mass, own.inertia)
    elif word == "impossible" and declared.mass > 0.0:
        try:
            nearest, distance = nearest_valid(declared.inertia)
        except PolhodeError:
            return None
        if not 0.0 < distance <= _NEAR * float(np.linalg.norm(declared.inertia)):
            return None
        found = Inertial(declared.mass, declared.center_of_mass, nearest)
    else:
        return None
    rounded = Inertial(found.mass, _nine(found.center_of_mass), _nine(found.inertia))
    try:
        RigidBody(rounded.mass, rounded.inertia, rounded.center_of_mass)
    except PolhodeError:
        return found
    return rounded


def _nine(values: Floats) -> Floats:
    """Round to nine digits of the largest, so that rounding left over from turning is 0."""
    largest = float(np.abs(values).max())
    if largest == 0.0:
        return values
    digits = 9 - int(np.ceil(np.log10(largest)))
    return np.round(values, digits) + 0.0
