"""The T-handle of the demo: an extruded letter T, as a mesh and as a binary STL file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode.files.writing import write_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

__all__ = ["t_handle", "write_stl"]

# Millimetres. The bar lies along x, the stem along -z, the thickness along y. With the stem half as long
# as the bar, the stem is the axis of the intermediate moment.
_BAR_LENGTH = 100.0
_STEM_LENGTH = 50.0
_WIDTH = 16.0
_THICKNESS = 16.0

_STL_TRIANGLE = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def t_handle() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (mm) and faces of the T-handle: closed, outward oriented."""
    bar, stem = _BAR_LENGTH / 2, _WIDTH / 2
    outline = np.array(
        [
            (-bar, _WIDTH),
            (-bar, 0.0),
            (-stem, 0.0),
            (-stem, -_STEM_LENGTH),
            (stem, -_STEM_LENGTH),
            (stem, 0.0),
            (bar, 0.0),
            (bar, _WIDTH),
        ]
    )
    n = len(outline)
    vertices = np.empty((2 * n, 3))
    vertices[:, [0, 2]] = np.tile(outline, (2, 1))
    vertices[:n, 1], vertices[n:, 1] = -_THICKNESS / 2, _THICKNESS / 2
    # Seen from -y the outline runs counter-clockwise; that cap is the front.
    front = np.array([(0, 1, 2), (0, 2, 5), (0, 5, 6), (0, 6, 7), (2, 3, 4), (2, 4, 5)])
    back = front[:, ::-1] + n
    here = np.arange(n)
    following = np.roll(here, -1)
    sides = np.concatenate(
        [
            np.stack([here, here + n, following + n], axis=-1),
            np.stack([here, following + n, following], axis=-1),
        ]
    )
    return vertices, np.concatenate([front, back, sides]).astype(np.int64)


def write_stl(path: Path, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
    """Write a mesh as binary STL, whose coordinates are 32-bit floats."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles = np.zeros(len(faces), dtype=_STL_TRIANGLE)
    triangles["normal"] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    triangles["corners"] = corners
    header = b"T-handle, millimetres".ljust(80)
    write_bytes(path, header + np.uint32(len(faces)).astype("<u4").tobytes() + triangles.tobytes())
