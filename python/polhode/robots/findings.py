"""Findings of a check: the law that a link breaks, the number at fault, and the edits that put it right."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from polhode._format import Note
from polhode.io.xml_source import attribute_span, text_span, word_span
from polhode.robots.model import Spot
from polhode.robots.verdict import replacement

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from polhode.io.xml_source import Edit, Element
    from polhode.robots.model import Link, Robot
    from polhode.robots.verdict import Verdict

    Span = tuple[int, int]

__all__ = ["EDGE", "LAWS", "Finding", "Rule", "findings"]

EDGE: Final = "edge"


class Rule(NamedTuple):
    """A law in words: what holds for every link, and what to do where it does not."""

    says: str
    way_out: str


LAWS: Final = {
    "unreadable": Rule(
        "Every number of the inertia and of the collision shapes is there, and is a finite number.",
        "Write the number that is missing; expand macros with xacro.",
    ),
    "missing-mass": Rule(
        "What a joint moves has mass, itself or tied to it; else the mass matrix is singular.",
        "Declare mass and inertia. --fix FILE with --density or --mass computes them from the shapes.",
    ),
    "mass": Rule("The mass of a body is above 0.", "Weigh the part, or compute its mass from its volume."),
    "moments": Rule(
        "No principal moment of a body is below 0: each is a sum of masses times squared distances.",
        "Look for products of inertia that are too large, or that have the wrong sign.",
    ),
    "triangle-inequality": Rule(
        "No principal moment of a body is larger than the sum of the two others: I1 + I2 >= I3.",
        "Look for numbers in another unit or about another point than the centre of mass. The fix writes the "
        "inertia of the shapes, or the nearest tensor that a body has.",
    ),
    "placeholder": Rule(
        "An inertia comes from the body: it is not the unit tensor, zero, or the same for unlike masses.",
        "The fix writes the inertia of the shapes, filled evenly with the declared mass.",
    ),
    "center-of-mass": Rule(
        "The centre of mass lies within the box around the shapes of its link.",
        "Look at the origin of <inertial>: it is relative to the link, in metres.",
    ),
    "room": Rule(
        "The shapes of a link have room for its mass, spread as its tensor says.",
        "Look for moments in another unit (g mm^2 are 1e-9 kg m^2), or for shapes scaled from mm.",
    ),
    "shape": Rule(
        "Moments are between 1/10 and 3 times those of the shapes filled evenly with the declared mass.",
        "Compare the moments with the drawing; a heavy core or a thin shell may be meant.",
    ),
    "density": Rule(
        "No matter is denser than osmium, 22,590 kg/m^3.",
        "Look for a mass in another unit, or for shapes that are only markers.",
    ),
    EDGE: Rule(
        "A tensor is inside the edge I1 + I2 = I3, beyond which rounding in a turned frame may move it.",
        "The fix moves it inside by the last digits.",
    ),
}
"""What every link obeys, by the word of `Verdict.law`; the last one is told of tensors that pass."""


class Finding(NamedTuple):
    """A law that a link breaks.

    Attributes
    ----------
    link : Link
    law : str
        A key of :data:`LAWS`.
    verdict : str
        The word of the verdict; ``"good"`` for the edge.
    reason : str
        By how much.
    fails : bool
        Whether the verdict of the robot is bad by it.
    path : pathlib.Path or None
        The included file that holds the link; None for the robot's own file, and where it is not known.
    span : (int, int) or None
        Bytes of that file at which the offending number begins and ends; None where it is not known.
    edits : tuple of Edit
        What :func:`polhode.robots.fix` changes for it in the robot's own file.
    """

    link: Link
    law: str
    verdict: str
    reason: str
    fails: bool
    path: Path | None = None
    span: Span | None = None
    edits: tuple[Edit, ...] = ()


def findings(
    robot: Robot, verdicts: Sequence[Verdict], words: Collection[str], source_of: Callable[[Path], bytes]
) -> Iterator[Finding]:
    """Find the laws that the links of a robot break, in the order of the links.

    Parameters
    ----------
    robot : Robot
    verdicts : sequence of Verdict
        From :func:`polhode.robots.check`.
    words : collection of str
        Verdicts that fail, and that are fixed.
    source_of : callable
        Reads an included file.

    Yields
    ------
    Finding
        Their edits together are those of :func:`polhode.robots.fix`.
    """
    for link, verdict in zip(robot.links, verdicts, strict=True):
        better = replacement(verdict, words)
        edits: tuple[Edit, ...] = ()
        if better is not None and link.rewrite is not None:
            edits = tuple(sorted(link.rewrite(robot.source, better)))
        path = robot.files.get(link.file)
        source = source_of(path) if path is not None else b"" if link.file else robot.source
        is_edge = verdict.verdict not in words and verdict.inside is not None
        if verdict.law:
            span = _span(source, link, verdict) if source else None
            own = () if is_edge else edits
            reason = verdict.reason
            fails = verdict.verdict in words
            yield Finding(link, verdict.law, verdict.verdict, reason, fails, path, span, own)
        if is_edge:
            span = _number(source, link, "largest") if source else None
            reason = "its tensor is on the edge I1 + I2 = I3, where rounding may put it beyond"
            yield Finding(link, EDGE, verdict.verdict, reason, False, path, span, edits)


def _span(source: bytes, link: Link, verdict: Verdict) -> Span | None:
    if verdict.law == "unreadable":
        found = next(_spots([link.problem]), None)
        # A shape may stand in a class of another file, whose bytes are not these.
        if found is not None and found.element.file == link.file:
            return _of_spot(source, found)
        return _number(source, link, "")
    which = {"mass": "mass", "density": "mass", "missing-mass": "mass", "moments": "least"}
    which |= {"center-of-mass": "center_of_mass"}
    return _number(source, link, which.get(verdict.law, "largest"))


def _spots(pieces: Iterable[object]) -> Iterator[Spot]:
    for piece in pieces:
        if isinstance(piece, Note):
            yield from _spots(piece.pieces)
        elif isinstance(piece, Spot):
            yield piece


def _of_spot(source: bytes, spot: Spot) -> Span:
    element, name = spot.element, spot.name.rpartition(" ")[2]
    return attribute_span(source, element, name) or text_span(source, element) or _tag(element)


def _tag(element: Element) -> Span:
    """Return where the name of an element stands in its start tag."""
    return element.start + 1, element.start + 1 + len(element.tag.encode())


_DIAGONAL: Final = ("ixx", "iyy", "izz")


def _number(source: bytes, link: Link, which: str) -> Span | None:
    """Return where the mass, the centre or an element of the diagonal stands; else what should hold it."""
    element = link.element
    if element is None:
        return None
    declared = element.find("inertial")
    if declared is None or declared.file != element.file:
        return attribute_span(source, element, "name") or _tag(element)
    found = None
    if which == "mass":
        found = _mass(source, declared)
    elif which == "center_of_mass":
        found = _center(source, declared)
    elif which:
        found = _moment(source, declared, is_largest=which == "largest")
    return found or _tag(declared)


def _mass(source: bytes, declared: Element) -> Span | None:
    mass = declared.find("mass")
    if mass is None:
        return attribute_span(source, declared, "mass")
    return attribute_span(source, mass, "value") or text_span(source, mass)


def _center(source: bytes, declared: Element) -> Span | None:
    origin, pose = declared.find("origin"), declared.find("pose")
    if origin is not None:
        return attribute_span(source, origin, "xyz")
    return text_span(source, pose) if pose is not None else attribute_span(source, declared, "pos")


def _moment(source: bytes, declared: Element, *, is_largest: bool) -> Span | None:
    """Return where the largest or the least of the three numbers of the diagonal stands."""
    spans: list[Span | None] = []
    inertia = declared.find("inertia")
    if inertia is not None:
        for name in _DIAGONAL:
            child = inertia.find(name)
            spans.append(attribute_span(source, inertia, name) if child is None else text_span(source, child))
    else:
        name = "fullinertia" if "fullinertia" in declared.attributes else "diaginertia"
        whole = attribute_span(source, declared, name)
        spans = [word_span(source, whole, place) for place in range(3)] if whole is not None else []
    known = [(_value(source, span), span) for span in spans if span is not None]
    if not known:
        return _tag(inertia) if inertia is not None else None
    value, _ = max(known) if is_largest else min(known)
    return next(span for own, span in known if own == value)  # the first of equal ones


def _value(source: bytes, span: Span) -> float:
    try:
        return float(source[slice(*span)])
    except ValueError:
        return 0.0
