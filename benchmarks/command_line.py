"""The command line in fresh interpreters, beside the imports that it cannot do without."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from harness import Row
from meshes import write_stl

if TYPE_CHECKING:
    from collections.abc import Iterator

HELP_NEEDS = "import cyclopts, rich"
REPORT_NEEDS = "import cyclopts, rich.console, rich.text, numpy, polhode._core"


def torus(around: int, across: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh of 2 x around x across triangles."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    phi, psi = 2 * np.pi * u / around, 2 * np.pi * v / across
    r = 3.0 + np.cos(psi)
    vertices = np.stack([r * np.cos(phi), r * np.sin(phi), np.sin(psi)], axis=-1).reshape(-1, 3)

    def corner(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        return (i % around) * across + j % across

    a, b, c, d = corner(u, v), corner(u + 1, v), corner(u + 1, v + 1), corner(u, v + 1)
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]).reshape(-1, 3)
    return vertices, faces


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""

    def run(*arguments: str) -> int:
        done = subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
        return done.returncode

    def same(ours: int, theirs: int) -> None:
        assert ours == theirs

    yield Row(
        name="polhode --help",
        peer=HELP_NEEDS,
        ours=lambda: run("-m", "polhode", "--help"),
        theirs=lambda: run("-c", HELP_NEEDS),
        compare=same,
        at_most=1.2,
    )
    with tempfile.TemporaryDirectory() as folder:
        part = Path(folder, "part.stl")
        write_stl(part, *torus(100, 50))
        report = ("-m", "polhode", "report", str(part), "--length-unit", "mm", "--density", "2700")
        yield Row(
            name="polhode report, 10 000 triangles",
            peer="the bare imports",
            ours=lambda: run(*report),
            theirs=lambda: run("-c", REPORT_NEEDS),
            compare=same,
            at_most=1.5,
        )
