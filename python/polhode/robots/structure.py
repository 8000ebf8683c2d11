"""Which links of a robot can move, and what they carry: told from the joints alone.

A link needs mass where something moves it. Links that fixed joints tie together move as one body, so that one
of them may carry the mass of all; what is tied to the world needs none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, NamedTuple

from polhode.robots.model import WORLD

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from polhode.robots.model import Link, Robot

__all__ = ["Standing", "standings", "without_mass"]

_FREE: Final = ("floating", "free")


class Standing(NamedTuple):
    """How a link stands in its robot.

    Attributes
    ----------
    moves : bool
        Whether a joint moves it, or nothing holds it.
    joint : str
        The joint that moves it, itself or through what it is tied to; "" where it floats.
    carrier : str
        A link with mass that it is tied to (itself counted); "" if there is none.
    weld : str
        Another link that it is tied to whose own mass is spread in all directions, or the world; "" if there
        is none.
    carries_mass : bool
        Whether what hangs on it by joints that move has mass enough for its motions.
    stands_for : bool
        Whether a verdict on missing mass is told here: at links with shapes and where the joint ends.
    is_root : bool
        Whether it belongs to what no joint holds, which some simulators hold still and others let fall.
    """

    moves: bool
    joint: str
    carrier: str
    weld: str
    carries_mass: bool
    stands_for: bool
    is_root: bool


class _Group:
    """Links that fixed joints tie together."""

    def __init__(self) -> None:
        self.links: list[int] = []
        self.carrier = ""
        self.spread: list[int] = []
        self.has_shape = False
        self.joint: str | None = None
        self.is_free = True
        self.first = -1
        self.below: list[_Group] = []


def standings(robot: Robot, has_mass: Sequence[bool], has_spread: Sequence[bool]) -> list[Standing]:
    """Tell for every link whether it can move and what carries mass there.

    Parameters
    ----------
    robot : Robot
        Its joints may name links that are not there, which are passed over, and may run in circles.
    has_mass, has_spread : sequence of bool
        Of each link: whether it has mass, and whether a body has its tensor with three moments above 0.

    Returns
    -------
    list of Standing
        In the order of the links.
    """
    world = len(robot.links)
    number = {link.key: i for i, link in reversed([*enumerate(robot.links)])} | {WORLD: world}
    if WORLD in {link.key for link in robot.links}:  # a link of that name is a link: in URDF the root
        number[WORLD] = next(i for i, link in enumerate(robot.links) if link.key == WORLD)
    root = [*range(world + 1)]

    def find(i: int) -> int:
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    joints = [j for j in robot.joints if j.parent in number and j.child in number]
    for joint in joints:
        if joint.kind == "fixed":
            root[find(number[joint.child])] = find(number[joint.parent])
    for i, link in enumerate(robot.links):
        if link.is_static or link.key == WORLD:
            root[find(i)] = find(world)
    groups: dict[int, _Group] = {}
    for i, link in enumerate(robot.links):
        group = groups.setdefault(find(i), _Group())
        group.links.append(i)
        group.carrier = group.carrier or (link.name if has_mass[i] else "")
        group.spread += [i] if has_spread[i] else []
        group.has_shape = group.has_shape or bool(link.shapes)
        group.first = i if group.first < 0 else group.first
    ground = groups.setdefault(find(world), _Group())
    for joint in joints:
        parent, child = groups[find(number[joint.parent])], groups[find(number[joint.child])]
        if child is ground:  # a joint may name the world as its child
            parent, child = child, parent
        if joint.kind != "fixed" and parent is not child:
            parent.below.append(child)
            if child.joint is None and child is not ground:
                child.joint, child.first = joint.name, number[joint.child]
                child.is_free = joint.kind in _FREE
    heavy = _with_mass_below(groups.values())
    told: list[Standing] = []
    for i, link in enumerate(robot.links):
        group = groups[find(i)]
        is_root = group.joint is None and group is not ground
        moves = group is not ground and not (is_root and robot.format == "URDF")
        is_end = i == group.first and (group.joint is not None or not group.has_shape)
        stands_for = bool(link.shapes) or is_end
        # Six motions of a free link and those of one joint are too many for a single body with mass.
        carries_mass = sum(below in heavy for below in group.below) > group.is_free
        weld = next((robot.links[k].name for k in group.spread[:2] if k != i), "")
        if group is ground:
            weld = weld or "the world"
        standing = Standing(moves, group.joint or "", group.carrier, weld, carries_mass, stands_for, is_root)
        told.append(standing)
    return told


def _with_mass_below(groups: Iterable[_Group]) -> set[_Group]:
    """Give the groups that have mass, themselves or in what hangs on them."""
    above: dict[_Group, list[_Group]] = {}
    waiting: list[_Group] = []
    for group in groups:
        for below in group.below:
            above.setdefault(below, []).append(group)
        if group.carrier:
            waiting.append(group)
    found = set(waiting)
    while waiting:
        for group in above.get(waiting.pop(), []):
            if group not in found:
                found.add(group)
                waiting.append(group)
    return found


class WithoutMass(NamedTuple):
    """The verdict of a link without mass: the word, why, and what simulators make of it."""

    word: Literal["none", "missing"]
    reason: str
    note: str = ""


def without_mass(robot_format: str, link: Link, standing: Standing) -> WithoutMass:
    """Judge a link without mass.

    A mass matrix is singular where a joint moves what has no mass and carries none. MuJoCo refuses every body
    that joints move without mass, what it carries not counted; nothing else does.
    """
    if standing.carrier:
        return WithoutMass("none", f"tied to {standing.carrier}, which has mass")
    if not standing.moves:
        note = ""
        if standing.is_root and link.shapes:
            note = (
                f"line {link.line}: {link.name} is the root, with shapes and without mass: Pinocchio and "
                "MuJoCo hold it still, Drake and Gazebo let it fall unless it is tied to the world"
            )
        return WithoutMass("none", "no joint moves it", note)
    if not standing.joint and not link.shapes and link.inertial is None:
        return WithoutMass("none", "nothing is tied to it")
    mover = f"joint {standing.joint} moves it" if standing.joint else "nothing holds it"
    if not standing.stands_for:
        return WithoutMass("none", f"{mover} with what it is tied to, which is told there")
    shaped = "it has shape but no mass" if link.shapes else "no mass is tied to it"
    if not standing.carries_mass:
        return WithoutMass("missing", f"{mover}, and {shaped}: the mass matrix is singular there")
    if robot_format == "MJCF":
        return WithoutMass("missing", f"{mover}, and {shaped}: MuJoCo refuses it, whatever it carries")
    if link.shapes:
        return WithoutMass("missing", f"{mover}, and {shaped}: what it carries has mass, its own is left out")
    return WithoutMass("none", f"{mover} without mass; what it carries has mass")
