"""What must be true of the links of a robot, judged without polhode.

Of each link they say a word and the rule that gave it:

- ``law``: no body has the mass and the tensor (one is negative, or a moment larger than the others' sum);
- ``sign``: the tensor stands for nothing (the unit tensor, none with a mass, one for unlike masses);
- ``tied``: a point mass, of no tensor or less than a ball of osmium has, tied to what has one (``good``);
- ``marker``: the mass would be denser in its shapes than any matter, so that they say nothing (``suspect``);
- ``joints``: it has a shape and is moved by a joint, and neither it nor what is fixed to it has mass;
- ``room``: the second moments are beyond those of matter within the box around all its shapes (``suspect``
  where they are 3 to 1000 times those of the box filled, and the centre of mass is inside)
  (``room dae`` where one is a DAE mesh, which takes its reader's word for unit and axes);
- ``shape``: more than 1000 times the moments of its shapes filled evenly; ``suspect`` where more than
  3 times or less than a tenth.

Where a rule is met so narrowly that the digits of a mesh decide, the word is ``disputed``: either will do.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from robots_files import Array, Link, Robot

Said = tuple[str, str]

NARROW = 0.02  # of the diagonal of the box around the shapes
GREY = 1.5  # factor either side of a threshold
ABSURD, MOST, LEAST = 1000.0, 3.0, 0.1
OSMIUM, DENSEST = 22_590.0, 25_000.0  # kg/m^3


def judged(robot: Robot) -> list[Said]:
    """Return of each link a word and the rule that says it."""
    repeated = defaultdict(set)
    for link in robot.links:
        if not link.problem and not link.is_static and (moment := isotropic(link.tensor)) is not None:
            repeated[moment].add(link.mass)
    copied = {m for m, masses in repeated.items() if m == 1.0 or len(masses) > 1}
    moved, idle, tied = standing(robot)
    return [_judged(link, copied, i in moved, i in idle, i in tied) for i, link in enumerate(robot.links)]


def _judged(link: Link, copied: set[float], is_moved: bool, is_idle: bool, is_tied: bool) -> Said:
    if link.is_static:
        return "good", "static"
    if link.problem:
        return "unreadable", "law"
    if np.isnan(link.tensor).any():
        return "good", "inferred"
    if link.is_empty and is_idle:
        return ("missing" if link.shapes else "disputed"), "joints"
    if link.is_empty or not (link.is_declared or is_moved):
        return "good", "joints"
    return of_tensor(link, copied, is_tied=is_tied)


def of_tensor(link: Link, copied: set[float], *, is_tied: bool = False) -> Said:
    """Judge a mass and a tensor that are given."""
    moments = np.linalg.eigvalsh(link.tensor)
    largest = float(np.abs(moments).max())
    if link.mass <= 0.0 or moments[0] < -1e-9 * largest:
        return "impossible", "law"
    if moments[2] - moments[0] - moments[1] > 1e-9 * largest:
        return "impossible", "law"
    own, density = filled(link)
    if is_tied and (
        largest == 0.0 or (own is None and moments.sum() < 1.2 * link.mass * of_osmium(link.mass))
    ):
        return "good", "tied"
    if largest == 0.0:
        return "placeholder", "sign"
    known = [each for _, each in link.shapes if each is not None]
    if density > DENSEST:
        known = []
    if isotropic(link.tensor) in copied:
        is_true = own is not None and np.allclose(own * link.mass, moments, rtol=1e-2, atol=0.0)
        return ("good" if is_true else "placeholder"), "sign"
    if density:
        return ("suspect" if density > DENSEST * GREY else "disputed"), "marker"
    ratio = 1.0 if own is None else farthest(moments, own * link.mass)
    if known:
        corners = np.concatenate([each.corners for each in known])
        low, high = corners.min(axis=0), corners.max(axis=0)
        size = float(np.linalg.norm(high - low))
        if len(known) < len(link.shapes):  # as if the others were no larger
            ratio = max(ratio, largest / (link.mass * size**2 / 12.0)) if size else ratio
        elif size and (over := overshoot(link, low, high) / size) > 1e-9:
            kinds = {each.dae for each in known} - {""}
            is_sure = (over > NARROW and "y-up" not in kinds) or ratio > ABSURD * GREY
            return (beyond(link, low, high) if is_sure else "disputed"), "room dae" if kinds else "room"
    if ratio > ABSURD:
        return ("impossible" if ratio > ABSURD * GREY else "disputed"), "shape"
    return ("good" if LEAST <= ratio <= MOST else "suspect"), ("law" if own is None else "shape")


def beyond(link: Link, low: Array, high: Array) -> str:
    """Return what a tensor without room is: suspect from 3 to 1000 times that of the box filled."""
    size = float(np.linalg.norm(high - low))
    times = float(np.trace(link.tensor)) / 2.0 / link.mass / (size**2 / 12.0)
    if ((link.center < low) | (link.center > high)).any():
        return "impossible"
    if any(limit / GREY < times < limit * GREY for limit in (MOST, ABSURD)):
        return "disputed"
    return "suspect" if MOST < times < ABSURD else "impossible"


def isotropic(tensor: Array) -> float | None:
    """Return the moment of a tensor that is a multiple of the unit tensor; None for others."""
    moment = float(f"{tensor[0, 0]:.9g}")  # the turn of its axes leaves it so
    return (
        moment
        if moment and np.allclose(tensor, moment * np.eye(3), rtol=0, atol=1e-9 * abs(moment))
        else None
    )


def of_osmium(mass: float) -> float:
    """Return the square of the radius of a ball of osmium."""
    return float((0.75 * mass / np.pi / OSMIUM) ** (2.0 / 3.0))


def filled(link: Link) -> tuple[Array | None, float]:
    """Return the moments, per unit of mass, of the shapes of one role filled evenly.

    Shapes in which the mass would be denser than any matter, or nearly so, are passed over: the density is
    the least of theirs where no others are left, else 0.
    """
    dense: list[float] = []
    for role in ("collision", "visual"):
        parts = [each for kind, each in link.shapes if kind == role]
        solids = [part for part in parts if part is not None]
        volume = sum(solid.volume for solid in solids)
        if len(solids) < len(parts) or not volume > 0.0:
            continue
        if link.mass > DENSEST / GREY * volume:
            dense.append(link.mass / volume)
            continue
        center = sum(solid.volume * solid.center for solid in solids) / volume
        second = sum(
            solid.volume * (solid.second + np.outer(solid.center - center, solid.center - center))
            for solid in solids
        )
        tensor = (np.trace(second) * np.eye(3) - second) / volume
        moments: Array = np.linalg.eigvalsh(tensor)
        return moments, 0.0
    return None, min(dense, default=0.0)


def farthest(moments: Array, own: Array) -> float:
    """Return the ratio of moments that is farthest from 1."""
    ratios = np.maximum(moments, 1e-300) / np.maximum(own, 1e-300)
    return float(ratios[np.argmax(np.abs(np.log(ratios)))])


def overshoot(link: Link, low: Array, high: Array) -> float:
    """Compute by how much a box must grow on all sides for matter within it to have the second moments."""
    second = (np.trace(link.tensor) / 2.0 * np.eye(3) - link.tensor) / link.mass
    if not np.isfinite([*second.ravel(), *low, *high]).all():
        return 0.0
    grown, step = 0.0, float(np.linalg.norm(high - low)) or 1.0
    if fits(second, link.center, low, high):
        return 0.0
    while not fits(second, link.center, low - step, high + step):
        step *= 2.0
    for _ in range(60):
        middle = (grown + step) / 2.0
        if fits(second, link.center, low - middle, high + middle):
            step = middle
        else:
            grown = middle
    return step


def fits(second: Array, center: Array, low: Array, high: Array) -> bool:
    """Whether matter in a box can have these second moments about its centre of mass (per mass)."""
    below, above = center - low, high - center
    room = np.outer(below, above)
    room = np.minimum(room, room.T)
    least = -np.minimum(np.outer(below, below), np.outer(above, above))
    is_within = bool((below >= 0).all() and (above >= 0).all())
    slack = 1e-12 * float(np.abs(room).max())
    off = ~np.eye(3, dtype=bool)
    return is_within and bool((second <= room + slack).all() and (second[off] >= least[off] - slack).all())


def standing(robot: Robot) -> tuple[set[int], set[int], set[int]]:
    """Return links that move, those of them that neither have mass nor are tied to some, and the tied ones.

    Tied are those fixed to another with three moments above 0, with which simulators join them, or to the
    world.
    """
    group = {link.name: link.name for link in robot.links} | {"world": "world"}

    def find(name: str) -> str:
        while group.setdefault(name, name) != name:
            name = group[name]
        return name

    for parent, child, is_fixed in robot.joints:
        if is_fixed:
            group[find(child)] = find(parent)
    world = find("world") if robot.format == "SDF" else ""
    moved = {find(child) for _, child, is_fixed in robot.joints if not is_fixed}
    if robot.format == "SDF":  # a model falls unless a joint holds it
        moved |= {find(link.name) for link in robot.links}
    moved.discard(world)
    heavy = {find(link.name) for link in robot.links if not link.is_empty or link.problem}
    places = [find(link.name) for link in robot.links]
    spread = [i for i, link in enumerate(robot.links) if is_spread(link)]
    tied = {
        i
        for i, place in enumerate(places)
        if place == find("world") or any(places[k] == place and k != i for k in spread)
    }
    return (
        {i for i, p in enumerate(places) if p in moved},
        {i for i, p in enumerate(places) if p in moved - heavy},
        tied if robot.format != "SDF" else set(),  # libsdformat refuses a tensor of zero
    )


def is_spread(link: Link) -> bool:
    """Whether a body has its tensor, with three moments above 0."""
    if link.problem or link.mass <= 0.0 or not np.isfinite(link.tensor).all():
        return False
    first, second, third = np.linalg.eigvalsh(link.tensor)
    return bool(first > 1e-14 * third and third <= (first + second) * (1.0 + 1e-9))
