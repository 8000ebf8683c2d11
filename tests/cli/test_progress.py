"""Progress of long work: a bar on a terminal after two seconds, nothing in a pipe, or one's own function."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, solids
from polhode._progress import duration, progress_bar
from polhode.uncertainty import propagate


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time that passes is what a test says."""
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    return now


def shown(monkeypatch: pytest.MonkeyPatch, stream: Any, progress: Any, clock: list[float]) -> str:
    monkeypatch.setattr(sys, "stderr", stream)
    with progress_bar("work", progress) as tell:
        for step in range(1, 101):
            clock[0] += 0.0625
            if tell is not None:
                tell(step / 100)
    return str(stream.getvalue())


def test_a_bar_on_a_terminal_after_two_seconds(monkeypatch: pytest.MonkeyPatch, clock: list[float]) -> None:
    text = shown(monkeypatch, Terminal(), None, clock)
    lines = text.split("\r")
    assert lines[1].startswith("work [==========  ")
    assert " 32 %, 4 s left" in lines[1]
    assert 10 < len(lines) < 25
    # What was shown is wiped away at the end.
    assert not lines[-1]
    assert not lines[-2].strip()
    assert len(lines[-2]) >= len(lines[-3].rstrip())


def test_nothing_in_a_pipe_unless_asked_for(monkeypatch: pytest.MonkeyPatch, clock: list[float]) -> None:
    assert shown(monkeypatch, io.StringIO(), None, clock) == ""
    assert shown(monkeypatch, Terminal(), False, clock) == ""
    assert "work [" in shown(monkeypatch, io.StringIO(), True, clock)
    monkeypatch.setattr(sys, "stderr", None)
    with progress_bar("work") as tell:
        assert tell is None


def test_short_work_shows_nothing(monkeypatch: pytest.MonkeyPatch, clock: list[float]) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    with progress_bar("work") as tell:
        assert tell is not None
        clock[0] += 1.9
        tell(0.99)
    assert stream.getvalue() == ""


def test_a_function_of_ones_own() -> None:
    told: list[float] = []
    with progress_bar("work", told.append) as tell:
        assert tell is not None
        tell(0.5)
    assert told == [0.5]


def test_what_is_neither_is_refused() -> None:
    with (
        pytest.raises(TypeError, match="progress: expected True, False, None or a function"),
        progress_bar("", 3),  # type: ignore[arg-type]
    ):
        pass


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.4, "0 s"), (59.4, "59 s"), (61.0, "1 min 01 s"), (3599.0, "59 min 59 s"), (7384.0, "2 h 03 min")],
)
def test_durations(seconds: float, words: str) -> None:
    assert duration(seconds) == words


def test_pieces_of_a_file_and_draws_show_a_bar_on_a_terminal_alone(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    rows = np.memmap(tmp_path / "rows", dtype="f8", mode="w+", shape=(100_000, 4))
    rows[:] = 1.0
    body = solids.box((1, 2, 3), mass=1.0).with_sigma(mass=0.1)
    monkeypatch.setattr("polhode.ensembles.lazy_arrays._PIECE", 4096)
    monkeypatch.setattr("polhode._progress._SILENT", 0.0)
    works: dict[str, Callable[[], object]] = {
        "100000 particles [": lambda: RigidBody.from_particles(rows[:, 0], rows[:, 1:]),
        "500 draws [": lambda: propagate(lambda one: one.mass, body, "monte-carlo", n=500, seed=1),
    }
    for words, work in works.items():
        for stream in (Terminal(), io.StringIO()):
            monkeypatch.setattr(sys, "stderr", stream)
            work()
            assert (words in stream.getvalue()) == stream.isatty()
