"""How numbers, results and messages print: sigmas, limits, one-line reprs, and messages of pieces."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from typing import Self

__all__ = [
    "Argument",
    "Note",
    "at_least",
    "at_most",
    "in_words",
    "one_line",
    "short",
    "with_sigma",
]

_FEW: Final = 12
_REPR_DIGITS: Final = 8


def short(result: Any) -> str:
    """Write a named tuple: its ``__repr__``."""
    return one_line(result, result._asdict())


def one_line(result: object, fields: Mapping[str, Any]) -> str:
    """Write the name of a class and its fields."""
    parts = ", ".join(f"{name}={_text(value)}" for name, value in fields.items())
    return f"{type(result).__name__}({parts})"


def _text(value: Any) -> str:
    import numpy as np  # only here: the help of the command line needs no NumPy

    if isinstance(value, np.ndarray | np.generic):
        if value.size > _FEW:
            return f"<shape {value.shape}>"
        value = value.tolist()
    return repr(_round_for_repr(value))


def _round_for_repr(value: Any) -> Any:
    if isinstance(value, list):
        return [_round_for_repr(item) for item in value]
    # Adding zero makes a plain zero of a negative one.
    return float(f"{value:.{_REPR_DIGITS}g}") + 0.0 if isinstance(value, float) else value


_DIGITS = 7
_ROUNDING = 1e-15
"""A sigma below this fraction of the value is zero with rounding errors."""
_LARGE = 1e7
_SMALL = 1e-4


def with_sigma(value: float, sigma: float | None) -> str:
    """Write a number and its standard deviation: ``57.8 ± 1.2``.

    Parameters
    ----------
    value : float
    sigma : float or None
        Without one, or where it is zero, the number stands alone with seven digits.

    Examples
    --------
    >>> with_sigma(57.834, 1.2416)
    '57.8 ± 1.2'
    >>> with_sigma(42673.7, 2789.3)
    '42700 ± 2800'
    >>> with_sigma(-3.2e-9, 4.56e-11)
    '(-3.200 ± 0.046)e-09'
    """
    if not sigma or not math.isfinite(sigma) or not math.isfinite(value) or sigma < _ROUNDING * abs(value):
        return f"{value + 0.0:.{_DIGITS}g}"
    # The place of the last digit, after rounding: 0.0996 has the digits 10 of 0.100.
    last = int(f"{sigma:.1e}".partition("e")[2]) - 1
    largest = max(abs(value), sigma)
    if _SMALL <= largest < _LARGE:
        return f"{_round_to_place(value, last)} ± {_round_to_place(sigma, last)}"
    exponent = math.floor(math.log10(largest))
    scale = 10.0**exponent if abs(exponent) < 300 else 1.0
    if scale == 1.0:
        return f"{value:.3g} ± {sigma:.1e}"
    one, other = (_round_to_place(number / scale, last - exponent) for number in (value, sigma))
    return f"({one} ± {other})e{exponent:+03d}"


def _round_to_place(value: float, last: int) -> str:
    return f"{round(value, -last) + 0.0:.{max(-last, 0)}f}"


def at_least(number: float, digits: int = 3) -> str:
    """Write a positive number with so many digits, rounded up: for values that are stated as sufficient.

    Examples
    --------
    >>> at_least(0.12345)
    '0.124'
    """
    text = f"{number:.{digits}g}"
    if float(text) < number:
        unit = 10.0 ** (math.floor(math.log10(number)) - digits + 1)
        text = f"{number + unit:.{digits}g}"
    return text


def at_most(number: float, digits: int = 3) -> str:
    """Write a positive number with so many digits, rounded down: for values that are stated as allowed.

    Examples
    --------
    >>> at_most(0.12367)
    '0.123'
    """
    text = f"{number:.{digits}g}"
    if float(text) > number:
        unit = 10.0 ** (math.floor(math.log10(number)) - digits + 1)
        text = f"{number - unit:.{digits}g}"
    return text


class Argument(NamedTuple):
    """An argument in a message: the command line and the files of assemblies write it in their own way.

    Attributes
    ----------
    name : str
    value : object
        The value to pass, or a tuple to choose from; None names the argument alone.
    """

    name: str
    value: object = None

    def __str__(self) -> str:
        if self.value is None:
            return self.name
        values = [f'"{value}"' if isinstance(value, str) else str(value) for value in self.values]
        return f"{self.name}={' or '.join(values)}"

    @property
    def values(self) -> tuple[object, ...]:
        """The values to choose from."""
        return self.value if isinstance(self.value, tuple) else (self.value,)


class Note(str):
    """A remark: words for who reads it, and as data what it tells.

    Parameters
    ----------
    *pieces
        Texts, objects of :class:`Argument`, and other notes.
    kind : str
        What was found, for who gathers such notes.
    subject : str
        Of what it was found.
    """

    pieces: tuple[object, ...]
    kind: str
    subject: str

    def __new__(cls, *pieces: object, kind: str = "", subject: str = "") -> Self:
        """Join the pieces."""
        note = super().__new__(cls, in_words(pieces))
        note.pieces, note.kind, note.subject = pieces, kind, subject
        return note

    @classmethod
    def after(cls, prefix: str, note: str) -> Self:
        """Return a note, or one of words alone, with a prefix."""
        if isinstance(note, Note):
            return cls(prefix, note, kind=note.kind, subject=note.subject)
        return cls(prefix, note)


def in_words(pieces: Iterable[object], name: Callable[[Argument], str] = str) -> str:
    """Join the pieces of a message, its arguments as `name` writes them."""
    words = []
    for piece in pieces:
        if isinstance(piece, Note):
            words.append(in_words(piece.pieces, name))
        else:
            words.append(name(piece) if isinstance(piece, Argument) else str(piece))
    return "".join(words)
