"""CAD files read in a process of their own: OCCT ends the whole process on some damaged files.

That process imports OCCT instead of this one, so that little time is lost.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from polhode import errors
from polhode.errors import FileFormatError, PolhodeError

if TYPE_CHECKING:
    from polhode.files.cad_file import CadFile

__all__ = ["read_cad_apart"]

_COMMAND: Final = ["-m", "polhode.files.cad_apart"]


def read_cad_apart(path: Path) -> CadFile:
    """Read the solids of a STEP or IGES file; see :func:`polhode.files.cad_file.read_cad`."""
    if not sys.executable:  # within another program
        from polhode.files.cad_file import read_cad

        return read_cad(path)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(place for place in sys.path if place)}
    done = subprocess.run(
        [sys.executable, *_COMMAND, str(path)],
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        check=False,
    )
    if done.returncode != 0:
        raise FileFormatError(
            f"{path}: OCCT broke down on it (exit code {done.returncode}), as it does on damaged files; "
            "export it again"
        )
    found: CadFile | tuple[str, str] = pickle.loads(done.stdout)
    if isinstance(found, tuple):
        kind, text = found
        raise getattr(errors, kind, PolhodeError)(text)
    return found


def _main(path: Path) -> None:
    """Read a file and write what it holds, or what is wrong with it, on standard output."""
    out = os.dup(1)
    os.dup2(2, 1)  # OCCT speaks on standard output
    from polhode.files.cad_file import read_cad

    found: CadFile | tuple[str, str]
    try:
        found = read_cad(path)
    except PolhodeError as error:
        found = type(error).__name__, str(error)
    os.dup2(out, 1)
    sys.stdout.buffer.write(pickle.dumps(found))


if __name__ == "__main__":
    _main(Path(sys.argv[1]))
