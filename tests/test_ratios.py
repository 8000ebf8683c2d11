"""The ratios of the benchmarks that a release keeps."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture
def harness(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[1] / "benchmarks"))
    from importlib import import_module

    yield import_module("harness")
    sys.modules.pop("harness")


def result(harness: Any, name: str, ratio: float) -> Any:
    return harness.Result(
        name, "a peer", 9, (1.0, 1.0, 1.0), (ratio, ratio, ratio), (ratio, ratio, ratio), "", None
    )


def test_a_run_is_compared_with_the_last_release(
    harness: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "ratios.json"
    assert harness.kept(path) == ("", {})
    for release, ratio in (("0.9.0", 3.0), ("0.10.0", 4.0), ("0.2.0", 5.0)):
        harness.keep(release, [result(harness, "a row", ratio)], path)
    assert harness.kept(path) == ("0.10.0", {"a row, beside a peer": 4.0})
    rows = [result(harness, "a row", 5.0), result(harness, "another row", 5.0)]
    harness.report(rows, ratios=path)
    head, old, new = capsys.readouterr().out.splitlines()
    assert "0.10.0" in head
    assert "x1.25" in old
    assert " new " in new
