"""Text for a terminal: safe to show, and exactly as it is."""

from __future__ import annotations

import re
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import Console

__all__ = ["in_options", "note", "printable", "write"]

_WAYS_OUT: Final = (
    ('closure="caps" or "hull"', "--closure caps or --closure hull"),
    ("pass orient=True", "pass --orient"),
    ("repair=True mends it", "--repair mends it"),
    ("repair closes and orients by itself", "--repair closes and orients by itself"),
    ("leave index_base out", "leave --index-base out"),
    ("leave length_unit out", "leave --length-unit out"),
    ("pass density= instead", "pass --density instead"),
    ("pass allow_outside=True", "pass --allow-outside"),
    (" (validity.nearest_valid finds the nearest tensor that a body has)", ""),
    ("move the body with translated()", "correct --center"),
    ("index_base=0", "--index-base 0"),
    ("pass overwrite=True", "pass --overwrite"),
    ("pass ignore= with its name", "pass --ignore with its name"),
    ("pass the edges as tree=", "pass the edges as --tree"),
    ("give the body a thickness, or nothing inside", "leave out --wheel"),
    ("integrate with simulate()", "integrate with RigidBody.simulate in Python"),
)
_NAMED: Final = re.compile(
    r"^(weld|closure|orient|union|repair|index_base|length_unit|mass|density|seed|chunk)(?=: )"
)
"""Of arguments that are options by the same names."""
_CLOSURE: Final = re.compile(r'\bclosure="(caps|hull)"(?=\)| takes)')
_WELD: Final = re.compile(r"\bweld=(?=\S+ joins)")
_RTOL: Final = (
    (re.compile(r"\bpass rtol=\S+ if the table was printed to few digits"), "give more digits"),
    (re.compile(r"\bpass rtol=\S+ to take them as equal"), "give equal moments"),
)


def in_options(message: str) -> str:
    """Replace the names of Python's arguments in a message by the options of the command line."""
    for argument, option in _WAYS_OUT:
        message = message.replace(argument, option)
    for pattern, option in _RTOL:
        message = pattern.sub(option, message)
    message = _NAMED.sub(lambda found: f"--{found[1].replace('_', '-')}", message)
    message = _CLOSURE.sub(r"--closure \1", message)
    return _WELD.sub("--weld ", message)


def printable(text: str) -> str:
    """Escape control characters, so that text from a file is safe to show in a terminal."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def note(notes: Iterable[str]) -> None:
    """Print notes on stderr, where the output is for another program."""
    if sys.stderr is None:
        return
    with suppress(OSError):  # nobody reads them
        for each in notes:
            print("polhode: note:", printable(in_options(each)), file=sys.stderr, flush=True)


def write(console: Console, line: str = "", style: str = "") -> None:
    """Print one line as it is: no markup, no breaking to a guessed width."""
    from rich.text import Text

    console.print(Text(line, style=style), soft_wrap=True)
