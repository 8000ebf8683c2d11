"""CAD files read in a process of their own: OCCT ends the whole process on some damaged files.

That process imports OCCT instead of this one, so that little time is lost. It writes what the file holds and
then, one after the other, what solids near each other share: what came before it ended, or was ended, stays.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from threading import Event, Timer
from typing import IO, TYPE_CHECKING, Final

from polhode import errors
from polhode.errors import FileFormatError, PolhodeError
from polhode.files.cad_overlaps import Pair, near_pairs, overlaps_told, volume_shared

if TYPE_CHECKING:
    from polhode.files.cad_file import CadFile

__all__ = ["read_cad_apart"]

_COMMAND: Final = ["-m", "polhode.files.cad_apart"]
_SECONDS: Final = 60.0
"""So long is looked for what solids share."""


def read_cad_apart(path: Path) -> CadFile:
    """Read the solids of a STEP or IGES file, and see which of them share matter.

    See :func:`polhode.files.cad_file.read_cad`.
    """
    if not sys.executable:  # within another program
        from polhode.files.cad_file import read_cad

        found = read_cad(path)
        return replace(found, overlaps=overlaps_told(found, [], "OCCT was not started"))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(place for place in sys.path if place)}
    with subprocess.Popen(
        [sys.executable, *_COMMAND, str(path)],
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    ) as process:
        try:
            cad, pairs, is_ended = _answer(process, path)
        except BaseException:
            process.kill()
            raise
    code = process.returncode
    fault = f"OCCT broke down when it looked for overlaps (exit code {code})" if code != 0 else ""
    fault = f"OCCT took more than {_SECONDS:g} s to look for overlaps" if is_ended else fault
    return replace(cad, overlaps=overlaps_told(cad, pairs, fault))


def _answer(process: subprocess.Popen[bytes], path: Path) -> tuple[CadFile, list[Pair], bool]:
    """Give what a file holds and the pairs that were looked at; and whether that was ended before its end."""
    assert process.stdout is not None  # it is a pipe
    try:
        cad: CadFile | tuple[str, str] = pickle.load(process.stdout)
    except (EOFError, pickle.UnpicklingError):
        raise FileFormatError(
            f"{path}: OCCT broke down on it (exit code {process.wait()}), as it does on damaged files; "
            "export it again"
        ) from None
    if isinstance(cad, tuple):
        kind, text = cad
        raise getattr(errors, kind, PolhodeError)(text)
    is_ended = Event()

    def end() -> None:
        is_ended.set()
        process.kill()

    limit = Timer(_SECONDS, end)
    limit.start()
    try:
        pairs = _pairs_in(process.stdout)
        process.wait()
    finally:
        limit.cancel()
    return cad, pairs, is_ended.is_set()


def _pairs_in(stream: IO[bytes]) -> list[Pair]:
    """Read pairs until the stream ends, perhaps within one."""
    pairs = []
    while True:
        try:
            pairs.append(Pair(*pickle.load(stream)))
        except (EOFError, pickle.UnpicklingError):
            return pairs


def _main(path: Path) -> None:
    """Write what a file holds, or what is wrong with it, on standard output, and then what solids share."""
    out = os.dup(1)
    os.dup2(2, 1)  # OCCT speaks on standard output
    from polhode.files.cad_file import read_with_shapes

    try:
        cad, shapes = read_with_shapes(path)
    except PolhodeError as error:
        _send(out, (type(error).__name__, str(error)))
        return
    _send(out, cad)
    for i, k in near_pairs(cad.parts):
        _send(out, (i, k, volume_shared(shapes[i], shapes[k], cad.parts[k].moments.volume)))


def _send(out: int, found: object) -> None:
    """Write a pickle into a pipe, which takes it piece by piece."""
    left = memoryview(pickle.dumps(found))
    while left:
        left = left[os.write(out, left) :]


if __name__ == "__main__":
    _main(Path(sys.argv[1]))
