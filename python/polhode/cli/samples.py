"""``polhode samples``: the files that ship with the package, listed or put into a folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

from polhode import samples
from polhode.cli.terminal import write

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console

__all__ = ["run"]


def run(folder: Path | None, console: Console) -> None:
    """List the files; put them into a folder where one is named."""
    if folder is not None:
        samples.copy(folder)
    longest = max(map(len, samples.names()))
    for name in samples.names():
        write(console, f"  {name:<{longest}}  {samples.about(name)}")
    write(console)
    write(
        console,
        "  polhode samples FOLDER writes them into a folder" if folder is None else f"  now in {folder}",
    )
