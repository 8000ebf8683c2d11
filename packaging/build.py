"""Source distribution and wheel as they are published, into ``dist``: ``python packaging/build.py``.

The sources are copied to a scratch folder and dressed for strangers: links of the readme become absolute, the
addresses of the project and the licences of what is compiled in are added. From there comes the source
distribution, and from that alone the wheel. The same sources give the same bytes.

``--target manylinux2014`` (the default on Linux) compiles by zig, against the glibc of 2014;
``--target native`` as the machine does. ``--interpreter python3.14t`` makes a wheel without the GIL.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from dress import address, dressed
from plain import without_traces

ROOT = Path(__file__).resolve().parents[1]
NATIVE = "native"
LINUX = "manylinux2014"


def main() -> None:
    """Build what the options ask for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--target", default=LINUX if platform.system() == "Linux" else NATIVE)
    parser.add_argument("--triple", help="the Rust target, where it is not this machine")
    parser.add_argument("--interpreter", default=sys.executable)
    parser.add_argument("--dist", type=Path, default=ROOT / "dist")
    parser.add_argument("--only", choices=("sdist", "wheel"))
    parser.add_argument("--to-publish", action="store_true", help="refuse while the project has no address")
    options = parser.parse_args()
    if options.to_publish and ".invalid/" in address():
        parser.error(
            "Cargo.toml: `repository` is still a placeholder; write the address of the project there"
        )
    # Links in the way would be part of the paths that the compiler writes down.
    with tempfile.TemporaryDirectory() as scratch:
        build(Path(scratch).resolve(), options)


def build(scratch: Path, options: argparse.Namespace) -> None:
    """The source distribution from dressed sources, and the wheel from it."""
    dist: Path = options.dist.resolve()
    sources = exported(scratch / "sources")
    dressed(sources)
    made = scratch / "sdist"
    run("maturin", "sdist", "--out", made, "--manifest-path", sources / "rust/python/Cargo.toml")
    [archive] = made.glob("*.tar.gz")
    dist.mkdir(parents=True, exist_ok=True)
    if options.only != "wheel":
        shutil.copy(archive, dist)
    if options.only == "sdist":
        return
    with tarfile.open(archive) as tar:
        tar.extractall(scratch, filter="data")
    unpacked = scratch / archive.name.removesuffix(".tar.gz")
    interpreter = options.interpreter
    if "musl" in (options.triple or ""):
        # That of this machine is one of glibc: by a name maturin takes what it knows itself.
        interpreter = f"python{sys.version_info[0]}.{sys.version_info[1]}{getattr(sys, 'abiflags', '')}"
    command = [
        "maturin",
        "build",
        "--release",
        "--out",
        scratch / "wheel",
        "--interpreter",
        interpreter,
    ]
    command += ["--manifest-path", unpacked / "rust/python/Cargo.toml"]
    if options.target != NATIVE:
        command += ["--compatibility", options.target, "--zig"]
    if options.triple:
        command += ["--target", options.triple]
    run(*command, **reproducible(unpacked))
    for wheel in (scratch / "wheel").glob("*.whl"):
        without_traces(wheel, dist / wheel.name, str(unpacked))


def exported(folder: Path) -> Path:
    """The files that Git knows, as they are now."""
    names = subprocess.check_output(["git", "ls-files", "-z"], cwd=ROOT, text=True)
    for name in filter(None, names.split("\0")):
        if (ROOT / name).exists():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    return folder


def reproducible(sources: Path) -> dict[str, str]:
    """The environment in which no path and no time of this machine gets into the wheel."""
    cargo = Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo"))
    flags = [f"--remap-path-prefix={sources}=/polhode", f"--remap-path-prefix={cargo}=/cargo"]
    return {
        "CARGO_ENCODED_RUSTFLAGS": "\x1f".join(flags),
        "CARGO_TARGET_DIR": os.environ.get("CARGO_TARGET_DIR", str(ROOT / "target" / "package")),
        "SOURCE_DATE_EPOCH": committed(),
    }


def committed() -> str:
    """When the last commit was made."""
    return subprocess.check_output(["git", "log", "-1", "--format=%ct"], cwd=ROOT, text=True).strip()


def run(*command: str | Path, **environment: str) -> None:
    """Run a command of the environment of this Python."""
    scripts = Path(sys.executable).parent
    words = [str(word) for word in command]
    path = f"{scripts}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "SOURCE_DATE_EPOCH": committed(), **environment}
    print("$", re.sub(r"/\S*/", "", " ".join(words)), flush=True)
    subprocess.run(words, cwd=ROOT, env=environment, check=True)


if __name__ == "__main__":
    main()
