"""The portrait of a gyrostat: what is marked is what was found, and every curve keeps its energy."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
import pytest
from oracles.gyrostat_equilibria import equilibria, folds
from polhode import RigidBody, plot

mpl.use("Agg")
from matplotlib import pyplot as plt

pytestmark = pytest.mark.usefixtures("without_surfaces")

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

MOMENTS = (1.0, 1.8, 2.6)
INSIDE = (0.25, 0.2, 0.3)


@pytest.fixture(autouse=True)
def _no_figure_left_open() -> Iterator[None]:
    yield
    plt.close("all")


class Gyrostat:
    """What a portrait asks of a gyrostat, from the roots of a polynomial."""

    shape = ()
    inertia = np.diag(MOMENTS)

    def __init__(self, momentum: Sequence[float]) -> None:
        self.momentum = np.array(momentum)
        self.body = SimpleNamespace(gyrostat=Gyrostat)

    def equilibria(self, momentum: float) -> Any:
        directions, kinds = [], []
        for mu, n, _, squared in equilibria(MOMENTS, self.momentum.tolist(), momentum):
            direction = np.array([float(x) for x in n])
            across = np.diag(1 / np.array(MOMENTS) - float(mu))
            trace = np.trace(across) - direction @ across @ direction
            directions.append(direction)
            kinds.append("saddle" if squared < 0 else "minimum" if trace > 0 else "maximum")
        size = float(np.linalg.norm(self.momentum))
        rotor = [size * momentum / float(x) for x in folds(MOMENTS, self.momentum.tolist())]
        return SimpleNamespace(
            direction=np.array(directions),
            kind=kinds,
            circle=np.zeros((len(kinds), 3)),
            bifurcations=SimpleNamespace(rotor=rotor),
        )


def test_marks_and_curves() -> None:
    gyrostat: Any = Gyrostat(INSIDE)
    ax: Any = plot.portrait(gyrostat, 2.0)
    found = gyrostat.equilibria(2.0)
    lines = [np.array(line.get_data_3d()).T for line in ax.get_lines()]
    marks = [line[0] for line in lines if len(line) == 1]
    for direction in found.direction:
        assert min(np.linalg.norm(mark - direction) for mark in marks) < 0.01
    assert {text.get_text() for text in ax.get_legend().get_texts()} == {
        "stable: least energy",
        "stable: most energy",
        "unstable",
    }
    curves = [line[np.isfinite(line[:, 0])] for line in lines if len(line) > 2]
    assert len(curves) > 20
    for curve in curves:
        if not len(curve):
            continue
        np.testing.assert_allclose(np.linalg.norm(curve, axis=1), 1.0, rtol=1e-14)
        energy = (curve - np.array(INSIDE) / 2.0) ** 2 @ (1 / np.array(MOMENTS))
        assert np.ptp(energy) < 2e-4


def test_a_circle_of_equilibria_is_drawn() -> None:
    # Moments 1, 1, 2 and h = (0, 0, 0.2): L₃ = −h on the circle, of most energy.
    n = np.array([np.sqrt(1 - 0.01), 0.0, -0.1])
    none = np.zeros(3)
    found = SimpleNamespace(
        direction=np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], n]),
        kind=["minimum", "minimum", "maximum"],
        circle=np.array([none, none, [0.0, 0.0, 1.0]]),
    )
    gyrostat: Any = type("Gyrostat", (SimpleNamespace,), {})(
        shape=(), inertia=np.diag([1.0, 1.0, 2.0]), momentum=np.array([0, 0, 0.2]), equilibria=lambda _: found
    )
    ax: Any = plot.portrait(gyrostat, 2.0)
    thick = [np.array(line.get_data_3d()).T for line in ax.get_lines() if line.get_linewidth() == 2.4]
    heights = [line[:, 2] for line in thick if len(line) == 181]
    assert heights
    np.testing.assert_allclose(heights[0][np.isfinite(heights[0])], -0.1, rtol=1e-14)


def test_a_row_has_one_for_each_number_of_equilibria() -> None:
    gyrostat: Any = Gyrostat(INSIDE)
    row = plot.portraits(gyrostat, 2.0)
    words = [ax.texts[-1].get_text() for ax in row]
    assert [word.split(": ")[1] for word in words] == ["6 equilibria", "4 equilibria", "2 equilibria"]
    assert len(plot.portraits(gyrostat, 2.0, (0.5, 1.0))) == 2


@pytest.mark.parametrize(
    ("inside", "omega"),
    [
        (INSIDE, (0.3, 0.2, 0.7)),
        (INSIDE, (1.5, 0.3, 0.1)),
        ((0.0, 0.0, 0.0), (0.3, 0.5, 0.7)),
        ((0.0, 0.6, 0.0), (0.0, 1.0, 0.0)),
    ],
)
def test_a_motion_draws_its_own_path(inside: tuple[float, ...], omega: tuple[float, ...]) -> None:
    motion = RigidBody.from_principal(1.0, MOMENTS).gyrostat(inside).free_motion(omega)
    ax: Any = plot.portrait(motion)
    total = np.array(MOMENTS) * omega + inside
    start = total / np.linalg.norm(total)
    black = [np.array(line.get_data_3d()).T for line in ax.get_lines() if line.get_color() == "#111111"]
    (mark,) = (line[0] for line in black if len(line) == 1)
    np.testing.assert_allclose(mark, 1.005 * start, rtol=1e-12)
    paths = [line for line in black if len(line) > 1]
    assert len(paths) == (0 if motion.mode == "steady" else 2)  # near and far
    for path in paths:
        shown = path[np.isfinite(path[:, 0])] / 1.002
        np.testing.assert_allclose(np.linalg.norm(shown, axis=1), 1.0, rtol=1e-12)
        of_start, *of_path = (
            ((n * np.linalg.norm(total) - inside) ** 2 / MOMENTS).sum() for n in (start, *shown)
        )
        np.testing.assert_allclose(of_path, of_start, rtol=1e-12)
    if paths:
        assert sum(np.isfinite(path[:, 0]).sum() for path in paths) >= 1441  # all the way round


def test_what_a_motion_and_a_gyrostat_need() -> None:
    gyrostat = RigidBody.from_principal(1.0, MOMENTS).gyrostat(INSIDE)
    with pytest.raises(ValueError, match="momentum: say how long"):
        plot.portrait(gyrostat)
    with pytest.raises(ValueError, match=r"momentum: the motion has its own; leave 2 out"):
        plot.portrait(gyrostat.free_motion((1.0, 0.0, 0.0)), 2.0)
    still = gyrostat.body.gyrostat((0.5, 0.0, 0.0)).free_motion((-0.5, 0.0, 0.0))
    with pytest.raises(ValueError, match="is zero; it has no direction"):
        plot.portrait(still)


def test_what_cannot_be_drawn() -> None:
    gyrostat: Any = Gyrostat(INSIDE)
    for momentum in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="momentum"):
            plot.portrait(gyrostat, momentum)
    still: Any = Gyrostat((0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="no momentum inside"):
        plot.portraits(still, 2.0)
