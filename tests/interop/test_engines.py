"""The table of engines on its page: what is found in those that are installed."""

from __future__ import annotations

import importlib.util
import re
from typing import Any

import numpy as np
import polhode
import pytest
from places import ROOT
from polhode import RigidBody, Trajectory


def _engines() -> Any:
    spec = importlib.util.spec_from_file_location("engines", ROOT / "benchmarks" / "engines.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


engines = _engines()
ROWS = {
    tuple(row[:2]): row[2]
    for row in re.findall(
        r"^\| (\w+) [\d.]+ \| ([^|]+) \| .* \| ([^|]+) \|$",
        (ROOT / "docs" / "engines.md").read_text("utf-8"),
        re.MULTILINE,
    )
}


def test_the_page_has_every_engine() -> None:
    assert set(ROWS) == {(name, how) for name, _, how, _ in engines.ENGINES}
    assert {"scalar-first", "diagonal tensor", "none"} <= set(ROWS.values())


@pytest.mark.parametrize("one", engines.ENGINES, ids=lambda one: f"{one[0]}, {one[2]}")
def test_an_engine_does_what_the_page_says(one: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    name, package, how, run = one
    pytest.importorskip({"drake": "pydrake", "pin": "pinocchio"}.get(package, package))
    monkeypatch.setattr(engines, "END", 20.0)
    t, quaternion, omega = run()
    body = RigidBody(1.0, np.diag(engines.MOMENTS) if name == "Bullet" else engines.TENSOR)
    found = polhode.audit(Trajectory.from_samples(body, t, quaternion, omega))
    assert ", ".join(finding.kind for finding in found.findings) == ROWS[name, how].replace("none", "")
    assert found.agrees == (ROWS[name, how] == "none")
