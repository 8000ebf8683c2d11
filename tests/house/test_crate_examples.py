"""Examples of the crate: every public name stands in one that runs, at it, its type or its module."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from places import ROOT
from public_rust import examples, public

SOURCE = ROOT / "rust" / "core" / "src"


def unshown() -> dict[str, set[str]]:
    """Public names that stand in the code of no example, be it their own, their type's or their module's."""
    words = set(re.findall(r"\w+", examples(SOURCE)))
    found = public(SOURCE)
    return {
        "items": {name for name in found.items if name not in words},
        "methods": {name for name in found.methods if name.partition("::")[2] not in words},
    }


@pytest.mark.parametrize("kind", ["items", "methods"])
def test_public_names_stand_in_an_example(kind: str) -> None:
    assert sorted(unshown()[kind]) == [], "write an example (`# Examples`) that uses it"


def test_what_is_public_is_found() -> None:
    found = public(SOURCE)
    assert {"RigidBody", "simulate", "cuboid", "Level", "philox", "MOST_STEPS"} <= set(found.items)
    assert {"RigidBody::from_principal", "FreeMotion::of", "Tolerance::new"} <= set(found.methods)
    # Of private modules nothing is public but what is handed on; of hidden ones nothing.
    assert not {"twofold", "two_sum", "Kernel", "eigen3", "carlson_rf"} & set(found.items)


def test_an_example_runs_unless_its_fence_says_else(tmp_path: Path) -> None:
    text = "/// ```\n/// shown();\n/// ```\n///\n/// ```text\n/// unseen\n/// ```\npub fn shown() {}\n"
    (tmp_path / "lib.rs").write_text(text, "utf-8")
    assert examples(tmp_path) == "shown();"
    assert set(public(tmp_path).items) == {"shown"}


def test_what_is_hidden_from_the_pages_needs_none(tmp_path: Path) -> None:
    text = "#[doc(hidden)]\npub mod a;\n\n#[doc(hidden)]\n#[derive(Debug)]\npub struct B;\n\npub struct C;\n"
    (tmp_path / "lib.rs").write_text(text, "utf-8")
    (tmp_path / "a.rs").write_text("pub fn d() {}\n", "utf-8")
    assert set(public(tmp_path).items) == {"C"}
