"""Links whose meshes are files of CAD: their solids, and what is told without the extra that reads them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from cad_files import primitive, write_step
from polhode import robots
from robot_texts import link, urdf


def judged(folder: Path, inertia: float | tuple[float, float, float], scale: str = "1 1 1") -> robots.Verdict:
    shape = f'<mesh filename="ball.step" scale="{scale}"/>'
    text = urdf(link("a", 3.0, inertia, shape))
    (verdict,) = robots.check(robots.parse_robot(text.encode(), name="r", folder=folder))
    return verdict


@pytest.mark.usefixtures("occt_here")
@pytest.mark.parametrize(("scale", "factor"), [("1 1 1", 1.0), ("2 2 2", 2.0)])
def test_a_ball_of_step(scale: str, factor: float, tmp_path: Path) -> None:
    """A ball of radius 50 mm, whatever unit the file has, and one that is scaled."""
    write_step(primitive("Sphere", 50.0)(), tmp_path / "ball.step")
    expected = 0.4 * 3.0 * (0.05 * factor) ** 2
    verdict = judged(tmp_path, expected, scale)
    assert (verdict.verdict, verdict.notes) == ("good", ())
    assert verdict.shape_moments is not None
    np.testing.assert_allclose(verdict.shape_moments, expected, rtol=1e-9)
    assert judged(tmp_path, 10.0 * expected, scale).verdict == "suspect"


@pytest.mark.usefixtures("occt_here")
def test_a_scale_that_bends(tmp_path: Path) -> None:
    write_step(primitive("Sphere", 50.0)(), tmp_path / "ball.step")
    verdict = judged(tmp_path, 0.003, "1 1 2")
    assert any("solids of CAD are scaled alike along all axes" in note for note in verdict.notes)


def test_without_the_extra_the_line_that_installs_it_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "ball.step").write_text("ISO-10303-21;\n")
    monkeypatch.setattr("polhode.io.cad_geometry.find_spec", lambda _: None)
    monkeypatch.setitem(sys.modules, "OCP", None)
    verdict = judged(tmp_path, 0.003)
    assert any('pip install "polhode[cad]"' in note for note in verdict.notes)
