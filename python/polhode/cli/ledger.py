"""``polhode ledger``: a tree of parts rolled up, each number with its sigma."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode._format import with_sigma
from polhode._optional import require
from polhode.assembly.tables import suggest_name
from polhode.cli.files import STDIN, check_depth, check_suffixes, label
from polhode.cli.layout import ROUNDING, Cell, Column, Field, Report, Table
from polhode.errors import FileFormatError, PolhodeError
from polhode.io.writing import save_picture
from polhode.uncertainty.ledgers import ledger
from polhode.uncertainty.ledgers.rollup import NUMBERS
from polhode.uncertainty.ledgers.table import table_of_text

if TYPE_CHECKING:
    from polhode.cli.options import LedgerOptions
    from polhode.uncertainty.ledgers import Ledger, Part, Shares

__all__ = ["ledger_report", "node_row", "save_ledger", "tensor_row"]

_CONTRIBUTORS: Final = 10
_SAVED: Final = (".png", ".pdf", ".svg", ".csv")


def ledger_report(file: Path, options: LedgerOptions) -> tuple[Report, Ledger]:
    """Report on the ledger in a file; give the ledger too."""
    if options.of not in NUMBERS:
        raise PolhodeError(f"--of: {options.of!r} is none of the numbers; give one of {', '.join(NUMBERS)}")
    check_depth(options.depth)
    check_suffixes(options.save, _SAVED)
    made = ledger(_table(file), options.tree, overwrite=options.overwrite, ignore=options.ignore)
    top = _top(made, options)
    report = Report()
    report.section(
        "",
        Field("file", "file", label(file)),
        Field("root", "the whole", made.root),
        Field("parts", "parts", int(made.is_part.sum())),
        Field("levels", "levels", int(made.depth.max()) + 1),
    )
    nodes = list(made.walk(top.depth + options.depth, at=top.id))
    grows = bool(np.any(made.predicted_mass != made.mass))
    columns = [Column("id", "part"), Column("mass", "mass")]
    columns += [Column("growth", "growth"), Column("predicted_mass", "with growth")] if grows else []
    columns += [Column(name, name) for name in NUMBERS[1:4]]
    rows = [node_row(node, top) for node in nodes]
    report.section("mass and centre", Table("nodes", columns, rows))
    tensors = [Column("id", "part"), *(Column(name, name) for name in NUMBERS[4:])]
    report.section(
        "tensor about the own centre, elements",
        Table("tensors", tensors, [tensor_row(node, top) for node in nodes]),
    )
    if made.sigma is None:
        report.notes.append("no part states a standard deviation: all numbers count as exact")
    else:
        _shares(report, made, top, options)
    if made.sigma is not None and made.unstated:
        report.notes.append(f"{made.unstated} of the parts state no standard deviation and count as exact")
    for source, numbers in made.opposite_signs.items():
        report.notes.append(
            f"source {source}: its parts state {', '.join(numbers)} with both signs of POIconv; what they "
            "share is the error of the element of the tensor, so that a number of + is too small where one "
            "of - is too large"
        )
    report.notes.append("numbers are in the units of the table; ± is one standard deviation, to first order")
    return report, made


def save_ledger(made: Ledger, options: LedgerOptions, path: Path) -> None:
    """Write all rows as a table, or draw the shares of the mass, and beside them those of the variance."""
    if path.suffix.lower() == ".csv":
        made.to_csv(path)
        return
    figure_module: Any = require("matplotlib.figure", extra="plot", purpose="drawing")
    top = _top(made, options)
    count = 1 if _found_shares(made, top, options) is None else 2
    figure = figure_module.Figure(figsize=(6.0 * count, 5.6), facecolor="white", layout="constrained")
    axes = figure.subplots(1, count, squeeze=False)[0]
    made.plot(axes[0], of="mass", at=top.id)
    if count == 2:
        made.plot(axes[1], of="variance", at=top.id, number=options.of)
    save_picture(figure, path)


def _table(file: Path) -> Any:
    """Return the file, or the table that comes on standard input."""
    if file != STDIN:
        return file
    data = sys.stdin.buffer.read()
    try:
        return table_of_text(data.decode(), "-", Path())
    except UnicodeDecodeError as error:
        raise FileFormatError(
            f"-: not a text file, so not a table: byte {error.start} is not UTF-8; save it as CSV"
        ) from None


def _top(made: Ledger, options: LedgerOptions) -> Part:
    name = made.root if options.at is None else options.at
    if name not in made:
        raise PolhodeError(f"--at: no part has the id {name!r}; {suggest_name(name, made.ids)}")
    return made[name]


def node_row(node: Part, top: Part) -> dict[str, Any]:
    """Describe mass and centre of a node."""
    row = {
        "id": _name_cell(node, top),
        "parent": node.parent.id if node.parent is not None else None,
        "depth": node.depth,
        "mass": _cell(node, "mass"),
        "growth": Cell(
            f"{100.0 * (node.predicted_mass / node.mass - 1.0):.3g} %", node.predicted_mass / node.mass - 1.0
        ),
        "predicted_mass": Cell(with_sigma(node.predicted_mass, None), node.predicted_mass),
    }
    row |= {name: _cell(node, name) for name in NUMBERS[1:4]}
    return row | {"covariance": node.covariance}


def tensor_row(node: Part, top: Part) -> dict[str, Any]:
    """Return the tensor of a node."""
    return {"id": _name_cell(node, top)} | {name: _cell(node, name) for name in NUMBERS[4:]}


def _name_cell(node: Part, top: Part) -> Cell:
    return Cell("  " * (node.depth - top.depth) + node.id, node.id)


def _cell(node: Part, name: str) -> Cell:
    value, sigma = node.with_sigma(name)
    size = node.inertia if name[0] == "I" else node.ledger.center_of_mass if name[0] == "C" else 0.0
    is_rounding = abs(value) < ROUNDING * float(np.abs(size).max())
    return Cell(with_sigma(0.0 if is_rounding else value, sigma), {"value": value, "sigma": sigma})


def _found_shares(made: Ledger, top: Part, options: LedgerOptions) -> Shares | None:
    """Return who contributes; None where nothing that the number depends on is uncertain."""
    try:
        return made.variance_shares(options.of, top.id)
    except PolhodeError:
        return None


def _shares(report: Report, made: Ledger, top: Part, options: LedgerOptions) -> None:
    shares = _found_shares(made, top, options)
    if shares is None:
        report.notes.append(f"{options.of} of {top.id} is exact: nothing that it depends on is uncertain")
        return
    alone = shares.sigma * np.sqrt(shares.fraction)
    rows = [
        {
            "name": shares.names[k],
            "is_source": bool(shares.is_source[k]),
            "fraction": Cell(f"{100.0 * shares.fraction[k]:.3g} %", float(shares.fraction[k])),
            "sigma": Cell(f"{alone[k]:.2g}", float(alone[k])),
            "mostly": shares.largest(k),
        }
        for k in range(min(len(shares), _CONTRIBUTORS))
    ]
    columns = (
        Column("name", "part or source"),
        Column("fraction", "of the variance"),
        Column("sigma", "alone"),
        Column("mostly", "mostly by its"),
    )
    title = f"who contributes to the variance of {options.of} of {top.id}"
    report.section(title, Table("variance_shares", columns, rows))
    if len(shares) > _CONTRIBUTORS:
        rest = float(shares.fraction[_CONTRIBUTORS:].sum())
        report.notes.append(f"{len(shares) - _CONTRIBUTORS} more contribute {100.0 * rest:.3g} % together")
