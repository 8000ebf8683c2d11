"""The terminal: text that is safe to show, standard output with errors of its own, and a progress bar."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, Final, TextIO, cast

from polhode._format import Note, in_words
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from rich.console import Console

    from polhode._format import Argument

__all__ = [
    "ClosedPipe",
    "in_options",
    "note",
    "printable",
    "progress",
    "reading_progress",
    "standard_output",
    "write",
]

_REMEDIES: Final = {
    "impossible": "; check the numbers and their units",
    "impossible matter": "; check matter for surfaces that cross, or take another tensor",
    "index zero": ": --index-base 0",
    "nearly symmetric": "; give equal moments, or integrate with RigidBody.simulate in Python",
    "not symmetric": "; integrate with RigidBody.simulate in Python",
    "pivot off axis": "; correct --center-of-mass, or integrate with RigidBody.simulate in Python",
    "rounded": "; give more digits",
}
"""Remedies of the command line in the place of Python's, at the end of an error of the core, by its kind."""


def in_options(message: str | Exception) -> str:
    """Write a note or an error in words, with options where Python has arguments."""
    if isinstance(message, Note):
        return in_words(message.pieces, _option)
    if not isinstance(message, PolhodeError):
        return str(message)
    if message.kind in _REMEDIES:
        return in_words(message.args[:-1], _option) + _REMEDIES[message.kind]
    return message.words(_option)


def _option(argument: Argument) -> str:
    name = f"--{argument.name.replace('_', '-')}"
    if argument.value in (None, True):
        return name
    return " or ".join(f"{name} {value}" for value in argument.values)


def printable(text: str) -> str:
    """Escape control characters, so that text from a file is safe to show in a terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def note(notes: Iterable[str]) -> None:
    """Print notes on stderr, where the output is for another program."""
    if sys.stderr is None:
        return
    with suppress(OSError):  # nobody reads them
        for each in notes:
            print("polhode: note:", printable(in_options(each)), file=sys.stderr, flush=True)


def write(console: Console, line: str = "", style: str = "") -> None:
    """Print one line as it is: no markup, no breaking to a guessed width."""
    from rich.text import Text

    console.print(Text(line, style=style), soft_wrap=True)


class ClosedPipe(Exception):  # noqa: N818 (it tells of no error)
    """The reader of standard output has closed it early, as ``head`` does: nothing is wrong."""


class _NamedStream:
    """A stream whose errors have its name; all else is the stream itself."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with _naming():
            return int(self._stream.write(text))

    def flush(self) -> None:
        with _naming():
            self._stream.flush()


@contextmanager
def standard_output() -> Iterator[None]:
    """Let standard output raise errors with its name, and ClosedPipe where nobody reads it.

    It is flushed at the end. A name that is beyond the terminal's encoding is escaped. What can not be
    written is given up, so that Python does not try again when it ends.
    """
    stream: Any = sys.stdout
    if stream is None:  # closed by who called: the exit code is all that is asked for
        yield
        return
    with suppress(AttributeError, ValueError):
        stream.reconfigure(errors="backslashreplace")
    named = _NamedStream(stream)
    sys.stdout = cast("TextIO", named)
    try:
        yield
        named.flush()
    except (ClosedPipe, OSError):
        _give_up(stream)
        raise
    finally:
        sys.stdout = stream


@contextmanager
def _naming() -> Iterator[None]:
    try:
        yield
    except BrokenPipeError:
        raise ClosedPipe from None
    except OSError as error:
        from polhode.io.writing import STANDARD_OUTPUT

        error.filename = STANDARD_OUTPUT
        raise


def _give_up(stream: Any) -> None:
    """Discard what is still buffered for standard output."""
    try:
        stream.flush()
    except OSError:
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


_LARGE_FILE: Final = 1 << 26


@contextmanager
def progress(what: str, *, is_long: bool = True) -> Iterator[Callable[[float], object] | None]:
    """Return a function that takes the fraction done; None where no bar is drawn."""
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
    """Describe how much of a large file is read."""
    is_long = file.is_file() and file.stat().st_size >= _LARGE_FILE
    with progress(f"reading {file.name}", is_long=is_long) as tell:
        yield tell
