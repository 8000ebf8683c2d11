"""What ``polhode ensemble`` tells of every member: some numbers at the end, reduced while members run.

The functions go to the workers of a cluster, where nothing else of the command line is needed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import reductions
from polhode.cli.layout import Cell, Column, Table

if TYPE_CHECKING:
    from polhode.reductions import Reduction

__all__ = ["NUMBERS", "SHARES", "kept", "modes_table", "numbers", "numbers_table"]

NUMBERS: Final = (
    ("omega_x", "rad/s"),
    ("omega_y", "rad/s"),
    ("omega_z", "rad/s"),
    ("|omega|", "rad/s"),
    ("|omega|, ratio to start", ""),
    ("z of body from z", "deg"),
)
"""Names and units."""
SHARES: Final = (0.05, 0.5, 0.95)


def numbers(motion: Any) -> Any:
    """Give the numbers of members at the end, shape (members, 6).

    Parameters
    ----------
    motion : Trajectory

    Returns
    -------
    numpy.ndarray
    """
    size = np.sqrt(np.square(motion.omega[:, [0, -1]]).sum(axis=-1))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = size[:, 1] / size[:, 0]
    x, y, z, w = np.moveaxis(motion.quaternion[:, -1], -1, 0)
    tilt = np.degrees(2.0 * np.arctan2(np.hypot(x, y), np.hypot(z, w)))
    return np.column_stack([motion.omega[:, -1], size[:, 1], ratio, tilt])


def kept(*, has_modes: bool) -> dict[str, Reduction]:
    """Give the reductions; modes only of members that are free."""
    both = {"spread": reductions.covariance(numbers), "shares": reductions.quantiles(SHARES, numbers)}
    return both | ({"modes": reductions.mode_changes()} if has_modes else {})


def numbers_table(found: dict[str, Any]) -> Table:
    """Tell the spread of each number."""
    columns = (
        Column("name", "number"),
        Column("mean", "mean"),
        Column("sigma", "sigma"),
        Column("low", "5 %"),
        Column("median", "median"),
        Column("high", "95 %"),
        Column("unit", "unit"),
    )
    means, sigmas = found["spread"].mean, np.sqrt(np.diagonal(found["spread"].covariance))
    rows = [
        {
            "name": name,
            "mean": float(means[k]),
            "sigma": float(sigmas[k]),
            **dict(zip(("low", "median", "high"), found["shares"].values[:, k].tolist(), strict=True)),
            "unit": unit,
        }
        for k, (name, unit) in enumerate(NUMBERS)
    ]
    return Table("end", columns, rows)


def modes_table(found: dict[str, Any]) -> Table:
    """Tell how many members rotate in which mode, which free ones keep."""
    modes = found["modes"]
    shares = modes.table.sum(axis=0) / modes.table.sum()
    rows = [
        {"mode": name, "share": Cell(f"{100.0 * share:.3g} %", share)}
        for name, share in zip(modes.modes, shares.tolist(), strict=True)
        if share > 0.0
    ]
    return Table("modes", (Column("mode", "mode"), Column("share", "members")), rows)
