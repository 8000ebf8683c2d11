"""The mutants that are tried: some of a seed, and those with a name."""

from __future__ import annotations

import hashlib
import math
import tomllib
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
#: The folders of each part, and how many mutants of a seed are drawn from it.
PARTS = {
    "core": (Path("rust", "core", "src"), 220),
    "bindings": (Path("rust", "python", "src"), 60),
    "package": (Path("python", "polhode"), 100),
}


@dataclass(frozen=True)
class Mutant:
    """A fault: bytes of a file that are replaced, `%d` standing for its number in Rust."""

    key: str
    file: str
    start: int
    end: int
    text: str
    what: str
    tests: tuple[str, ...] = ()
    kind: str = "named"
    part: str = "named"

    @property
    def is_rust(self) -> bool:
        return self.file.endswith(".rs")

    @property
    def is_text(self) -> bool:
        """Whether it has no switch: the file is written anew for it."""
        return not self.is_rust and self.kind == "named"


def lives(file: str) -> str:
    """What asks the switch in a file."""
    if file.endswith(".py"):
        return '__import__("polhode._mutant", fromlist=["lives"]).lives(%d)'
    crate = "polhode" if file.startswith("rust/python/") else "crate"
    return f"{crate}::mutant::is(%d)"


def switched(file: str, old: str, new: str) -> str:
    """An expression that the switch chooses."""
    if file.endswith(".py"):
        return f"(({new}) if {lives(file)} else ({old}))"
    return f"(if {lives(file)} {{ {new} }} else {{ {old} }})"


def but_for(file: str, condition: str) -> str:
    """A condition that is not met where the mutant lives."""
    return (
        f"({condition} and not {lives(file)})" if file.endswith(".py") else f"{condition} && !{lives(file)}"
    )


def named() -> list[Mutant]:
    """Those of `named.toml`: an old text that is there once, and the new one."""
    found = []
    for row in tomllib.loads((HERE / "named.toml").read_text(encoding="utf-8"))["mutant"]:
        file, old, new = row["file"], row["old"], row["new"]
        source = (ROOT / file).read_text(encoding="utf-8")
        if source.count(old) != 1:
            raise SystemExit(f"{row['name']}: {old!r} is {source.count(old)} times in {file}")
        start = len(source[: source.index(old)].encode())
        text = switched(file, old, new) if file.endswith(".rs") else new
        end = start + len(old.encode())
        found.append(Mutant(row["name"], file, start, end, text, f"{old} → {new}", tuple(row["tests"])))
    return found


def drawn(part: str, count: int, seed: int) -> list[Mutant]:
    """About so many of a part: of each rule in proportion to the square root of how often it applies.

    Which ones are drawn hangs on the text of each place, not on what stands around it.
    """
    from mutants import rules, rules_python

    by_rule: dict[str, list[tuple[str, Mutant]]] = defaultdict(list)
    for path in sorted((ROOT / PARTS[part][0]).rglob("*.*")):
        if path.suffix not in {".rs", ".py"}:
            continue
        file, before = path.relative_to(ROOT).as_posix(), Counter[str]()
        for place in (rules if path.suffix == ".rs" else rules_python).places(path):
            words = f"{seed} {file} {place.rule} {place.old}"
            before[words] += 1
            key = hashlib.sha256(f"{words} {before[words]}".encode()).hexdigest()[:8]
            made = (
                but_for(file, place.new) if place.rule == "return" else switched(file, place.old, place.new)
            )
            old, new = (" ".join(words.split()) for words in (place.old, place.new))
            what = f"{file}:{place.line}: {place.rule}: {old} → {new}"
            by_rule[place.rule].append(
                (key, Mutant(key, file, place.start, place.end, made, what, kind=place.rule, part=part))
            )
    parts = {rule: math.sqrt(len(rows)) for rule, rows in by_rule.items()}
    share = count / sum(parts.values())
    return [
        mutant
        for rule in sorted(parts)
        for _, mutant in sorted(by_rule[rule], key=lambda row: row[0])[: round(share * parts[rule])]
    ]
