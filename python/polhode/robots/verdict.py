"""Check of each declared inertia: whether any body has it, a body of this size, a body of this shape."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from polhode import RigidBody, principal_moments
from polhode._format import Argument
from polhode.errors import InvalidInertiaError, PolhodeError
from polhode.interop.programs import LEAST_MOMENT, inside_edge
from polhode.robots.mjcf import as_compiled
from polhode.robots.model import WORLD, Inertial
from polhode.robots.room import (
    LEAST,
    MARKER,
    MOST,
    beyond_room,
    beyond_size,
    density_needed,
    times,
    too_dense,
)
from polhode.robots.twins import twin_notes
from polhode.validity import nearest_valid

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from numpy.typing import NDArray

    from polhode.robots.geometry import Geometry, GeometryReader
    from polhode.robots.model import Link, Robot

    Floats = NDArray[np.float64]

__all__ = [
    "FAILURES",
    "LinkRole",
    "Verdict",
    "has_own_tensor",
    "is_without_mass",
    "judge",
    "judge_without_mass",
    "link_roles",
    "replacement",
]

Word = Literal[
    "good",
    "suspect",
    "coarse",
    "placeholder",
    "impossible",
    "missing",
    "unreadable",
    "none",
    "inferred",
]
Law = Literal[
    "",
    "unreadable",
    "missing-mass",
    "mass",
    "moments",
    "triangle-inequality",
    "placeholder",
    "center-of-mass",
    "room",
    "shape",
    "density",
]
FAILURES: Final = frozenset({"placeholder", "impossible", "missing", "unreadable"})
_STANDS_FOR: Final = {0.0: "is a point's, where mass has no spread", 1.0: "is the unit tensor"}
# A table printed to few digits breaks a law by no more than this, and can be put right without guessing.
_NEAR: Final = 0.1


class Verdict(NamedTuple):
    """Result of the test of one link.

    Attributes
    ----------
    name : str
    line : int
        Line of the link in the file.
    verdict : str
        ``"good"``; ``"suspect"``: far from what its shape has, or its shape has no room for its mass in any
        matter; ``"coarse"``: larger than
        its shape has room for, but by no more than its shape may differ from the true one;
        ``"placeholder"``: the unit tensor, the same multiple of it in links of different masses, or zero;
        ``"impossible"``: no body has it, or no body of the size of the link; ``"missing"``: no mass
        where a joint moves; ``"unreadable"``: a number is missing or is not a number; ``"none"``: nothing is
        declared, nor needed; ``"inferred"``: nothing is declared, and a simulator computes it from the
        geometry.
    reason : str
        The law that fails, and by how much.
    mass : float or None
        Declared mass; for the verdict ``"inferred"`` the mass that the simulator computes. The same holds for
        `moments`.
    moments : numpy.ndarray, shape (3,), or None
        Declared principal moments about the centre of mass, ascending.
    shape_moments : numpy.ndarray, shape (3,), or None
        Principal moments of the shapes of the link, filled uniformly with the declared mass.
    factor : float or None
        Ratio of declared moment to moment of the shape, for the axis where it is farthest from 1.
    shapes : str
        Kind of the shapes that were compared: ``"collision"``, ``"visual"``, or ``""`` for none.
    notes : tuple of str
        Remarks on the geometry, such as shapes that could not be read.
    better : Inertial or None
        Values to declare instead: those of the shape, or the nearest possible tensor.
    file : str
        File that contains the link, if the robot file includes it.
    inside : Inertial or None
        If the declared tensor is on the edge I1 + I2 = I3, as of a lamina, where rounding may make it
        impossible: the same tensor, moved inside by less than 6e-15 of the sum of its moments.
    law : str
        The law that `reason` states: ``"mass"`` (above 0), ``"moments"`` (none below 0),
        ``"triangle-inequality"``, ``"placeholder"``, ``"center-of-mass"`` (within the shape), ``"room"`` (in
        the shape), ``"shape"`` (1/10 to 3 times the shape filled), ``"density"`` (that of matter),
        ``"missing-mass"``, ``"unreadable"``; ``""`` where none is broken.
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
    inside: Inertial | None = None
    law: Law = ""


def judge(
    robot: Robot, geometry: GeometryReader, density: float | None = None, mass: float | None = None
) -> list[Verdict]:
    """Check every link.

    Parameters
    ----------
    robot : Robot
    geometry : GeometryReader
    density, mass : float, optional
        What links have whose file says no mass: each of that density, or all together of that mass.

    Returns
    -------
    list of Verdict
        In the order of the links.
    """
    # Ratios of numbers that lie far apart leave their range: infinity and zero are right there.
    with np.errstate(all="ignore"):
        read = [geometry.read(link) for link in robot.links]
        pairs = list(zip(robot.links, read, strict=True))
        roles = link_roles(
            robot, [_has_mass(*pair) for pair in pairs], [_has_spread(*pair) for pair in pairs]
        )
        judging = _VerdictData(
            geometry,
            robot.format,
            _placeholders(robot.links),
            _reach(robot, read),
            not any(each.unread for each in read),
        )
        found = [
            judging.link(link, each, role)._replace(file=link.file)
            for link, each, role in zip(robot.links, read, roles, strict=True)
        ]
        for place, note in twin_notes(robot.links):
            found[place] = found[place]._replace(notes=(*found[place].notes, note))
        return _fill_masses(robot, as_compiled(robot, found), geometry, density, mass)


def has_own_tensor(link: Link) -> bool:
    """Return whether a tensor may have been measured: it is possible, and it is no placeholder."""
    declared = link.inertial
    if declared is None or link.defaults or _isotropic(declared.inertia) is not None:
        return False
    try:
        RigidBody(declared.mass, declared.inertia, declared.center_of_mass)
    except PolhodeError:
        return False
    return True


def replacement(verdict: Verdict, words: Collection[str]) -> Inertial | None:
    """Return what is written for a link where verdicts of these words are corrected; None for nothing."""
    return verdict.better if verdict.verdict in words else verdict.inside


def is_without_mass(link: Link, verdict: Verdict) -> bool:
    """Return whether a link fails and its file says no mass, so that a density or a mass is needed."""
    return verdict.verdict == "missing" or ("1 kg" in link.defaults and verdict.verdict in FAILURES)


def _is_empty(declared: Inertial) -> bool:
    return declared.mass == 0.0 and not declared.inertia.any()


def _has_mass(link: Link, geometry: Geometry) -> bool:
    if link.problem:
        return True
    if link.inertial is None:
        solid = [shape for shape in link.shapes if shape.role == "collision"]
        unread = any((shape.density if shape.mass is None else shape.mass) != 0.0 for shape in solid)
        return link.inferred and (geometry.body is not None or (unread and geometry.unread > 0))
    return not _is_empty(link.inertial)


def _has_spread(link: Link, geometry: Geometry) -> bool:
    """Return whether a tensor is possible, with three moments above 0: it stays so if matter is added."""
    body = geometry.body
    try:
        if link.inertial is not None:
            body = RigidBody(link.inertial.mass, link.inertial.inertia)
    except PolhodeError:
        return False
    return body is not None and not link.problem and float(body.principal_moments[0]) > 0.0


def _is_point(declared: Inertial) -> bool:
    """Return whether a tensor is no larger than that of a ball of the densest matter, down to zero."""
    try:
        body = RigidBody(declared.mass, declared.inertia)
    except PolhodeError:
        return False
    return too_dense(body) is not None


def _reach(robot: Robot, geometry: Sequence[Geometry]) -> float:
    """Return the largest extent of the robot, by its joints and the shapes that were read."""
    joints = sum(link.reach for link in robot.links)
    shapes = (
        float(np.linalg.norm(each.high - each.low))
        for each in geometry
        if each.low is not None and each.high is not None
    )
    return joints + sum(shapes)


def _placeholders(links: Sequence[Link]) -> dict[float, int]:
    """Count the links of each isotropic moment of nothing: 0, 1, or the same at unlike masses."""
    masses = defaultdict(list)
    for link in links:
        if link.inertial is None or _is_empty(link.inertial) or link.is_static:
            continue
        if (moment := _isotropic(link.inertial.inertia)) is not None:
            masses[moment].append(link.inertial.mass)
    return {m: len(held) for m, held in masses.items() if m in (0.0, 1.0) or len(set(held)) > 1}


def _isotropic(tensor: Floats) -> float | None:
    moment = float(f"{tensor[0, 0]:.9g}")  # which the turn of its axes leaves alone
    return moment if np.allclose(tensor, moment * np.eye(3), rtol=0.0, atol=1e-9 * abs(moment)) else None


class _VerdictData(NamedTuple):
    """Data for the verdict of a link besides the link itself."""

    geometry: GeometryReader
    format: str
    placeholders: dict[float, int]
    reach: float
    is_all: bool

    def link(self, link: Link, geometry: Geometry, role: LinkRole) -> Verdict:
        """Judge a link."""
        notes, declared = geometry.notes, link.inertial
        if link.is_static:
            told = (*notes, link.problem) if link.problem else notes
            return Verdict(link.name, link.line, "none", "nothing moves it: its model is static", notes=told)
        if link.problem:
            return Verdict(link.name, link.line, "unreadable", link.problem, law="unreadable")
        if link.defaults and not role.moves:
            return Verdict(
                link.name, link.line, "none", "nothing moves it: it is tied to the world", notes=notes
            )
        if not _has_mass(link, geometry):
            empty = judge_without_mass(self.format, link, role)
            told = (*notes, empty.note) if empty.note else notes
            notes = told if link.shapes else ()
            law: Law = "missing-mass" if empty.word == "missing" else ""
            return Verdict(link.name, link.line, empty.word, empty.reason, notes=notes, law=law)
        if declared is None:
            body = geometry.body
            if body is None:
                return Verdict(link.name, link.line, "inferred", "", notes=notes)
            values = float(body.mass), np.asarray(body.principal_moments)
            return Verdict(link.name, link.line, "inferred", "from its shapes", *values, notes=notes)
        own, factor = None, None
        if geometry.body is not None and declared.mass > 0.0:
            try:
                own = geometry.body.scaled(mass=declared.mass / float(geometry.body.mass))
            except PolhodeError as error:
                notes = (*notes, f"line {link.line}: its shape at the declared mass is no body: {error}")
        moments = np.asarray(principal_moments(declared.inertia))
        if own is not None:
            factor = _farthest(moments, own.principal_moments)
        better, inside = None, None
        is_point = _is_point(declared) and (own is None or not declared.inertia.any())
        if is_point and role.weld and self.format != "SDF":  # libsdformat refuses it all the same
            word: Word = "good"
            law = ""
            reason = f"a point mass, tied to {role.weld}"
            notes = (*notes, f"line {link.line}: {link.name} is {reason}: simulators join the two")
        else:
            word, law, reason = self._law(link, declared, geometry, own, factor)
            better = None if word in ("good", "coarse") else _better(declared, own, word)
        if word not in FAILURES:
            inside = _inside(declared)
        least = LEAST_MOMENT.get(self.format, 0.0)
        if better is not None and not (moment := _least_moment(better)) > least:
            what = "the nearest tensor of a body" if own is None else f"its {geometry.role} shape"
            notes = (
                *notes,
                f"line {link.line}: {link.name}: {what} has {_describe_refusal(moment, least)}: not written",
            )
            better = None
        if inside is not None and not float(moments[0]) > least:
            notes = (
                *notes,
                f"line {link.line}: {link.name} has {_describe_refusal(float(moments[0]), least)}",
            )
            inside = None
        elif inside is not None:
            notes = (
                *notes,
                f"line {link.line}: {link.name} is on the edge I1 + I2 = I3, as a plate without thickness: "
                "where it is turned, rounding may put it beyond, and MuJoCo refuses it there; --fix moves it "
                "inside by the last digits",
            )
        return Verdict(
            link.name,
            link.line,
            word,
            "; ".join(part for part in (link.defaults, reason) if part),
            declared.mass,
            moments,
            None if own is None else own.principal_moments,
            factor,
            geometry.role if own is not None else "",
            notes,
            None if better is None else _round_inertial(better),
            inside=inside,
            law=law,
        )

    def _law(
        self,
        link: Link,
        declared: Inertial,
        geometry: Geometry,
        own: RigidBody | None,
        factor: float | None,
    ) -> tuple[Word, Law, str]:
        """Return the first law that fails, in the order from simple to complex, and the reason."""
        try:
            body = RigidBody(declared.mass, declared.inertia, declared.center_of_mass)
        except InvalidInertiaError as error:  # its remedies are those of Python's arguments
            return "impossible", _law_of_body(declared), error.fault
        except PolhodeError as error:
            return "impossible", _law_of_body(declared), str(error)
        if geometry.unread or geometry.low is None:
            size = beyond_size(body, geometry, own, self.reach, is_all=self.is_all)
        else:
            size = beyond_room(body, geometry, lambda: self.geometry.coarseness(link))
        compared = _compare_with_shape(factor, geometry) if own is not None else ""
        needed = density_needed(declared.mass, geometry.volume, factor or 0.0)
        moment = _isotropic(declared.inertia)
        if moment is not None and moment in self.placeholders:
            count = self.placeholders[moment]
            told = f"{moment:g} {moment:g} {moment:g} {_STANDS_FOR.get(moment, 'in links of unlike mass')}"
            told = f"{told}; it stands in {count} links" if count > 1 else told
            is_true = own is not None and size is None and _are_near(own.inertia, declared.inertia)
            if not is_true:
                return (
                    "placeholder",
                    "placeholder",
                    _join_reasons(told, compared, size.reason if size else ""),
                )
        if size is not None and size.word == "impossible":
            return size.word, size.law, _join_reasons(compared, size.reason, size.why, needed)
        if geometry.marker is not None:
            told = (
                f"its mass would have {geometry.marker:.3g} kg/m^3 in its shapes, beyond {MARKER:g}: they "
                "are markers, and nothing else that was read tells its size"
            )
            return "suspect", "density", _join_reasons(told, *((size.reason, size.why) if size else ()))
        if factor is not None and not LEAST <= factor <= MOST:
            reasons = (size.reason, size.why) if size else ()
            return "suspect", "shape", _join_reasons(compared, *reasons, needed)
        if size is not None and size.word == "coarse":
            return size.word, size.law, _join_reasons(compared, size.reason)
        if size is None and own is None:
            size = too_dense(body)
        if size is not None:
            return size.word, size.law, _join_reasons(size.reason, size.why)
        return "good", "", compared


def _law_of_body(declared: Inertial) -> Law:
    """Return which law of every body mass properties break."""
    if not declared.mass > 0.0:
        return "mass"
    return "moments" if _least_moment(declared) < 0.0 else "triangle-inequality"


def _are_near(one: Floats, other: Floats) -> bool:
    """Return whether two tensors differ by less than a hundredth of the first."""
    return bool(np.abs(one - other).max() <= 0.01 * np.abs(one).max())


def _join_reasons(*reasons: str) -> str:
    return "; ".join(reason for reason in reasons if reason)


def _fill_masses(
    robot: Robot,
    verdicts: list[Verdict],
    geometry: GeometryReader,
    density: float | None,
    mass: float | None,
) -> list[Verdict]:
    """Compute mass and inertia of links without a mass from their shapes, by a density or a common mass."""
    if density is None and mass is None:
        return verdicts
    without = {
        i: body
        for i, (link, verdict) in enumerate(zip(robot.links, verdicts, strict=True))
        if is_without_mass(link, verdict)
        if (body := geometry.fill_shapes(link)) is not None
    }
    volume = sum(float(body.mass) for body in without.values())
    unread = [
        link.name
        for link, verdict in zip(robot.links, verdicts, strict=True)
        if is_without_mass(link, verdict) and link.shapes and geometry.fill_shapes(link) is None
    ]
    if mass is not None and unread:
        raise PolhodeError(
            Argument("mass"),
            f": the shape of {unread[0]}, which has no mass, tells no volume, so that its share is not "
            "known; pass ",
            Argument("density"),
            " instead",
        )
    if mass is not None and mass > MARKER * volume > 0.0:
        raise PolhodeError(
            Argument("mass"),
            f": {mass:.6g} kg in the shapes of links without mass would be {mass / volume:.3g} kg/m^3, "
            f"and no matter has more than {MARKER:g}: the shapes are markers, or their lengths are wrong; "
            "correct the file, or pass less",
        )
    for i, body in without.items():
        weighed = body.scaled(mass=density if density is not None else (mass or 0.0) / volume)
        better = Inertial(float(f"{float(weighed.mass):.9g}"), weighed.center_of_mass, weighed.inertia)
        found, least = verdicts[i], LEAST_MOMENT.get(robot.format, 0.0)
        if not (moment := _least_moment(better)) > least:
            reason = _describe_refusal(moment, least)
            told = f"line {found.line}: {found.name}: its shape has {reason}: not written"
            verdicts[i] = found._replace(notes=(*found.notes, told))
            continue
        verdicts[i] = found._replace(
            shape_moments=weighed.principal_moments,
            shapes=geometry.read(robot.links[i]).role,
            better=_round_inertial(better),
        )
    return verdicts


def _farthest(declared: Floats, own: Floats) -> float | None:
    """Return the ratio of moments that is farthest from 1, either way."""
    ratios = np.where(own > 0.0, declared / own, np.nan)
    distance = np.abs(np.log(np.where(ratios > 0.0, ratios, np.nan)))
    return None if np.isnan(distance).all() else float(ratios[np.nanargmax(distance)])


def _compare_with_shape(factor: float | None, geometry: Geometry) -> str:
    if factor is None or 0.99 <= factor <= 1.01:
        return "" if factor is None else f"as its {geometry.role} shape"
    return f"{times(factor)} its {geometry.role} shape's"


def _better(declared: Inertial, own: RigidBody | None, word: Word) -> Inertial | None:
    """Find better values for the declaration."""
    if own is not None:
        return Inertial(declared.mass, own.center_of_mass, own.inertia)
    if word == "impossible" and declared.mass > 0.0:
        try:
            nearest, distance = nearest_valid(declared.inertia)
        except PolhodeError:
            return None
        if 0.0 < distance <= _NEAR * float(np.linalg.norm(declared.inertia)):
            return declared._replace(inertia=nearest)
    return None


def _inside(declared: Inertial) -> Inertial | None:
    tensor = inside_edge(declared.inertia)
    return None if tensor is declared.inertia else declared._replace(inertia=tensor)


def _least_moment(inertial: Inertial) -> float:
    return float(principal_moments(inertial.inertia)[0])


def _describe_refusal(moment: float, least: float) -> str:
    told = f"a moment of {moment:.3g} kg m^2"
    return f"{told}, and MuJoCo refuses what has no more than {least:g}" if least else f"{told}, no extent"


def _round_inertial(found: Inertial) -> Inertial:
    """Round to nine digits if the rounded tensor is possible; else move it inside the possible ones."""
    rounded = Inertial(found.mass, _nine(found.center_of_mass), _nine(found.inertia))
    if inside_edge(rounded.inertia) is rounded.inertia:
        return rounded
    return found._replace(inertia=inside_edge(found.inertia))


def _nine(values: Floats) -> Floats:
    """Round to nine digits of the largest, so that rounding left over from turning is 0."""
    largest = float(np.abs(values).max())
    if largest == 0.0:
        return values
    digits = 9 - int(np.ceil(np.log10(largest)))
    return np.round(values, digits) + 0.0


_FREE: Final = ("floating", "free")


class LinkRole(NamedTuple):
    """Role of a link in its robot.

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


def link_roles(robot: Robot, has_mass: Sequence[bool], has_spread: Sequence[bool]) -> list[LinkRole]:
    """For each link: find whether it can move, and which links below it have mass.

    Parameters
    ----------
    robot : Robot
        Its joints may name links that are not there, which are passed over, and may run in circles.
    has_mass, has_spread : sequence of bool
        Of each link: whether it has mass, and whether a body has its tensor with three moments above 0.

    Returns
    -------
    list of LinkRole
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
    told: list[LinkRole] = []
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
        role = LinkRole(moves, group.joint or "", group.carrier, weld, carries_mass, stands_for, is_root)
        told.append(role)
    return told


def _with_mass_below(groups: Iterable[_Group]) -> set[_Group]:
    """Return the groups that have mass, themselves or in what hangs on them."""
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


class MasslessVerdict(NamedTuple):
    """The verdict of a link without mass: the word, why, and what simulators make of it."""

    word: Literal["none", "missing"]
    reason: str
    note: str = ""


def judge_without_mass(robot_format: str, link: Link, role: LinkRole) -> MasslessVerdict:
    """Judge a link without mass.

    A mass matrix is singular where a joint moves what has no mass and carries none. MuJoCo refuses every body
    that joints move without mass, what it carries not counted; nothing else does.
    """
    if role.carrier:
        return MasslessVerdict("none", f"tied to {role.carrier}, which has mass")
    if not role.moves:
        note = ""
        if role.is_root and link.shapes:
            note = (
                f"line {link.line}: {link.name} is the root, with shapes and without mass: Pinocchio and "
                "MuJoCo hold it still, Drake and Gazebo let it fall unless it is tied to the world"
            )
        return MasslessVerdict("none", "no joint moves it", note)
    if not role.joint and not link.shapes and link.inertial is None:
        return MasslessVerdict("none", "nothing is tied to it")
    mover = f"joint {role.joint} moves it" if role.joint else "nothing holds it"
    if not role.stands_for:
        return MasslessVerdict("none", f"{mover} with what it is tied to, which is told there")
    shaped = "it has shape but no mass" if link.shapes else "no mass is tied to it"
    if not role.carries_mass:
        return MasslessVerdict("missing", f"{mover}, and {shaped}: the mass matrix is singular there")
    if robot_format == "MJCF":
        return MasslessVerdict("missing", f"{mover}, and {shaped}: MuJoCo refuses it, whatever it carries")
    if link.shapes:
        return MasslessVerdict(
            "missing", f"{mover}, and {shaped}: what it carries has mass, its own is left out"
        )
    return MasslessVerdict("none", f"{mover} without mass; what it carries has mass")
