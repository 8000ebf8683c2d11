"""Files written whole or not at all: every file that the package writes goes through here."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Final

from polhode.io.budget import status_of

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "DASH",
    "STANDARD_OUTPUT",
    "replacing",
    "save_picture",
    "write_bytes",
    "writing",
]

DASH: Final = Path("-")
"""Standard input or output as a path."""
STANDARD_OUTPUT: Final = "standard output"
"""Its name in errors."""
_LONGEST_SUFFIX: Final = 16
_WITHOUT_FSYNC: Final = (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP)


@contextmanager
def writing(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file for bytes, which stand under its name once all of them are written.

    Parameters
    ----------
    path : str or os.PathLike
        A link is followed, and the permissions of an old file are kept. Pipes, devices and ``-`` (standard
        output) are written straight into.

    Yields
    ------
    binary stream

    Raises
    ------
    OSError
        With the name of the file.
    """
    descriptor = _standard_descriptor(Path(path))
    if descriptor is not None:
        with _naming(path, None), open(os.dup(descriptor), "wb") as stream:  # noqa: PTH123 (no path)
            yield stream
        return
    with replacing(path) as place, place.open("wb") as stream:
        yield stream


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Return the path of a new file beside the old one, which it replaces at the end.

    For what writes to a name; :func:`writing` is for what writes into a stream.

    Parameters
    ----------
    path : str or os.PathLike
        As for :func:`writing`; the path of a pipe or a device is given as it is.

    Yields
    ------
    pathlib.Path
        An empty file with the same suffix.

    Raises
    ------
    OSError
        With the name of the file.
    """
    old = _old(path)
    if old is not None and not stat.S_ISREG(old.st_mode):
        with _naming(path, None):
            yield Path(path)
        return
    target = Path(os.path.realpath(path))
    suffix = target.suffix if len(target.suffix) <= _LONGEST_SUFFIX else ""
    new = target.with_name(f".polhode-{os.urandom(8).hex()}{suffix}")
    with _naming(path, new):
        _create(new)
        try:
            yield new
            _keep(new, old)
            new.replace(target)
        except BaseException:
            with suppress(OSError):
                new.unlink()
            raise


def write_bytes(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a whole file, see :func:`writing`."""
    with writing(path) as stream:
        stream.write(data)


def _old(path: str | os.PathLike[str]) -> os.stat_result | None:
    """Return the status of the old file, if any; an error where nothing can be written."""
    try:
        old = status_of(path)
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(old.st_mode):
        raise IsADirectoryError(errno.EISDIR, "is a directory; name a file in it", str(path))
    if stat.S_ISSOCK(old.st_mode):
        raise OSError(errno.ENXIO, "is a socket, which no file can be written to; name a file", str(path))
    if stat.S_ISREG(old.st_mode) and not os.access(path, os.W_OK):
        # Its folder may allow to replace it; whoever took the right to write away did not mean that.
        raise PermissionError(errno.EACCES, f"{os.strerror(errno.EACCES)}; name another file", str(path))
    return old


def _standard_descriptor(file: Path) -> int | None:
    """Return the descriptor of standard output or error where the file is one, as ``/dev/stdout`` is.

    What has been written to it already stays, and its other writers go on behind.
    """
    if file == DASH:
        return 1
    for descriptor in (1, 2):
        with suppress(OSError):
            if os.path.samestat(file.stat(), os.fstat(descriptor)):
                return descriptor
    return None


def _create(new: Path) -> None:
    """Create an empty file with the permissions that new files get."""
    try:
        os.close(os.open(new, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    except PermissionError as error:
        reason = (
            f"its folder takes no new file ({os.strerror(errno.EACCES)}), and an old one is only replaced; "
            "name a file in another"
        )
        raise PermissionError(errno.EACCES, reason, str(new)) from error


def _keep(new: Path, old: os.stat_result | None) -> None:
    """Bring a finished file to the disk, with the permissions and the owner of the old one."""
    with new.open("r+b") as stream:
        try:
            os.fsync(stream.fileno())
        except OSError as error:
            if error.errno not in _WITHOUT_FSYNC:
                raise
    if old is None:
        return
    made = new.stat()
    if hasattr(os, "chown") and (old.st_uid, old.st_gid) != (made.st_uid, made.st_gid):
        with suppress(PermissionError):  # only root may give files away
            os.chown(new, old.st_uid, old.st_gid)
    new.chmod(stat.S_IMODE(old.st_mode))


@contextmanager
def _naming(path: str | os.PathLike[str], new: Path | None) -> Iterator[None]:
    """Let errors of the system name the file that was asked for."""
    try:
        yield
    except OSError as error:
        if error.errno is not None and error.filename in (None, *([str(new), new] if new else [])):
            is_standard = Path(path) in (DASH, Path("/dev/stdout"))
            error.filename, error.filename2 = STANDARD_OUTPUT if is_standard else str(path), None
        raise


_DOTS_PER_INCH: Final = 160


def save_picture(figure: Any, path: Path) -> None:
    """Write a figure of matplotlib in the format that the suffix names.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : pathlib.Path
    """
    with writing(path) as stream:
        figure.savefig(stream, format=path.suffix.lower().removeprefix("."), dpi=_DOTS_PER_INCH)
