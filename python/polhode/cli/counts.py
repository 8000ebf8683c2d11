"""Whole numbers as options take them: cyclopts by itself rounds what has a point."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from cyclopts import Parameter

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Count"]


def _count(_: Any, tokens: Sequence[Any]) -> int:
    """Read the digits, or refuse what is no whole number."""
    text = tokens[0].value.strip()
    if not re.fullmatch(r"[+-]?[0-9]+", text):
        raise ValueError(f"expected a whole number, got {text!r}")
    return int(text)


Count: TypeAlias = Annotated[int, Parameter(converter=_count)]
