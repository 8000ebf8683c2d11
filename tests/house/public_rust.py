"""What a crate hands to its users, by its sources: public items, methods of public types, examples."""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

ITEM = re.compile(
    r"^(#\[doc\(hidden\)\]\n(?:#.*\n)*)?"
    r"pub (?:const |unsafe )*(?:fn|struct|enum|trait|const|static|type) (\w+)",
    re.MULTILINE,
)
IMPL = re.compile(r"^impl(?:<(?:[^<>]|<[^<>]*>)*>)? (?:(\S.*?) for )?([\w:]+)", re.MULTILINE)
METHOD = re.compile(r"^    pub (?:const )?fn (\w+)", re.MULTILINE)
FENCE = re.compile(r"^ *(?:///|//!) ?(.*)$", re.MULTILINE)


@dataclass
class Public:
    """Names by the files that they stand in; methods as ``Type::name``."""

    items: dict[str, str] = field(default_factory=dict)
    methods: dict[str, str] = field(default_factory=dict)


def without_tests(text: str) -> str:
    """A source up to its tests."""
    return re.split(r"^#\[cfg\(test\)\]\nmod \w+ \{", text, flags=re.MULTILINE)[0]


@cache
def public(source: Path) -> Public:
    """All that users of the crate in this folder can name, but for fields, variants and methods of traits."""
    found = Public()
    texts = {path: without_tests(path.read_text("utf-8")) for path in sorted(source.rglob("*.rs"))}
    homes: dict[str, str] = {}
    for path, text in texts.items():
        for hidden, name in ITEM.findall(text):
            if not hidden:
                homes.setdefault(name, path.relative_to(source).as_posix())
    opened(source / "lib.rs", texts, found, source, homes)
    types = set(found.items)
    for path, text in texts.items():
        for impl in IMPL.finditer(text):
            owner = impl[2].rpartition("::")[2]
            if impl[1] or owner not in types:
                continue
            body = text[impl.end() : text.find("\n}", impl.end())]
            for name in METHOD.findall(body):
                found.methods[f"{owner}::{name}"] = path.relative_to(source).as_posix()
    return found


def opened(path: Path, texts: dict[Path, str], found: Public, source: Path, homes: dict[str, str]) -> None:
    """A public module: its items, the modules below it, and the names that it hands on."""
    text = texts[path]
    for hidden, name in ITEM.findall(text):
        if not hidden:
            found.items[name] = path.relative_to(source).as_posix()
    folder = path.parent if path.name in ("lib.rs", "mod.rs") else path.with_suffix("")
    for hidden, name in re.findall(r"^(#\[doc\(hidden\)\]\n)?pub mod (\w+);", text, re.MULTILINE):
        if not hidden:
            file = folder / f"{name}.rs"
            opened(file if file in texts else folder / name / "mod.rs", texts, found, source, homes)
    for name in re.findall(r"^pub use self::(\w+)::\*;", text, re.MULTILINE):
        opened(folder / f"{name}.rs", texts, found, source, homes)
    for handed in re.findall(r"^pub use ([^;]+);", text, re.MULTILINE):
        where, _, names = " ".join(handed.split()).rpartition("::{")
        for name in re.findall(r"(\w+)(?=[ ,}]|$)", names if where else handed.rpartition("::")[2]):
            if name in homes:
                found.items[name] = homes[name]


@cache
def examples(source: Path) -> str:
    """The code of all examples in the documentation of a crate, one after the other."""
    code: list[str] = []
    for path in sorted(source.rglob("*.rs")):
        is_code = is_run = False
        for line in FENCE.findall(path.read_text("utf-8")):
            if line.lstrip().startswith("```"):
                is_code = not is_code
                is_run = is_code and line.strip().removeprefix("```") in ("", "rust", "no_run")
            elif is_run:
                code.append(line)
    return textwrap.dedent("\n".join(code))
