"""Run the tests of a source distribution with the wheel beside it: ``python packaging/try_tests.py dist``.

The archive is unpacked where nothing lies beside it. Each Python of this machine from 3.11 on gets an
environment of its own with the wheel, as a stranger would: no checkout, no compiler, no data of others.
``--other`` leaves out the Python that runs this, ``--mine`` all others; ``--quick`` takes the newest of them
and a share of the tests that needs little and lasts seconds. What stands after ``--`` goes to pytest.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

LEAST = (3, 11)
#: What the quick share imports besides the package.
NEEDS = ["hypothesis", "mpmath", "pytest", "pytest-timeout", "pytest-xdist", "scipy"]
#: Files of the quick share: each class of the extension is made, and bodies move.
QUICK = [
    "house/reprs", "loads/loads", "mass/laminae", "mass/rods", "mass/solids", "motion/euler_angles",
    "motion/simulate",
]  # fmt: skip
#: What all tests import, the site and the tests of mutants among them.
GROUPS = ["test", "docs", "mutants"]
#: How `make docs` makes the site, whose pages are tested too.
SITE = ["-m", "sphinx", "--builder", "html", "--fail-on-warning", "--quiet", "docs", "docs/_build/html"]
ASKED = "import sys; print(*sys.version_info[:2], getattr(sys, 'abiflags', ''), sys.executable)"


def main() -> None:
    """Try every Python that is asked for."""
    own, passed_on = divided(sys.argv[1:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("dist", type=Path)
    parser.add_argument("--python", action="append", metavar="PATH", help="this one; may be said again")
    parser.add_argument(
        "--other", action="store_true", help="those of this machine but the one that runs this"
    )
    parser.add_argument("--mine", action="store_true", help="the Python that runs this, alone")
    parser.add_argument("--quick", action="store_true", help="a share of the tests")
    options = parser.parse_args(own)
    files = [sorted(options.dist.resolve().glob(kind)) for kind in ("*.tar.gz", "*-abi3-*.whl")]
    if [len(kind) for kind in files] != [1, 1]:
        parser.error(f"{options.dist}: expected one source distribution and one wheel of abi3 beside it")
    [[archive], [wheel]] = files
    pythons = options.python or ([sys.executable] if options.mine else None)
    if pythons is None:
        versions = found()
        wanted = [version for version in versions if not options.other or version != mine()]
        wanted.sort(key=lambda version: int(version.partition(".")[2]))
        pythons = [versions[version] for version in (wanted[-1:] if options.quick else wanted)]
    if not pythons:
        print(f"no other Python from {LEAST[0]}.{LEAST[1]} on is here: the workflow of a release tries them")
    failed = [python for python in pythons if not passes(archive, wheel, python, options.quick, passed_on)]
    if failed:
        sys.exit(f"tests failed with {', '.join(failed)}")


def divided(words: list[str]) -> tuple[list[str], list[str]]:
    """What stands before ``--`` and after it."""
    at = words.index("--") if "--" in words else len(words)
    return words[:at], words[at + 1 :]


def mine() -> str:
    """The version of the Python that runs this."""
    return f"{sys.version_info[0]}.{sys.version_info[1]}{getattr(sys, 'abiflags', '')}"


def found() -> dict[str, str]:
    """The Pythons of this machine that the wheel is for, one of each version; also those of pyenv."""
    root = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    names = [f"python3.{minor}" for minor in range(LEAST[1], 30)]
    paths = [
        sys.executable,
        *filter(None, map(shutil.which, names)),
        *sorted(root.glob("versions/3.*/bin/python")),
    ]
    pythons: dict[str, str] = {}
    for path in paths:
        # What is on the search path may be a stub that finds nothing.
        told = subprocess.run([path, "-c", ASKED], check=False, capture_output=True, text=True)
        if told.returncode:
            continue
        major, minor, flags, executable = told.stdout.rstrip("\n").split(" ", 3)
        # Without the GIL it takes a wheel of its own.
        if (int(major), int(minor)) >= LEAST and "t" not in flags:
            pythons.setdefault(f"{major}.{minor}", executable)
    return pythons


def passes(archive: Path, wheel: Path, python: str, quick: bool, words: list[str]) -> bool:
    """Whether the tests pass with this Python."""
    with tempfile.TemporaryDirectory() as folder:
        room = Path(folder).resolve()
        with tarfile.open(archive) as tar:
            tar.extractall(room, filter="data")
        sources = room / archive.name.removesuffix(".tar.gz")
        own = prepared(room, sources, wheel, python, quick)
        command = [own, *tests(quick), *words]
        alone = {
            key: value for key, value in os.environ.items() if not key.startswith(("POLHODE_", "PYTHON"))
        }
        return subprocess.run(command, cwd=sources, env=alone, check=False).returncode == 0


def prepared(room: Path, sources: Path, wheel: Path, python: str, quick: bool) -> Path:
    """The Python of an environment with the wheel and what the tests need."""
    subprocess.run([python, "-m", "venv", room / "venv"], check=True)
    own = room / "venv" / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    pip = [own, "-m", "pip", "install", "--quiet", "--no-compile"]
    subprocess.run([*pip, "--upgrade", "pip>=25.1"], check=True)
    if quick:
        subprocess.run([*pip, wheel, *NEEDS], check=True)
    else:
        groups = [f"{sources / 'pyproject.toml'}:{name}" for name in GROUPS]
        subprocess.run([*pip, f"{wheel}[all]", *(f"--group={group}" for group in groups)], check=True)
        subprocess.run([own, "tests/optional.py"], cwd=sources, check=True)
        subprocess.run([own, *SITE], cwd=sources, check=True)
    told = "import sys, polhode; print('polhode', polhode.__version__, 'on', sys.version)"
    subprocess.run([own, "-c", told], cwd=room, check=True)
    return own


def test_file(name: str) -> str:
    """The path of a file of tests by its room and subject, as ``mass/solids``."""
    return f"tests/{name.replace('/', '/test_')}.py"


def tests(quick: bool) -> list[str]:
    """What Python is asked to run: all tests but those that take minutes or measure time, or a share."""
    files = [test_file(name) for name in QUICK] if quick else []
    marks = ["-m", "not long and not alone"]
    return ["-m", "pytest", "--quiet", *marks, "--numprocesses", "auto", "--dist", "loadfile", *files]


if __name__ == "__main__":
    main()
