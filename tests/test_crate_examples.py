"""Examples of the crate: the public names that none of them has, a list that may only become shorter."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from public_rust import examples, public

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "rust" / "core" / "src"
LISTED = tomllib.loads((ROOT / "tests" / "crate_examples.toml").read_text("utf-8"))


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
    found, listed = unshown()[kind], set(LISTED[kind])
    assert sorted(found - listed) == [], "write an example (`# Examples`) that uses it"
    assert sorted(listed - found) == [], "it has an example now: take it off tests/crate_examples.toml"


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
