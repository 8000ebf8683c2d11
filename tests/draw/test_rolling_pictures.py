"""Pictures of a body that rolls: plane, body and both traces are where the motion has them."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from browser import Browser, needs_browser
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from moving_pictures import DESK, ON_ITS_SIDE, PHONE, TOLD, inside
from page_data import data
from polhode import RigidBody, loads, plot, rolling, solids
from polhode.animation import scene_of
from polhode.draw.animation.film import Picture
from polhode.draw.ground import surface_shape

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from polhode import Trajectory

G = loads.uniform_gravity((0, 0, -9.81))
LEANING = np.array([0.3, -0.2, 1.0]) / np.sqrt(1.13)
TILTED = (np.sin(0.5), 0.0, 0.0, np.cos(0.5))
SURFACES = [
    rolling.sphere(0.7, center=(0.1, 0, 0.2)),
    rolling.ellipsoid((2.0, 0.5, 0.3), center=(0, 0.1, 0), axes=[[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
    rolling.disk(0.5, axis=(1, 2, 2), center=(0, 0, 0.1)),
    rolling.torus(0.5, 0.1, axis=(0, 1, 0)),
    rolling.paraboloid((1.0, 2.0), 0.4, axes=[[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
]


def coin(t: Any) -> Trajectory:
    contact = rolling.plane(rolling.disk(0.05))
    return solids.cylinder(0.05, 0.0, mass=0.2).simulate(
        t, (0, 2, 14), TILTED, load=G, contact=contact, rtol=1e-13
    )


def ball(t: Any) -> Trajectory:
    contact = rolling.plane(rolling.sphere(0.02), turntable=3.0, point=(0.1, 0, 0), normal=LEANING)
    down = loads.uniform_gravity(-9.81 * LEANING)
    return solids.sphere(0.02, mass=0.03).simulate(t, (0, 9, 0), load=down, contact=contact, rtol=1e-13)


@pytest.mark.parametrize("surface", SURFACES)
def test_the_surface_that_is_drawn_touches_where_the_body_does(surface: rolling.Surface) -> None:
    """Against a plane from any side no vertex is beyond the contact, and one is near it."""
    about = np.array([0.05, -0.02, 0.1])
    shape = surface_shape(surface, about)
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(200, 3))
    if "paraboloid" in repr(surface):
        normals = normals * 0.2 + (0, 0, 1)  # touches within its rim
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    contact = surface.contact(normals) - about
    heights = np.einsum("vi,ni->nv", shape.vertices, normals).min(axis=1)
    lowest = np.einsum("ni,ni->n", contact, normals)
    size = np.ptp(shape.vertices, axis=0).max()
    assert ((heights - lowest) / size > -1e-12).all()
    assert ((heights - lowest) / size).max() < 0.02
    triangles = shape.vertices[shape.faces]
    outward = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    volume = np.einsum("ni,ni->", outward, triangles[:, 0]) / 6
    assert volume > 0.0 or "disk" in repr(surface)


def test_a_page_holds_plane_and_contact(tmp_path: Path) -> None:
    motion: Any = ball(np.linspace(0, 4, 1001))
    found = data(motion.animate(tmp_path / "ball.html"))
    ground = found["ground"]
    np.testing.assert_allclose(ground["normal"], LEANING, atol=1e-15)
    assert (ground["turntable"], ground["middle"]) == (3.0, [0.1, 0, 0])
    for name, known in (("center", motion.position), ("contact", motion.contact.point)):
        packed = np.frombuffer(base64.b64decode(ground[name])).reshape(-1, 3)
        np.testing.assert_array_equal(packed, known)
    assert found["energy"]["potential"] is None
    assert "the plane does work" in found["energy"]["why"]
    free = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0)).free_motion((1, 0, 1)).at([0, 1])
    assert data(free.animate(tmp_path / "free.html"))["ground"] is None


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("rolling")


@pytest.fixture(scope="module")
def browser(folder: Path) -> Iterator[Browser]:
    with Browser(folder) as one:
        yield one


@needs_browser
@pytest.mark.parametrize("make", [coin, ball])
def test_between_the_frames_the_contact_is_that_of_the_motion(
    browser: Browser, folder: Path, make: Any
) -> None:
    page = make(np.linspace(0, 2, 601)).animate(folder / f"{make.__name__}.html")
    browser.screen(*DESK)
    browser.open(page, "#t=1.234567")
    exact: Any = make([0.0, 1.234567])
    place = browser.run(
        "(({ place }) => [place.center, place.contact, place.inBody])(polhode.stateAt(1.234567))"
    )
    size = float(np.linalg.norm(exact.contact.point_in_body[-1]))
    known = [exact.position[-1], exact.contact.point[-1], exact.contact.point_in_body[-1]]
    np.testing.assert_allclose(place, known, atol=2e-3 * size)
    told = browser.run(TOLD)
    assert float(told["friction needed"]) == pytest.approx(exact.contact.friction_needed[-1], rel=0.05)
    words = browser.run("document.getElementById('space-caption').textContent")
    assert ("on the plane and on the body" in words) == (make is coin)
    assert ("the plane turns" in words) == (make is ball)
    assert "T + V" in told if make is coin else "T + V" not in told


@needs_browser
@pytest.mark.parametrize("size", [DESK, PHONE, ON_ITS_SIDE])
def test_both_traces_are_seen(browser: Browser, folder: Path, size: tuple[int, int]) -> None:
    """In the colour of the contact alone, in both views, and gone with their switch."""
    page = coin(np.linspace(0, 2, 601)).animate(folder / "coin.html")
    browser.screen(*size, touch=size == PHONE)
    browser.open(page, "#t=1.2")
    assert inside(browser, "space")
    counted = """((id) => {
      const canvas = document.getElementById(id), pen = canvas.getContext("2d");
      const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
      let found = 0;
      for (let i = 0; i < data.length; i += 4)
        found += Math.hypot(data[i] - 194, data[i + 1] - 65, data[i + 2] - 12) < 40;
      return found / (globalThis.devicePixelRatio || 1) ** 2;
    })"""
    views = ["space"] if size == PHONE else ["space", "second"]
    browser.run("polhode.draw()")  # the browser may not have come to it yet
    shown = [browser.run(f"{counted}('{view}')") for view in views]
    browser.run("document.getElementById('traces').click(); polhode.draw()")
    hidden = [browser.run(f"{counted}('{view}')") for view in views]
    assert min(np.subtract(shown, hidden)) > 150


@needs_browser
def test_nothing_is_in_the_way_of_anyone(browser: Browser, folder: Path) -> None:
    page = coin(np.linspace(0, 2, 601)).animate(folder / "coin.html")
    for dark in (False, True):
        browser.screen(*PHONE, dark=dark, touch=True)
        browser.open(page, "#t=1.2")
        assert browser.serious_faults() == []


def test_a_film_follows_the_body() -> None:
    motion = coin(np.linspace(0, 2, 201))
    scene = scene_of(motion, is_page=False, duration=None, shape=None, title="A coin")
    picture = Picture(scene, (240, 240), has_labels=False)
    pictures = []
    for frame in (20, 180):
        picture.show(frame)
        pictures.append(picture.pixels()[..., :3].astype(float))
        blue = (pictures[-1][..., 2] > pictures[-1][..., 0] + 25).nonzero()
        assert np.abs(np.mean(blue, axis=1) / 240 - 0.5).max() < 0.12  # the body, in the middle
    assert np.abs(pictures[0] - pictures[1]).max() > 50


def test_figures() -> None:
    motion: Any = coin(np.linspace(0, 2, 201))
    ax: Any = plot.contact(motion, Figure().add_subplot())
    np.testing.assert_array_equal(ax.lines[0].get_xydata(), motion.contact.point[:, :2])
    np.testing.assert_array_equal(ax.lines[1].get_xydata(), motion.position[:, :2])
    solid: Any = plot.rolling(motion, Figure().add_subplot(projection="3d"), index=100)
    trace = np.array(solid.lines[0].get_data_3d()).T
    given = motion.contact.point[:101]
    # One scale and one shift: distances keep their ratios.
    ratio = np.linalg.norm(np.diff(trace, axis=0), axis=1) / np.linalg.norm(np.diff(given, axis=0), axis=1)
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-9)
    on_body = np.fmax.reduce([np.array(line.get_data_3d()).T for line in solid.lines[1:3]])
    arms = np.linalg.norm(on_body - on_body.mean(axis=0), axis=1)
    assert np.isfinite(arms).all()  # each point is in one of both parts
    for index in (201, -202):
        with pytest.raises(IndexError, match=rf"index: {index} is none of the 201 times"):
            plot.rolling(motion, index=index)
    for wrong, words in (
        (RigidBody.from_principal(1.0, (1.0, 2.0, 3.0)).simulate([0, 1], (1, 0, 0)), "rolls on nothing"),
        (
            solids.sphere(1, mass=1).simulate(
                [0, 1], np.eye(3), load=G, contact=rolling.plane(rolling.sphere(1))
            ),
            "got a stack of shape",
        ),
    ):
        with pytest.raises(ValueError, match=words):
            plot.contact(wrong)


def test_the_plane_does_not_cover_the_body() -> None:
    """In axes of one's own too, made without any option."""
    figure = Figure(figsize=(4, 4), dpi=100)
    canvas: Any = FigureCanvasAgg(figure)
    plot.rolling(jumper(np.linspace(0, 1.5, 301)), figure.add_subplot(projection="3d"), index=220)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].astype(int)
    assert (pixels[..., 2] > pixels[..., 0] + 25).sum() > 200


def test_a_body_that_has_left_the_plane_is_drawn_up_to_there() -> None:
    body = RigidBody.from_principal(1.0, (0.09, 0.09, 0.09), center_of_mass=(0, 0, 0.9))
    motion: Any = body.simulate(
        np.linspace(0, 3, 61), (0.5, 0, 0), load=G, contact=rolling.plane(rolling.sphere(1.0))
    )
    assert motion.status == "lift-off"
    ax: Any = plot.contact(motion, Figure().add_subplot())
    assert np.isfinite(ax.lines[0].get_xydata()).all()
    plot.rolling(motion, Figure().add_subplot(projection="3d"))


def jumper(t: Any) -> Trajectory:
    """A smooth eccentric ball: it leaves the plane at 0.514 s, and lands at 1.535 s."""
    body = RigidBody.from_principal(1.0, (0.09, 0.09, 0.09), center_of_mass=(0, 0, 0.9))
    contact = rolling.plane(rolling.sphere(1.0), law="sliding", friction=0.0, lift="fly")
    attitude = (np.sin(0.6), 0.0, 0.0, np.cos(0.6))
    return body.simulate(t, (5, 0.3, 0), attitude, load=G, contact=contact, rtol=1e-12)


def test_in_flight_nothing_is_traced() -> None:
    """The plane stays where it is, and the body is above it."""
    motion: Any = jumper(np.linspace(0, 1.5, 301))
    flies = motion.contact.phase == "flying"
    assert 150 < np.count_nonzero(flies) < 250
    ax: Any = plot.contact(motion, Figure().add_subplot())
    np.testing.assert_array_equal(np.isnan(ax.lines[0].get_xydata()[:, 0]), flies)
    solid: Any = plot.rolling(motion, Figure().add_subplot(projection="3d"), index=200)
    trace, *on_body = (np.array(line.get_data_3d())[0] for line in solid.lines)
    assert np.isnan(trace[flies[:201]]).all()
    assert all(np.isnan(one[flies[:201]]).all() for one in on_body)
    assert len(on_body) == 2  # no dot where nothing touches


@needs_browser
def test_in_flight_the_page_has_no_contact(browser: Browser, folder: Path) -> None:
    page = jumper(np.linspace(0, 1.5, 301)).animate(folder / "jumper.html")
    browser.screen(*DESK)
    exact: Any = jumper([0.0, 0.3, 1.0])
    for time, touches, row in ((0.3, True, 1), (1.0, False, 2)):
        browser.open(page, f"#t={time}")
        place = browser.run(f"(({{ place }}) => [place.touches, place.contact])(polhode.stateAt({time}))")
        assert place[0] is touches
        np.testing.assert_allclose(place[1], exact.contact.point[row], atol=2e-3)
        friction = browser.run(TOLD)["friction needed"]
        assert (friction == "none, in flight") != touches


@pytest.mark.parametrize(
    ("given", "works"),
    [
        ({}, False),
        ({"law": "dry", "friction": 3.0}, False),  # it rolls all the way
        ({"law": "dry", "friction": 0.01}, True),
        ({"law": "sliding", "friction": 0.0}, False),
        ({"law": "sliding", "viscous": 0.1}, True),
        ({"resistance": rolling.resistance(viscous=1e-3)}, True),
        ({"turntable": 1.0}, True),
    ],
)
def test_the_plane_is_said_to_work_where_it_does(given: dict[str, Any], works: bool, tmp_path: Path) -> None:
    velocity = (1.0, 0.5, 0.0) if given.get("friction") == 0.01 or given.get("law") == "sliding" else None
    contact = rolling.plane(rolling.sphere(0.5), **given)
    motion = solids.sphere(0.5, mass=1.0).simulate(
        np.linspace(0, 1, 101), (0.3, 1.0, 0.2), load=G, contact=contact, velocity=velocity
    )
    assert motion.contact is not None
    assert bool(np.abs(motion.contact.work).max() > 1e-12) == works
    energy = data(motion.animate(tmp_path / "a.html"))["energy"]
    assert ("the plane does work" in energy["why"]) == works
