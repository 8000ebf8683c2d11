"""Pictures at any size: nothing runs out of the figure, axes have units, and the words are true."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from polhode import (
    RigidBody,
    Trajectory,
    animation,
    assembly,
    euler_angles,
    flybys,
    loads,
    orbits,
    plot,
    rolling,
    samples,
    solids,
    view,
)
from polhode.uncertainty.ledgers import Ledger, ledger
from scipy.spatial import ConvexHull

pytest.importorskip("matplotlib")

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Wedge
from matplotlib.text import Text
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Text3D

SIZES = (
    (4.0, 3.0),
    pytest.param((6.4, 4.8), marks=pytest.mark.long),
    pytest.param((10.0, 6.0), marks=pytest.mark.long),
)
TURN = 360.0

BODY = RigidBody.from_principal(1.0, (1.0, 1.8, 2.6))
UNCERTAIN: Any = solids.box((1.0, 2.0, 3.0), mass=2.0).with_sigma(inertia=np.full((3, 3), 0.01))
FREE = BODY.free_motion((1.0, 0.2, 0.5))
TIMES = np.linspace(0.0, 20.0, 101)
MOTION = FREE.at(TIMES)
RACKET = solids.box((3.0, 2.0, 1.0), mass=1.0)
CONE = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0)).translated((0, 0, 0.045))
TOP = CONE.heavy_top((0.0, 0.0, 260.0), euler_angles.to_quaternion((0.0, 0.5, 0.0)), (0.0, 0.0, -9.81))
GYROSTAT = BODY.gyrostat((0.25, 0.2, 0.3))
CORNERS = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)])


def faces_of(corners: np.ndarray) -> np.ndarray:
    hull = ConvexHull(corners)
    faces: np.ndarray = np.array(hull.simplices)
    a, b, c = np.moveaxis(corners[faces], 1, 0)
    is_inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces[is_inward] = faces[is_inward, ::-1]
    return faces


@cache
def passed() -> flybys.Flyby:
    far = orbits.from_elements(3.986e14, eccentricity=4.25, periapsis=3.72e7, since_periapsis=-2.6e5)
    body = RigidBody.from_principal(1.0, (0.61, 0.96, 1.0))
    periods: Any = {"rotation_period": 9.5e5, "precession_period": 9.9e4, "mode": "long-axis"}
    return flybys.flyby(body, far, 5.2e5, n=100, **periods)


@cache
def rover() -> assembly.Assembly:
    return assembly.read(samples.path("rover.toml"))


@cache
def rolled() -> Any:
    contact = rolling.plane(rolling.disk(0.05))
    coin, tilted = solids.cylinder(0.05, 0.0, mass=0.2), (0.5, 0.0, 0.0, 0.8660254)
    weight = loads.uniform_gravity((0, 0, -9.81))
    return coin.simulate(np.linspace(0, 1, 101), (0, 2, 14), tilted, load=weight, contact=contact)


def craft() -> Ledger:
    return ledger(samples.path("craft.csv"))


FLAT: dict[str, Callable[[Any], Any]] = {
    "angular_velocity": lambda ax: plot.angular_velocity(UNCERTAIN.free_motion((1, 0.2, 0.5)).at(TIMES), ax),
    "angular_momentum": lambda ax: plot.angular_momentum(MOTION, ax, frame="body"),
    "euler_angles": lambda ax: plot.euler_angles(MOTION, ax),
    "invariants": lambda ax: plot.invariants(MOTION, ax),
    "effective_potential": lambda ax: plot.effective_potential(TOP, ax),
    "contact": lambda ax: plot.contact(rolled(), ax),
    "flyby": lambda ax: plot.flyby(passed(), "spin_ratio", ax),
    "flyby, pole": lambda ax: plot.flyby(passed(), "pole_shift", ax),
    "flyby, period": lambda ax: plot.flyby(passed(), "rotation_period", ax, time_label="h", time_scale=3600),
    "variances": lambda ax: craft().plot(ax, of="variance"),
    "masses": lambda ax: craft().plot(ax),
    "masses of an assembly": lambda ax: rover().ledger.plot(ax, mass_label="kg"),
}
SOLID: dict[str, Callable[[Any], Any]] = {
    "ellipsoid": lambda ax: plot.ellipsoid(UNCERTAIN, ax, enlarged=5.0),
    "polhodes": lambda ax: plot.polhodes(BODY, ax),
    "polhode": lambda ax: plot.polhode(FREE, ax),
    "poinsot": lambda ax: plot.poinsot(FREE, TIMES, ax),
    "cones": lambda ax: plot.cones(FREE, TIMES, ax),
    "nutation": lambda ax: plot.nutation(TOP, TIMES[:11], ax),
    "rolling": lambda ax: plot.rolling(rolled(), ax),
    "portrait": lambda ax: plot.portrait(GYROSTAT, 2.0, ax),
    "body": lambda ax: plot.body(CORNERS, faces_of(CORNERS), ax, length_label="m"),
    "principal_axes": lambda ax: plot.principal_axes(
        BODY, plot.body(CORNERS, faces_of(CORNERS), ax), length=1.5
    ),
    "assembly": lambda ax: rover().plot(ax, length_label="m"),
}
WITHOUT_UNIT = {"clones", "relative change since the start", "spin rate, after / before", ""}


def test_every_function_is_looked_at() -> None:
    functions = {name for name in plot.__all__ if callable(getattr(plot, name))}
    assert functions - {*FLAT, *SOLID} == {"portraits"}


def made(name: str, size: tuple[float, float] = (6.4, 4.8), dpi: float = 72.0) -> Any:
    figure = Figure(figsize=size, dpi=dpi, layout="constrained")
    FigureCanvasAgg(figure)
    if name in FLAT:
        FLAT[name](figure.add_subplot())
    else:
        SOLID[name](figure.add_subplot(projection="3d", computed_zorder=False))
    return figure


def drawn(name: str, size: tuple[float, float]) -> Any:
    figure = made(name, size)
    figure.draw_without_rendering()
    return figure


def texts(figure: Any) -> list[tuple[str, Any]]:
    """Texts that are seen, with their boxes in pixels."""
    found = []
    ticks = {
        id(label)
        for ax in figure.axes
        for axis in ax._axis_map.values()
        for label in (*axis.get_ticklabels(), axis.offsetText)
    }
    for text in figure.findobj(Text):
        if not text.get_visible() or not text.get_text() or id(text) in ticks:
            continue
        owner = text.axes
        if (
            owner is not None
            and not owner.axison
            and text in (owner.xaxis.label, owner.yaxis.label, owner.title)
        ):
            continue
        if isinstance(text, Text3D):  # which stands there only while it is drawn
            x, y, _ = proj3d.proj_transform(*text.get_position_3d(), owner.get_proj())
            Text.set_position(text, (x, y))
        found.append((text.get_text(), text.get_window_extent()))
    return found


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", [*FLAT, *SOLID])
def test_every_text_is_within_the_figure(name: str, size: tuple[float, float]) -> None:
    figure = drawn(name, size)
    seen = texts(figure)
    assert seen
    for words, box in seen:
        x0, y0, x1, y1 = box.extents
        assert min(x0, y0) >= -1.0, words
        assert x1 <= figure.bbox.width + 1.0, words
        assert y1 <= figure.bbox.height + 1.0, words


@pytest.mark.parametrize("factors", [(0.5,), None])
def test_a_row_of_portraits_is_within_its_figure(factors: Any) -> None:
    figure: Any = plot.portraits(GYROSTAT, 2.0, factors)[0].figure
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    for words, box in texts(figure):
        x0, y0, x1, y1 = box.extents
        assert min(x0, y0) >= -1.0, words
        assert x1 <= figure.bbox.width + 1.0, words
        assert y1 <= figure.bbox.height + 1.0, words


@pytest.mark.usefixtures("without_surfaces")
@pytest.mark.parametrize("name", [*FLAT, *SOLID])
def test_axes_that_are_shown_have_units(name: str) -> None:
    for ax in made(name).axes:
        if ax.axison:
            for axis in ax._axis_map.values():
                words = axis.label.get_text()
                assert "(" in words or words in WITHOUT_UNIT, words
                assert words or name == "variances"  # where the names of parts stand


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["masses", "masses of an assembly"])
def test_names_stand_within_their_wedges(name: str, size: tuple[float, float]) -> None:
    figure = drawn(name, size)
    (ax,) = figure.axes
    names = [text for text in ax.texts if text.get_position() != (0.0, 0.0)]
    wedges: list[Any] = [patch for patch in ax.patches if isinstance(patch, Wedge)]
    assert len(names) >= 0.5 * len(wedges)
    for text in names:
        x, y = text.get_position()
        radius, angle = np.hypot(x, y), np.rad2deg(np.arctan2(y, x))
        (wedge,) = [
            one
            for one in wedges
            if one.r - one.width < radius < one.r and (angle - one.theta1) % TURN < one.theta2 - one.theta1
        ]
        turn = text.get_rotation()
        text.set_rotation(0.0)
        box = text.get_window_extent()
        text.set_rotation(turn)
        half = 0.5 * np.array([box.width, box.height])
        cosine, sine = np.cos(np.deg2rad(turn)), np.sin(np.deg2rad(turn))
        for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1)):
            across, up = half * signs
            away = np.array([cosine * across - sine * up, sine * across + cosine * up])
            corner = ax.transData.transform((x, y)) + away
            px, py = ax.transData.inverted().transform(corner)
            assert wedge.r - wedge.width <= np.hypot(px, py) <= wedge.r, text.get_text()
            turned = (np.rad2deg(np.arctan2(py, px)) - wedge.theta1) % TURN
            assert turned <= wedge.theta2 - wedge.theta1, text.get_text()
    (center,) = [text for text in ax.texts if text.get_position() == (0.0, 0.0)]
    assert ("kg" in center.get_text()) == ("assembly" in name)
    box = center.get_window_extent()
    corner = ax.transData.inverted().transform(box.max) - ax.transData.inverted().transform(box.min)
    assert np.hypot(*corner) <= 2.0
    assert ax.get_title() == ""


def lines_of(ax: Any) -> list[tuple[np.ndarray, np.ndarray]]:
    return [
        (np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)) for line in ax.lines[:3]
    ]


@pytest.mark.parametrize("sequence", ["ZXZ", "ZYX", "xyz"])
@pytest.mark.parametrize("seed", range(4))
def test_angles_go_to_the_edge_of_their_turn(sequence: str, seed: int) -> None:
    """Where a curve breaks it ends on one edge and goes on from the other one, at the same time."""
    rng = np.random.default_rng(seed)
    run = BODY.free_motion(rng.normal(size=3)).at(np.linspace(0.0, 20.0, 301))
    ax = plot.euler_angles(run, Figure().add_subplot(), sequence=sequence)
    angles = np.rad2deg(run.euler_angles(sequence, "nan"))
    for i, (t, values) in enumerate(lines_of(ax)):
        gaps = np.flatnonzero(np.isnan(values) & np.isin(t, t[:-1][np.diff(t) == 0.0]))
        for k in gaps:
            assert t[k - 1] == t[k] == t[k + 1]
            assert abs(values[k - 1] - values[k + 1]) == TURN
        kept = np.ones(len(t), bool)
        kept[(gaps[:, np.newaxis] + [-1, 0, 1]).ravel()] = False
        np.testing.assert_array_equal(t[kept], run.t)
        off = (values[kept] - angles[:, i]) / TURN
        np.testing.assert_allclose(off, np.round(off), atol=1e-12)


def test_angles_about_half_a_turn_are_not_broken() -> None:
    """A first angle that goes to and fro about 180 degrees is one curve, from 0 to 360."""
    t = np.linspace(0.0, 20.0, 401)
    angles = np.stack([np.pi + 0.1 * np.sin(3.0 * t), np.full_like(t, 1.0), 0.2 * np.cos(t)], axis=-1)
    turned = {"quaternion": euler_angles.to_quaternion(angles)}
    run = Trajectory(**{**vars(BODY.free_motion((1.0, 0.0, 0.0)).at(t)), **turned})
    ax = plot.euler_angles(run, Figure().add_subplot())
    first, _, third = lines_of(ax)
    assert np.isfinite(first[1]).all()
    np.testing.assert_allclose(first[1], np.rad2deg(angles[:, 0]), atol=1e-10)
    np.testing.assert_allclose(third[1], np.rad2deg(angles[:, 2]), atol=1e-10)


def test_rounding_is_told_from_drift() -> None:
    times = np.linspace(0.0, 50.0, 201)
    tight = RACKET.simulate(times, (0.3, 1.0, 0.2))
    loose = RACKET.simulate(times, (0.3, 1.0, 0.2), method="dop853", rtol=1e-6)
    for run, is_rounding in ((tight, True), (loose, False)):
        ax: Any = plot.invariants(run, Figure().add_subplot())
        assert ("rounding" in ax.get_legend().get_title().get_text()) == is_rounding
        assert ax.get_ylim()[1] >= 1e-12
        changes = np.concatenate([np.asarray(line.get_ydata()) for line in ax.lines])
        assert (changes.max() <= 64.0 * np.finfo(float).eps) == is_rounding
        assert "rounding of float64" in [text.get_text() for text in ax.get_legend().get_texts()]


def test_tails_of_a_flyby_are_counted() -> None:
    ax: Any = plot.flyby(passed(), "rotation_period", Figure().add_subplot())
    values = passed().after.rotation_period
    known = values[np.isfinite(values)]
    low, high = (float(x) for x in (ax.containers[0][0].get_x(), ax.containers[0][-1].get_x()))
    width = float(ax.containers[0][0].get_width())
    below, above = int((known < low).sum()), int((known > high + width).sum())
    assert below > 0 < above
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert f"and beyond: {below} below, {above} above" in words
    hatched = [patch for patch in ax.patches if isinstance(patch, Patch) and patch.get_hatch()]
    heights = sorted(patch.get_height() for patch in hatched)  # type: ignore[attr-defined]
    assert heights == sorted([(known < low + width).sum(), (known >= high).sum()])


def pixels(opacity: float, dpi: float) -> np.ndarray:
    figure = Figure(figsize=(3.0, 3.0), dpi=dpi)
    canvas: Any = FigureCanvasAgg(figure)
    ax: Any = figure.add_subplot(projection="3d", computed_zorder=False)
    from polhode.draw.plot.axes import plain_frame, solid_ellipsoid

    solid_ellipsoid(ax, np.ones(3), np.eye(3), np.zeros(3), opacity)
    plain_frame(ax, 3 * [-1.1], 3 * [1.1])
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(float)


@pytest.mark.parametrize("dpi", [60.0, 100.0])
@pytest.mark.parametrize("opacity", [0.3, 0.8])
def test_a_translucent_surface_is_the_opaque_one_mixed_with_what_is_behind(
    opacity: float, dpi: float
) -> None:
    """Pixel by pixel, so that no grid is seen where its pieces meet."""
    opaque = pixels(1.0, dpi)
    assert (opaque < 255.0).any()
    mixed = opacity * opaque + (1.0 - opacity) * 255.0
    assert np.abs(pixels(opacity, dpi) - mixed).max() <= 3.0


LABELS: dict[str, Callable[..., Any]] = {
    "time_label": lambda **word: plot.angular_velocity(MOTION, Figure().add_subplot(), **word),
    "energy_label": lambda **word: plot.effective_potential(TOP, Figure().add_subplot(), **word),
    "momentum_label": lambda **word: plot.angular_momentum(MOTION, Figure().add_subplot(), **word),
    "rate_label": lambda **word: plot.polhode(FREE, Figure().add_subplot(projection="3d"), **word),
    "length_label": lambda **word: plot.body(
        CORNERS, faces_of(CORNERS), Figure().add_subplot(projection="3d"), **word
    ),
}


@pytest.mark.parametrize("name", LABELS)
def test_a_label_is_shown_and_changes_no_number(name: str) -> None:
    plain, named = LABELS[name](), LABELS[name](**{name: "furlong"})
    words = [text.get_text() for text in named.figure.findobj(Text)]
    assert any("furlong" in text for text in words)
    for one, other in zip(plain.lines, named.lines, strict=True):
        np.testing.assert_array_equal(one.get_data(), other.get_data())
    former = {"momentum_label": "unit"}.get(name, name.replace("label", "unit"))
    with pytest.raises(TypeError, match=f"'{former}'; write {name}=, .* converts no number"):
        LABELS[name](**{former: "furlong"})


def test_former_names_of_labels_are_refused_everywhere(tmp_path: Any) -> None:
    run: Any = MOTION
    calls: list[Callable[[], object]] = [
        lambda: run.animate(tmp_path / "a.html", time_unit="h"),
        lambda: run.show(time_unit="h"),
        lambda: animation.animate(FREE, tmp_path / "a.html", end=1.0, time_unit="h"),  # type: ignore[call-arg]
        lambda: plot.euler_angles(run, time_unit="h"),  # type: ignore[call-arg]
        lambda: plot.invariants(run, time_unit="h"),  # type: ignore[call-arg]
        lambda: plot.flyby(passed(), time_unit="h"),  # type: ignore[call-arg]
        lambda: plot.poinsot(FREE, TIMES, rate_unit="h"),  # type: ignore[call-arg]
        lambda: plot.polhodes(BODY, rate_unit="h"),  # type: ignore[call-arg]
        lambda: rover().plot(length_unit="h"),
        lambda: view.motion(run, time_unit="h"),  # type: ignore[call-arg]
    ]
    for call in calls:
        with pytest.raises(TypeError, match=r"write \w+_label="):
            call()
    assert not (tmp_path / "a.html").exists()


def test_no_picture_takes_a_unit_that_converts_nothing() -> None:
    functions = [getattr(module, name) for module in (plot, view, animation) for name in module.__all__]
    for function in [*functions, Ledger.plot, assembly.Assembly.plot, Trajectory.plot, Trajectory.show]:
        if callable(function):
            names = inspect.signature(function).parameters
            assert not [name for name in names if name == "unit" or name.endswith("_unit")], function
