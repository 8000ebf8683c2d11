"""Ledgers as files: a table with a row for each node, or arrays by name."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode.files.fields import write_json
from polhode.files.record import in_json
from polhode.files.writing import write_bytes
from polhode.uncertainty._parts import SIGMAS
from polhode.uncertainty._rollup import NUMBERS

if TYPE_CHECKING:
    from os import PathLike

    from polhode.uncertainty._results import Ledger

__all__ = ["write_csv", "write_json_ledger"]

_FORMAT: Final = "polhode.Ledger/1"
_ELEMENTS: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def write_csv(ledger: Ledger, path: str | PathLike[str]) -> None:
    """Write a table: what ``Ledger.to_csv`` does."""
    columns: dict[str, Any] = {"id": ledger.ids, "parent": ledger.parents}
    columns |= ledger._words
    columns |= dict(zip(NUMBERS, _ten(ledger.mass, ledger.center_of_mass, ledger.inertia), strict=True))
    columns["POIconv"] = ["-"] * len(ledger)
    if ledger.sigma is not None:
        columns |= dict(zip(SIGMAS, _ten(*ledger.sigma), strict=True))
    if any(ledger._sources):
        columns["source"] = ledger._sources
    if np.any(ledger.predicted_mass != ledger.mass):
        columns["growth"] = ledger.growth.tolist()
        columns["predicted_mass"] = ledger.predicted_mass.tolist()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    write_bytes(path, text.getvalue().encode())


def write_json_ledger(ledger: Ledger, path: str | PathLike[str], *, covariance: bool) -> None:
    """Write arrays by name: what ``Ledger.to_json`` does."""
    file = Path(path)
    sigma = ledger.sigma
    fields: dict[str, Any] = {
        "format": _FORMAT,
        "root": ledger.root,
        "id": list(ledger.ids),
        "parent": list(ledger.parents),
        "depth": ledger.depth,
        "mass": ledger.mass,
        "center_of_mass": ledger.center_of_mass,
        "inertia": ledger.inertia,
        "growth": ledger.growth,
        "predicted_mass": ledger.predicted_mass,
        "sigma": None if sigma is None else in_json(sigma._asdict(), file),
    }
    if covariance:
        fields["covariance_of"] = list(NUMBERS)
        fields["covariance"] = ledger.covariance
    write_json(file, in_json(fields, file))


def _ten(mass: Any, center: Any, inertia: Any) -> list[list[float]]:
    """Give the ten columns as lists of floats, which print with all their digits."""
    return [column.tolist() for column in (mass, *center.T, *(inertia[:, a, b] for a, b in _ELEMENTS))]
