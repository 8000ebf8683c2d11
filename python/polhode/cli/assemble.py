"""``polhode assemble``: parts put together, their tree and the whole."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from polhode._optional import require
from polhode.assembly import read
from polhode.cli.files import STDIN, check_depth, check_suffixes
from polhode.cli.layout import Cell, Column, Field, Report, Table
from polhode.cli.ledger import node_row, tensor_row
from polhode.cli.loading import LoadedBody
from polhode.cli.report import check_alone
from polhode.cli.tables import FileUnits
from polhode.cli.whole import body_sections
from polhode.errors import PolhodeError
from polhode.interop.programs import to_text
from polhode.io.writing import save_picture
from polhode.uncertainty.ledgers.rollup import NUMBERS
from polhode.units import quantity, vector

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.assembly import Assembly
    from polhode.cli.options import AssembleOptions, ReportOptions

__all__ = ["assembly_for_program", "assembly_report", "save_assembly"]

_PICTURES: Final = (".png", ".pdf", ".svg")
_MOST_ROWS: Final = 40
_SAVED: Final = (*_PICTURES, ".json", ".npz", ".csv")


def assembly_report(file: Path, options: AssembleOptions, extra: ReportOptions) -> tuple[Report, Assembly]:
    """Report on an assembly; give it too."""
    check_depth(options.depth)
    check_suffixes(options.save, _SAVED)
    if extra.mass_unit is not None:
        quantity(f"1 {extra.mass_unit}", "kg", "--mass-unit")
    about = vector(extra.about, "m", "--about") if extra.about else None
    made = _read_assembly(file)
    whole = made.ledger[made.ledger.root]
    report = Report()
    report.section(
        "",
        Field("file", "file", str(file)),
        Field("format", "format", "assembly"),
        Field("length_unit", "length unit", "m"),
        Field("name", "the whole", made.name),
        Field("part_count", "parts", len(made)),
    )
    nodes = list(made.ledger.walk(options.depth))
    most = None if options.every else _MOST_ROWS
    columns = [Column("id", "part"), Column("mass", "mass", "kg")]
    columns += [Column(name, name, "m") for name in NUMBERS[1:4]]
    rows = [node_row(node, whole) | {"id": _name_cell(node.id, node.depth)} for node in nodes]
    report.section("parts, centres from the origin of the whole", Table("parts", columns, rows, most))
    tensors = [Column("id", "part"), *(Column(name, name, "kg m^2") for name in NUMBERS[4:])]
    report.section(
        "their tensors about the own centres, elements",
        Table(
            "part_tensors",
            tensors,
            [tensor_row(node, whole) | {"id": _name_cell(node.id, node.depth)} for node in nodes],
            most,
        ),
    )
    loaded = LoadedBody(made.body, [], "kg", "m", notes=made.notes, kind="assembly")
    body_sections(report, loaded, FileUnits("m", extra.mass_unit), about)
    return report, made


def assembly_for_program(
    file: Path, options: AssembleOptions, extra: ReportOptions, form: str | None
) -> tuple[str, list[str]]:
    """Write the mass properties of the whole for the program of --as; what has to be noted too."""
    check_alone(extra, form)
    if options.save:
        raise PolhodeError("--save: --as prints numbers alone; leave one of the two out")
    made = _read_assembly(file)
    return to_text(made.body, str(extra.program)), list(made.notes)


def _read_assembly(file: Path) -> Assembly:
    if file == STDIN:
        raise PolhodeError("-: an assembly names files beside its own; save it in one, and name that")
    return read(file)


def save_assembly(made: Assembly, path: Path) -> list[str]:
    """Write a picture, the whole as one body, or the tree as a ledger; give notes on it."""
    suffix = path.suffix.lower()
    if suffix == ".csv":
        made.ledger.to_csv(path)
        if made.ledger.sigma is None:
            return [f"saved {path}"]
        return [
            f"saved {path}; a table states the ten sigmas of a part as independent, the whole in .json keeps "
            "what they share"
        ]
    if suffix not in _PICTURES:
        made.body.save(path)
        return [f"saved {path}"]
    figure_module: Any = require("matplotlib.figure", extra="plot", purpose=f"--save {path}:")
    figure = figure_module.Figure(figsize=(12.0, 5.6), facecolor="white", layout="constrained")
    made.plot(figure.add_subplot(1, 2, 1, projection="3d", computed_zorder=False), length_label="m")
    made.ledger.plot(figure.add_subplot(1, 2, 2), of="mass", mass_label="kg")
    save_picture(figure, path)
    notes = [f"saved {path}"]
    boxes = sum(part.file is None and not part.solid for part in made.parts)
    if boxes:
        notes.append(
            f"{path.name}: parts of which the inertia alone is known are drawn as the box that has it"
        )
    return notes


def _name_cell(name: str, depth: int) -> Cell:
    return Cell("  " * depth + name.rpartition("/")[2], name)
