"""A copy of the sources with many mutants, of which the switch lets one live at a time."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from mutants.draw import HERE, ROOT, Mutant

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
TREE = TARGET / "mutants"
EXTENSION = "python/polhode/_core.abi3.so"
SWITCHES = {"rust/core/src/mutant.rs": "switch.rs", "python/polhode/_mutant.py": "switch.py"}
REFUSED = TARGET / "mutants-refused.json"
# One level of instructions: the laws are the same, and the build takes a third of the time.
FLAGS = {"RUSTFLAGS": "--cfg baseline_alone --cap-lints allow", "CARGO_TARGET_DIR": str(TARGET)}
CARGO = {**os.environ, **FLAGS, "PYO3_PYTHON": sys.executable}


def write(mutants: dict[int, Mutant]) -> dict[str, list[tuple[int, int, int]]]:
    """Write the copy anew where it differs; in each file, where the mutants of a number begin and end.

    What is no source any more is removed: a test that was renamed would run twice.
    """
    listed = subprocess.check_output(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT
    )
    by_file: dict[str, list[tuple[int, Mutant]]] = defaultdict(list)
    for number, mutant in mutants.items():
        if not mutant.is_text:
            by_file[mutant.file].append((number, mutant))
    where: dict[str, list[tuple[int, int, int]]] = defaultdict(list)
    names = {name for name in listed.decode().split("\0") if name and (ROOT / name).is_file()}
    stale(TREE, {*names, *SWITCHES, EXTENSION})
    for name in sorted(names):
        data = (ROOT / name).read_bytes()
        parts, last, length = [], 0, 0
        for number, mutant in sorted(by_file[name], key=lambda row: row[1].start):
            text = mutant.text.replace("%d", str(number)).encode()
            parts += [data[last : mutant.start], text]
            length += mutant.start - last
            where[name].append((length, length + len(text), number))
            length, last = length + len(text), mutant.end
        data = b"".join([*parts, data[last:]])
        if name == "rust/core/src/lib.rs":
            data += b"\npub mod mutant;\n"
        put(TREE / name, data)
    for name, source in SWITCHES.items():
        put(TREE / name, (HERE / source).read_bytes())
    return where


def stale(tree: Path, names: set[str]) -> None:
    """Remove the files of a folder that have none of these names, and folders that are left empty."""
    for path in sorted(tree.rglob("*"), reverse=True):
        if path.is_dir() and not path.is_symlink():
            if not any(path.iterdir()):
                path.rmdir()
        elif path.relative_to(tree).as_posix() not in names:
            path.unlink()


def put(path: Path, data: bytes) -> None:
    """Write a file if it differs: cargo looks at the time of the last change."""
    if not path.is_file() or path.read_bytes() != data:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def apart(mutants: list[Mutant]) -> list[Mutant]:
    """Those of which none overlaps an earlier one of the list."""
    kept: list[Mutant] = []
    for mutant in mutants:
        if not any(
            other.file == mutant.file and other.start < mutant.end and mutant.start < other.end
            for other in kept
            if not mutant.is_text
        ):
            kept.append(mutant)
    return kept


def compiling(mutants: list[Mutant]) -> dict[int, Mutant]:
    """The mutants by their numbers, from 1; what the compiler refuses is left out."""
    numbers = dict(enumerate(mutants, 1))
    refused = json.loads(REFUSED.read_text(encoding="utf-8")) if REFUSED.exists() else {}
    left = {number: mutant for number, mutant in numbers.items() if mutant.key not in refused}
    command = ["cargo", "check", "--locked", "--workspace", "--features", "polhode/serde"]
    command += ["--message-format=json", "--profile", "test"]
    while True:
        where = write(left)
        told = subprocess.run(command, cwd=TREE, env=CARGO, text=True, stdout=subprocess.PIPE, check=False)
        if told.returncode == 0:
            return left
        wrong = set()
        for line in told.stdout.splitlines():
            message = json.loads(line).get("message") or {}
            if message.get("level") == "error":
                wrong |= {
                    number
                    for span in message["spans"]
                    for start, end, number in where[span["file_name"]]
                    if span["byte_start"] < end and start < span["byte_end"]
                }
        if not wrong:
            raise SystemExit(told.stdout[-5000:])
        for number in sorted(wrong):
            mutant = left.pop(number)
            refused[mutant.key] = mutant.what
            print(f"does not compile: {mutant.what}")
        REFUSED.write_text(json.dumps(refused, indent=1), encoding="utf-8")


def build() -> list[Path]:
    """Compile the copy: the tests of the core; the extension goes where Python finds it."""
    command = ["cargo", "test", "--locked", "--package", "polhode", "--features", "serde"]
    command += ["--lib", "--tests", "--no-run"]
    told = subprocess.run(command, cwd=TREE, env=CARGO, text=True, stderr=subprocess.PIPE, check=True).stderr
    programs = [Path(path) for path in re.findall(r"Executable .*\((\S+)\)$", told, re.MULTILINE)]
    command = ["cargo", "build", "--locked", "--package", "polhode-python", "--profile", "test"]
    subprocess.run(command, cwd=TREE, env=CARGO, check=True)
    shutil.copy(TARGET / "debug" / "lib_core.so", TREE / EXTENSION)
    return programs
