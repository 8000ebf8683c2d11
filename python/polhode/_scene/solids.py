"""Surfaces of solids as triangles, to be drawn: profiles that are turned about z."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Surface = tuple[Floats, NDArray[np.int64]]

__all__ = ["solid_surface"]

_SEGMENTS: Final = 40


def solid_surface(name: str, numbers: Floats, segments: int = _SEGMENTS) -> Surface | None:
    """Give vertices and triangles, outward, of a solid in its own place; None for another shape.

    Parameters
    ----------
    name : str
        Of :mod:`polhode.solids`.
    numbers : numpy.ndarray, shape (n,)
        Its arguments one after the other, without mass and density.
    segments : int
        Of a full circle.
    """
    if name in _FLAT_FACED:
        corners, triangles = _FLAT_FACED[name]
        return corners * numbers, np.array(triangles)
    if name == "prism":
        sides, radius, height = numbers
        return _turned(_cylinder(radius, height), int(sides))
    if name == "ellipsoid":
        vertices, faces = _turned(_ball(1.0, segments), segments)
        return vertices * numbers, faces
    if name not in _PROFILES:
        return None
    return _turned(_PROFILES[name](segments, *numbers), segments)


def _turned(profile: Floats, segments: int) -> Surface:
    """Turn points (r, z), from below to above on the outside, about z."""
    angles = 2.0 * np.pi * np.arange(segments) / segments
    r, z = profile.T
    rings = np.stack(
        [np.outer(np.cos(angles), r), np.outer(np.sin(angles), r), np.tile(z, (segments, 1))], axis=-1
    )
    count = len(profile)
    here, row = np.arange(segments)[:, None] * count, np.arange(count - 1)
    a, b = here + row, np.roll(here, -1, axis=0) + row
    # Two triangles between neighbouring points and their copies a turn further; one of them at the axis.
    faces = np.stack([np.stack([a, b, b + 1], axis=-1), np.stack([a, b + 1, a + 1], axis=-1)], axis=2)
    is_there = np.broadcast_to(np.stack([r[:-1] > 0.0, r[1:] > 0.0], axis=-1), faces.shape[:3])
    vertices, index = np.unique(rings.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    return vertices, index.reshape(-1)[faces[is_there]].astype(np.int64)


def _cylinder(radius: float, height: float) -> Floats:
    return np.array([(0.0, -height / 2), (radius, -height / 2), (radius, height / 2), (0.0, height / 2)])


def _arc(radius: float, start: float, end: float, segments: int, z: float = 0.0) -> Floats:
    """Give a piece of a circle about (0, z), angles from −90° at its bottom to 90° at its top."""
    angles = np.deg2rad(np.linspace(start, end, max(segments // 2, 4) + 1))
    r = radius * np.cos(angles)
    r[np.abs(np.cos(angles)) < 1e-9] = 0.0
    return np.stack([r, z + radius * np.sin(angles)], axis=1)


def _ball(radius: float, segments: int) -> Floats:
    return _arc(radius, -90.0, 90.0, segments)


def _frustum(bottom_radius: float, top_radius: float, height: float) -> Floats:
    a, b, h = bottom_radius, top_radius, height
    # Without width it has no surface, wherever it stands.
    low = -h * (a * a + 2.0 * a * b + 3.0 * b * b) / (4.0 * (a * a + a * b + b * b) or 1.0)
    ends = [(0.0, low), (a, low), (b, low + h), (0.0, low + h)]
    return np.array(ends if b > 0.0 else ends[:3])


def _tube(inner_radius: float, outer_radius: float, height: float) -> Floats:
    a, b, z = inner_radius, outer_radius, height / 2
    return np.array([(a, -z), (b, -z), (b, z), (a, z), (a, -z)])


def _torus(major_radius: float, minor_radius: float, segments: int) -> Floats:
    angles = np.linspace(-np.pi, np.pi, max(segments // 2, 4) + 1)
    r = major_radius + minor_radius * np.cos(angles)
    loop: Floats = np.stack([r, minor_radius * np.sin(angles)], axis=1)
    loop[-1] = loop[0]
    return loop


_PROFILES: Final[dict[str, Callable[..., Floats]]] = {
    "cylinder": lambda n, radius, height: _cylinder(radius, height),  # noqa: ARG005
    "tube": lambda n, inner, outer, height: _tube(inner, outer, height),  # noqa: ARG005
    "cone": lambda n, radius, height: _frustum(radius, 0.0, height),  # noqa: ARG005
    "frustum": lambda n, bottom, top, height: _frustum(bottom, top, height),  # noqa: ARG005
    "sphere": lambda n, radius: _ball(radius, n),
    "hollow_sphere": lambda n, inner, outer: _ball(outer, n),  # noqa: ARG005
    "hemisphere": lambda n, radius: np.vstack(
        [(0.0, -0.375 * radius), _arc(radius, 0.0, 90.0, n, -0.375 * radius)]
    ),
    "capsule": lambda n, radius, length: np.vstack(
        [_arc(radius, -90.0, 0.0, n, -length / 2), _arc(radius, 0.0, 90.0, n, length / 2)]
    ),
    "torus": lambda n, major, minor: _torus(major, minor, n),
}

_BOX_FACES: Final = [
    (1, 3, 5), (3, 7, 5), (0, 4, 2), (2, 4, 6), (2, 6, 3), (3, 6, 7),
    (0, 1, 4), (1, 5, 4), (4, 5, 6), (5, 7, 6), (0, 2, 1), (1, 2, 3),
]  # fmt: skip
"""Two triangles for each face, toward +x, −x, +y, −y, +z, −z."""
_BOX: Final = np.array([(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
_FLAT_FACED: Final[dict[str, tuple[Floats, list[tuple[int, int, int]]]]] = {
    "cuboid": (_BOX, _BOX_FACES),
    "cube": (_BOX, _BOX_FACES),
    "wedge": (
        np.array([(x / 3, y, z / 3) for y in (-0.5, 0.5) for x, z in ((-1, -1), (2, -1), (-1, 2))]),
        [(0, 1, 2), (3, 5, 4), (0, 3, 1), (1, 3, 4), (1, 4, 2), (2, 4, 5), (2, 5, 0), (0, 5, 3)],
    ),
    "pyramid": (
        np.array([(-1, -1, -0.5), (1, -1, -0.5), (1, 1, -0.5), (-1, 1, -0.5), (0, 0, 1.5)]) / 2.0,
        [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    ),
    "tetrahedron": (
        np.array(
            [
                (0.0, 0.0, 6**0.5 / 4),
                (3**-0.5, 0.0, -(24**-0.5)),
                (-(12**-0.5), 0.5, -(24**-0.5)),
                (-(12**-0.5), -0.5, -(24**-0.5)),
            ]
        ),
        [(0, 1, 2), (0, 2, 3), (0, 3, 1), (1, 3, 2)],
    ),
}  # fmt: skip
"""Corners of those of size 1, and their triangles."""
