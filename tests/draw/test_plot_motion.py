"""Pictures of bodies and motions: what is drawn, where `ax=` goes, what is refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, euler_angles, loads, solids

pytest.importorskip("matplotlib")

from matplotlib.figure import Figure
from matplotlib.text import Text
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Text3D
from polhode import plot

BODY = RigidBody.from_principal(1.0, (1.0, 1.8, 2.6))
FREE = BODY.free_motion((1.0, 0.2, 0.5))
TIMES = np.linspace(0.0, 20.0, 101)
MOTION = FREE.at(TIMES)
CONE = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0)).translated((0, 0, 0.045))
TOP = CONE.heavy_top((0.0, 0.0, 260.0), euler_angles.to_quaternion((0.0, 0.5, 0.0)), (0.0, 0.0, -9.81))

FLAT: dict[str, Callable[[Any], Any]] = {
    "angular_velocity": lambda ax: plot.angular_velocity(MOTION, ax),
    "angular_momentum": lambda ax: plot.angular_momentum(MOTION, ax, frame="body"),
    "euler_angles": lambda ax: plot.euler_angles(MOTION, ax),
    "invariants": lambda ax: plot.invariants(MOTION, ax),
    "effective_potential": lambda ax: plot.effective_potential(TOP, ax),
}
SOLID: dict[str, Callable[[Any], Any]] = {
    "ellipsoid": lambda ax: plot.ellipsoid(BODY, ax),
    "method": lambda ax: BODY.plot(ax),
    "rod": lambda ax: plot.ellipsoid(RigidBody.from_principal(1.0, (0.0, 1.0, 1.0)), ax),
    "polhodes": lambda ax: plot.polhodes(BODY, ax),
    "symmetric": lambda ax: plot.polhodes(RigidBody.from_principal(1.0, (1.0, 1.0, 1.5)), ax),
    "polhode": lambda ax: plot.polhode(FREE, ax),
    "polhode of a gyrostat": lambda ax: plot.polhode(
        BODY.gyrostat((0.1, 0.9, 0.3)).free_motion((1, 0.2, 0.3)), ax
    ),
    "polhode of a steady gyrostat": lambda ax: plot.polhode(
        BODY.gyrostat((0, 0, 1)).free_motion((0, 0, 1)), ax
    ),
    "poinsot": lambda ax: plot.poinsot(FREE, TIMES, ax),
    "cones": lambda ax: plot.cones(FREE, TIMES, ax),
    "nutation": lambda ax: plot.nutation(TOP, TIMES, ax),
}


@pytest.mark.parametrize("name", [*FLAT, *SOLID])
def test_it_draws_where_it_is_told(name: str) -> None:
    figure = Figure()
    if name in FLAT:
        ax: Any = figure.add_subplot()
        assert FLAT[name](ax) is ax
        assert ax.get_xlabel()
        assert "(" in ax.get_ylabel() or name == "invariants"  # a unit
    else:
        ax = figure.add_subplot(projection="3d", computed_zorder=False)
        assert SOLID[name](ax) is ax
    assert ax.lines
    figure.canvas.draw()


def test_the_momentum_of_a_free_body_is_a_constant_in_space() -> None:
    ax = plot.angular_momentum(MOTION, Figure().add_subplot())
    for line, component in zip(ax.lines, FREE.angular_momentum().spin, strict=True):
        np.testing.assert_allclose(np.asarray(line.get_ydata()), component, rtol=1e-13)


def test_euler_angles_break_where_they_wrap() -> None:
    ax = plot.euler_angles(MOTION, Figure().add_subplot())
    for line in ax.lines:
        steps = np.abs(np.diff(np.asarray(line.get_ydata())))
        assert np.nanmax(steps) < 180.0


def test_the_level_of_a_top_ends_on_its_potential() -> None:
    ax = plot.effective_potential(TOP, Figure().add_subplot())
    ends, level = np.deg2rad(ax.lines[1].get_xdata()), np.asarray(ax.lines[1].get_ydata())
    np.testing.assert_allclose(TOP.effective_potential(ends), level, rtol=1e-12)


PLATE = solids.cylinder(radius=0.12, height=0.002, mass=0.3)
SATELLITE = RigidBody.from_principal(150.0, (20.0, 25.0, 30.0))
CROWDED: dict[str, Callable[[Any], Any]] = {
    "narrow cones": lambda ax: plot.cones(PLATE.free_motion((1.2, 0.0, 12.0)), TIMES[:11], ax),
    "wide cones": lambda ax: plot.cones(FREE, TIMES, ax),
    "a wheel along an axis": lambda ax: plot.portrait(
        SATELLITE.gyrostat((0.0, 1.0, 0.0)).free_motion((0.002, 0.1, 0.002)), ax=ax
    ),
    "a top": lambda ax: plot.nutation(TOP, TIMES[:5], ax),
}


@pytest.mark.parametrize("name", CROWDED)
def test_names_are_not_written_over_each_other(name: str) -> None:
    figure = Figure(figsize=(10.0, 3.8), layout="constrained")
    ax: Any = figure.add_subplot(1, 3, 3, projection="3d", computed_zorder=False)
    CROWDED[name](ax)
    figure.canvas.draw()
    boxes = []
    for text in ax.texts:
        if isinstance(text, Text3D):  # which stands there only while it is drawn
            x, y, _ = proj3d.proj_transform(*text.get_position_3d(), ax.get_proj())
            Text.set_position(text, (x, y))
        boxes.append(text.get_window_extent().padded(-1.0))
    assert len(boxes) >= 3
    for k, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[:k]), ax.texts[k].get_text()


def test_what_cannot_be_drawn_is_told() -> None:
    stack = solids.cube(np.ones(2), mass=1.0)
    for draw in (plot.ellipsoid, plot.polhodes):
        with pytest.raises(ValueError, match=r"one body, got a stack of shape \(2,\)"):
            draw(stack)
    with pytest.raises(ValueError, match="a point has no ellipsoid"):
        plot.ellipsoid(RigidBody.from_principal(1.0, (0.0, 0.0, 0.0)), Figure().add_subplot(projection="3d"))
    with pytest.raises(ValueError, match="energy: -1"):
        plot.polhodes(BODY, energy=-1)
    with pytest.raises(ValueError, match="no end"):
        plot.polhodes(RigidBody.from_principal(1.0, (0.0, 1.0, 1.0)))
    with pytest.raises(ValueError, match="no end"):
        plot.polhode(RigidBody.from_principal(1.0, (0.0, 1.0, 1.0)).free_motion((0.0, 1.0, 0.0)))
    with pytest.raises(ValueError, match="at rest"):
        plot.polhode(BODY.free_motion((0.0, 0.0, 0.0)))
    with pytest.raises(ValueError, match="at rest"):
        plot.cones(BODY.free_motion((0.0, 0.0, 0.0)), TIMES)
    load = loads.torque_callback(lambda *_: np.array([0.1, 0.0, 0.0]))
    with pytest.raises(ValueError, match="keeps neither"):
        plot.invariants(BODY.simulate([0.0, 1.0], (0.0, 0.0, 1.0), load=load))


@pytest.mark.parametrize("motion", [FREE, TOP, BODY.gyrostat((0.0, 0.2, 1.0)).free_motion((0.3, 0.2, 1.1))])
def test_motions_in_closed_form_are_drawn_to_an_end(motion: Any) -> None:
    """Through as many states as the curves need, each as the closed form has it."""
    ax = plot.angular_velocity(motion, Figure().add_subplot(), end=2.0)
    t, drawn = (np.asarray(part) for part in ax.lines[0].get_data())
    assert (t[0], t[-1]) == (0.0, 2.0)
    assert len(t) > 3
    np.testing.assert_allclose(drawn, motion.at(t).omega[:, 0], atol=1e-12)


def test_ends_that_are_missing_or_too_many() -> None:
    ax = Figure().add_subplot()
    with pytest.raises(ValueError, match="end: a motion in closed form has none of its own"):
        plot.angular_velocity(FREE, ax)
    with pytest.raises(ValueError, match="end: a trajectory has its own times"):
        plot.angular_velocity(MOTION, ax, end=2.0)
    many = BODY.free_motion([(1.0, 0.2, 0.5), (0.3, 0.2, 0.1)])
    with pytest.raises(ValueError, match=r"angular_velocity: expected one body, got a stack of shape \(2,\)"):
        plot.angular_velocity(many, ax, end=2.0)


def test_the_polhode_of_a_gyrostat_is_on_its_ellipsoid() -> None:
    motion = BODY.gyrostat((0.1, 0.9, 0.3)).free_motion((1.0, 0.2, 0.3))
    axes = Figure().add_subplot(projection="3d", computed_zorder=False)
    path = np.array(plot.polhode(motion, axes).lines[0].get_data_3d())
    path = path[:, np.isfinite(path[0])]
    assert path.shape[1] > 50
    assert np.allclose((path * (BODY.inertia @ path)).sum(0), 2 * motion.kinetic_energy().total, rtol=1e-12)
