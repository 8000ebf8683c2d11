"""The format of a file, recognised by its first bytes and its size and not by its name."""

from __future__ import annotations

import codecs
import os
import shlex
import struct
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final, NamedTuple

from polhode.errors import FileFormatError
from polhode.io.budget import check_ordinary, naming
from polhode.io.plates import is_numbered_plates

if TYPE_CHECKING:
    from collections.abc import Iterator
__all__ = [
    "EXPECTED_CONTENT",
    "MOLECULE_SUFFIX",
    "MOLECULE_SUFFIXES",
    "Content",
    "content_format",
    "is_molecule",
    "open_file",
    "rename",
    "unread",
]

MOLECULE_SUFFIX: Final = ".xyz"
MOLECULE_SUFFIXES: Final = (MOLECULE_SUFFIX, ".extxyz", ".pdb", ".ent", ".mol", ".sdf")
EXPECTED_CONTENT: Final = {
    ".stl": ("binary STL", "ASCII STL"),
    ".obj": ("v/f text",),
    ".tab": ("v/f text", "numbered plates"),
    ".txt": ("v/f text", "numbered plates"),
    ".ply": ("PLY",),
    ".off": ("OFF",),
    ".glb": ("GLB",),
    ".gltf": ("glTF",),
    ".dae": ("COLLADA",),
    ".3mf": ("a ZIP archive",),
    ".vtk": ("VTK",),
    ".vtu": ("VTK",),
    ".vtp": ("VTK",),
    ".xyz": ("XYZ",),
    ".extxyz": ("XYZ",),
    ".pdb": ("PDB",),
    ".ent": ("PDB",),
    ".mol": ("MOL",),
    ".sdf": ("MOL",),
    ".step": ("STEP",),
    ".stp": ("STEP",),
    ".igs": ("IGES",),
    ".iges": ("IGES",),
}
_PACKED = ".gz"
_SUFFIXES: Final = {
    kind: suffix
    for suffix, kinds in reversed(EXPECTED_CONTENT.items())
    for kind in kinds
    if kind not in ("VTK", "a ZIP archive")
}
"""The usual suffix of each content that has one alone."""
_VTK_SUFFIXES: Final = ((b"PolyData", ".vtp"), (b"UnstructuredGrid", ".vtu"))
_FOREIGN: Final = (
    (
        (".cif", ".mmcif", ".mol2", ".cml", ".pdbqt", ".gjf", ".zmat"),
        "write its atoms as .xyz, .pdb or .mol, as Open Babel does: obabel {0} -O {1}.xyz",
    ),
    (
        (
            ".sldprt", ".sldasm", ".ipt", ".iam", ".prt", ".asm", ".catpart", ".catproduct", ".x_t", ".x_b",
            ".sat", ".f3d", ".fcstd", ".3dm", ".dwg", ".dxf", ".jt", ".brep",
        ),
        "export it as .step, or as a mesh such as .stl",
    ),
    (
        (
            ".fbx", ".blend", ".x3d", ".wrl", ".amf", ".usd", ".usda", ".usdc", ".usdz", ".3ds", ".max",
            ".msh", ".inp",
        ),
        "export it as a mesh such as .stl, .obj or .glb",
    ),
    (
        (".dcm", ".dicom", ".ima"),
        "convert the folder of its series to NIfTI, as dcm2niix does: dcm2niix -z y -f scan FOLDER",
    ),
    ((".mha", ".mhd", ".tif", ".tiff", ".vti"), "RigidBody.from_voxels takes voxels as an array"),
    (
        (".nii", ".nrrd", ".nhdr", ".npy"),
        "RigidBody.from_file, polhode report and assemblies read images, unpacked or as .nii.gz",
    ),
    ((".urdf", ".xacro", ".mjcf"), "polhode check judges the links of robots"),
)  # fmt: skip
"""Suffixes of others, with what to do with such a file."""

_STL_HEADER = 84
_STL_TRIANGLE = 50
_PLATE_KEYWORDS = frozenset({"v", "vn", "vt", "vp", "f", "o", "g", "s", "l", "mtllib", "usemtl"})
_ROBOT_ROOTS = ((b"<robot", "URDF"), (b"<sdf", "SDF"), (b"<mujoco", "MJCF"))
_PDB_RECORDS = ("ATOM  ", "HETATM", "HEADER", "TITLE ", "COMPND", "REMARK", "CRYST1", "MODEL ")
_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a"))


class Content(NamedTuple):
    """A file that is open to be read, and what it holds.

    Attributes
    ----------
    stream : binary stream
        At the beginning of the file.
    format : str or None
        See :func:`content_format`.
    head : bytes
        The file's first few thousand bytes.
    """

    stream: BinaryIO
    format: str | None
    head: bytes


def is_molecule(path: Path) -> bool:
    """Return whether a file is a molecule, by its name; packed or not."""
    suffix = path.suffix.lower()
    return (Path(path.stem).suffix.lower() if suffix == _PACKED else suffix) in MOLECULE_SUFFIXES


def unread(file: Path, suffix: str, readable: tuple[str, ...]) -> FileFormatError:
    """Return the error of a file whose suffix is none that is read."""
    name = f"files named {suffix}" if suffix else "files without a suffix"
    if file.suffix.lower() == _PACKED and suffix in (".json", ".npz", ".toml"):
        return FileFormatError(file, f": {name} are read unpacked alone; unpack it with gunzip")
    way_out = f"use one of {', '.join(readable)}"
    for suffixes, words in _FOREIGN:
        if suffix in suffixes:
            way_out = words.format(shlex.quote(file.name), shlex.quote(file.stem))
    return FileFormatError(file, f": {name} are not read; {way_out}")


def content_format(head: bytes, size: int) -> tuple[str | None, bool]:
    """Return the format of a file's content.

    Parameters
    ----------
    head : bytes
        The file's first few thousand bytes.
    size : int
        Its size in bytes.

    Returns
    -------
    format : str or None
        ``"binary STL"``, ``"ASCII STL"``, ``"PLY"``, ``"OFF"``, ``"GLB"``, ``"a ZIP archive"``,
        ``"v/f text"``, ``"numbered plates"``, ``"XYZ"``, ``"COLLADA"``, ``"glTF"``, ``"VTK"``, ``"STEP"``,
        ``"IGES"``, ``"PDB"``, ``"MOL"``; None where none of these is certain.
    is_text : bool
        Whether it reads as text.
    """
    if head.startswith(b"glTF"):
        return "GLB", False
    if head.startswith((b"ply\n", b"ply\r")):
        return "PLY", False
    if head.startswith(b"PK\x03\x04"):
        return "a ZIP archive", False
    if head.startswith(b"\x1f\x8b"):
        return "packed with gzip", False
    if head.startswith((b"# vtk DataFile", b"<VTKFile")) or b"<VTKFile" in head[:500]:
        return "VTK", False
    # Before ASCII STL, since binary files may also begin with the word "solid".
    if len(head) >= _STL_HEADER:
        (triangles,) = struct.unpack_from("<I", head, _STL_HEADER - 4)
        if size == _STL_HEADER + _STL_TRIANGLE * triangles:
            return "binary STL", False
    text = _as_text(head, whole=len(head) == size)
    if text is None:
        return None, False
    return _text_format(text), True


@contextmanager
def open_file(file: Path) -> Iterator[Content]:
    """Open a file and tell the format of its content where that can be told.

    Raises
    ------
    FileFormatError
        If the file is empty, or its content is not what its suffix says.
    OSError
        With the name of the file.
    """
    check_ordinary(file)
    with naming(file), file.open("rb") as stream:
        head = stream.read(4096)
        found = _checked_format(file, head, os.fstat(stream.fileno()).st_size)
        stream.seek(0)
        yield Content(stream, found, head)


def _checked_format(file: Path, head: bytes, size: int) -> str | None:
    if not head:
        raise FileFormatError(file, ": the file is empty; export it again")
    if head[128:132] == b"DICM":
        raise unread(file, ".dcm", ())
    robot = next((name for root, name in _ROBOT_ROOTS if root in head), None)
    if robot is not None and head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        raise FileFormatError(file, f": is a robot ({robot}); polhode check judges its links")
    suffix = file.suffix.lower()
    actual, is_text = content_format(head, size)
    expected = EXPECTED_CONTENT.get(suffix, ())
    if actual in expected:
        return actual
    if actual is not None:
        name = f"named {suffix}" if suffix else "named without a suffix"
        way_out = rename(file, actual, head)
        raise FileFormatError(file, f": {name}, but its content is {actual}; {way_out}")
    if is_text and suffix == ".stl":
        raise FileFormatError(
            file, ": named .stl, but it is text without an STL's words 'solid' and 'facet'; check the file"
        )
    if not is_text and expected == ("v/f text",):
        raise FileFormatError(file, f": named {suffix}, but it is not text; check the file")
    return None


def rename(file: Path, actual: str, head: bytes) -> str:
    """Say under which name a file of this content is read."""
    if actual == "packed with gzip":
        return f"rename it to {file.name}{_PACKED}"
    if actual == "a ZIP archive":
        return "unpack it, or rename it to end in .3mf if it is a 3MF file"
    if actual == "VTK":
        is_legacy = head.startswith(b"# vtk DataFile")
        found = next((suffix for kind, suffix in _VTK_SUFFIXES if kind in head and not is_legacy), ".vtk")
        return f"rename it to end in {found}"
    return f"rename it to end in {_SUFFIXES[actual]}"


def _as_text(head: bytes, *, whole: bool) -> str | None:
    if len(head.translate(None, _CONTROL)) != len(head):
        return None
    try:
        return codecs.getincrementaldecoder("utf-8-sig")().decode(head, final=whole)
    except UnicodeDecodeError:
        # Old exporters write names in an 8-bit encoding; such text is still text.
        return head.decode("latin-1")


def _text_format(text: str) -> str | None:
    rows = [row for line in text.splitlines() if (row := line.partition("#")[0].split())]
    if not rows:
        return None
    first = rows[0][0]
    if first.startswith("ISO-10303-21"):
        return "STEP"
    if "<COLLADA" in text:
        return "COLLADA"
    if first.startswith("{") and '"asset"' in text:
        return "glTF"
    if first.lower() == "solid":
        return "ASCII STL" if "facet" in text.lower() else None
    if first in ("OFF", "COFF", "NOFF"):
        return "OFF"
    if first in _PLATE_KEYWORDS:
        return "v/f text"
    lines = text.splitlines()
    if len(lines[0]) >= 80 and lines[0][72] == "S" and lines[0][73:80].strip() == "1":
        return "IGES"
    if lines[0][:6] in _PDB_RECORDS:
        return "PDB"
    if len(lines) > 3 and lines[3].rstrip().endswith(("V2000", "V3000")):
        return "MOL"
    if is_numbered_plates(lines):
        return "numbered plates"
    if lines[0].strip().isdecimal() and len(lines) > 2 and _is_atom(lines[2]):
        return "XYZ"
    return None


def _is_atom(line: str) -> bool:
    words = line.split()
    if len(words) < 4 or not words[0].isalnum():
        return False
    try:
        return all(abs(float(word)) >= 0.0 for word in words[1:4])
    except ValueError:
        return False
