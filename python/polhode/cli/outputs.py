"""Checks of the files that a command is to write: their folders exist, and none of them is read too."""

from __future__ import annotations

import os
import stat
from typing import TYPE_CHECKING

from polhode.errors import PolhodeError
from polhode.files.writing import DASH

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

__all__ = ["check_outputs"]


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


def _is_same(one: Path, other: Path) -> bool:
    """Whether two names lead to one ordinary file; a pipe or a device may be named twice."""
    if DASH in (one, other):
        return False
    try:
        ours, theirs = one.stat(), other.stat()
    except OSError:
        return os.path.realpath(one) == os.path.realpath(other)
    return stat.S_ISREG(ours.st_mode) and os.path.samestat(ours, theirs)
