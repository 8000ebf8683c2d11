"""PLY, OFF and GLB files, read by trimesh and checked against their own headers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, BinaryIO, Final, NoReturn

import numpy as np

from polhode._extras import require
from polhode.errors import FileFormatError
from polhode.files.content import unread
from polhode.files.glb import check_glb
from polhode.files.mesh import Mesh, weld
from polhode.files.promises import check_off, check_ply, check_ply_lists, check_ply_size
from polhode.files.reading import with_way_out

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["read_by_trimesh"]

_READ: Final = (".ply", ".off", ".glb", ".gltf")
_PROMISING: Final = {"ply": check_ply, "off": check_off}
_MOST_TRIANGLES: Final = 100_000_000
"""Placed by the nodes of a scene: a small file can name one mesh again and again."""


class _Alone:
    """Where trimesh would look for other files: nothing but the file itself is read."""

    def get(self, name: str) -> NoReturn:
        raise ValueError(f"it names another file, {name!r}; write all into one")

    __getitem__ = get


def read_by_trimesh(stream: BinaryIO, file: Path, readable: tuple[str, ...]) -> Mesh:
    """Read every triangle of a file with trimesh, nodes placed by their transforms.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    file : pathlib.Path
        Its name.
    readable : tuple of str
        Suffixes to name where this file's is none that is read.

    Returns
    -------
    Mesh
    """
    suffix = file.suffix.lower()
    if suffix not in _READ:  # trimesh knows more: archives that unpack without end, drawings, voxels
        raise unread(file, suffix, readable)
    trimesh: Any = require("trimesh", extra="mesh", purpose=f"{file}: reading {suffix} files")
    kind = "glb" if suffix == ".gltf" else suffix.removeprefix(".")
    try:
        # Its own processing would merge, drop and reorder; only the stored triangles are wanted.
        scene = _loaded(trimesh, stream, kind)
    except (MemoryError, OSError, FileFormatError):
        raise
    except Exception as error:  # a damaged file can raise anything in there, from KeyError to struct.error
        reason = " ".join(str(error).split()) or type(error).__name__
        fault = with_way_out(reason[:200], "export it again")
        raise FileFormatError(f"{file}: not a readable {kind.upper()} file: {fault}") from error
    vertices, faces = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)]
    offset = placed_faces = 0
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        geometry = scene.geometry[name]
        if not isinstance(geometry, trimesh.Trimesh):
            raise FileFormatError(
                f"{file}: holds points or lines ({name}) where triangles are needed; export triangles"
            )
        placed_faces += len(geometry.faces)
        if placed_faces > _MOST_TRIANGLES:
            raise FileFormatError(
                f"{file}: its nodes place more than {_MOST_TRIANGLES} triangles; place fewer"
            )
        corners = np.asarray(geometry.faces, dtype=np.int64)
        placed = np.asarray(geometry.vertices, dtype=np.float64)
        if corners.size == 0:
            corners = np.empty((0, 3), dtype=np.int64)
        if corners.shape[1:] != (3,) or placed.shape[1:] != (3,):
            raise FileFormatError(
                f"{file}: its faces or vertices are not rows of three numbers; export triangles"
            )
        if corners.size and not (corners.min() >= 0 and corners.max() < len(placed)):
            row = int(np.flatnonzero((corners < 0).any(axis=1) | (corners >= len(placed)).any(axis=1))[0])
            raise FileFormatError(
                f"{file}: face {row} names a vertex that the file does not hold; is it cut short?"
            )
        # A reflection turns every triangle inside out; the opposite winding turns it back.
        if np.linalg.det(transform[:3, :3]) < 0.0:
            corners = corners[:, ::-1]
        if not np.array_equal(transform, np.eye(4)):
            placed = placed @ transform[:3, :3].T + transform[:3, 3]
        vertices.append(placed)
        faces.append(corners + offset)
        offset += len(placed)
    mesh = weld(np.concatenate(vertices), np.concatenate(faces), kind.upper())
    if not len(mesh.faces):
        raise FileFormatError(f"{file}: holds no triangles; export it with them")
    if kind in _PROMISING:
        try:
            stream.seek(0)
            _PROMISING[kind](stream, len(mesh.faces))
        except (ValueError, IndexError) as error:
            fault = with_way_out(error, "export it again")
            raise FileFormatError(f"{file}: not a whole {kind.upper()} file: {fault}") from None
    return mesh


def _loaded(trimesh: Any, stream: BinaryIO, kind: str) -> Any:
    """Give trimesh's scene of a file that can be what it says."""
    if kind == "glb":
        check_glb(stream)
    elif kind == "ply":
        check_ply_size(stream)
    stream.seek(0)
    scene = trimesh.load_scene(stream, file_type=kind, resolver=_Alone(), process=False, skip_materials=True)
    if kind == "ply":
        check_ply_lists(scene)
    return scene
