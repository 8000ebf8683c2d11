"""Run the benchmarks: ``python benchmarks/run.py [--rounds N] [--json FILE] [--keep RELEASE] [NAME ...]``.

NAME is the stem of a file of rows beside this one; all of them by default. Everything runs on one thread,
ours and the peers', unless the environment says otherwise. The last column but one compares each ratio with
that of the last release on the same processor in ``ratios.json``: above one, we have become faster beside the
peer. ``--keep`` puts the ratios of this run into that file.
"""

from __future__ import annotations

import argparse
import os
from importlib import import_module
from pathlib import Path

# Before anything imports NumPy: the same threads on both sides.
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "POLHODE_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

FILES_OF_ROWS = (
    "startup",
    "command_line",
    "ledger",
    "principal_axes",
    "particles",
    "voxels",
    "meshes",
    "free_motion",
    "gyrostat",
    "heavy_top",
    "rolling",
    "simulate",
    "chunks",
    "flyby",
    "identification",
    "callbacks",
    "threads",
)


def main() -> None:
    """Measure the rows asked for and print their table."""
    from harness import keep, measure, report

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of {', '.join(FILES_OF_ROWS)}")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--keep", metavar="RELEASE", help="of which release these ratios are")
    options = parser.parse_args()
    if options.keep and options.names:
        parser.error("--keep is for the ratios of all files of rows")
    results = [
        measure(row, options.rounds)
        for name in options.names or FILES_OF_ROWS
        for row in import_module(name).rows()
    ]
    report(results, options.json)
    if options.keep:
        keep(options.keep, results)


if __name__ == "__main__":
    main()
