"""What a file of matter holds: a triangle mesh or a molecule, opened and recognised once.

Nothing is repaired and nothing is guessed: a file is what its name says and whole, or it is an error.
The one exception is exact: corners at bit-equal coordinates are one vertex, because STL stores each
triangle's corners anew.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

import numpy as np

from polhode import _core
from polhode.errors import FileFormatError
from polhode.files.content import EXPECTED_CONTENT, MOLECULE_SUFFIX, Content, opened
from polhode.files.mesh import Mesh, check_faces, weld, weld_within
from polhode.files.reading import naming

if TYPE_CHECKING:
    from polhode.files.xyz import Molecule

__all__ = ["Loaded", "load", "read_mesh"]

_MESH_SUFFIXES: Final = tuple(suffix for suffix in EXPECTED_CONTENT if suffix != MOLECULE_SUFFIX)
_TEXT_SUFFIXES: Final = tuple(suffix for suffix, known in EXPECTED_CONTENT.items() if "v/f text" in known)


@dataclass(eq=False, repr=False)
class Loaded:
    """What a file holds.

    What Python reads is read in the same opening of the file that told its format. Binary STL, binary PLY
    and ``v/f`` text are for the compiled reader: the first two as a stream, see :func:`solid_of`.

    Attributes
    ----------
    path : pathlib.Path
        Of the file.
    format : str
        ``"binary STL"``, ``"ASCII STL"``, ``"v/f text"`` (OBJ and plate files), ``"PLY"``, ``"OFF"``,
        ``"GLB"`` or ``"XYZ"``.
    is_stream : bool
        Whether its triangles can be gone through one after the other, without all of them in memory.
    index_base : {1, 0}
        What ``v``/``f`` text counts its vertices from.
    """

    path: Path
    format: str
    is_stream: bool = False
    index_base: int = 1
    _molecule: Molecule | None = None
    _mesh: Mesh | None = None

    def __repr__(self) -> str:
        return f"<Loaded {self.format} from {self.path}>"

    @property
    def mesh(self) -> Mesh:
        """The triangles; those that the compiled reader reads are read when they are first asked for."""
        if self._molecule is not None:
            raise FileFormatError(f"{self.path}: an XYZ file holds atoms, not a mesh; ask for its molecule")
        if self._mesh is None:
            self._mesh = self._read_mesh()
        return self._mesh

    @property
    def molecule(self) -> Molecule:
        """The atoms."""
        if self._molecule is None:
            raise FileFormatError(f"{self.path}: {self.format} holds a mesh, not atoms; ask for its mesh")
        return self._molecule

    def _read_mesh(self) -> Mesh:
        if self.format == "binary STL":
            return Mesh(*_core.read_stl(str(self.path)), self.format)
        if self.format == "PLY":
            with naming(self.path), self.path.open("rb") as stream:
                return _by_trimesh(stream, self.path)
        mesh = Mesh(*_core.read_plates(str(self.path), self.index_base), self.format)
        check_faces(mesh, str(self.path))
        return mesh


def load(path: str | os.PathLike[str], *, index_base: int = 1) -> Loaded:
    r"""Open a file of matter, tell its format from its content and read it.

    Parameters
    ----------
    path : str or os.PathLike
        A mesh (see :func:`read_mesh`) or a molecule (see :func:`read_xyz`); the suffix tells which.
    index_base : {1, 0}
        What ``v``/``f`` text counts its vertices from: 1 in OBJ and in most plate files, 0 in some.

    Returns
    -------
    Loaded

    Raises
    ------
    FileFormatError
        If the file is empty, cut short, damaged or in another format than its suffix says.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> from polhode.files import load
    >>> corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "corner.obj")
    ...     _ = path.write_text(corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    ...     loaded = load(path)
    ...     loaded.format, loaded.mesh.faces.shape
    ('v/f text', (4, 3))
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if index_base not in (0, 1):
        raise ValueError(f"index_base: expected 0 or 1, got {index_base!r}")
    if index_base != 1 and suffix not in _TEXT_SUFFIXES:
        raise ValueError(f"index_base: {file} is not v/f text (.obj, .tab, .txt); leave index_base out")
    with opened(file) as content:
        if suffix == MOLECULE_SUFFIX:
            from polhode.files.xyz import molecule_of

            return Loaded(file, "XYZ", _molecule=molecule_of(content.stream, file))
        if content.format == "ASCII STL":
            from polhode.files.ascii_stl import read_ascii_stl

            corners = read_ascii_stl(content.stream, file)
            faces = np.arange(corners.size // 3).reshape(-1, 3)
            return Loaded(file, "ASCII STL", _mesh=weld(corners.reshape(-1, 3), faces, "ASCII STL"))
        if suffix == ".stl":
            # Whatever is neither text nor another known format is the compiled reader's to read or refuse.
            return Loaded(file, "binary STL", is_stream=True)
        if suffix in _TEXT_SUFFIXES:
            return Loaded(file, "v/f text", index_base=index_base)
        if _is_binary_ply(content, suffix):
            return Loaded(file, "PLY", is_stream=True)
        mesh = _by_trimesh(content.stream, file)
    return Loaded(file, mesh.format, _mesh=mesh)


def _by_trimesh(stream: BinaryIO, path: Path) -> Mesh:
    # Imported when a file needs it: the formats of our own readers are opened sooner.
    from polhode.files.by_trimesh import read_by_trimesh

    return read_by_trimesh(stream, path, _MESH_SUFFIXES)


def read_mesh(path: str | os.PathLike[str], *, index_base: int = 1, weld: float = 0.0) -> Mesh:
    """Read a triangle mesh.

    Parameters
    ----------
    path : str or os.PathLike
        Binary and ASCII STL, and ``v``/``f`` text (``.obj``, ``.tab``, ``.txt``) are read without any
        further library; PLY, OFF and GLB by trimesh (extra ``mesh``), and no other format. Nodes of a scene
        are placed by their transforms and taken together.
    index_base : {1, 0}
        What ``v``/``f`` text counts its vertices from: 1 in OBJ and in most plate files, 0 in some.
    weld : float
        Corners at most this far from each other (in the unit of the file, in every coordinate) are one
        vertex. The default joins equal corners only, as it must for STL; some exporters write the same
        corner with other last digits in each triangle, and leave the mesh open by them.

    Returns
    -------
    Mesh

    Raises
    ------
    FileFormatError
        If the file is empty, cut short, damaged or in another format than its suffix says.
    OSError
        If the file cannot be read.
    """
    if Path(path).suffix.lower() == MOLECULE_SUFFIX:
        raise FileFormatError(f"{Path(path)}: an XYZ file holds atoms, not a mesh; read it with read_xyz")
    mesh = load(path, index_base=index_base).mesh
    return weld_within(mesh, weld) if weld != 0.0 else mesh


def _is_binary_ply(content: Content, suffix: str) -> bool:
    return suffix == ".ply" and content.format == "PLY" and b"\nformat binary" in content.head
