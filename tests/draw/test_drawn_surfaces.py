"""What is drawn beside a motion is true: its path has the energy and the |L| of the surface that is named."""

from __future__ import annotations

import base64
import json
import re
from itertools import combinations
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
import pytest
from browser import Browser, needs_browser
from polhode import FreeMotion, GyrostatMotion, RigidBody, loads, plot
from polhode.animation import page_of
from random_motions import KINDS, Motion, motion

mpl.use("Agg")
from matplotlib import pyplot as plt

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

ROUNDING = 3e-7
"""Of vectors that a page holds in four bytes, beside the largest of them."""
RESOLVED = 1e-6
"""Curvatures of the energy below this, beside the largest possible, are those of equal moments or a fold."""
COLOR_WORDS = r"\b(dark|light|black|white|gr[ae]y|blue|green|red|pink|purple|orange|brown|yellow|vermilion)\b"
SIZES = ((390, 844), (800, 700), (1440, 900))

DRAWN = """(items) => items.map(({ surface, moments, along, fastest }) => {
  const ellipsoid = new polhode.Ellipsoid(moments, along, fastest);
  const shows = { omega: fastest > 0 }, plain = (html) => html.replace(/<[^>]*>/g, "");
  const drawn = polhode.drawnWith(surface, ellipsoid), isShown = drawn === "ellipsoid";
  const angles = [0, 1, 2.5, 4], parts = [-1, -0.9, -0.3, 0, 0.5, 1];
  return {
    drawn, ends: ellipsoid.ends, isCut: ellipsoid.isCut,
    points: isShown ? parts.flatMap((part) => angles.map((angle) => ellipsoid.point(part, angle))) : [],
    separatrix: isShown ? ellipsoid.separatrix() : [],
    captions: [false, true].map((rolls) => plain(polhode.captionOf({ surface, ellipsoid, shows }, rolls))),
  };
})"""


class Shown:
    """What a page holds of a motion, and the path from it: ω and L in the body at its frames."""

    def __init__(self, text: str) -> None:
        found = re.search(r'<script type="application/json" id="motion">(.*?)</script>', text)
        assert found
        self.data: dict[str, Any] = json.loads(found[1])
        self.surface: dict[str, Any] = self.data["surface"]
        self.moments, self.axes = np.array(self.data["moments"]), np.array(self.data["axes"])
        self.omega = self._vectors(self.data["omega"], self.data["omega_unit"])
        self.along = self.omega @ self.axes.T
        self.spin = self.along * self.moments @ self.axes
        self.fastest = float(np.linalg.norm(self.omega, axis=1).max())
        self.greatest = self.fastest * float(self.moments[2])
        self.momentum = self.spin
        if self.data["inside"] is not None:
            inside = self._vectors(self.data["inside"], self.data["inside_unit"])
            self.momentum = self.spin + inside
            self.greatest += float(np.abs(inside).max())

    def _vectors(self, text: str, unit: float) -> np.ndarray:
        return numbers(text) * unit

    def of_page(self) -> dict[str, Any]:
        """What the page's own functions are asked with."""
        start = self.data["free"]
        along = start["omega"] if start else self.along[0].tolist()
        surface = self.surface | {
            "marks": [mark | {"curve": bool(mark["curve"])} for mark in self.surface["marks"]]
        }
        return {
            "surface": surface,
            "moments": self.data["moments"],
            "along": along,
            "fastest": self.fastest,
        }


def numbers(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype="<f4").reshape(-1, 3).astype(float)


def constant(values: np.ndarray, size: float) -> bool:
    """Whether values, or vectors, are so but for the rounding of numbers of a size."""
    return bool(np.ptp(values, axis=0).max() <= ROUNDING * size)


def shown(one: Motion) -> Shown:
    return Shown(page_of(one.motion, one.end)[0])


def check_data(one: Motion, page: Shown) -> None:
    """The kind that the page has of a motion is that which its numbers obey, and that which was made."""
    surface = page.surface
    assert surface["kind"] == one.kind
    np.testing.assert_allclose(
        (page.axes.T * page.moments) @ page.axes, tensor_at_reference(one), atol=1e-9 * page.moments[2]
    )
    size = np.linalg.norm(page.momentum, axis=1)
    if surface["kind"] == "free":
        assert constant((page.omega * page.spin).sum(axis=1), page.fastest * page.greatest)
        assert constant(size, page.greatest)
    if surface["momentum"] is not None:
        off = size - np.linalg.norm(surface["momentum"])
        assert np.abs(off).max() <= ROUNDING * page.greatest
    if surface["kind"] == "gyrostat":
        check_gyrostat(one, page)
    else:
        assert (surface["marks"], surface["level"]) == ([], None)
    if surface["kind"] == "loaded":
        assert surface["momentum"] is None


def tensor_at_reference(one: Motion) -> np.ndarray:
    body = one.motion.body
    about = getattr(one.motion, "about", None)
    if about is None:
        about = np.zeros(3) if one.kind == "loaded" else body.center_of_mass
    tensor: np.ndarray = body.inertia_about(about)
    return tensor


def check_gyrostat(one: Motion, page: Shown) -> None:
    """Energies of the path, the marks and the separatrices, in the body's own numbers; and what is stable."""
    surface, inverse, h = page.surface, np.linalg.inv(one.tensor), one.rotor
    assert h is not None
    size = float(np.linalg.norm(surface["momentum"]))
    units = size**2 / np.abs(one.tensor).max()

    def level(n: np.ndarray) -> Any:
        off = n * size - h
        return 0.5 * np.einsum("...i,ij,...j", off, inverse, off) / units

    marks = surface["marks"]
    scale = max([surface["level"], *(mark["level"] for mark in marks)])
    of_path = 0.5 * np.einsum("...i,ij,...j", page.omega, one.tensor, page.omega) / units
    np.testing.assert_allclose(
        of_path, surface["level"], rtol=0, atol=ROUNDING * page.fastest * page.greatest / units
    )
    np.testing.assert_allclose(
        page.momentum - page.omega @ one.tensor,
        np.tile(h, (len(of_path), 1)),
        rtol=0,
        atol=ROUNDING * page.greatest,
    )
    index = 0
    for mark in marks:
        n = np.array(mark["direction"])
        assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-12)
        assert mark["level"] == pytest.approx(level(n), abs=1e-9 * scale)
        rate = inverse @ (n * size - h)
        stiff = np.linalg.eigvalsh(inverse) * size
        assert np.linalg.norm(np.cross(rate, n)) < 1e-6 * max(np.linalg.norm(rate), stiff.max())
        across = np.linalg.svd(n[np.newaxis])[2][1:]
        curvature = np.linalg.eigvalsh(across @ (inverse * size - (rate @ n) * np.eye(3)) @ across.T)
        if mark["circle"] is None and np.abs(curvature).min() > RESOLVED * stiff.max():
            wanted = {2: "minimum", 1: "saddle", 0: "maximum"}[int((curvature > 0.0).sum())]
            assert mark["kind"] == wanted
            assert (mark["curve"] is not None) == (wanted == "saddle")
        if mark["curve"] is not None:
            curve = numbers(mark["curve"])
            np.testing.assert_allclose(np.linalg.norm(curve, axis=1), 1.0, atol=1e-6)
            sensitive = np.abs(rate).max() * size / units + ROUNDING
            np.testing.assert_allclose(level(curve), mark["level"], atol=1e-5 * (scale + sensitive))
            assert np.linalg.norm(curve - n, axis=1).min() < 0.05
        index += {"minimum": 1, "maximum": 1, "saddle": -1}.get(mark["kind"], 0)
    if all(mark["circle"] is None and mark["kind"] != "degenerate" for mark in marks):
        assert index == 2  # as many extrema more than saddles as on every sphere


def check_words(page: Shown, drawn: dict[str, Any]) -> None:
    """The words of the page's own functions, and the surface and the separatrix that they give."""
    surface, moments = page.surface, page.moments
    caption, rolling = drawn["captions"]
    assert not re.search(COLOR_WORDS, caption + rolling)
    size = np.linalg.norm(page.momentum, axis=1)
    doubled = (page.along**2 * moments).sum(axis=1)
    if "ellipsoid of inertia" in caption:
        assert constant(doubled, page.fastest * page.greatest)
        assert constant(size, page.greatest)
        assert (np.abs(page.along[:, 0]) <= drawn["ends"][0] * (1.0 + 1e-6)).all()  # no path beyond the cut
        points = np.array(drawn["points"])
        np.testing.assert_allclose((points**2 * moments).sum(axis=1), doubled[0], rtol=1e-6)
        for curve in np.array(drawn["separatrix"]).reshape(-1, 145, 3):
            np.testing.assert_allclose((curve**2 * moments).sum(axis=1), doubled[0], rtol=1e-6)
            np.testing.assert_allclose(
                (curve**2 * moments**2).sum(axis=1), doubled[0] * moments[1], rtol=1e-6
            )
        assert ("cut off" in caption) == drawn["isCut"]
        assert ("rod" in caption) == (moments[0] == 0.0)
    assert ("polhode" in caption) == ("ellipsoid of inertia" in caption)
    assert ("polhode is a point" not in caption) or constant(page.omega, page.fastest)
    if "sphere of constant |L|" in caption:
        assert constant(size, page.greatest)
    assert ("curve of constant ½ ω·Iω" in caption) == (surface["level"] is not None)
    curves = drawn["separatrix"] or [mark for mark in surface["marks"] if mark["curve"]]
    assert ("separatri" in caption) == bool(curves)
    if "unstable" in caption:
        assert any(mark["kind"] == "saddle" for mark in surface["marks"])
    if surface["kind"] == "loaded":
        assert not re.search("polhode|sphere|separatri|ellipsoid of", caption)


def check_many(browser: Browser, pages: list[Shown]) -> None:
    for first in range(0, len(pages), 200):
        part = pages[first : first + 200]
        found = browser.run(f"({DRAWN})({json.dumps([page.of_page() for page in part])})")
        for page, drawn in zip(part, found, strict=True):
            check_words(page, drawn)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    folder = tmp_path_factory.mktemp("surfaces")
    with Browser(folder) as one:
        blank = RigidBody(1.0, np.diag([1.0, 2.0, 2.5])).free_motion((1.0, 0.1, 0.1)).at([0.0, 1.0])
        one.open(blank.animate(folder / "a.html"), "#t=0")
        yield one


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_random_motions(browser: Browser, kind: str) -> None:
    many = [motion(kind, k) for k in range(15)]
    pages = [shown(one) for one in many]
    for one, page in zip(many, pages, strict=True):
        check_data(one, page)
    check_many(browser, pages)


@needs_browser
@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("kind", KINDS)
def test_a_thousand_random_motions(browser: Browser, kind: str) -> None:
    pages = []
    for k in range(15, 1040):
        one = motion(kind, k)
        pages.append(shown(one))
        check_data(one, pages[-1])
    check_many(browser, pages)


WRITTEN = """["space", "second"].map((view) => [polhode.views[view].width, polhode.views[view].height,
  (polhode.views[view].written ?? []).map(({ name, at, width }) => [name, ...at, width])])"""
WORDS = """[document.body.innerText, ...[...document.querySelectorAll("[aria-label], [title]")].map(
  (one) => `${one.ariaLabel} ${one.title}`)].join(" ")"""
SHOW = "location.hash = 't=0&view={0}'; new Promise((done) => setTimeout(done, 60))"
KEYS = """(() => {
  const colorOf = (one) => getComputedStyle(one).color;
  const seen = (color) => {
    const one = document.createElement("i");
    one.style.color = color; document.body.append(one);
    const found = colorOf(one);
    one.remove();
    return found;
  };
  const lines = Object.values(polhode.colors).flat().map(seen);
  return [lines, [...document.querySelectorAll(".key")].map(colorOf)];
})()"""
CAPTIONS = """["space", "second"].map((name) => [document.getElementById(`${name}-caption`).textContent,
  document.getElementById(name).getAttribute("aria-label")])"""


def with_wheels(names: tuple[str, ...]) -> Any:
    """Wheels under a load, with the longest names that anyone gives."""
    axes = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1), (-1, 1, 0), (0, -1, -1)]
    load: Any = sum(
        loads.wheel(axis, 0.05, 40.0 * k + 1.0, name=name)
        for k, (axis, name) in enumerate(zip(axes, names, strict=False))
    )
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    return body.simulate(np.linspace(0.0, 10.0, 101), (0.3, 0.2, 0.7), load=load)


@needs_browser
@pytest.mark.parametrize(
    "names",
    [
        ("wheel",),
        ("reaction_wheel_of_the_roll_axis",),
        ("reaction_wheel",) * 4,
        ("a", "W" * 60, "rw", "x y z"),
    ],
)
def test_no_name_meets_another_or_the_edge(browser: Browser, tmp_path: Path, names: tuple[str, ...]) -> None:
    browser.open(with_wheels(names).animate(tmp_path / "a.html"), "#t=0")
    for size in SIZES:
        browser.screen(*size, touch=size[0] < 500)
        for view in ("space", "body"):
            browser.run(SHOW.format(view))
            for t in np.linspace(0.0, 10.0, 6):
                browser.run(f"polhode.show({t})")
                for width, height, written in browser.run(WRITTEN):
                    check_names(width, height, written)


def check_names(width: float, height: float, written: list[tuple[str, float, float, float]]) -> None:
    if not width:  # of a narrow screen the other view
        return
    assert {"ω", "L"} <= {name for name, *_ in written}
    for name, x, y, wide in written:
        assert wide / 2 <= x <= width - wide / 2, name
        assert 8 <= y <= height - 8, name
    for (one, x, y, wide), (other, p, q, far) in combinations(written, 2):
        assert abs(x - p) >= (wide + far) / 2 or abs(y - q) >= 16, (one, other, width)


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_pages_of_each_kind(browser: Browser, tmp_path: Path, kind: str) -> None:
    """On each screen, in light and dark: no word for a colour, and what is read aloud is what is written."""
    one = motion(kind, 1)
    page = tmp_path / "a.html"
    page.write_text(page_of(one.motion, one.end)[0], "utf-8")
    browser.open(page, "#t=0")
    assert browser.run("polhode.motion.surface.kind") == one.kind
    has_rolling = browser.run("!document.querySelector('[data-view=poinsot]').hidden")
    for size, dark in (*((size, False) for size in SIZES), (SIZES[2], True)):
        browser.screen(*size, touch=size[0] < 500, dark=dark)
        for view in ("space", "body", "poinsot"):
            browser.run(SHOW.format(view))
            words = browser.run(WORDS)
            assert not re.search(COLOR_WORDS, words, re.IGNORECASE), words
            captions = browser.run(CAPTIONS)
            for caption, label in captions:
                assert label == f"{caption}. Arrow keys turn the view, plus and minus bring it nearer."
            if view != "space":  # which leaves the other view as it was
                assert captions[1][0].startswith("Poinsot") == (view == "poinsot" and has_rolling)
            lines, words = browser.run(KEYS)
            assert set(words) <= set(lines)


@needs_browser
def test_another_start_changes_the_words(browser: Browser, tmp_path: Path) -> None:
    """The separatrix goes where two moments become equal, in the caption too."""
    start = RigidBody.from_principal(1.0, (1.0, 3.0, 3.2)).free_motion((0.01, 6.0, 0.0)).at([0.0, 5.0])
    browser.screen(*SIZES[2])
    browser.open(start.animate(tmp_path / "a.html"), "#t=0")
    caption = "document.getElementById('second-caption').textContent"
    assert "separatrix" in browser.run(caption)
    browser.run(
        "{ const slider = document.getElementById('start-second'); slider.value = 1;"
        "slider.dispatchEvent(new Event('input')) }"
    )
    assert "separatrix" not in browser.run(caption)
    assert "separatrix" not in browser.run("document.getElementById('second').getAttribute('aria-label')")
    browser.run("document.getElementById('given').click()")
    assert "separatrix" in browser.run(caption)


def drawn_lines(ax: Any) -> list[np.ndarray]:
    lines = [np.array(line.get_data_3d(), dtype=float).T for line in ax.get_lines()]
    return [line[np.isfinite(line).all(axis=1)] for line in lines]


def check_plots(one: Motion) -> None:
    """What `polhode`, `poinsot` and `portrait` draw of a motion in closed form has its energy, and |L|."""
    shown = one.motion
    energy, tensor = float(shown.kinetic_energy().rotational), one.tensor
    assert one.end is not None
    has_end = bool(shown.body.principal_moments[0] > 0.0)
    size = float(np.linalg.norm(shown.angular_momentum().spin))
    if energy > 0.0 and has_end:
        ax: Any = plot.polhode(shown)
        paths = [line for line in drawn_lines(ax) if len(line) > 2]
        for path in paths:
            found = np.einsum("ti,ij,tj->t", path, tensor, path)
            np.testing.assert_allclose(found, 2.0 * energy, rtol=1e-9)
        assert bool(paths) == (len(ax.get_lines()) > 4)
        plt.close("all")
    if isinstance(shown, FreeMotion) and energy > 0.0 and has_end:
        ax = plot.poinsot(shown, [0.0, one.end])
        rolled = [line for line in drawn_lines(ax) if len(line) > 2]
        herpolhode = next(
            line
            for line, made in zip(drawn_lines(ax), ax.get_lines(), strict=True)
            if made.get_color() == plot.AXIS_COLORS[0]
        )
        np.testing.assert_allclose(herpolhode[:, 2], 2.0 * energy / size, rtol=1e-9)
        assert rolled
        plt.close("all")
    if isinstance(shown, GyrostatMotion) and size > 0.0:
        check_portrait(one, size)


def check_portrait(one: Motion, size: float) -> None:
    assert one.rotor is not None
    inverse, h = np.linalg.inv(one.tensor), one.rotor

    def level(n: np.ndarray) -> Any:
        off = n / np.linalg.norm(n, axis=-1, keepdims=True) * size - h
        return 0.5 * np.einsum("...i,ij,...j", off, inverse, off)

    found = one.motion.equilibria()
    ax: Any = plot.portrait(one.motion, levels=0)
    scale = float(level(found.direction).max())
    saddles = [
        float(level(n)) for n, kind in zip(found.direction, found.kind, strict=True) if kind == "saddle"
    ]
    for made in ax.get_lines():
        line = np.array(made.get_data_3d(), dtype=float).T
        line = line[np.isfinite(line).all(axis=1)]
        if len(line) < 3:
            continue
        if made.get_color() == plot.MOMENTUM_COLOR:
            np.testing.assert_allclose(
                level(line), float(one.motion.kinetic_energy().rotational), atol=1e-7 * scale
            )
        elif made.get_color() == plot.AXIS_COLORS[1]:
            off = np.abs(np.subtract.outer(level(line), saddles)).max(axis=0).min()
            assert off < 1e-9 * scale
    plt.close("all")


PLOTTED = ("free", "gyrostat")


@pytest.mark.usefixtures("without_surfaces")
@pytest.mark.parametrize("kind", PLOTTED)
def test_plots_of_two_random_motions(kind: str) -> None:
    many = (motion(kind, k) for k in range(20))
    for one in [one for one in many if one.end is not None][:2]:
        check_plots(one)


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("kind", PLOTTED)
def test_plots_of_a_thousand_random_motions(kind: str) -> None:
    for k in range(15, 1040):
        one = motion(kind, k)
        if one.end is not None:
            check_plots(one)
