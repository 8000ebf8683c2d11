"""What is drawn for a body: its mesh, or the box that has its inertia."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from polhode import _core
from polhode._scene.triangles import cut

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode import RigidBody

    Floats = NDArray[np.float64]
    Mesh: TypeAlias = tuple[ArrayLike, ArrayLike]
    GivenShape: TypeAlias = Mesh | list[RigidBody | Mesh]

__all__ = ["Shape", "check_one", "equivalent_box", "given_shape", "longest", "shape_of"]

_LIGHT_TINTS = ((158, 197, 224), (240, 190, 150), (158, 214, 196))
_DARK_TINTS = ((110, 160, 200), (222, 150, 96), (98, 178, 150))
_PLAIN = (199, 212, 230)
_PART_TINTS = ((158, 197, 224), (240, 190, 150), (158, 214, 196), (214, 186, 214), (226, 214, 150))
_PIECES = 24
"""Of the size of a mesh: triangles are cut to that, for their order by depth."""
_MOST = 10_000
"""Pieces that a browser still turns smoothly."""
# The corners of a face of the unit cube whose normal is +e3, counterclockwise seen from outside.
_FACE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


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
    """

    vertices: Floats
    faces: NDArray[np.int64]
    colors: NDArray[np.int64]


def check_one(shape: tuple[int, ...], name: str) -> None:
    """Refuse a stack where one body, or the motion of one, is drawn."""
    if shape:
        raise ValueError(f"{name}: expected one body, got a stack of shape {shape}; index it")


def longest(vectors: Floats) -> float:
    """Give the length of the longest of vectors (n, 3), to draw them by; 1 where all are zero."""
    return float(np.linalg.norm(vectors, axis=-1).max()) or 1.0


def equivalent_box(body: RigidBody, about: Floats) -> Shape:
    """Find the uniform box with the mass and inertia of a body, its pairs of faces in six colours.

    Parameters
    ----------
    body : RigidBody
        One body. Its box has sides (6 (I_j + I_k - I_i)/m)^(1/2).
    about : numpy.ndarray, shape (3,)
        The point that the vertices are counted from.
    """
    moments, axes = body.principal.moments, body.principal.axes
    squares = 6.0 * (moments.sum() - 2.0 * moments) / body.mass
    half = 0.5 * np.sqrt(np.maximum(squares, 0.0))
    half = np.maximum(half, 0.01 * half.max() or 1.0)  # a sheet or a rod is drawn a hundredth thick
    vertices: list[Floats] = []
    faces: list[list[int]] = []
    colors: list[tuple[int, int, int]] = []
    for axis in range(3):
        across = [(axis + 1) % 3, (axis + 2) % 3]
        for sense, tint in ((1.0, _LIGHT_TINTS[axis]), (-1.0, _DARK_TINTS[axis])):
            corners = np.empty((4, 3))
            corners[:, axis] = sense
            corners[:, across] = _FACE if sense > 0.0 else _FACE[::-1]
            first = 4 * len(vertices)
            vertices.append((corners * half) @ axes.T)
            faces += [[first, first + 1, first + 2], [first, first + 2, first + 3]]
            colors += [tint, tint]
    return Shape(np.concatenate(vertices) + body.center_of_mass - about, np.array(faces), np.array(colors))


def shape_of(given: GivenShape, about: Floats, *, is_cut: bool = True) -> Shape:
    """Take what the user gives as the surface of a body: a mesh, or a list of its parts.

    Parameters
    ----------
    given : (vertices, faces) or list
        Of parts, each a mesh or a body; a body is drawn as the box of its inertia, which a box itself is.
    about : numpy.ndarray, shape (3,)
        The point that the vertices are counted from.
    is_cut : bool
        Whether large triangles are cut for whoever sorts them by their depth.
    """
    if not isinstance(given, list):
        return given_shape(*given, about, is_cut=is_cut)
    if not given:
        raise ValueError("shape: the list has no parts")
    parts: list[Shape] = []
    for part in given:
        if isinstance(part, _core.RigidBody):
            check_one(part.shape, "shape")
            box = equivalent_box(part, np.zeros(3))
            parts.append(given_shape(box.vertices, box.faces, about, is_cut=is_cut))
        else:
            parts.append(given_shape(*part, about, is_cut=is_cut))
    corners = np.cumsum([0, *(len(part.vertices) for part in parts)])
    tints = [np.tile(_PART_TINTS[k % len(_PART_TINTS)], (len(part.faces), 1)) for k, part in enumerate(parts)]
    return Shape(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + first for part, first in zip(parts, corners, strict=False)]),
        np.concatenate(tints),
    )


def given_shape(vertices: ArrayLike, faces: ArrayLike, about: Floats, *, is_cut: bool = True) -> Shape:
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
    if not is_cut:
        return Shape(points - about, corners.astype(np.int64), np.tile(_PLAIN, (len(corners), 1)))
    size = max(float(np.ptp(points, axis=0).max(initial=0.0)), float(np.finfo(float).tiny))
    pieces, _ = cut(points[corners.astype(np.int64)], size / _PIECES, at_most=max(_MOST, len(corners)))
    corner, index = np.unique(pieces.reshape(-1, 3), axis=0, return_inverse=True)
    return Shape(corner - about, index.reshape(-1, 3), np.tile(_PLAIN, (len(pieces), 1)))
