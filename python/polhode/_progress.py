"""A progress bar on stderr, with the estimated time that remains."""

from __future__ import annotations

import sys
import threading
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import TextIO

    Tell: TypeAlias = Callable[[float], object]
    Progress: TypeAlias = bool | Tell | None

__all__ = ["bar_of_core", "duration", "progress_bar"]

_SILENT: Final = 2.0
"""Seconds within which nothing is shown: most work is over by then."""
_BETWEEN: Final = 0.2
_WIDTH: Final = 30
_under_way: Final[list[_Bar]] = []
"""The bars of loops in Python, beneath which the core shows none."""


@contextmanager
def progress_bar(what: str, progress: Progress = None) -> Iterator[Tell | None]:
    """Open a progress bar, and return the function that updates it; None where no progress is shown.

    Parameters
    ----------
    what : str
        The words before the bar.
    progress : bool or callable, optional
        A function of one's own, called with the fraction; True and False for a bar and none. By default a
        bar where stderr is a terminal, once two seconds have passed.

    Yields
    ------
    callable or None
    """
    if progress is None:
        progress = sys.stderr is not None and sys.stderr.isatty()
        bar = _Bar(what, sys.stderr, _SILENT) if progress else None
    elif isinstance(progress, bool):
        bar = _Bar(what, sys.stderr, 0.0) if progress else None
    elif callable(progress):
        yield progress
        return
    else:
        kind = type(progress).__name__
        raise TypeError(
            f"progress: expected True, False, None or a function of the fraction done, got {kind}"
        )
    if bar is None:
        yield None
        return
    _under_way.append(bar)
    try:
        yield bar.tell
    finally:
        _under_way.remove(bar)
        bar.clear()


def bar_of_core() -> _Bar | None:
    """Return the bar of a long run of the core; None where nobody would see it.

    That is where stderr is no terminal, in a thread, and beneath a bar of a loop in Python.
    """
    is_main = threading.current_thread() is threading.main_thread()
    if _under_way or not is_main or sys.stderr is None or not sys.stderr.isatty():
        return None
    return _Bar("polhode", sys.stderr, 0.0)


def duration(seconds: float) -> str:
    """Write a time span in words.

    Parameters
    ----------
    seconds : float

    Returns
    -------
    str
    """
    if seconds < 60.0:
        return f"{seconds:.0f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {rest:02} s"


class _Bar:
    """A line of the terminal that each update replaces."""

    def __init__(self, what: str, stream: TextIO, silent: float) -> None:
        self.what, self.stream = what, stream
        self.start = time.monotonic()
        self.due = self.start + silent
        self.shown = 0

    def tell(self, fraction: float) -> None:
        now = time.monotonic()
        if now < self.due:
            return
        self.due = now + _BETWEEN
        full = round(_WIDTH * min(max(fraction, 0.0), 1.0))
        passed = now - self.start
        left = f", {duration(passed / fraction - passed)} left" if fraction > 0.0 else ""
        line = f"{self.what} [{'=' * full}{' ' * (_WIDTH - full)}] {100 * fraction:3.0f} %{left}"
        self._write(line.ljust(self.shown))
        self.shown = len(line)

    def clear(self) -> None:
        if self.shown:
            self._write(" " * self.shown)
            self._write("")

    def _write(self, line: str) -> None:
        self.stream.write(f"\r{line}")
        self.stream.flush()
