"""Pictures as files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from polhode.files.writing import writing

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["save_picture"]

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
