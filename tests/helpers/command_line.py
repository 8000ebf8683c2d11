"""The command line as the tests run it: in this process."""

from __future__ import annotations

import io
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from mesh_files import obj
from polhode.cli import main

__all__ = ["one_line", "run", "write_obj"]


def run(*arguments: object) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of ``polhode`` with these arguments."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        code = main([str(argument) for argument in arguments])
    return code, out.getvalue(), err.getvalue()


def one_line(text: str) -> bool:
    """Whether this is an error as the command line reports them."""
    return text.startswith("polhode: ") and text.count("\n") == 1 and "Traceback" not in text


def write_obj(path: Path, vertices: Any, faces: Any) -> Path:
    """Write a mesh as OBJ."""
    path.write_bytes(obj(vertices, faces))
    return path
