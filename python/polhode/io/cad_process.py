"""CAD files read in a process of their own: OCCT ends the whole process on some damaged files.

That process imports OCCT instead of this one, so that little time is lost. It writes what the file holds and
then, one after the other, what solids near each other share: what came before it ended, or was ended, stays.
What OCCT does with a damaged file cannot be counted: its process has limits in seconds of computing, and ends
with the process that asked.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from threading import Event, Timer
from typing import IO, TYPE_CHECKING, Final

from polhode.errors import FileFormatError, PolhodeError
from polhode.io.cad_files import Pair, near_pairs, overlaps_told, volume_shared

if TYPE_CHECKING:
    from polhode.io.cad_files import CadFile

__all__ = ["read_cad_apart"]

_COMMAND: Final = ["-m", "polhode.io.cad_process"]
_READING: Final = (4.0, 3.0)
"""Seconds of computing in which a file is read, and those more for each megabyte of it."""
_SHARING: Final = (5.0, 5.0)
"""Seconds in which OCCT looks for what solids share, and those more for each megabyte beyond the first."""
_BOTH: Final = (8.0, 8.0)
"""Seconds for both, likewise; a second is left for sharing in any case."""
_SET_DEATH_SIGNAL: Final = 1
"""Linux's PR_SET_PDEATHSIG."""
_STOPPED: Final = -signal.SIGPROF if hasattr(signal, "SIGPROF") else None
"""Exit code of a process that has computed for too long."""


def read_cad_apart(path: Path, packed: int | None = None) -> CadFile:
    """Read the solids of a STEP or IGES file, and see which of them share matter.

    See :func:`polhode.io.cad_files.read_cad`.

    Parameters
    ----------
    path : pathlib.Path
    packed : int, optional
        Bytes of the file that it was unpacked from, if it was packed.
    """
    megabytes = _megabytes(path.stat().st_size, packed)
    if not sys.executable:  # within another program
        from polhode.io.cad_files import read_cad

        found = read_cad(path)
        return replace(found, overlaps=overlaps_told(found, [], "OCCT was not started"))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(place for place in sys.path if place)}
    with subprocess.Popen(
        [sys.executable, *_COMMAND, str(path), str(os.getpid()), str(_reading(megabytes))],
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    ) as process:
        try:
            cad, pairs, seconds = _answer(process, path, megabytes)
        except BaseException:
            process.kill()
            raise
    code = process.returncode
    fault = f"OCCT broke down when it looked for overlaps (exit code {code})" if code != 0 else ""
    fault = f"OCCT took more than {seconds:g} s to look for overlaps" if seconds is not None else fault
    return replace(cad, overlaps=overlaps_told(cad, pairs, fault))


def _answer(
    process: subprocess.Popen[bytes], path: Path, megabytes: float
) -> tuple[CadFile, list[Pair], float | None]:
    """Return what a file holds, the pairs that were looked at, and the seconds after which that was ended."""
    start = time.monotonic()
    assert process.stdout is not None  # it is a pipe
    try:
        cad: CadFile | PolhodeError = pickle.load(process.stdout)
    except (EOFError, pickle.UnpicklingError):
        if process.wait() == _STOPPED:
            raise FileFormatError(
                path,
                f": OCCT has computed for more than {_reading(megabytes):g} s on it, the most for "
                f"{megabytes:.2g} MB of file; unpack it if it is packed, export it again, or divide it",
            ) from None
        raise FileFormatError(
            path,
            f": OCCT broke down on it (exit code {process.wait()}), as it does on damaged files; "
            "export it again",
        ) from None
    if isinstance(cad, PolhodeError):
        raise cad
    is_ended = Event()

    def end() -> None:
        is_ended.set()
        process.kill()

    seconds = _sharing(megabytes, time.monotonic() - start)
    limit = Timer(seconds, end)
    limit.start()
    try:
        pairs = _pairs_in(process.stdout)
        process.wait()
    finally:
        limit.cancel()
    return cad, pairs, seconds if is_ended.is_set() else None


def _megabytes(size: int, packed: int | None) -> float:
    """Return the size that decides the time; of an unpacked file at most the packed size, or one megabyte."""
    return min(size, size if packed is None else max(packed, 1_000_000)) / 1e6


def _reading(megabytes: float) -> float:
    first, more = _READING
    return round(first + more * megabytes, 1)


def _sharing(megabytes: float, elapsed: float) -> float:
    """Return the seconds for overlaps when reading has taken some."""
    beyond = max(megabytes - 1.0, 0.0)
    own, both = (first + more * beyond for first, more in (_SHARING, _BOTH))
    return round(min(own, max(both - elapsed, 1.0)), 1)


def _pairs_in(stream: IO[bytes]) -> list[Pair]:
    """Read pairs until the stream ends, perhaps within one."""
    pairs = []
    while True:
        try:
            pairs.append(Pair(*pickle.load(stream)))
        except (EOFError, pickle.UnpicklingError):
            return pairs


def _main(path: Path, parent: int, seconds: float) -> None:
    """Write what a file holds, or what is wrong with it, on standard output, and then what solids share."""
    _end_with_parent(parent)
    out = os.dup(1)
    os.dup2(2, 1)  # OCCT speaks on standard output
    from polhode.io.cad_files import read_with_shapes

    try:
        cad, shapes = read_with_shapes(path, lambda runs: _set_time_limit(seconds if runs else 0.0))
    except PolhodeError as error:
        _send(out, error)
        return
    _send(out, cad)
    for i, k in near_pairs(cad.parts):
        _send(out, (i, k, volume_shared(shapes[i], shapes[k], cad.parts[k].moments.volume)))


def _end_with_parent(parent: int) -> None:
    """Let Linux end this process with the one that asked, even within OCCT, which lets no thread run.

    Elsewhere the seconds of computing end it.
    """
    if sys.platform != "linux":
        return
    import ctypes

    ctypes.CDLL(None).prctl(_SET_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != parent:  # it has ended already
        os._exit(1)


def _set_time_limit(seconds: float) -> None:
    """Let the system end this process after so many seconds of computing; zero: no limit."""
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_PROF, seconds)


def _send(out: int, found: object) -> None:
    """Write a pickle into a pipe, which takes it piece by piece."""
    left = memoryview(pickle.dumps(found))
    while left:
        left = left[os.write(out, left) :]


if __name__ == "__main__":
    _main(Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]))
