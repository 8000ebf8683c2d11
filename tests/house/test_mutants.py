"""The table of mutants fits the sources; `python -m mutants` runs them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from places import ROOT

TABLES = ROOT / "tests" / "mutants"


def rows(name: str, table: str = "mutant") -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = tomllib.loads((TABLES / name).read_text(encoding="utf-8"))[table]
    return found


@pytest.mark.parametrize("row", rows("named.toml"), ids=lambda row: str(row["name"]))
def test_a_named_mutant_has_its_place(row: dict[str, Any]) -> None:
    assert (ROOT / row["file"]).read_text(encoding="utf-8").count(row["old"]) == 1
    assert row["new"] != row["old"]
    assert all((ROOT / "tests" / name).is_file() for name in row["tests"])


def test_named_mutants_have_names_of_their_own() -> None:
    names = [row["name"] for row in rows("named.toml")]
    assert len(set(names)) == len(names) >= 42


def test_each_survivor_has_a_reason() -> None:
    survivors = [*rows("equivalent.toml"), *rows("equivalent.toml", "living")]
    keys = [row["key"] for row in survivors]
    assert len(set(keys)) == len(keys)
    assert all(re.fullmatch(r"[0-9a-f]{8}|[a-z-]+", key) for key in keys)
    assert all(row["why"].endswith(".") for row in survivors)


@pytest.mark.parametrize(
    ("source", "found"),
    [
        (
            "fn f(a: f64) -> bool { a < 1.5 }",
            ["comparison: a < 1.5 → a <= 1.5", "constant: 1.5 → 10.0 * 1.5"],
        ),
        ("const A: f64 = 1.0 + 2.0; fn f() -> f64 { A }", ["constant: A → 10.0 * A"]),
        ("fn f(a: &mut i32) { *a += 1 }", ["sum: *a += 1 → *a -= 1"]),
        ("fn f(a: f64) -> f64 { a.max(0.0) }", ["min, max: a.max(0.0) → a.min(0.0)"]),
        ("fn f(a: bool, b: bool) -> bool { !a && b }", ["and, or: !a && b → !a || b", "not: !a → a"]),
        ("fn f(a: bool) -> i32 { if a { return 1; } 2 }", ["return: a → (a)"]),
        ("fn f() { assert!(1 + 1 < 3); } // 1 + 1", []),
        ("#[cfg(test)] mod tests { fn f() -> i32 { 1 + 1 } }", []),
        ("const fn f() -> i32 { 1 + 1 }", []),
    ],
)
def test_a_rule_makes_mutants(tmp_path: Path, source: str, found: list[str]) -> None:
    pytest.importorskip("tree_sitter_rust")
    from mutants.rules import places

    (tmp_path / "a.rs").write_text(source)
    assert [f"{place.rule}: {place.old} → {place.new}" for place in places(tmp_path / "a.rs")] == found


@pytest.mark.parametrize(
    ("lines", "found"),
    [
        ("return a < 1.5", ["comparison: a < 1.5 → a <= 1.5", "constant: 1.5 → 10.0 * 1.5"]),
        ("return 0 < a <= 9", ["comparison: 0 < a <= 9 → 0 <= a <= 9", "comparison: 0 < a <= 9 → 0 < a < 9"]),
        ("return A", ["constant: A → 10.0 * A"]),
        ("return (a) - (b)", ["sum: (a) - (b) → (a) + (b)"]),
        ("return max(a, 0)", ["min, max: max(a, 0) → min(a, 0)"]),
        ("return np.minimum(a, 0)", ["min, max: np.minimum(a, 0) → np.maximum(a, 0)"]),
        ("return not a and b", ["and, or: not a and b → not a or b", "not: not a → bool( a)"]),
        ("if a:\n        raise ValueError", ["return: a → (a)"]),
        ("if a:\n        return 1\n    else:\n        return 2", []),
        ("return 'a' + b", []),
        ("return f'{1 + 1}'", []),
    ],
)
def test_a_rule_makes_mutants_of_the_package(tmp_path: Path, lines: str, found: list[str]) -> None:
    from mutants.rules_python import places

    source = f"A = 2.5\nB = 1.0 + 2.0\n\ndef f(a, b=1.0 + 1.0):\n    {lines}\n"
    (tmp_path / "a.py").write_text(source, encoding="utf-8")
    made = places(tmp_path / "a.py")
    assert [f"{place.rule}: {place.old} → {place.new}" for place in made] == found
    assert all(source[place.start : place.end] == place.old for place in made)
