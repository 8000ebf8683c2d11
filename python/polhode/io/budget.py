"""Files opened to be read: ordinary ones only, texts up to a stated size, all within one budget."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final, NamedTuple

from polhode.errors import FileFormatError, PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

__all__ = [
    "LIMITS",
    "MOST_TEXT",
    "Budget",
    "Limit",
    "LimitError",
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


class Limit(NamedTuple):
    """How many of a kind may be made of a file, and the way out where that is not enough."""

    least: int
    per_byte: float
    way_out: str


LIMITS: Final[Mapping[str, Limit]] = {
    "unpacked bytes": Limit(1 << 24, 32.0, "unpack it, and pack it with less compression or not at all"),
    "elements": Limit(1_000_000, 0.125, "divide the file"),
    "tags": Limit(2_000_000, 1.0, "divide the file"),
    "atoms": Limit(1_000_000, 0.125, "divide the file"),
    "items": Limit(50_000, 0.0625, "place fewer parts"),
    "placements": Limit(50_000, 0.0625, "place fewer parts"),
    "triangles": Limit(1_000_000, 1.0, "place fewer parts, or coarser ones"),
    "points or cells": Limit(1_000_000, 1.0, "divide the file"),
    "numbers": Limit(10_000_000, 2.0, "let each part name an array of its own"),
    "words": Limit(10_000_000, 1.0, "divide the file"),
    "readings of files": Limit(2000, 0.002, "count says how often a part is there"),
    "bytes read": Limit(1 << 24, 32.0, "count says how often a part is there"),
    "files": Limit(1000, 0.0, "divide the model"),
    "included bytes": Limit(1 << 28, 0.0, "divide the model"),
    "links": Limit(50_000, 0.0, "divide the model"),
    "copies": Limit(10_000, 0.0, "lower the count"),
    "levels": Limit(5000, 0.0, "nest parts in fewer levels"),
    "shared errors": Limit(200_000, 20.0, "name fewer sources, or nest parts in fewer levels"),
    "elements in copies": Limit(50_000, 0.0, "lower the count"),
}
"""By kind: so many, and so many more for each byte of the file."""


class LimitError(FileFormatError):
    """A file that grows beyond a limit, which ends the reading as a whole."""


class Budget:
    """What may still be made of a file, and of those that it names.

    Parameters
    ----------
    name : str
        Of the file, for errors.
    size : int
        In bytes, as it lies on the disk.
    unit : str
        In what a table that is no file has its size.
    """

    def __init__(self, name: str, size: int, unit: str = "bytes of file") -> None:
        self.name, self._unit = name, unit
        self._size = size
        self._spent = dict.fromkeys(LIMITS, 0)
        self._files: set[str] = set()

    def add_file(self, size: int, name: str = "") -> None:
        """Count the bytes of another file that belongs to this one; of a file with a name once."""
        if not name or name not in self._files:
            self._size += size
            self._files.add(name)

    def most(self, kind: str) -> int:
        """Return how many of a kind may be made in all."""
        least, per_byte, _ = LIMITS[kind]
        return least + int(per_byte * self._size)

    def remaining(self, kind: str) -> int:
        """Return how many of a kind may still be made."""
        return self.most(kind) - self._spent[kind]

    def spend(self, kind: str, count: int = 1, *where: str) -> None:
        """Count what is about to be made.

        Parameters
        ----------
        kind : str
            Of :data:`LIMITS`.
        count : int
            How many; negative where what was counted is not made after all.
        *where : str
            Pieces of the place, for the error; the name of the file by default.

        Raises
        ------
        LimitError
            If there are too many.
        """
        self._spent[kind] += count
        if self._spent[kind] <= (most := self.most(kind)):
            return
        _, per_byte, way_out = LIMITS[kind]
        of = f", the most for {self._size} {self._unit}" if per_byte else ""
        raise LimitError(*(where or (self.name,)), f": there are more than {most} {kind}{of}; {way_out}")


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
    """Return a list to which every file is added that is read in the meantime."""
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
            raise FileFormatError(os.fspath(path), f": {words}")
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
    return _decode(read_bytes(path, most), path, kind)


def text_of(stream: BinaryIO, path: str | os.PathLike[str], kind: str, most: int = MOST_TEXT) -> str:
    """Read a whole text in UTF-8 from a file that is open; see :func:`read_text`."""
    return _decode(_whole(stream, path, most), path, kind)


def whole_of(stream: BinaryIO, path: str | os.PathLike[str], most: int = MOST_TEXT) -> bytes:
    """Read a whole file that is open; see :func:`read_bytes`."""
    return _whole(stream, path, most)


def with_way_out(fault: object, way_out: str) -> str:
    """Return the words of a fault, with the way out behind them where they name none after a semicolon."""
    words = str(fault)
    return words if "; " in words else f"{words}; {way_out}"


def _whole(stream: BinaryIO, path: str | os.PathLike[str], most: int) -> bytes:
    if os.fstat(stream.fileno()).st_size <= most:
        data = stream.read(most + 1)
        if len(data) <= most:
            return data
    raise FileFormatError(
        os.fspath(path), f": is larger than {most} bytes, the most that is read of such files; divide it"
    )


def _decode(data: bytes, path: str | os.PathLike[str], kind: str) -> str:
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise FileFormatError(
            os.fspath(path),
            f": not a text file, so not {kind}: byte {error.start} is not UTF-8; check the file",
        ) from None
