"""Standard output of the commands, with errors of its own: they are not taken for those of another file."""

from __future__ import annotations

import os
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, TextIO, cast

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["ReaderLeft", "standard_output"]


class ReaderLeft(Exception):  # noqa: N818 (it tells of no error)
    """The reader of standard output has closed it early, as ``head`` does: nothing is wrong."""


class _Named:
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
    named = _Named(stream)
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
        from polhode.files.writing import STANDARD_OUTPUT

        error.filename = STANDARD_OUTPUT
        raise


def _give_up(stream: Any) -> None:
    """Discard what is still buffered for standard output."""
    try:
        stream.flush()
    except OSError:
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
