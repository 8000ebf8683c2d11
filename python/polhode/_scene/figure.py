"""The shape of a body that was made of solids, sheets, wires, meshes or particles, as it is drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode import _core
from polhode._scene.sheets import both_sides, particles_surface, sheet_surface, wire_surface
from polhode._scene.solids import solid_surface

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode import RigidBody

    Floats = NDArray[np.float64]
    Surface = tuple[Floats, NDArray[np.int64]]
    Part = tuple[str, Floats, NDArray[np.uint32], list[float], bool]

__all__ = ["Piece", "pieces_of"]

_BY_PARTS: Final = ((3, 40), (12, 24), (48, 12))
"""Up to so many parts a full circle has so many segments; of more parts eight."""
_MARKED: Final = frozenset(
    {"cylinder", "cone", "frustum", "tube", "sphere", "hollow_sphere", "hemisphere", "capsule", "torus"}
    | {"ellipsoid", "disk", "annulus", "ellipse", "ring"}
)
"""Round ones: quarters in two shades show how they turn."""
_HOLLOW: Final = frozenset(
    {"mesh", "surface", "wire", "particles", "tube", "torus", "annulus", "polygon", "arc"}
)
"""Those that can hide a part of themselves."""
_GIVEN: Final = frozenset({"mesh", "surface", "wire", "particles", "inertia"})
"""Those whose surface has an area."""
_THICK: Final = 0.01
"""Of the length of a line: how thick it is drawn."""
_LINE: Final = 1e-12
"""Twice the area of the largest triangle, beside the square of the size, of what is a line."""
_ROUNDING: Final = 1e-12
"""Of the places of parts that are the same."""


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
    """Give the parts that one body was made of, and what is not drawn of them.

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
    """Leave out parts that were taken out again just as they were put in, and the other way round."""
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
        vertices, faces = _thickened(name, numbers, segments)
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
    return Piece(vertices @ turn.T + shift, faces, group, is_dark, name not in _HOLLOW)


def _has_area(vertices: Floats, faces: NDArray[np.int64]) -> bool:
    size = float(np.ptp(vertices, axis=0).max())
    if size == 0.0 or not len(faces):
        return False
    first, second, third = (vertices[faces[:, k]] / size for k in range(3))
    return bool(np.abs(np.cross(second - first, third - first)).max() > _LINE)


def _thickened(name: str, numbers: Floats, segments: int) -> Surface:
    """Give a shape that is a line a hundredth as thick as it is long; a point has no faces."""
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
    if name == "inertia":
        return box(_core.RigidBody._from_numbers(numbers))
    for surface in (solid_surface, sheet_surface, wire_surface):
        found = surface(name, numbers, segments)
        if found is not None:
            return found
    raise AssertionError(f"no surface of {name!r}")  # tests/test_figures.py draws every kind there is
