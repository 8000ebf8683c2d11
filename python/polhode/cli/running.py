"""How commands are called and how they end: with an exit code, and after an error with one line on stderr."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from cyclopts import CycloptsError

from polhode.cli.app import GOOD, app
from polhode.cli.standard_output import ReaderLeft, standard_output
from polhode.cli.text import in_options, printable
from polhode.files.reading import words_of

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["run"]

COMMANDS: Final = (
    "report", "check", "molecule", "spin", "flyby", "ensemble", "assemble", "ledger", "samples", "demo",
    "validate",
)  # fmt: skip
BAD_INPUT: Final = 2
INTERRUPTED: Final = 130


def _version_in_full() -> None:
    """Print what a report of a fault has to tell."""
    from polhode.cli.machine import as_text

    print(as_text())


def overview() -> str:
    """List the commands, each with the first line of its docstring."""
    lines = ["Usage: polhode COMMAND", "", app.help, "", "Commands:"]
    for name in COMMANDS:
        document = app[name].default_command.__doc__ or ""
        lines.append(f"  {name:<12}{document.partition(chr(10))[0]}")
    lines += ["", "polhode COMMAND --help tells what a command takes; polhode --version the version."]
    lines += ["polhode --version --verbose tells of the machine too, for reports of faults."]
    lines += ["Exit codes: 0 good, 1 the verdict is bad, 2 bad input."]
    return "\n".join(lines)


def run(arguments: list[str]) -> int:
    """Run one command and turn every foreseen error into one line and an exit code."""
    command: Callable[[], object] = partial(
        app,
        [_as_value(argument) for argument in arguments],
        exit_on_error=False,
        print_error=False,
        result_action="return_value",
    )
    if arguments in ([], ["--help"], ["-h"]):
        command = partial(print, overview())
    if sorted(arguments) == ["--verbose", "--version"]:
        command = _version_in_full
    try:
        with standard_output():
            code = command()
    except CycloptsError as error:
        return _fail(f"{error} (see polhode --help)")
    except ReaderLeft:
        return GOOD
    except OSError as error:
        return _fail(words_of(error))
    except MemoryError as error:
        return _fail(f"there is not enough memory for it ({error})")
    except (ValueError, ModuleNotFoundError) as error:
        return _fail(str(error))
    except KeyboardInterrupt:
        return _fail("interrupted", code=INTERRUPTED)
    return code if isinstance(code, int) else 0


def _as_value(argument: str) -> str:
    """Keep ``"-1 0 0 deg/s"`` from being taken for an option, and the file ``./-`` for standard input."""
    if argument == "./-":  # a path without its "./" would be "-"
        return str(Path.cwd() / "-")
    return f" {argument}" if re.match(r"-\.?\d", argument) else argument


def _fail(message: str, code: int = BAD_INPUT) -> int:
    if sys.stderr is not None:
        with suppress(OSError):  # nobody reads it: the exit code remains
            print("polhode:", printable(in_options(" ".join(message.split()))), file=sys.stderr, flush=True)
    return code
