"""The benchmarks: their rows can be made, and a release keeps their ratios."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import import_module
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
from places import ROOT


@pytest.fixture
def harness(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    yield import_module("harness")
    sys.modules.pop("harness")


def result(harness: Any, name: str, ratio: float) -> Any:
    return harness.Result(
        name,
        "a peer",
        9,
        (1.0, 1.0, 1.0),
        (ratio, ratio, ratio),
        (ratio, 0.9 * ratio, 1.2345 * ratio),
        "",
        None,
    )


def test_a_run_is_compared_with_the_last_release(
    harness: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "ratios.json"
    assert harness.kept(path) == ("", {})
    for release, ratio in (("0.9.0", 3.0), ("0.10.0", 4.0), ("0.2.0", 5.0)):
        harness.keep(release, [result(harness, "a row", ratio)], path)
    assert harness.kept(path) == ("0.10.0", {"a row, beside a peer": 4.0})
    processor = harness._processor()
    first = {"date": "2026-11-22", "machine": {}, "ratios": {"a row, beside a peer": 2.0}}
    other = {"0.1.0": {processor: first}, "0.2.0": {"another, avx512": first}}
    (tmp_path / "first.json").write_text(json.dumps(other), encoding="utf-8")
    assert harness.kept(tmp_path / "first.json") == ("0.1.0", {"a row, beside a peer": 2.0})
    other.pop("0.1.0")
    (tmp_path / "first.json").write_text(json.dumps(other), encoding="utf-8")
    assert harness.kept(tmp_path / "first.json") == ("", {})
    harness.keep("0.2.0", [result(harness, "a row", 3.0)], tmp_path / "first.json")
    assert list(json.loads((tmp_path / "first.json").read_text("utf-8"))["0.2.0"]) == [
        "another, avx512",
        processor,
    ]
    rows = [result(harness, "a row", 5.0), result(harness, "another row", 5.0)]
    harness.report(rows, ratios=path)
    machine, head, old, new = capsys.readouterr().out.splitlines()
    assert machine == f"on {processor}"
    assert "0.10.0" in head
    assert "x1.25" in old
    assert " new " in new


def test_the_page_tells_spread_machine_and_date(
    harness: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "site"))
    measured: Any = import_module("measured")
    path = tmp_path / "ratios.json"
    harness.keep("0.2.0", [result(harness, "a row", 4.0)], path)
    found = json.loads(path.read_text("utf-8"))
    page = measured.performance(found | json.loads(harness.RATIOS.read_text("utf-8")))
    assert "| a row | a peer | 4 | 3.6 to 4.94 |" in page
    named = "| moments and axes of a million tensors | NumPy: `linalg.eigh` | 43.2 |\n"
    assert named in page  # no spread was kept: no column
    assert page.count("least to largest |") == 1
    run = found["0.2.0"][harness._processor()]
    assert f"Measured on {run['date']}: {run['machine']['cpu']} with {run['machine']['level']}, " in page
    assert "Measured on 2026-11-22: AMD EPYC with avx2, 2 cores, Python 3.11.7." in page


def test_each_kept_row_has_words_on_the_page(harness: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "docs" / "site"))
    measured: Any = import_module("measured")
    told = {name for rows in measured.ROWS.values() for name in rows}
    for found in chain.from_iterable(
        one.values() for one in json.loads(harness.RATIOS.read_text("utf-8")).values()
    ):
        assert set(found["ratios"]) <= told, "give the rows words in docs/site/measured.py"
    page = measured.performance(json.loads(harness.RATIOS.read_text("utf-8")))
    assert "Other rows" not in page
    assert page.count("\n|") == sum(len(rows) + 2 for rows in measured.ROWS.values())


@pytest.mark.parametrize(
    ("most", "bar", "met"), [(1.0, "ours <= 1 s", True), (1e-12, "ours <= 0.001 ns", False)]
)
def test_a_bar_on_our_own_time(harness: Any, most: float, bar: str, met: bool) -> None:
    row = harness.Row(
        "a row", "a peer", lambda: sum(range(100)), lambda: None, lambda *_: None, most_seconds=most
    )
    result = harness.measure(row, rounds=3, least_seconds=1e-4)
    assert (result.bar, result.met) == (bar, met)


ROWS = """
import sys
from importlib import import_module
sys.path.insert(0, sys.argv[1])
from run import FILES_OF_ROWS
for name in FILES_OF_ROWS:
    try:
        rows = list(import_module(name).rows())
    except ModuleNotFoundError as error:
        if error.name not in {"dask", "psutil", "scipy", "trimesh"}:
            raise
    else:
        for row in rows:
            print(f"{name}: {row.name}, beside {row.peer}")
"""


@pytest.mark.long
def test_all_rows_can_be_made(harness: Any) -> None:
    """In a process of its own: the files of rows set threads, and their names are plain words."""
    command = [sys.executable, "-c", ROWS, str(Path(harness.__file__).parent)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = done.stdout.splitlines()
    assert len(rows) == len(set(rows)) > 0
    assert "gyrostat: gyrostat, set-up, beside our free motion" in rows
