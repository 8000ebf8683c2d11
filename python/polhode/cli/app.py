"""The commands and the way they end: an exit code, and for an error one line on stderr."""

from __future__ import annotations

import os
import sys
from functools import partial
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, CycloptsError, Parameter
from rich.console import Console

from polhode import __version__
from polhode.cli import demo as demonstration
from polhode.cli.layout import printable
from polhode.cli.report import BodyOptions, file_report
from polhode.cli.spin import SpinOptions, spin_report

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode.cli.layout import Report

__all__ = ["app", "run"]

BAD_INPUT = 2
INTERRUPTED = 130

app = App(
    name="polhode",
    help="One body in: an inertia you can trust, and exactly how it will spin.",
    version=f"polhode {__version__}",
    help_format="plaintext",
    suppress_keyboard_interrupt=False,
)

Form = Annotated[Literal["table", "json"], Parameter(name="--format")]
Body = Annotated[BodyOptions, Parameter(name="*")]
AS_STORED = BodyOptions()
Spin = Annotated[SpinOptions, Parameter(name="*")]


@app.command
def report(file: Path, /, *, body: Body = AS_STORED, form: Form = "table") -> int:
    """Print mass, centre, inertia and principal axes of the body in a file.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, OFF, GLB, v/f plate file) or a molecule (XYZ).
    form
        A table for people or the same fields as JSON, where an infinite number is the string "Infinity"
        and an undefined one is null.
    """
    _show(file_report(file, body), form)
    return 0


@app.command
def spin(file: Path, /, *, spin: Spin, body: Body = AS_STORED, form: Form = "table") -> int:
    """Let the body in a file spin freely and print how it ends.

    Parameters
    ----------
    file
        A mesh (STL, OBJ, PLY, OFF, GLB, v/f plate file) or a molecule (XYZ).
    form
        A table for people or the same fields as JSON, where an undefined number is null.
    """
    _show(spin_report(file, spin, body), form)
    return 0


@app.command
def demo(*, output_dir: Path = Path("polhode-demo")) -> int:
    """Show it all without a file of your own: a T-handle that flips, and NASA's tumbling brick.

    Parameters
    ----------
    output_dir
        Where the mesh and the picture are written.
    """
    return demonstration.run(output_dir, Console(highlight=False))


def run(arguments: list[str]) -> int:
    """Run one command and turn every foreseen error into one line and an exit code."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(
            errors="backslashreplace"
        )  # a file may be named beyond the terminal's encoding
    command: Callable[[], object] = partial(
        app, arguments, exit_on_error=False, print_error=False, result_action="return_value"
    )
    try:
        code = command()
        sys.stdout.flush()
    except CycloptsError as error:
        return _fail(f"{error} (see polhode --help)")
    except BrokenPipeError:
        # The reader of a pipe has left (as `head` does); nothing is wrong and nobody is listening.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        what = f"{error.filename}: {error.strerror}" if error.filename is not None else str(error)
        return _fail(f"{what}; check the path")
    except (ValueError, ModuleNotFoundError) as error:
        return _fail(str(error))
    except KeyboardInterrupt:
        return _fail("interrupted", code=INTERRUPTED)
    return code if isinstance(code, int) else 0


def _fail(message: str, code: int = BAD_INPUT) -> int:
    print("polhode:", printable(" ".join(message.split())), file=sys.stderr)
    return code


def _show(report: Report, form: str) -> None:
    if form == "json":
        print(report.as_json())
    else:
        report.print(Console(highlight=False))
