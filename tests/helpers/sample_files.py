"""The generated files of `polhode.samples`: run as a program, this writes them anew.

The others there are typed by hand. Coordinates come from sums, products and square roots alone, and are
rounded: any machine makes the same bytes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from places import ROOT
from polhode import RigidBody

__all__ = ["FILES", "FOLDER", "stl", "t_handle"]

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]
FOLDER = ROOT / "python" / "polhode" / "samples"
_TRIANGLE = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def extruded(outline: list[tuple[float, float]], caps: list[tuple[int, int, int]], depth: float) -> Mesh:
    """Vertices and faces of an outline in x and z, counterclockwise seen from -y, with its triangles."""
    n = len(outline)
    vertices = np.empty((2 * n, 3))
    vertices[:, [0, 2]] = np.tile(np.array(outline), (2, 1))
    vertices[:n, 1], vertices[n:, 1] = -depth / 2, depth / 2
    front, here = np.array(caps), np.arange(n)
    following = np.roll(here, -1)
    sides = [
        np.stack([here, here + n, following + n], axis=-1),
        np.stack([here, following + n, following], axis=-1),
    ]
    return vertices, np.concatenate([front, front[:, ::-1] + n, *sides]).astype(np.int64)


def t_handle() -> Mesh:
    """A bar of 100 x 16 x 16 mm along x; a stem of 16 x 16 x 50 along -z, the axis of the middle moment."""
    outline = [(-50, 16), (-50, 0), (-8, 0), (-8, -50), (8, -50), (8, 0), (50, 0), (50, 16)]
    caps = [(0, 1, 2), (0, 2, 5), (0, 5, 6), (0, 6, 7), (2, 3, 4), (2, 4, 5)]
    return extruded([(float(x), float(z)) for x, z in outline], caps, 16.0)


def bracket() -> Mesh:
    """An angle of 3 x 2 inches, a quarter of an inch thick and 2 wide."""
    outline = [(0.0, 0.0), (3.0, 0.0), (3.0, 0.25), (0.25, 0.25), (0.25, 2.0), (0.0, 2.0)]
    return extruded(outline, [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)], 2.0)


def circle(halvings: int) -> NDArray[np.float64]:
    """Points on the unit circle, 4 · 2^halvings of them: midpoints of chords, pushed out."""
    points = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
    for _ in range(halvings):
        between = points + np.roll(points, -1, axis=0)
        between /= np.sqrt((between * between).sum(axis=1, keepdims=True))
        points = np.stack([points, between], axis=1).reshape(-1, 2)
    return points


def torus() -> Mesh:
    """A ring about z of 32 by 16 facets."""
    around, across = circle(3), circle(2)
    n, k = len(around), len(across)
    distance = 40.0 + 10.0 * across[:, 0]
    vertices = np.concatenate(
        [
            around[:, np.newaxis] * distance[np.newaxis, :, np.newaxis],
            np.tile(10.0 * across[:, 1], (n, 1))[..., np.newaxis],
        ],
        axis=-1,
    ).reshape(-1, 3)
    i, j = np.divmod(np.arange(n * k), k)
    right, up, both = (i + 1) % n * k + j, i * k + (j + 1) % k, (i + 1) % n * k + (j + 1) % k
    here = i * k + j
    faces = np.concatenate([np.stack([here, right, both], axis=-1), np.stack([here, both, up], axis=-1)])
    return vertices, faces


def sphere(halvings: int) -> Mesh:
    """The unit sphere: an octahedron whose faces are cut into four again and again."""
    vertices = [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)]
    points = [np.array(v) for v in [*vertices, (0.0, 0.0, -1.0)]]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(halvings):
        known: dict[tuple[int, int], int] = {}

        def middle(a: int, b: int, known: dict[tuple[int, int], int] = known) -> int:
            pair = (min(a, b), max(a, b))
            if pair not in known:
                known[pair] = len(points)
                between = points[a] + points[b]
                points.append(between / np.sqrt(between @ between))
            return known[pair]

        cut = []
        for a, b, c in faces:
            p, q, r = middle(a, b), middle(b, c), middle(c, a)
            cut += [(a, p, r), (p, b, q), (r, q, c), (p, q, r)]
        faces = cut
    return np.array(points), np.array(faces, dtype=np.int64)


def asteroid() -> Mesh:
    """Two lobes of unequal size with hills: a radius in metres over the directions of a sphere."""
    directions, faces = sphere(4)
    x, y, z = directions.T
    lobes = 120.0 + 118.0 * x**2 - 9.0 * x + 14.0 * x * x * x
    hills = 24.0 * x * y * z - 11.0 * y * y * z + 9.0 * z * (5.0 * z * z - 3.0) * y + 13.0 * x * x * y * y * y
    return (lobes + hills)[:, np.newaxis] * directions * (1.0, 1.0, 0.9), faces


def benzene() -> bytes:
    """Hexagons of carbon and hydrogen, 1.397 and 2.481 Angstrom from the middle."""
    height = np.sqrt(0.75)
    corners = [(1.0, 0.0), (0.5, height), (-0.5, height), (-1.0, 0.0), (-0.5, -height), (0.5, -height)]
    atoms = [(name, r * x, r * y) for name, r in (("C", 1.397), ("H", 2.481)) for x, y in corners]
    lines = ["12", "benzene, C-C 1.397 and C-H 1.084 Angstrom"]
    return "\n".join([*lines, *(f"{name} {x:9.5f} {y:9.5f}   0.00000" for name, x, y in atoms), ""]).encode()


def stl(mesh: Mesh) -> bytes:
    """Binary STL, whose coordinates are 32-bit floats."""
    vertices, faces = mesh
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = np.zeros(len(faces), dtype=_TRIANGLE)
    triangles["normal"] = normals / np.sqrt((normals * normals).sum(axis=1, keepdims=True))
    triangles["corners"] = corners
    head = b"T-handle, millimetres".ljust(80) + len(faces).to_bytes(4, "little")
    return head + bytes(triangles.tobytes())


def obj(mesh: Mesh, title: str, digits: int) -> bytes:
    """Wavefront OBJ."""
    rows = [f"v {x:.{digits}f} {y:.{digits}f} {z:.{digits}f}" for x, y, z in mesh[0] + 0.0]
    rows += [f"f {a} {b} {c}" for a, b, c in mesh[1] + 1]
    return "\n".join([f"# {title}", *rows, ""]).encode()


def ply(mesh: Mesh, title: str) -> bytes:
    """PLY with numbers as text."""
    head = f"ply\nformat ascii 1.0\ncomment {title}\nelement vertex {len(mesh[0])}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face {len(mesh[1])}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [f"{x:g} {y:g} {z:g}" for x, y, z in mesh[0]] + [f"3 {a} {b} {c}" for a, b, c in mesh[1]]
    return (head + "\n".join([*rows, ""])).encode()


def tumble() -> bytes:
    """Write a record of an exact motion, with eight decimals."""
    t = np.arange(401) / 20.0
    motion = RigidBody.from_principal(1.0, (2.0, 3.0, 4.0)).free_motion((0.1, 1.5, 0.05)).at(t)
    rows = np.column_stack((t, motion.quaternion, motion.omega))
    lines = [",".join(f"{x:.8f}" for x in row) for row in rows.round(8) + 0.0]
    return "\n".join(["t,qx,qy,qz,qw,wx,wy,wz", *lines, ""]).encode()


FILES: dict[str, Callable[[], bytes]] = {
    "asteroid.obj": lambda: obj(asteroid(), "asteroid, metres", 2),
    "benzene.xyz": benzene,
    "bracket.ply": lambda: ply(bracket(), "bracket, inches"),
    "t-handle.stl": lambda: stl(t_handle()),
    "torus.obj": lambda: obj(torus(), "torus, millimetres", 4),
    "tumble.csv": tumble,
}


if __name__ == "__main__":
    for name, made in FILES.items():
        (FOLDER / name).write_bytes(made())
