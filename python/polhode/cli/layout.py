"""Reports as data: shown as a table, as JSON or as lines, saved, or compared with an earlier one."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from difflib import get_close_matches
from io import StringIO
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._format import with_sigma
from polhode.cli.terminal import printable, write
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.budget import read_text

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray
    from rich.console import Console

    from polhode.cli.options import FindingsOptions, OutputOptions, ReportOptions

__all__ = [
    "NOT_LINEAR",
    "ROUNDING",
    "Cell",
    "Column",
    "Field",
    "Report",
    "Table",
    "form_of",
    "held_against",
    "held_and_shown",
    "number",
    "show",
    "show_lines",
]

DIGITS: Final = 7
LABEL_WIDTH: Final = 20
CELL_WIDTH: Final = 14
ROUNDING: Final = 1e-15
"""Of the size of what numbers are components of: less is printed as 0 in tables."""
NOT_LINEAR: Final = "*"
"""Behind a number for which the first order is not enough."""


@dataclass(frozen=True)
class Field:
    """One quantity of a report.

    Attributes
    ----------
    key : str
        Its name in JSON; a dot makes an object: ``"in_file_unit.volume"``.
    label : str
        Its name in the table; "" continues the field above.
    value : str, int, float, array_like or None
        Text, a number, three numbers or a 3 x 3 matrix; None where there is a sigma alone.
    unit : str
        "" for a pure number or text.
    hint : str
        What the table says after the unit.
    decimals : int, optional
        Decimals in the table; by default 7 significant digits.
    scale : float, optional
        Size of what the numbers are components of: those below 1e-15 of it are rounding, and the table
        (not the JSON) prints them as 0.
    sigma : float or array_like, optional
        Standard deviations, of the shape of `value`; in JSON under the same key in the object "sigma".
    linear : bool or array_like of bool, optional
        Whether the first order is enough for them; in JSON under the same key in the object "linear", and
        marked in the table where it is not.
    cells : sequence of str, optional
        What the table shows in one row instead of the numbers.
    """

    key: str
    label: str
    value: str | float | ArrayLike | None
    unit: str = ""
    hint: str = ""
    decimals: int | None = None
    scale: float = 0.0
    sigma: ArrayLike | None = None
    linear: ArrayLike | None = None
    cells: Sequence[str] | None = None


@dataclass(frozen=True)
class Column:
    """One column of a table: the key of its values in JSON, its heading and its unit.

    `shown` is the unit of the cells in the table where it is another one than that of the JSON.
    """

    key: str
    heading: str
    unit: str = ""
    decimals: int | None = None
    shown: str = ""


@dataclass(frozen=True)
class Table:
    """Several things of one kind, a row each.

    Attributes
    ----------
    key : str
        Its name in JSON, where it is a list of objects.
    columns : sequence of Column
        The last one may be long.
    rows : sequence of mapping
        Values by the keys of the columns: text, numbers, lists of numbers; absent or None where there is
        none. Other keys are for JSON alone.
    most : int, optional
        So many rows are shown to people, and the rest counted; JSON has them all.
    """

    key: str
    columns: Sequence[Column]
    rows: Sequence[Mapping[str, Any]]
    most: int | None = None


@dataclass(frozen=True)
class Cell:
    """What a table shows and what stands in JSON for it, where the two differ."""

    text: str
    value: Any


@dataclass
class Report:
    """Titled sections of fields, tables, and notes that belong to no single field."""

    sections: list[tuple[str, list[Field | Table]]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def section(self, title: str, *fields: Field | Table) -> None:
        """Add a section; one without a title continues the section above."""
        self.sections.append((title, list(fields)))

    def as_dict(self) -> dict[str, Any]:
        """Return every field by its key, ``"units"`` of those that have one, and ``"notes"``.

        Where numbers have sigmas these stand in ``"sigma"`` by the same keys, and in ``"linear"`` whether the
        first order is enough for them.
        """
        values: dict[str, Any] = {}
        units: dict[str, Any] = {}
        sigmas: dict[str, Any] = {}
        linear: dict[str, Any] = {}
        for _, fields in self.sections:
            for item in fields:
                if isinstance(item, Table):
                    _set_nested(
                        values, item.key, [{k: _plain(v) for k, v in row.items()} for row in item.rows]
                    )
                    for column in item.columns:
                        if column.unit:
                            _set_nested(units, f"{item.key}.{column.key}", column.unit)
                    continue
                if item.value is not None:
                    _set_nested(values, item.key, _plain(item.value))
                if item.sigma is not None:
                    _set_nested(sigmas, item.key, _plain(item.sigma))
                if item.linear is not None:
                    _set_nested(linear, item.key, _plain(item.linear))
                if item.unit:
                    _set_nested(units, item.key if item.value is not None else f"sigma.{item.key}", item.unit)
        of_sigmas = {"sigma": sigmas, "linear": linear} if sigmas else {}
        return {**values, **of_sigmas, "units": units, "notes": list(self.notes)}

    def as_json(self) -> str:
        """Write the same as text; infinity is the string "Infinity", not-a-number is null."""
        return json.dumps(self.as_dict(), indent=2, allow_nan=False)

    def print(self, console: Console) -> None:
        """Print the table."""
        for title, fields in self.sections:
            if title:
                write(console)
                write(console, title, style="bold cyan")
            for item in fields:
                for line in _table_lines(item) if isinstance(item, Table) else _lines(item):
                    write(console, line)
        if self.notes:
            write(console)
        for note in self.notes:
            write(console, f"  note: {printable(note)}", style="yellow")


def number(value: float, decimals: int | None = None) -> str:
    """Write a number for people: 7 significant digits, or a fixed number of decimals."""
    if not math.isfinite(value):
        return "undefined" if math.isnan(value) else "infinite" if value > 0 else "-infinite"
    value += 0.0  # no negative zero
    return f"{value:.{DIGITS}g}" if decimals is None else f"{value:.{decimals}f}"


def _lines(item: Field) -> Iterator[str]:
    label = f"  {item.label}".ljust(LABEL_WIDTH)
    if isinstance(item.value, str):
        yield f"{label}  {printable(item.value)}  {item.hint}".rstrip()
        return
    unit = "".join(f"  {text}" for text in (item.unit, item.hint) if text)
    rows = list(_rows(item))
    width = CELL_WIDTH
    if item.sigma is not None or item.cells is not None:
        width = max(width, *(len(cell) + 2 for row in rows for cell in row))
    for row in rows:
        cells = "".join(cell.rjust(width) for cell in row)
        yield f"{label}{cells}{' ' * max(0, CELL_WIDTH * 3 - width * len(row))}{unit}".rstrip()
        label, unit = " " * LABEL_WIDTH, ""


def _table_lines(table: Table) -> Iterator[str]:
    headings = [f"{c.heading}, {c.shown or c.unit}" if c.unit else c.heading for c in table.columns]
    texts = [[_cell(row.get(c.key), c.decimals) for c in table.columns] for row in table.rows[: table.most]]
    widths = [max(len(line[i]) for line in [headings, *texts]) for i in range(len(headings))]
    for line in [headings, *texts]:
        yield "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
    left = len(table.rows) - len(texts)
    if left:
        yield f"  and {left} more; --all shows them, --depth fewer levels"


def _cell(value: Any, decimals: int | None) -> str:
    if value is None:
        return "-"
    if isinstance(value, Cell):
        return printable(value.text)
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, int):
        return str(value)
    short = np.asarray(value, dtype=np.float64).reshape(-1)
    return " ".join(f"{x + 0.0:.4g}" if decimals is None else number(x, decimals) for x in short.tolist())


def _rows(item: Field) -> Iterator[list[str]]:
    if item.cells is not None:
        yield list(item.cells)
        return
    array: NDArray[Any] = np.asarray(item.value)
    matrix = array.reshape((-1, array.shape[-1]) if array.ndim else (1, 1))
    if np.issubdtype(matrix.dtype, np.integer):
        yield from ([str(x) for x in row] for row in matrix)
        return
    matrix = np.where(np.abs(matrix) < ROUNDING * item.scale, 0.0, matrix)
    if item.sigma is not None:
        yield from _rows_with_sigma(item, matrix)
        return
    yield from ([number(float(x), item.decimals) for x in row] for row in matrix)


def _rows_with_sigma(item: Field, matrix: NDArray[Any]) -> Iterator[list[str]]:
    """Return the numbers beside their sigmas; those for which the first order is not enough are marked."""
    sigmas = np.asarray(item.sigma, dtype=np.float64).reshape(matrix.shape)
    linear = np.broadcast_to(np.asarray(True if item.linear is None else item.linear).ravel(), matrix.size)
    for row, deviations, flags in zip(matrix, sigmas, linear.reshape(matrix.shape), strict=True):
        cells = []
        for x, sigma, is_linear in zip(row.tolist(), deviations.tolist(), flags.tolist(), strict=True):
            is_exact = not sigma > ROUNDING * max(abs(x), item.scale)
            text = number(x, item.decimals) if is_exact else with_sigma(x, sigma)
            cells.append(text if is_linear else f"{text}{NOT_LINEAR}")
        yield cells


def _plain(value: object) -> Any:
    if value is None or isinstance(value, str | bool):
        return value
    if isinstance(value, Cell):
        return _plain(value.value)
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return _finite(np.asarray(value).tolist())


def _finite(value: Any) -> Any:
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value


def _set_nested(target: dict[str, Any], key: str, value: object) -> None:
    *path, last = key.split(".")
    for name in path:
        target = target.setdefault(name, {})
    target[last] = value


def held_and_shown(
    told: Report, extra: ReportOptions, output: OutputOptions, saved: Iterable[str] = ()
) -> bool:
    """Hold a report against what was expected, save what is to be saved, and show it.

    Returns
    -------
    bool
        Whether it agrees.
    """
    agrees = True
    if extra.expect is not None:
        agrees = not held_against(told, extra.expect, extra.rtol)
    told.notes += saved
    show(told, output)
    return agrees


def form_of(options: OutputOptions | FindingsOptions, by_name: Collection[str] = ("json",)) -> str:
    """Return the form that was asked for, or that the name of the file has."""
    path = options.output
    suffix = path.suffix.lower().removeprefix(".") if path is not None else ""
    return options.form or (suffix if suffix in by_name else "table")


def show_lines(text: str, options: OutputOptions | FindingsOptions) -> None:
    """Write lines as they are, such as numbers for another program."""
    from polhode.io.writing import DASH, write_bytes

    if options.output is None or options.output == DASH:
        print(text)
    else:
        write_bytes(options.output, f"{text}\n".encode())


def show(report: Report, options: OutputOptions | FindingsOptions) -> None:
    """Write a report in the form that was asked for, or that the name of the file has."""
    from rich.console import Console

    from polhode.io.writing import DASH, write_bytes

    path = options.output if options.output != DASH else None
    form = form_of(options)
    if path is None:
        _write(report, form, Console(highlight=False))
    else:
        text = StringIO()
        _write(report, form, Console(file=text, highlight=False, color_system=None))
        write_bytes(path, text.getvalue().encode(errors="backslashreplace"))


def _write(report: Report, form: str, console: Console) -> None:
    if form == "json":
        print(report.as_json(), file=console.file)
    else:
        report.print(console)


# What says how the numbers came about, or follows from them but wavers where two moments are nearly equal.
_NOT_COMPARED: Final = frozenset(
    {"axes", "comment", "error_bound", "expected", "file", "format", "gaps", "notes", "provenance", "units"}
    | {"linear", "sigma"}
)
_SAME_DIFFERENCE: Final = 1e-9
"""Of the largest difference of a field: smaller ones are rounding, and so are their sigmas."""


def held_against(report: Report, expected: Path, rtol: float) -> list[dict[str, Any]]:
    """Compare the numbers of a report with those of a file, and add what was found to the report.

    Parameters
    ----------
    report : Report
        Gets a section on it.
    expected : pathlib.Path
        JSON with the keys of the report, all or some of them.
    rtol : float
        Relative to the largest component; a centre of mass also to the largest radius of gyration.

    Returns
    -------
    list of dict
        What differs, a row each.
    """
    if not (math.isfinite(rtol) and rtol >= 0.0):
        raise PolhodeError(f"--rtol: {rtol:g} is not a tolerance; give a number such as 1e-6")
    known = _read_expected(expected)
    ours = report.as_dict()
    known_units, our_units = dict(_leaves(known.get("units", {}))), dict(_leaves(ours["units"]))
    length = max(ours["radii_of_gyration"])
    found, compared = [], 0
    flat = dict(_leaves(ours))
    our_sigmas, known_sigmas = (dict(_leaves(_object(one, "sigma"))) for one in (ours, known))
    for key, value in _leaves(known):
        if key.partition(".")[0] in _NOT_COMPARED:
            continue
        if key not in flat:
            near = get_close_matches(key, flat, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else "; take fields of --format json"
            raise PolhodeError(f"--expect: {expected}: the report has no field {key[:60]!r}{hint}")
        unit = our_units.get(key, "")
        if known_units.get(key, unit) != unit:
            raise PolhodeError(
                f"--expect: {expected}: {key} is in {known_units[key]!r}, the report's in {unit!r}; "
                "use the same --length-unit"
            )
        compared += 1
        difference = _difference(flat[key], value, length if key == "center_of_mass" else 0.0)
        if not difference <= rtol:
            row = {"field": key, "found": flat[key], "expected": _as_text(value), "difference": difference}
            found.append(row | _beside_sigma(flat[key], value, our_sigmas.get(key), known_sigmas.get(key)))
    if not compared:
        raise PolhodeError(f"--expect: {expected} holds no field of the report; save one with --format json")
    columns = [
        Column("field", "field"),
        Column("found", "found"),
        Column("expected", "expected"),
        Column("difference", "relative difference"),
    ]
    if any("in_sigmas" in row for row in found):
        columns.append(Column("in_sigmas", "difference ± its sigma"))
        report.notes.append(
            "the sigma of a difference takes the two reports as independent, since a saved report does not "
            "hold the sources that they share; RigidBody.covariance_with takes them into account in Python"
        )
    if found:
        report.section("differs from what was expected", Table("differences", columns, found))
    verdict = f"{len(found)} of {compared} fields differ" if found else f"{compared} fields agree"
    report.notes.append(f"{verdict} with {expected} within {rtol:g}")
    return found


def _object(document: dict[str, Any], key: str) -> dict[str, Any]:
    value = document.get(key, {})
    return value if isinstance(value, dict) else {}


def _beside_sigma(ours: Any, theirs: Any, sigma: Any, other: Any) -> dict[str, Any]:
    """Return component that differs by the most of its sigmas, where one of the two reports has sigmas."""
    if sigma is None and other is None:
        return {}
    try:
        difference = np.atleast_1d(np.asarray(ours, float) - np.asarray(theirs, float))
        zero = np.zeros_like(difference)
        deviations = [zero if one is None else np.asarray(one, float) for one in (sigma, other)]
        joint = np.broadcast_to(np.hypot(*deviations), difference.shape)
    except (TypeError, ValueError, OverflowError):
        return {}
    sizes = np.abs(difference)
    sizes[sizes < _SAME_DIFFERENCE * sizes.max(initial=0.0)] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        worst = int(np.argmax(np.nan_to_num(sizes / joint).ravel()))
    d, s = float(difference.flat[worst]), float(joint.flat[worst])
    return {"in_sigmas": Cell(with_sigma(d, s), {"difference": d, "sigma": s})}


def _read_expected(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(read_text(path, "JSON"))
    except FileFormatError as error:
        raise FileFormatError(f"--expect: {error}; save one with --format json") from None
    except (ValueError, RecursionError) as error:
        message = f"--expect: {path} is not JSON ({error}); save one with --format json"
        raise FileFormatError(message) from None
    if not isinstance(document, dict) or not isinstance(document.get("units", {}), dict):
        raise FileFormatError(f"--expect: {path} holds no object of fields; save one with --format json")
    try:
        list(_leaves(document))
    except RecursionError:
        raise FileFormatError(
            f"--expect: {path}: its fields are nested beyond reason; save one with --format json"
        ) from None
    return document


def _leaves(value: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, item in value.items():
        if isinstance(item, dict):
            yield from _leaves(item, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", item


def _as_text(value: Any) -> Any:
    """Return what was expected as it is, or as text where it is no array."""
    try:
        np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return value if isinstance(value, str) else json.dumps(value)[:60]
    return value


def _difference(ours: Any, theirs: Any, size: float) -> float:
    """Compute the largest difference, relative to the largest component; infinite between different kinds."""
    if isinstance(ours, str) or isinstance(theirs, str) or ours is None or theirs is None:
        return 0.0 if ours == theirs else math.inf
    try:
        a, b = np.asarray(ours, dtype=np.float64), np.asarray(theirs, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return 0.0 if ours == theirs else math.inf
    if a.shape != b.shape:
        return math.inf
    largest = max(float(np.abs(b).max(initial=0.0)), size)
    difference = float(np.abs(a - b).max(initial=0.0))
    return difference / largest if largest > 0.0 else (0.0 if difference == 0.0 else math.inf)
