"""The shape of a body in a picture: its own surface, a given mesh, or the box of its inertia."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from polhode import _core
from polhode.draw.triangles import (
    balls_surface,
    both_sides,
    cluster_vertices,
    particles_surface,
    sheet_surface,
    solid_surface,
    subdivide,
    wire_surface,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from polhode import RigidBody

    Floats = NDArray[np.float64]
    Mesh: TypeAlias = tuple[ArrayLike, ArrayLike]
    GivenShape: TypeAlias = Mesh | list[RigidBody | Mesh]
    Surface = tuple[Floats, NDArray[np.int64]]
    Part = tuple[str, Floats, NDArray[np.uint32], list[float], bool]

__all__ = [
    "BOX_TINTS",
    "Piece",
    "Shape",
    "body_shape",
    "check_one",
    "check_size",
    "given_shape",
    "longest",
    "notes_on",
    "pieces_of",
    "shape_of",
]

BOX_TINTS: NDArray[np.int64] = np.array(
    [(158, 197, 224), (110, 160, 200), (240, 190, 150), (222, 150, 96), (158, 214, 196), (98, 178, 150)]
)
"""Colours of the faces toward +x, −x, +y, −y, +z, −z."""
_PLAIN = (199, 212, 230)
_PART_TINTS = ((158, 197, 224), (240, 190, 150), (158, 214, 196), (214, 186, 214), (226, 214, 150))
_SHADE = 0.84
"""Factor of a colour for the dark quarters of round shapes."""
_PIECES = 24
"""Largest edges are the size of a mesh divided by this: triangles are sorted by depth."""
_PARTS = 12
"""The same for a body of parts."""
_MOST = 10_000
"""Pieces that a browser still turns smoothly."""
_FAR = 100.0
_SIZES = (1e-50, 1e50)


@dataclass(frozen=True)
class Shape:
    """A surface about the point that the motion refers to.

    Attributes
    ----------
    vertices : numpy.ndarray, shape (n, 3)
        From that point, in the body frame.
    faces : numpy.ndarray, shape (m, 3)
        Triangles, counterclockwise seen from outside.
    colors : numpy.ndarray, shape (m, 3)
        Red, green and blue of each, from 0 to 255.
    left_out : int
        Triangles of the user's mesh that are gone, as corners of too many were joined.
    moved : float
        How far no corner has moved by that.
    """

    vertices: Floats
    faces: NDArray[np.int64]
    colors: NDArray[np.int64]
    left_out: int = 0
    moved: float = 0.0


def check_one(shape: tuple[int, ...], name: str) -> None:
    """Refuse a stack: a picture shows one body, or one motion."""
    if shape:
        raise ValueError(f"{name}: expected one body, got a stack of shape {shape}; index it")


def check_size(numbers: Floats, what: str, unit: str) -> None:
    """Refuse numbers for which the picture would overflow or underflow."""
    size = float(np.abs(numbers).max(initial=0.0))
    if size > _SIZES[1] or 0.0 < size < _SIZES[0]:
        raise ValueError(
            f"{what}: numbers up to {size:.3g} are not of a size from {_SIZES[0]:g} to {_SIZES[1]:g}, as "
            f"pictures take them; choose another unit of {unit}"
        )


def notes_on(shape: Shape) -> tuple[str, ...]:
    """Return notes on a shape that is drawn with less detail, or that is so far away that it is a dot."""
    size, far = float(np.ptp(shape.vertices, axis=0).max()), longest(shape.vertices)
    notes: list[str] = []
    if shape.left_out:
        notes.append(
            f"shape: of {len(shape.faces) + shape.left_out} triangles {len(shape.faces)} are drawn, as many "
            f"as turn smoothly; corners have moved by less than {shape.moved / size:.2g} of its size"
        )
    if far > _FAR * size:
        notes.append(
            f"shape: drawn as a dot, for it is {far / size:.3g} times its own size away from the point that "
            "the motion refers to; give it in the body's frame and unit of length"
        )
    return tuple(notes)


def longest(vectors: Floats) -> float:
    """Return the length of the longest of vectors (n, 3), to draw them by; 1 where all are zero."""
    return float(np.linalg.norm(vectors, axis=-1).max()) or 1.0


def body_shape(body: RigidBody, about: Floats, *, is_cut: bool = True) -> tuple[Shape, tuple[str, ...]]:
    """Return the shape that is drawn for a body, and notes on what is not drawn.

    It is the shapes that it was made of, where they are known, else the uniform box with its mass and
    inertia. A box has faces in six colours, another part has one; a round part has quarters in two shades.

    Parameters
    ----------
    body : RigidBody
        One body.
    about : numpy.ndarray, shape (3,)
        The point that the vertices are counted from.
    is_cut : bool
        Whether large triangles are cut for whoever sorts them by their depth.
    """
    pieces, notes = pieces_of(body, equivalent_box)
    if pieces is None:
        vertices, faces = equivalent_box(body)
        return Shape(vertices - about, faces, np.repeat(BOX_TINTS, 2, axis=0)), notes
    is_cut = is_cut and not (len(pieces) == 1 and pieces[0].is_convex)
    longest_edge = _size(np.concatenate([piece.vertices for piece in pieces])) / _PARTS if is_cut else None
    shapes = []
    for k, piece in enumerate(pieces):
        tint = _PART_TINTS[k % len(_PART_TINTS)]
        shapes.append(
            _make_shape(piece.vertices, piece.faces, _colors(piece, tint, len(pieces)), about, longest_edge)
        )
    return _together(shapes), notes


def _colors(piece: Piece, tint: tuple[int, int, int], count: int) -> NDArray[np.int64]:
    if count == 1 and piece.group.min() >= 0:
        return BOX_TINTS[piece.group]
    shade = np.where(piece.is_dark, _SHADE, 1.0)
    colors: NDArray[np.int64] = np.outer(shade, tint).round().astype(np.int64)
    return colors


def equivalent_box(body: RigidBody) -> tuple[Floats, NDArray[np.int64]]:
    """Find the uniform box with the mass and inertia of a body, of sides (6 (I_j + I_k - I_i)/m)^(1/2)."""
    moments, axes = body.principal.moments, body.principal.axes
    sides = np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments) / body.mass, 0.0))
    sides = np.maximum(sides, 0.01 * sides.max() or 1.0)  # a sheet or a rod is drawn a hundredth thick
    box = solid_surface("cuboid", sides)
    assert box is not None  # a box has a surface
    return box[0] @ axes.T + body.center_of_mass, box[1]


def shape_of(given: GivenShape, about: Floats, *, is_cut: bool = True, at_most: int | None = None) -> Shape:
    """Read the surface of a body from the user's argument: a mesh, or a list of parts.

    Parameters
    ----------
    given : (vertices, faces) or list
        Of parts, each a mesh or a body, each in a colour of its own.
    about : numpy.ndarray, shape (3,)
        The point that the vertices are counted from.
    is_cut : bool
        Whether large triangles are cut for whoever sorts them by their depth.
    at_most : int, optional
        Triangles of a mesh; of one with more, corners that are near each other are joined.
    """
    if not isinstance(given, list):
        return given_shape(*given, about, is_cut=is_cut, at_most=at_most)
    if not given:
        raise ValueError("shape: the list has no parts")
    parts = []
    for k, part in enumerate(given):
        tint = _PART_TINTS[k % len(_PART_TINTS)]
        if isinstance(part, _core.RigidBody):
            check_one(part.shape, "shape")
            drawn, _ = body_shape(part, about, is_cut=is_cut)
        else:
            drawn = given_shape(*part, about, is_cut=is_cut, at_most=at_most)
        parts.append(replace(drawn, colors=np.tile(tint, (len(drawn.faces), 1))))
    return _together(parts)


def _together(parts: list[Shape]) -> Shape:
    corners = np.cumsum([0, *(len(part.vertices) for part in parts)])
    return Shape(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + first for part, first in zip(parts, corners, strict=False)]),
        np.concatenate([part.colors for part in parts]),
        sum(part.left_out for part in parts),
        max(part.moved for part in parts),
    )


def given_shape(
    vertices: ArrayLike, faces: ArrayLike, about: Floats, *, is_cut: bool = True, at_most: int | None = None
) -> Shape:
    """Check and return the user's mesh, in the body frame."""
    points = _core.real_numbers(vertices, "shape")
    _core.real_numbers(faces, "shape")  # neither masked nor with a unit
    corners = np.asarray(faces)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise ValueError(f"shape: expected finite vertices of shape (n, 3), got {points.shape}")
    if corners.ndim != 2 or corners.shape[1] != 3 or corners.dtype.kind not in "iu":
        raise ValueError(f"shape: expected whole numbers of shape (m, 3) as faces, got {corners.shape}")
    if corners.size and not 0 <= corners.min() <= corners.max() < len(points):
        wrong = corners.min() if corners.min() < 0 else corners.max()
        raise ValueError(f"shape: a face names vertex {wrong}, but they run from 0 to {len(points) - 1}")
    faces = corners.astype(np.int64)
    sides = points[faces]
    check_size(sides, "shape", "length")
    if not np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]).any():
        raise ValueError(
            f"shape: {len(sides)} triangles, none with an area; leave it out for what the body was made "
            "of, or the box that has its inertia"
        )
    points, drawn, side = cluster_vertices(points, faces, at_most or len(faces))
    longest_edge = _size(points) / _PIECES if is_cut else None
    made = _make_shape(points, drawn, np.tile(_PLAIN, (len(drawn), 1)), about, longest_edge)
    return replace(made, left_out=len(faces) - len(drawn), moved=float(np.sqrt(3.0)) * side)


def _size(points: Floats) -> float:
    return max(float(np.ptp(points, axis=0).max(initial=0.0)), float(np.finfo(float).tiny))


def _make_shape(
    points: Floats,
    faces: NDArray[np.int64],
    colors: NDArray[np.int64],
    about: Floats,
    longest_edge: float | None,
) -> Shape:
    """Return a surface; if a longest edge is given, its triangles are subdivided to this length."""
    if longest_edge is None:
        return Shape(points - about, faces, colors)
    pieces, owner = subdivide(points[faces], longest_edge, at_most=max(_MOST, len(faces)))
    corner, index = np.unique(pieces.reshape(-1, 3), axis=0, return_inverse=True)
    return Shape(corner - about, index.reshape(-1, 3), colors[owner])


_BY_PARTS: Final = ((3, 40), (12, 24), (48, 12))
"""Largest number of parts, and the segments of a full circle for it; eight for more parts."""
_MARKED: Final = frozenset(
    {"cylinder", "cone", "frustum", "tube", "sphere", "hollow_sphere", "hemisphere", "capsule", "torus"}
    | {"ellipsoid", "disk", "annulus", "ellipse", "ring"}
)
"""Round ones: quarters in two shades show how they turn."""
_HOLLOW: Final = frozenset(
    {"mesh", "surface", "wire", "particles", "balls", "tube", "torus", "annulus", "polygon", "arc"}
)
"""Shapes that can hide a part of themselves."""
_GIVEN: Final = frozenset({"mesh", "surface", "wire", "particles", "balls", "inertia"})
"""Shapes whose surface has an area."""
_THICK: Final = 0.01
"""Thickness of a line relative to its length."""
_LINE: Final = 1e-12
"""Twice the area of the largest triangle, beside the square of the size, of what is a line."""
_ROUNDING: Final = 1e-12
"""Tolerance of the places of equal parts."""


@dataclass(frozen=True)
class Piece:
    """A part of a body, in the body frame.

    Attributes
    ----------
    vertices, faces : numpy.ndarray, shapes (n, 3) and (m, 3)
        Triangles, counterclockwise seen from outside.
    group : numpy.ndarray of int, shape (m,)
        Faces of one group have one colour: -1 where the whole part has one, else the face of a box (0 to 5).
    is_dark : numpy.ndarray of bool, shape (m,)
        Those of the other shade.
    is_convex : bool
        Whether no face can hide another that is seen.
    """

    vertices: Floats
    faces: NDArray[np.int64]
    group: NDArray[np.int64]
    is_dark: NDArray[np.bool_]
    is_convex: bool


def pieces_of(
    body: RigidBody, box: Callable[[RigidBody], Surface]
) -> tuple[list[Piece] | None, tuple[str, ...]]:
    """Return the parts of one body, and notes on the parts that are not drawn.

    Parameters
    ----------
    body : RigidBody
    box : callable
        Gives the surface of the box that has the inertia of a body: the shape of a part that is not known.

    Returns
    -------
    list of Piece, or None
        None where nothing is known of the whole body but its numbers.
    tuple of str
    """
    stored = body._figures()
    if stored is None:
        return None, ()
    parts = _without_pairs(stored[0])
    if any(kind == "whole" for kind, *_ in parts):
        return None, (
            "the body has too many parts to draw each: it is drawn as the box that has its inertia",
        )
    shown = [part for part in parts if not part[4]]
    notes: tuple[str, ...] = ()
    if len(shown) < len(parts):
        notes = (f"parts taken out of the body are not drawn: {len(parts) - len(shown)}",)
    if not shown:
        return None, notes
    segments = next((n for most, n in _BY_PARTS if len(shown) <= most), 8)
    return _with_points([_piece(part, segments, box) for part in shown]), notes


def _without_pairs(parts: list[Part]) -> list[Part]:
    """Leave out pairs of equal parts of which one was added and the other subtracted."""
    kept: list[Part] = []
    for part in parts:
        other = next((k for k, old in enumerate(kept) if _is_undone(old, part)), None)
        if other is None:
            kept.append(part)
        else:
            del kept[other]
    return kept


def _is_undone(one: Part, other: Part) -> bool:
    if one[4] == other[4] or one[0] != other[0]:
        return False
    if not (np.array_equal(one[1], other[1]) and np.array_equal(one[2], other[2])):
        return False
    change, size = np.abs(np.subtract(one[3], other[3])), np.abs(one[3])  # a turn and a shift
    return all(
        change[part].max() <= _ROUNDING * max(size[part].max(), 1e-300) for part in (slice(9), slice(9, 12))
    )


def _with_points(pieces: list[Piece]) -> list[Piece]:
    """Draw parts that are points as small balls."""
    size = float(np.ptp(np.concatenate([piece.vertices for piece in pieces]), axis=0).max()) or 1.0
    made = []
    for piece in pieces:
        if len(piece.faces):
            made.append(piece)
            continue
        ball, faces = particles_surface(np.array([1.0, 0.0, 0.0, 0.0]))
        count = len(faces)
        place = size * ball + piece.vertices[0]
        made.append(Piece(place, faces, np.full(count, -1), np.zeros(count, dtype=bool), is_convex=True))
    return made


def _piece(
    part: Part,
    segments: int,
    box: Callable[[RigidBody], Surface],
) -> Piece:
    kind, numbers, corners, place, _ = part
    name = kind.rpartition("::")[2]
    vertices, faces = _surface(name, numbers, corners.reshape(-1, 3).astype(np.int64), segments, box)
    if name not in _GIVEN and not _has_area(vertices, faces):
        vertices, faces = _thicken(name, numbers, segments)
    turn, shift = np.array(place[:9]).reshape(3, 3), np.array(place[9:])
    middle = vertices[faces].mean(axis=1)
    is_dark = np.zeros(len(faces), dtype=bool)
    if name in _MARKED:
        is_dark = middle[:, 0] * middle[:, 1] > 0.0
    group = np.full(len(faces), -1)
    if name in {"cuboid", "cube", "inertia"}:
        first, second, third = (vertices[faces[:, k]] for k in range(3))
        normal = np.cross(second - first, third - first)
        axis = np.abs(normal).argmax(axis=1)
        group = 2 * axis + (normal[np.arange(len(faces)), axis] < 0.0)
    if np.linalg.det(turn) < 0.0:  # a mirror image, whose triangles would be seen from inside
        faces = faces[:, ::-1]
    return Piece(vertices @ turn.T + shift, faces, group, is_dark, name not in _HOLLOW)


def _has_area(vertices: Floats, faces: NDArray[np.int64]) -> bool:
    size = float(np.ptp(vertices, axis=0).max())
    if size == 0.0 or not len(faces):
        return False
    first, second, third = (vertices[faces[:, k]] / size for k in range(3))
    return bool(np.abs(np.cross(second - first, third - first)).max() > _LINE)


def _thicken(name: str, numbers: Floats, segments: int) -> Surface:
    """Return a shape for a line, with a thickness of a hundredth of its length; a point has no faces."""
    point = np.zeros((1, 3)), np.zeros((0, 3), dtype=np.int64)
    if name.startswith("arc"):
        return point
    if name == "polygon":
        corners = numbers.reshape(-1, 2)
        return wire_surface("wire", np.column_stack([corners, np.zeros(len(corners))]).ravel()) or point
    lengths = numbers[1:] if name == "prism" else numbers  # without the number of its sides
    if not lengths.max() > 0.0:
        return point
    widened = np.concatenate([numbers[: -len(lengths)], np.maximum(lengths, _THICK * lengths.max())])
    return solid_surface(name, widened, segments) or sheet_surface(name, widened, segments) or point


def _surface(
    name: str,
    numbers: Floats,
    faces: NDArray[np.int64],
    segments: int,
    box: Callable[[RigidBody], Surface],
) -> Surface:
    if name == "mesh":
        return numbers.reshape(-1, 3), faces
    if name == "surface":
        return both_sides(numbers.reshape(-1, 3), faces)
    if name == "particles":
        return particles_surface(numbers)
    if name == "balls":
        return balls_surface(numbers)
    if name == "inertia":
        return box(_core.RigidBody._from_numbers(numbers))
    for surface in (solid_surface, sheet_surface, wire_surface):
        found = surface(name, numbers, segments)
        if found is not None:
            return found
    raise AssertionError(f"no surface of {name!r}")  # tests/draw/test_figures.py draws every kind there is
