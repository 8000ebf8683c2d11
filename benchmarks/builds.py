"""Two builds of polhode, our side of every row, in turn: ``python benchmarks/builds.py OLD NEW [NAME ...]``.

OLD and NEW are folders that hold a built package ``polhode`` (``python`` of a checkout after ``make
build``). Each build has a process of its own; a round times a row in one and then in the other, so that
what the machine does meanwhile meets both. The ratios are times of OLD over times of NEW: above one, NEW
is faster. How memory lies differs from process to process by more than most changes of the code: the
median is that of several pairs of processes.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any

from run import FILES_OF_ROWS

HERE = Path(__file__).resolve().parent


class Build:
    """A process with the rows of one build."""

    def __init__(self, folder: Path, names: list[str]) -> None:
        path = os.pathsep.join([str(folder.resolve()), str(HERE)])
        self.process = subprocess.Popen(
            [sys.executable, __file__, "--serve", *names],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": path},
        )

    def ask(self, *question: Any) -> Any:
        """Send a question, and wait for the answer."""
        stdin, stdout = self.process.stdin, self.process.stdout
        if stdin is None or stdout is None:
            raise RuntimeError("the process has no pipes")
        stdin.write(json.dumps(question) + "\n")
        stdin.flush()
        return json.loads(stdout.readline())

    def close(self) -> None:
        """End the process: it has no more questions to answer."""
        self.process.communicate()


def serve(names: list[str]) -> None:
    """Answer questions about one row after the other: its name, how many calls fit the clock, their time."""
    from importlib import import_module

    from harness import repeats, seconds

    answers, sys.stdout = sys.stdout, sys.stderr
    # One at a time: what a row reads may be there only until the next one is asked for.
    rows = ((name, row) for name in names for row in import_module(name).rows())
    row: Any = None
    for line in sys.stdin:
        what, *rest = json.loads(line)
        if what == "next":
            name, row = next(rows, (None, None))
            answer: Any = row and f"{name}: {row.name}"
        elif what == "repeats":
            answer = repeats(row.ours, 0.02)
        else:
            answer = seconds(row.ours, *rest)
        print(json.dumps(answer), file=answers, flush=True)


def compare(folders: list[Path], name: str, rounds: int) -> dict[str, list[float]]:
    """Ratios of the rows of one file, in two new processes."""
    old, new = (Build(folder, [name]) for folder in folders)
    ratios: dict[str, list[float]] = {}
    while row := new.ask("next"):
        if old.ask("next") != row:
            raise RuntimeError(f"the builds have other rows from {row!r} on")
        count = min(build.ask("repeats") for build in (old, new))
        for turn in range(rounds):
            # Who goes first changes from round to round.
            pair = [(build, build.ask("seconds", count)) for build in ((old, new), (new, old))[turn % 2]]
            times = dict(pair)
            ratios.setdefault(row, []).append(times[old] / times[new])
    for build in (old, new):  # with the workers that its rows began, which would take time from the next pair
        build.close()
    return ratios


def main() -> None:
    """Time all rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("old", type=Path, metavar="OLD")
    parser.add_argument("new", type=Path, metavar="NEW")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of {', '.join(FILES_OF_ROWS)}")
    parser.add_argument("--rounds", type=int, default=5, help="in each pair of processes")
    parser.add_argument("--pairs", type=int, default=5, help="of processes")
    options = parser.parse_args()
    medians = []
    print(f"{'what':80} {'old/new':>8}   least to most of {options.pairs} pairs of processes")
    for name in options.names or FILES_OF_ROWS:
        pairs = [compare([options.old, options.new], name, options.rounds) for _ in range(options.pairs)]
        for row in pairs[0]:
            found = [statistics.median(pair[row]) for pair in pairs]
            medians.append(statistics.median(found))
            print(f"{row:80} {medians[-1]:8.3f}   {min(found):.3f} to {max(found):.3f}", flush=True)
    print(f"{'geometric mean':80} {statistics.geometric_mean(medians):8.3f}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--serve"]:
        serve(sys.argv[2:])
    else:
        main()
