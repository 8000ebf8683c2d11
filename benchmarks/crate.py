"""The crate as a stranger builds it beside the wheel's build: ``python benchmarks/crate.py [NAME ...]``.

A scratch crate depends on ``rust/core`` by its path and runs the kernels of
``rust/core/benches/kernels.rs``, once built by ``cargo build --release`` with no profile of its own,
once with the profile of the workspace (whole-program optimization, one codegen unit). Each round runs
both programs, on one thread, every second round the other one first. The ratio of a kernel is the median
of the ratios of all rounds: the least times would hide a kernel that is slow in most processes, for example
where the stack begins at an unlucky address. The quartiles show the spread. Kernels near the limit run
four times as many rounds more. NAMEs pick the kernels whose names contain them.

With ``--software`` it measures nothing, and names the functions of the first program that multiply and
add by the routine in software: they are part of a kernel, but not inlined into it.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import shutil
import statistics
import subprocess
import tempfile
import tomllib
from pathlib import Path

from harness import _cpu, _human

ROOT = Path(__file__).resolve().parents[1]
FAR = 1.10
"""Ratios above it are marked, and counted as a failure."""
NEAR = 1.05
"""Kernels with a ratio above it are measured again."""
MANIFEST = """\
[package]
name = "stranger"
version = "0.0.0"
edition = "2024"

[workspace]

[dependencies]
polhode = {{ path = {core} }}

[profile.wheel]
inherits = "release"
lto = "{lto}"
codegen-units = {units}
"""


def main() -> None:
    """Build both programs, run them in turn and print a row for each kernel."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--json", type=Path, metavar="FILE", help="keep the ratios")
    parser.add_argument("--software", action="store_true", help="look for parts of kernels in software")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        target = Path(os.environ.get("CARGO_TARGET_DIR", Path(folder) / "target"))
        if options.software:
            (program,) = built(Path(folder), target, ("release",))
            found = software(program)
            raise SystemExit("\n".join(["multiply and add in software:", *found]) if found else 0)
        programs = built(Path(folder), target, ("release", "wheel"))
        rounds = measured(programs, options.names, options.rounds)
        again = [name for name, pairs in rounds.items() if ratio(pairs) > NEAR]
        if again:
            more = measured(programs, again, 4 * options.rounds)
            rounds = {name: pairs + more.get(name, []) for name, pairs in rounds.items()}
    far = [name for name, pairs in rounds.items() if ratio(pairs) > FAR]
    kept = {name: round(ratio(pairs), 2) for name, pairs in rounds.items()}
    print(f"{'kernel':24} {'default':>10} {'wheel':>10} {'ratio':>7} {'quartiles':>11} {'rounds':>7}")
    for name, pairs in rounds.items():
        default, wheel = map(statistics.median, zip(*pairs, strict=True))
        low, middle, high = statistics.quantiles(one / other for one, other in pairs)
        print(
            f"{name:24} {_human(default):>10} {_human(wheel):>10} {middle:7.3f} "
            f"{low:6.2f}{high:5.2f} {len(pairs):7}{' FAR' if name in far else ''}"
        )
    print(f"{'geometric mean':46} {statistics.geometric_mean(kept.values()):7.2f}")
    if options.json:
        machine = {"cpu": _cpu(), "cores": os.cpu_count(), "system": platform.system()}
        document = {"machine": machine, "rounds": options.rounds, "default_over_wheel": kept}
        options.json.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    if far:
        raise SystemExit(f"slower than the wheel's build by more than {FAR - 1:.0%}: {', '.join(far)}")


def built(folder: Path, target: Path, profiles: tuple[str, ...]) -> list[Path]:
    """The programs as a stranger ("release") and as the wheel's profile build them."""
    release = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["profile"]["release"]
    manifest = MANIFEST.format(
        core=json.dumps(str(ROOT / "rust" / "core")), lto=release["lto"], units=release["codegen-units"]
    )
    (folder / "Cargo.toml").write_text(manifest, encoding="utf-8")
    (folder / "src").mkdir()
    shutil.copy(ROOT / "Cargo.lock", folder)
    shutil.copy(ROOT / "rust" / "core" / "benches" / "kernels.rs", folder / "src" / "main.rs")
    environment = {**os.environ, "CARGO_TARGET_DIR": str(target)}
    programs = []
    for profile in profiles:
        command = ["cargo", "build", "--quiet", "--profile", profile]
        subprocess.run(command, cwd=folder, env=environment, check=True)
        programs.append(target / profile / "stranger")
    return programs


def software(program: Path) -> list[str]:
    """The functions of a program for x86-64 that call `fma`, but for kernels for every machine.

    Each takes the address of `fma` from a place in the table of addresses, which the loader fills.
    """

    def said(*command: str) -> list[str]:
        told = subprocess.run([*command, program], check=True, capture_output=True, text=True)
        return told.stdout.splitlines()

    symbols = [line.split() for line in said("nm")]
    (address,) = {parts[0].lstrip("0") for parts in symbols if parts[-1] == "fma"}
    relocations = [line.split() for line in said("readelf", "--relocs", "--wide")]
    places = {parts[0].lstrip("0") for parts in relocations if len(parts) == 4 and parts[3] == address}
    found, function = set(), ""
    for line in said("objdump", "--disassemble", "--demangle", "--no-show-raw-insn"):
        if line.endswith(">:"):
            function = line.split(" ", 1)[1].strip("<>:")
        elif "# " in line and line.split("# ")[1].split()[0] in places:
            found.add(function)
    return sorted(name for name in found if not name.startswith("polhode::numerics::dispatch::baseline"))


def measured(programs: list[Path], names: list[str], rounds: int) -> dict[str, list[tuple[float, float]]]:
    """Seconds of each kernel in both programs, round by round."""
    both: list[dict[str, float]] = [{}, {}]
    pairs: dict[str, list[tuple[float, float]]] = {}
    for number in range(rounds):
        for side in (0, 1) if number % 2 == 0 else (1, 0):
            both[side] = times(programs[side], names)
        for name, default in both[0].items():
            pairs.setdefault(name, []).append((default, both[1][name]))
    return pairs


def ratio(pairs: list[tuple[float, float]]) -> float:
    """Median of the ratios within a round."""
    return statistics.median(default / wheel for default, wheel in pairs)


def times(program: Path, names: list[str]) -> dict[str, float]:
    """Seconds of each kernel."""
    told = subprocess.run([program, *names], check=True, capture_output=True, text=True).stdout
    return {name: float(seconds) for name, seconds in map(str.split, told.splitlines())}


if __name__ == "__main__":
    main()
