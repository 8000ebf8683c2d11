"""The notebooks of the pages: their cells run, show what they promise, and hold no outputs in Git."""

from __future__ import annotations

import ast
import contextlib
import io
import itertools
import json
import sys
from typing import Any

import pytest
from places import ROOT

FOLDER = ROOT / "docs/notebooks"
PROMISED = {
    "asteroid": ["long-axis 5.4", " 1 -1 ", "relative change of the energy: "],
    "racket": ["turns over every ", "   0.01 rad/s: "],
    "satellite": [
        "h = 0.0 N m s: ω strays from the axis by up to 1",
        "h = 1.0 N m s: ω strays from the axis by up to   ",
    ],
}


def cells(name: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((FOLDER / f"{name}.ipynb").read_text("utf-8"))["cells"]
    return found


def run(name: str, monkeypatch: pytest.MonkeyPatch) -> tuple[str, list[str], dict[str, Any]]:
    """What the cells print, what the last expressions of cells show, and the names that are left."""
    monkeypatch.setitem(sys.modules, "ipykernel", sys)  # as where a notebook runs
    names: dict[str, Any] = {}
    shown: list[str] = []
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        for cell in cells(name):
            if cell["cell_type"] != "code":
                continue
            tree = ast.parse("".join(cell["source"]))
            last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
            exec(compile(tree, name, "exec"), names)
            value = (
                eval(compile(ast.Expression(last.value), name, "eval"), names)
                if isinstance(last, ast.Expr)
                else None
            )
            if value is not None:
                shown.append(value._repr_html_())
    return printed.getvalue(), shown, names


def test_each_is_tested() -> None:
    assert {path.stem for path in FOLDER.glob("*.ipynb")} == set(PROMISED)


@pytest.mark.parametrize("name", PROMISED)
def test_it_runs_and_shows_pages(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    printed, shown, _ = run(name, monkeypatch)
    for words in PROMISED[name]:
        assert words in printed, printed
    assert sum("<iframe" in one for one in shown) >= 1
    assert all(len(one.encode()) < 300_000 for one in shown)


@pytest.mark.parametrize("name", PROMISED)
def test_it_is_small(name: str) -> None:
    assert (FOLDER / f"{name}.ipynb").stat().st_size < 10_000
    for cell in cells(name):
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


def test_the_step_of_the_flips_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten times less of a push, one step more: ln 10 over the rate of growth, for the way out and back."""
    printed, _, names = run("racket", monkeypatch)
    lines = [line.split(":") for line in printed.splitlines() if "rad/s:" in line]
    times = [float(words[1].split()[0]) for words in lines]
    first, second, third = names["handle"].principal_moments
    growth = 6.28 * ((second - first) * (third - second) / (first * third)) ** 0.5
    steps = [b - a for a, b in itertools.pairwise(times)]
    assert steps[1:] == pytest.approx([2.0 * 2.302585093 / growth] * 2, rel=1e-3)
