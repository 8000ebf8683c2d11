"""Side-by-side timing: answers compared first, then interleaved rounds in one process, and ratios.

A row names what is timed, ours and a peer's, on the same input, with the same threads and the same output.
The shared cores of test machines drift, so only the ratio within a round means anything; its median and
spread over the rounds are what is reported.
"""

from __future__ import annotations

import json
import os
import platform
import statistics
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from polhode import _core

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = ["Result", "Row", "keep", "kept", "measure", "repeats", "report", "seconds"]

RATIOS = Path(__file__).with_name("ratios.json")
"""The ratios of each release on each processor, by the names of row and peer."""


@dataclass(frozen=True)
class Row:
    """One comparison.

    Attributes
    ----------
    name : str
        What is done.
    peer : str
        Who else does it.
    ours, theirs : callable
        Do it once and return the answer.
    compare : callable
        Given both answers, raises AssertionError where they differ.
    items : int
        How many things one call does, for the time per item.
    peer_items : int, optional
        As `items`, where one call of the peer does fewer.
    at_least, at_most : float, optional
        Bars for the peer's time over ours, or for ours over the peer's.
    most_seconds : float, optional
        A bar for our own time per item, where there is none for a ratio.
    """

    name: str
    peer: str
    ours: Callable[[], Any]
    theirs: Callable[[], Any]
    compare: Callable[[Any, Any], None]
    items: int = 1
    peer_items: int | None = None
    at_least: float | None = None
    at_most: float | None = None
    most_seconds: float | None = None


@dataclass(frozen=True)
class Result:
    """Seconds per item and the ratio of the times, median, least and most over the rounds."""

    name: str
    peer: str
    rounds: int
    ours: tuple[float, float, float]
    theirs: tuple[float, float, float]
    speedup: tuple[float, float, float]
    bar: str
    met: bool | None


def measure(row: Row, rounds: int = 9, least_seconds: float = 0.02) -> Result:
    """Compare the answers of a row, then time both sides in turn, each round long enough for the clock."""
    row.compare(row.ours(), row.theirs())
    counts = [repeats(call, least_seconds) for call in (row.ours, row.theirs)]
    items_each = (row.items, row.peer_items or row.items)
    times = [
        [
            seconds(call, count) / items
            for call, count, items in zip((row.ours, row.theirs), counts, items_each, strict=True)
        ]
        for _ in range(rounds)
    ]
    speedup = _spread([theirs / ours for ours, theirs in times])
    bar, met = "", None
    if row.at_least is not None:
        bar, met = f">= {row.at_least:g}", speedup[0] >= row.at_least
    elif row.at_most is not None:
        bar, met = f">= {1 / row.at_most:.3g}", speedup[0] >= 1 / row.at_most
    ours, theirs = (_spread(side) for side in zip(*times, strict=True))
    if row.most_seconds is not None:
        bar, met = f"ours <= {_human(row.most_seconds)}", ours[0] <= row.most_seconds
    return Result(row.name, row.peer, rounds, ours, theirs, speedup, bar, met)


def report(results: Iterable[Result], path: Path | None = None, ratios: Path = RATIOS) -> None:
    """Print a table of ratios beside those of the last release, and write all as JSON if a path is given."""
    results = list(results)
    release, before = kept(ratios)
    print(f"on {_processor()}")
    print(f"{'what':66} {'peer':28} {'ours':>10} {'peer':>10} {'times faster':>26} {release:>8}  bar")
    for result in results:
        ratio = "{:.3g} ({:.3g} to {:.3g})".format(*result.speedup)
        verdict = {True: "met", False: "NOT MET", None: ""}[result.met]
        then = before.get(_key(result))
        change = "new" if then is None else f"x{result.speedup[0] / then:.2f}"
        print(
            f"{result.name:66} {result.peer:28} {_human(result.ours[0]):>10} {_human(result.theirs[0]):>10}"
            f" {ratio:>26} {change:>8}  {result.bar} {verdict}"
        )
    if path is not None:
        document = {"machine": _machine(), "results": [asdict(result) for result in results]}
        path.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")


def kept(path: Path = RATIOS) -> tuple[str, dict[str, float]]:
    """The last release whose ratios on this processor are kept, and these; nothing where there is none."""
    if not path.exists():
        return "", {}
    known = json.loads(path.read_text(encoding="utf-8"))
    releases = {name: found[_processor()] for name, found in known.items() if _processor() in found}
    if not releases:
        return "", {}
    release = max(releases, key=lambda name: [int(part) for part in name.split(".")])
    # Of the first release the medians alone were kept.
    ratios = releases[release]["ratios"].items()
    return release, {name: ratio[0] if isinstance(ratio, list) else ratio for name, ratio in ratios}


def keep(release: str, results: Iterable[Result], path: Path = RATIOS) -> None:
    """Keep the ratios of a release, median, least and most, beside those on other processors."""
    releases = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    ratios = {_key(result): [float(f"{ratio:.3g}") for ratio in result.speedup] for result in results}
    found = {"date": time.strftime("%Y-%m-%d"), "machine": _machine(), "ratios": ratios}
    releases.setdefault(release, {})[_processor()] = found
    path.write_text(json.dumps(releases, indent=2) + "\n", encoding="utf-8")


def _key(result: Result) -> str:
    return f"{result.name}, beside {result.peer}"


def _machine() -> dict[str, Any]:
    python, level = platform.python_version(), _core.machine()[0]
    return {"cpu": _cpu(), "level": level, "cores": os.cpu_count(), "python": python}


def _processor() -> str:
    """The processor and the instruction set that is used: ratios of others are not compared."""
    return f"{_cpu()}, {_core.machine()[0]}"


def repeats(call: Callable[[], Any], least_seconds: float) -> int:
    """How many calls last long enough for the clock."""
    once = seconds(call, 1)
    return max(1, round(least_seconds / max(once, 1e-9)))


def seconds(call: Callable[[], Any], count: int) -> float:
    """Seconds a call, over so many of them."""
    start = time.perf_counter()
    for _ in range(count):
        call()
    return (time.perf_counter() - start) / count


def _spread(values: Iterable[float]) -> tuple[float, float, float]:
    """Median, least and most."""
    values = sorted(values)
    return statistics.median(values), values[0], values[-1]


def _human(seconds: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _cpu() -> str:
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as lines:  # noqa: PTH123
            return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()
