"""Triangles of solids, sheets, wires and particles for pictures: large ones divided, too many merged."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Surface = tuple[Floats, Integers]

__all__ = [
    "balls_surface",
    "both_sides",
    "cluster_vertices",
    "particles_surface",
    "sheet_surface",
    "solid_surface",
    "subdivide",
    "unit_normals",
    "wire_surface",
]

_COARSEST: Final = 4
"""Cells along the largest extent of a mesh whose corners are joined, at the least."""


def subdivide(triangles: Floats, longest: float, *, at_most: int | None = None) -> tuple[Floats, Integers]:
    """Halve triangles until no edge is longer than `longest`; return the index of the source triangle too.

    What draws sorts polygons by the depth of their middles, which puts large ones in the wrong order.

    Parameters
    ----------
    triangles : numpy.ndarray, shape (m, 3, 3)
        Triangle, corner, component.
    longest : float
    at_most : int, optional
        Cut no further where more pieces than this would come of it.

    Returns
    -------
    pieces : numpy.ndarray, shape (k, 3, 3)
    owner : numpy.ndarray, shape (k,)
        Which triangle each is a piece of.
    """
    owner = np.arange(len(triangles))
    while True:
        lengths = np.linalg.norm(triangles[:, [1, 2, 0]] - triangles, axis=2)
        long = lengths.max(axis=1) > longest
        if not long.any() or (at_most is not None and len(triangles) + long.sum() > at_most):
            return triangles, owner
        edge = lengths[long].argmax(axis=1)
        row = np.arange(len(edge))
        a, b, c = (triangles[long][row, (edge + k) % 3] for k in range(3))
        middle = (a + b) / 2
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        triangles = np.concatenate([triangles[~long], *halves])
        owner = np.concatenate([owner[~long], owner[long], owner[long]])


def cluster_vertices(vertices: Floats, faces: Integers, at_most: int) -> tuple[Floats, Integers, float]:
    """Merge corners in one cell of a grid, the finest grid that leaves few enough triangles.

    Parameters
    ----------
    vertices : numpy.ndarray, shape (n, 3)
    faces : numpy.ndarray, shape (m, 3)
    at_most : int
        Triangles that may be left.

    Returns
    -------
    vertices, faces : numpy.ndarray
        Of the coarser mesh; for drawing, since it need not bound a solid.
    side : float
        Of the cells; no corner has moved by more than their diagonal. 0 if nothing had to be joined.
    """
    if len(faces) <= at_most:
        return vertices, faces, 0.0
    low = vertices[faces].min(axis=(0, 1))
    size = float((vertices[faces].max(axis=(0, 1)) - low).max())
    coarse, fine = _COARSEST, int(np.sqrt(len(faces))) + _COARSEST
    found = _in_cells(vertices, faces, low, size / coarse)
    while fine - coarse > 1:
        middle = (coarse + fine) // 2
        tried = _in_cells(vertices, faces, low, size / middle)
        if len(tried[1]) <= at_most:
            coarse, found = middle, tried
        else:
            fine = middle
    return *found, size / coarse


def _in_cells(vertices: Floats, faces: Integers, low: Floats, side: float) -> tuple[Floats, Integers]:
    """Replace the corners in one cell by their mean, and drop the triangles without area."""
    cells = np.floor((vertices - low) / side).astype(np.int64)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    count = np.bincount(cell)
    middles = np.stack([np.bincount(cell, axis) for axis in vertices.T], axis=-1) / count[:, np.newaxis]
    corners = cell[faces]
    a, b, c = corners.T
    kept = corners[(a != b) & (b != c) & (c != a)]
    # Sheets that fell together leave the same triangle twice.
    _, first = np.unique(np.sort(kept, axis=1), axis=0, return_index=True)
    return middles, kept[np.sort(first)]


def unit_normals(triangles: Floats) -> Floats:
    """Return unit normals of triangles (m, 3, 3), by the right-hand rule."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    unit: Floats = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    return unit


_SEGMENTS: Final = 40


def solid_surface(name: str, numbers: Floats, segments: int = _SEGMENTS) -> Surface | None:
    """Return vertices and triangles, outward, of a solid in its own place; None for another shape.

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
        return _revolve(_cylinder(radius, height), int(sides))
    if name == "ellipsoid":
        vertices, faces = _revolve(_half_circle(1.0, segments), segments)
        return vertices * numbers, faces
    if name not in _PROFILES:
        return None
    return _revolve(_PROFILES[name](segments, *numbers), segments)


def _revolve(profile: Floats, segments: int) -> Surface:
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
    """Return a piece of a circle about (0, z), angles from −90° at its bottom to 90° at its top."""
    angles = np.deg2rad(np.linspace(start, end, max(segments // 2, 4) + 1))
    r = radius * np.cos(angles)
    r[np.abs(np.cos(angles)) < 1e-9] = 0.0
    return np.stack([r, z + radius * np.sin(angles)], axis=1)


def _half_circle(radius: float, segments: int) -> Floats:
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
    "sphere": lambda n, radius: _half_circle(radius, n),
    "hollow_sphere": lambda n, inner, outer: _half_circle(outer, n),  # noqa: ARG005
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
_THIN: Final = 0.01
"""Radius of a wire, of its size."""
_BALL: Final = 0.06
"""Radius of the heaviest particle, of the size of all."""


def both_sides(vertices: Floats, faces: Integers) -> Surface:
    """Return a sheet with triangles on both sides."""
    return vertices, np.concatenate([faces, faces[:, ::-1]])


def sheet_surface(name: str, numbers: Floats, segments: int = _SEGMENTS) -> Surface | None:
    """Return the triangles of a lamina of :mod:`polhode.laminae`, from both sides; None for another shape."""
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
    """Return the triangles of a rod of :mod:`polhode.rods` or a wire, made thick; None for another shape."""
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
    return _concatenate(pieces) if pieces else (points[:1], np.zeros((0, 3), dtype=np.int64))


def particles_surface(numbers: Floats) -> Surface:
    """Return a ball for each particle, its volume as its mass: numbers are all masses, then all positions."""
    masses, positions = numbers[: len(numbers) // 4], numbers[len(numbers) // 4 :].reshape(-1, 3)
    size = float(np.ptp(positions, axis=0).max()) or 1.0
    heavy = masses > 0.0
    radii = _BALL * size * np.cbrt(masses[heavy] / masses.max())
    return _small_spheres(radii, positions[heavy], 1 if len(radii) <= _FEW else 0)


def balls_surface(numbers: Floats) -> Surface:
    """Return the spheres of balls, which may overlap: numbers are all radii, then all centers."""
    radii, centers = numbers[: len(numbers) // 4], numbers[len(numbers) // 4 :].reshape(-1, 3)
    return _small_spheres(radii, centers, 3 if len(radii) <= _FEW // 10 else 2 if len(radii) <= _FEW else 1)


def _small_spheres(radii: Floats, centers: Floats, times: int) -> Surface:
    corners, faces = _small_sphere(times)
    vertices = centers[:, np.newaxis] + radii[:, np.newaxis, np.newaxis] * corners
    first = len(corners) * np.arange(len(radii))
    return vertices.reshape(-1, 3), (first[:, np.newaxis, np.newaxis] + faces).reshape(-1, 3)


_FEW: Final = 100
"""Particles that are drawn round; of more each is an octahedron."""


def _small_sphere(times: int) -> Surface:
    """Return the octahedron, each triangle cut in four so many times, its corners at distance 1."""
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
    """Return a bar of six sides from point to point; nothing if the points are equal."""
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


def _concatenate(pieces: list[Surface]) -> Surface:
    first = np.cumsum([0, *(len(vertices) for vertices, _ in pieces)])
    return (
        np.concatenate([vertices for vertices, _ in pieces]),
        np.concatenate([faces + k for (_, faces), k in zip(pieces, first, strict=False)]),
    )


def _flat(points: Floats) -> Floats:
    return np.column_stack([points, np.zeros(len(points))])


def _ears(corners: Floats) -> Integers:
    """Divide a simple polygon into triangles by cutting ears: convex corners that hold no other corner."""
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
