"""Tables of parts: a file of comma- or tab-separated text, columns by name, or rows, as columns of cells."""

from __future__ import annotations

import csv
import difflib
import io
import math
import os
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.errors import FileFormatError, PolhodeError
from polhode.files.reading import read_text

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Table", "read_table", "table_of_text"]

_ABSENT: Final = frozenset({"NA", "N/A", "<NA>"})
"""Cells that state nothing, as empty ones do: R writes NA, pandas <NA>."""
_TRUE: Final = frozenset({"true", "t", "yes", "1"})
_FALSE: Final = frozenset({"false", "f", "no", "0"})
_SIGMA: Final = "\u03c3_"
"""R massProps wrote its sigmas with this letter once."""


class Table:
    """Columns of cells, and what a row is called in errors.

    Parameters
    ----------
    name : str
        The file, or "" for arrays.
    columns : dict
        Cells by the name of their column, all of one length.
    lines : list of int, optional
        The line of the file at which each row begins.
    folder : pathlib.Path
        Where names of files in it start from.

    Attributes
    ----------
    uniform : set of str
        Columns for which a single value was given.
    """

    def __init__(
        self, name: str, columns: dict[str, Any], lines: list[int] | None = None, folder: Path = Path()
    ) -> None:
        self.name, self.columns, self.lines, self.folder = name, columns, lines, folder
        self.uniform: set[str] = set()
        self.count = len(next(iter(columns.values()))) if columns else 0

    def __contains__(self, column: str) -> bool:
        return column in self.columns

    def where(self, row: int) -> str:
        """Name a row."""
        place = f"row {row}" if self.lines is None else f"line {self.lines[row]}"
        return f"{self.name}: {place}" if self.name else place

    def words(self, column: str) -> list[str]:
        """Give a column of text; "" where nothing is stated, or the table has no such column."""
        if column not in self.columns:
            return [""] * self.count
        cells = self.columns[column]
        if isinstance(cells, np.ndarray):
            cells = cells.tolist()
        try:
            words = list(map(str.strip, cells))
        except TypeError:  # not all of them are text
            return [_word(cell) for cell in cells]
        return words if _ABSENT.isdisjoint(words) else ["" if word in _ABSENT else word for word in words]

    def numbers(self, column: str, *, percent: bool = False) -> NDArray[np.float64]:
        """Give a column of numbers, to be read only; NaN where nothing is stated.

        Parameters
        ----------
        column : str
        percent : bool, optional
            Whether 15% may stand for 0.15.
        """
        if column not in self.columns:
            return np.full(self.count, np.nan)
        cells = self.columns[column]
        if isinstance(cells, np.ndarray) and cells.dtype.kind in "fiu":
            numbers = cells.astype(np.float64, copy=False)
        else:
            numbers = self._parsed(column, cells, percent)
        infinite = np.flatnonzero(np.isinf(numbers))
        if len(infinite):
            row = int(infinite[0])
            raise PolhodeError(f"{self.where(row)}: {column} must be finite, got {numbers[row]}")
        return numbers

    def _parsed(self, column: str, cells: Any, percent: bool) -> NDArray[np.float64]:
        words = [cell if isinstance(cell, float) else _word(cell) for cell in cells]
        try:
            numbers = np.array([float("nan" if word == "" else word) for word in words])
            # "nan" as text is no number, unlike the float by which arrays say that nothing is known.
            row = next(
                (
                    row
                    for row in np.flatnonzero(np.isnan(numbers)).tolist()
                    if isinstance(words[row], str) and words[row]
                ),
                None,
            )
        except ValueError:
            if percent and any(str(word).endswith("%") for word in words):
                return self._parsed(column, [_of_percent(word) for word in words], False)
            row = next(row for row, word in enumerate(words) if not _is_number("nan" if word == "" else word))
        if row is not None:
            raise PolhodeError(
                f"{self.where(row)}: {column} is not a number: {str(words[row])[:40]!r}; write it as 0.25 or "
                "2.5e-1, without a unit, or leave the cell empty"
            )
        return numbers

    def truths(self, column: str) -> NDArray[np.bool_]:
        """Give a column of TRUE and FALSE; false where nothing is stated."""
        cells = self.columns.get(column, ())
        if isinstance(cells, np.ndarray) and cells.dtype.kind == "b":
            return cells.copy()
        truths = np.zeros(self.count, np.bool_)
        for row, word in enumerate(self.words(column) if column in self.columns else ()):
            if word.lower() in _TRUE:
                truths[row] = True
            elif word and word.lower() not in _FALSE:
                raise PolhodeError(f"{self.where(row)}: {column} is {word[:40]!r}; write TRUE or FALSE")
        return truths


def read_table(
    table: Any, known: Collection[str], *, ignore: Collection[str] = (), argument: str = "table"
) -> Table:
    """Read a table.

    Parameters
    ----------
    table : path, mapping or iterable of mappings
        A file, columns by name (a single value holds for all parts), or rows.
    known : collection of str
        The columns that it may have.
    ignore : collection of str
        Columns that are left out.
    argument : str
        What `table` is called in errors where it is no file.

    Raises
    ------
    PolhodeError
        If there is a column that is not known, or there are no rows.
    """
    if isinstance(table, str | os.PathLike):
        read = table_of_text(read_text(table, "a table"), str(table), Path(table).parent)
    elif isinstance(table, Table):
        read = table
    elif hasattr(table, "keys") and hasattr(table, "__getitem__"):
        read = _from_columns({str(name): table[name] for name in table.keys()}, argument)  # noqa: SIM118 (a data frame)
    elif isinstance(table, Iterable):
        read = _from_rows(list(table), argument)
    else:
        raise TypeError(f"{argument}: expected a path, columns by name or rows, got {type(table).__name__}")
    where = read.name or argument
    for name in [name for name in read.columns if name in ignore]:
        del read.columns[name]
    for name in [name for name in read.columns if name.startswith(_SIGMA)]:
        plain = f"sigma_{name.removeprefix(_SIGMA)}"
        if plain in read.columns:
            raise PolhodeError(f"{where}: column {plain!r} is there twice, once as {name!r}")
        read.columns[plain] = read.columns.pop(name)
    unknown = [name for name in read.columns if name not in known]
    if unknown:
        near = difflib.get_close_matches(unknown[0], known, n=1)
        hint = f"meant {near[0]!r}" if near else "words for the reader may stand in 'name' and 'comment'"
        raise PolhodeError(
            f"{where}: nobody knows the column {unknown[0][:40]!r}; {hint}; or pass ignore= with its name"
        )
    if not read.count:
        raise PolhodeError(f"{where}: there are no rows")
    return read


def table_of_text(text: str, file: str, folder: Path) -> Table:
    """Read a table from a text.

    Parameters
    ----------
    text : str
        Separated by commas, tabs or semicolons: by what the first line has most of.
    file : str
        What errors call it.
    folder : pathlib.Path
        Where names of files in it start from.

    Raises
    ------
    FileFormatError
        If it is no table.
    """
    text = text.removeprefix("\ufeff")
    head = text.partition("\n")[0]
    delimiter = max("\t,;", key=head.count)  # the first of those that are there most often
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    rows: list[list[str]] = []
    lines: list[int] = []
    line = 0
    try:
        for row in reader:
            if any(row):
                rows.append(row)
                lines.append(line + 1)
            line = reader.line_num
    except csv.Error as error:
        raise FileFormatError(f"{file}: line {reader.line_num}: not a table: {error}") from None
    if not rows:
        raise FileFormatError(f"{file}: the file is empty")
    names = [name.strip() for name in rows[0]]
    often = Counter(names)
    twice = next((name for name in names if often[name] > 1), None)
    if twice is not None:
        raise FileFormatError(f"{file}: line {lines[0]}: column {twice!r} is there twice")
    for row, line in zip(rows, lines, strict=True):
        if len(row) != len(names):
            raise FileFormatError(
                f"{file}: line {line}: {len(row)} cells, but {len(names)} columns; a cell with a separator "
                'in it stands in quotes: "1,2"'
            )
    cells = zip(*rows[1:], strict=True) if len(rows) > 1 else ([] for _ in names)
    return Table(file, dict(zip(names, map(list, cells), strict=True)), lines[1:], folder)


def _from_columns(columns: dict[str, Any], argument: str) -> Table:
    full = {name: _cells(cells, name, argument) for name, cells in columns.items()}
    lengths = {name: len(cells) for name, cells in full.items() if cells is not None}
    first = next(iter(lengths), "")
    other = next((name for name in lengths if lengths[name] != lengths[first]), None)
    if other is not None:
        raise PolhodeError(
            f"{argument}: column {first!r} has {lengths[first]} rows, but {other!r} has {lengths[other]}"
        )
    count = lengths.get(first, 1)
    table = Table(
        "", {name: [columns[name]] * count if cells is None else cells for name, cells in full.items()}
    )
    table.uniform = {name for name, cells in full.items() if cells is None}
    return table


def _cells(cells: Any, name: str, argument: str) -> Any:
    """Give the cells of a column as a list or an array of one axis; None for a single value."""
    if isinstance(cells, list | tuple):
        return list(cells)
    if isinstance(cells, str) or np.ndim(cells) == 0:
        return None
    array = np.asarray(cells)
    if array.ndim != 1:
        raise PolhodeError(f"{argument}: column {name!r} has shape {array.shape}; expected one cell a row")
    return array


def _from_rows(rows: list[Any], argument: str) -> Table:
    names: dict[str, None] = {}
    for number, row in enumerate(rows):
        if not isinstance(row, Mapping):
            raise TypeError(
                f"{argument}: row {number}: expected a mapping of columns to cells, got {type(row).__name__}"
            )
        names.update(dict.fromkeys(row))
    return Table("", {str(name): [row.get(name) for row in rows] for name in names})


def _word(cell: Any) -> str:
    if cell is None:
        return ""
    if isinstance(cell, float):
        if math.isnan(cell):
            return ""
        return str(int(cell)) if cell.is_integer() and abs(cell) < 1e15 else repr(float(cell))
    word = str(cell).strip()
    return "" if word in _ABSENT else word


def _is_number(word: str | float) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _of_percent(word: Any) -> Any:
    if isinstance(word, str) and word.endswith("%") and _is_number(word[:-1]):
        return float(word[:-1]) / 100.0
    return word
