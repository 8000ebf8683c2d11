"""Where what a command found goes: on standard output or into a file, as a table, as JSON or as lines."""

from __future__ import annotations

from io import StringIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import Console

    from polhode.cli.layout import Report
    from polhode.cli.options import OutputOptions, ReportOptions

__all__ = ["held_and_shown", "show", "show_lines"]


def held_and_shown(
    told: Report, extra: ReportOptions, output: OutputOptions, saved: Iterable[str] = ()
) -> bool:
    """Hold a report against what was expected, save what is to be saved, and show it.

    Returns
    -------
    bool
        Whether it agrees.
    """
    agrees = True
    if extra.expect is not None:
        from polhode.cli.compare import held_against

        agrees = not held_against(told, extra.expect, extra.rtol)
    told.notes += saved
    show(told, output)
    return agrees


def show_lines(text: str, options: OutputOptions) -> None:
    """Write lines as they are, such as numbers for another program."""
    from polhode.files.writing import DASH, write_bytes

    if options.output is None or options.output == DASH:
        print(text)
    else:
        write_bytes(options.output, f"{text}\n".encode())


def show(report: Report, options: OutputOptions) -> None:
    """Write a report in the form that was asked for, or that the name of the file has."""
    from rich.console import Console

    from polhode.files.writing import DASH, write_bytes

    path = options.output if options.output != DASH else None
    by_name = "json" if path is not None and path.suffix.lower() == ".json" else "table"
    form = options.form or by_name
    if path is None:
        _write(report, form, Console(highlight=False))
    else:
        text = StringIO()
        _write(report, form, Console(file=text, highlight=False, color_system=None))
        write_bytes(path, text.getvalue().encode(errors="backslashreplace"))


def _write(report: Report, form: str, console: Console) -> None:
    if form == "json":
        print(report.as_json(), file=console.file)
    else:
        report.print(console)
