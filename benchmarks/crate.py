"""The crate as a stranger builds it beside the wheel's build: ``python benchmarks/crate.py [NAME ...]``.

A scratch crate depends on ``rust/core`` by its path and runs the kernels of
``rust/core/benches/kernels.rs``, once built by ``cargo build --release`` with no profile of its own,
once with the profile of the workspace (whole-program optimization, one codegen unit). Each round runs
both programs, on one thread. The time of a kernel is the least of all rounds, since other work on the
machine only adds to it; the median of the ratios within a round shows how far to trust that. NAMEs pick
the kernels whose names contain them.
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
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        target = Path(os.environ.get("CARGO_TARGET_DIR", Path(folder) / "target"))
        programs = built(Path(folder), target)
        rounds = [[times(program, options.names) for program in programs] for _ in range(options.rounds)]
    far = []
    kept = {}
    print(f"{'kernel':24} {'default':>10} {'wheel':>10} {'ratio':>7}   median of the rounds")
    for name in rounds[0][0]:
        default, wheel = (min(both[side][name] for both in rounds) for side in (0, 1))
        kept[name] = round(default / wheel, 2)
        median = statistics.median(both[0][name] / both[1][name] for both in rounds)
        mark = ""
        if default / wheel > FAR:
            far.append(name)
            mark = " FAR"
        print(
            f"{name:24} {_human(default):>10} {_human(wheel):>10} {default / wheel:7.2f}   {median:.2f}{mark}"
        )
    print(f"{'geometric mean':46} {statistics.geometric_mean(kept.values()):7.2f}")
    if options.json:
        machine = {"cpu": _cpu(), "cores": os.cpu_count(), "system": platform.system()}
        document = {"machine": machine, "rounds": options.rounds, "default_over_wheel": kept}
        options.json.write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    if far:
        raise SystemExit(f"slower than the wheel's build by more than {FAR - 1:.0%}: {', '.join(far)}")


def built(folder: Path, target: Path) -> list[Path]:
    """The programs as a stranger and as the wheel's profile build them."""
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
    for profile in ("release", "wheel"):
        command = ["cargo", "build", "--quiet", "--profile", profile]
        subprocess.run(command, cwd=folder, env=environment, check=True)
        programs.append(target / profile / "stranger")
    return programs


def times(program: Path, names: list[str]) -> dict[str, float]:
    """Seconds of each kernel."""
    told = subprocess.run([program, *names], check=True, capture_output=True, text=True).stdout
    return {name: float(seconds) for name, seconds in map(str.split, told.splitlines())}


if __name__ == "__main__":
    main()
