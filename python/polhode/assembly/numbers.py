"""Numbers of an assembly's file: bare ones in the unit of their table, others with a unit of their own."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from polhode._quantities import amount, has_unit, quantity, split
from polhode.errors import PolhodeError
from polhode.units import metres_per

if TYPE_CHECKING:
    from polhode import _core

__all__ = ["Scope"]

_SHOWN: Final = 60
_LONGEST: Final = 10_000


@dataclass(frozen=True)
class Scope:
    """One table of the file: what it is called in errors, and the unit of its bare lengths.

    Attributes
    ----------
    where : str
    length_unit : str or None
        None where nothing states it: metres are taken, but for files, which have to state theirs.
    """

    where: str
    length_unit: str | None = None

    @property
    def metres(self) -> float:
        """Metres in one unit of length."""
        return metres_per(self.length_unit or "m")

    def within(self, name: str, length_unit: Any) -> Scope:
        """Give the scope of a table inside this one."""
        where = f"{self.where}: {name}" if self.where else name
        if length_unit is None:
            return Scope(where, self.length_unit)
        if not isinstance(length_unit, str):
            raise PolhodeError(
                f"{where}: length_unit: {_shown(length_unit)} is not the name of a unit; write one, as 'mm'"
            )
        try:
            metres_per(length_unit)
        except PolhodeError as error:
            raise PolhodeError(f"{where}: {error}") from None
        return Scope(where, length_unit)

    def lengths(self, key: str, value: Any, count: int | None = None) -> Any:
        """Read a length, a row of them (of `count`) or rows of rows, in metres."""
        if count is None and isinstance(value, list | tuple) and value and isinstance(value[0], list | tuple):
            return [self.lengths(key, row) for row in value]
        return self.numbers(key, value, "m", self.metres, count)

    def numbers(self, key: str, value: Any, unit: str, bare: float = 1.0, count: int | None = None) -> Any:
        """Read one number, or a row of them where it is a row or `count` says so.

        Parameters
        ----------
        key : str
            Named in what goes wrong.
        value : object
            A number, a text with a unit, an array of either, or one text of several numbers.
        unit : str
            What is returned.
        bare : float
            A number without a unit, in `unit`.
        count : int, optional
            How many there have to be.
        """
        option = self._option(key, value)
        if isinstance(value, list | tuple):
            found = [self._number(option, item, unit, bare) for item in value]
        elif isinstance(value, str) and (count or "," in value or len(value.split()) > 1):
            parts = split((value,), count, unit, option)
            found = [self._number(option, part, unit, bare) for part in parts]
            if count is None and len(found) == 1:
                return found[0]
        else:
            found = [self._number(option, value, unit, bare)]
            if count is None:
                return found[0]
        if count is not None and len(found) != count:
            raise PolhodeError(f"{option}: expected {count} numbers, got {len(found)} in {_shown(value)}")
        return found

    def amount(self, key: str, value: Any, unit: str) -> float | _core.Uncertain:
        """Read a mass or a density, which may have a sigma."""
        option = self._option(key, value)
        if isinstance(value, str):
            return amount(value, unit, option)
        return self._number(option, value, unit, 1.0)

    def _option(self, key: str, value: Any) -> str:
        option = f"{self.where}: {key}" if self.where else key
        if isinstance(value, str) and len(value) > _LONGEST:
            raise PolhodeError(f"{option}: {_shown(value)} has more than {_LONGEST} letters; write a number")
        return option

    def _number(self, option: str, value: Any, unit: str, bare: float) -> float:
        if isinstance(value, str):
            return quantity(value, unit, option) * (1.0 if has_unit(value) else bare)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise PolhodeError(f"{option}: {_shown(value)} is not a number; write one, as in 2.5")
        try:
            number = float(value) * bare
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise PolhodeError(f"{option}: {_shown(value)} is not finite; write one that is")
        return number


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."
