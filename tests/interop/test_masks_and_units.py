"""Masks and units are never dropped: pictures and motions refuse what has them, and name the argument."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import molecules, plot, solids

BOX = solids.box((3.0, 2.0, 1.0), mass=1.0)
MOTION = BOX.free_motion((0.1, 1.0, 0.2))
FALL = BOX.simulate([0.0, 1.0], (0.1, 1.0, 0.2), about="origin")
TOP = solids.cylinder(1.0, 2.0, mass=1.0).translated((0.0, 0.0, 1.0))
TIMES = np.linspace(0.0, 1.0, 5)
CENTER = np.array([0.1, 0.2, 0.3])
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])

CALLS: dict[str, tuple[Any, Callable[[Any], object]]] = {
    "plot.body: vertices": (CORNERS, lambda value: plot.body(value, FACES)),
    "plot.body: faces": (FACES, lambda value: plot.body(CORNERS, value)),
    "plot.ellipsoid: center": (CENTER, lambda value: plot.ellipsoid(BOX, center=value)),
    "plot.poinsot: t": (TIMES, lambda value: plot.poinsot(MOTION, value)),
    "plot.cones: t": (
        TIMES,
        lambda value: plot.cones(solids.cylinder(1, 3, mass=1).free_motion((0.1, 0, 1)), value),
    ),
    "plot.nutation: t": (
        TIMES,
        lambda value: plot.nutation(TOP.heavy_top((0, 0.1, 9), (0.6, 0, 0, 0.8), (0, 0, -9.81)), value),
    ),
    "animate: shape": (CORNERS, lambda value: MOTION.at(TIMES).animate("never.html", shape=(value, FACES))),
    "Trajectory.point: r": (CENTER, MOTION.at(TIMES).point),
    "pivot_reaction: force": (CENTER, lambda value: FALL.pivot_reaction(force=value)),
    "resume: t": (TIMES + 1.0, FALL.resume),
    "ray_kappa: constants": (np.array([3.0, 2.0, 1.0]), molecules.ray_kappa),
    "planar_moments: moments": (np.array([1.0, 2.0, 2.5]), molecules.planar_moments),
}


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", CALLS)
def test_a_mask_and_a_unit_are_told(name: str, tmp_path: Path) -> None:
    good, call = CALLS[name]
    argument = name.partition(": ")[2]
    mask = np.zeros(np.shape(good), dtype=bool)
    mask[-1] = True
    with pytest.raises(ValueError, match=f"{argument}: .*is masked"):
        call(np.ma.masked_array(good, mask))
    quantity = pytest.importorskip("pint").UnitRegistry().Quantity(good, "second")
    with pytest.raises(TypeError, match=f"{argument}: .*would lose its unit"):
        call(quantity)
    assert list(tmp_path.iterdir()) == []
    call(np.ma.masked_array(good, False))  # nothing of it is masked
    pytest.importorskip("matplotlib.pyplot").close("all")
