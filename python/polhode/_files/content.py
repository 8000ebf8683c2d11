"""What a file holds, told from its first bytes and its size rather than from its name."""

from __future__ import annotations

import codecs
import struct

__all__ = ["content_format"]

_STL_HEADER = 84
_STL_TRIANGLE = 50
_PLATE_KEYWORDS = frozenset({"v", "vn", "vt", "vp", "f", "o", "g", "s", "l", "mtllib", "usemtl"})
_CONTROL = bytes(set(range(32)) - set(b"\t\n\v\f\r\x1a"))


def content_format(head: bytes, size: int) -> tuple[str | None, bool]:
    """Tell the format of a file's content.

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
        ``"v/f text"``, ``"XYZ"``; None where none of these is certain.
    is_text : bool
        Whether it reads as text.
    """
    if head.startswith(b"glTF"):
        return "GLB", False
    if head.startswith((b"ply\n", b"ply\r")):
        return "PLY", False
    if head.startswith(b"PK\x03\x04"):
        return "a ZIP archive", False
    # Before ASCII STL, since binary files may also begin with the word "solid".
    if len(head) >= _STL_HEADER:
        (triangles,) = struct.unpack_from("<I", head, _STL_HEADER - 4)
        if size == _STL_HEADER + _STL_TRIANGLE * triangles:
            return "binary STL", False
    text = _as_text(head, whole=len(head) == size)
    if text is None:
        return None, False
    return _text_format(text), True


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
    if first.lower() == "solid":
        return "ASCII STL" if "facet" in text.lower() else None
    if first in ("OFF", "COFF", "NOFF"):
        return "OFF"
    if first in _PLATE_KEYWORDS:
        return "v/f text"
    lines = text.splitlines()
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
