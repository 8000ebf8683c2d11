"""URDF: ``<robot>`` with ``<link>`` elements; angles are roll, pitch, yaw about fixed axes."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from polhode import euler_angles
from polhode._core import rotate
from polhode._format import Note
from polhode.errors import FileFormatError
from polhode.io.xml_source import Edit, Element, blanks_of
from polhode.robots.edits import attribute, first_child, indent_element, number_text
from polhode.robots.model import WORLD, Inertial, Joint, Link, Place, Shape, Spot, numbers, scale

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path
    from typing import Literal

    from numpy.typing import NDArray

    from polhode.robots.sources import Sources

__all__ = ["LinkReader", "forms", "links", "roll_pitch_yaw", "tensor_text"]

_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


class LinkReader(NamedTuple):
    """Reader of links: how a format states their inertia and shapes.

    Attributes
    ----------
    inertial, shapes : callable
        Read ``<inertial>``, and the shapes of a link.
    rewrite : callable
        Of the link, its ``<inertial>``, the source and other mass properties: the edits that write them.
    """

    inertial: Callable[[Element], Inertial]
    shapes: Callable[[Element], Iterator[Shape]]
    rewrite: Callable[[Element, Element | None, bytes, Inertial], list[Edit]]

    def read(
        self, element: Element, sources: Sources, folder: Path, prefix: str, *, inferred: bool = False
    ) -> Link:
        """Read a link; faults of its numbers are stored for the verdict."""
        inertial: Inertial | None = None
        shapes: tuple[Shape, ...] = ()
        problem = ""
        declared = element.find("inertial")
        try:
            inertial = None if declared is None or inferred else self.inertial(declared)
            shapes = tuple(self.shapes(element))
        except FileFormatError as error:
            problem = Note(*error.args)
        return Link(
            name=sources.name(prefix, element.attributes.get("name", "(without a name)"), element),
            line=element.line,
            inertial=inertial,
            problem=problem,
            shapes=shapes,
            inferred=inferred,
            rewrite=None if element.file else partial(self.rewrite, element, declared),
            file=element.file,
            folder=folder,
            own_name=element.attributes.get("name", ""),
            element=element,
        )


def links(
    root: Element, sources: Sources, folder: Path | None = None, prefix: str = "", scope: str = ""
) -> Iterator[Link]:
    """Read the links of a robot, in the folder of its file if that is another one's, and its joints."""
    reader = LinkReader(_inertial, _shapes, _rewrite)
    reaches: dict[str, float] = {}
    for element in root.all("joint"):
        parent, child = (_end(element, tag) for tag in ("parent", "child"))
        kind = element.attributes.get("type", "")
        ends = (name if name == WORLD else scope + name for name in (parent, child))
        sources.joints.append(Joint(element.attributes.get("name", ""), kind, *ends))
        with suppress(FileFormatError):
            reaches[child] = float(np.linalg.norm(_place(element.find("origin")).position))
    met: set[str] = set()
    for element in root.all("link"):
        for note in _oddities(element, met):
            sources.notes[note] = None
        link = reader.read(element, sources, folder or sources.folder, prefix)
        name = element.attributes.get("name", "(without a name)")
        key = name if name == WORLD else scope + name
        yield replace(link, key=key, reach=reaches.get(name, 0.0))


def _oddities(link: Element, met: set[str]) -> Iterator[str]:
    """Return notes on content of a link that is not read; `met` are the names of the links before it."""
    name = link.attributes.get("name", "")
    if name in met:
        yield f"{link.where}: link {name!r} again; parsers refuse two links of one name: rename one"
    met.add(name)
    inertials = list(link.all("inertial"))
    if len(inertials) > 1:
        yield f"{inertials[1].where}: <inertial> again in link {name!r}; only the first is read: leave one"
    inertia = inertials[0].find("inertia") if inertials else None
    unknown = sorted(set(inertia.attributes) - set(_MOMENTS)) if inertia is not None else []
    if unknown:
        yield (
            f"{link.where}: link {name!r}: <inertia> has {', '.join(unknown)}, which no parser reads; "
            f"its attributes are {', '.join(_MOMENTS)}"
        )


def _end(joint: Element, tag: str) -> str:
    end = joint.find(tag)
    return end.attributes.get("link", "") if end is not None else ""


def forms(link: Element) -> Iterator[tuple[Literal["collision", "visual"], Element, Element]]:
    """Return the shapes of a link: what each serves for, its element and that of its form, as ``<box>``."""
    roles: tuple[Literal["collision", "visual"], ...] = ("collision", "visual")
    for role in roles:
        for element in link.all(role):
            geometry = element.find("geometry")
            if geometry is not None and geometry.children:
                yield role, element, geometry.children[0]


def roll_pitch_yaw(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the rotation matrix of turns about the fixed axes x, then y, then z."""
    quaternion = euler_angles.to_quaternion(angles, "xyz")
    matrix: NDArray[np.float64] = np.stack([rotate(quaternion, axis) for axis in np.eye(3)], axis=-1)
    return matrix


def tensor_text(tensor: NDArray[np.float64]) -> dict[str, str]:
    """Write the six elements of a tensor by their names."""
    places = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    return {name: repr(float(tensor[place]) + 0.0) for name, place in places.items()}


def _place(element: Element | None) -> Place:
    if element is None:
        return Place.identity()
    attributes = element.attributes
    position = numbers(element, attributes.get("xyz", "0 0 0"), 3, "xyz")
    angles = numbers(element, attributes.get("rpy", "0 0 0"), 3, "rpy")
    return Place(roll_pitch_yaw(angles), position)


def _inertial(element: Element) -> Inertial:
    place = _place(element.find("origin"))
    mass, inertia = element.find("mass"), element.find("inertia")
    if mass is None or inertia is None:
        missing = "mass" if mass is None else "inertia"
        raise FileFormatError(Spot(element, ""), f": <inertial> without <{missing}>; add it")
    (value,) = numbers(mass, mass.attributes.get("value"), 1, "mass value")
    xx, yy, zz, xy, xz, yz = (numbers(inertia, inertia.attributes.get(name), 1, name)[0] for name in _MOMENTS)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(float(value), place.position, place.rotation @ tensor @ place.rotation.T)


def _shapes(link: Element) -> Iterator[Shape]:
    for role, element, form in forms(link):
        try:
            yield _shape(element, form, role)
        except FileFormatError as error:
            if role == "collision":
                raise
            yield Shape(form.tag, (), Place.identity(), role, where=form.where, problem=Note(*error.args))


def _shape(element: Element, form: Element, role: Literal["collision", "visual"]) -> Shape:
    place = _place(element.find("origin"))
    read = partial(_size, form)
    if form.tag == "box":
        return Shape("box", read("size", 3), place, role, where=form.where)
    if form.tag == "sphere":
        return Shape("sphere", read("radius"), place, role, where=form.where)
    if form.tag in ("cylinder", "capsule"):
        size = (*read("radius"), *read("length"))
        return Shape(form.tag, size, place, role, where=form.where)
    if form.tag == "mesh":
        factors = scale(form, form.attributes.get("scale", "1"))
        address = form.attributes.get("filename", "")
        return Shape("mesh", factors, place, role, mesh=address, where=form.where)
    return Shape(form.tag, (), place, role, where=form.where)


def _size(form: Element, name: str, count: int = 1) -> tuple[float, ...]:
    size: tuple[float, ...] = tuple(
        numbers(form, form.attributes.get(name), count, f"{form.tag} {name}").tolist()
    )
    return size


def _rewrite(link: Element, declared: Element | None, source: bytes, new: Inertial) -> list[Edit]:
    """Write mass properties with the axes of the link."""
    position = number_text(new.center_of_mass)
    if declared is None:
        tensor = " ".join(f'{name}="{text}"' for name, text in tensor_text(new.inertia).items())
        parts = [f'<origin xyz="{position}" rpy="0 0 0"/>'] if np.any(new.center_of_mass) else []
        parts += [f'<mass value="{new.mass!r}"/>', f"<inertia {tensor}/>"]
        return [first_child(source, link, indent_element(source, link, "<inertial>", parts, "</inertial>"))]
    edits = []
    origin = declared.find("origin")
    if origin is not None:
        edits += attribute(source, origin, "xyz", position)
        if "rpy" in origin.attributes:
            edits += attribute(source, origin, "rpy", "0 0 0")
    elif np.any(new.center_of_mass):
        # Before the first child, behind the same indentation.
        first = declared.children[0].start if declared.children else declared.inside
        blanks = blanks_of(source[declared.inside : first])
        edits.append(Edit(first, first, f'<origin xyz="{position}" rpy="0 0 0"/>{blanks}'))
    for mass in declared.all("mass"):
        edits += attribute(source, mass, "value", repr(new.mass))
    for inertia in declared.all("inertia"):
        for name, text in tensor_text(new.inertia).items():
            edits += attribute(source, inertia, name, text)
    return edits
