"""URDF: ``<robot>`` with ``<link>`` elements; angles are roll, pitch, yaw about fixed axes."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from polhode import euler_angles
from polhode._core import rotate
from polhode.errors import FileFormatError
from polhode.files.xml_source import Edit, Element, blanks_of, set_attribute
from polhode.robots.model import Inertial, Link, Place, Shape, numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path
    from typing import Literal

    from numpy.typing import NDArray

    from polhode.robots.sources import Sources

__all__ = ["LinkReader", "forms", "links", "roll_pitch_yaw", "tensor_text"]

_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


class LinkReader(NamedTuple):
    """How a format says what a link has.

    Attributes
    ----------
    inertial, shapes : callable
        Read ``<inertial>``, and the shapes of a link.
    rewrite : callable
        Of ``<inertial>``, the source and other mass properties: the edits that write them.
    """

    inertial: Callable[[Element], Inertial]
    shapes: Callable[[Element], Iterator[Shape]]
    rewrite: Callable[[Element, bytes, Inertial], list[Edit]]

    def read(
        self, element: Element, sources: Sources, folder: Path, prefix: str, *, inferred: bool = False
    ) -> Link:
        """Read a link; what is wrong with its numbers is kept for the verdict."""
        inertial: Inertial | None = None
        shapes: tuple[Shape, ...] = ()
        problem = ""
        declared = element.find("inertial")
        try:
            inertial = None if declared is None or inferred else self.inertial(declared)
            shapes = tuple(self.shapes(element))
        except FileFormatError as error:
            problem = str(error)
        return Link(
            name=sources.name(prefix, element.attributes.get("name", "(without a name)"), element),
            line=element.line,
            inertial=inertial,
            problem=problem,
            shapes=shapes,
            inferred=inferred,
            rewrite=partial(self.rewrite, declared) if declared is not None and not declared.file else None,
            file=element.file,
            folder=folder,
        )


def links(root: Element, sources: Sources, folder: Path | None = None, prefix: str = "") -> Iterator[Link]:
    """Read the links of a robot, in the folder of its file if that is another one's."""
    reader = LinkReader(_inertial, _shapes, _rewrite)
    for element in root.all("link"):
        yield reader.read(element, sources, folder or sources.folder, prefix)


def forms(link: Element) -> Iterator[tuple[Literal["collision", "visual"], Element, Element]]:
    """Give the shapes of a link: what each serves for, its element and that of its form, as ``<box>``."""
    roles: tuple[Literal["collision", "visual"], ...] = ("collision", "visual")
    for role in roles:
        for element in link.all(role):
            geometry = element.find("geometry")
            if geometry is not None and geometry.children:
                yield role, element, geometry.children[0]


def roll_pitch_yaw(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation matrix of turns about the fixed axes x, then y, then z."""
    quaternion = euler_angles.to_quaternion(angles, "xyz")
    matrix: NDArray[np.float64] = np.stack([rotate(quaternion, axis) for axis in np.eye(3)], axis=-1)
    return matrix


def tensor_text(tensor: NDArray[np.float64]) -> dict[str, str]:
    """Write the six elements of a tensor by their names."""
    places = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    return {name: repr(float(tensor[place]) + 0.0) for name, place in places.items()}


def _place(element: Element | None) -> Place:
    if element is None:
        return Place.here()
    attributes = element.attributes
    position = numbers(element, attributes.get("xyz", "0 0 0"), 3, "xyz")
    angles = numbers(element, attributes.get("rpy", "0 0 0"), 3, "rpy")
    return Place(roll_pitch_yaw(angles), position)


def _inertial(element: Element) -> Inertial:
    place = _place(element.find("origin"))
    mass, inertia = element.find("mass"), element.find("inertia")
    if mass is None or inertia is None:
        missing = "mass" if mass is None else "inertia"
        raise FileFormatError(f"{element.where}: <inertial> without <{missing}>; add it")
    (value,) = numbers(mass, mass.attributes.get("value"), 1, "mass value")
    xx, yy, zz, xy, xz, yz = (numbers(inertia, inertia.attributes.get(name), 1, name)[0] for name in _MOMENTS)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(float(value), place.position, place.rotation @ tensor @ place.rotation.T)


def _shapes(link: Element) -> Iterator[Shape]:
    for role, element, form in forms(link):
        place = _place(element.find("origin"))
        read = partial(_size, form)
        if form.tag == "box":
            yield Shape("box", read("size", 3), place, role, where=form.where)
        elif form.tag == "sphere":
            yield Shape("sphere", read("radius"), place, role, where=form.where)
        elif form.tag in ("cylinder", "capsule"):
            size = (*read("radius"), *read("length"))
            yield Shape(form.tag, size, place, role, where=form.where)
        elif form.tag == "mesh":
            scale = tuple(numbers(form, form.attributes.get("scale", "1 1 1"), 3, "scale").tolist())
            address = form.attributes.get("filename", "")
            yield Shape("mesh", scale, place, role, mesh=address, where=form.where)
        else:
            yield Shape(form.tag, (), place, role, where=form.where)


def _size(form: Element, name: str, count: int = 1) -> tuple[float, ...]:
    size: tuple[float, ...] = tuple(
        numbers(form, form.attributes.get(name), count, f"{form.tag} {name}").tolist()
    )
    return size


def _rewrite(declared: Element, source: bytes, new: Inertial) -> list[Edit]:
    """Write mass properties with the axes of the link."""
    position = " ".join(repr(float(x) + 0.0) for x in new.center_of_mass)
    edits = []
    origin = declared.find("origin")
    if origin is not None:
        edits.append(set_attribute(source, origin, "xyz", position))
        if "rpy" in origin.attributes:
            edits.append(set_attribute(source, origin, "rpy", "0 0 0"))
    elif np.any(new.center_of_mass):
        # Before the first child, behind the same indentation.
        first = declared.children[0].start if declared.children else declared.inside
        blanks = blanks_of(source[declared.inside : first])
        edits.append(Edit(first, first, f'<origin xyz="{position}" rpy="0 0 0"/>{blanks}'))
    for inertia in declared.all("inertia"):
        edits += [
            set_attribute(source, inertia, name, text) for name, text in tensor_text(new.inertia).items()
        ]
    return edits
