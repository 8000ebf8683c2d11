"""Every script in examples/ runs, draws its figure and prints what theory says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
PRINTED = {
    "apophis": [r"before: 0\.[67]\d to 1\.[34]\d", r"short-axis: 9\d % after"],
    "asteroid": [r"rotation 5\.4100 d, precession 7\.3500 d", r"relative change [0-9]e-1[5-7]|0e\+00"],
    "edge_mill": [r"11688\.000 N, by hand 11688\.000 N"],
    "gravity_gradient": [r"theory: 4218\.4 s", r"from 2°: 42(19|20)\.\d s"],
    "lagrange_top": [r"cusp: nutates between 30\.0000°"],
    "molecule": [r"H2O: A 820\.71, B 437\.28, C 285\.28 GHz"],
    "parallel_axis": [r"0\.166667 kg m², by hand 0\.166667", r"at 0\.28[89] m; radius of gyration 0\.289 m"],
    "spacecraft": [r"empty: 497\.0 kg"],
    "tennis_racket": [r"every 1\.737951 s", r"simulated: 1\.737951 s"],
}


def test_every_script_has_its_row() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(PRINTED)


@pytest.mark.parametrize("name", PRINTED)
def test_it_runs_and_draws(name: str, tmp_path: Path) -> None:
    picture = pytest.importorskip("matplotlib.image")
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), "figure.png"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    for pattern in PRINTED[name]:
        assert re.search(pattern, done.stdout), done.stdout
    pixels = np.asarray(picture.imread(tmp_path / "figure.png"))
    assert pixels.shape[1] >= 800
    assert (pixels[..., :3].min(axis=-1) < 0.9).mean() > 0.005
