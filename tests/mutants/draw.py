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
CORE = Path("rust", "core", "src")


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

    @property
    def is_rust(self) -> bool:
        return self.file.endswith(".rs")


def switched(file: str, old: str, new: str) -> str:
    """A Rust expression that the switch chooses."""
    crate = "polhode" if file.startswith("rust/python/") else "crate"
    return f"(if {crate}::mutant::is(%d) {{ {new} }} else {{ {old} }})"


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


def drawn(count: int, seed: int) -> list[Mutant]:
    """About so many of the core: of each rule in proportion to the square root of how often it applies.

    Which ones are drawn hangs on the text of each place, not on what stands around it.
    """
    from mutants.rules import places

    by_rule: dict[str, list[tuple[str, Mutant]]] = defaultdict(list)
    for path in sorted((ROOT / CORE).rglob("*.rs")):
        file, before = path.relative_to(ROOT).as_posix(), Counter[str]()
        for place in places(path):
            words = f"{seed} {file} {place.rule} {place.old}"
            before[words] += 1
            key = hashlib.sha256(f"{words} {before[words]}".encode()).hexdigest()[:8]
            text = f"{place.new} && !crate::mutant::is(%d)"
            if place.rule != "return":
                text = switched(file, place.old, place.new)
            old, new = (" ".join(words.split()) for words in (place.old, place.new))
            what = f"{file}:{place.line}: {place.rule}: {old} → {new}"
            by_rule[place.rule].append(
                (key, Mutant(key, file, place.start, place.end, text, what, kind=place.rule))
            )
    parts = {rule: math.sqrt(len(rows)) for rule, rows in by_rule.items()}
    share = count / sum(parts.values())
    return [
        mutant
        for rule in sorted(parts)
        for _, mutant in sorted(by_rule[rule], key=lambda row: row[0])[: round(share * parts[rule])]
    ]
