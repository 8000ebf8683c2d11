"""Pytest on mutants: each test runs without one, and then on each living mutant that it reached.

``pytest -p mutants.in_pytest`` in the copy. `POLHODE_MUTANTS` names a JSON file: the numbers and keys of the
mutants that still live, the seconds that each may take, the longest test that is run on them, and the file
that the outcomes go to, line by line.
"""

from __future__ import annotations

import ctypes
import json
import os
import resource
import signal
import time
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

from _pytest.runner import runtestprotocol
from polhode import _core

if TYPE_CHECKING:
    import pytest

TASK = json.loads(Path(os.environ["POLHODE_MUTANTS"]).read_text(encoding="utf-8"))
LIVING = {int(number): key for number, key in TASK["living"].items()}
SPENT: dict[int, float] = defaultdict(float)
SWITCH = ctypes.CDLL(_core.__file__)
RECORD = Path(TASK["record"])
LINES = [json.loads(line) for line in RECORD.read_text(encoding="utf-8").splitlines()]
TRIED = {(line["key"], line.get("ended")) for line in LINES}

# A mutant that does not end is stopped from outside, within the core as well; one that eats memory ends too.
MOST = 60
SPOILT = 70
signal.signal(signal.SIGALRM, signal.SIG_DFL)
resource.setrlimit(resource.RLIMIT_AS, (1 << 34, 1 << 34))


def let_live(number: int) -> None:
    """Here, and in processes that a test starts."""
    SWITCH.polhode_mutant_lives(number)
    os.environ["POLHODE_MUTANT"] = str(number)


def reached() -> list[int]:
    """The living mutants that were asked for since this was called last."""
    return [number for number in sorted(LIVING) if SWITCH.polhode_mutant_reached(number) & 1]


def has_passed(item: pytest.Item, nextitem: pytest.Item | None) -> bool:
    """Whether a test passes; one that is skipped does."""
    return not any(report.failed for report in runtestprotocol(item, nextitem=nextitem, log=False))


def note(number: int, **found: object) -> None:
    """Add a line to the record, which outlives a crash."""
    with RECORD.open("a", encoding="utf-8") as file:
        file.write(json.dumps({"key": LIVING[number], **found}) + "\n")


def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool:
    """Run a test on all mutants it reaches; a mutant it finds is dead from then on."""
    let_live(0)
    reached()
    start = time.monotonic()
    if not LIVING or nextitem is None or not has_passed(item, nextitem):
        return True
    if time.monotonic() - start > TASK["longest"]:
        return True
    for number in reached():
        if SPENT[number] > TASK["seconds"] or (LIVING[number], item.nodeid) in TRIED:
            continue
        note(number, begun=item.nodeid)  # a crash, or a test that does not end, has killed it
        let_live(number)
        start = time.monotonic()
        signal.alarm(MOST)
        is_alive = has_passed(item, nextitem)
        signal.alarm(0)
        SPENT[number] += time.monotonic() - start
        let_live(0)
        if is_alive:
            note(number, ended=item.nodeid)
        else:
            is_clean = has_passed(item, nextitem)
            note(number, ended=item.nodeid, killed=item.nodeid if is_clean else None)
            if not is_clean:  # what it left behind spoils what comes
                os._exit(SPOILT)
            del LIVING[number]
    return True
