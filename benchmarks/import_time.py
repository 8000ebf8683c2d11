"""Time of ``import polhode`` beside ``import numpy``, each in a fresh interpreter, in interleaved rounds."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time

ROUNDS = 15


def seconds(statement: str) -> float:
    """Wall time of an interpreter that executes one statement."""
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", statement], check=True)
    return time.perf_counter() - start


def main() -> None:
    statements = ("pass", "import numpy", "import polhode")
    for statement in statements:  # fill the file cache
        seconds(statement)
    rounds = [[seconds(statement) for statement in statements] for _ in range(ROUNDS)]
    for statement, times in zip(statements, zip(*rounds, strict=True), strict=True):
        low, middle, high = min(times), statistics.median(times), max(times)
        print(f"{statement:15} {middle * 1e3:6.1f} ms  ({low * 1e3:.1f} to {high * 1e3:.1f})")
    ratios = sorted((polhode - bare) / (numpy - bare) for bare, numpy, polhode in rounds)
    print(
        "import polhode / import numpy, the interpreter's own start taken off: "
        f"{statistics.median(ratios):.2f}"
        f"  ({ratios[0]:.2f} to {ratios[-1]:.2f})"
    )


if __name__ == "__main__":
    main()
