"""Meshes and scenes by trimesh: PLY, OFF, GLB and what else it knows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode._extras import require
from polhode._files.mesh import Mesh, weld
from polhode.errors import FileFormatError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["read_scene"]


def read_scene(file: Path, readable: tuple[str, ...]) -> Mesh:
    """Read every triangle of a file with trimesh, nodes placed by their transforms.

    Parameters
    ----------
    file : pathlib.Path
        The file.
    readable : tuple of str
        Suffixes to name where this file's is none that trimesh knows.

    Returns
    -------
    Mesh
    """
    suffix = file.suffix.lower()
    trimesh: Any = require("trimesh", extra="mesh", purpose=f"{file}: reading {suffix or 'it'} files")
    kind = suffix.removeprefix(".")
    if kind not in trimesh.available_formats():
        name = f"files named {suffix}" if suffix else "files without a suffix"
        raise FileFormatError(f"{file}: {name} are not read; use one of {', '.join(readable)}")
    try:
        # Its own processing would merge, drop and reorder; only the stored triangles are wanted.
        scene = trimesh.load_scene(str(file), file_type=kind, process=False)
    except Exception as error:  # a damaged file can raise anything in there, from KeyError to struct.error
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FileFormatError(f"{file}: not a readable {kind.upper()} file: {reason[:200]}") from error
    vertices, faces = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)]
    offset = 0
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        geometry = scene.geometry[name]
        if not isinstance(geometry, trimesh.Trimesh):
            raise FileFormatError(f"{file}: holds points or lines ({name}) where triangles are needed")
        corners = np.asarray(geometry.faces, dtype=np.int64)
        placed = np.asarray(geometry.vertices, dtype=np.float64)
        if corners.size and not (corners.min() >= 0 and corners.max() < len(placed)):
            row = int(np.flatnonzero((corners < 0).any(axis=1) | (corners >= len(placed)).any(axis=1))[0])
            raise FileFormatError(f"{file}: face {row} names a vertex that the file does not hold")
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
        raise FileFormatError(f"{file}: holds no triangles")
    _check_promise(file, kind, len(mesh.faces))
    return mesh


def _check_promise(file: Path, kind: str, triangles: int) -> None:
    """Text formats cut at the end of a line still parse: hold what was read against the header's counts."""
    if kind == "ply":
        faces, needed, held = _ply_counts(file)
    elif kind == "off":
        faces, needed, held = _off_counts(file)
    else:
        return
    if triangles < faces or held < needed:
        raise FileFormatError(
            f"{file}: the header promises {faces} faces, but the file holds fewer; is it cut short?"
        )


def _ply_counts(file: Path) -> tuple[int, int, int]:
    """Faces and rows that the header promises, and rows held; binary PLY's length trimesh has checked."""
    counts: dict[bytes, int] = {}
    is_ascii = False
    with file.open("rb") as lines:
        for line in lines:
            words = line.split()
            if words[:1] == [b"element"]:
                counts[words[1]] = int(words[2])
            is_ascii |= words[:2] == [b"format", b"ascii"]
            if words == [b"end_header"]:
                break
        held = sum(1 for line in lines if line.strip()) if is_ascii else 0
    return counts.get(b"face", 0), sum(counts.values()) if is_ascii else 0, held


def _off_counts(file: Path) -> tuple[int, int, int]:
    """Faces and rows that the header promises, and rows held."""
    with file.open("rb") as lines:
        rows = (words for line in lines if (words := line.partition(b"#")[0].split()))
        counts = next(rows)[1:] or next(rows)  # the counts may stand beside the word OFF
        held = sum(1 for _ in rows)
    return int(counts[1]), int(counts[0]) + int(counts[1]), held
