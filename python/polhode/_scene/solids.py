"""Surfaces of solids as triangles, to be drawn: profiles that are turned about z."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Surface = tuple[Floats, NDArray[np.int64]]

__all__ = ["solid_surface"]

_SEGMENTS: Final = 40


def solid_surface(name: str, arguments: dict[str, Any], segments: int = _SEGMENTS) -> Surface | None:
    """Give vertices and triangles, outward, of a solid in its own place; None for those without a profile.

    Parameters
    ----------
    name : str
        Of :mod:`polhode.solids`.
    arguments : dict
        Without mass and density.
    segments : int
        Of a full circle.
    """
    if name == "prism":
        radius, height = arguments["radius"], arguments["height"]
        return _turned(_cylinder(radius, height), int(arguments["sides"]))
    if name == "ellipsoid":
        vertices, faces = _turned(_ball(1.0, segments), segments)
        return vertices * np.asarray(arguments["semi_axes"], dtype=np.float64), faces
    if name not in _PROFILES:
        return None
    return _turned(_PROFILES[name](segments, **arguments), segments)


def _turned(profile: Floats, segments: int) -> Surface:
    """Turn points (r, z), from below to above on the outside, about z."""
    angles = 2.0 * np.pi * np.arange(segments) / segments
    r, z = profile.T
    rings = np.stack(
        [np.outer(np.cos(angles), r), np.outer(np.sin(angles), r), np.tile(z, (segments, 1))], axis=-1
    )
    count = len(profile)
    faces = []
    for k in range(segments):
        here, there = k * count, (k + 1) % segments * count
        for i in range(count - 1):
            a, b, c, d = here + i, there + i, there + i + 1, here + i + 1
            if r[i] > 0.0:
                faces.append((a, b, c))
            if r[i + 1] > 0.0:
                faces.append((a, c, d))
    vertices, index = np.unique(rings.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    return vertices, index.reshape(-1)[np.array(faces)].astype(np.int64)


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
    low = -h * (a * a + 2.0 * a * b + 3.0 * b * b) / (4.0 * (a * a + a * b + b * b))
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
    "tube": lambda n, **of: _tube(**of),  # noqa: ARG005
    "cone": lambda n, radius, height: _frustum(radius, 0.0, height),  # noqa: ARG005
    "frustum": lambda n, **of: _frustum(**of),  # noqa: ARG005
    "sphere": lambda n, radius: _ball(radius, n),
    "hollow_sphere": lambda n, inner_radius, outer_radius: _ball(outer_radius, n),  # noqa: ARG005
    "hemisphere": lambda n, radius: np.vstack(
        [(0.0, -0.375 * radius), _arc(radius, 0.0, 90.0, n, -0.375 * radius)]
    ),
    "capsule": lambda n, radius, length: np.vstack(
        [_arc(radius, -90.0, 0.0, n, -length / 2), _arc(radius, 0.0, 90.0, n, length / 2)]
    ),
    "torus": lambda n, major_radius, minor_radius: _torus(major_radius, minor_radius, n),
}
