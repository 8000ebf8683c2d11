"""The parts of a ledger that are bodies already, with the errors that they depend on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode.errors import PolhodeError
from polhode.uncertainty._parts import Parts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from polhode._core import RigidBody

    Floats = NDArray[np.float64]

__all__ = ["parts_of_bodies"]

_MOST = 10
"""Draws that a ledger keeps of a part, and of all parts that share some."""


def parts_of_bodies(ids: Sequence[str], bodies: Sequence[RigidBody | None]) -> Parts:
    """Take the ten numbers of bodies and their errors; None stands for a node with children.

    Parameters
    ----------
    ids : sequence of str
        Errors that several bodies share bear the name of the first of them.
    bodies : sequence of (RigidBody or None)
        In one frame.
    """
    count = len(bodies)
    values = np.zeros((10, count))
    found: list[tuple[int, list[tuple[int, ...]], Floats]] = []
    for row, body in enumerate(bodies):
        if body is None:
            continue
        tensor = body.inertia
        values[:, row] = [
            body.mass, *body.center_of_mass, *np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2]
        ]  # fmt: skip
        doubts = body._doubts()
        if doubts is not None and len(doubts["tangents"]):
            effects = doubts["tangents"].copy()  # of m, C and I; the ledger keeps those of m, m C and I
            effects[:, 1:4] *= body.mass
            found.append((row, [tuple(name) for name in doubts["variables"].tolist()], effects))
    draws = np.zeros((10, _MOST, len(found)))
    source = [""] * count
    for group in _sharing([set(names) for _, names, _ in found]):
        every = sorted({name for k in group for name in found[k][1]})
        if len(every) > _MOST and len(group) > 1:
            raise PolhodeError(
                f"{len(group)} parts share {len(every)} independent errors, and a ledger keeps {_MOST} at "
                "most; leave the sigmas of these parts out"
            )
        for k in group:
            row, names, effects = found[k]
            if len(every) > _MOST:  # of a part alone, by as many draws with the same covariance
                effects = np.linalg.svd(effects, full_matrices=False)[1:]
                effects = effects[0][:, None] * effects[1]
                names = every[: len(effects)]
            found[k] = row, names, effects
        place = _numbers([found[k][1:] for k in group])
        for k in group:
            row, names, effects = found[k]
            draws[:, [place[name] for name in names], k] = effects.T
            if len(group) > 1:
                source[row] = f"{ids[found[group[0]][0]]} and {len(group) - 1} like it"
    rows = np.array([row for row, _, _ in found], np.intp)
    return Parts(
        mass=values[0],
        center=values[1:4],
        inertia=values[4:],
        growth=np.zeros(count),
        sigma=np.zeros((10, count)),
        correlated=(rows, draws),
        source=source,
        unstated=sum(body is not None for body in bodies) - len(found),
        opposite_signs={},
    )


def _numbers(members: Sequence[tuple[list[tuple[int, ...]], Floats]]) -> dict[tuple[int, ...], int]:
    """Give each error the place of the number that is uncertain by it more than by any other."""
    variances: dict[tuple[int, ...], Floats] = {}
    for names, effects in members:
        for name, effect in zip(names, effects, strict=True):
            variances[name] = variances.get(name, np.zeros(10)) + effect**2
    left, place = sorted(variances), {}
    for number in range(10):
        of_number = {name: variances[name][number] for name in left}
        first = max(left, key=of_number.__getitem__, default=None)
        if first is not None and of_number[first] > 0.0:
            place[first] = number
            left.remove(first)
    free = (number for number in range(10) if number not in place.values())
    return place | dict(zip(left, free, strict=False))


def _sharing(names: list[set[tuple[int, ...]]]) -> list[list[int]]:
    """Give the numbers of those that share a name, directly or by way of others."""
    groups: list[tuple[set[tuple[int, ...]], list[int]]] = []
    of_name: dict[tuple[int, ...], int] = {}
    for k, own in enumerate(names):
        near = sorted({of_name[name] for name in own if name in of_name})
        at = near[0] if near else len(groups)
        if not near:
            groups.append((set(), []))
        for other in near[1:]:
            groups[at][0].update(groups[other][0])
            groups[at][1].extend(groups[other][1])
            groups[other] = (set(), [])
        groups[at][0].update(own)
        groups[at][1].append(k)
        of_name.update(dict.fromkeys(groups[at][0], at))
    return [sorted(members) for _, members in groups if members]
