"""The lints and tests of what differs from a commit: ``python tests/quick.py [COMMIT]``, of HEAD by default.

Rust tests are those of the rooms with a changed file. Python tests are those that bear the name of a changed
file, or else those of its room, against an extension that is compiled anew, quickly, not for speed and for
any machine. It says which changed files no test is named after; `make test` runs everything, on all
instruction sets.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))

#: Folders that are no rooms.
ROOTS = ("rust", "core", "src", "python", "polhode")

#: Rooms of other names than those of their tests.
NAMED = {
    "integrate": ["simulate", "taylor", "sensitivity", "load_terms"],
    "simulate": ["simulate", "events", "exact_runs"],
    "random": ["distributions"],
    "problem": ["simulate", "bad_inputs"],
    "numerics": ["principal_axes", "free_motion", "heavy_top_motion", "taylor"],
    "simplex": ["tetrahedra", "polyhedron"],
    "refined": ["free_motion", "near_separatrix"],
    "error": ["errors", "bad_inputs"],
    "arrays": ["foreign_arrays"],
    "free": ["free_motion"],
}


def changed(commit: str) -> list[Path]:
    """The files that differ from the commit, new ones among them."""
    commands = (["diff", "--name-only", commit], ["ls-files", "--others", "--exclude-standard"])
    told = [subprocess.check_output(["git", *words], cwd=ROOT, text=True) for words in commands]
    return [Path(name) for text in told for name in text.split("\n") if name and (ROOT / name).exists()]


def room(file: Path) -> str:
    """The module of the core that a file lies in: two folders deep, as ``motion::integrate``."""
    parts = file.relative_to("rust/core/src").with_suffix("").parts
    return "::".join(parts[:2])


def tests_of(file: Path) -> list[Path]:
    """The tests that bear the name of a file, or else those of the nearest room around it."""
    if file.parts[0] == "tests":
        return [file] if file.name.startswith("test_") else sorted(file.parent.glob("test_*.py"))
    rooms = [part for part in file.parts[:-1] if part not in ROOTS]
    for word in (file.stem, *reversed(rooms)):
        names = NAMED.get(word, [word.strip("_").removesuffix("s")])
        found = [path for name in names for path in sorted(Path("tests").glob(f"*/test_*{name}*.py"))]
        if word in rooms and word not in NAMED:
            found = sorted(Path("tests", word).glob("test_*.py")) or found
        if found and len(word.strip("_")) > 1:
            return found
    return []


def run(*command: str | Path, **environment: str) -> bool:
    """Run a command, and say how long it took."""
    start = time.monotonic()
    words = [str(word) for word in command]
    done = subprocess.run(words, cwd=ROOT, env={**os.environ, **environment}, check=False).returncode == 0
    print(
        f"== {' '.join(words[:4])}: {time.monotonic() - start:.0f} s{'' if done else ', FAILED'}", flush=True
    )
    return done


def extension() -> Path | None:
    """The package with an extension of the present sources; its folder."""
    words = ["cargo", "build", "--locked", "--package", "polhode-python", "--profile", "quick"]
    # Kernels for one instruction set: those for all take three times as long.
    flags = {"RUSTFLAGS": "--cfg baseline_alone", "PYO3_PYTHON": sys.executable}
    if not run(*words, "--target-dir", TARGET, **flags):
        return None
    package = TARGET / "quick" / "python"
    shutil.rmtree(package, ignore_errors=True)
    shutil.copytree(ROOT / "python", package, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    shutil.copy(TARGET / "quick" / "lib_core.so", package / "polhode" / "_core.abi3.so")
    return package


def main() -> None:
    """Run what belongs to the change."""
    files = changed(*sys.argv[1:] or ["HEAD"])
    rust = [file for file in files if file.suffix == ".rs"]
    python = [file for file in files if file.suffix in (".py", ".pyi")]
    done = True
    if rust:
        done &= run("cargo", "fmt", "--all", "--check")
        rooms = sorted({room(file) for file in rust if file.is_relative_to("rust/core/src")})
        if rooms:
            words = ["cargo", "test", "--locked", "--quiet", "--package", "polhode", "--profile", "units"]
            done &= run(*words, "--lib", "--", *rooms)
    if python:
        done &= run(sys.executable, "-m", "ruff", "check", *python)
        done &= run(sys.executable, "-m", "ruff", "format", "--check", *python)
    tests = list(dict.fromkeys(test for file in rust + python for test in tests_of(file)))
    for file in rust + python:
        if not tests_of(file):
            print(f"no test has the name of {file}: make test runs all of them")
    if tests:
        package = extension() if rust else ROOT / "python"
        done &= package is not None
        if package:
            options = ["-q", "-m", "not long and not alone", "--numprocesses", "auto"]
            done &= run(sys.executable, "-m", "pytest", *options, *tests, PYTHONPATH=str(package))
    sys.exit(not done)


if __name__ == "__main__":
    main()
