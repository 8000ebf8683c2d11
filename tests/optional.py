"""What some tests need besides the test group, into this environment: ``python tests/optional.py``.

Windows are tested where VTK can be had and draws, CAD files where OCCT can be had, whether pages can be read
by ear and by keys with axe-core, which a package carries. Together they are 200 MB that users do not need.
What cannot be had here is said; its tests are skipped.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass


@dataclass(frozen=True)
class Library:
    """What is installed, and a program that tells whether it works."""

    requirement: str
    name: str
    program: str
    untested: str
    #: Whether what it asks for is left out: it works without.
    alone: bool = False


LIBRARIES = (
    Library(
        "pyvista>=0.44",
        "pyvista",
        "import pyvista; pyvista.Plotter(off_screen=True).screenshot(return_img=True)",
        "no windows can be drawn here",
    ),
    Library(
        "cadquery-ocp-novtk>=8",
        "cadquery-ocp-novtk",
        "import OCP.BRep",
        "no CAD files can be read here",
        alone=True,
    ),
    Library(
        "axe-playwright-python",
        "axe-playwright-python",
        "import importlib.metadata as m; m.version('axe-playwright-python')",
        "axe-core cannot be had here",
        alone=True,
    ),
)


def install(library: Library) -> bool:
    """Install it; away with it where it does not work."""
    pip = [sys.executable, "-m", "pip"]
    words = ["--no-deps"] if library.alone else []
    commands = (
        [*pip, "install", "--quiet", "--no-compile", *words, library.requirement],
        [sys.executable, "-c", library.program],
    )
    if all(subprocess.run(command, check=False, capture_output=True).returncode == 0 for command in commands):
        return True
    subprocess.run([*pip, "uninstall", "--quiet", "--yes", library.name], check=False, capture_output=True)
    return False


def main() -> None:
    """Install all of them."""
    for library in LIBRARIES:
        if not install(library):
            print(f"{library.untested}: its tests are skipped", flush=True)


if __name__ == "__main__":
    main()
