"""Lines of the core that tests execute: those of cargo, and of pytest through an extension with counters.

``python rust/coverage.py [--least PERCENT] [PYTEST OPTIONS]`` builds into ``target/coverage``, runs both
suites, and prints the share of lines, the worst files last. It needs ``llvm-profdata`` and ``llvm-cov`` of
rustc's LLVM or a newer one: ``rustup component add llvm-tools``, or a package such as ``llvm-22``;
``LLVM_PROFDATA`` and ``LLVM_COV`` name others.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CORE = ROOT / "rust" / "core" / "src"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "coverage"
RAW = TARGET / "raw"
# One level of instructions: the lines are the same, and the build takes a third of the time.
FLAGS = "-C instrument-coverage --cfg baseline_alone"


def tool(name: str) -> str:
    """Find one of LLVM's tools."""
    named = os.environ.get(name.upper().replace("-", "_"))
    sysroot = subprocess.check_output(["rustc", "--print", "sysroot"], text=True).strip()
    version = subprocess.check_output(["rustc", "-vV"], text=True)
    said = [re.search(rf"^{key}: (\w[\w-]*)", version, re.MULTILINE) for key in ("host", "LLVM version")]
    host, major = said
    inside = Path(sysroot) / "lib" / "rustlib" / (host[1] if host else "") / "bin" / name
    newest = [f"{name}-{k}" for k in range(int(major[1]) if major else 22, 40)]
    for candidate in filter(None, [named, str(inside), *newest]):
        if found := shutil.which(candidate):
            return found
    raise SystemExit(
        f"{name} is missing: rustup component add llvm-tools, or install LLVM {major and major[1]}"
    )


failed: list[str] = []
"""Suites in which a test failed: the share is printed all the same."""


def run(*command: str | Path, **environment: str) -> None:
    """Run a command with counters."""
    flags = {"RUSTFLAGS": FLAGS, "LLVM_PROFILE_FILE": str(RAW / "%4m.profraw")}
    words = [str(word) for word in command]
    if subprocess.run(words, check=False, cwd=ROOT, env={**os.environ, **flags, **environment}).returncode:
        failed.append(" ".join(words[:4]))


def of_cargo() -> list[Path]:
    """Run the tests of the core, and the seeds of the fuzzers; the programs that were run."""
    programs = []
    for manifest, package in (("Cargo.toml", "polhode"), ("rust/fuzz/Cargo.toml", "polhode-fuzz")):
        arguments = ["--locked", "--manifest-path", manifest, "--package", package]
        arguments += ["--profile", "coverage", "--target-dir", str(TARGET), "--lib", "--tests"]
        run("cargo", "test", *arguments, "--no-fail-fast")
        told = subprocess.run(
            ["cargo", "test", *arguments, "--no-run"],
            check=True,
            cwd=ROOT,
            text=True,
            capture_output=True,
            env={**os.environ, "RUSTFLAGS": FLAGS},
        )
        programs += [ROOT / path for path in re.findall(r"\((\S+?)\)$", told.stderr, re.MULTILINE)]
    return programs


def of_pytest(options: list[str]) -> Path:
    """Run the tests of the package on an extension with counters."""
    run(
        "cargo",
        "build",
        "--locked",
        "--package",
        "polhode-python",
        "--profile",
        "coverage",
        "--target-dir",
        TARGET,
        PYO3_PYTHON=sys.executable,
    )
    package = TARGET / "python"
    shutil.rmtree(package, ignore_errors=True)
    shutil.copytree(ROOT / "python", package, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    extension = package / "polhode" / "_core.abi3.so"
    shutil.copy(TARGET / "coverage" / "lib_core.so", extension)
    # What measures time measures the counters here.
    chosen = ["-m", "not long and not alone", "-o", "timeout=1200", *options]
    run(sys.executable, "-m", "pytest", "-q", *chosen, PYTHONPATH=str(package))
    return extension


def lines(programs: list[Path]) -> dict[Path, dict[int, int]]:
    """How often each line of the core was executed, its tests left out."""
    profile = TARGET / "all.profdata"
    subprocess.run(
        [tool("llvm-profdata"), "merge", "-sparse", *map(str, RAW.glob("*.profraw")), "-o", str(profile)],
        check=True,
    )
    objects = [word for program in programs[1:] for word in ("-object", str(program))]
    command = [
        tool("llvm-cov"),
        "export",
        "-format=lcov",
        f"-instr-profile={profile}",
        str(programs[0]),
        *objects,
    ]
    found: dict[Path, dict[int, int]] = defaultdict(dict)
    file, last = Path(), 0
    for row in subprocess.run(command, check=True, text=True, capture_output=True).stdout.splitlines():
        if row.startswith("SF:"):
            file = Path(row[3:])
            is_ours = file.is_relative_to(CORE) and file.name != "tests.rs"
            text = file.read_text(encoding="utf-8").splitlines() if is_ours else []
            last = next((k for k, line in enumerate(text, 1) if line == "mod tests {"), len(text))
        elif row.startswith("DA:"):
            line, count, *_ = map(int, row[3:].split(","))
            if line <= last:
                found[file][line] = max(count, found[file].get(line, 0))
    return found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--least", type=float, default=0.0, help="fail below this share, in percent")
    parser.add_argument("--suite", choices=("both", "cargo", "pytest"), default="both")
    given, options = parser.parse_known_args()
    shutil.rmtree(RAW, ignore_errors=True)
    programs = [of_pytest(options)] if given.suite != "cargo" else []
    if given.suite != "pytest":
        programs += of_cargo()
    found = lines(programs)
    total = sum(map(len, found.values()))
    hit = sum(count > 0 for counts in found.values() for count in counts.values())
    missed = {
        file: sorted(line for line, count in counts.items() if not count) for file, counts in found.items()
    }
    for file in sorted(missed, key=lambda file: len(missed[file])):
        if missed[file]:
            share = 100 * (1 - len(missed[file]) / len(found[file]))
            where = f"{file.relative_to(CORE)}: {spans(missed[file])}"
            print(f"{share:6.1f} %  {len(missed[file]):4d} missed  {where}")
    share = 100 * hit / total
    print(f"{share:.2f} % of {total} lines of the core")
    if share < given.least:
        raise SystemExit(f"less than {given.least} %")
    if failed:
        raise SystemExit(f"tests failed: {', '.join(failed)}")


def spans(missed: list[int]) -> str:
    """Line numbers, neighbours together."""
    parts: list[list[int]] = []
    for line in missed:
        if parts and line <= parts[-1][1] + 1:
            parts[-1][1] = line
        else:
            parts.append([line, line])
    return " ".join(f"{a}-{b}" if b > a else str(a) for a, b in parts)


if __name__ == "__main__":
    main()
