"""Text for a terminal: safe to show, and exactly as it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["printable", "write"]


def printable(text: str) -> str:
    """Escape control characters, so that text from a file is safe to show in a terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def write(console: Console, line: str = "", style: str = "") -> None:
    """Print one line as it is: no markup, no breaking to a guessed width."""
    from rich.text import Text

    console.print(Text(line, style=style), soft_wrap=True)
