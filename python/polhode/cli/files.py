"""Files as arguments: a path, or ``-`` for standard input; checks of the files that a command is to write."""

from __future__ import annotations

import os
import shutil
import stat
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from polhode.errors import FileFormatError, PolhodeError
from polhode.io.content import content_format
from polhode.io.writing import DASH, writing

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

__all__ = [
    "STDIN",
    "as_file",
    "check_depth",
    "check_outputs",
    "check_suffixes",
    "label",
]

STDIN: Final = DASH
_SUFFIXES: Final = {
    "binary STL": ".stl",
    "ASCII STL": ".stl",
    "PLY": ".ply",
    "OFF": ".off",
    "GLB": ".glb",
    "v/f text": ".obj",
    "numbered plates": ".tab",
    "glTF": ".gltf",
    "COLLADA": ".dae",
    "a ZIP archive": ".3mf",
    "STEP": ".step",
    "IGES": ".igs",
    "PDB": ".pdb",
    "MOL": ".mol",
    "XYZ": ".xyz",
}


def label(file: Path) -> str:
    """Name a file as a report does."""
    return "standard input" if file == STDIN else str(file)


def _begin() -> bytes:
    """Read the first bytes of standard input, which may be a device that never ends."""
    head: bytes = sys.stdin.buffer.read(1)
    try:
        is_device = stat.S_ISCHR(os.fstat(sys.stdin.fileno()).st_mode) and not sys.stdin.isatty()
    except (OSError, ValueError):  # there is no descriptor behind it
        is_device = False
    if head and is_device:
        raise FileFormatError("-: standard input is a device, which may never end; send a file into it")
    return head


@contextmanager
def as_file(file: Path) -> Iterator[Path]:
    """Return the file itself; standard input as a file whose suffix tells its content.

    Parameters
    ----------
    file : pathlib.Path
        ``-`` is standard input.

    Raises
    ------
    FileFormatError
        If nothing comes on standard input, or its content does not tell what it is.
    """
    if file != STDIN:
        yield file
        return
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        raw = Path(folder, "stdin")
        with writing(raw) as copy:
            copy.write(_begin())
            shutil.copyfileobj(sys.stdin.buffer, copy)
        with raw.open("rb") as stream:
            head = stream.read(4096)
        if not head:
            raise FileFormatError("-: nothing came on standard input; send a file into it")
        found, _ = content_format(head, raw.stat().st_size)
        suffix = _SUFFIXES.get(found or "")
        if found == "packed with gzip":
            raise FileFormatError(
                "-: standard input is packed with gzip; unpack it before, as in gunzip -c FILE | polhode"
            )
        if suffix is None:
            raise FileFormatError(
                "-: its content does not show its format; save it in a file with the format's suffix"
            )
        named = raw.rename(raw.with_suffix(suffix))
        try:
            yield named
        except PolhodeError as error:
            error.rename_file(named, label(file))
            raise


def check_outputs(outputs: Sequence[tuple[str, Path | None]], inputs: Iterable[Path | None]) -> None:
    """Refuse an output that is also an input, or twice the same output, even by way of links.

    Parameters
    ----------
    outputs : sequence of (str, pathlib.Path or None)
        The option and where it writes; None where it was not given.
    inputs : iterable of (pathlib.Path or None)
        Files that are read.

    Raises
    ------
    PolhodeError
        With the way out.
    """
    read = [path for path in inputs if path is not None]
    written: list[tuple[str, Path]] = []
    for option, path in outputs:
        if path is None:
            continue
        if not path.parent.is_dir():
            raise PolhodeError(
                f"{option}: {path}: there is no directory {path.parent}; check the path or create it first"
            )
        if any(_is_same(path, other) for other in read):
            raise PolhodeError(f"{option}: {path} is a file that is read; write to another one")
        twice = next((other for other, place in written if _is_same(path, place)), None)
        if twice is not None:
            raise PolhodeError(f"{option}: {path} is written by {twice} too; write to another one")
        written.append((option, path))


def check_suffixes(outputs: Iterable[Path], written: Sequence[str]) -> None:
    """Refuse files of --save whose suffix is none of those that are `written`."""
    for path in outputs:
        if path.suffix.lower() not in written:
            raise PolhodeError(
                f"--save: {path.name!r} has a suffix that is not written; use one of {', '.join(written)}"
            )


def check_depth(depth: int) -> None:
    """Refuse a negative number of levels of a tree."""
    if depth < 0:
        raise PolhodeError(f"--depth: expected a number of levels, 0 or more, got {depth}")


def _is_same(one: Path, other: Path) -> bool:
    """Return whether two names lead to one ordinary file; a pipe or a device may be named twice."""
    if DASH in (one, other):
        return False
    try:
        ours, theirs = one.stat(), other.stat()
    except OSError:
        return os.path.realpath(one) == os.path.realpath(other)
    return stat.S_ISREG(ours.st_mode) and os.path.samestat(ours, theirs)
