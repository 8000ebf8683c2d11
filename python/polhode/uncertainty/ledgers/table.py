"""Tables of parts as trees: a file or rows, columns by name, and the levels of the tree."""

from __future__ import annotations

import csv
import difflib
import io
import math
import os
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from itertools import pairwise, repeat
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode._format import Argument
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import Budget, read_text

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

__all__ = [
    "Table",
    "Tree",
    "make_tree",
    "read_table",
    "table_of_text",
]

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
        """Return the name of a row for error messages."""
        place = f"row {row}" if self.lines is None else f"line {self.lines[row]}"
        return f"{self.name}: {place}" if self.name else place

    def words(self, column: str) -> list[str]:
        """Return a column of text; "" where nothing is stated, or the table has no such column."""
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
        """Return a column of numbers, to be read only; NaN where nothing is stated.

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
            numbers = self._parse_numbers(column, cells, percent)
        infinite = np.flatnonzero(np.isinf(numbers))
        if len(infinite):
            row = int(infinite[0])
            raise PolhodeError(f"{self.where(row)}: {column} must be finite, got {numbers[row]}")
        return numbers

    def _parse_numbers(self, column: str, cells: Any, percent: bool) -> NDArray[np.float64]:
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
                return self._parse_numbers(column, [_of_percent(word) for word in words], False)
            row = next(row for row, word in enumerate(words) if not _is_number("nan" if word == "" else word))
        if row is not None:
            raise PolhodeError(
                f"{self.where(row)}: {column} is not a number: {str(words[row])[:40]!r}; write it as 0.25 or "
                "2.5e-1, without a unit, or leave the cell empty"
            )
        return numbers

    def truths(self, column: str) -> NDArray[np.bool_]:
        """Return a column of TRUE and FALSE; false where nothing is stated."""
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
            f"{where}: nobody knows the column {unknown[0][:40]!r}; {hint}; or pass ",
            Argument("ignore"),
            " with its name",
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
    """Return the cells of a column as a list or an array of one axis; None for a single value."""
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


_SHOWN = 8
"""Ids of a circle that an error names."""


class Tree(NamedTuple):
    """The tree of parts: the parent of each.

    Rows are those of the table. Places count through the levels from the root down: within a level the
    children of one parent stand side by side, in the order of their parents.

    Attributes
    ----------
    ids : tuple of str
        By row.
    row_of : dict
        The row of each id.
    parent : numpy.ndarray
        The row of the parent, by row; -1 for the root.
    order : numpy.ndarray
        The row, by place.
    place : numpy.ndarray
        The place, by row.
    levels : tuple of slice
        The places of each level.
    above : numpy.ndarray
        The place of the parent, by place: it never descends. -1 for the root.
    is_leaf : numpy.ndarray of bool
        By place: whether nothing is below it.
    is_sorted : bool
        Whether places are rows: the table goes level by level.
    """

    ids: tuple[str, ...]
    row_of: dict[str, int]
    parent: Integers
    order: Integers
    place: Integers
    levels: tuple[slice, ...]
    above: Integers
    is_leaf: NDArray[np.bool_]
    is_sorted: bool

    def by_place(self, rows: Floats) -> Floats:
        """Put what stands by row, last axis, in the order of places; not copied where that is the same."""
        return rows if self.is_sorted else rows[..., self.order]

    def by_row(self, places: Floats) -> Floats:
        """Put what stands by place, last axis, in the order of rows; not copied where that is the same."""
        return places if self.is_sorted else places[..., self.place]

    def depth(self) -> Integers:
        """Return the level of each row: 0 for the root."""
        depth = np.empty_like(self.order)
        for level, places in enumerate(self.levels):
            depth[self.order[places]] = level
        return depth

    def below(self, row: int) -> NDArray[np.bool_]:
        """For each place: return whether it is the node of this row or below it."""
        inside: NDArray[np.bool_] = self.order == row
        for places in self.levels[1:]:
            inside[places] |= inside[self.above[places]]
        return inside

    def children(self, row: int) -> tuple[int, ...]:
        """Return the rows of the children, in the order of the table."""
        place = self.place[row]
        start, end = np.searchsorted(self.above, (place, place + 1))
        return tuple(self.order[start:end].tolist())


def make_tree(ids: Sequence[str], parents: Sequence[str], where: Callable[[int], str]) -> Tree:
    """Build the tree.

    Parameters
    ----------
    ids, parents : sequence of str
        The parent of the root is "".
    where : callable
        Names a row in errors.

    Raises
    ------
    PolhodeError
        If an id is missing or there twice, a parent has no row, there is no root or more than one, or a part
        is its own ancestor.
    """
    index = dict(zip(ids, range(len(ids)), strict=True))
    if "" in index:
        raise PolhodeError(f"{where(ids.index(''))}: id is empty; give each part its own")
    if len(index) < len(ids):
        _refuse_twice(ids, where)
    parent = np.fromiter(map(index.get, parents, repeat(-1)), np.intp, len(ids))
    roots = np.flatnonzero(parent < 0)
    orphan = next((row for row in roots.tolist() if parents[row]), None)
    if orphan is not None:
        raise PolhodeError(
            f"{where(orphan)}: an orphan: its parent {parents[orphan]!r} has no row; add one for it "
            "or correct the name"
        )
    if len(roots) > 1:
        one, two = (ids[row] for row in roots[:2].tolist())
        raise PolhodeError(
            f"{where(int(roots[1]))}: a second root: {one!r} and {two!r} have no parent"
            f"{f' ({len(roots)} roots in all)' if len(roots) > 2 else ''}; add a row for the whole and "
            "name it as their parent"
        )
    order, bounds = _by_levels(parent)
    if len(order) < len(ids):
        _refuse_circle(ids, parent, order, where)
    Budget("", 0).spend("levels", len(bounds) - 1, where(int(order[-1])))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    above = np.where(parent[order] < 0, -1, place[parent[order]])
    is_leaf = np.ones(len(order), np.bool_)
    is_leaf[above[1:]] = False
    levels = tuple(slice(start, end) for start, end in pairwise(bounds))
    return Tree(
        tuple(ids), index, parent, order, place, levels, above, is_leaf, bool(np.all(place[:-1] < place[1:]))
    )


def _by_levels(parent: Integers) -> tuple[Integers, list[int]]:
    """Return the rows that are reached from the root, level by level, and where each level begins."""
    by_parent = np.argsort(parent, kind="stable")
    count = np.bincount(parent + 1, minlength=len(parent) + 1)
    first = np.cumsum(count) - count
    count, first = count[1:], first[1:]
    order, bounds = [by_parent[: int(np.sum(parent < 0))]], [0]
    while len(order[-1]):
        bounds.append(bounds[-1] + len(order[-1]))
        counts = count[order[-1]]
        # The children of each node are a range of `by_parent`: all those ranges one after another.
        steps = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        order.append(by_parent[np.repeat(first[order[-1]], counts) + steps])
    return np.concatenate(order), bounds


def _refuse_twice(ids: Sequence[str], where: Callable[[int], str]) -> None:
    seen: dict[str, int] = {}
    for row, name in enumerate(ids):
        if name in seen:
            raise PolhodeError(
                f"{where(row)}: id {name!r} is there twice, first at {where(seen[name])}; give each part "
                "its own"
            )
        seen[name] = row


def _refuse_circle(
    ids: Sequence[str], parent: Integers, reached: Integers, where: Callable[[int], str]
) -> None:
    outside = np.ones(len(ids), np.bool_)
    outside[reached] = False
    row = int(np.flatnonzero(outside)[0])
    met: dict[int, int] = {}
    walk: list[int] = []
    while row not in met:
        met[row] = len(walk)
        walk.append(row)
        row = int(parent[row])
    circle = walk[met[row] :]
    names = [repr(ids[row]) for row in circle[:_SHOWN]] + (["..."] if len(circle) > _SHOWN else [])
    raise PolhodeError(
        f"{where(circle[0])}: a cycle: {' in '.join([*names, names[0]])}; a part cannot be its own ancestor: "
        "correct one of the parents"
    )
