"""Keys of the tables of an assembly's file: what each may hold, and the nearest known one for a wrong one."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING, Any, Final

from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

__all__ = [
    "COMMON",
    "FILE",
    "KINDS",
    "PRINTED",
    "REPEATED",
    "TOP",
    "check_keys",
    "meant",
    "text_of",
    "unknown",
]

TOP: Final = ("name", "comment", "length_unit", "part")
KINDS: Final = ("solid", "file", "assembly", "inertia")
"""One of them says what a part is."""
REPEATED: Final = ("count", "step", "turn")
COMMON: Final = ("name", "comment", *KINDS, "length_unit", "position", "rotation", *REPEATED)
FILE: Final = ("mass", "density", "weld", "closure", "orient", "union", "repair", "index_base")
_MOST_NAMES: Final = 30
PRINTED: Final = ("mass", "com", "tensor", "products", "about", "rtol")
"""Of `inertia`, as CAD programs print it."""


def check_keys(table: Mapping[str, Any], known: Collection[str], where: str) -> None:
    """Refuse a key that is not known, with the nearest one that is."""
    for key in table:
        if key not in known:
            raise PolhodeError(f"{where}: {unknown(str(key), known)}")


def unknown(key: str, known: Collection[str]) -> str:
    """Say that a key is not known, and which are."""
    return f"{key[:40]!r} is not a known key; {meant(key, known)}"


def meant(name: str, known: Collection[str]) -> str:
    """Ask for the nearest of the names that there are, or tell them."""
    near = difflib.get_close_matches(name, known, n=1)
    names = [*known][:_MOST_NAMES]
    more = f" and {len(known) - len(names)} more" if len(known) > len(names) else ""
    return f"is {near[0]!r} meant?" if near else f"give one of {', '.join(names)}{more}"


def text_of(table: Mapping[str, Any], key: str, where: str) -> str:
    """Give a text; "" where it is absent."""
    value = table.get(key, "")
    if not isinstance(value, str) or not value.isprintable():
        raise PolhodeError(
            f"{where}: {key}: {repr(value)[:60]} is not a line of text; write one between quotes"
        )
    return value
