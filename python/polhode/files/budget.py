"""One budget for every reader: how much may be made of a file, in counts and bytes.

A small file can ask for much: by parts placed again and again, by a long run of zeros packed into nothing,
by nested references. Each reader counts what it makes of a file, and ends with an error at a limit that
depends on the size of the file alone. So the answer is the same on every machine.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from polhode.errors import FileFormatError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["LIMITS", "Budget", "Limit", "LimitError"]


class Limit(NamedTuple):
    """How many of a kind may be made of a file, and the way out where that is not enough."""

    least: int
    per_byte: float
    way_out: str


LIMITS: Final[Mapping[str, Limit]] = {
    "unpacked bytes": Limit(1 << 24, 32.0, "unpack it, and pack it with less compression or not at all"),
    "elements": Limit(1_000_000, 0.125, "divide the file"),
    "tags": Limit(2_000_000, 1.0, "divide the file"),
    "atoms": Limit(1_000_000, 0.125, "divide the file"),
    "placements": Limit(50_000, 0.0625, "place fewer parts"),
    "triangles": Limit(1_000_000, 1.0, "place fewer parts, or coarser ones"),
    "points or cells": Limit(1_000_000, 1.0, "divide the file"),
    "numbers": Limit(10_000_000, 2.0, "let each part name an array of its own"),
    "words": Limit(10_000_000, 1.0, "divide the file"),
    "readings of files": Limit(2000, 0.002, "count says how often a part is there"),
    "bytes read": Limit(1 << 24, 32.0, "count says how often a part is there"),
    "files": Limit(1000, 0.0, "divide the model"),
    "included bytes": Limit(1 << 28, 0.0, "divide the model"),
    "links": Limit(50_000, 0.0, "divide the model"),
    "copies": Limit(10_000, 0.0, "lower the count"),
    "levels": Limit(5000, 0.0, "nest parts in fewer levels"),
    "shared errors": Limit(200_000, 20.0, "name fewer sources, or nest parts in fewer levels"),
    "elements in copies": Limit(50_000, 0.0, "lower the count"),
}
"""By kind: so many, and so many more for each byte of the file."""


class LimitError(FileFormatError):
    """A file that grows beyond a limit, which ends the reading as a whole."""


class Budget:
    """What may still be made of a file, and of those that it names.

    Parameters
    ----------
    name : str
        Of the file, for errors.
    size : int
        In bytes, as it lies on the disk.
    unit : str
        In what a table that is no file has its size.
    """

    def __init__(self, name: str, size: int, unit: str = "bytes of file") -> None:
        self.name, self._unit = name, unit
        self._size = size
        self._spent = dict.fromkeys(LIMITS, 0)
        self._files: set[str] = set()

    def add_file(self, size: int, name: str = "") -> None:
        """Count the bytes of another file that belongs to this one; of a file with a name once."""
        if not name or name not in self._files:
            self._size += size
            self._files.add(name)

    def most(self, kind: str) -> int:
        """Return how many of a kind may be made in all."""
        least, per_byte, _ = LIMITS[kind]
        return least + int(per_byte * self._size)

    def left(self, kind: str) -> int:
        """Return how many of a kind may still be made."""
        return self.most(kind) - self._spent[kind]

    def spend(self, kind: str, count: int = 1, where: str = "") -> None:
        """Count what is about to be made.

        Parameters
        ----------
        kind : str
            Of :data:`LIMITS`.
        count : int
            How many; negative where what was counted is not made after all.
        where : str
            What stands before the words of the error; the name of the file by default.

        Raises
        ------
        LimitError
            If there are too many.
        """
        self._spent[kind] += count
        if self._spent[kind] <= (most := self.most(kind)):
            return
        _, per_byte, way_out = LIMITS[kind]
        of = f", the most for {self._size} {self._unit}" if per_byte else ""
        raise LimitError(f"{where or self.name}: there are more than {most} {kind}{of}; {way_out}")
