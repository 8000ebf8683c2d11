"""PLY and OFF files, read by trimesh and checked against their own headers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, BinaryIO, Final, NoReturn

import numpy as np

from polhode._extras import require
from polhode.errors import FileFormatError
from polhode.files.content import unread
from polhode.files.mesh import Mesh, weld
from polhode.files.promises import check_off, check_ply, check_ply_lists, check_ply_size
from polhode.files.reading import with_way_out

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.files.budget import Budget

__all__ = ["read_by_trimesh"]

_READ: Final = (".ply", ".off")
_PROMISING: Final = {"ply": check_ply, "off": check_off}
_BLANKS: Final = b" \t\n\r\v\f"
_BLOCK: Final = 1 << 20


class _Alone:
    """Where trimesh would look for other files: nothing but the file itself is read."""

    def get(self, name: str) -> NoReturn:
        raise ValueError(f"it names another file, {name!r}; write all into one")

    __getitem__ = get


def read_by_trimesh(stream: BinaryIO, file: Path, readable: tuple[str, ...], budget: Budget) -> Mesh:
    """Read every triangle of a file with trimesh.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    file : pathlib.Path
        Its name.
    readable : tuple of str
        Suffixes to name where this file's is none that is read.
    budget : Budget

    Returns
    -------
    Mesh
    """
    suffix = file.suffix.lower()
    if suffix not in _READ:  # trimesh knows more: archives that unpack without end, drawings, voxels
        raise unread(file, suffix, readable)
    trimesh: Any = require("trimesh", extra="mesh", purpose=f"{file}: reading {suffix} files")
    kind = suffix.removeprefix(".")
    try:
        _count_words(stream, budget)
        # Its own processing would merge, drop and reorder; only the stored triangles are wanted.
        scene = _loaded(trimesh, stream, kind)
    except (MemoryError, OSError, FileFormatError):
        raise
    except Exception as error:  # a damaged file can raise anything in there, from KeyError to struct.error
        reason = " ".join(str(error).split()) or type(error).__name__
        fault = with_way_out(reason[:200], "export it again")
        raise FileFormatError(f"{file}: not a readable {kind.upper()} file: {fault}") from error
    vertices, faces = np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    for name, geometry in scene.geometry.items():  # of which these formats hold one
        if not isinstance(geometry, trimesh.Trimesh):
            raise FileFormatError(
                f"{file}: holds points or lines ({name}) where triangles are needed; export triangles"
            )
        vertices = np.asarray(geometry.vertices, dtype=np.float64)
        if len(geometry.faces):
            faces = np.asarray(geometry.faces, dtype=np.int64)
    if faces.shape[1:] != (3,) or vertices.shape[1:] != (3,):
        raise FileFormatError(
            f"{file}: its faces or vertices are not rows of three numbers; export triangles"
        )
    if faces.size and not (faces.min() >= 0 and faces.max() < len(vertices)):
        row = int(np.flatnonzero((faces < 0).any(axis=1) | (faces >= len(vertices)).any(axis=1))[0])
        raise FileFormatError(
            f"{file}: face {row} names a vertex that the file does not hold; is it cut short?"
        )
    mesh = weld(vertices, faces, kind.upper())
    if not len(mesh.faces):
        raise FileFormatError(f"{file}: holds no triangles; export it with them")
    try:
        stream.seek(0)
        _PROMISING[kind](stream, len(mesh.faces))
    except (ValueError, IndexError) as error:
        fault = with_way_out(error, "export it again")
        raise FileFormatError(f"{file}: not a whole {kind.upper()} file: {fault}") from None
    return mesh


def _count_words(stream: BinaryIO, budget: Budget) -> None:
    """Count what may be words of a text, each of which takes far more memory than its letters."""
    stream.seek(0)
    while block := stream.read(_BLOCK):
        budget.spend("words", len(block) - len(block.translate(None, _BLANKS)))
    stream.seek(0)


def _loaded(trimesh: Any, stream: BinaryIO, kind: str) -> Any:
    """Give trimesh's scene of a file that can be what it says."""
    if kind == "ply":
        check_ply_size(stream)
    stream.seek(0)
    scene = trimesh.load_scene(stream, file_type=kind, resolver=_Alone(), process=False, skip_materials=True)
    if kind == "ply":
        check_ply_lists(scene)
    return scene
