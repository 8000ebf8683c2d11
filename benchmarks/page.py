"""What a drawing of the moving page costs: ``python benchmarks/page.py`` in the environment of the tests.

Prints the median and the 95th percentile of the time that a draw takes, for bodies of so many triangles.
A page redraws both of its views; at sixty pictures a second it may take 16 ms.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

from browser import BROWSER, Browser
from polhode import solids

DRAWS = 400
TIMED = f"""(() => {{
  const taken = [];
  for (let k = 0; k < {DRAWS}; k++) {{
    const begun = performance.now();
    polhode.show(20 * k / {DRAWS});
    taken.push(performance.now() - begun);
  }}
  return taken;
}})()"""


def ball(triangles: int) -> tuple[np.ndarray, np.ndarray]:
    """A mesh with about so many triangles, and unlike lengths."""
    across = round(np.sqrt(triangles / 2.0))
    polar, around = np.linspace(0.0, np.pi, across + 1), np.linspace(0.0, 2.0 * np.pi, across + 1)
    p, a = np.meshgrid(polar, around, indexing="ij")
    corners = np.stack([3.0 * np.sin(p) * np.cos(a), 2.0 * np.sin(p) * np.sin(a), np.cos(p)], axis=-1)
    index = np.arange((across + 1) ** 2).reshape(across + 1, across + 1)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    return corners.reshape(-1, 3), np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def main() -> None:
    """Time the draws, in a browser without a screen."""
    if BROWSER is None:
        raise SystemExit("no Chromium: apt install chromium")
    motion = solids.ellipsoid((3.0, 2.0, 1.0), mass=1.0).free_motion((0.02, 6.0, 0.0)).at([0.0, 20.0])
    with tempfile.TemporaryDirectory() as folder, Browser(Path(folder)) as browser:
        browser.screen(1200, 820)
        print(f"{'triangles':>9} {'drawn':>7} {'median':>8} {'95 %':>8}   ms a draw")
        for triangles in (12, 1000, 5000, 10_000):
            page = motion.animate(Path(folder) / "page.html", shape=ball(triangles))
            browser.open(page, "#t=0")
            browser.run(TIMED)  # once to warm up
            taken = np.array(browser.run(TIMED))
            count = browser.run("polhode.motion.solid.count")
            print(f"{triangles:9d} {count:7d} {np.median(taken):8.2f} {np.percentile(taken, 95):8.2f}")


if __name__ == "__main__":
    main()
