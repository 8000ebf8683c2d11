"""Surfaces of sheets, wires and particles, to be drawn: sheets from both sides, the others a little thick."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from polhode._scene.solids import solid_surface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Faces = NDArray[np.int64]
    Surface = tuple[Floats, Faces]

__all__ = ["both_sides", "particles_surface", "sheet_surface", "wire_surface"]

_SEGMENTS: Final = 40
_THIN: Final = 0.01
"""Radius of a wire, of its size."""
_BALL: Final = 0.06
"""Radius of the heaviest particle, of the size of all."""


def both_sides(vertices: Floats, faces: Faces) -> Surface:
    """Give a sheet that is seen from both sides."""
    return vertices, np.concatenate([faces, faces[:, ::-1]])


def sheet_surface(name: str, numbers: Floats, segments: int = _SEGMENTS) -> Surface | None:
    """Give the triangles of a lamina of :mod:`polhode.laminae`, from both sides; None for another shape."""
    if name == "polygon":
        corners = numbers.reshape(-1, 2)
        return both_sides(_flat(corners), _ears(corners))
    angles = 2.0 * np.pi * np.arange(segments) / segments
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    here = np.arange(segments)
    there = np.roll(here, -1)
    fan = np.stack([np.full(segments, segments), here, there], axis=1)
    if name in {"disk", "ellipse"}:
        return both_sides(_flat(np.vstack([circle * numbers, (0.0, 0.0)])), fan)
    if name == "rectangle":
        corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]) * numbers
        return both_sides(_flat(corners), np.array([(0, 1, 2), (0, 2, 3)]))
    if name == "annulus":
        inner, outer = numbers
        if inner == outer:
            return solid_surface("torus", np.array([outer, _THIN * outer]), segments)
        rings = np.vstack([inner * circle, outer * circle])
        quarter = np.stack([here, here + segments, there + segments], axis=1)
        other = np.stack([here, there + segments, there], axis=1)
        return both_sides(_flat(rings), np.concatenate([quarter, other]))
    return None


def wire_surface(name: str, numbers: Floats, segments: int = _SEGMENTS) -> Surface | None:
    """Give the triangles of a rod of :mod:`polhode.rods` or a wire, made thick; None for another shape."""
    if name == "rod":
        return solid_surface("cylinder", np.array([_THIN * numbers[0], numbers[0]]), 8)
    if name == "ring":
        return solid_surface("torus", np.array([numbers[0], _THIN * numbers[0]]), segments)
    if name in {"arc", "arc in degrees"}:
        radius, angle = numbers[0], numbers[1] if name == "arc" else np.radians(numbers[1])
        along = np.linspace(-angle / 2.0, angle / 2.0, segments + 1)
        middle = radius * np.sinc(angle / 2.0 / np.pi)
        points = np.stack([radius * np.cos(along) - middle, radius * np.sin(along), 0.0 * along], axis=1)
    elif name == "wire":
        points = numbers.reshape(-1, 3)
    else:
        return None
    radius = _THIN * float(np.ptp(points, axis=0).max())
    bars = [_bar(a, b, radius) for a, b in pairwise(points)]
    pieces = [piece for piece in bars if piece is not None]
    return _joined(pieces) if pieces else (points[:1], np.zeros((0, 3), dtype=np.int64))


def particles_surface(numbers: Floats) -> Surface:
    """Give a ball for each particle, its volume as its mass: numbers are all masses, then all positions."""
    masses, positions = numbers[: len(numbers) // 4], numbers[len(numbers) // 4 :].reshape(-1, 3)
    size = float(np.ptp(positions, axis=0).max()) or 1.0
    heavy = masses > 0.0
    corners, faces = _ball(1 if np.count_nonzero(heavy) <= _FEW else 0)
    radii = _BALL * size * np.cbrt(masses[heavy] / masses.max())
    vertices = positions[heavy][:, np.newaxis] + radii[:, np.newaxis, np.newaxis] * corners
    first = len(corners) * np.arange(len(radii))
    return vertices.reshape(-1, 3), (first[:, np.newaxis, np.newaxis] + faces).reshape(-1, 3)


_FEW: Final = 100
"""Particles that are drawn round; of more each is an octahedron."""


def _ball(times: int) -> Surface:
    """Give the octahedron, each triangle cut in four so many times, its corners at distance 1."""
    corners = np.array(
        [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)], dtype=np.float64
    )
    faces = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    triangles = corners[np.array(faces)]
    for _ in range(times):
        a, b, c = np.moveaxis(triangles, 1, 0)
        ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
        of = [np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        triangles = np.concatenate(of)
        triangles /= np.linalg.norm(triangles, axis=-1, keepdims=True)
    return triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def _bar(start: Floats, end: Floats, radius: float) -> Surface | None:
    """Give a bar of six sides from point to point; nothing of no length."""
    along = end - start
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return None
    turned = solid_surface("prism", np.array([6.0, radius, length]))
    assert turned is not None  # a prism has a surface
    vertices, faces = turned
    z = along / length
    x = np.cross(z, np.eye(3)[np.abs(z).argmin()])
    x /= np.linalg.norm(x)
    return vertices @ np.stack([x, np.cross(z, x), z]) + (start + end) / 2.0, faces


def _joined(pieces: list[Surface]) -> Surface:
    first = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    return (
        np.concatenate([vertices for vertices, _ in pieces]),
        np.concatenate([faces + k for (_, faces), k in zip(pieces, first, strict=False)]),
    )


def _flat(points: Floats) -> Floats:
    return np.column_stack([points, np.zeros(len(points))])


def _ears(corners: Floats) -> Faces:
    """Cut a simple polygon into triangles, one convex corner that holds no other after the other."""
    x, y = (corners - corners.mean(axis=0)).T
    rest = list(range(len(corners)))
    if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0.0:
        rest.reverse()
    faces = []
    while len(rest) > 3:
        faces.append(_ear(corners, rest))
        rest.remove(faces[-1][1])
    return np.array([*faces, tuple(rest)])


def _ear(corners: Floats, rest: list[int]) -> tuple[int, int, int]:
    """Find a corner of a polygon whose triangle with its neighbours lies within and holds no other corner."""
    points = corners[rest]
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    turn = _cross(points - before, after - points)
    for k in np.argsort(-turn):  # the widest first: in a polygon with corners in line the flat ones come last
        triangle = (before[k], points[k], after[k])
        sides = [_cross(triangle[(i + 1) % 3] - triangle[i], points - triangle[i]) for i in range(3)]
        within = (sides[0] >= 0.0) & (sides[1] >= 0.0) & (sides[2] >= 0.0)
        within[[k - 1, k, (k + 1) % len(rest)]] = False
        if turn[k] >= 0.0 and not within.any():
            return rest[k - 1], rest[k], rest[(k + 1) % len(rest)]
    return rest[-1], rest[0], rest[1]  # by rounding none: a picture may overlap there


def _cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
