"""Try a wheel with the oldest versions that it admits: ``python packaging/try_lowest.py dist``.

Each extra gets the oldest versions of what it names, in one environment with all others that may stand
together; the tests of the rooms that use them follow. A bound that fails is raised. Needs uv, which alone
resolves so.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Large downloads, and what needs a screen; their bounds are those of the versions they were written with.
LARGE = {"view", "cad"}
TOOLS = ["hypothesis", "jsonschema", "mpmath", "pytest>=9", "pytest-timeout", "pyyaml"]
#: Tests of the rooms that use what the extras bring.
TESTS = [
    "tests/symbolic", "tests/molecules", "tests/uncertainty", "tests/io", "tests/draw",
    "tests/robots/test_sarif.py", "tests/cli/test_cli.py", "tests/cli/test_amounts.py",
    "tests/cli/test_command_help.py", "tests/cli/test_demo.py",
]  # fmt: skip
#: Tests beside other engines and chemists' programs, which no extra brings.
OTHERS = ["--ignore=tests/molecules/test_molecule_peers.py", "--ignore=tests/io/test_files.py"]


def main() -> None:
    """Make the environment, and run the tests in it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("dist", type=Path)
    options = parser.parse_args()
    wheels = sorted(options.dist.resolve().glob("*-abi3-*.whl"))
    if len(wheels) != 1:
        parser.error(f"{options.dist}: expected one wheel of abi3, found {len(wheels)}")
    with tempfile.TemporaryDirectory() as scratch:
        python = environment(Path(scratch), wheels[0])
        # From a folder with the tests alone: the package comes from the wheel.
        subprocess.run([python, "-m", "pytest", "-q", "-W", "ignore", *OTHERS, *TESTS], cwd=ROOT, check=True)


def extras() -> list[str]:
    """Every extra that is tried, in the order of the project."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    return [name for name in project["optional-dependencies"] if name not in LARGE]


def environment(scratch: Path, wheel: Path) -> Path:
    """An environment with the wheel, the oldest versions of what its extras name, and tools for tests."""
    home = scratch / "lowest"
    python = home / ("Scripts" if os.name == "nt" else "bin") / "python"
    subprocess.run(["uv", "venv", "--quiet", home], check=True)
    install = ["uv", "pip", "install", "--quiet", "--python", python]
    needed = f"polhode[{','.join(extras())}] @ {wheel.as_uri()}"
    subprocess.run([*install, "--resolution", "lowest-direct", needed], check=True)
    subprocess.run([*install, *TOOLS], check=True)
    subprocess.run(["uv", "pip", "list", "--python", python], check=True)
    return python


if __name__ == "__main__":
    main()
