"""A bar on stderr that shows how far long work is, where stderr is a terminal."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from polhode.cli.text import printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

__all__ = ["progress", "reading_progress"]

_LARGE_FILE: Final = 1 << 26


@contextmanager
def progress(what: str, *, is_long: bool = True) -> Iterator[Callable[[float], object] | None]:
    """Give a function that takes the fraction done; None where no bar is drawn."""
    if not (is_long and sys.stderr.isatty()):
        yield None
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bars:
        task = bars.add_task(escape(printable(what)), total=1.0)
        yield lambda fraction: bars.update(task, completed=fraction)


@contextmanager
def reading_progress(file: Path) -> Iterator[Callable[[float], object] | None]:
    """Tell how much of a large file is read."""
    is_long = file.is_file() and file.stat().st_size >= _LARGE_FILE
    with progress(f"reading {file.name}", is_long=is_long) as tell:
        yield tell
