"""Files that are packed with gzip, unpacked to a stated size."""

from __future__ import annotations

import gzip
import zlib
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, TYPE_CHECKING, Final

from polhode.errors import FileFormatError, PolhodeError
from polhode.files.reading import check_ordinary, naming
from polhode.files.writing import writing

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["MOST_UNPACKED", "inner_suffix", "unpacked"]

MOST_UNPACKED: Final = 1 << 32
"""Bytes that a packed file may unpack to."""
_BLOCK: Final = 1 << 20


def inner_suffix(path: Path) -> str:
    """Give the suffix of what a file holds: ``.stl`` of ``part.stl.gz``."""
    suffix = path.suffix.lower()
    return Path(path.stem).suffix.lower() if suffix == ".gz" else suffix


@contextmanager
def unpacked(path: Path, most: int = MOST_UNPACKED) -> Iterator[Path]:
    """Give the file itself, or where it is packed with gzip what it holds, in a folder that is then removed.

    Parameters
    ----------
    path : pathlib.Path
    most : int
        Bytes.

    Raises
    ------
    FileFormatError
        If it unpacks to more, or is no whole gzip file.
    """
    if path.suffix.lower() != ".gz":
        yield path
        return
    check_ordinary(path)
    with TemporaryDirectory() as folder:
        inside = Path(folder, path.stem)
        with naming(path), writing(inside) as copy:
            _unpack(path, copy, most)
        try:
            yield inside
        except PolhodeError as error:
            error.args = (str(error).replace(str(inside), str(path)), *error.args[1:])
            raise


def _unpack(path: Path, copy: IO[bytes], most: int) -> None:
    size = 0
    try:
        with gzip.open(path, "rb") as packed:
            while block := packed.read(_BLOCK):
                size += len(block)
                if size > most:
                    raise FileFormatError(f"{path}: unpacks to more than {most} bytes; unpack it with gunzip")
                copy.write(block)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise FileFormatError(f"{path}: not a whole gzip file: {error}; is it cut short?") from None
    if size == 0:
        raise FileFormatError(f"{path}: the file is empty; pack it again")
