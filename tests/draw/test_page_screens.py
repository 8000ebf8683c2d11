"""The page on screens of each size: controls in view, no word cut, fingers, and who wants no motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from browser import Browser, needs_browser
from moving_pictures import BRICK, CONE, DESK, ON_ITS_SIDE, PHONE, START, inside, middle
from polhode import RigidBody, euler_angles
from polhode.animation import animate_motion

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = needs_browser

SELECT = """(() => {
  const box = document.getElementById("speed"), style = getComputedStyle(box);
  const pen = document.createElement("canvas").getContext("2d");
  pen.font = style.font;
  const mark = 28; // at the end of the box
  return [box.clientWidth, pen.measureText(box.selectedOptions[0].textContent).width + mark];
})()"""
CUT = """[...document.querySelectorAll("main *")].filter((e) => {
  const box = e.getBoundingClientRect();
  return box.width && (box.right > document.documentElement.clientWidth || box.left < 0);
}).map((e) => e.outerHTML)"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("screens")


@pytest.fixture(scope="module")
def page(folder: Path) -> Path:
    return BRICK.free_motion(START).at([0.0, 20.0]).animate(folder / "brick.html", title="A brick")


@pytest.fixture(scope="module")
def top(folder: Path) -> Path:
    motion = CONE.heavy_top((0.0, 0.0, 260.0), euler_angles.to_quaternion((0.0, 0.5, 0.0)), (0.0, 0.0, -9.81))
    animate_motion(motion, 2.0, folder / "top.html", title="A top")
    return folder / "top.html"


@pytest.fixture(scope="module")
def browser(folder: Path) -> Iterator[Browser]:
    with Browser(folder) as one:
        yield one


@pytest.mark.parametrize("size", [DESK, PHONE, ON_ITS_SIDE])
def test_all_controls_are_in_view(browser: Browser, page: Path, size: tuple[int, int]) -> None:
    browser.screen(*size, touch=size == PHONE)
    browser.open(page, "#t=3")
    for name in ("play", "slider", "clock", "speed", "reset", "full", "space"):
        assert inside(browser, name), name
    assert browser.run("document.documentElement.scrollWidth <= innerWidth")
    x, y = (int(part) for part in middle(browser, "space"))
    assert (np.ptp(browser.picture()[y - 20 : y + 20, x - 30 : x + 30], axis=-1) > 25).mean() > 0.8


@pytest.mark.parametrize("size", [DESK, PHONE, ON_ITS_SIDE])
def test_no_word_is_cut(browser: Browser, folder: Path, top: Path, size: tuple[int, int]) -> None:
    """The longest words of time, speed and ω: those of a molecule, and of a top in slow motion."""
    water = RigidBody.from_particles([16.0, 1.0, 1.0], [(0, 0, 0), (0.757, 0, 0.587), (-0.757, 0, 0.587)])
    molecule = water.free_motion((1e11, 5e12, 0.0)).at([0.0, 2e-11]).animate(folder / "water.html")
    browser.screen(*size, touch=size == PHONE)
    for one in (top, molecule):
        browser.open(one, "#t=3")
        browser.run("document.getElementById('share').open = true")
        wide, needed = browser.run(SELECT)
        assert wide >= needed
        assert browser.run(CUT) == []
        for name in ("play", "slider", "clock", "speed", "reset", "full", "space"):
            assert inside(browser, name), name


def test_one_view_at_a_time_on_a_phone(browser: Browser, page: Path) -> None:
    browser.screen(*PHONE, touch=True)
    browser.open(page, "#t=3")
    for name in ("body", "poinsot", "space"):
        browser.run(f"document.querySelector('button[data-view={name}]').click()")
        assert inside(browser, "space") == (name == "space")
        assert inside(browser, "second") == (name != "space")
        pressed = browser.run("document.querySelector('#tabs [aria-pressed=true]').dataset.view")
        assert pressed == name


def test_a_swipe_scrolls_and_two_fingers_bring_nearer(browser: Browser, page: Path) -> None:
    browser.screen(*PHONE, touch=True)
    browser.open(page, "#t=3")
    x, y = middle(browser, "space")
    before = browser.run("[polhode.views.space.azimuth, polhode.views.space.elevation]")
    browser.touch("touchStart", (x, y + 100))
    for k in range(12):
        browser.touch("touchMove", (x + k, y + 100 - 20 * k))
    browser.touch("touchEnd")
    assert browser.run("scrollY") > 60
    assert browser.run("polhode.views.space.elevation") == before[1]
    browser.run("scrollTo(0, 0)")
    zoom = browser.run("polhode.views.space.zoom")
    browser.touch("touchStart", (x - 30, y), (x + 30, y))
    for far in (45, 60):
        browser.touch("touchMove", (x - far, y), (x + far, y))
    browser.touch("touchEnd")
    assert browser.run("polhode.views.space.zoom") == pytest.approx(2.0 * zoom, rel=0.2)


def test_who_wants_no_motion_gets_none(browser: Browser, page: Path) -> None:
    browser.screen(*DESK, still=True)
    browser.open(page)
    assert browser.run("polhode.playing") is False
    assert browser.run("document.getElementById('play').textContent") == "Play"


@pytest.mark.parametrize("size", [DESK, PHONE])
@pytest.mark.parametrize("dark", [False, True])
def test_nothing_is_in_the_way_of_anyone(
    browser: Browser, page: Path, size: tuple[int, int], dark: bool
) -> None:
    """The rules of axe-core find nothing serious."""
    browser.screen(*size, dark=dark, touch=size == PHONE)
    browser.open(page, "#t=3")
    browser.run("document.getElementById('share').open = true")
    assert browser.serious_faults() == []
