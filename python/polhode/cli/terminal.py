"""The terminal: text that is safe to show, standard output with errors of its own, and a progress bar."""

from __future__ import annotations

import os
import re
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, Final, TextIO, cast

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from rich.console import Console

__all__ = [
    "ReaderLeft",
    "in_options",
    "note",
    "printable",
    "progress",
    "reading_progress",
    "standard_output",
    "write",
]

_WAYS_OUT: Final = (
    ('closure="caps" or "hull"', "--closure caps or --closure hull"),
    ("pass orient=True", "pass --orient"),
    ("repair=True mends it", "--repair mends it"),
    ("repair closes and orients by itself", "--repair closes and orients by itself"),
    ("leave index_base out", "leave --index-base out"),
    ("leave length_unit out", "leave --length-unit out"),
    ("pass density= instead", "pass --density instead"),
    ("pass allow_outside=True", "pass --allow-outside"),
    (" (validity.nearest_valid finds the nearest tensor that a body has)", ""),
    ("move the body with translated()", "correct --center"),
    ("index_base=0", "--index-base 0"),
    ("pass overwrite=True", "pass --overwrite"),
    ("pass ignore= with its name", "pass --ignore with its name"),
    ("pass the edges as tree=", "pass the edges as --tree"),
    ("give the body a thickness, or nothing inside", "leave out --wheel"),
    ("integrate with simulate()", "integrate with RigidBody.simulate in Python"),
)
_NAMED: Final = re.compile(
    r"^(weld|closure|orient|union|repair|index_base|length_unit|mass|density|seed|chunk)(?=: )"
)
"""Of arguments that are options by the same names."""
_CLOSURE: Final = re.compile(r'\bclosure="(caps|hull)"(?=\)| takes)')
_WELD: Final = re.compile(r"\bweld=(?=\S+ joins)")
_RTOL: Final = (
    (re.compile(r"\bpass rtol=\S+ if the table was printed to few digits"), "give more digits"),
    (re.compile(r"\bpass rtol=\S+ to take them as equal"), "give equal moments"),
)


def in_options(message: str) -> str:
    """Replace the names of Python's arguments in a message by the options of the command line."""
    for argument, option in _WAYS_OUT:
        message = message.replace(argument, option)
    for pattern, option in _RTOL:
        message = pattern.sub(option, message)
    message = _NAMED.sub(lambda found: f"--{found[1].replace('_', '-')}", message)
    message = _CLOSURE.sub(r"--closure \1", message)
    return _WELD.sub("--weld ", message)


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


class ReaderLeft(Exception):  # noqa: N818 (it tells of no error)
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
    """Let standard output raise errors with its name, and ReaderLeft where nobody reads it.

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
    except (ReaderLeft, OSError):
        _give_up(stream)
        raise
    finally:
        sys.stdout = stream


@contextmanager
def _naming() -> Iterator[None]:
    try:
        yield
    except BrokenPipeError:
        raise ReaderLeft from None
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
