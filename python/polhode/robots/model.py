"""Links and joints of a robot, the same for all file formats."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np

from polhode.errors import FileFormatError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode.io.xml_source import Edit, Element

    Floats = NDArray[np.float64]

__all__ = [
    "WORLD",
    "Compiler",
    "Inertial",
    "Joint",
    "Link",
    "Place",
    "Robot",
    "Shape",
    "Spot",
    "numbers",
    "quote",
    "scale",
    "shorten",
    "unit",
]

WORLD: Final = "world"
"""Name of the fixed world in a joint."""


class Spot(NamedTuple):
    """Place of a fault, a piece of a message: an element, and the name of what is wrong in it.

    It is written as the line of the element. The name is that of an attribute; "" for the element itself.
    """

    element: Element
    name: str

    def __str__(self) -> str:
        return self.element.where


class Place(NamedTuple):
    """Position and rotation in another frame: v_frame = rotation @ v + position."""

    rotation: Floats
    position: Floats

    @classmethod
    def identity(cls) -> Place:
        """Return the identity: no rotation, no displacement."""
        return cls(np.eye(3), np.zeros(3))

    def then(self, inner: Place) -> Place:
        """Compose two placements: first `inner`, then this one."""
        return Place(self.rotation @ inner.rotation, self.rotation @ inner.position + self.position)


class Inertial(NamedTuple):
    """Declared mass properties, in the axes of the link and relative to its origin.

    Attributes
    ----------
    mass : float
    center_of_mass : numpy.ndarray, shape (3,)
    inertia : numpy.ndarray, shape (3, 3)
        Tensor about the centre of mass.
    """

    mass: float
    center_of_mass: Floats
    inertia: Floats


@dataclass(frozen=True)
class Shape:
    """One piece of a link's geometry.

    Attributes
    ----------
    kind : str
        ``"box"``, ``"sphere"``, ``"cylinder"``, ``"capsule"``, ``"ellipsoid"``, ``"mesh"``; the volume of any
        other kind is not known.
    size : tuple of float
        For these kinds in this order: sides; radius; radius and length; radius and length of the straight
        part; semi-axes; scale.
    place : Place
        Place in the link.
    role : {"collision", "visual"}
    mesh : str
        Address of a mesh, as the file has it.
    density : float
        Density relative to the other shapes of the link.
    mass : float, optional
        Mass of this shape, if the file gives one.
    where : str
        Line in the file, with the name of the file if it is an included one.
    problem : str
        Why the numbers of a visual shape cannot be read; "" if they can. If those of a collision shape cannot
        be read, the link is ``"unreadable"``.
    counting : str
        How a simulator that computes the inertia fills a mesh: ``"legacy"`` or ``"convex"`` (MuJoCo); or
        ``"shell"`` of a mesh or another shape whose mass is on its surface, where `density` is per area. For
        any other value the shape is filled as it is.
    """

    kind: str
    size: tuple[float, ...]
    place: Place
    role: Literal["collision", "visual"]
    mesh: str = ""
    density: float = 1.0
    mass: float | None = None
    where: str = ""
    problem: str = ""
    counting: str = ""


class Compiler(NamedTuple):
    """Settings of MuJoCo's compiler that change the bodies of a model.

    Attributes
    ----------
    mass, moment : float
        Least mass and principal moment of a body.
    is_balanced : bool
        Whether moments that no body has become their mean.
    """

    mass: float = 0.0
    moment: float = 0.0
    is_balanced: bool = False


class Joint(NamedTuple):
    """A joint between two links.

    Attributes
    ----------
    name : str
    kind : str
        Kind of the joint as in the file; ``"fixed"`` if it allows no motion.
    parent, child : str
        Keys of the two links; ``"world"`` for the frame that never moves.
    """

    name: str
    kind: str
    parent: str
    child: str


@dataclass(frozen=True)
class Link:
    """One link.

    Attributes
    ----------
    name : str
    line : int
        Line of its element in the file.
    inertial : Inertial or None
        What the file declares.
    problem : str
        Why the declaration, or a shape, cannot be read; "" if they can.
    shapes : tuple of Shape
    inferred : bool
        Whether a simulator computes the inertia from the geometry: in MJCF if none is declared, in SDF if the
        file says so.
    rewrite : callable, optional
        Function that takes the source and new mass properties and returns the changes of the file; None if
        the link is in another file.
    file : str
        File that contains the link, if the robot file includes it.
    folder : pathlib.Path, optional
        Folder from which relative addresses of its meshes are read; that of the robot by default.
    key : str
        The name by which joints refer to the link: the names of the models that contain it, and its own.
    defaults : str
        Values that the file leaves out and the format replaces by defaults (SDF: 1 kg, the unit tensor); ""
        for none.
    is_static : bool
        Whether it belongs to a model that never moves.
    reach : float
        Distance of the link from the frame in which the file places it, in metres.
    compiler : Compiler, optional
        Settings of the MJCF compiler, if they change anything.
    own_name : str
        The name of the link in its own file, the same in every robot that includes the file: without what
        the including files put before it, and without numbers of lines.
    element : Element, optional
        Where it stands in the source.
    macros : tuple of str
        The macro calls of xacro that made it, from the outermost, each with file and line.
    """

    name: str
    line: int
    inertial: Inertial | None
    problem: str = ""
    shapes: tuple[Shape, ...] = ()
    inferred: bool = False
    rewrite: Callable[[bytes, Inertial], list[Edit]] | None = field(default=None, compare=False)
    file: str = ""
    folder: Path | None = None
    key: str = ""
    defaults: str = ""
    is_static: bool = False
    reach: float = 0.0
    compiler: Compiler | None = None
    own_name: str = ""
    element: Element | None = field(default=None, compare=False, repr=False)
    macros: tuple[str, ...] = ()


@dataclass(frozen=True)
class Robot:
    """A robot file.

    Attributes
    ----------
    format : {"URDF", "SDF", "MJCF"}
    name : str
        Name of the robot, model or world.
    links : tuple of Link
    folder : pathlib.Path
        Where relative addresses start.
    source : bytes
        The file.
    notes : tuple of str
        Parts of the file that are not tested.
    roots : tuple of pathlib.Path
        Further folders in which its files may be: the real folder of the file, if it was read through a
        symbolic link.
    joints : tuple of Joint
    total_mass : float
        The total mass to which the MJCF compiler scales all bodies together; 0 if it does not scale.
    files : dict of str to pathlib.Path
        The included files, by their names in :attr:`Link.file`; a name that stands for two files is left out.
    """

    format: str
    name: str
    links: tuple[Link, ...]
    folder: Path
    source: bytes
    notes: tuple[str, ...] = ()
    roots: tuple[Path, ...] = ()
    joints: tuple[Joint, ...] = ()
    total_mass: float = 0.0
    files: Mapping[str, Path] = field(default_factory=dict)


# Longer texts hold no few numbers; the file may say them of many elements.
_LONGEST: Final = 1000
# Five such lengths multiply in a tensor of density 1; beyond it numbers have no room.
_LARGEST: Final = 1e50


def numbers(element: Element, text: str | None, count: int | None, what: str) -> Floats:
    """Read the numbers of an attribute or a text.

    Raises
    ------
    FileFormatError
        With the line, unless there are `count` finite numbers (any number of them for None), none beyond
        1e50 in size.
    """
    # Python reads 1_0 and other scripts' digits as numbers, which no simulator does.
    is_plain = text is not None and len(text) <= _LONGEST and text.isascii() and "_" not in text
    try:
        values = np.array([float(word) for word in text.split()] if text and is_plain else [])
    except ValueError:
        values = np.array([np.nan])
    is_wrong = bool(text) and not is_plain
    if is_wrong or not np.isfinite(values).all() or (count is not None and len(values) != count):
        wanted = (
            "a finite number" if count == 1 else f"{count or ''} finite numbers".replace("  ", " ").strip()
        )
        way_out = "; expand the file with xacro first" if text and "${" in text else ""
        must = f"{wanted} has to stand" if count == 1 else f"{wanted} have to stand"
        given = "is missing," if text is None else f"is {quote(text)}"
        raise FileFormatError(Spot(element, what), f": {what} {given} where {must}{way_out}")
    if values.size and np.abs(values).max() > _LARGEST:
        raise FileFormatError(
            Spot(element, what),
            f": {what} is {quote(text)}, beyond {_LARGEST:g}, where squares have no "
            "room in numbers; correct it",
        )
    return values


def scale(element: Element, text: str) -> tuple[float, ...]:
    """Read the scale of a mesh; one number stands for all three axes."""
    count = 1 if len(text[:_LONGEST].split()) == 1 else 3
    values: tuple[float, ...] = tuple(numbers(element, text, count, "scale").tolist())
    return values * (3 // count)


def unit(element: Element, vector: Floats) -> Floats:
    """Return the direction of a vector, or the quaternion of a rotation, of length 1.

    Raises
    ------
    FileFormatError
        With the line, if its length is zero.
    """
    largest = float(np.abs(vector).max())
    if largest == 0.0:
        raise FileFormatError(f"{element.where}: a direction of length zero; give one")
    # A power of two changes no digit, and keeps the squares from over- and underflow.
    scaled = np.ldexp(vector, -int(np.frexp(largest)[1])) if not 1e-100 < largest < 1e100 else vector
    direction: Floats = scaled / np.linalg.norm(scaled)
    return direction


def shorten(text: str, most: int = 200) -> str:
    """Return a text; a long one as its beginning and its length."""
    return text if len(text) <= most else f"{text[:most]}... ({len(text)} characters)"


def quote(text: str | None, most: int = 80) -> str:
    """Return a text between quotes, a long one shortened; ``None`` if there is no text."""
    if text is None or len(text) <= most:
        return repr(text)
    return f"{text[:most]!r}... ({len(text)} characters)"
