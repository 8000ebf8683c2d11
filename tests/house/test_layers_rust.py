"""The arrows of the Rust sources: no files lead to one another, and rooms use only what is below them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from places import ROOT
from rust_layers import Crate, circles, first_item, out_of_order, strings, upward

LAYERS: dict[str, Any] = tomllib.loads((Path(__file__).with_name("layers.toml")).read_text("utf-8"))
SOURCES = {"core": "rust/core/src", "bindings": "rust/python/src"}


@pytest.fixture(scope="module", params=SOURCES)
def house(request: pytest.FixtureRequest) -> tuple[Crate, dict[str, Any]]:
    return Crate(ROOT / SOURCES[request.param]), LAYERS[request.param]


def test_every_test_of_the_core_is_in_a_program() -> None:
    folder = ROOT / "rust/core/tests"
    declared = {
        name
        for path in folder.rglob("*.rs")
        for name in re.findall(r"^mod (\w+);$", path.read_text("utf-8"), flags=re.MULTILINE)
    }
    programs = {"outside", "levels"}
    files = {path.parent.name if path.stem == "mod" else path.stem for path in folder.rglob("*.rs")}
    assert files - declared == programs
    told = tomllib.loads((ROOT / "rust/core/Cargo.toml").read_text("utf-8"))
    assert {program["name"] for program in told["test"]} == programs


class TestThisHouse:
    def test_every_name_is_followed(self, house: tuple[Crate, Any]) -> None:
        crate, _ = house
        on_disk = {path.relative_to(crate.source).as_posix() for path in crate.source.rglob("*.rs")}
        tests = {file for file in on_disk if file.rpartition("/")[2] == "tests.rs"}
        assert crate.unknown == []
        assert set(crate.files) == on_disk - tests
        assert sum(map(len, crate.arrows.values())) > 3 * len(crate.files) / 2

    def test_no_files_lead_to_one_another(self, house: tuple[Crate, Any]) -> None:
        crate, plan = house
        found = {file for group in circles(crate.arrows) for file in group}
        listed = set(plan["in_circles"])
        assert sorted(found - listed) == [], "new circles"
        assert sorted(listed - found) == [], "no longer in a circle: take them off the list"

    def test_rooms_use_what_they_may(self, house: tuple[Crate, Any]) -> None:
        crate, plan = house
        assert out_of_order(crate, plan["rooms"]) == []

    def test_rooms_stand_above_those_they_use(self, house: tuple[Crate, Any]) -> None:
        assert upward(house[1]["rooms"]) == []

    def test_rooms_only_declare(self, house: tuple[Crate, Any]) -> None:
        doors = sorted(house[0].source.rglob("mod.rs"))
        found = {path.relative_to(ROOT).as_posix(): first_item(path.read_text("utf-8")) for path in doors}
        told = [f"{file}:{item[0]}: {item[1]}" for file, item in found.items() if item is not None]
        assert told == [], "items stand in files of the room; its mod.rs declares and hands on"
        assert doors


class TestWords:
    """The core says laws and numbers; keywords are for the bindings to say, options for the command line."""

    FOREIGN = re.compile(
        r"\b\w+=(?![={:])|(?<![\w-])--[a-z]|\b[a-z_]\w*\(\)|\b(?:loads|numpy|np|polhode)\.\w|\b(?:True|False|None)\b"
    )

    def test_the_core_names_no_keyword_and_no_option(self) -> None:
        told = [
            f"{path.name}: {text}"
            for path in sorted((ROOT / SOURCES["core"]).rglob("*.rs"))
            if path.name != "tests.rs"
            for text in strings(path.read_text("utf-8"))
            if self.FOREIGN.search(text)
        ]
        assert told == []

    @pytest.mark.parametrize(
        "text",
        [
            "pass rtol= for a table",
            'closure=\\"caps\\"',
            "say so: index_base=0",
            "or --index-base 0",
            "integrate with simulate()",
            "by loads.schedule",
            "pass orient=True",
        ],
    )
    def test_such_words_are_found(self, text: str) -> None:
        found = strings(
            f'#[error(\n    "a law; \\\n     {text}"\n)]\n// "rtol="\n#[cfg(test)] mod t {{ "rtol=" }}'
        )
        assert [bool(self.FOREIGN.search(word)) for word in found] == [True]

    @pytest.mark.parametrize(
        "text", ["t = {time:?} where {a:e} -- b", "I1 + I2 >= I3", "m == n", "half a turn"]
    )
    def test_others_are_not(self, text: str) -> None:
        assert not self.FOREIGN.search(text)


def crate(folder: Path, **files: str) -> Crate:
    """A crate of these files; two underscores for a folder."""
    for name, text in files.items():
        path = folder / f"{name.replace('__', '/')}.rs"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return Crate(folder)


class TestTheChecker:
    """Circles that were planted, and files that only look like one."""

    @pytest.mark.parametrize(
        "a",
        [
            "use crate::b::B; pub struct A;",
            "use super::b::{self, B as Other}; pub struct A;",
            "pub struct A; fn f() -> crate::b::B { loop {} }",
            "pub struct A; fn f() { use super::b::B; }",
            "use crate::b; pub struct A; fn f() { b::B::new() }",
            "use crate::b::*; pub struct A; fn f(_: B) {}",
            "use crate::{b::{B}, c}; pub struct A;",
            "pub use super::b::B; pub struct A; fn f(_: B) {}",
            "pub struct A; mod inner { use super::super::b::B; }",
            "pub struct A; impl crate::b::Trait for A {}",
            "pub struct A<'a>(&'a str, crate::b::B, char); const Q: char = '\"'; const R: &str = r#\"\"#;",
        ],
    )
    def test_of_two(self, tmp_path: Path, a: str) -> None:
        b = "use crate::a::A; pub struct B; pub trait Trait {}"
        found = crate(tmp_path, lib="mod a; mod b; mod c;", a=a, b=b, c="")
        assert found.unknown == []
        assert circles(found.arrows) == [["a.rs", "b.rs"]]

    @pytest.mark.parametrize(
        "a",
        [
            "pub struct A;",
            "// use crate::b::B;\npub struct A; /* crate::b::B */",
            "/// [`B`](crate::b::B)\npub struct A;",
            'pub struct A; const TEXT: &str = "crate::b::B";',
            'pub struct A; const TEXT: &str = r#"crate::b::B " crate::b::B"#;',
            "pub struct A; #[cfg(test)] mod tests { use crate::b::B; }",
            "pub struct A; #[cfg(test)] #[allow(dead_code)] fn f() -> crate::b::B { {} }",
            "pub struct A; #[cfg(test)] use crate::b::B;",
            "pub use crate::b::B; pub struct A;",
            "pub(in crate::b) struct A;",
            "use other::b::B; pub struct A;",
        ],
    )
    def test_of_none(self, tmp_path: Path, a: str) -> None:
        found = crate(tmp_path, lib="mod a; mod b;", a=a, b="use crate::a::A; pub struct B;")
        assert found.unknown == []
        assert circles(found.arrows) == []

    def test_of_a_folder_and_its_file(self, tmp_path: Path) -> None:
        used = crate(
            tmp_path / "1",
            lib="mod a;",
            a__mod="mod b; pub struct A; fn f() { b::g() }",
            a__b="use super::A; pub fn g() {}",
        )
        assert circles(used.arrows) == [["a/b.rs", "a/mod.rs"]]
        handed_on = crate(
            tmp_path / "2",
            lib="mod a;",
            a__mod="mod b; pub use b::g; pub struct A;",
            a__b="use super::A; pub fn g() {}",
        )
        assert circles(handed_on.arrows) == []

    def test_a_name_is_followed_to_its_file(self, tmp_path: Path) -> None:
        found = crate(
            tmp_path,
            lib="mod a; mod b; pub use a::Thing;",
            a__mod="mod deep; pub use self::deep::Thing as Other; pub use deep::Thing;",
            a__deep="pub struct Thing; use crate::b::g;",
            b="use crate::Thing; use crate::a::Other; pub fn g() {}",
        )
        assert set(found.arrows["b.rs"]) == {"a/deep.rs"}
        assert circles(found.arrows) == [["a/deep.rs", "b.rs"]]

    def test_of_many(self, tmp_path: Path) -> None:
        names = [f"m{k}" for k in range(40)]
        files = {name: f"use crate::m{(k + 1) % 40}::T; pub struct T;" for k, name in enumerate(names)}
        found = crate(tmp_path, lib=" ".join(f"mod {name};" for name in names), **files)
        assert circles(found.arrows) == [sorted(f"{name}.rs" for name in names)]

    def test_a_name_that_nothing_defines(self, tmp_path: Path) -> None:
        found = crate(tmp_path, lib="mod a;", a="use crate::nowhere::X;")
        assert found.unknown == ["a.rs: crate::nowhere::X"]

    @pytest.mark.parametrize(
        "item",
        [
            "fn f() {}",
            "pub(super) const fn f() {}",
            "pub struct A;",
            "pub(crate) enum A { B }",
            "impl A {}",
            "unsafe impl Send for A {}",
            "pub trait T {}",
            "const A: u8 = 1;",
            "static A: u8 = 1;",
            "type A = u8;",
            "macro_rules! m { () => {} }",
            "m! { a }",
            "mod tests { use super::*; }",
            "extern crate a;",
        ],
    )
    @pytest.mark.parametrize("attribute", ["", "#[cfg(test)] ", '#[doc = "]; mod a;"] '])
    def test_an_item_of_a_room(self, item: str, attribute: str) -> None:
        before = "//! A room.\n\n/* fn g() {}\n*/ mod a;\npub use a::A;\n\n/// What it is.\n"
        assert first_item(f"{before}{attribute}{item}\nmod b;\n") == (8, item)

    @pytest.mark.parametrize(
        "room",
        [
            "",
            "//! A room: `fn f() {}`.\n\nmod a;\npub mod b;\npub(crate) mod r#c;\npub(in crate::a) mod d;",
            "mod a;\npub use self::a::{self, B as C,\n    d::*};\nuse std::fmt;\npub(super) use a::D;",
            '#![allow(dead_code)]\n#[cfg(test)]\nmod tests;\n#[expect(\n    lint, reason = "]"\n)]\nmod a;',
            "/// struct A;\nmod a; // fn f() {}\n/* impl A {} */ use a::modulus;",
        ],
    )
    def test_declarations_alone(self, room: str) -> None:
        assert first_item(room) is None

    def test_rooms(self, tmp_path: Path) -> None:
        found = crate(
            tmp_path,
            lib="mod low; mod high; mod lost;",
            low__mod="pub mod near; use crate::high::H;",
            low__near="pub struct N;",
            high="use crate::low::near::N; pub struct H;",
            lost="",
        )
        rooms: list[dict[str, Any]] = [
            {"name": "middle", "files": ["low/near"], "uses": []},
            {"name": "ground", "files": ["low/*"], "uses": []},
            {"name": "roof", "files": ["high", "lib"], "uses": ["ground"]},
        ]
        assert out_of_order(found, rooms) == [
            "lost.rs is in no room",
            "low/mod.rs (ground) uses crate::high::H of high.rs (roof)",
            "high.rs (roof) uses crate::low::near::N of low/near.rs (middle)",
        ]
        assert upward(rooms) == []
        assert upward(rooms[::-1]) == ["roof uses ground"]
