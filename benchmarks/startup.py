"""Fresh interpreters: what importing polhode costs beside importing NumPy."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

from harness import Row

if TYPE_CHECKING:
    from collections.abc import Iterator


def rows() -> Iterator[Row]:
    """Yield the comparisons of this file."""

    def run(statement: str) -> int:
        return subprocess.run([sys.executable, "-c", statement], check=True).returncode

    def same(ours: int, theirs: int) -> None:
        assert ours == theirs

    yield Row(
        name="import in a fresh interpreter",
        peer="import numpy",
        ours=lambda: run("from polhode import RigidBody"),
        theirs=lambda: run("import numpy"),
        compare=same,
        at_most=1.3,
    )
