"""Files opened to be read: ordinary ones only, and whole texts up to a stated size."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

from polhode.errors import FileFormatError, PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = [
    "MOST_TEXT",
    "check_ordinary",
    "files_read",
    "naming",
    "note_read",
    "read_bytes",
    "read_text",
    "status_of",
    "text_of",
    "whole_of",
    "with_way_out",
    "words_of",
]

MOST_TEXT: Final = 1 << 30
"""Bytes of the largest text that is read whole."""

_READ: Final[ContextVar[tuple[list[Path], ...]]] = ContextVar("files read", default=())
_OTHERS: Final[tuple[tuple[Callable[[int], bool], str], ...]] = (
    (stat.S_ISDIR, "is a directory; name a file in it"),
    (stat.S_ISFIFO, "is a pipe, which may never end; save what comes out of it in a file"),
    (stat.S_ISSOCK, "is a socket; name a file"),
    (stat.S_ISCHR, "is a device, which may never end; name a file"),
    (stat.S_ISBLK, "is a device; name a file"),
)


@contextmanager
def files_read() -> Iterator[list[Path]]:
    """Give a list to which every file is added that is read in the meantime."""
    read: list[Path] = []
    outer = _READ.get()
    token = _READ.set((*outer, read))
    try:
        yield read
    finally:
        _READ.reset(token)


def note_read(path: str | os.PathLike[str]) -> None:
    """Add a file to the lists that :func:`files_read` gave."""
    for read in _READ.get():
        read.append(Path(path))


def status_of(path: str | os.PathLike[str]) -> os.stat_result:
    """Read the status of a file; a name that no file can have is refused with the reason."""
    try:
        return Path(path).stat()
    except ValueError as error:  # a NUL, or half of a surrogate pair
        reason = error.reason if isinstance(error, UnicodeEncodeError) else str(error)
        raise PolhodeError(f"path: {path!r} cannot be the name of a file ({reason}); correct it") from None


def check_ordinary(path: str | os.PathLike[str]) -> None:
    """Refuse a pipe, a device or a folder before it is opened: reading a pipe waits, a device never ends.

    Parameters
    ----------
    path : str or os.PathLike
        Links are followed.

    Raises
    ------
    FileFormatError
        If it is a directory, a pipe, a socket or a device.
    OSError
        If there is no such file.
    """
    mode = status_of(path).st_mode
    for is_that, words in _OTHERS:
        if is_that(mode):
            raise FileFormatError(f"{os.fspath(path)}: {words}")
    note_read(path)


_OF_THE_PATH: Final = (errno.ENOENT, errno.ENOTDIR, errno.ENAMETOOLONG, errno.ELOOP)
_RIGHTS: Final = (errno.EACCES, errno.EPERM, errno.EROFS)


def words_of(error: OSError) -> str:
    """Say what the system refused, and what to do where the path is the fault.

    Parameters
    ----------
    error : OSError
        Of the system, or raised here with a remedy of its own.

    Returns
    -------
    str
    """
    if error.filename is None or error.errno is None:
        return str(error)
    what = f"{error.filename}: {error.strerror}"
    if error.strerror != os.strerror(error.errno):
        return what
    if error.errno in _OF_THE_PATH:
        return f"{what}; check the path"
    if error.errno in _RIGHTS:
        return f"{what}; check who may read or write there"
    return f"{what}; name a file in it" if error.errno == errno.EISDIR else what


@contextmanager
def naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Let errors of the system name the file that is read."""
    try:
        yield
    except OSError as error:
        error.filename = error.filename or str(path)
        raise


def read_bytes(path: str | os.PathLike[str], most: int = MOST_TEXT) -> bytes:
    """Read a whole file of at most so many bytes.

    Parameters
    ----------
    path : str or os.PathLike
    most : int
        In bytes.

    Raises
    ------
    FileFormatError
        If it is larger, or no ordinary file.
    OSError
        With the name of the file.
    """
    check_ordinary(path)
    with naming(path), Path(path).open("rb") as stream:
        return _whole(stream, path, most)


def read_text(path: str | os.PathLike[str], kind: str, most: int = MOST_TEXT) -> str:
    """Read a whole text in UTF-8.

    Parameters
    ----------
    path : str or os.PathLike
    kind : str
        What it should be, for the error where it is no text.
    most : int
        In bytes.
    """
    return _decoded(read_bytes(path, most), path, kind)


def text_of(stream: BinaryIO, path: str | os.PathLike[str], kind: str, most: int = MOST_TEXT) -> str:
    """Read a whole text in UTF-8 from a file that is open; see :func:`read_text`."""
    return _decoded(_whole(stream, path, most), path, kind)


def whole_of(stream: BinaryIO, path: str | os.PathLike[str], most: int = MOST_TEXT) -> bytes:
    """Read a whole file that is open; see :func:`read_bytes`."""
    return _whole(stream, path, most)


def with_way_out(fault: object, way_out: str) -> str:
    """Give the words of a fault, with the way out behind them where they name none after a semicolon."""
    words = str(fault)
    return words if "; " in words else f"{words}; {way_out}"


def _whole(stream: BinaryIO, path: str | os.PathLike[str], most: int) -> bytes:
    if os.fstat(stream.fileno()).st_size <= most:
        data = stream.read(most + 1)
        if len(data) <= most:
            return data
    raise FileFormatError(
        f"{os.fspath(path)}: is larger than {most} bytes, the most that is read of such files; divide it"
    )


def _decoded(data: bytes, path: str | os.PathLike[str], kind: str) -> str:
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise FileFormatError(
            f"{os.fspath(path)}: not a text file, so not {kind}: byte {error.start} is not UTF-8; check "
            "the file"
        ) from None
