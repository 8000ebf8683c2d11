"""How results print: on one line, small arrays as lists of rounded numbers, large ones by their shape."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["one_line", "short"]

_SMALL: Final = 12
_DIGITS: Final = 8


def short(result: Any) -> str:
    """Write a named tuple: its ``__repr__``."""
    return one_line(result, result._asdict())


def one_line(result: object, fields: Mapping[str, Any]) -> str:
    """Write the name of a class and its fields."""
    parts = ", ".join(f"{name}={_text(value)}" for name, value in fields.items())
    return f"{type(result).__name__}({parts})"


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray | np.generic):
        if value.size > _SMALL:
            return f"<shape {value.shape}>"
        value = value.tolist()
    return repr(_rounded(value))


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    # Adding zero makes a plain zero of a negative one.
    return float(f"{value:.{_DIGITS}g}") + 0.0 if isinstance(value, float) else value
