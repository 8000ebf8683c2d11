"""Pictures: what is drawn is what was computed, where the caller asked for it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
import pytest
from oracles.meshes import cube, icosphere
from polhode import RigidBody, Trajectory, plot

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(autouse=True)
def _no_figure_left_open() -> Iterator[None]:
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def trajectory() -> Trajectory:
    body = RigidBody(1.0, [[2.0, 0.3, 0.0], [0.3, 1.0, 0.1], [0.0, 0.1, 2.5]])
    return body.simulate(np.linspace(0.0, 5.0, 40), [0.1, 0.2, 3.0])


@pytest.fixture(scope="module")
def stack() -> Trajectory:
    body = RigidBody(np.ones(3), np.tile(np.diag([1.0, 2.0, 2.5]), (3, 1, 1)))
    return body.simulate(np.linspace(0.0, 5.0, 40), [[0.1, 2.0, 0.1], [0.1, 2.1, 0.1], [0.1, 2.2, 0.1]])


def test_components_over_time(trajectory: Trajectory) -> None:
    ax: Any = trajectory.plot()
    lines = ax.get_lines()
    assert len(lines) == 3
    for i, line in enumerate(lines):
        np.testing.assert_array_equal(line.get_xdata(), trajectory.t)
        np.testing.assert_array_equal(line.get_ydata(), trajectory.omega[:, i])
        assert to_hex(line.get_color()).upper() == plot.AXIS_COLORS[i]
    assert ax.get_xlabel() == "time (s)"
    assert ax.get_ylabel() == "angular velocity (rad/s)"
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [rf"$\omega_{c}$" for c in "xyz"]


def test_components_along_principal_axes_in_degrees_per_hour(trajectory: Trajectory) -> None:
    ax: Any = plot.angular_velocity(trajectory, frame="principal", degrees=True, time_label="h")
    expected = np.rad2deg(trajectory.omega @ trajectory.body.principal.axes)
    for i, line in enumerate(ax.get_lines()):
        np.testing.assert_allclose(line.get_ydata(), expected[:, i], rtol=1e-13, atol=1e-12)
    assert ax.get_ylabel() == "angular velocity (deg/h)"


def test_ax_is_used_and_returned(trajectory: Trajectory) -> None:
    ax = Figure().add_subplot()
    assert trajectory.plot(ax) is ax
    assert plt.get_fignums() == []  # no other figure was made


def test_stack_draws_every_body_and_names_the_components_once(stack: Trajectory) -> None:
    ax: Any = plot.angular_velocity(stack, frame="principal")
    assert len(ax.get_lines()) == 9
    assert len(ax.get_legend().get_texts()) == 3


def test_unknown_frame(trajectory: Trajectory) -> None:
    with pytest.raises(ValueError, match="'space' is not 'body' or 'principal'"):
        plot.angular_velocity(trajectory, frame="space")  # type: ignore[arg-type]


def test_body_and_axes(tmp_path: Path) -> None:
    vertices, faces = cube(2.0)
    body = RigidBody.from_mesh(vertices * [1, 2, 3], faces, density=1.0)
    ax: Any = plot.body(vertices * [1, 2, 3], faces, length_label="m")
    assert plot.principal_axes(body, ax, length=4.0) is ax
    assert ax.get_xlabel() == "x (m)"
    assert {text.get_text() for text in ax.texts} == {"$e_1$", "$e_2$", "$e_3$"}
    # The moments ascend as the extents descend: e1 is along z, in the first colour.
    first = ax.get_lines()[0]
    assert to_hex(first.get_color()).upper() == plot.AXIS_COLORS[0]
    np.testing.assert_allclose(np.array(first.get_data_3d())[:, 1], [0, 0, 4.0], atol=1e-12)
    path = tmp_path / "body.png"
    ax.figure.savefig(path)
    pixels = plt.imread(path)
    assert len(np.unique(pixels.reshape(-1, 4), axis=0)) > 50  # shaded faces, edges, axes and text


def test_outline_follows_sharp_edges_only() -> None:
    ax: Any = plot.body(*cube(2.0))
    ball: Any = plot.body(*icosphere(3))
    outlines = [_outline_pieces(axes.collections[0]) for axes in (ax, ball)]
    assert outlines[0] > 0
    assert outlines[0] % 12 == 0  # the edges of a cube
    assert outlines[1] == 0


def _outline_pieces(collection: Any) -> int:
    return int((collection.get_facecolor()[:, :3] == plot.OUTLINE_COLOR).all(axis=1).sum())


def test_body_without_extent_is_drawn() -> None:
    plot.body(np.zeros((3, 3)), [[0, 1, 2]])


def test_without_matplotlib_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] in ("matplotlib", "mpl_toolkits")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "mpl_toolkits", None)
    with pytest.raises(ModuleNotFoundError, match=r'pip install "polhode\[plot\]"'):
        plot.body(*cube())
