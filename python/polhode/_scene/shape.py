"""What is drawn for a body: what it was made of, a mesh that is given, or the box that has its inertia."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from polhode import _core
from polhode._scene.figure import pieces_of
from polhode._scene.solids import solid_surface
from polhode._scene.triangles import cut, joined

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode import RigidBody
    from polhode._scene.figure import Piece

    Floats = NDArray[np.float64]
    Mesh: TypeAlias = tuple[ArrayLike, ArrayLike]
    GivenShape: TypeAlias = Mesh | list[RigidBody | Mesh]

__all__ = [
    "BOX_TINTS",
    "Shape",
    "body_shape",
    "check_one",
    "check_size",
    "given_shape",
    "longest",
    "notes_on",
    "shape_of",
]

BOX_TINTS: NDArray[np.int64] = np.array(
    [(158, 197, 224), (110, 160, 200), (240, 190, 150), (222, 150, 96), (158, 214, 196), (98, 178, 150)]
)
"""Of the faces toward +x, −x, +y, −y, +z, −z."""
_PLAIN = (199, 212, 230)
_PART_TINTS = ((158, 197, 224), (240, 190, 150), (158, 214, 196), (214, 186, 214), (226, 214, 150))
_SHADE = 0.84
"""Of a colour, for the dark quarters of what is round."""
_PIECES = 24
"""Of the size of a mesh: triangles are cut to that, for their order by depth."""
_PARTS = 12
"""Of the size of a body of parts."""
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
    """Refuse a stack where one body, or the motion of one, is drawn."""
    if shape:
        raise ValueError(f"{name}: expected one body, got a stack of shape {shape}; index it")


def check_size(numbers: Floats, what: str, unit: str) -> None:
    """Refuse numbers of which no picture can be computed in floats."""
    size = float(np.abs(numbers).max(initial=0.0))
    if size > _SIZES[1] or 0.0 < size < _SIZES[0]:
        raise ValueError(
            f"{what}: numbers up to {size:.3g} are not of a size from {_SIZES[0]:g} to {_SIZES[1]:g}, as "
            f"pictures take them; choose another unit of {unit}"
        )


def notes_on(shape: Shape) -> tuple[str, ...]:
    """Tell of a shape that is drawn coarser than it is, or so far off that it is a dot."""
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
    """Give the length of the longest of vectors (n, 3), to draw them by; 1 where all are zero."""
    return float(np.linalg.norm(vectors, axis=-1).max()) or 1.0


def body_shape(body: RigidBody, about: Floats, *, is_cut: bool = True) -> tuple[Shape, tuple[str, ...]]:
    """Give what a body is drawn as, and what is not drawn of it.

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
            _made(piece.vertices, piece.faces, _colors(piece, tint, len(pieces)), about, longest_edge)
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
    """Take what the user gives as the surface of a body: a mesh, or a list of its parts.

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
    """Take the user's mesh, in the body frame."""
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
    points, drawn, side = joined(points, faces, at_most or len(faces))
    longest_edge = _size(points) / _PIECES if is_cut else None
    made = _made(points, drawn, np.tile(_PLAIN, (len(drawn), 1)), about, longest_edge)
    return replace(made, left_out=len(faces) - len(drawn), moved=float(np.sqrt(3.0)) * side)


def _size(points: Floats) -> float:
    return max(float(np.ptp(points, axis=0).max(initial=0.0)), float(np.finfo(float).tiny))


def _made(
    points: Floats,
    faces: NDArray[np.int64],
    colors: NDArray[np.int64],
    about: Floats,
    longest_edge: float | None,
) -> Shape:
    """Give a surface with its triangles cut until no edge is longer than that, if it is given."""
    if longest_edge is None:
        return Shape(points - about, faces, colors)
    pieces, owner = cut(points[faces], longest_edge, at_most=max(_MOST, len(faces)))
    corner, index = np.unique(pieces.reshape(-1, 3), axis=0, return_inverse=True)
    return Shape(corner - about, index.reshape(-1, 3), colors[owner])
