"""Files that are packed with gzip, unpacked within a budget."""

from __future__ import annotations

import gzip
import zlib
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, TYPE_CHECKING, Final

from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import Budget, check_ordinary, naming
from polhode.io.writing import writing

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["inner_suffix", "unpack"]

_BLOCK: Final = 1 << 20


def inner_suffix(path: Path) -> str:
    """Return the suffix of what a file holds: ``.stl`` of ``part.stl.gz``."""
    suffix = path.suffix.lower()
    return Path(path.stem).suffix.lower() if suffix == ".gz" else suffix


@contextmanager
def unpack(path: Path, budget: Budget | None = None) -> Iterator[Path]:
    """Return file itself, or where it is packed with gzip what it holds, in a folder that is then removed.

    Parameters
    ----------
    path : pathlib.Path
    budget : Budget, optional
        Its own by default.

    Raises
    ------
    FileFormatError
        If it unpacks to more than the budget, or is no whole gzip file.
    """
    if path.suffix.lower() != ".gz":
        yield path
        return
    check_ordinary(path)
    with TemporaryDirectory() as folder:
        inside = Path(folder, path.stem)
        with naming(path), writing(inside) as copy:
            _unpack(path, copy, budget or Budget(str(path), path.stat().st_size))
        try:
            yield inside
        except PolhodeError as error:
            error.rename_file(inside, path)
            raise


def _unpack(path: Path, copy: IO[bytes], budget: Budget) -> None:
    size = 0
    try:
        with gzip.open(path, "rb") as packed:
            while block := packed.read(_BLOCK):
                size += len(block)
                budget.spend("unpacked bytes", len(block))
                copy.write(block)
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise FileFormatError(path, f": not a whole gzip file: {error}; is it cut short?") from None
    if size == 0:
        raise FileFormatError(path, ": the file is empty; pack it again")
